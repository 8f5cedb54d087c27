//! The observer: runs the model beside the pendulum, corrects it a little by each measurement, and tells how well the
//! model still fits.
//!
//! Luenberger form, corrected once a sample: θ += (1 − p²)·e, ω += (1 − p)²/Δt·e with p = 1/(1 + b·Δt), where b is the
//! bandwidth and the innovation e the measured minus the predicted angle, neither of them filtered. An error dies away by
//! p from sample to sample, as e^(−b·t) where these are close, however far apart they are. Source: G. F. Franklin,
//! J. D. Powell, M. L. Workman, Digital Control of Dynamic Systems, 3rd ed. (1998), section 8.2, with both poles at p. The
//! gains 2·b·Δt and b²·Δt of continuous time, which these are for short steps, would be unstable from b·Δt = 0.83 on.
//!
//! About rest, where the pendulum swings with ω₀, the observer's poles are −b ± i·ω₀: on its way out the error swings as
//! the pendulum does. (Where gravity gives no stiffness, at 90°, both lie at −b.) Two real poles would need a gain
//! b² − ω₀² that is negative at a low bandwidth and would push the velocity the wrong way. Keep the bandwidth low, about
//! 3 rad/s: at 100 rad/s right and wrong parameters give the same innovation.

use crate::model::{Model, SensorState, State};
use crate::parameters::Parameters;
use crate::real::{Mask, Real};

/// The innovation's running mean square forgets with this time constant.
const FORGETTING_S: f64 = 2.0;

/// A measured angle that stays within so many rad …
const MOVED_RAD: f64 = 5e-3;

/// … for so long is that of a pendulum that somebody holds or that hangs: its next swing begins at time zero. Around a
/// turning point at 0.1 rad the angle stays for a quarter of that.
const HELD_S: f64 = 0.4;

/// The model's longest step, over a gap and between two samples: of 20 ms, as at 50 Hz, it takes two.
const LONGEST_STEP_S: f64 = 0.01;

/// A step that is longer by what rounding adds is one step.
const ROUNDING: f64 = 1.0 + 1e-6;

/// Over a gap the model goes on alone for so long. After more than that nobody knows where the pendulum is, and the next
/// measurement begins anew.
const LONGEST_GAP_S: f64 = 5.0;

/// A model that is further from the measurement than this (rad), or faster (rad/s), has run away: its parameters are of
/// no pendulum. It begins anew, so that good parameters find it well.
const LOST: f64 = 1e4;

/// What the observer says after a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<R> {
    /// θ in rad.
    pub angle_rad: R,
    /// ω in rad/s.
    pub velocity_rad_s: R,
    /// Friction and added effects, N·m.
    pub friction_nm: R,
    /// Measured minus predicted angle, rad.
    pub innovation_rad: R,
}

/// A model that follows a measurement.
#[derive(Clone)]
pub struct Observer<R: 'static> {
    model: Model<R>,
    state: State<R>,
    sensor: SensorState<R>,
    bandwidth_rad_s: R,
    mean_square: R,
    started: bool,
    /// How long there has been no measurement, s.
    gap_s: R,
    since_release: SinceRelease<R>,
}

/// Counts samples since the release: sums of seconds would drift in `f32`.
#[derive(Clone, Copy)]
struct SinceRelease<R> {
    n_samples: u32,
    gaps_s: R,
    anchor_rad: R,
    n_still: u32,
}

impl<R: Real> SinceRelease<R> {
    fn at(angle_rad: R) -> Self {
        Self { n_samples: 0, gaps_s: R::zero(), anchor_rad: angle_rad, n_still: 0 }
    }

    /// Takes the next measured angle, gives the seconds since the release.
    fn after(&mut self, measured_rad: R, dt_s: R) -> R {
        if R::of(MOVED_RAD).lt((measured_rad - self.anchor_rad).abs()).any() {
            (self.anchor_rad, self.n_still) = (measured_rad, 0);
        }
        self.n_still = self.n_still.saturating_add(1);
        self.n_samples = self.n_samples.saturating_add(1);
        if R::of(HELD_S).lt(R::of(f64::from(self.n_still)) * dt_s).any() {
            (self.n_samples, self.gaps_s) = (0, R::zero());
        }
        self.gaps_s + R::of(f64::from(self.n_samples)) * dt_s
    }
}

impl<R: Real> Observer<R> {
    /// Bandwidth in rad/s; zero lets the model run alone. It starts with the first measurement.
    pub fn new(parameters: &Parameters<R>, bandwidth_rad_s: R) -> Self {
        let zero = R::zero();
        let mut observer = Self {
            model: Model::empty(zero),
            state: State::all(zero),
            sensor: SensorState::all(zero),
            bandwidth_rad_s,
            mean_square: zero,
            started: false,
            gap_s: zero,
            since_release: SinceRelease::at(zero),
        };
        observer.set_parameters(parameters);
        observer
    }

    /// Other parameters, the same state: nothing jumps while the pendulum swings.
    pub fn set_parameters(&mut self, parameters: &Parameters<R>) {
        self.model.renew(parameters);
        let mut fresh = self.model.release(self.state.angle_rad, self.state.velocity_rad_s);
        fresh.time_s = self.state.time_s;
        self.sensor = self.model.sensor_at_rest(&fresh);
        self.state = fresh;
    }

    /// Bandwidth in rad/s.
    pub fn set_bandwidth(&mut self, bandwidth_rad_s: R) {
        self.bandwidth_rad_s = bandwidth_rad_s;
    }

    /// Starts anew at a known angle (rad) and velocity (rad/s), time zero.
    pub fn start_at(&mut self, angle_rad: R, velocity_rad_s: R) {
        self.state = self.model.release(angle_rad, velocity_rad_s);
        self.sensor = self.model.sensor_at_rest(&self.state);
        self.mean_square = R::zero();
        self.since_release = SinceRelease::at(angle_rad);
        self.started = true;
    }

    /// What is measured means something else from now on: the next measurement begins anew.
    pub fn begin_anew(&mut self) {
        self.started = false;
    }

    /// Takes a measured angle (rad), `dt_s` after the one before. The first one only sets the state; one that is no
    /// number counts as a gap.
    pub fn on_measurement(&mut self, measured_rad: R, dt_s: R) -> Estimate<R> {
        if !measured_rad.abs().lt(R::of(LOST)).all() {
            return self.on_gap(dt_s);
        }
        self.gap_s = R::zero();
        if self.started {
            self.advance(dt_s);
            self.state.time_s = self.since_release.after(measured_rad, dt_s);
        } else {
            self.start_at(measured_rad, R::zero());
        }
        let mut innovation = measured_rad - self.model.read(&self.state, &mut self.sensor);
        if self.is_lost(innovation) {
            self.start_at(measured_rad, R::zero());
            innovation = measured_rad - self.model.read(&self.state, &mut self.sensor);
        }
        self.correct(innovation, dt_s);
        let forget = (dt_s * R::of(1.0 / FORGETTING_S)).min(R::one());
        self.mean_square = self.mean_square + forget * (innovation * innovation - self.mean_square);
        self.estimate(innovation)
    }

    /// Lets `dt_s` pass without a usable measurement.
    pub fn on_gap(&mut self, dt_s: R) -> Estimate<R> {
        self.gap_s = self.gap_s + dt_s;
        // Not a number fails the comparison too.
        self.started &= self.gap_s.lt(R::of(LONGEST_GAP_S)).all();
        if self.started {
            self.advance(dt_s);
            self.since_release.gaps_s = self.since_release.gaps_s + dt_s;
        }
        if self.is_lost(R::zero()) {
            self.state = self.model.release(R::zero(), R::zero());
            self.started = false;
        }
        self.estimate(R::zero())
    }

    fn advance(&mut self, dt_s: R) {
        let mut left_s = dt_s;
        // A step of absurd length is one step to nowhere, not many.
        while R::of(LONGEST_STEP_S * ROUNDING).lt(left_s).any() && left_s.lt(R::of(LONGEST_GAP_S)).all() {
            self.model.step(&mut self.state, R::of(LONGEST_STEP_S));
            left_s = left_s - R::of(LONGEST_STEP_S);
        }
        if R::zero().lt(left_s).any() {
            self.model.step(&mut self.state, left_s);
        }
    }

    fn is_lost(&self, innovation_rad: R) -> bool {
        let limit = R::of(LOST);
        let State { angle_rad, velocity_rad_s, .. } = self.state;
        let numbers = [innovation_rad, angle_rad, velocity_rad_s];
        !numbers.iter().all(|number| number.abs().lt(limit).all())
    }

    fn correct(&mut self, innovation: R, dt_s: R) {
        let b = self.bandwidth_rad_s;
        if !R::zero().lt(b).any() {
            return;
        }
        let pole = R::one() / (R::one() + b * dt_s);
        let toward = b * pole * innovation;
        self.state.angle_rad = self.state.angle_rad + dt_s * (R::one() + pole) * toward;
        self.state.velocity_rad_s = self.state.velocity_rad_s + b * dt_s * pole * toward;
        self.model.reconsider(&mut self.state);
    }

    fn estimate(&self, innovation_rad: R) -> Estimate<R> {
        // A law of absurd numbers may have no value at some speed; whoever draws it needs one.
        let friction_nm = self.model.friction_torque_nm(&self.state);
        let has_value = friction_nm.abs().lt(R::of(LOST));
        Estimate {
            angle_rad: self.state.angle_rad,
            velocity_rad_s: self.state.velocity_rad_s,
            friction_nm: R::select(has_value, friction_nm, R::zero()),
            innovation_rad,
        }
    }

    /// Root mean square of the innovation over the last few seconds, rad: near the noise, the model fits.
    pub fn innovation_rms_rad(&self) -> R {
        self.mean_square.max(R::zero()).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 1e-3;

    /// Innovation over the last 8 of 10 s of a swing of `truth`, observed with `assumed`.
    fn innovation_rms(truth: &Parameters<f64>, assumed: &Parameters<f64>, bandwidth_rad_s: f64) -> f64 {
        let plant = Model::new(truth);
        let mut swing = plant.release(1.0, 0.0);
        let mut observer = Observer::new(assumed, bandwidth_rad_s);
        let mut sum = 0.0;
        for i in 0..10_000 {
            let estimate = observer.on_measurement(swing.angle_rad, DT_S);
            sum += if i >= 2000 { estimate.innovation_rad * estimate.innovation_rad } else { 0.0 };
            plant.step(&mut swing, DT_S);
        }
        libm::sqrt(sum / 8000.0)
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn the_right_model_leaves_no_innovation() {
        let truth = Parameters::paper();
        assert!(innovation_rms(&truth, &truth, 3.0) < 1e-12);
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn a_wrong_model_shows_at_low_bandwidth_and_hides_at_high() {
        let truth = Parameters::paper();
        let mut wrong = truth.clone();
        wrong.pendulum.inertia_kg_m2 *= 1.05;
        let (low, high) = (innovation_rms(&truth, &wrong, 3.0), innovation_rms(&truth, &wrong, 100.0));
        assert!(low > 5e-3 && high < 0.1 * low, "{low} {high}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn time_counts_from_the_release_however_long_it_was_held_before() {
        let truth = Parameters::paper().map(|value| value as f32);
        let model = Model::new(&truth);
        let mut swing = model.release(1.0, 0.0);
        let mut observer = Observer::<f32>::new(&truth, 3.0);
        (0..300_000).for_each(|_| {
            observer.on_measurement(1.0, 1e-3);
        });
        (0..30_000).for_each(|_| {
            model.step(&mut swing, 1e-3);
            observer.on_measurement(swing.angle_rad, 1e-3);
        });
        observer.on_gap(2.0);
        observer.on_measurement(swing.angle_rad, 1e-3);
        let time_s = observer.state.time_s;
        assert!((time_s - 32.0).abs() < 0.03, "{time_s}");
    }

    /// An hour of streaming is no hour of drift: time begins anew where the pendulum hangs.
    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn a_zero_that_drifts_does_so_from_the_release_however_long_the_rig_hung() {
        let (mut truth, dt_s, drift) = (Parameters::paper(), 1e-2, 2e-3);
        let effects = crate::effect::Effect::<f64>::ALL.iter();
        let id = effects.filter(|effect| effect.name == "zero-drift").map(|effect| effect.id).next().unwrap();
        truth.set(id, &[drift]).unwrap();
        let model = Model::new(&truth);
        let mut observer = Observer::new(&truth, 3.0);
        (0..360_000).for_each(|_| assert!(observer.on_measurement(0.0, dt_s).innovation_rad.abs() < 1e-9 + drift));
        let mut swing = model.release(1.0, 0.0);
        (0..3000).for_each(|_| {
            observer.on_measurement(swing.angle_rad + drift * swing.time_s, dt_s);
            model.step(&mut swing, dt_s);
        });
        assert!(observer.innovation_rms_rad() < 2e-3, "{}", observer.innovation_rms_rad());
    }

    /// An error of the state swings with the pendulum's own frequency and dies away with the bandwidth.
    #[test]
    fn its_poles_are_where_the_documentation_says() {
        let truth = Parameters::frictionless(crate::motion::Pendulum::paper());
        let own_rad_s = libm::sqrt(truth.pendulum.gravity_torque_nm() / truth.pendulum.pivot_inertia_kg_m2());
        for (bandwidth_rad_s, dt_s) in [(1.0, 1e-4), (3.0, 1e-4), (3.0, 1e-3)] {
            let mut observer = Observer::new(&truth, bandwidth_rad_s);
            observer.start_at(1e-3, 0.0);
            // Measured at rest, what the observer has is its error.
            let errors: std::vec::Vec<f64> =
                (0..(4.0 / dt_s) as usize).map(|_| observer.on_measurement(0.0, dt_s).angle_rad).collect();
            // Between two zeros of the same direction lies a period.
            let falls = |i: &usize| errors[i - 1] > 0.0 && errors[*i] <= 0.0;
            let zeros: std::vec::Vec<usize> = (1..errors.len()).filter(falls).collect();
            let period_s = (zeros[1] - zeros[0]) as f64 * dt_s;
            assert!((period_s * own_rad_s / core::f64::consts::TAU - 1.0).abs() < 0.01, "{period_s} s");
            let top = |i: usize| errors[i..i + (period_s / dt_s) as usize].iter().copied().fold(0.0, f64::max);
            let decay = libm::log(top(zeros[0]) / top(zeros[1])) / period_s;
            // The correction once a step is of first order in the step: 1 % at b·Δt = 0.003.
            assert!((decay / bandwidth_rad_s - 1.0).abs() < 0.02, "{decay} instead of {bandwidth_rad_s} 1/s");
        }
    }

    /// At 50 Hz the model still takes steps of 10 ms.
    #[test]
    fn a_slow_rate_gives_the_same_estimate_as_a_fast_one() {
        let truth = Parameters::paper();
        let model = Model::new(&truth);
        let mut swing = model.release(1.0, 0.0);
        let (mut slow, mut fast) = (Observer::new(&truth, 0.0), Observer::new(&truth, 0.0));
        slow.start_at(1.0, 0.0);
        fast.start_at(1.0, 0.0);
        for i in 0..1000 {
            model.step(&mut swing, 0.01);
            fast.on_measurement(swing.angle_rad, 0.01);
            if i % 2 == 1 {
                slow.on_measurement(swing.angle_rad, 0.02);
            }
        }
        assert_eq!(slow.state.angle_rad, fast.state.angle_rad);
    }

    #[test]
    fn without_bandwidth_it_is_the_model_alone() {
        let truth = Parameters::paper();
        let mut observer = Observer::new(&truth, 0.0);
        observer.start_at(1.0, 0.0);
        let model = Model::new(&truth);
        let mut state = model.release(1.0, 0.0);
        for _ in 0..1000 {
            let estimate = observer.on_measurement(0.3, DT_S);
            model.step(&mut state, DT_S);
            assert_eq!(estimate.angle_rad, state.angle_rad);
        }
    }
}
