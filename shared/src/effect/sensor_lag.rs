//! Sensor lag: the reading follows the angle late, as behind a capacitor.
//! Source: E. O. Doebelin, Measurement Systems (McGraw-Hill, 1966): first-order instruments.
//!
//! τ·dy/dt = u − y, exact for an angle u that moves evenly between two samples:
//! y₁ = u₁ − r·τ + (y₀ − u₀ + r·τ)·exp(−Δt/τ) with r = (u₁ − u₀)/Δt.
//!
//! A recording may begin when the pendulum moves already. A release from rest with an even acceleration a is then
//! taken to lie behind it: u − y = τ·ω − a·τ²·(1 − exp(−ω/(a·τ))).

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 33,
        name: "sensor-lag",
        summary: "The reading runs behind the pendulum, as through a filter that nobody told of.",
        formula: "tau*d(reading)/dt = theta - reading",
        source: "E. O. Doebelin, Measurement Systems (McGraw-Hill, 1966): first-order instruments",
        experiment: "A release from rest: the reading starts late; afterwards only a small change of shape is left of it.",
        parameters: &[Parameter {
            symbol: "tau",
            unit: "s",
            low: 0.0,
            high: 0.2,
            start: 0.0,
            meaning: prose!("time by which the reading is late"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0], [5e-3, 0.0, 0.0, 0.0], [2e-2, 0.0, 0.0, 0.0]],
        family: Family::Reading,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Sensor(Sensor { start, read }),
    }
}

/// Memory: the reading, the angle and the time of the last sample.
fn start<R: Real>(input_rad: R, motion: &Motion<R>, values: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [input_rad - behind_after_release(motion, values[0]), input_rad, motion.time_s]
}

/// How far the reading lags behind some time after a release from rest, in rad.
fn behind_after_release<R: Real>(motion: &Motion<R>, lag_s: R) -> R {
    let pendulum = &motion.pendulum;
    let acceleration = -pendulum.gravity_torque_nm() * motion.angle_rad.sin() / pendulum.pivot_inertia_kg_m2();
    let gained = acceleration * lag_s;
    // On its way up, the pendulum was let go more than a quarter of a swing ago.
    let rises = (gained * motion.velocity_rad_s).lt(R::zero());
    let falls = R::zero().lt(gained.abs());
    let passed = motion.velocity_rad_s / R::select(falls, gained, R::one());
    let fading = R::select(rises, R::zero(), (-passed.abs()).exp());
    lag_s * (motion.velocity_rad_s - gained * (R::one() - fading))
}

fn read<R: Real>(input_rad: R, motion: &Motion<R>, memory: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    let [reading_before, input_before, time_before] = *memory;
    let passed_s = motion.time_s - time_before;
    let (passes, lags) = (R::zero().lt(passed_s), R::zero().lt(values[0]));
    // Divisors that are zero in a lane whose result is not used.
    let interval_s = R::select(passes, passed_s, R::one());
    let lag_s = R::select(lags, values[0], R::one());
    let behind = (input_rad - input_before) / interval_s * values[0];
    let fading = R::select(lags, (-passed_s / lag_s).exp(), R::zero());
    let reached = input_rad - behind + (reading_before - input_before + behind) * fading;
    let reading = R::select(passes, reached, R::select(lags, reading_before, input_rad));
    *memory = [reading, input_rad, motion.time_s];
    reading
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::tests_support::motion_at;

    /// Readings of an angle that moves at 2 rad/s, with a lag of 10 ms.
    fn readings(interval_s: f64, n_samples: u32) -> f64 {
        let values = [0.01, 0.0, 0.0, 0.0];
        let mut memory = start(0.0, &motion_at(0.0, 0.0, 0.0), &values);
        let sample = |i: u32| {
            let time = f64::from(i) * interval_s;
            read(2.0 * time, &motion_at(2.0 * time, 2.0, time), &mut memory, &values)
        };
        (0..=n_samples).map(sample).last().unwrap()
    }

    #[test]
    fn even_motion_is_exact_whatever_the_sampling() {
        let exact = 2.0 * (0.02 - 0.01 * (1.0 - libm::exp(-2.0)));
        assert!((readings(0.02, 1) - exact).abs() < 1e-15);
        assert!((readings(0.001, 20) - exact).abs() < 1e-15);
    }

    #[test]
    fn a_start_in_the_middle_of_a_release_reads_as_if_it_had_begun_at_rest() {
        let values = [0.02, 0.0, 0.0, 0.0];
        // From 1 rad, with the acceleration there.
        let motion = |t: f64| motion_at(1.0 - 0.5 * A * t * t, -A * t, t);
        const A: f64 = 0.15 * 9.81 * 0.16 * 0.841_470_984_8 / (0.15 * 0.16 * 0.16 + 2.7e-3);
        let mut memory = start(1.0, &motion(0.0), &values);
        for i in 1..=300 {
            let here = motion(f64::from(i) * 1e-4);
            let reading = read(here.angle_rad, &here, &mut memory, &values);
            let fresh = start(here.angle_rad, &here, &values)[0];
            assert!((reading - fresh).abs() < 2e-4, "{i}: {reading} {fresh}");
        }
    }

    #[test]
    fn without_lag_the_reading_is_the_angle() {
        let mut memory = start(0.3, &motion_at(0.3, 0.0, 0.0), &[0.0; 4]);
        assert_eq!(read(0.3, &motion_at(0.3, 0.0, 0.0), &mut memory, &[0.0; 4]), 0.3);
        assert_eq!(read(0.5, &motion_at(0.5, 0.0, 0.1), &mut memory, &[0.0; 4]), 0.5);
    }
}
