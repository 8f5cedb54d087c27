//! A friction curve: the torque against sliding as a free, smooth function F(|ω|) ≥ 0 of the speed, in place of Coulomb
//! and viscous friction.
//!
//! It is given at knots and runs through them as piecewise cubics (Hermite), whose slope at a knot is that of the
//! parabola through it and its neighbours. So F is smooth to its first derivative and linear in the torques, and a
//! straight line through the knots is a straight line between them: Mc + Mw·|ω| is a special case. Where it would fall
//! below zero it is zero; beyond the last knot it goes on straight, but never falls.
//! Source: C. de Boor, A Practical Guide to Splines (Springer 2001), chapter IV, Bessel's slopes.

use crate::effect::{Action, CURVE_ID, CURVE_NAME, Effect, Family, MAX_VALUES, Rules};
use crate::motion::Motion;
use crate::real::Real;
use heapless::Vec;

/// The most knots of a curve.
pub const MAX_KNOTS: usize = 32;

/// The effect, which is in no list: its numbers are the curve's.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: CURVE_ID,
        name: CURVE_NAME,
        summary: "Friction as a free, smooth curve of the speed, in place of viscous and coulomb.",
        formula: "torque = -F(abs(omega))*sgn(omega)",
        source: "C. de Boor, A Practical Guide to Splines (Springer 2001), chapter IV",
        experiment: "Releases from several angles, large and small, until rest.",
        parameters: &[],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Speed,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Curve,
    }
}

/// A speed in rad/s and the friction there in N·m, as they are sent and stored.
pub type Knot = [f32; 2];

/// The knots of a friction curve: as many torques as speeds, two at least, the speeds rising from zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve<R> {
    speeds_rad_s: Vec<f32, MAX_KNOTS>,
    torques_nm: Vec<R, MAX_KNOTS>,
}

impl<R: Copy> Curve<R> {
    /// Through these knots; `None` unless the speeds (rad/s) rise from zero, each has its torque (N·m), and there are
    /// from two to [`MAX_KNOTS`] of them.
    pub fn new(speeds_rad_s: &[f32], torques_nm: &[R]) -> Option<Self> {
        let rises = speeds_rad_s.windows(2).all(|pair| pair[0] < pair[1]);
        let sound = rises && speeds_rad_s.first() == Some(&0.0) && speeds_rad_s.last().is_some_and(|v| v.is_finite());
        if !sound || speeds_rad_s.len() < 2 || speeds_rad_s.len() != torques_nm.len() {
            return None;
        }
        let (speeds_rad_s, torques_nm) = (Vec::from_slice(speeds_rad_s).ok()?, Vec::from_slice(torques_nm).ok()?);
        Some(Self { speeds_rad_s, torques_nm })
    }

    /// |ω| at the knots, rad/s.
    pub fn speeds_rad_s(&self) -> &[f32] {
        &self.speeds_rad_s
    }

    /// F at the knots, N·m.
    pub fn torques_nm(&self) -> &[R] {
        &self.torques_nm
    }

    /// F at the knots, to be changed.
    pub fn torques_nm_mut(&mut self) -> &mut [R] {
        &mut self.torques_nm
    }

    /// The same knots in another number type.
    pub fn map<S: Copy>(&self, convert: impl Fn(R) -> S) -> Curve<S> {
        let torques_nm = self.torques_nm.iter().map(|torque| convert(*torque)).collect();
        Curve { speeds_rad_s: self.speeds_rad_s.clone(), torques_nm }
    }
}

impl Curve<f32> {
    /// As [`Curve::new`].
    pub fn through(knots: &[Knot]) -> Option<Self> {
        let column = |index: usize| -> Option<Vec<f32, MAX_KNOTS>> {
            let mut numbers = Vec::new();
            knots.iter().try_for_each(|knot| numbers.push(knot[index])).ok()?;
            Some(numbers)
        };
        Self::new(&column(0)?, &column(1)?)
    }

    /// What [`Curve::through`] takes.
    pub fn knots(&self) -> Vec<Knot, MAX_KNOTS> {
        self.speeds_rad_s.iter().zip(&self.torques_nm).map(|(speed, torque)| [*speed, *torque]).collect()
    }
}

/// Start of a piece in rad/s, then F as a polynomial of the speed beyond it, the constant first.
type Piece<R> = [R; 5];

/// A curve ready to run: its pieces, and the straight line beyond the last knot.
#[derive(Clone, Debug)]
pub struct Spline<R>(Vec<Piece<R>, MAX_KNOTS>);

impl<R> Spline<R> {
    /// The spline of no curve.
    pub const fn none() -> Self {
        Self(Vec::new())
    }

    /// Is it of a curve?
    pub fn is_some(&self) -> bool {
        !self.0.is_empty()
    }

    /// Becomes that of no curve.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl<R: Real> Spline<R> {
    /// Of a curve.
    pub fn new(curve: &Curve<R>) -> Self {
        let mut spline = Self::none();
        spline.follow(curve);
        spline
    }

    /// Becomes that of a curve.
    pub fn follow(&mut self, curve: &Curve<R>) {
        let (speeds, torques) = (&curve.speeds_rad_s, &curve.torques_nm);
        let last = speeds.len() - 1;
        let speed = |i: usize| R::of(f64::from(speeds[i]));
        let width = |i: usize| speed(i + 1) - speed(i);
        let rise = |i: usize| (torques[i + 1] - torques[i]) / width(i);
        let inner = |i: usize| (width(i) * rise(i - 1) + width(i - 1) * rise(i)) / (width(i - 1) + width(i));
        let slope = |i: usize| match i {
            _ if last == 1 => rise(0),
            0 => R::of(2.0) * rise(0) - inner(1),
            i if i == last => R::of(2.0) * rise(last - 1) - inner(last - 1),
            i => inner(i),
        };
        let piece = |i: usize| {
            let bend = (R::of(3.0) * rise(i) - R::of(2.0) * slope(i) - slope(i + 1)) / width(i);
            let twist = (slope(i) + slope(i + 1) - R::of(2.0) * rise(i)) / (width(i) * width(i));
            [speed(i), torques[i], slope(i), bend, twist]
        };
        let beyond = [speed(last), torques[last], slope(last).max(R::zero()), R::zero(), R::zero()];
        self.0.clear();
        self.0.extend((0..last).map(piece).chain([beyond]));
    }

    /// F at a speed in rad/s, N·m. A speed a little below zero, as within a step that turns, continues the first piece.
    pub fn torque_nm(&self, speed_rad_s: R) -> R {
        let [start, constant, slope, bend, twist] = speed_rad_s.row(&self.0);
        let beyond = speed_rad_s - start;
        (constant + beyond * (slope + beyond * (bend + beyond * twist))).max(R::zero())
    }

    /// The torque of sliding, N·m, positive counter-clockwise.
    pub fn friction_nm(&self, motion: &Motion<R>) -> R {
        -self.torque_nm(motion.velocity_rad_s * motion.direction) * motion.direction
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dual::Dual;
    use crate::effect::tests_support::motion_at;

    const SPEEDS: [f32; 5] = [0.0, 0.5, 1.25, 3.0, 4.0];

    fn spline(torques_nm: [f64; 5]) -> Spline<f64> {
        Spline::new(&Curve::new(&SPEEDS, &torques_nm).unwrap())
    }

    #[test]
    fn it_passes_through_its_knots_and_is_smooth_there() {
        let torques = [3e-3, 1e-3, 2e-3, 2.5e-3, 6e-3];
        let spline = spline(torques);
        for (speed, torque) in SPEEDS.map(f64::from).into_iter().zip(torques) {
            assert!((spline.torque_nm(speed) - torque).abs() < 1e-17, "at {speed}");
            let slope = |from: f64, to: f64| (spline.torque_nm(to) - spline.torque_nm(from)) / (to - from);
            let (before, after) = (slope(speed - 1e-6, speed), slope(speed, speed + 1e-6));
            assert!((before - after).abs() < 1e-7, "at {speed}: {before} {after}");
        }
    }

    #[test]
    fn coulomb_and_viscous_friction_are_a_straight_curve() {
        let base = |speed: f64| 7e-4 + 5e-4 * speed;
        let spline = spline(SPEEDS.map(|speed| base(f64::from(speed))));
        for k in -2..60 {
            let speed = 0.1 * f64::from(k);
            assert!((spline.torque_nm(speed) - base(speed)).abs() < 1e-16, "at {speed}");
        }
    }

    #[test]
    fn a_parabola_is_met_exactly_between_the_knots() {
        let parabola = |speed: f64| 1e-3 + 2e-4 * speed * speed;
        let spline = spline(SPEEDS.map(|speed| parabola(f64::from(speed))));
        assert!((0..40).all(|k| {
            let speed = 0.1 * f64::from(k);
            (spline.torque_nm(speed) - parabola(speed)).abs() < 1e-16
        }));
    }

    #[test]
    fn it_drives_nothing_and_never_falls_beyond_the_last_knot() {
        let dip = spline([1e-3, 0.0, 0.0, 4e-3, 0.0]);
        assert!((0..800).all(|k| dip.torque_nm(0.01 * f64::from(k)) >= 0.0));
        assert_eq!(dip.torque_nm(0.8), 0.0, "it would overshoot below zero there");
        assert_eq!(dip.torque_nm(9.0), 0.0);
        let falling = spline([5e-3, 4e-3, 3e-3, 2e-3, 1e-3]);
        assert_eq!(falling.torque_nm(9.0), 1e-3);
    }

    #[test]
    fn it_opposes_sliding_either_way() {
        let spline = spline([1e-3, 2e-3, 3e-3, 4e-3, 5e-3]);
        assert!((spline.friction_nm(&motion_at(0.3, 3.0, 0.0)) + 4e-3).abs() < 1e-17);
        assert!((spline.friction_nm(&motion_at(0.3, -3.0, 0.0)) - 4e-3).abs() < 1e-17);
        assert_eq!(spline.friction_nm(&motion_at(0.3, 0.0, 0.0)), 0.0);
    }

    /// The curve and Stribeck friction act at once in the new direction; what presliding holds of Coulomb friction
    /// turns round over zc.
    #[test]
    fn presliding_stacks_on_a_curve_and_on_stribeck() {
        use crate::model::Model;
        use crate::parameters::Parameters;
        const CURVE: f64 = 1e-3;
        const STRIBECK: f64 = 3e-4;
        const BUILDS_UP: f64 = 5e-4;
        const RANGE: f64 = 0.05;
        let mut parameters = Parameters::frictionless(motion_at(0.0, 0.0, 0.0).pendulum);
        parameters.set_curve(&Curve::new(&SPEEDS, &[CURVE; 5]).unwrap()).unwrap();
        parameters.set(Effect::<f64>::by_name("stribeck").unwrap().id, &[STRIBECK, 1e6]).unwrap();
        parameters.set(Effect::<f64>::by_name("presliding").unwrap().id, &[BUILDS_UP, RANGE]).unwrap();
        let model = Model::new(&parameters);
        let mut state = model.release(1.0, 0.0);
        let mut turned_rad = None;
        for _ in 0..1200 {
            model.step(&mut state, 1e-3);
            let torque = model.friction_torque_nm(&state);
            if state.velocity_rad_s < 0.0 && state.angle_rad < 0.0 {
                assert!((torque - (CURVE + STRIBECK + BUILDS_UP)).abs() < 1e-9, "{torque} at {}", state.angle_rad);
            }
            if state.velocity_rad_s > 0.0 {
                let path = state.angle_rad - *turned_rad.get_or_insert(state.angle_rad);
                let bristle = BUILDS_UP * (1.0 - 2.0 * libm::exp(-path / RANGE));
                assert!((torque + CURVE + STRIBECK + bristle).abs() < 2e-6, "{torque} after {path}");
            }
        }
        assert!(turned_rad.is_some_and(|angle| angle < -0.5), "it swung back");
    }

    #[test]
    fn its_derivative_by_a_torque_is_that_of_the_difference() {
        let torques = [3e-3, 1e-3, 2e-3, 2.5e-3, 6e-3];
        let at = |change: f64| {
            let mut moved = torques;
            moved[2] += change;
            spline(moved).torque_nm(1.0)
        };
        let duals = core::array::from_fn::<_, 5, _>(|i| match i {
            2 => Dual::<f64, 1>::variable(torques[2], 0),
            i => Dual::constant(torques[i]),
        });
        let dual = Spline::new(&Curve::new(&SPEEDS, &duals).unwrap()).torque_nm(Dual::constant(1.0));
        assert!((dual.slopes[0] - (at(1e-4) - at(-1e-4)) / 2e-4).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        let refused = |speeds: &[f32], torques: &[f64]| assert_eq!(Curve::new(speeds, torques), None, "{speeds:?}");
        refused(&[], &[]);
        refused(&[0.0], &[1.0]);
        refused(&[0.1, 1.0], &[1.0, 1.0]);
        refused(&[0.0, 1.0], &[1.0]);
        refused(&[0.0, 1.0, 1.0], &[1.0; 3]);
        refused(&[0.0, f32::NAN], &[1.0; 2]);
        refused(&[0.0, f32::INFINITY], &[1.0; 2]);
        let many: std::vec::Vec<f32> = (0..=MAX_KNOTS).map(|i| i as f32).collect();
        refused(&many, &[1.0; MAX_KNOTS + 1]);
        assert!(Curve::new(&many[..MAX_KNOTS], &[1.0; MAX_KNOTS]).is_some());
    }
}
