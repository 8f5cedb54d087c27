//! A step in which sliding begins or ends: whether it does, when, and what comes then.

use super::{Model, State};
use crate::karnopp::Contact;
use crate::real::{Mask, Real};
use crate::rk4::{self, Phase};

/// A step is cut at most this often; the rest of it is then taken without looking.
pub const MAX_CUTS: usize = 6;

/// Secant steps to where friction takes hold in the band.
const HOLD_STEPS: usize = 4;

impl<R: Real> Model<R> {
    /// True where the contact is the same before and after a step.
    #[inline(never)]
    pub(super) fn stays(&self, state: &State<R>, trial: Phase<R>, dt_s: R) -> R::Mask {
        let contact = &state.contact;
        let slides = contact.is_sliding().and(self.velocity_band.le(contact.slide * trial.velocity));
        let time = state.time_s + dt_s;
        let driven =
            contact.level_nm.le(contact.push * self.drive_nm(trial.angle, trial.velocity, time, &state.memories));
        let creeps = contact.is_in_band().and(trial.velocity.abs().le(self.velocity_band)).and(driven);
        if !contact.is_resting().any() {
            return slides.or(creeps);
        }
        let held = self.balance(trial.angle, R::zero(), time, &state.memories).holds();
        slides.or(creeps).or(contact.is_resting().and(held))
    }

    /// A step in which sliding begins or ends: cut there as often as needed.
    #[inline(never)]
    pub(super) fn step_in_pieces(&self, state: &mut State<R>, trial: Phase<R>, dt_s: R) {
        let (mut trial, mut left_s) = (trial, dt_s);
        for _ in 0..MAX_CUTS {
            left_s = self.trial_to_change(state, trial, left_s);
            if !R::zero().lt(left_s).any() {
                return;
            }
            trial = self.trial(state, left_s);
            if self.stays(state, trial, left_s).all() {
                break;
            }
        }
        self.accept(state, trial, left_s);
    }

    /// Steps until the contact changes, at most `dt_s`; gives what is left of it. A part of [`Model::step`], which is
    /// what simulations call; alone it serves whoever writes the step in another language.
    pub fn step_to_change(&self, state: &mut State<R>, dt_s: R) -> R {
        self.trial_to_change(state, self.trial(state, dt_s), dt_s)
    }

    /// The same for the step that `trial` is.
    fn trial_to_change(&self, state: &mut State<R>, trial: Phase<R>, dt_s: R) -> R {
        let before = state.contact;
        let (sliding, in_band, resting) = (before.is_sliding(), before.is_in_band(), before.is_resting());

        // What happens within this step, lane by lane.
        let enters = sliding.and(self.velocity_band.le(before.slide * trial.velocity).not());
        let mut leaves = in_band.and(self.velocity_band.lt(trial.velocity.abs()));
        let excess = |angle, velocity, time| {
            before.push * self.drive_nm(angle, velocity, time, &state.memories) - before.level_nm
        };
        let end_s = state.time_s + dt_s;
        let creeps = in_band.and(leaves.not());
        let mut holds = creeps.and_then(|| excess(trial.angle, trial.velocity, end_s).lt(R::zero()));
        let breaks =
            resting.and_then(|| self.balance(state.angle_rad, R::zero(), end_s, &state.memories).holds().not());

        // When it happens, as a share of the step.
        let mut share = R::select(breaks, R::zero(), R::one());
        let (mut until, mut part) = (trial, R::one());
        if holds.may_be() {
            share = R::select(holds, self.share_until_held(state, trial, dt_s, excess), share);
            // Where the drive is spent the speed is largest: if it is beyond the band there, the band was left before.
            let spent = self.trial(state, share * dt_s);
            let had_left = holds.and(self.velocity_band.lt(spent.velocity.abs()));
            until = Phase::select(had_left, spent, trial);
            part = R::select(had_left, share, R::one());
            (leaves, holds) = (leaves.or(had_left), holds.and(had_left.not()));
        }
        let crosses = enters.or(leaves);
        let edge = R::select(sliding, before.slide, until.velocity.sign()) * self.velocity_band;
        if crosses.may_be() {
            share = R::select(crosses, part * self.share_until_edge(state, until, part * dt_s, edge), share);
        }

        let reached = self.trial(state, share * dt_s);
        let velocity = R::select(crosses, edge, reached.velocity);
        self.accept(state, Phase { angle: reached.angle, velocity }, share * dt_s);

        let held = Contact { slide: R::zero(), push: R::zero(), level_nm: before.level_nm };
        state.contact = Contact::select(holds, held, before);
        state.contact = Contact::select(leaves, Contact::sliding(edge.sign()), state.contact);
        let decides = enters.or(breaks);
        if decides.may_be() {
            let settled = self.balance(state.angle_rad, velocity, state.time_s, &state.memories).contact();
            state.contact = Contact::select(decides, settled, state.contact);
        }
        state.velocity_rad_s = R::select(state.contact.is_resting(), R::zero(), velocity);
        (R::one() - share) * dt_s
    }

    /// The share of a step at which the velocity reaches the edge of the band.
    fn share_until_edge(&self, state: &State<R>, trial: Phase<R>, dt_s: R, edge: R) -> R {
        let regime = self.regime(&state.contact);
        let rise_start =
            self.acceleration(&regime, state.angle_rad, state.velocity_rad_s, state.time_s, &state.memories);
        let moved = self.with_support_moved(state, dt_s);
        let memories = moved.as_ref().unwrap_or(&state.memories);
        let rise_end = self.acceleration(&regime, trial.angle, trial.velocity, state.time_s + dt_s, memories);
        rk4::share_until(state.velocity_rad_s, rise_start * dt_s, trial.velocity, rise_end * dt_s, edge)
    }

    /// The share of a step in the band at which the drive falls to what friction holds: secant steps along the cubic
    /// through both ends.
    fn share_until_held(&self, state: &State<R>, trial: Phase<R>, dt_s: R, excess: impl Fn(R, R, R) -> R) -> R {
        let at = |share: R| {
            let (v0, v1) = (state.velocity_rad_s * dt_s, trial.velocity * dt_s);
            let change = trial.angle - state.angle_rad;
            let c2 = R::of(3.0) * change - (v0 + v0) - v1;
            let c3 = v0 + v1 - (change + change);
            let angle = state.angle_rad + share * (v0 + share * (c2 + share * c3));
            let velocity = state.velocity_rad_s + share * (trial.velocity - state.velocity_rad_s);
            excess(angle, velocity, state.time_s + share * dt_s)
        };
        let (mut left, mut right) = (R::zero(), R::one());
        let (mut excess_left, mut excess_right) = (at(left), at(right));
        let mut share = R::zero();
        for _ in 0..HOLD_STEPS {
            share = left + (right - left) * excess_left / (excess_left - excess_right);
            let here = at(share);
            let still = R::zero().lt(here);
            left = R::select(still, share, left);
            excess_left = R::select(still, here, excess_left);
            right = R::select(still, right, share);
            excess_right = R::select(still, excess_right, here);
        }
        let inside = R::zero().le(share).and(share.le(R::one()));
        R::select(inside, share, R::zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::Parameters;

    /// A pendulum that moves by θ = 0.2 + 0.3·t − 0.2·t² + 0.4·t³ within a step of 0.1 s from 7 s on.
    fn share_until(excess: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let model = Model::new(&Parameters::<f64>::paper());
        let state = State { time_s: 7.0, ..model.release(0.2, 0.3) };
        let end = Phase { angle: 0.2284, velocity: 0.272 };
        model.share_until_held(&state, end, 0.1, excess)
    }

    #[test]
    fn the_share_of_a_step_is_sought_by_angle_velocity_and_time() {
        let angle = |t: f64| 0.2 + 0.3 * t - 0.2 * t * t + 0.4 * t * t * t;
        for share in [0.2, 0.5, 0.9] {
            let by_angle = share_until(|theta, _, _| 1e-3 * (angle(0.1 * share) - theta));
            assert!((by_angle - share).abs() < 1e-4, "{share}: {by_angle}");
            // Between the ends the velocity goes along a straight line.
            let by_velocity = share_until(|_, omega, _| omega - (0.3 - 0.028 * share));
            let by_time = share_until(|_, _, time_s| 7.0 + 0.1 * share - time_s);
            assert!((by_velocity - share).abs() < 1e-12 && (by_time - share).abs() < 1e-12, "{share}");
        }
    }
}
