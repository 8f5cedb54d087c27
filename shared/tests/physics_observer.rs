//! The observer against pendulums of the independent integrator: it corrects, as fast as its bandwidth says, and no
//! faster.

mod physics_reference;

use physics_reference::Reference;
use shared::observer::Observer;
use shared::parameters::Parameters;

const DT_S: f64 = 1e-3;

/// The paper's pendulum; without dry friction its small swings are linear.
fn pendulum(viscous: f64, coulomb_nm: f64) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(viscous, coulomb_nm, coulomb_nm, 0.0);
    parameters
}

/// Errors of the observer's angle over time; it starts `wrong_by` (rad, rad/s) beside the pendulum.
fn errors(parameters: &Parameters<f64>, bandwidth: f64, start_rad: f64, wrong_by: (f64, f64), n: usize) -> Vec<f64> {
    let mut plant = Reference::release(parameters, None, start_rad, 0.0);
    let mut observer = Observer::new(parameters, bandwidth);
    observer.start_at(start_rad + wrong_by.0, wrong_by.1);
    let mut errors = Vec::new();
    for _ in 0..n {
        plant.advance(DT_S);
        let estimate = observer.on_measurement(plant.angle_rad, DT_S);
        errors.push(estimate.angle_rad - plant.angle_rad);
    }
    errors
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Beside the pendulum by e, the observer has e″ + (2b + c/J)·e′ + (ω₀² + b² + 2bc/J)·e = 0: the error dies at the rate
/// b + c/2J while it swings at about ω₀.
#[test]
fn a_wrong_start_is_corrected_at_the_rate_of_the_bandwidth() {
    let viscous = 2e-4;
    let parameters = pendulum(viscous, 0.0);
    let inertia = parameters.pendulum.pivot_inertia_kg_m2();
    let natural = (parameters.pendulum.gravity_torque_nm() / inertia).sqrt();
    for bandwidth in [0.0, 0.5, 1.0, 2.0, 3.0] {
        let errors = errors(&parameters, bandwidth, 0.05, (0.02, 0.0), 5000);
        // Whole periods of the error, so that its phase does not matter.
        let swings = (natural * natural - (0.5 * viscous / inertia).powi(2) + bandwidth * viscous / inertia).sqrt();
        let period = (std::f64::consts::TAU / swings / DT_S).round() as usize;
        let later = 3 * period;
        let rate = (rms(&errors[..period]) / rms(&errors[later..later + period])).ln() / (later as f64 * DT_S);
        let expected = bandwidth + 0.5 * viscous / inertia;
        println!("b = {bandwidth}: the error dies at {rate:.3} /s, {expected:.3} expected");
        assert!((rate - expected).abs() < 0.03 * expected + 0.005, "b = {bandwidth}: {rate} instead of {expected}");
    }
}

/// At any amplitude, with dry friction, and after a blow that the model knows nothing of.
#[test]
fn after_a_blow_it_finds_angle_and_velocity_again() {
    let parameters = pendulum(5.4e-4, 7.1e-4);
    let mut plant = Reference::release(&parameters, None, 1.2, 0.0);
    let mut observer = Observer::<f64>::new(&parameters, 3.0);
    for step in 0..8000 {
        if step == 3000 {
            let blow = plant.velocity_rad_s + 3.0;
            plant = Reference::release(&parameters, None, plant.angle_rad, blow);
        }
        plant.advance(DT_S);
        let estimate = observer.on_measurement(plant.angle_rad, DT_S);
        let off =
            (estimate.angle_rad - plant.angle_rad).abs() + 0.1 * (estimate.velocity_rad_s - plant.velocity_rad_s).abs();
        // e⁻⁶ of the blow is left after two seconds, and less of the first millisecond, which it took for rest.
        let settled = (1000..3000).contains(&step) || step >= 5500;
        assert!(!settled || off < 5e-3, "{off} rad off at {step} ms");
        assert!(step != 3100 || off > 0.05, "the blow of 3 rad/s is not seen: {off}");
    }
}

/// Low bandwidth shows a wrong model, as its documentation promises: for a small error of the torque the innovation is
/// (Δτ/J)/b² where the pendulum moves slowly, and that is what tells the right parameters from the wrong ones.
#[test]
fn a_wrong_model_keeps_an_innovation_that_the_right_one_loses() {
    let parameters = pendulum(5.4e-4, 7.1e-4);
    let mut wrong = parameters.clone();
    wrong.pendulum.inertia_kg_m2 *= 1.05;
    let innovation = |assumed: &Parameters<f64>| {
        let mut plant = Reference::release(&parameters, None, 1.2, 0.0);
        let mut observer = Observer::<f64>::new(assumed, 3.0);
        for _ in 0..8000 {
            observer.on_measurement(plant.angle_rad, DT_S);
            plant.advance(DT_S);
        }
        observer.innovation_rms_rad()
    };
    let (right, wrong) = (innovation(&parameters), innovation(&wrong));
    println!("{right:.2e} with the right model, {wrong:.2e} with 5 % more inertia");
    assert!(right < 1e-4 && wrong > 3e-3 && wrong < 0.1, "{right} {wrong}");
}
