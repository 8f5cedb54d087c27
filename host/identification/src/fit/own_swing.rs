//! For tests: swings by the equation of motion alone, integrated here and nowhere else.

use crate::diagnose::tests::{NOISE_RAD, rig};
use crate::random::Noise;
use crate::swing::Swing;

const STEP_S: f64 = 5e-4;

/// Steps from one sample to the next.
const STEPS: usize = 20;

/// Twelve seconds of the tests' rig, released from an angle (rad), with one more torque (N·m, of angle and velocity).
pub(crate) fn swing(release_rad: f64, more: impl Fn(f64, f64) -> f64) -> Swing {
    let pendulum = rig().pendulum;
    let (gravity, inertia) = (pendulum.gravity_torque_nm(), pendulum.pivot_inertia_kg_m2());
    let faster = |[x, v]: [f64; 2]| (-gravity * x.sin() - 4e-4 * v - 3e-4 * v.signum() + more(x, v)) / inertia;
    let rate = |state: [f64; 2]| [state[1], faster(state)];
    let ahead = |[x, v]: [f64; 2], [a, b]: [f64; 2], share: f64| [x + share * STEP_S * a, v + share * STEP_S * b];
    let (mut state, mut noise) = ([release_rad, 0.0], Noise::new(5));
    let times_s: Vec<f64> = (0..1200).map(|i| f64::from(i) * STEPS as f64 * STEP_S).collect();
    let mut angles_rad = Vec::new();
    for _ in &times_s {
        angles_rad.push(state[0] + NOISE_RAD * noise.normal());
        for _ in 0..STEPS {
            let first = rate(state);
            let second = rate(ahead(state, first, 0.5));
            let third = rate(ahead(state, second, 0.5));
            let fourth = rate(ahead(state, third, 1.0));
            let sum = [0, 1].map(|i| (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]) / 6.0);
            state = ahead(state, sum, 1.0);
        }
    }
    Swing::new("own", &times_s, &angles_rad, NOISE_RAD)
}
