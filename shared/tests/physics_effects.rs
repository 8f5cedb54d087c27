//! Every effect in the list, one after the other: it stays finite, takes no energy from nowhere, and means the same on
//! the board as on the PC. Some of the laws are checked against an independent integration too.

mod physics_reference;

use physics_reference::{Law, Reference};
use shared::effect::{Action, Effect};
use shared::model::Model;
use shared::parameters::{Parameters, base};

fn added() -> impl Iterator<Item = &'static Effect<f64>> {
    Effect::<f64>::ALL.iter().filter(|effect| !effect.is_base())
}

/// The paper's pendulum with friction as strong as any added friction may be, and the effect at a share 0 … 1 of its
/// parameters' ranges.
fn rig_with(effect: &Effect<f64>, share: f64) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    // Where an added friction may be negative it must not exceed these.
    parameters.set_friction(3e-3, 1.5e-2, 1.6e-2, 0.0);
    let values: Vec<f64> = effect.parameters.iter().map(|p| p.low + share * (p.high - p.low)).collect();
    parameters.set(effect.id, &values).unwrap();
    parameters.check().unwrap();
    parameters
}

#[test]
fn anywhere_in_its_range_an_effect_stays_finite() {
    for effect in added() {
        for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let model = Model::new(&rig_with(effect, share));
            for start in [1.5, -0.3, 3.0] {
                let mut state = model.release(start, 0.0);
                let mut sensor = model.sensor_at_rest(&state);
                for _ in 0..10_000 {
                    model.step(&mut state, 1e-3);
                    let reading = model.read(&state, &mut sensor);
                    assert!(state.angle_rad.is_finite() && reading.is_finite(), "{} at {share}", effect.name);
                }
            }
        }
    }
}

#[test]
fn frictions_and_sensors_never_add_energy() {
    for effect in added().filter(|effect| matches!(effect.action, Action::Friction(_) | Action::Sensor(_))) {
        for share in [0.05, 0.5, 0.95] {
            let model = Model::new(&rig_with(effect, share));
            let mut state = model.release(1.5, 0.0);
            let mut energy = model.energy_j(&state);
            for _ in 0..5000 {
                model.step(&mut state, 1e-3);
                let after = model.energy_j(&state);
                assert!(after <= energy + 1e-11, "{} at {share} adds {:e} J", effect.name, after - energy);
                energy = after;
            }
        }
    }
}

#[test]
fn drives_do_no_work_over_a_closed_swing() {
    // A drive that depends on the angle alone, or a support that bends, gives back what it takes: without friction the
    // pendulum returns to the height of its release.
    for effect in added().filter(|effect| matches!(effect.action, Action::Drive(_))) {
        for strength in [0.01, 0.05] {
            let mut parameters = rig_with(effect, 0.0);
            parameters.set_friction(0.0, 0.0, 0.0, 0.0);
            let values: Vec<f64> =
                effect.parameters.iter().map(|p| if p.start == 0.0 { strength * p.high } else { p.start }).collect();
            parameters.set(effect.id, &values).unwrap();
            let model = Model::new(&parameters);
            let mut state = model.release(1.2, 0.0);
            let mut highest = f64::MIN;
            for step in 0..10_000 {
                model.step(&mut state, 1e-3);
                highest = if step > 5000 { highest.max(state.angle_rad) } else { highest };
            }
            assert!((highest - 1.2).abs() < 2e-3, "{}: {highest}", effect.name);
        }
    }
}

/// Typical strengths: a twentieth of the range, what is not a strength at its usual value.
fn typical_rig(effect: &Effect<f64>) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    let values: Vec<f64> =
        effect.parameters.iter().map(|p| if p.start == 0.0 { 0.05 * p.high } else { p.start }).collect();
    parameters.set(effect.id, &values).unwrap();
    parameters
}

#[test]
fn the_board_agrees_with_the_pc() {
    for effect in added() {
        let parameters = typical_rig(effect);
        let (pc, board) = (Model::new(&parameters), Model::new(&parameters.map(|value| value as f32)));
        let (mut on_pc, mut on_board) = (pc.release(1.0, 0.0), board.release(1.0_f32, 0.0));
        let (mut pc_sensor, mut board_sensor) = (pc.sensor_at_rest(&on_pc), board.sensor_at_rest(&on_board));
        let mut worst = 0.0_f64;
        for _ in 0..10_000 {
            pc.step(&mut on_pc, 1e-3);
            board.step(&mut on_board, 1e-3);
            let readings = (pc.read(&on_pc, &mut pc_sensor), board.read(&on_board, &mut board_sensor));
            worst = worst.max((readings.0 - f64::from(readings.1)).abs());
        }
        assert!(worst < MOST_BETWEEN_BOARD_AND_PC, "{}: {worst:e}", effect.name);
    }
}

/// 10 s of rounding in single precision, in rad.
const MOST_BETWEEN_BOARD_AND_PC: f64 = 1e-4;

#[test]
fn each_effect_changes_what_is_read() {
    for effect in added() {
        let reading = |parameters: &Parameters<f64>| {
            let model = Model::new(parameters);
            let mut state = model.release(1.0, 0.0);
            let mut sensor = model.sensor_at_rest(&state);
            let mut readings = vec![];
            for _ in 0..5000 {
                model.step(&mut state, 1e-3);
                readings.push(model.read(&state, &mut sensor));
            }
            readings
        };
        let (with, without) = (reading(&typical_rig(effect)), reading(&Parameters::paper()));
        let apart = with.iter().zip(&without).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
        assert!(apart > 1e-5, "{}: {apart:e}", effect.name);
    }
}

#[test]
fn added_frictions_agree_with_an_independent_integration() {
    let laws: [(&str, &[f64], Law); 8] = [
        ("quadratic-drag", &[4e-5], |_, v, _| -4e-5 * v * v.abs()),
        ("power-law-drag", &[4e-5, 2.5], |_, v, _| -4e-5 * v.abs().powf(2.5) * v.signum()),
        ("stribeck", &[3e-4, 0.5], |_, v, s| -3e-4 * (-(v / 0.5).powi(2)).exp() * s),
        ("load-dependent-coulomb", &[1e-4], |a, v, s| {
            -1e-4 * (0.146_608_4 * (9.81 * a.cos() + 0.156_217_7 * v * v)).abs() * s
        }),
        ("gear-load", &[2e-3], |a, _, s| -2e-3 * (0.146_608_4 * 9.81 * 0.156_217_7 * a.sin()).abs() * s),
        ("asymmetric-coulomb", &[2e-4], |_, _, s| -2e-4 * s.abs()),
        ("asymmetric-viscous", &[2e-4], |_, v, _| -2e-4 * v.abs()),
        ("eddy-brake", &[1e-3, 0.3, 0.2], |a, v, _| -1e-3 * v * (-((a - 0.3) / 0.2).powi(2)).exp()),
    ];
    for (name, values, law) in laws {
        for band in [0.0, 0.03] {
            let mut parameters = Parameters::paper();
            parameters.set_friction(5.4e-4, 7.1e-4, 1.5e-3, band);
            let mut reference = Reference::release(&parameters, Some(law), 1.2, 0.0);
            parameters.set(Effect::<f64>::by_name(name).unwrap().id, values).unwrap();
            let model = Model::new(&parameters);
            let mut state = model.release(1.2, 0.0);
            for sample in 0..3000 {
                (0..10).for_each(|_| model.step(&mut state, 1e-3));
                reference.advance(0.01);
                let apart = (state.angle_rad - reference.angle_rad).abs();
                assert!(apart < 1e-7, "{name}, DV {band}, sample {sample}: {apart:e}");
            }
        }
    }
}

#[test]
fn sensors_act_in_the_order_of_the_chain_whatever_the_order_of_the_list() {
    let chain = [
        ("sensor-lag", vec![0.02]),
        ("angle-offset", vec![0.1]),
        ("sensor-gain", vec![0.1]),
        ("backlash", vec![0.02, 0.5]),
    ];
    let final_reading = |order: &[usize]| {
        let mut parameters = Parameters::paper();
        for i in order {
            parameters.set(Effect::<f64>::by_name(chain[*i].0).unwrap().id, &chain[*i].1).unwrap();
        }
        let model = Model::new(&parameters);
        let mut state = model.release(1.0, 0.0);
        let mut sensor = model.sensor_at_rest(&state);
        // Held still at 1 rad: the play leaves the sensor 5 mrad further, then gain, then offset, and no lag yet.
        assert!((model.read(&state, &mut sensor) - (1.005 * 1.1 + 0.1)).abs() < 1e-12);
        for _ in 0..500 {
            model.step(&mut state, 1e-3);
            model.read(&state, &mut sensor);
        }
        model.read(&state, &mut sensor)
    };
    assert_eq!(final_reading(&[0, 1, 2, 3]), final_reading(&[3, 2, 1, 0]));
}

#[test]
fn a_drifting_friction_fades_from_the_release_on() {
    // Dry friction that is doubled at first and gone after a few seconds: the first swing loses twice as much.
    let mut parameters = Parameters::paper();
    parameters.set_friction(0.0, 1e-3, 1e-3, 0.0);
    let loss = |parameters: &Parameters<f64>| {
        let model = Model::new(parameters);
        let mut state = model.release(0.5, 0.0);
        (0..20).for_each(|_| model.step(&mut state, 1e-3));
        model.friction_torque_nm(&state)
    };
    let plain = loss(&parameters);
    parameters.set_friction(0.0, 2e-3, 1e-3, 0.0);
    parameters.set(Effect::<f64>::by_name("drifting-friction").unwrap().id, &[-0.5e-3, 0.0, 2.0]).unwrap();
    assert!((loss(&parameters) / plain - 1.0 - (-0.02_f64 / 2.0).exp()).abs() < 1e-12);
    assert!(parameters.values(base::COULOMB).is_some());
}

/// Root mean square over 20 s of how far readings with steps of so many seconds are from those with 1 ms, in rad.
fn error_of_long_steps(parameters: &Parameters<f64>, step_s: f64) -> f64 {
    let model = Model::new(parameters);
    let readings = |step_s: f64| -> Vec<f64> {
        let mut state = model.release(1.5, 0.0);
        let mut sensor = model.sensor_at_rest(&state);
        let per_reading = (0.02 / step_s).round() as usize;
        let mut next = || {
            (0..per_reading).for_each(|_| model.step(&mut state, step_s));
            model.read(&state, &mut sensor)
        };
        (0..1000).map(|_| next()).collect()
    };
    let (long, short) = (readings(step_s), readings(1e-3));
    (long.iter().zip(&short).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / long.len() as f64).sqrt()
}

#[test]
fn effects_that_are_not_fine_allow_steps_of_10_ms() {
    for effect in added().filter(|effect| !effect.is_fine) {
        for share in [0.05, 0.5, 0.95] {
            let error_rad = error_of_long_steps(&rig_with(effect, share), 1e-2);
            // A fiftieth of the usual noise.
            assert!(error_rad < 2e-5, "{} at {share}: {error_rad:e} rad", effect.name);
        }
    }
}
