//! Sensitivities by dual numbers against finite differences of plain simulations, for every effect of the list.

use shared::dual::Dual;
use shared::effect::Effect;
use shared::model::Model;
use shared::parameters::{Parameters, base};
use shared::real::Real;

const DT_S: f64 = 2e-3;
const N_STEPS: usize = 5000;
const ANGLE_RAD: f64 = 1.3;
const VELOCITY_RAD_S: f64 = 0.4;

/// Central differences over 1e-5 of a quantity: truncation 1e-10 and rounding 1e-11 relative, but where the step is
/// cut, the cubic through its ends is 1e-5 off.
const TOLERANCE: f64 = 1e-4;

/// What the reading is derived by.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    Angle,
    Velocity,
    Inertia,
    Effect { id: u16, index: usize },
}

/// Angles that the sensor reads, and their derivatives by the quantity, from one run.
fn sensitivities(parameters: &Parameters<f64>, quantity: Quantity) -> Vec<Dual<f64, 1>> {
    let mut dual = parameters.map(Dual::<f64, 1>::constant);
    let own = |value: Dual<f64, 1>| Dual::variable(value.value, 0);
    let mut start = [ANGLE_RAD, VELOCITY_RAD_S].map(Dual::constant);
    match quantity {
        Quantity::Angle => start[0] = own(start[0]),
        Quantity::Velocity => start[1] = own(start[1]),
        Quantity::Inertia => dual.pendulum.inertia_kg_m2 = own(dual.pendulum.inertia_kg_m2),
        Quantity::Effect { id, index } => {
            let effect = dual.effects.iter_mut().find(|effect| effect.id == id).unwrap();
            effect.values[index] = own(effect.values[index]);
        }
    }
    readings(&dual, start)
}

/// The same by two plain runs, the quantity a little larger and smaller.
fn differences(parameters: &Parameters<f64>, quantity: Quantity, step: f64) -> Vec<f64> {
    let moved = |step: f64| {
        let mut parameters = parameters.clone();
        let mut start = [ANGLE_RAD, VELOCITY_RAD_S];
        match quantity {
            Quantity::Angle => start[0] += step,
            Quantity::Velocity => start[1] += step,
            Quantity::Inertia => parameters.pendulum.inertia_kg_m2 += step,
            Quantity::Effect { id, index } => {
                let effect = parameters.effects.iter_mut().find(|effect| effect.id == id).unwrap();
                effect.values[index] += step;
            }
        }
        readings(&parameters, start)
    };
    moved(step).iter().zip(moved(-step)).map(|(more, less)| (more - less) / (2.0 * step)).collect()
}

fn readings<R: Real>(parameters: &Parameters<R>, [angle_rad, velocity_rad_s]: [R; 2]) -> Vec<R> {
    let model = Model::new(parameters);
    let mut state = model.release(angle_rad, velocity_rad_s);
    let mut sensor = model.sensor_at_rest(&state);
    let read = |_| {
        model.step(&mut state, R::of(DT_S));
        model.read(&state, &mut sensor)
    };
    (0..N_STEPS).map(read).collect()
}

/// Largest disagreement as a share of the largest derivative.
fn disagreement(parameters: &Parameters<f64>, quantity: Quantity, size: f64) -> f64 {
    let plain = readings(parameters, [ANGLE_RAD, VELOCITY_RAD_S]);
    let dual = sensitivities(parameters, quantity);
    assert!(plain.iter().zip(&dual).all(|(plain, dual)| *plain == dual.value), "{quantity:?}: other values");
    let differences = differences(parameters, quantity, 1e-5 * size);
    let largest = differences.iter().fold(0.0_f64, |largest, d| largest.max(d.abs()));
    assert!(largest > 0.0, "{quantity:?} has no effect");
    let apart = dual.iter().zip(&differences).map(|(dual, d)| (dual.slopes[0] - d).abs());
    apart.fold(0.0, f64::max) / largest
}

fn rig(viscous: f64, coulomb: f64, stiction: f64, band: f64) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(viscous, coulomb, stiction, band);
    parameters
}

#[test]
fn base_parameters_and_starts_agree_with_finite_differences_with_and_without_a_band_until_rest() {
    let effect = |id, index| Quantity::Effect { id, index };
    let rigs = [rig(5.4e-4, 7.1e-4, 0.0, 0.0), rig(5.4e-4, 1.1e-2, 1.2e-2, 0.0), rig(5.4e-4, 1.0e-2, 1.3e-2, 0.08)];
    for (case, parameters) in rigs.iter().enumerate() {
        let mut quantities = vec![
            (Quantity::Angle, 1.0),
            (Quantity::Velocity, 1.0),
            (Quantity::Inertia, 2.7e-3),
            (effect(base::VISCOUS, 0), 5e-4),
            (effect(base::COULOMB, 0), 5e-3),
        ];
        if parameters.values(base::STICTION).unwrap()[1] > 0.0 {
            quantities.extend([(effect(base::STICTION, 0), 1e-2), (effect(base::STICTION, 1), 0.05)]);
        }
        for (quantity, size) in quantities {
            let apart = disagreement(parameters, quantity, size);
            assert!(apart < TOLERANCE, "rig {case}, {quantity:?}: {apart:e}");
        }
    }
}

#[test]
fn every_number_of_every_effect_agrees_with_finite_differences() {
    let mut checked = 0;
    for effect in Effect::<f64>::ALL.iter().filter(|effect| !effect.is_base()) {
        let mut parameters = rig(5.4e-4, 7.1e-4, 1e-3, 0.05);
        let values: Vec<f64> = effect.parameters.iter().map(|p| p.start + 0.03 * (p.high - p.start)).collect();
        parameters.set(effect.id, &values).unwrap();
        for (index, parameter) in effect.parameters.iter().enumerate() {
            let quantity = Quantity::Effect { id: effect.id, index };
            let apart = disagreement(&parameters, quantity, 0.1 * (parameter.high - parameter.low));
            assert!(apart < TOLERANCE, "{} {}: {apart:e}", effect.name, parameter.symbol);
            checked += 1;
        }
    }
    assert!(checked > 0);
}
