//! A pendulum whose support moves with it: both in one Runge–Kutta step.

use super::{Model, Regime, State, Term};
use crate::effect::{MEMORY, Support};
use crate::parameters::MAX_MEMORIES;
use crate::real::Real;
use crate::rk4::{self, Law, Phase};

impl<R: Real> Model<R> {
    /// [`Model::step`] with a support.
    #[inline(never)]
    pub(super) fn step_with(&self, support: &Term<Support<R>, R>, state: &mut State<R>, dt_s: R) {
        let start = Phase { angle: state.angle_rad, velocity: state.velocity_rad_s };
        let (trial, moved) = self.beside(support, &self.regime(&state.contact), start, state, dt_s);
        if !self.goes_on(state, trial, dt_s) {
            return self.step_in_pieces(state, trial, dt_s);
        }
        self.advance_memories(state, trial, dt_s, Some(moved));
        state.go_to(trial, dt_s);
    }

    /// Where pendulum and support come to within `dt_s` in this contact.
    pub(super) fn beside(
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
            self.shaken(support, regime, angle, velocity, time, &memories)
        };
        rk4::step_beside(slope, start, state.memories[slot], state.time_s, dt_s)
    }

    /// dω/dt in rad/s², and how fast the support's memory changes.
    #[inline(always)]
    pub(super) fn shaken(
        &self,
        support: &Term<Support<R>, R>,
        regime: &Regime<R>,
        angle: R,
        velocity: R,
        time: R,
        memories: &[[R; MEMORY]; MAX_MEMORIES],
    ) -> (R, [R; MEMORY]) {
        let contact = &regime.contact;
        let motion = self.motion(angle, velocity, contact.slide, time);
        let shake = (support.law.shake)(&motion, &memories[self.memories.len()], &support.values);
        let moving = contact.slide.abs() + contact.push.abs();
        let mut acceleration =
            regime.acceleration(angle, velocity, time) + moving * shake.torque_nm * self.inverse_inertia;
        if self.has_others {
            acceleration = acceleration + self.added_acceleration(regime, angle, velocity, time, memories);
        }
        (acceleration / shake.share_held, shake.rate)
    }

    /// The support's memory after `dt_s`; none where nothing moves it.
    pub(super) fn support_moved(&self, state: &State<R>, dt_s: R) -> Option<[R; MEMORY]> {
        let support = self.support.as_ref()?;
        let start = Phase { angle: state.angle_rad, velocity: state.velocity_rad_s };
        Some(self.beside(support, &self.regime(&state.contact), start, state, dt_s).1)
    }

    /// All memories, that of the support after `dt_s`.
    pub(super) fn with_support_moved(&self, state: &State<R>, dt_s: R) -> Option<[[R; MEMORY]; MAX_MEMORIES]> {
        let mut memories = state.memories;
        memories[self.memories.len()] = self.support_moved(state, dt_s)?;
        Some(memories)
    }
}
