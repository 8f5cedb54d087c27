//! The swing that exported models are compared over, and what it must be: the product's own model, step by step.
#![allow(dead_code, reason = "each test program uses a part")]

use host::rigfile::{Knowledge, Quantity, RigFile};
use shared::effect::Effect;
use shared::model::Model;
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::process::Command;

/// From a wide release to rest, at the rig's usual rate.
pub(crate) const N_STEPS: usize = 15_000;
/// s
pub(crate) const DT_S: f64 = 1e-3;
/// rad
pub(crate) const RELEASE_RAD: f64 = 1.5;

/// Of angle, velocity, torque and reading. Both compute in f64; sines and powers differ in their last bits.
const TOLERANCE: f64 = 1e-9;

/// Rows are compared this often, so that a wrong one is near its cause.
pub(crate) const EVERY: usize = 50;

/// The paper's pendulum with more dry friction.
pub(crate) fn dry() -> RigFile {
    let pendulum = Parameters::paper().pendulum;
    let mut file = RigFile::new(Pendulum { ..pendulum }).unwrap();
    let mut parameters = Parameters::paper();
    // More dry friction than the paper's, so that it comes to rest in time.
    parameters.set_friction(5.4e-4, 8e-3, 1e-2, 0.055);
    for quantity in Quantity::all(&parameters) {
        set(&mut file, quantity, quantity.get(&parameters).unwrap());
    }
    file
}

/// Sets a number of which nothing else is known.
pub(crate) fn set(file: &mut RigFile, quantity: Quantity, value: f64) {
    file.set(quantity, value, Knowledge::default()).unwrap();
}

/// That pendulum and one effect more, at a twentieth of its largest usual size.
pub(crate) fn with(effect: &'static Effect<f64>) -> RigFile {
    let mut file = dry();
    if !effect.is_base() {
        for (index, parameter) in effect.parameters.iter().enumerate() {
            let value = if parameter.start == 0.0 { 0.05 * parameter.high } else { parameter.start };
            let quantity = Quantity::all_of_effect(effect).nth(index).unwrap();
            set(&mut file, quantity, value);
        }
    }
    file
}

/// Angle, velocity, torque and reading, every so many steps.
pub(crate) fn ours(file: &RigFile) -> Vec<[f64; 4]> {
    let model = Model::new(file.parameters());
    let mut state = model.release(RELEASE_RAD, 0.0);
    let mut sensor = model.sensor_at_rest(&state);
    let mut rows = Vec::new();
    for step in 0..N_STEPS {
        let reading = model.read(&state, &mut sensor);
        if step % EVERY == 0 {
            rows.push([state.angle_rad, state.velocity_rad_s, model.friction_torque_nm(&state), reading]);
        }
        model.step(&mut state, DT_S);
    }
    rows
}

/// What a program prints, which must succeed.
pub(crate) fn said_by(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(output.status.success(), "{command:?}\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Are rows of angle, velocity, torque and reading the model's?
#[track_caller]
pub(crate) fn check(what: &str, file: &RigFile, theirs: &str) {
    let ours = ours(file);
    assert_eq!(ours.len(), theirs.lines().count(), "{what}");
    for (idx, (ours, line)) in ours.iter().zip(theirs.lines()).enumerate() {
        let theirs: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        for (ours, theirs) in ours.iter().zip(&theirs) {
            let off = (ours - theirs).abs();
            assert!(off < TOLERANCE, "{what}, step {}: {ours} here, {theirs} there, {off:e} apart", EVERY * idx);
        }
    }
}
