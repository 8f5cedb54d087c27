//! Numbers that no rig has: the simulation stays finite, ends in bounded time and never panics.

use proptest::prelude::*;
use shared::model::Model;
use shared::parameters::Parameters;
use std::f64::consts::PI;

/// Simulates ten seconds; everything must stay a number.
fn simulate(parameters: &Parameters<f64>, angle: f64, velocity: f64, dt_s: f64) -> f64 {
    let model = Model::new(parameters);
    let mut state = model.release(angle, velocity);
    for _ in 0..(10.0 / dt_s) as usize {
        model.step(&mut state, dt_s);
    }
    assert!(state.angle_rad.is_finite() && state.velocity_rad_s.is_finite(), "{parameters:?} gives {state:?}");
    state.angle_rad
}

fn paper_with(viscous: f64, coulomb: f64, stiction: f64, band: f64) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(viscous, coulomb, stiction, band);
    parameters
}

#[test]
fn friction_stronger_than_gravity_holds_the_pendulum_where_it_stops() {
    let strong = paper_with(0.0, 1.0, 1.5, 0.05);
    assert_eq!(simulate(&strong, 1.5, 0.0, 1e-3), 1.5);
    let thrown = simulate(&strong, 1.5, -5.0, 1e-3);
    assert!(thrown < 1.5 && thrown > 1.3, "{thrown}");
}

#[test]
fn a_band_wider_than_any_speed_is_harmless() {
    let angle = simulate(&paper_with(5e-4, 7e-4, 1e-3, 300.0), 1.5, 0.0, 1e-3);
    assert!(angle.abs() < 1.6);
}

#[test]
fn without_inertia_of_its_own_it_is_a_point_mass() {
    let mut parameters = paper_with(5e-4, 7e-4, 1e-3, 0.05);
    parameters.pendulum.inertia_kg_m2 = 0.0;
    simulate(&parameters, 1.5, 0.0, 1e-3);
}

#[test]
fn upright_it_stays_with_friction_and_falls_without() {
    assert_eq!(simulate(&paper_with(5e-4, 7e-4, 1e-3, 0.05), PI, 0.0, 1e-3), PI);
    let fallen = simulate(&paper_with(5e-4, 0.0, 0.0, 0.0), PI - 1e-3, 0.0, 1e-3);
    assert!((fallen - PI).abs() > 0.1);
}

#[test]
fn spinning_over_the_top_it_comes_to_rest_after_whole_turns() {
    let parameters = paper_with(5e-4, 7e-4, 1e-3, 0.055);
    let model = Model::new(&parameters);
    let mut state = model.release(0.0, 40.0);
    (0..120_000).for_each(|_| model.step(&mut state, 1e-3));
    let turns = state.angle_rad / (2.0 * PI);
    assert!(state.contact.is_resting() && turns > 5.0 && (turns - turns.round()).abs() < 1e-3, "{turns} turns");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_numbers_stay_finite(
        viscous in 0.0..1e-2, coulomb in 0.0..2.0, stiction in 0.0..2.0, band in prop_oneof![Just(0.0), 0.0..10.0],
        inertia in 0.0..1e-2, angle in -10.0..10.0, velocity in -50.0..50.0, dt_s in 1e-4..1e-2,
    ) {
        let mut parameters = paper_with(viscous, coulomb, stiction, band);
        parameters.pendulum.inertia_kg_m2 = inertia;
        simulate(&parameters, angle, velocity, dt_s);
    }
}
