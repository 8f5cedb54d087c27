//! The step function against an independent integrator: order, accuracy through stick and slip, rest.

mod physics_reference;

use physics_reference::Reference;
use shared::model::{Model, State};
use shared::parameters::Parameters;

fn paper_with(viscous: f64, coulomb: f64, stiction: f64, band: f64) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(viscous, coulomb, stiction, band);
    parameters
}

/// Largest difference in angle from the reference, in rad, compared every 10 ms.
fn worst_error(parameters: &Parameters<f64>, start: (f64, f64), seconds: f64, dt_s: f64) -> f64 {
    let model = Model::new(parameters);
    let mut state = model.release(start.0, start.1);
    let mut reference = Reference::release(parameters, None, start.0, start.1);
    let per_sample = (0.01 / dt_s).round() as usize;
    let mut worst = 0.0_f64;
    for _ in 0..(seconds / 0.01) as usize {
        (0..per_sample).for_each(|_| model.step(&mut state, dt_s));
        reference.advance(0.01);
        worst = worst.max((state.angle_rad - reference.angle_rad).abs());
    }
    worst
}

#[test]
fn a_smooth_swing_converges_with_the_fourth_power_of_the_step() {
    // Viscous friction alone never changes the regime.
    let smooth = paper_with(5e-4, 0.0, 0.0, 0.0);
    for start in [(1.5, 0.0), (0.3, 0.0), (-2.8, 0.0), (0.1, 12.0)] {
        let [coarse, fine] = [2e-3, 1e-3].map(|dt_s| worst_error(&smooth, start, 5.0, dt_s));
        let order = (coarse / fine).log2();
        assert!((order - 4.0).abs() < 0.15, "{start:?}: order {order}");
    }
}

#[test]
fn dry_friction_keeps_the_fourth_order_because_steps_are_cut() {
    for (coulomb, stiction, band) in [(7e-4, 1e-3, 0.0), (7e-4, 1e-3, 0.055), (5e-3, 1e-2, 0.03)] {
        let dry = paper_with(5e-4, coulomb, stiction, band);
        let [coarse, fine] = [5e-3, 2.5e-3].map(|dt_s| worst_error(&dry, (1.5, 0.0), 4.0, dt_s));
        let order = (coarse / fine).log2();
        assert!(order > 3.5, "Mc {coulomb}, Ms {stiction}, DV {band}: order {order}");
    }
}

#[test]
fn stick_and_slip_agree_with_the_reference() {
    // (Mw, Mc, Ms, DV): with and without a band, sticky and slippery, Ms below Mc.
    let rigs = [
        (5.4e-4, 7.1e-4, 1e-3, 0.055),
        (5.4e-4, 7.1e-4, 1e-3, 0.0),
        (5.4e-4, 7.1e-4, 6e-3, 0.055),
        (1e-4, 5e-3, 1e-2, 0.01),
        (1e-4, 5e-3, 1e-3, 0.1),
        (0.0, 1e-3, 0.0, 0.0),
        (0.0, 0.0, 5e-3, 0.055),
    ];
    for (viscous, coulomb, stiction, band) in rigs {
        let parameters = paper_with(viscous, coulomb, stiction, band);
        for start in [(1.509, 0.0), (-0.4, 0.0), (2.6, -3.0)] {
            let errors = [1e-3, 1e-4].map(|dt_s| worst_error(&parameters, start, 46.2, dt_s));
            let rig = (viscous, coulomb, stiction, band);
            assert!(errors[0] < MOST_AT_1_MS && errors[1] < MOST_AT_100_US, "{rig:?} from {start:?}: {errors:?}");
        }
    }
}

/// Over 46 s the phase runs away by about (ω₀·Δt)⁴·ω₀·t/120. The worst rig has no friction while it slides and starts
/// high; the paper's stays below 2e-9.
const MOST_AT_1_MS: f64 = 4e-8;
/// Rounding of two integrations over half a million steps.
const MOST_AT_100_US: f64 = 3e-10;

#[test]
fn long_steps_stop_where_the_reference_stops() {
    // Near rest the speed may just pass the band's edge and fall back within one step.
    let parameters = paper_with(5.4e-4, 7.1e-4, 1e-3, 0.055);
    let model = Model::new(&parameters);
    for i in 0..40 {
        let start = 0.7 + 0.03 * f64::from(i);
        let mut reference = Reference::release(&parameters, None, start, 0.0);
        (0..50).for_each(|_| reference.advance(1.0));
        let mut state = model.release(start, 0.0);
        (0..5000).for_each(|_| model.step(&mut state, 1e-2));
        let apart = (state.angle_rad - reference.angle_rad).abs();
        assert!(apart < 2e-4, "from {start:.2}: {} rad, the reference {}", state.angle_rad, reference.angle_rad);
    }
}

#[test]
fn it_comes_to_rest_without_chatter() {
    for stiction in [0.0, 3e-4, 7e-4, 6e-3] {
        for (coulomb, band) in [(7e-4, 0.0), (7e-4, 0.055), (5e-3, 0.0)] {
            let model = Model::new(&paper_with(5e-4, coulomb, stiction, band));
            let mut state = model.release(1.5, 0.0);
            let mut n_changes = 0;
            for _ in 0..100_000 {
                let before = kind(&state);
                model.step(&mut state, 1e-3);
                n_changes += usize::from(kind(&state) != before);
            }
            assert!(
                state.contact.is_resting() && state.velocity_rad_s == 0.0,
                "Ms {stiction}, Mc {coulomb}, DV {band}"
            );
            // At most two changes of regime a half swing; 100 s hold fewer than 200 half swings.
            assert!(n_changes < 400, "{n_changes} changes of regime");
        }
    }
}

fn kind(state: &State<f64>) -> (bool, bool, bool) {
    (state.contact.is_sliding(), state.contact.is_in_band(), state.velocity_rad_s > 0.0)
}

#[test]
fn without_any_dry_friction_it_swings_on() {
    let model = Model::new(&paper_with(0.0, 0.0, 0.0, 0.0));
    let mut state = model.release(0.5, 0.0);
    let energy = model.energy_j(&state);
    (0..100_000).for_each(|_| model.step(&mut state, 1e-3));
    assert!((model.energy_j(&state) / energy - 1.0).abs() < 1e-9);
}

#[test]
fn it_rests_where_stiction_holds_gravity_and_only_there() {
    for band in [0.0, 0.055] {
        let parameters = paper_with(5e-4, 7e-4, 6e-3, band);
        let edge = (6e-3 / parameters.pendulum.gravity_torque_nm()).asin();
        let model = Model::new(&parameters);
        for (angle, rests) in
            [(edge * 0.999, true), (-edge * 0.999, true), (edge * 1.001, false), (-edge * 1.001, false)]
        {
            let mut state = model.release(angle, 0.0);
            (0..10).for_each(|_| model.step(&mut state, 1e-3));
            assert_eq!(state.contact.is_resting(), rests, "{angle} with DV {band}");
            assert_eq!(state.velocity_rad_s == 0.0, rests);
        }
    }
}

#[test]
fn nothing_drifts_at_rest_for_an_hour() {
    let parameters = paper_with(5e-4, 7e-4, 6e-3, 0.055);
    let model = Model::new(&parameters);
    let mut state = model.release(0.02, 0.0);
    let board = Model::new(&parameters.map(|value| value as f32));
    let mut on_board = board.release(0.02_f32, 0.0);
    for _ in 0..3_600_000 {
        model.step(&mut state, 1e-3);
        board.step(&mut on_board, 1e-3);
    }
    assert_eq!((state.angle_rad, state.velocity_rad_s), (0.02, 0.0));
    assert_eq!((on_board.angle_rad, on_board.velocity_rad_s), (0.02, 0.0));
}

#[test]
fn nothing_drifts_after_a_swing_has_ended() {
    let board = Model::new(&paper_with(5e-4, 7e-4, 1e-3, 0.055).map(|value| value as f32));
    let mut state = board.release(1.5_f32, 0.0);
    (0..100_000).for_each(|_| board.step(&mut state, 1e-3));
    let rest = state.angle_rad;
    (0..1_000_000).for_each(|_| board.step(&mut state, 1e-3));
    assert_eq!(state.angle_rad, rest);
}
