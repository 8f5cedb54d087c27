//! How far rounding can tell levels apart that stop the pendulum elsewhere.
//!
//! A sensor that no noise moves is wrong alike for as long as the pendulum rests: its many readings there tell the angle no
//! better than one of them, to within a step. So a level is no less likely for what its cost rises by as long as rounding
//! explains that: along the difference d of what two levels leave, once the smooth numbers have answered, rounding
//! errors e have the variance v² = Var(dᵀe)/dᵀd in place of that of white noise, with Var from the harmonics of
//! `fit/rounding.rs`. Of a rest of n readings that one step holds, v² is n·Δ²/12.

use super::answered::Left;
use super::arrow::ArrowFactor;
use super::fitted::Stiction;
use super::linear::{Linear, SwingLinear, dot};
use super::problem::{Point, Problem};
use super::rounding::Grid;
use super::solve::ANSWER_DAMPING;
use nalgebra::DVector;

/// v² of each pair beside one of them, rad²; 0 where noise hides all steps, and of that pair itself.
pub(super) fn rounded_between(
    problem: &Problem,
    linear: &Linear,
    point: &Point,
    tried: &[Stiction],
    own: usize,
) -> Vec<f64> {
    let left = Left::by(problem, point, tried);
    let of_swing = |swing_idx: usize, known: &SwingLinear| {
        let left = left.of_swing(swing_idx);
        let waves: Vec<Vec<f64>> = match Grid::of(&problem.swings[swing_idx], &left[own]) {
            Some(grid) => grid.waves(&left[own]).collect(),
            None => Vec::new(),
        };
        let between = left.iter().map(|other| other.iter().zip(&left[own]).map(|(a, b)| a - b).collect());
        Apart::new(known, &between.collect::<Vec<Vec<f64>>>(), &waves)
    };
    let swings = linear.each(of_swing);
    let n_waves = swings.iter().map(|swing| swing.of_waves.len()).max().unwrap_or(0);
    if n_waves == 0 {
        return vec![0.0; tried.len()];
    }
    let factor = ArrowFactor::new(&linear.equations.normal, ANSWER_DAMPING, |_| true);
    let of_waves: Vec<DVector<f64>> =
        (0..n_waves).map(|k| linear.together(swings.iter().map(|swing| swing.of_waves.get(k)))).collect();
    let of_pair = |i: usize| {
        let slopes = linear.together(swings.iter().map(|swing| swing.slopes.get(i)));
        let answer = factor.solve(&slopes);
        let square = swings.iter().map(|swing| swing.squares[i]).sum::<f64>() - slopes.dot(&answer);
        let along = |k: usize| {
            let together: f64 = swings.iter().filter_map(|swing| swing.along[i].get(k)).sum();
            together - of_waves[k].dot(&answer)
        };
        if i == own || square <= 0.0 { 0.0 } else { (0..n_waves).map(|k| along(k).powi(2)).sum::<f64>() / square }
    };
    (0..tried.len()).map(of_pair).collect()
}

/// What sets pairs apart in one swing.
struct Apart {
    /// dᵀd of each pair.
    squares: Vec<f64>,
    /// Jᵀd of each pair.
    slopes: Vec<Vec<f64>>,
    /// dᵀw of each pair and wave of rounding.
    along: Vec<Vec<f64>>,
    /// Jᵀw of each wave.
    of_waves: Vec<Vec<f64>>,
}

impl Apart {
    fn new(known: &SwingLinear, between: &[Vec<f64>], waves: &[Vec<f64>]) -> Self {
        let products = |of: &[Vec<f64>], with: &[Vec<f64>]| -> Vec<Vec<f64>> {
            of.iter().map(|a| with.iter().map(|b| dot(a, b)).collect()).collect()
        };
        Self {
            squares: between.iter().map(|d| dot(d, d)).collect(),
            slopes: products(between, &known.columns),
            along: products(between, waves),
            of_waves: products(waves, &known.columns),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::fit::fitted::{Fitted, Stiction};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::stop_level::{levels, likely};
    use crate::fit::tally::Tally;
    use crate::fit::tests::{PENDULUM, at_rest, dry_swing};
    use crate::swing::Swing;
    use shared::parameters::Parameters;

    /// The torque beyond Mc at which dry friction stops the pendulum for the fifth time, N·m: were it held no more, it would
    /// move by twice as much over m·g·l.
    const BEYOND_NM: f64 = 3e-6;

    /// Likely levels of a pendulum that a level above that torque holds there, read in steps of so many times that move;
    /// and the truth. Turning points are 2·Mc/m·g·l apart.
    fn likely_levels(moves_a_step: f64) -> ((f64, f64), [f64; 3]) {
        let (gravity_nm, count) = (PENDULUM.gravity_torque_nm(), Tally::default());
        let coulomb_nm = (0.02 * gravity_nm - BEYOND_NM) / 11.0;
        let stop_nm = coulomb_nm + BEYOND_NM;
        let level_nm = 2.0 * coulomb_nm;
        let [swing] = dry_swing(coulomb_nm, level_nm);
        let step_rad = 2.0 * BEYOND_NM / gravity_nm * moves_a_step;
        let read = |angle: &f64| if step_rad > 0.0 { step_rad * (angle / step_rad).round() } else { *angle };
        let readings: Vec<f64> = swing.angles_rad.iter().map(read).collect();
        let swings = [Swing::new("dry", &swing.times_s, &readings, (step_rad / 12.0_f64.sqrt()).max(1e-7))];
        let mut rig = Parameters::frictionless(PENDULUM);
        rig.set_friction(0.0, coulomb_nm, 0.0, 0.0);
        let problem = problem_of(&swings, &rig, &count);
        let point = Point { values: problem.template_values(), starts: at_rest(0.02) };
        let from = Fitted::at(&problem, &point).with_stiction(Stiction::level(1.01 * stop_nm));
        let model = levels(&problem, &from).swap_remove(0);
        (likely(&problem, &model, 2.71 * problem.noise_rad().powi(2)), [coulomb_nm, stop_nm, level_nm])
    }

    #[test]
    fn a_last_move_of_an_eighth_of_a_step_may_have_been_or_not() {
        let ((low, high), [coulomb_nm, stop_nm, level_nm]) = likely_levels(8.0);
        assert!(
            low < 0.5 * (coulomb_nm + stop_nm) && high > level_nm,
            "{low} … {high} of {coulomb_nm}, {stop_nm}, {level_nm}"
        );
    }

    #[test]
    fn a_last_move_that_is_seen_is_known() {
        let ((low, high), [_, stop_nm, level_nm]) = likely_levels(0.0);
        assert!(low > 0.99 * stop_nm && high > level_nm, "{low} … {high} of {stop_nm}, {level_nm}");
    }
}
