//! How far ahead does the model see? Free run, one swing ahead, one step ahead: a wrong start spoils only the first,
//! wrong physics the first two; the third shows what the noise is like.

use super::follow::Followed;
use super::restart::Restart;
use super::rms;
use crate::recording::Measured;
use crate::swing::Swing;
use serde::Serialize;
use shared::observer::Observer;
use shared::parameters::Parameters;

/// Bandwidth of the observer that predicts one step, rad/s.
const BANDWIDTH_RAD_S: f64 = 10.0;

/// The observer settles for so long first, s.
const SETTLING_S: f64 = 1.0;

/// Root mean square errors, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Predictions {
    /// The whole swing from its start.
    pub free_run_rad: f64,
    /// A swing from the state at the end of the one before; absent with fewer than two swings.
    pub swing_ahead_rad: Option<f64>,
    /// A sample from the samples before; absent for rates.
    pub step_ahead_rad: Option<f64>,
}

/// The three errors of one recording.
pub fn predictions(
    swing: &Swing,
    followed: &Followed,
    restarts: &[Restart],
    parameters: &Parameters<f64>,
) -> Predictions {
    let ahead: Vec<f64> = restarts.iter().flat_map(|restart| restart.ahead_rad.iter().copied()).collect();
    // The rig's observer takes angles.
    let is_angle = swing.measured == Measured::Angle;
    let steps = if is_angle { innovations(swing, followed, parameters) } else { Vec::new() };
    let some = |errors: &[f64]| (!errors.is_empty()).then(|| rms(errors));
    Predictions {
        free_run_rad: rms(&followed.residuals_rad),
        swing_ahead_rad: some(&ahead),
        step_ahead_rad: some(&steps),
    }
}

/// Errors of the observer that follows the swing.
fn innovations(swing: &Swing, followed: &Followed, parameters: &Parameters<f64>) -> Vec<f64> {
    let mut observer = Observer::new(parameters, BANDWIDTH_RAD_S);
    let start = followed.start;
    observer.start_at(start.angle_rad, start.velocity_rad_s);
    let mut errors = Vec::with_capacity(swing.len());
    for i in 1..swing.len() {
        let dt_s = swing.times_s[i] - swing.times_s[i - 1];
        let estimate = observer.on_measurement(swing.angles_rad[i] - start.offset_rad, dt_s);
        if swing.times_s[i] > SETTLING_S {
            errors.push(estimate.innovation_rad);
        }
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::follow::follow;
    use crate::compare::tests::{VISCOUS, rig, swing};

    /// One step ahead of a swing without noise about a zero that is off, followed from a velocity that is off too, rad.
    fn step_ahead_rad(velocity_rad_s: f64) -> f64 {
        let (swing, rig) = (swing("one", 0.0, 1), rig(VISCOUS));
        let mut followed = follow(&swing, &rig);
        followed.start.velocity_rad_s += velocity_rad_s;
        rms(&innovations(&swing, &followed, &rig))
    }

    #[test]
    fn the_true_model_sees_one_step_ahead_about_the_zero_that_was_found() {
        assert!(step_ahead_rad(0.0) < 1e-6, "{}", step_ahead_rad(0.0));
    }

    #[test]
    fn a_second_after_the_start_the_observer_has_forgotten_it() {
        // A sample of 5 ms at 0.1 rad/s is 0.5 mrad; ten seconds of its time are e^-10 of that.
        assert!(step_ahead_rad(0.1) < 1e-5, "{}", step_ahead_rad(0.1));
    }

    /// A swing of the paper's pendulum, frictionless and small, read so many times a second.
    fn step_ahead_at(rate_hz: f64) -> f64 {
        let parameters = Parameters::frictionless(Parameters::paper().pendulum);
        let pendulum = &parameters.pendulum;
        let frequency_rad_s = (pendulum.gravity_torque_nm() / pendulum.pivot_inertia_kg_m2()).sqrt();
        let times_s: Vec<f64> = (0..(20.0 * rate_hz) as u32).map(|k| f64::from(k) / rate_hz).collect();
        let angle = |(k, t): (usize, &f64)| 0.05 * (frequency_rad_s * t).cos() + 1e-4 * [1.0, -0.6, 0.2, -0.9][k % 4];
        let angles_rad: Vec<f64> = times_s.iter().enumerate().map(angle).collect();
        let swing = Swing::new("swing.csv", &times_s, &angles_rad, 1e-4);
        let followed = follow(&swing, &parameters);
        predictions(&swing, &followed, &[], &parameters).step_ahead_rad.unwrap()
    }

    /// It is off by little more than the noise (0.075 mrad rms), however few they are.
    #[test]
    fn the_observer_follows_few_readings_a_second_as_it_follows_many() {
        for rate_hz in [200.0, 25.0, 12.0, 6.0] {
            let step_rad = step_ahead_at(rate_hz);
            assert!((5e-5..2e-4).contains(&step_rad), "{rate_hz}: {step_rad}");
        }
    }
}
