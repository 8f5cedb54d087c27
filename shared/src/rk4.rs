//! The classical fourth-order Runge–Kutta step (paper, Eqs 4–13), and where within it a velocity is reached.

use crate::real::{Mask, Real};

/// Angle in rad and velocity in rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Phase<R> {
    pub(crate) angle: R,
    pub(crate) velocity: R,
}

impl<R: Real> Phase<R> {
    pub(crate) fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        let (angle, velocity) = (R::select(mask, yes.angle, no.angle), R::select(mask, yes.velocity, no.velocity));
        Self { angle, velocity }
    }
}

/// What is integrated: ω' at an angle, a velocity and a time.
pub(crate) trait Law<R> {
    fn acceleration(&self, angle: R, velocity: R, time: R) -> R;
}

impl<R, F: Fn(R, R, R) -> R> Law<R> for F {
    #[inline(always)]
    fn acceleration(&self, angle: R, velocity: R, time: R) -> R {
        self(angle, velocity, time)
    }
}

/// One step of θ' = ω, ω' = `law.acceleration(θ, ω, t)`.
#[inline(always)]
pub(crate) fn step<R: Real>(law: impl Law<R>, start: Phase<R>, time: R, dt: R) -> Phase<R> {
    let (half, sixth) = (R::of(0.5) * dt, R::of(1.0 / 6.0) * dt);
    let Phase { angle, velocity: v1 } = start;
    let a1 = law.acceleration(angle, v1, time);
    let v2 = v1 + half * a1;
    let a2 = law.acceleration(angle + half * v1, v2, time + half);
    let v3 = v1 + half * a2;
    let a3 = law.acceleration(angle + half * v2, v3, time + half);
    let v4 = v1 + dt * a3;
    let a4 = law.acceleration(angle + dt * v3, v4, time + dt);
    Phase {
        angle: angle + sixth * (v1 + (v2 + v3) + (v2 + v3) + v4),
        velocity: v1 + sixth * (a1 + (a2 + a3) + (a2 + a3) + a4),
    }
}

/// One step of θ' = ω with two numbers beside it; `slope(θ, ω, t, numbers)` gives ω' and how fast the numbers change.
#[inline(always)]
pub(crate) fn step_beside<R: Real>(
    slope: impl Fn(R, R, R, [R; 2]) -> (R, [R; 2]),
    start: Phase<R>,
    beside: [R; 2],
    time: R,
    dt: R,
) -> (Phase<R>, [R; 2]) {
    let (half, sixth) = (R::of(0.5) * dt, R::of(1.0 / 6.0) * dt);
    let moved = |rate: [R; 2], by: R| [beside[0] + by * rate[0], beside[1] + by * rate[1]];
    let mean = |a: R, b: R, c: R, d: R| sixth * (a + (b + c) + (b + c) + d);
    let Phase { angle, velocity: v1 } = start;
    let (a1, r1) = slope(angle, v1, time, beside);
    let v2 = v1 + half * a1;
    let (a2, r2) = slope(angle + half * v1, v2, time + half, moved(r1, half));
    let v3 = v1 + half * a2;
    let (a3, r3) = slope(angle + half * v2, v3, time + half, moved(r2, half));
    let v4 = v1 + dt * a3;
    let (a4, r4) = slope(angle + dt * v3, v4, time + dt, moved(r3, dt));
    let phase = Phase { angle: angle + mean(v1, v2, v3, v4), velocity: v1 + mean(a1, a2, a3, a4) };
    (phase, [0, 1].map(|i| beside[i] + mean(r1[i], r2[i], r3[i], r4[i])))
}

/// The share 0 … 1 of a step at which the velocity reaches `target`, by Newton's method on the cubic through both
/// ends (Hermite). `rise_*` are acceleration times step. Meant for steps in which it does cross.
pub(crate) fn share_until<R: Real>(v_start: R, rise_start: R, v_end: R, rise_end: R, target: R) -> R {
    let change = v_end - v_start;
    let c2 = R::of(3.0) * change - (rise_start + rise_start) - rise_end;
    let c3 = rise_start + rise_end - (change + change);
    let linear = (target - v_start) / change;
    let mut share = linear;
    for _ in 0..NEWTON_STEPS {
        let value = v_start - target + share * (rise_start + share * (c2 + share * c3));
        let slope = rise_start + share * (c2 + c2 + R::of(3.0) * share * c3);
        share = share - value / slope;
    }
    let inside = R::zero().le(share).and(share.le(R::one()));
    R::select(inside, share, linear.max(R::zero()).min(R::one()))
}

/// The cubic is nearly straight: three steps reach rounding, the fourth is spare.
const NEWTON_STEPS: usize = 4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oscillator_converges_with_the_fourth_power_of_the_step() {
        let error = |n_steps: u32| {
            let dt = 2.0 / f64::from(n_steps);
            let mut phase = Phase { angle: 1.0, velocity: 0.0 };
            for i in 0..n_steps {
                phase = step(|angle: f64, _, _| -9.0 * angle, phase, f64::from(i) * dt, dt);
            }
            (phase.angle - libm::cos(6.0)).abs()
        };
        let order = libm::log2(error(200) / error(400));
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn a_crossing_of_a_cubic_is_found_exactly() {
        // v(s) = 1 − 2s − s³/10, as straight as velocities within a step are, crosses 0.5 where 2s + s³/10 = 0.5.
        let share = share_until(1.0, -2.0, -1.1, -2.3, 0.5_f64);
        assert!((2.0 * share + 0.1 * share * share * share - 0.5).abs() < 1e-15);
    }
}
