//! A step in which the pendulum slides on: its transition by the variational equation along a cubic.
//!
//! Nearly all steps are such, and this takes a tenth of what the model takes with its derivatives from end to end. The
//! changes of acceleration by angle (a) and velocity (b) are known at the beginning, in the middle and at the end; a
//! parabola through each, δ'' = a·δ + b·δ' takes one step of Runge and Kutta.

use crate::real::Real;

/// Angle, velocity and acceleration.
#[derive(Clone, Copy)]
pub struct Point<R> {
    /// θ, rad.
    pub angle_rad: R,
    /// ω, rad/s.
    pub velocity_rad_s: R,
    /// dω/dt, rad/s².
    pub acceleration: R,
}

/// The way between two points.
pub struct Way<R> {
    /// Where it begins.
    pub from: Point<R>,
    /// Where it ends.
    pub to: Point<R>,
    /// How long it takes, s.
    pub seconds: R,
}

impl<R: Real> Way<R> {
    /// Angle and velocity at a share of it: cubics through both ends.
    pub fn at(&self, share: R) -> (R, R) {
        let (from, to) = (&self.from, &self.to);
        let angle =
            cubic([from.angle_rad, to.angle_rad], [from.velocity_rad_s, to.velocity_rad_s], self.seconds, share);
        let changes = [from.acceleration, to.acceleration];
        (angle, cubic([from.velocity_rad_s, to.velocity_rad_s], changes, self.seconds, share))
    }
}

/// Between two values, so many seconds apart, that change at these speeds: the cubic at a share of the way.
pub fn cubic<R: Real>(values: [R; 2], speeds: [R; 2], seconds: R, share: R) -> R {
    let (first, last) = (speeds[0] * seconds, speeds[1] * seconds);
    let change = values[1] - values[0];
    let c2 = R::of(3.0) * change - (first + first) - last;
    let c3 = first + last - (change + change);
    values[0] + share * (first + share * (c2 + share * c3))
}

/// How the acceleration changes by angle and velocity at the beginning, in the middle and at the end of a step.
pub struct Changes<R>(pub [[R; 2]; 3]);

impl<R: Real> Changes<R> {
    fn at(&self, share: R) -> [R; 2] {
        let [first, middle, last] = &self.0;
        let twice = share + share;
        core::array::from_fn(|i| {
            let (rise, bend) = (last[i] - first[i], first[i] + last[i] - (middle[i] + middle[i]));
            first[i] + share * (rise + (twice - R::of(2.0)) * bend)
        })
    }

    /// Where a small gain of velocity at a share of the step has come to at its end, per gain: as a series, with the
    /// changes two thirds on, where they act on what has been gained. A tenth of the work of [`Self::carry`]; torques are
    /// looked at in two places only and are no more exact.
    pub fn carry_velocity(&self, from: R, step_s: R) -> [R; 2] {
        let rest = R::one() - from;
        let seconds = rest * step_s;
        let [by_angle, by_velocity] = self.at(from + R::of(2.0 / 3.0) * rest);
        let (bend, drag) = (by_angle * seconds * seconds, by_velocity * seconds);
        let more = bend + drag * drag;
        let angle = seconds * (R::one() + R::of(0.5) * drag + R::of(1.0 / 6.0) * more);
        [angle, R::one() + drag + R::of(0.5) * more + R::of(1.0 / 6.0) * drag * (bend + more)]
    }

    /// Where a small change of angle and velocity at the beginning has come to at the end.
    #[inline(never)]
    pub fn carry(&self, step_s: R, [angle, velocity]: [R; 2]) -> [R; 2] {
        let half = R::of(0.5);
        let [begin, middle, end] = &self.0;
        let slope = |change: [R; 2], by: &[R; 2]| [change[1], by[0] * change[0] + by[1] * change[1]];
        let moved = |slope: [R; 2], seconds: R| [angle + seconds * slope[0], velocity + seconds * slope[1]];
        let k1 = slope([angle, velocity], begin);
        let k2 = slope(moved(k1, half * step_s), middle);
        let k3 = slope(moved(k2, half * step_s), middle);
        let k4 = slope(moved(k3, step_s), end);
        let sixth = step_s * R::of(1.0 / 6.0);
        let sum = |i: usize| k1[i] + k4[i] + (k2[i] + k2[i]) + (k3[i] + k3[i]);
        [angle + sixth * sum(0), velocity + sixth * sum(1)]
    }
}
