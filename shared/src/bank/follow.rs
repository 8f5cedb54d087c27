//! A model that swings on its own through a window, all its columns beside it.

use super::column::{Column, Columns, MAX_COLUMNS, MAX_KNOWN, Remembered};
use super::swing::{Piece, Place, Swing};
use crate::effect::{Action, MAX_VALUES, SENSOR_MEMORY, Sensor};
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

/// What the model says of a reading.
pub struct Prediction<'a, R> {
    /// The reading, rad.
    pub reading_rad: R,
    /// Its derivatives by the known columns …
    pub known: &'a [R],
    /// … and by those of the candidates.
    pub added: &'a [R],
}

/// How far a column has moved the state, and what its law remembers.
#[derive(Clone, Copy)]
struct Moved<R> {
    angle: R,
    velocity: R,
    memory: Remembered<R>,
}

/// A window's model and columns.
pub struct Follower<'a, R: 'static> {
    swing: Swing<R>,
    columns: &'a Columns<R>,
    n_added: usize,
    moved: Vec<Moved<R>, MAX_ALL>,
    derivatives: Vec<R, MAX_ALL>,
}

impl<'a, R: Real<Mask = bool>> Follower<'a, R> {
    /// For a model with these parameters; without candidates it is much faster.
    #[inline(never)]
    pub fn new(parameters: &Parameters<R>, columns: &'a Columns<R>, has_candidates: bool) -> Self {
        let n_added = if has_candidates { columns.added.len() } else { 0 };
        Self { swing: Swing::new(parameters), columns, n_added, moved: Vec::new(), derivatives: Vec::new() }
    }

    fn all(&self) -> impl Iterator<Item = &'a Column<R>> + use<'a, R> {
        self.columns.known.iter().chain(self.columns.added.iter().take(self.n_added))
    }

    /// Begins anew where the sensor reads an angle (rad) and a velocity (rad/s), so long after the release.
    pub fn start(&mut self, angle_rad: R, velocity_rad_s: R, time_s: R) {
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
        let here = self.swing.motion();
        let (zero, one) = (R::zero(), R::one());
        let approach = self.swing.approach();
        let still = |column: &Column<R>| match column {
            Column::Law { action: Action::Sensor(sensor), values, .. } => {
                Remembered { sensor: in_stride(sensor, values, &approach), ..Remembered::nothing() }
            }
            Column::Between { sensor, values, .. } => {
                let [sensor, more] = values.map(|values| in_stride(sensor, &values, &approach));
                Remembered { sensor, more, ..Remembered::nothing() }
            }
            Column::Law { action, values, .. } => Remembered::start(action, &here, here.angle_rad, values),
            _ => Remembered::nothing(),
        };
        self.moved = self.all().map(|column| Moved { angle: zero, velocity: zero, memory: still(column) }).collect();
        if let [angle, velocity, ..] = self.moved.as_mut_slice() {
            (angle.angle, velocity.velocity) = (one, one);
        }
    }

    /// Swings on for so many seconds.
    pub fn advance(&mut self, seconds: R) {
        let all = self.columns.known.iter().chain(self.columns.added.iter().take(self.n_added));
        let moved = &mut self.moved;
        let inverse_inertia = self.swing.inverse_inertia();
        self.swing.advance(seconds, &mut |piece| {
            for (column, moved) in all.clone().zip(moved.iter_mut()) {
                moved.advance(column, piece, inverse_inertia);
            }
        });
    }

    /// What the sensor reads here. Call it at each sample in turn.
    pub fn read(&mut self) -> Prediction<'_, R> {
        let (reading_rad, gain) = self.swing.read();
        let here = self.swing.motion();
        let mut derivative = |(column, moved): (&Column<R>, &mut Moved<R>)| match column {
            Column::Offset => R::one(),
            Column::Law { action: Action::Sensor(sensor), values, units } => {
                ((sensor.read)(reading_rad, &here, &mut moved.memory.sensor, values) - reading_rad) / *units
            }
            Column::Between { sensor, values, units } => {
                let less = (sensor.read)(here.angle_rad, &here, &mut moved.memory.sensor, &values[0]);
                ((sensor.read)(here.angle_rad, &here, &mut moved.memory.more, &values[1]) - less) / *units
            }
            _ => gain * moved.angle,
        };
        let all = self.columns.known.iter().chain(self.columns.added.iter().take(self.n_added));
        self.derivatives.clear();
        self.derivatives.extend(all.zip(self.moved.iter_mut()).map(&mut derivative));
        let (known, added) = self.derivatives.split_at(self.columns.known.len().min(self.derivatives.len()));
        Prediction { reading_rad, known, added }
    }
}

/// What a sensor's law remembers after it was led to where a window begins.
fn in_stride<R: Real>(sensor: &Sensor<R>, values: &[R; MAX_VALUES], approach: &[Motion<R>]) -> [R; SENSOR_MEMORY] {
    let mut memory = None;
    for motion in approach {
        let memory = memory.get_or_insert_with(|| (sensor.start)(motion.angle_rad, motion, values));
        (sensor.read)(motion.angle_rad, motion, memory, values);
    }
    memory.unwrap_or([R::zero(); SENSOR_MEMORY])
}

impl<R: Real<Mask = bool>> Moved<R> {
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
