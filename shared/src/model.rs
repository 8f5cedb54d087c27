//! The pendulum: sums the effects, applies the Karnopp rule, steps through time.
//!
//! (m·l² + I)·dω/dt = −m·g·l·sin θ − friction + added effects (paper, Eqs 1–3 and 14, physical sign).
//!
//! One step function serves board and PC. It is the fixed Runge–Kutta step, except that a step in which sliding
//! begins or ends is cut at that instant; a plain 1 ms step would be 7e-4 rad off at Ms = 0.01 N·m and would chatter
//! at DV = 0.

mod change;
mod state;
mod support;

pub use change::MAX_CUTS;
pub use state::{SensorState, State};

use crate::curve::Spline;
use crate::effect::{
    Action, CURVE_ID, CUSTOM_FORMULA_ID, Effect, MAX_VALUES, MEMORY, Memory, SENSOR_MEMORY, Sensor, Support, Torque,
    coulomb, viscous,
};
use crate::formula::Program;
use crate::karnopp::{Balance, Contact};
use crate::motion::{Motion, Pendulum};
use crate::parameters::{MAX_EFFECTS, MAX_MEMORIES, MAX_SENSORS, Parameters, base};
use crate::real::{Mask, Real};
use crate::rk4::{self, Law, Phase};
use heapless::Vec;

/// An effect's function with its numbers.
#[derive(Clone, Copy)]
struct Term<F, R> {
    law: F,
    values: [R; MAX_VALUES],
}

/// A pendulum with everything that acts on it, ready to run.
#[derive(Clone)]
pub struct Model<R: 'static> {
    pendulum: Pendulum<R>,
    gravity_nm: R,
    inverse_inertia: R,
    viscous: R,
    coulomb_nm: R,
    stiction_nm: R,
    velocity_band: R,
    drives: Vec<Term<Torque<R>, R>, MAX_EFFECTS>,
    frictions: Vec<Term<Torque<R>, R>, MAX_EFFECTS>,
    memories: Vec<Term<Memory<R>, R>, MAX_MEMORIES>,
    support: Option<Term<Support<R>, R>>,
    sensors: Vec<Term<Sensor<R>, R>, MAX_SENSORS>,
    custom: Option<Term<Program<R>, R>>,
    curve: Spline<R>,
    /// Nothing beyond the base effects: the inner loop skips the lists.
    plain: bool,
    /// Of what is there at rest, gravity is all.
    hangs_freely: bool,
    /// Something is remembered from step to step.
    remembers: bool,
    /// Beside the support something else is added.
    has_others: bool,
}

/// The coefficients of the base model in the present contact: which of them act, divided by the inertia.
#[derive(Clone, Copy)]
struct Regime<R> {
    gravity: R,
    viscous: R,
    dry: R,
    contact: Contact<R>,
}

/// What the base model makes of it.
impl<R: Real> rk4::Law<R> for &Regime<R> {
    // A call for each of the four in a step would cost several lanes a tenth of their time.
    #[inline(always)]
    fn acceleration(&self, angle: R, velocity: R, _: R) -> R {
        (self.dry + self.viscous * velocity) - self.gravity * angle.sin()
    }
}

/// The same with what is added to it.
struct WithAdded<'a, R: 'static> {
    model: &'a Model<R>,
    regime: &'a Regime<R>,
    memories: &'a [[R; MEMORY]; MAX_MEMORIES],
}

impl<R: Real> rk4::Law<R> for WithAdded<'_, R> {
    #[inline(always)]
    fn acceleration(&self, angle: R, velocity: R, time: R) -> R {
        let added = self.model.added_acceleration(self.regime, angle, velocity, time, self.memories);
        self.regime.acceleration(angle, velocity, time) + added
    }
}

/// Values in the length that every law takes.
fn padded<R: Real>(values: &[R]) -> [R; MAX_VALUES] {
    core::array::from_fn(|i| values.get(i).copied().unwrap_or(R::zero()))
}

impl<R: Copy> Model<R> {
    /// The model of nothing, given zero, to be filled by [`Model::renew`].
    pub const fn empty(zero: R) -> Self {
        Self {
            pendulum: Pendulum::all(zero),
            gravity_nm: zero,
            inverse_inertia: zero,
            viscous: zero,
            coulomb_nm: zero,
            stiction_nm: zero,
            velocity_band: zero,
            drives: Vec::new(),
            frictions: Vec::new(),
            memories: Vec::new(),
            support: None,
            sensors: Vec::new(),
            custom: None,
            curve: Spline::none(),
            plain: false,
            hangs_freely: false,
            remembers: false,
            has_others: false,
        }
    }
}

impl<R: Real> Model<R> {
    /// Builds the model from parameters that passed [`Parameters::check`]; unknown effects are left out.
    pub fn new(parameters: &Parameters<R>) -> Self {
        let mut model = Self::empty(R::zero());
        model.renew(parameters);
        model
    }

    /// Becomes the model of other parameters, where it is: it is too large to be moved about on a board's stack.
    pub fn renew(&mut self, parameters: &Parameters<R>) {
        let value = |id, index: usize| parameters.values(id).and_then(|v| v.get(index)).copied().unwrap_or(R::zero());
        self.pendulum = parameters.pendulum;
        self.gravity_nm = self.pendulum.gravity_torque_nm();
        self.inverse_inertia = R::one() / self.pendulum.pivot_inertia_kg_m2();
        self.viscous = value(base::VISCOUS, 0);
        self.coulomb_nm = value(base::COULOMB, 0);
        self.stiction_nm = value(base::STICTION, 0);
        self.velocity_band = value(base::STICTION, 1);
        self.clear();
        // In the order of the list of all effects, which for the sensor is that from the shaft to the wire.
        for effect in Effect::<R>::ALL {
            if let Some(values) = parameters.values(effect.id) {
                self.add(effect, values);
            }
        }
        if let Some((formula, numbers)) = parameters.formula.as_ref().zip(parameters.values(CUSTOM_FORMULA_ID)) {
            self.custom = Some(Term { law: Program::new(formula), values: padded(numbers) });
        }
        if let Some(curve) = parameters.curve.as_ref().filter(|_| parameters.values(CURVE_ID).is_some()) {
            self.curve.follow(curve);
        }
        if self.memories.is_full() {
            // The check of parameters lets none of these pass.
            self.support = None;
        }
        let is_driven = !(self.drives.is_empty() && self.memories.is_empty() && self.custom.is_none());
        self.has_others = is_driven || !self.frictions.is_empty() || self.curve.is_some();
        self.remembers = !self.memories.is_empty() || self.support.is_some();
        self.hangs_freely = !is_driven && self.support.is_none();
        self.plain = !self.has_others && self.support.is_none();
    }

    /// Nothing is added.
    fn clear(&mut self) {
        self.drives.clear();
        self.frictions.clear();
        self.memories.clear();
        self.sensors.clear();
        self.curve.clear();
        (self.support, self.custom) = (None, None);
    }

    fn add(&mut self, effect: &Effect<R>, values: &[R]) {
        let values = padded(values);
        // The lists are as long as the parameter list may be, those of memories and sensors as its check allows.
        let _ = match effect.action {
            Action::Base | Action::Formula(_) | Action::Curve => true,
            Action::Drive(law) => self.drives.push(Term { law, values }).is_ok(),
            Action::Friction(law) => self.frictions.push(Term { law, values }).is_ok(),
            Action::State(law) => self.memories.push(Term { law, values }).is_ok(),
            Action::Support(law) => self.support.replace(Term { law, values }).is_none(),
            Action::Sensor(law) => self.sensors.push(Term { law, values }).is_ok(),
        };
    }

    /// The pendulum's fixed quantities.
    pub fn pendulum(&self) -> &Pendulum<R> {
        &self.pendulum
    }

    /// Lets the pendulum go at an angle (rad) with a velocity (rad/s), time zero.
    pub fn release(&self, angle_rad: R, velocity_rad_s: R) -> State<R> {
        let time_s = R::zero();
        let contact = Contact::sliding(R::zero());
        let motion = self.motion(angle_rad, velocity_rad_s, R::zero(), time_s);
        let mut memories = [[R::zero(); MEMORY]; MAX_MEMORIES];
        for (memory, term) in memories.iter_mut().zip(&self.memories) {
            *memory = (term.law.start)(&motion, &term.values);
        }
        if let Some(support) = &self.support {
            memories[self.memories.len()] = (support.law.start)(&motion, &support.values);
        }
        let mut state = State { angle_rad, velocity_rad_s, time_s, contact, memories };
        self.reconsider(&mut state);
        state
    }

    /// Decides anew whether the pendulum slides or rests, after its state was changed from outside.
    pub fn reconsider(&self, state: &mut State<R>) {
        let velocity = state.velocity_rad_s;
        let fast = self.velocity_band.le(velocity.abs()).and(R::zero().lt(velocity.abs()));
        let slow = self.balance(state.angle_rad, velocity, state.time_s, &state.memories);
        state.contact = Contact::select(fast, Contact::sliding(velocity.sign()), slow.contact());
        state.velocity_rad_s = R::select(state.contact.is_resting(), R::zero(), velocity);
    }

    /// Advances by `dt_s` seconds.
    #[inline]
    pub fn step(&self, state: &mut State<R>, dt_s: R) {
        if let Some(support) = &self.support {
            return self.step_with(support, state, dt_s);
        }
        let trial = self.trial(state, dt_s);
        if self.goes_on(state, trial, dt_s) {
            self.accept(state, trial, dt_s);
        } else {
            self.step_in_pieces(state, trial, dt_s);
        }
    }

    /// Is the contact the same after a step, in all lanes?
    #[inline(always)]
    fn goes_on(&self, state: &State<R>, trial: Phase<R>, dt_s: R) -> bool {
        let onward = self.velocity_band.le(state.contact.slide * trial.velocity);
        state.contact.is_sliding().and(onward).all() || self.stays(state, trial, dt_s).all()
    }

    /// Where it would come to within `dt_s` if its contact stayed as it is.
    pub fn unchanged(&self, state: &State<R>, dt_s: R) -> State<R> {
        let mut reached = *state;
        self.accept(&mut reached, self.trial(state, dt_s), dt_s);
        reached
    }

    #[inline(always)]
    fn trial(&self, state: &State<R>, dt_s: R) -> Phase<R> {
        let regime = self.regime(&state.contact);
        let start = Phase { angle: state.angle_rad, velocity: state.velocity_rad_s };
        if self.plain {
            return rk4::step(&regime, start, state.time_s, dt_s);
        }
        self.trial_with_added(&regime, start, state, dt_s)
    }

    #[inline(never)]
    fn trial_with_added(&self, regime: &Regime<R>, start: Phase<R>, state: &State<R>, dt_s: R) -> Phase<R> {
        if let Some(support) = &self.support {
            return self.beside(support, regime, start, state, dt_s).0;
        }
        let law = WithAdded { model: self, regime, memories: &state.memories };
        rk4::step(law, start, state.time_s, dt_s)
    }

    #[inline(always)]
    fn accept(&self, state: &mut State<R>, reached: Phase<R>, dt_s: R) {
        if self.remembers {
            self.advance_memories(state, reached, dt_s, self.support_moved(state, dt_s));
        }
        state.go_to(reached, dt_s);
    }

    /// The support's memory has moved to `moved` by then.
    #[inline(never)]
    fn advance_memories(&self, state: &mut State<R>, reached: Phase<R>, dt_s: R, moved: Option<[R; MEMORY]>) {
        let direction = state.contact.slide;
        let before = self.motion(state.angle_rad, state.velocity_rad_s, direction, state.time_s);
        let after = self.motion(reached.angle, reached.velocity, direction, state.time_s + dt_s);
        for (memory, term) in state.memories.iter_mut().zip(&self.memories) {
            *memory = (term.law.advance)(&before, &after, memory, &term.values);
        }
        if let Some(moved) = moved {
            state.memories[self.memories.len()] = moved;
        }
    }

    #[inline(always)]
    fn regime(&self, contact: &Contact<R>) -> Regime<R> {
        let sliding = contact.slide.abs();
        let moving = sliding + contact.push.abs();
        Regime {
            gravity: moving * self.gravity_nm * self.inverse_inertia,
            viscous: viscous::torque_nm(sliding, self.viscous) * self.inverse_inertia,
            dry: (coulomb::torque_nm(contact.slide, self.coulomb_nm) - contact.push * contact.level_nm)
                * self.inverse_inertia,
            contact: *contact,
        }
    }

    #[inline(always)]
    fn acceleration(
        &self,
        regime: &Regime<R>,
        angle: R,
        velocity: R,
        time: R,
        memories: &[[R; MEMORY]; MAX_MEMORIES],
    ) -> R {
        if let Some(support) = &self.support {
            return self.shaken(support, regime, angle, velocity, time, memories).0;
        }
        let base = regime.acceleration(angle, velocity, time);
        if self.plain { base } else { base + self.added_acceleration(regime, angle, velocity, time, memories) }
    }

    #[inline(never)]
    fn added_acceleration(
        &self,
        regime: &Regime<R>,
        angle: R,
        velocity: R,
        time: R,
        memories: &[[R; MEMORY]; MAX_MEMORIES],
    ) -> R {
        let contact = &regime.contact;
        let motion = self.motion(angle, velocity, contact.slide, time);
        let sliding = contact.slide.abs();
        let moving = sliding + contact.push.abs();
        let torque = moving * self.added_drive_nm(&motion, memories) + sliding * self.added_friction_nm(&motion);
        torque * self.inverse_inertia
    }

    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn added_drive_nm(&self, motion: &Motion<R>, memories: &[[R; MEMORY]; MAX_MEMORIES]) -> R {
        let mut sum = R::zero();
        for term in &self.drives {
            sum = sum + (term.law)(motion, &term.values);
        }
        for (term, memory) in self.memories.iter().zip(memories) {
            sum = sum + (term.law.torque)(motion, memory, &term.values);
        }
        if let Some(term) = &self.custom {
            sum = sum + term.law.drive_nm(motion, &term.values);
        }
        sum
    }

    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn added_friction_nm(&self, motion: &Motion<R>) -> R {
        let mut sum = R::zero();
        for term in &self.frictions {
            sum = sum + (term.law)(motion, &term.values);
        }
        if let Some(term) = &self.custom {
            sum = sum + term.law.friction_nm(motion, &term.values);
        }
        if self.curve.is_some() {
            sum = sum + self.curve.friction_nm(motion);
        }
        sum
    }

    /// Torque of everything that acts at rest too: gravity, springs, magnets, bristles.
    fn drive_nm(&self, angle: R, velocity: R, time: R, memories: &[[R; MEMORY]; MAX_MEMORIES]) -> R {
        let gravity = -self.gravity_nm * angle.sin();
        if self.hangs_freely {
            return gravity;
        }
        let motion = self.motion(angle, velocity, R::zero(), time);
        let shaken = match &self.support {
            None => R::zero(),
            Some(term) => (term.law.shake)(&motion, &memories[self.memories.len()], &term.values).torque_nm,
        };
        gravity + shaken + self.added_drive_nm(&motion, memories)
    }

    /// Torque of everything that opposes sliding in a direction (−1 or +1).
    fn friction_nm(&self, angle: R, velocity: R, direction: R, time: R) -> R {
        let base = viscous::torque_nm(velocity, self.viscous) + coulomb::torque_nm(direction, self.coulomb_nm);
        if self.plain {
            return base;
        }
        base + self.added_friction_nm(&self.motion(angle, velocity, direction, time))
    }

    /// Torque in N·m of all friction of sliding at an instant, in a direction (−1 or +1).
    pub fn friction_of_sliding_nm(&self, angle_rad: R, velocity_rad_s: R, direction: R, time_s: R) -> R {
        self.friction_nm(angle_rad, velocity_rad_s, direction, time_s)
    }

    fn balance(&self, angle: R, velocity: R, time: R, memories: &[[R; MEMORY]; MAX_MEMORIES]) -> Balance<R> {
        let edge = self.velocity_band;
        Balance {
            drive_nm: self.drive_nm(angle, velocity, time, memories),
            hold_positive_nm: self.stiction_nm.max(-self.friction_nm(angle, edge, R::one(), time)),
            hold_negative_nm: self.stiction_nm.max(self.friction_nm(angle, -edge, -R::one(), time)),
            velocity_band: edge,
        }
    }

    fn motion(&self, angle_rad: R, velocity_rad_s: R, direction: R, time_s: R) -> Motion<R> {
        Motion { angle_rad, velocity_rad_s, direction, time_s, pendulum: self.pendulum }
    }

    fn motion_of(&self, state: &State<R>) -> Motion<R> {
        self.motion(state.angle_rad, state.velocity_rad_s, state.contact.slide, state.time_s)
    }

    /// Kinetic and potential energy in J, zero hanging at rest; springs are not counted.
    pub fn energy_j(&self, state: &State<R>) -> R {
        let v = state.velocity_rad_s;
        let kinetic = R::of(0.5) * v * v / self.inverse_inertia;
        let half_sine = (R::of(0.5) * state.angle_rad).sin();
        kinetic + self.gravity_nm * R::of(2.0) * half_sine * half_sine
    }

    /// dω/dt in rad/s² with the contact and the memories of a state, but elsewhere and at another time: zero at rest.
    pub fn acceleration_rad_s2(&self, state: &State<R>, angle_rad: R, velocity_rad_s: R, time_s: R) -> R {
        self.acceleration(&self.regime(&state.contact), angle_rad, velocity_rad_s, time_s, &state.memories)
    }

    /// Torque in N·m of friction and all added effects at present; what the bearing holds while at rest.
    pub fn friction_torque_nm(&self, state: &State<R>) -> R {
        let regime = self.regime(&state.contact);
        let moving = self.acceleration(&regime, state.angle_rad, state.velocity_rad_s, state.time_s, &state.memories);
        moving / self.inverse_inertia + self.gravity_nm * state.angle_rad.sin()
    }

    /// The sensor on a pendulum that is held still in this state.
    pub fn sensor_at_rest(&self, state: &State<R>) -> SensorState<R> {
        self.sensor_settled(state.angle_rad, state)
    }

    /// The same for a sensor of the angular velocity.
    pub fn rate_sensor_at_rest(&self, state: &State<R>) -> SensorState<R> {
        self.sensor_settled(state.velocity_rad_s, state)
    }

    fn sensor_settled(&self, measured: R, state: &State<R>) -> SensorState<R> {
        let motion = self.motion_of(state);
        let mut memories = [[R::zero(); SENSOR_MEMORY]; MAX_SENSORS];
        let mut reading = measured;
        for (memory, term) in memories.iter_mut().zip(&self.sensors) {
            *memory = (term.law.start)(reading, &motion, &term.values);
            reading = (term.law.read)(reading, &motion, memory, &term.values);
        }
        SensorState(memories)
    }

    /// What the sensor reads in this state, in rad. Call it at each sample in turn: some sensors remember.
    pub fn read(&self, state: &State<R>, sensor: &mut SensorState<R>) -> R {
        self.read_of(state.angle_rad, state, sensor)
    }

    /// What a sensor of the angular velocity (a gyroscope, a tachometer) reads, in rad/s: gain, lag and zero act on the
    /// velocity as those of an angle's sensor do on the angle.
    pub fn read_rate(&self, state: &State<R>, sensor: &mut SensorState<R>) -> R {
        self.read_of(state.velocity_rad_s, state, sensor)
    }

    #[inline(always)]
    fn read_of(&self, measured: R, state: &State<R>, sensor: &mut SensorState<R>) -> R {
        if self.sensors.is_empty() {
            return measured;
        }
        let motion = self.motion_of(state);
        let chain = self.sensors.iter().zip(&mut sensor.0);
        chain.fold(measured, |reading, (term, memory)| (term.law.read)(reading, &motion, memory, &term.values))
    }

    /// Does nothing act on the pendulum beyond the base effects?
    pub fn is_plain(&self) -> bool {
        self.plain
    }

    /// Does the sensor read the angle as it is?
    pub fn has_plain_sensor(&self) -> bool {
        self.sensors.is_empty()
    }
}
