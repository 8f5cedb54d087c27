//! A fit lives on derivatives: finite differences of the simulated angle must not depend on their step, wherever the
//! velocity zeros fall between the steps of the integration.

use shared::model::Model;
use shared::parameters::{Parameters, base};

/// Largest disagreement of two derivatives, relative to the largest derivative. Truncation gives 1e-6 at a relative
/// step of 1e-4, rounding 1e-6 at one of 1e-6.
const TOLERANCE: f64 = 2e-5;

/// The pendulum and how it is released.
#[derive(Clone)]
struct Swing {
    parameters: Parameters<f64>,
    angle_rad: f64,
}

impl Swing {
    fn new(viscous: f64, coulomb: f64, stiction: f64, band: f64, angle_rad: f64) -> Self {
        let mut parameters = Parameters::paper();
        parameters.set_friction(viscous, coulomb, stiction, band);
        Self { parameters, angle_rad }
    }

    fn changed(&self, knob: Knob, factor: f64) -> Self {
        let mut swing = self.clone();
        match knob {
            Knob::Angle => swing.angle_rad *= factor,
            Knob::Inertia => swing.parameters.pendulum.inertia_kg_m2 *= factor,
            Knob::Effect(id, index) => {
                let effect = swing.parameters.effects.iter_mut().find(|effect| effect.id == id).unwrap();
                effect.values[index] *= factor;
            }
        }
        swing
    }

    fn angles(&self, dt_s: f64, n_steps: usize) -> Vec<f64> {
        let model = Model::new(&self.parameters);
        let mut state = model.release(self.angle_rad, 0.0);
        let step = |_| {
            model.step(&mut state, dt_s);
            state.angle_rad
        };
        (0..n_steps).map(step).collect()
    }

    /// d(angle)/d(ln knob) at every step, by central differences.
    fn derivative(&self, knob: Knob, relative_step: f64, dt_s: f64, n_steps: usize) -> Vec<f64> {
        let above = self.changed(knob, 1.0 + relative_step).angles(dt_s, n_steps);
        let below = self.changed(knob, 1.0 - relative_step).angles(dt_s, n_steps);
        above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * relative_step)).collect()
    }

    /// How far derivatives over three steps lie apart.
    fn disagreement(&self, knob: Knob, dt_s: f64, n_steps: usize) -> f64 {
        let [fine, middle, coarse] = [1e-6, 1e-5, 1e-4].map(|step| self.derivative(knob, step, dt_s, n_steps));
        let largest = middle.iter().fold(0.0_f64, |largest, d| largest.max(d.abs()));
        let apart = |other: &[f64]| middle.iter().zip(other).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
        apart(&fine).max(apart(&coarse)) / largest
    }
}

#[derive(Clone, Copy, Debug)]
enum Knob {
    Angle,
    Inertia,
    Effect(u16, usize),
}

const VISCOUS: Knob = Knob::Effect(base::VISCOUS, 0);
const COULOMB: Knob = Knob::Effect(base::COULOMB, 0);
const STICTION: Knob = Knob::Effect(base::STICTION, 0);
const BAND: Knob = Knob::Effect(base::STICTION, 1);

#[test]
fn derivatives_do_not_depend_on_their_step() {
    for (stiction, band) in [(1e-3, 0.0), (1e-3, 0.055), (6e-3, 0.03)] {
        let swing = Swing::new(5.4e-4, 7.1e-4, stiction, band, 1.5);
        for knob in [VISCOUS, COULOMB, Knob::Inertia, Knob::Angle] {
            let apart = swing.disagreement(knob, 1e-3, 10_000);
            assert!(apart < TOLERANCE, "{knob:?} with Ms {stiction}, DV {band}: {apart:e}");
        }
    }
}

#[test]
fn the_band_has_smooth_derivatives_too_while_the_pendulum_swings() {
    let swing = Swing::new(5.4e-4, 7.1e-4, 6e-3, 0.055, 1.5);
    for knob in [STICTION, BAND] {
        let apart = swing.disagreement(knob, 1e-3, 10_000);
        assert!(apart < TOLERANCE, "{knob:?}: {apart:e}");
    }
}

#[test]
fn a_velocity_zero_on_a_step_boundary_ruins_no_derivative() {
    for band in [0.0, 0.03] {
        let swing = Swing::new(5.4e-4, 7.1e-4, 1e-3, band, 1.2);
        let turn_s = first_turn_s(&swing);
        for away_s in [-1e-7, -1e-8, -1e-9, -1e-11, 0.0, 1e-11, 1e-9, 1e-8, 1e-7] {
            // A step of which a whole number ends this far from the first turning point.
            let dt_s = (turn_s + away_s) / (turn_s / 1e-3).round();
            for knob in [VISCOUS, COULOMB, Knob::Inertia, Knob::Angle] {
                let apart = swing.disagreement(knob, dt_s, 3000);
                assert!(apart < TOLERANCE, "{knob:?}, zero {away_s:e} s from a boundary, DV {band}: {apart:e}");
            }
        }
    }
}

/// When the pendulum first turns round, s, by bisection over the length of the last step.
fn first_turn_s(swing: &Swing) -> f64 {
    let model = Model::new(&swing.parameters);
    let mut state = model.release(swing.angle_rad, 0.0);
    let mut before = state;
    while state.velocity_rad_s <= 0.0 {
        before = state;
        model.step(&mut state, 1e-3);
    }
    let (mut early, mut late) = (0.0, 1e-3);
    for _ in 0..50 {
        let middle = 0.5 * (early + late);
        let mut there = before;
        model.step(&mut there, middle);
        if there.velocity_rad_s <= 0.0 { early = middle } else { late = middle }
    }
    before.time_s + late
}
