//! What the reading is derived by: one column a number that may be other than the model says.
//!
//! The first columns are known to every model: where a window starts, the zero, friction and inertia, and the strengths
//! of effects that the model has already. Behind them stand the candidates: every start of every effect of the list
//! that the model lacks. In a number that the law is linear in, at zero (`Column::of`), the column is the exact
//! derivative. An effect of the sensor that is linear in none, such as play, is taken as a whole, at the size that its
//! start proposes.

use crate::effect::{Action, Effect, MAX_VALUES, MEMORY, SENSOR_MEMORY, Sensor};
use crate::motion::{Motion, Pendulum};
use crate::parameters::{Parameters, base};
use crate::real::Real;
use core::ops::Range;
use heapless::Vec;

/// The start angle and the start velocity of a window: the first two columns.
pub const N_STARTS: usize = 2;

/// Zero, viscous and dry friction, inertia: the next ones.
pub const N_BASE: usize = 4;

/// The most columns that a model may have beside its candidates: starts, base and strengths of effects it has.
pub const MAX_KNOWN: usize = 12;

/// The most columns of candidates.
pub const MAX_COLUMNS: usize = 76;

/// The most candidates.
pub const MAX_CANDIDATES: usize = 56;

/// So many candidates are judged to the end: those whose effects promise most.
pub const MAX_JUDGED: usize = 8;

/// The most numbers that a candidate is linear in.
pub const MAX_STRENGTHS: usize = 3;

/// What makes a column.
#[derive(Clone, Copy)]
pub enum Column<R: 'static> {
    /// A start of the window: known at its first instant, nothing adds to it.
    Start,
    /// The zero of the sensor.
    Offset,
    /// Viscous friction, Mw.
    Viscous,
    /// Dry friction, Mc.
    Coulomb,
    /// Moment of inertia, I.
    Inertia,
    /// The width of the velocity band, DV: acts where sliding begins and ends.
    Band,
    /// A law at these values, so many units of its strength.
    Law {
        /// The law.
        action: Action<R>,
        /// Its values: one strength, and the shape.
        values: [R; MAX_VALUES],
        /// By how much the strength differs from zero in them.
        units: R,
    },
    /// A sensor's law that the model has and that is linear in no strength: between two values of it.
    Between {
        /// The law.
        sensor: Sensor<R>,
        /// Its values, with a little less of the strength, the first of them.
        values: [R; MAX_VALUES],
        /// How much more the other one has.
        units: R,
    },
}

/// An effect at one of its starts.
#[derive(Clone)]
pub struct Candidate<R: 'static> {
    /// The effect.
    pub effect: &'static Effect<R>,
    /// Which start that is; one behind them all is zero.
    place: u8,
    /// Its first column among those of the candidates.
    pub first: u8,
    /// Which of its numbers the columns are.
    pub strengths: Strengths,
}

/// Which of an effect's numbers are strengths.
pub type Strengths = Vec<u8, MAX_STRENGTHS, u8>;

impl<R> Candidate<R> {
    /// Its columns among those of all candidates.
    pub fn columns(&self) -> Range<usize> {
        let first = usize::from(self.first);
        first..first + self.strengths.len()
    }
}

impl<R: Real> Candidate<R> {
    /// Its values at that start.
    pub fn start(&self) -> [R; MAX_VALUES] {
        self.effect.starts.get(usize::from(self.place)).map_or([R::zero(); MAX_VALUES], |start| start.map(R::of))
    }
}

/// All columns for a model.
pub struct Columns<R: 'static> {
    /// Starts, base, and strengths of effects that the model has.
    pub known: Vec<Column<R>, MAX_KNOWN>,
    /// Which effect and number each known column from `N_STARTS + N_BASE` on is.
    pub present: Vec<(u16, u8), { MAX_KNOWN - N_STARTS - N_BASE }>,
    /// Those of the candidates.
    pub added: Vec<Column<R>, MAX_COLUMNS>,
    /// The candidates.
    pub candidates: Vec<Candidate<R>, MAX_CANDIDATES>,
}

impl<R> Columns<R> {
    /// None yet.
    pub const fn empty() -> Self {
        Self { known: Vec::new(), present: Vec::new(), added: Vec::new(), candidates: Vec::new() }
    }
}

impl<R: Real<Mask = bool>> Columns<R> {
    /// Columns for a model with these parameters, the width of its velocity band known or a candidate; effects for which
    /// there is no room are left out.
    #[inline(never)]
    pub fn fill(&mut self, parameters: &Parameters<R>, knows_band: bool) {
        let columns = self;
        columns.known.clear();
        columns.present.clear();
        columns.added.clear();
        columns.candidates.clear();
        columns.known.extend([
            Column::Start,
            Column::Start,
            Column::Offset,
            Column::Viscous,
            Column::Coulomb,
            Column::Inertia,
        ]);
        for effect in Effect::<R>::ALL.iter().filter(|effect| !effect.is_base()) {
            match parameters.values(effect.id) {
                Some(values) => columns.add_present(effect, values),
                None if effect.is_for_first_look() => {
                    (0..effect.first_look_starts().len() as u8).for_each(|place| columns.add_candidate(effect, place));
                }
                None => {}
            }
        }
        if knows_band {
            let _ = columns.known.push(Column::Band).is_ok() && columns.present.push((base::STICTION, 1)).is_ok();
        } else {
            columns.add_band();
        }
    }

    /// Leaves only some of the candidates, given by their places.
    #[inline(never)]
    pub fn keep(&mut self, is_kept: &dyn Fn(usize) -> bool) {
        let (mut n_kept, mut first) = (0, 0);
        for place in (0..self.candidates.len()).filter(|place| is_kept(*place)) {
            let own = self.candidates[place].columns();
            for (from, to) in own.clone().zip(first..) {
                self.added[to] = self.added[from];
            }
            self.candidates[place].first = first as u8;
            self.candidates.swap(n_kept, place);
            (n_kept, first) = (n_kept + 1, first + own.len());
        }
        self.candidates.truncate(n_kept);
        self.added.truncate(first);
    }

    /// Strengths of an effect that the model has, at the shape it has.
    #[inline(never)]
    fn add_present(&mut self, effect: &'static Effect<R>, values: &[R]) {
        let strengths = effect.starts.first().map(|start| strengths(effect, &start.map(R::of))).unwrap_or_default();
        let shape: [R; MAX_VALUES] = core::array::from_fn(|i| match values.get(i) {
            Some(value) if !strengths.contains(&(i as u8)) => *value,
            _ => R::zero(),
        });
        let (whole, strengths) = if_whole(effect, &shape, strengths);
        for index in &strengths {
            let column = Column::of(effect, &shape, *index, whole).about(&shape);
            if self.known.push(column).is_ok() {
                let _ = self.present.push((effect.id, *index));
            }
        }
    }

    #[inline(never)]
    fn add_candidate(&mut self, effect: &'static Effect<R>, place: u8) {
        let start = effect.starts[usize::from(place)].map(R::of);
        let (whole, strengths) = if_whole(effect, &start, strengths(effect, &start));
        let first = self.added.len();
        let has_room = first + strengths.len() <= MAX_COLUMNS && !self.candidates.is_full();
        if strengths.is_empty() || !has_room {
            return;
        }
        for index in &strengths {
            let _ = self.added.push(Column::of(effect, &start, *index, whole));
        }
        let _ = self.candidates.push(Candidate { effect, place, first: first as u8, strengths });
    }

    /// Friction about rest: no effect that is added, but what may look like one.
    fn add_band(&mut self) {
        if let Some(effect) = Effect::<R>::by_id(base::STICTION) {
            let (place, first, strengths) = (u8::MAX, self.added.len() as u8, [1].into_iter().collect());
            if !self.candidates.is_full() && self.added.push(Column::Band).is_ok() {
                let _ = self.candidates.push(Candidate { effect, place, first, strengths });
            }
        }
    }
}

/// An effect of the sensor that is linear in no strength is taken as a whole: at which size of its first number, and the
/// strengths.
fn if_whole<R: Real<Mask = bool>>(
    effect: &Effect<R>,
    shape: &[R; MAX_VALUES],
    strengths: Strengths,
) -> (Option<R>, Strengths) {
    let is_whole = R::zero().lt(shape[0].abs()) && matches!(effect.action, Action::Sensor(_));
    if strengths.is_empty() && is_whole { (Some(shape[0]), [0].into_iter().collect()) } else { (None, strengths) }
}

/// A sensor's law as a whole is derived over this share of its strength, to either side.
const NEAR: f64 = 0.05;

impl<R: Real<Mask = bool>> Column<R> {
    /// Does it act on the pendulum, not on its sensor alone?
    pub fn turns(&self) -> bool {
        let Self::Law { action, .. } = self else {
            return !matches!(self, Self::Start | Self::Offset | Self::Between { .. });
        };
        !matches!(action, Action::Sensor(_))
    }

    /// As it is where the model has the effect already.
    fn about(self, shape: &[R; MAX_VALUES]) -> Self {
        match self {
            Self::Law { action: Action::Sensor(sensor), units, .. } if R::zero().lt(shape[0].abs()) => {
                let near = R::of(NEAR) * units;
                Self::Between { sensor, values: with(shape, 0, units - near), units: near + near }
            }
            other => other,
        }
    }

    /// One unit of a strength of an effect of this shape, all its other strengths zero as the shape has them; or the
    /// effect as a whole.
    fn of(effect: &Effect<R>, shape: &[R; MAX_VALUES], index: u8, whole: Option<R>) -> Self {
        let units = whole.unwrap_or(R::one());
        Self::Law { action: effect.action, values: with(shape, index, units), units }
    }
}

/// The same values but for one.
pub(super) fn with<R: Copy>(values: &[R; MAX_VALUES], index: u8, value: R) -> [R; MAX_VALUES] {
    let mut values = *values;
    values[usize::from(index)] = value;
    values
}

/// Which of an effect's numbers, zero at a start, it is linear in: the law is absent there, and a part of the number has
/// that part of the effect.
#[inline(never)]
fn strengths<R: Real<Mask = bool>>(effect: &Effect<R>, start: &[R; MAX_VALUES]) -> Strengths {
    let absent = probed(&effect.action, start);
    let is_strength = |index: &u8| {
        let is_zero = !R::zero().lt(start[usize::from(*index)].abs());
        let [part, whole] = [PART, 1.0].map(|size| probed(&effect.action, &with(start, *index, R::of(size))));
        let acts = whole.iter().any(|value| R::zero().lt(value.abs()));
        let is_share = |(part, whole): (&R, &R)| (*part - R::of(PART) * *whole).abs().le(R::of(ROUNDING) * whole.abs());
        is_zero && acts && part.iter().zip(&whole).all(is_share)
    };
    if absent.iter().any(|value| R::zero().lt(value.abs())) {
        return Vec::new();
    }
    (0..effect.parameters.len() as u8).filter(is_strength).take(MAX_STRENGTHS).collect()
}

/// A law is linear in a strength if this share of a unit has this share of its effect …
const PART: f64 = 0.125;

/// … but for what `f32` rounds.
const ROUNDING: f64 = 1e-3;

/// Angles (rad) and velocities (rad/s) at which laws are looked at: none of them special.
const PLACES: [[f64; 2]; 4] = [[0.31, 1.7], [0.54, 0.6], [-0.43, -2.3], [-1.17, 1.1]];

/// What a law adds at a few places, one after the other.
#[inline(never)]
fn probed<R: Real<Mask = bool>>(action: &Action<R>, values: &[R; MAX_VALUES]) -> [R; PLACES.len()] {
    let at = |index: usize| {
        let [angle, velocity] = PLACES[index].map(R::of);
        Motion {
            angle_rad: angle,
            velocity_rad_s: velocity,
            direction: velocity.sign(),
            time_s: R::of(0.01 * index as f64),
            pendulum: Pendulum::paper(),
        }
    };
    let mut memory = Remembered::start(action, &at(0), R::of(PLACES[0][0]), values);
    core::array::from_fn(|index| {
        let here = at(index);
        let added = match action {
            Action::Sensor(sensor) => memory.read(sensor, here.angle_rad, &here, values) - here.angle_rad,
            _ => memory.torque_nm(action, &here, &here, R::one(), values),
        };
        memory.advance(action, &at(index.max(1) - 1), &here, values);
        added
    })
}

/// The most that a law remembers.
const MOST_MEMORY: usize = if MEMORY < SENSOR_MEMORY { SENSOR_MEMORY } else { MEMORY };

/// What a law remembers, of a torque or of a sensor.
#[derive(Clone, Copy)]
pub struct Remembered<R> {
    numbers: [R; MOST_MEMORY],
}

impl<R: Copy> Remembered<R> {
    /// The same number throughout.
    pub const fn all(number: R) -> Self {
        Self { numbers: [number; MOST_MEMORY] }
    }
}

impl<R: Real> Remembered<R> {
    /// Nothing.
    pub fn nothing() -> Self {
        Self::all(R::zero())
    }

    /// Of a sensor.
    pub fn of_sensor(memory: &[R; SENSOR_MEMORY]) -> Self {
        Self { numbers: core::array::from_fn(|i| memory.get(i).copied().unwrap_or(R::zero())) }
    }

    fn of_torque(memory: &[R; MEMORY]) -> Self {
        Self { numbers: core::array::from_fn(|i| memory.get(i).copied().unwrap_or(R::zero())) }
    }

    fn torque(&self) -> [R; MEMORY] {
        core::array::from_fn(|i| self.numbers[i])
    }

    /// On a pendulum that begins here, its sensor reading this.
    pub fn start(action: &Action<R>, here: &Motion<R>, reading_rad: R, values: &[R; MAX_VALUES]) -> Self {
        match action {
            Action::State(law) => Self::of_torque(&(law.start)(here, values)),
            Action::Sensor(law) => Self::of_sensor(&(law.start)(reading_rad, here, values)),
            _ => Self::nothing(),
        }
    }

    /// What a sensor makes of a reading, rad.
    pub fn read(&mut self, sensor: &Sensor<R>, reading_rad: R, here: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
        let mut memory = core::array::from_fn(|i| self.numbers[i]);
        let reading_rad = (sensor.read)(reading_rad, here, &mut memory, values);
        *self = Self::of_sensor(&memory);
        reading_rad
    }

    /// The law's torque, N·m: as a drive sees the motion, and as friction does, which rubs or not (1 or 0).
    pub fn torque_nm(
        &self,
        action: &Action<R>,
        drive: &Motion<R>,
        friction: &Motion<R>,
        rubs: R,
        values: &[R; MAX_VALUES],
    ) -> R {
        match action {
            Action::Drive(law) => law(drive, values),
            Action::Friction(law) => rubs * law(friction, values),
            Action::State(law) => (law.torque)(drive, &self.torque(), values),
            Action::Base | Action::Support(_) | Action::Sensor(_) | Action::Formula(_) | Action::Curve => R::zero(),
        }
    }

    /// After a step from one instant to another.
    pub fn advance(&mut self, action: &Action<R>, before: &Motion<R>, after: &Motion<R>, values: &[R; MAX_VALUES]) {
        if let Action::State(law) = action {
            *self = Self::of_torque(&(law.advance)(before, after, &self.torque(), values));
        }
    }
}
