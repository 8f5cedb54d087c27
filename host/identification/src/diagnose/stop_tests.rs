//! Swings that rest, whose missing law decides at which turn they stop: the friction of a model without it is far from the
//! truth, and so is the turn.

use super::diagnose;
use super::tests::effect;
use crate::improve::{Change, change};
use crate::random::Noise;
use crate::swing::Swing;
use crate::verdict::Left;
use shared::model::Model;
use shared::motion::Pendulum;
use shared::parameters::Parameters;

const NOISE_RAD: f64 = 1.1e-3;

/// A pendulum, and what rubs: Mw, Mc, Ms and DV.
fn rig(mass_kg: f64, length_m: f64, inertia_kg_m2: f64, friction: [f64; 4]) -> Parameters<f64> {
    let mut rig = Parameters::frictionless(Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2: 9.81 });
    let [viscous, coulomb_nm, level_nm, velocity_band] = friction;
    rig.set_friction(viscous, coulomb_nm, level_nm, velocity_band);
    rig
}

/// Swings of a rig that lacks a law, from some releases (rad) to their rest, at 200 Hz; and the same rig with usual friction.
fn swings(
    truth: &Parameters<f64>,
    law: &str,
    values: &[f64],
    releases: &[(f64, f64)],
) -> (Vec<Swing>, Parameters<f64>) {
    let mut with_law = truth.clone();
    with_law.set(effect(law).id, values).unwrap();
    let model = Model::new(&with_law);
    let swing = |(idx, (release_rad, seconds)): (usize, &(f64, f64))| {
        let (mut state, mut noise) = (model.release(*release_rad, 0.0), Noise::new(idx as u64 + 1));
        let times_s: Vec<f64> = (0..(200.0 * seconds) as usize).map(|i| i as f64 / 200.0).collect();
        let mut angles_rad = Vec::new();
        for _ in &times_s {
            angles_rad.push(state.angle_rad + NOISE_RAD * noise.normal());
            (0..5).for_each(|_| model.step(&mut state, 1e-3));
        }
        Swing::new(&idx.to_string(), &times_s, &angles_rad, NOISE_RAD)
    };
    let usual = 2e-3 * truth.pendulum.gravity_torque_nm();
    let Pendulum { mass_kg, length_m, inertia_kg_m2, .. } = truth.pendulum;
    (releases.iter().enumerate().map(swing).collect(), rig(mass_kg, length_m, inertia_kg_m2, [usual, usual, 0.0, 0.0]))
}

/// A pendulum whose grease shears, from these releases.
fn shears(releases: [f64; 3]) -> (Vec<Swing>, Parameters<f64>) {
    let truth = rig(0.2455, 0.175, 6.35e-3, [1.31e-3, 7.52e-4, 1.222e-3, 0.05]);
    swings(&truth, "shear-thinning", &[3.363e-3, 0.604], &releases.map(|release_rad| (release_rad, 24.0)))
}

#[test]
fn what_is_added_to_a_model_that_stops_at_another_turn_explains_the_swings() {
    for releases in [[-0.719, 0.442, -1.325], [-0.674, 0.415, -1.243]] {
        let (swings, begun) = shears(releases);
        let steps = change(&swings, &[], &begun, &[Change::Add(effect("shear-thinning"))]).unwrap();
        let noises = |step: usize| steps[step].rmse / steps[step].noise;
        assert!(noises(0) > 5.0 && noises(1) < 1.03, "{} {}", noises(0), noises(1));
    }
}

#[test]
fn a_law_that_decides_at_which_turn_the_swings_stop_is_named() {
    let found = |(swings, begun): (Vec<Swing>, Parameters<f64>)| {
        let found = diagnose(&swings, &[], &begun);
        (found.verdict, found.left)
    };
    assert_eq!(found(shears([-0.697, 0.429, -1.284])), (vec!["shear-thinning"], Left::Noise));
    let truth = rig(0.25547, 0.20047, 3.7927e-3, [6.64e-4, 6.07e-4, 8.49e-4, 0.02]);
    let in_air = swings(&truth, "power-law-drag", &[7.421e-5, 2.24], &[(-1.113, 58.0), (1.115, 58.0)]);
    assert_eq!(found(in_air), (vec!["power-law-drag"], Left::Noise));
}
