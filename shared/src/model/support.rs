//! A pendulum whose support moves with it: both in one Runge–Kutta step.

use super::{Model, Regime, State, Term};
use crate::effect::{MEMORY, Support};
use crate::parameters::MAX_MEMORIES;
use crate::real::Real;
use crate::rk4::{self, Phase};

impl<R: Real> Model<R> {
    /// Where pendulum and support come to within `dt_s` in this contact.
    pub(super) fn step_on(
        &self,
        support: &Term<Support<R>, R>,
        regime: &Regime<R>,
        start: Phase<R>,
        state: &State<R>,
        dt_s: R,
    ) -> (Phase<R>, [R; MEMORY]) {
        let slot = self.memories.len();
        let slope = |angle, velocity, time, beside| {
            let mut memories = state.memories;
            memories[slot] = beside;
            let motion = self.motion(angle, velocity, regime.contact.slide, time);
            let rate = (support.law.rate)(&motion, &beside, &support.values);
            (self.acceleration(regime, angle, velocity, time, &memories), rate)
        };
        rk4::step_beside(slope, start, state.memories[slot], state.time_s, dt_s)
    }

    /// The memories with the support where it comes to within `dt_s`; none where nothing moves it.
    pub(super) fn support_moved(&self, state: &State<R>, dt_s: R) -> Option<[[R; MEMORY]; MAX_MEMORIES]> {
        let support = self.support.as_ref()?;
        let start = Phase { angle: state.angle_rad, velocity: state.velocity_rad_s };
        let (_, moved) = self.step_on(support, &self.regime(&state.contact), start, state, dt_s);
        let mut memories = state.memories;
        memories[self.memories.len()] = moved;
        Some(memories)
    }
}
