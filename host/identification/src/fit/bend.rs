//! How predictions bend along a step, and by how much a step has to bend with them.
//!
//! Numbers of a law that depend on each other, such as the speed, the size and the exponent of the Stribeck effect, lie
//! in a narrow valley that is curved: straight steps leave it long before they have kept what they promise, and a
//! search creeps. The second derivative along a step costs two simulations, and the least squares of it are a
//! correction with which the step follows the valley.
//! Source: M. K. Transtrum, B. B. Machta, J. P. Sethna, Phys. Rev. E 83 (2011) 036701, section VIII: geodesic
//! acceleration.

use super::linear::{Linear, SwingLinear, dot};
use super::problem::{PER_SWING, Point, Problem, Start};
use super::step::{Step, stepped};
use nalgebra::DVector;

/// The second derivative is a difference of the predictions after this share of a step and twice of it, the share as in
/// the source. From the derivatives at the start it would be spoilt by what these differences leave out.
const PROBE: f64 = 0.1;

/// Steps from where a problem was linearised, each bent as the predictions are along it.
pub(super) fn bent(problem: &Problem, point: &Point, linear: &Linear, steps: &[Step]) -> Vec<DVector<f64>> {
    let n_unknowns = problem.unknowns.len();
    let after = |share: f64| move |step: &Step| stepped(problem, point, &(&step.change * share));
    let probes: Vec<Point> = steps.iter().map(after(PROBE)).chain(steps.iter().map(after(2.0 * PROBE))).collect();
    let pulls = linear.each(|swing_idx, swing| pulls(problem, swing_idx, swing, &probes, point));
    let bent = |(k, step): (usize, &Step)| {
        let mut gradient = DVector::zeros(step.change.len());
        for (swing_idx, pulls) in pulls.iter().enumerate() {
            let place = |j: usize| if j < n_unknowns { j } else { j + PER_SWING * swing_idx };
            pulls[k].iter().enumerate().for_each(|(j, pull)| gradient[place(j)] += pull);
        }
        &step.change + step.answer(&linear.equations, &gradient)
    };
    steps.iter().enumerate().map(bent).collect()
}

/// Jᵀ times half the second derivative of a swing's residuals along each step; probes after one share of all steps,
/// then after two.
fn pulls(problem: &Problem, swing_idx: usize, swing: &SwingLinear, probes: &[Point], from: &Point) -> Vec<Vec<f64>> {
    let guesses: Vec<(&[f64], Start)> =
        probes.iter().map(|probe| (probe.values.as_slice(), probe.starts[swing_idx])).collect();
    let predicted = problem.predict(swing_idx, swing.residuals.len(), &guesses);
    // Offsets act linearly, so that they may be left out.
    let offset = from.starts[swing_idx].offset_rad;
    let readings = problem.swings[swing_idx].angles_rad.iter().zip(&swing.residuals);
    let begun: Vec<f64> = readings.map(|(reading, residual)| reading - residual - offset).collect();
    let (once, twice) = predicted.split_at(probes.len() / 2);
    let pull = |(once, twice): (&Vec<f64>, &Vec<f64>)| {
        let second = once.iter().zip(twice).zip(&begun).map(|((once, twice), begun)| 2.0 * once - twice - begun);
        let half: Vec<f64> = second.map(|second| second / (2.0 * PROBE.powi(2))).collect();
        swing.columns.iter().map(|column| dot(column, &half)).collect()
    };
    once.iter().zip(twice).map(pull).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::descent::{Tolerance, descend};
    use crate::fit::identify::problem_of;
    use crate::fit::linear::Steps;
    use crate::fit::tally::Tally;
    use crate::swing::{Swing, Window};
    use shared::effect::Effect;
    use shared::parameters::Parameters;

    #[test]
    fn bent_steps_reach_the_end_of_a_curved_valley_in_which_straight_ones_creep() {
        let count = Tally::default();
        let law = Effect::<f64>::by_name("general-stribeck").unwrap();
        let mut rig = Parameters::paper();
        rig.set_friction(4e-4, 5e-4, 0.0, 0.0);
        rig.set(law.id, &[3e-3, 0.7, 0.5]).unwrap();
        let times_s: Vec<f64> = (0..800).map(|i| f64::from(i) * 0.01).collect();
        let swing = |angles_rad: &[f64]| [Swing::new("one", &times_s, angles_rad, 1e-3)];
        let any = swing(&times_s.iter().map(|t| (6.0 * t).cos()).collect::<Vec<f64>>());
        let any = problem_of(&any, &rig, &count);
        let start = Start { angle_rad: 1.2, velocity_rad_s: 0.0, offset_rad: 0.0 };
        let truth = any.template_values();
        let swings = swing(&any.predict(0, times_s.len(), &[(&truth, start)])[0]);
        let problem = problem_of(&swings, &rig, &count);
        let mut from = Point { values: truth, starts: vec![start] };
        let delta = problem.unknowns.iter().position(|unknown| unknown.symbol == "delta").unwrap();
        from.values[delta] = 0.8;
        let cost = |tolerance: Tolerance| {
            descend(&problem, &from, Window::Whole, tolerance, Steps::new(&problem)).cost / problem.least_variance()
        };
        let (straight, bent) = (cost(Tolerance { follows_valleys: false, ..Tolerance::LAST }), cost(Tolerance::LAST));
        // The lowest point costs nothing, because the model made these readings.
        assert!(bent < 0.1 && straight > 10.0 * bent, "{bent} {straight}");
    }
}
