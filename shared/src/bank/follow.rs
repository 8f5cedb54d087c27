//! A model that swings on its own through a window, all its columns beside it.

use super::column::{Column, Columns, MAX_COLUMNS, MAX_KNOWN, Remembered, with};
use super::sums::Block;
use super::swing::{Approach, Piece, Place, Swing};
use crate::effect::{Action, Effect, MAX_VALUES, Sensor};
use crate::motion::Motion;
use crate::parameters::Parameters;
use crate::real::Real;
use heapless::Vec;

/// Known columns and those of candidates.
const MAX_ALL: usize = MAX_KNOWN + MAX_COLUMNS;

/// A sensor that lags or has a gain is met by this many corrections of where the pendulum is.
const START_ROUNDS: usize = 3;

/// A sensor whose reading changes more or less than its angle by more than this share just stands still, as with play.
const LARGEST_GAIN_ERROR: f64 = 0.5;

/// How carefully a swing is followed.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
enum Pace {
    /// As far with each step as the period allows.
    #[default]
    Free,
    /// From reading to reading about a turn, where laws change and play is taken up; without that a hidden play of 12
    /// mrad gains 8 % less.
    Careful,
    /// From reading to reading throughout: after each turn the model remembers a way that may be shorter than any step.
    Single,
}

impl Pace {
    /// Of a model with this effect.
    fn of<R: Real>(id: u16) -> Self {
        match Effect::<R>::by_id(id) {
            Some(Effect { action: Action::State(_), .. }) => Self::Single,
            Some(effect) if !effect.is_fine => Self::Free,
            _ => Self::Careful,
        }
    }
}

/// How far a column has moved the state, and what its law remembers.
#[derive(Clone, Copy)]
struct Moved<R> {
    angle: R,
    velocity: R,
    memory: Remembered<R>,
}

/// The memory of a follower.
pub struct Track<R: 'static> {
    swing: Swing<R>,
    moved: Vec<Moved<R>, MAX_ALL>,
    /// What a law of the sensor remembers that has a little more of its strength.
    more: [Remembered<R>; MAX_KNOWN],
}

impl<R: Copy> Track<R> {
    /// Empty, given zero.
    pub const fn empty(zero: R) -> Self {
        let more = [Remembered::all(zero); MAX_KNOWN];
        Self { swing: Swing::empty(zero), moved: Vec::new(), more }
    }
}

/// A window's model and columns.
pub struct Follower<'a, R: 'static> {
    swing: &'a mut Swing<R>,
    columns: &'a Columns<R>,
    n_added: usize,
    pace: Pace,
    moved: &'a mut Vec<Moved<R>, MAX_ALL>,
    more: &'a mut [Remembered<R>; MAX_KNOWN],
}

impl<'a, R: Real<Mask = bool>> Follower<'a, R> {
    /// For a model with these parameters; without candidates it is much faster.
    pub fn new(
        track: &'a mut Track<R>,
        parameters: &Parameters<R>,
        columns: &'a Columns<R>,
        has_candidates: bool,
    ) -> Self {
        track.swing.renew(parameters);
        let n_added = if has_candidates { columns.added.len() } else { 0 };
        let Track { swing, moved, more } = track;
        let present = parameters.effects.iter().map(|effect| Pace::of::<R>(effect.id)).max();
        let pace = present.unwrap_or_default().max(if n_added > 0 { Pace::Careful } else { Pace::Free });
        Self { swing, columns, n_added, pace, moved, more }
    }

    /// Begins anew where the sensor reads an angle (rad) and a velocity (rad/s), so long after the release.
    #[inline(never)]
    pub fn start(&mut self, angle_rad: R, velocity_rad_s: R, time_s: R) {
        self.start_swing(angle_rad, velocity_rad_s, time_s);
        self.start_columns();
    }

    fn start_swing(&mut self, angle_rad: R, velocity_rad_s: R, time_s: R) {
        let (mut angle, mut velocity) = (angle_rad, velocity_rad_s);
        self.swing.start(angle, velocity, time_s);
        for _ in 0..START_ROUNDS {
            let (reading, gain) = self.swing.read();
            let has_gain = (gain - R::one()).abs().lt(R::of(LARGEST_GAIN_ERROR));
            let gain = R::select(has_gain, gain, R::one());
            let rate = self.swing.rate(reading);
            (angle, velocity) = (angle + (angle_rad - reading) / gain, velocity + (velocity_rad_s - rate) / gain);
            self.swing.start(angle, velocity, time_s);
        }
    }

    fn start_columns(&mut self) {
        let here = self.swing.motion();
        let zero = R::zero();
        let approach = self.swing.approach();
        self.moved.clear();
        let columns = self.columns.known.iter().chain(&self.columns.added[..self.n_added]);
        for (index, column) in columns.enumerate() {
            let memory = match column {
                Column::Law { action: Action::Sensor(sensor), values, .. } => in_stride(sensor, values, &approach),
                Column::Between { sensor, values, units } => {
                    self.more[index] = in_stride(sensor, &with(values, 0, values[0] + *units), &approach);
                    in_stride(sensor, values, &approach)
                }
                Column::Law { action, values, .. } => Remembered::start(action, &here, here.angle_rad, values),
                _ => Remembered::nothing(),
            };
            let _ = self.moved.push(Moved { angle: zero, velocity: zero, memory });
        }
        if let [angle, velocity, ..] = self.moved.as_mut_slice() {
            (angle.angle, velocity.velocity) = (R::one(), R::one());
        }
    }

    /// How many columns it follows: known ones and those of candidates.
    pub fn n_columns(&self) -> (usize, usize) {
        (self.columns.known.len(), self.n_added)
    }

    /// Swings on for so many seconds.
    pub fn advance(&mut self, seconds: R) {
        let added = &self.columns.added[..self.n_added];
        let moved = &mut *self.moved;
        let known = &self.columns.known;
        let inverse_inertia = self.swing.inverse_inertia();
        self.swing.advance(seconds, &mut |piece| {
            let (of_known, of_added) = moved.split_at_mut(known.len());
            advance_all(of_known, known, piece, inverse_inertia);
            advance_all(of_added, added, piece, inverse_inertia);
        });
    }

    /// Swings on by so many intervals in s, and tells what the sensor reads at the end of each but the last one, and at
    /// which share of the way.
    pub fn advance_over(&mut self, n: usize, interval_s: R, tell: &mut dyn FnMut(R, R)) {
        let from = self.swing.motion();
        self.advance(R::of(n as f64) * interval_s);
        self.swing.read_between(&from, n, interval_s, tell);
    }

    /// Over how many intervals in s the next step may go, given the most that the pendulum's period allows.
    pub fn stride(&self, most: usize, interval_s: R) -> usize {
        let longest_s = R::of(most as f64) * interval_s;
        match self.pace {
            Pace::Free => most,
            Pace::Careful if !self.swing.is_near_turn(longest_s) => most,
            Pace::Careful | Pace::Single => 1,
        }
    }

    /// What the sensor reads here, rad; its derivatives by all columns go into a block. Call it at each sample in turn.
    pub fn read(&mut self, block: &mut Block<R>) -> R {
        let (reading_rad, gain) = self.swing.read();
        let here = self.swing.motion();
        let (known, added) = (&self.columns.known, &self.columns.added[..self.n_added]);
        let (of_known, of_added) = self.moved.split_at_mut(known.len());
        for (index, (column, moved)) in known.iter().zip(of_known).enumerate() {
            let derivative = match column {
                Column::Offset => R::one(),
                Column::Between { sensor, values, units } => {
                    let less = moved.memory.read(sensor, here.angle_rad, &here, values);
                    let values = with(values, 0, values[0] + *units);
                    (self.more[index].read(sensor, here.angle_rad, &here, &values) - less) / *units
                }
                _ => moved.derivative(column, reading_rad, gain, &here),
            };
            block.write(index, derivative);
        }
        let places = block.places(known.len());
        for ((column, moved), place) in added.iter().zip(of_added).zip(places) {
            *place = moved.derivative(column, reading_rad, gain, &here);
        }
        reading_rad
    }
}

#[inline(never)]
fn advance_all<R: Real<Mask = bool>>(
    moved: &mut [Moved<R>],
    columns: &[Column<R>],
    piece: &Piece<R>,
    inverse_inertia: R,
) {
    for (moved, column) in moved.iter_mut().zip(columns) {
        moved.advance(column, piece, inverse_inertia);
    }
}

/// What a sensor's law remembers after it was led to where a window begins.
#[inline(never)]
fn in_stride<R: Real>(sensor: &Sensor<R>, values: &[R; MAX_VALUES], approach: &Approach<R>) -> Remembered<R> {
    let mut memory = None;
    for motion in approach.motions() {
        let memory =
            memory.get_or_insert_with(|| Remembered::of_sensor(&(sensor.start)(motion.angle_rad, &motion, values)));
        memory.read(sensor, motion.angle_rad, &motion, values);
    }
    memory.unwrap_or(Remembered::nothing())
}

impl<R: Real<Mask = bool>> Moved<R> {
    /// Of the reading, for a column that does not depend on others.
    fn derivative(&mut self, column: &Column<R>, reading_rad: R, gain: R, here: &Motion<R>) -> R {
        match column {
            Column::Law { action: Action::Sensor(sensor), values, units } => {
                (self.memory.read(sensor, reading_rad, here, values) - reading_rad) / *units
            }
            _ => gain * self.angle,
        }
    }

    fn advance(&mut self, column: &Column<R>, piece: &Piece<R>, inverse_inertia: R) {
        let half = R::of(0.5) * piece.seconds * inverse_inertia;
        let [[aa, av], [va, vv]] = piece.whole;
        let (angle, velocity) = (self.angle, self.velocity);
        (self.angle, self.velocity) = (aa * angle + av * velocity, va * angle + vv * velocity);
        if column.turns() {
            for place in &piece.places {
                let gained = half * self.torque_nm(column, piece, place);
                self.angle = self.angle + place.from_here[0] * gained;
                self.velocity = self.velocity + place.from_here[1] * gained;
            }
        }
        match column {
            Column::Band => {
                self.angle = self.angle + piece.by_band.0[0];
                self.velocity = self.velocity + piece.by_band.0[1];
            }
            Column::Law { action, values, .. } => {
                self.memory.advance(action, &piece.ends[0], &piece.ends[1], values);
            }
            _ => {}
        }
    }

    /// The torque of one unit of the column's quantity, N·m.
    fn torque_nm(&self, column: &Column<R>, piece: &Piece<R>, place: &Place<R>) -> R {
        match column {
            Column::Start | Column::Offset | Column::Between { .. } => R::zero(),
            Column::Viscous => -piece.rubs * place.friction.velocity_rad_s,
            Column::Coulomb => -piece.rubs * place.friction.direction,
            Column::Inertia => -place.acceleration,
            Column::Band => piece.by_band.1,
            Column::Law { action, values, units } => {
                piece.moves * self.memory.torque_nm(action, &place.drive, &place.friction, piece.rubs, values) / *units
            }
        }
    }
}
