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
        let cubic = |value: [R; 2], slope: [R; 2]| {
            let (first, last) = (slope[0] * self.seconds, slope[1] * self.seconds);
            let change = value[1] - value[0];
            let c2 = R::of(3.0) * change - (first + first) - last;
            let c3 = first + last - (change + change);
            value[0] + share * (first + share * (c2 + share * c3))
        };
        let angle = cubic([from.angle_rad, to.angle_rad], [from.velocity_rad_s, to.velocity_rad_s]);
        (angle, cubic([from.velocity_rad_s, to.velocity_rad_s], [from.acceleration, to.acceleration]))
    }
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

    /// Where a small change of angle and velocity at a share of the step has come to at its end.
    pub fn carry(&self, from: R, step_s: R, [angle, velocity]: [R; 2]) -> [R; 2] {
        let (half, rest) = (R::of(0.5), R::one() - from);
        let seconds = rest * step_s;
        let [begin, middle, end] = [from, from + half * rest, R::one()].map(|share| self.at(share));
        let slope = |change: [R; 2], by: [R; 2]| [change[1], by[0] * change[0] + by[1] * change[1]];
        let moved =
            |slope: [R; 2], share: R| [angle + share * seconds * slope[0], velocity + share * seconds * slope[1]];
        let k1 = slope([angle, velocity], begin);
        let k2 = slope(moved(k1, half), middle);
        let k3 = slope(moved(k2, half), middle);
        let k4 = slope(moved(k3, R::one()), end);
        let sixth = seconds / R::of(6.0);
        let sum = |i: usize| k1[i] + k4[i] + (k2[i] + k2[i]) + (k3[i] + k3[i]);
        [angle + sixth * sum(0), velocity + sixth * sum(1)]
    }
}
