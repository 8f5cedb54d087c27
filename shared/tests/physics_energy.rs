//! Without an input the pendulum only loses energy.
//!
//! One exception belongs to the Karnopp rule itself: inside the velocity band friction acts against the drive, not
//! against the motion, so that a pendulum creeping up to its turning point is helped on by at most (breakaway torque) ×
//! (angle covered inside the band). What it gains there it loses on the way back. So a band is judged from turning
//! point to turning point, and every single step only without one.

use proptest::prelude::*;
use shared::model::Model;
use shared::parameters::Parameters;

/// The fixed step's own error in a step's energy: 1e-12 of m·g·l at ω = 10 rad/s, and rounding.
const STEP_ERROR_J: f64 = 3e-12;

fn rig(viscous: f64, coulomb: f64, stiction: f64, band: f64) -> Model<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(viscous, coulomb, stiction, band);
    Model::new(&parameters)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_step_without_a_band_loses_energy(
        viscous in 0.0..2e-3, coulomb in 0.0..5e-3, stiction in 0.0..1e-2,
        angle in -3.1..3.1, velocity in -15.0..15.0,
    ) {
        let model = rig(viscous, coulomb, stiction, 0.0);
        let mut state = model.release(angle, velocity);
        let mut energy = model.energy_j(&state);
        for _ in 0..5000 {
            model.step(&mut state, 1e-3);
            let after = model.energy_j(&state);
            prop_assert!(after <= energy + STEP_ERROR_J, "grew by {:e} J", after - energy);
            energy = after;
        }
    }

    #[test]
    fn every_step_outside_the_band_loses_energy(
        viscous in 0.0..2e-3, coulomb in 0.0..5e-3, stiction in 0.0..1e-2, band in 1e-3..0.2,
        angle in -3.1..3.1, velocity in -15.0..15.0,
    ) {
        let model = rig(viscous, coulomb, stiction, band);
        let mut state = model.release(angle, velocity);
        for _ in 0..5000 {
            let (energy, was_sliding) = (model.energy_j(&state), state.contact.is_sliding());
            let before = state.velocity_rad_s;
            model.step(&mut state, 1e-3);
            let stayed = was_sliding && state.contact.is_sliding() && before * state.velocity_rad_s > 0.0;
            let grown = model.energy_j(&state) - energy;
            prop_assert!(!stayed || grown <= STEP_ERROR_J, "grew by {grown:e} J");
        }
    }

    #[test]
    fn each_turning_point_lies_lower_than_the_last(
        viscous in 1e-4..2e-3, coulomb in 1e-4..5e-3, stiction in 0.0..1e-2, band in 0.0..0.1, angle in 0.1..3.0,
    ) {
        let model = rig(viscous, coulomb, stiction, band);
        let mut state = model.release(angle, 0.0);
        let mut height = angle;
        for _ in 0..20_000 {
            let before = state.velocity_rad_s;
            model.step(&mut state, 1e-3);
            if before * state.velocity_rad_s < 0.0 || state.contact.is_resting() {
                // The turning point is at most half a millisecond's creeping away from the sample.
                let slack = state.velocity_rad_s.abs().max(before.abs()) * 1e-3;
                prop_assert!(state.angle_rad.abs() <= height + slack, "{} after {height}", state.angle_rad);
                height = state.angle_rad.abs();
            }
        }
    }
}
