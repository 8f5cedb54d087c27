//! How well each number is known: covariance of the least-squares estimate, allowing for coloured residuals.
//!
//! For white residuals the covariance is s²·(JᵀJ)⁻¹. Real residuals are correlated from sample to sample, so the
//! covariance S of the scores stands in the middle: (JᵀJ)⁻¹·S·(JᵀJ)⁻¹, with S from sums over blocks that are longer than
//! the residuals' memory. A model that lacks physics errs coherently over the whole decay: there no number is taken to
//! be surer than its scatter over the [`super::clusters`], and than what these would move it by. What rounding does to the
//! numbers where no noise hides the steps of a sensor stands in `fit/rounding.rs`, and makes no residual coloured.
//! Source: H. R. Künsch, Ann. Stat. 17 (1989) 1217, for blocks; H. White, Econometrica 48 (1980) 817, for the sandwich.

use super::arrow::Arrow;
use super::clusters::{clusters, clusters_beside_wander, spread, upward_crossings};
use super::linear::{Linear, SwingLinear, dot};
use super::memory::{Again, Residuals};
use super::problem::{PER_SWING, Problem, Start};
use super::rounding::{Rounding, rounding};
use super::solve::RANK;
use nalgebra::{DMatrix, DVector};

/// Blocks at least this many times longer than the residuals' memory.
const BLOCK_OF_MEMORIES: usize = 4;

/// Uncertainties of all columns of a linearisation.
#[derive(Clone, Debug)]
pub struct Covariance {
    /// Covariance matrix; unknowns first, then the starts.
    pub matrix: DMatrix<f64>,
    /// True if the residuals are correlated in time.
    pub coloured: bool,
}

impl Covariance {
    /// Standard deviation of a column; `None` if the data say nothing about it.
    pub fn std(&self, column: usize) -> Option<f64> {
        let variance = self.matrix[(column, column)];
        (variance.is_finite() && variance > 0.0).then(|| variance.sqrt())
    }

    /// With moves of all columns in it that are as likely to any share of themselves.
    pub(super) fn with_any_share_of(self, moves: &DVector<f64>) -> Self {
        self.with_square(moves, 1.0 / 3.0)
    }

    /// With moves of all columns in it that are one of so many.
    pub(super) fn with_share(self, moves: &DVector<f64>, n: usize) -> Self {
        self.with_square(moves, 1.0 / n as f64)
    }

    fn with_square(mut self, moves: &DVector<f64>, share: f64) -> Self {
        for (i, j) in (0..moves.len()).flat_map(|i| (0..moves.len()).map(move |j| (i, j))) {
            self.matrix[(i, j)] += share * moves[i] * moves[j];
        }
        self
    }

    /// The same where no column is surer than a variance that is told of it.
    pub(super) fn no_surer(self, than: impl Fn(usize) -> Option<f64>) -> Self {
        let size = self.matrix.nrows();
        let least = DMatrix::from_fn(size, size, |i, j| if i == j { than(i).unwrap_or(0.0) } else { 0.0 });
        Self { matrix: larger_diagonal(self.matrix, &least), ..self }
    }

    /// Correlation of two columns, which their scatter over clusters may have left beyond one.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        Some((self.matrix[(i, j)] / (self.std(i)? * self.std(j)?)).clamp(-1.0, 1.0))
    }
}

/// The covariance at a linearisation; a column without effect has an infinite variance. `None` if rounding spoils all.
pub fn covariance(linear: &Linear) -> Option<Covariance> {
    let memories = linear.each(|_, swing| Residuals::new(&swing.residuals).memory());
    with_memory(linear, memories.into_iter().max().unwrap_or(0))
}

/// The same where residuals stay alike for so many samples.
fn with_memory(linear: &Linear, memory: usize) -> Option<Covariance> {
    let equations = &linear.equations;
    let size = equations.gradient.len();
    let normal = equations.normal.dense();
    let scale = DVector::from_fn(size, |i, _| normal[(i, i)].sqrt());
    let has_effect = |i: usize| scale[i].is_normal();
    // Columns that are each other's copy have a variance that is enormous, but a number.
    let unit = DMatrix::from_fn(size, size, |i, j| match (i == j, has_effect(i) && has_effect(j)) {
        (true, true) => 1.0 + RANK,
        (true, false) => 1.0,
        (false, true) => normal[(i, j)] / (scale[i] * scale[j]),
        (false, false) => 0.0,
    });
    let inverse = unit.cholesky()?.inverse();
    let dof = equations.n_samples.saturating_sub(size).max(1) as f64;
    let middle = if memory == 0 {
        &inverse * (equations.cost / dof)
    } else {
        let scores = score_covariance(linear, memory * BLOCK_OF_MEMORIES);
        let score = |i: usize, j: usize| {
            if has_effect(i) && has_effect(j) { scores[(i, j)] / (scale[i] * scale[j]) } else { 0.0 }
        };
        let sandwich = &inverse * DMatrix::from_fn(size, size, score) * &inverse;
        let white = &inverse * (equations.cost / dof);
        // The sandwich is an estimate from few blocks; it is never taken to be surer than white noise.
        larger_diagonal(sandwich, &white)
    };
    let matrix = DMatrix::from_fn(size, size, |i, j| match (i == j, has_effect(i) && has_effect(j)) {
        (_, true) => middle[(i, j)] / (scale[i] * scale[j]),
        (true, false) => f64::INFINITY,
        (false, false) => 0.0,
    });
    // Rounding alone makes the two halves differ.
    let matrix = 0.5 * (&matrix + matrix.transpose());
    Some(Covariance { matrix, coloured: memory > 0 })
}

/// The covariance at a linearisation of swings that began thus, with the error of the model in it where it shows, and with
/// what rounding to the steps of the sensor does.
pub fn with_model_error(on: &Problem, linear: &Linear, starts: &[Start]) -> Option<Covariance> {
    let covariance = of_noise_and_misfit(on, linear, starts)?;
    Some(match rounding(on, linear) {
        Some(rounding) => with_rounding(covariance, &rounding),
        None => covariance,
    })
}

/// Rounding takes the place of its share of the noise; no number becomes surer by it.
fn with_rounding(covariance: Covariance, rounding: &Rounding) -> Covariance {
    let Covariance { matrix: before, coloured } = covariance;
    let has_effect = |i: usize| before[(i, i)].is_finite();
    let after = DMatrix::from_fn(before.nrows(), before.ncols(), |i, j| match has_effect(i) && has_effect(j) {
        true => (1.0 - rounding.share) * before[(i, j)] + rounding.matrix[(i, j)],
        false => before[(i, j)],
    });
    Covariance { matrix: larger_diagonal(after, &before), coloured }
}

/// The same but for rounding.
fn of_noise_and_misfit(on: &Problem, linear: &Linear, starts: &[Start]) -> Option<Covariance> {
    let look = |swing_idx: usize, swing: &SwingLinear| {
        let mut residuals = Residuals::rounded(&on.swings[swing_idx], &swing.residuals);
        let memory = residuals.memory();
        let crossings = || upward_crossings(on, swing, swing_idx, starts[swing_idx].offset_rad);
        (memory, if memory > 0 { residuals.come_again(&crossings(), memory) } else { Again::No })
    };
    let (memories, come_again): (Vec<usize>, Vec<Again>) = linear.each(look).into_iter().unzip();
    let covariance = with_memory(linear, memories.into_iter().max().unwrap_or(0))?;
    let clusters = match () {
        () if come_again.contains(&Again::Always) => clusters_beside_wander(on, linear, starts),
        () if come_again.contains(&Again::EachPeriod) => clusters(on, linear, starts, |_| true),
        () => return Some(covariance),
    };
    let Some(spread) = spread(&clusters) else { return Some(covariance) };
    let (n_unknowns, size) = (linear.n_unknowns(), linear.equations.gradient.len());
    let place = |j: usize| if j < n_unknowns { j } else { n_unknowns + PER_SWING * (j - n_unknowns) + PER_SWING - 1 };
    let mut least = DMatrix::zeros(size, size);
    for (j, std) in spread.stds.iter().enumerate() {
        let variance = std.map_or(0.0, |std| std.powi(2) + spread.step[j].powi(2));
        least[(place(j), place(j))] = variance;
    }
    let alone = spread.stds.iter().enumerate().filter(|(_, std)| std.is_none()).map(|(j, _)| place(j));
    for (i, variance) in alone.map(|i| (i, by_the_others(&covariance, &least, i))).collect::<Vec<_>>() {
        least[(i, i)] = variance;
    }
    Some(Covariance { matrix: larger_diagonal(covariance.matrix, &least), ..covariance })
}

/// The variance of a number that clusters say nothing of, since one of them tells it alone: what the least of the others
/// makes of it, with which it is correlated.
fn by_the_others(covariance: &Covariance, least: &DMatrix<f64>, i: usize) -> f64 {
    let slope = |j: usize| covariance.matrix[(i, j)] / covariance.matrix[(j, j)];
    let moved = (0..least.nrows()).filter(|j| *j != i).map(|j| slope(j).powi(2) * least[(j, j)]);
    moved.filter(|variance| variance.is_finite()).fold(0.0, f64::max)
}

/// Scales rows and columns so that no variance is below that of `least`.
fn larger_diagonal(matrix: DMatrix<f64>, least: &DMatrix<f64>) -> DMatrix<f64> {
    let factor = |i: usize| match matrix[(i, i)].is_finite() {
        true => (least[(i, i)] / matrix[(i, i)].max(1e-300)).max(1.0).sqrt(),
        false => 1.0,
    };
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] * factor(i) * factor(j))
}

/// Sum over blocks of the products of Jᵀr: the covariance of the scores when blocks are independent.
fn score_covariance(linear: &Linear, block: usize) -> DMatrix<f64> {
    let of_swing = |_: usize, swing: &SwingLinear| {
        let mut sum = DMatrix::zeros(swing.columns.len(), swing.columns.len());
        for from in (0..swing.residuals.len()).step_by(block) {
            let to = (from + block).min(swing.residuals.len());
            let of_column = |column: &Vec<f64>| dot(&column[from..to], &swing.residuals[from..to]);
            let score = DVector::from_iterator(swing.columns.len(), swing.columns.iter().map(of_column));
            sum += &score * score.transpose();
        }
        sum
    };
    Arrow::new(linear.n_unknowns(), PER_SWING, &linear.each(of_swing)).dense()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::clusters::Cluster;
    use crate::fit::linear::{Steps, linearise};
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;
    use crate::fit::tests::{PENDULUM, RELEASE_RAD, at_rest, times_s, viscous_problem, viscous_rad};
    use crate::swing::{Swing, Window};

    #[test]
    fn what_one_cluster_alone_tells_is_no_surer_than_what_it_is_correlated_with() {
        let covariance = Covariance { matrix: DMatrix::from_row_slice(2, 2, &[4.0, -1.9, -1.9, 1.0]), coloured: true };
        let least = DMatrix::from_diagonal(&DVector::from_vec(vec![400.0, 0.0]));
        // The first is ten times as uncertain, and 1 of it moves the second by 1.9/4.
        assert!((by_the_others(&covariance, &least, 1) - (1.9_f64 / 4.0).powi(2) * 400.0).abs() < 1e-9);
        assert_eq!(by_the_others(&covariance, &DMatrix::zeros(2, 2), 1), 0.0);
    }

    /// A viscous swing with these angles, linearised where the model is beside it.
    fn linearised<T>(
        angle: impl Fn(f64) -> f64,
        beside: impl Fn(&mut Point),
        of: impl FnOnce(&Problem, &Linear, &[Start]) -> T,
    ) -> T {
        let (times_s, count) = (times_s(20.0), Tally::default());
        let angles_rad: Vec<f64> = times_s.iter().map(|t| angle(*t)).collect();
        let swings = [Swing::new("one", &times_s, &angles_rad, 1e-8)];
        let problem = viscous_problem(&swings, VISCOUS, &count);
        let mut point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
        let mut steps = Steps::found(&problem, &point);
        beside(&mut point);
        let linear = linearise(&problem, &point, Window::Whole, &mut steps);
        of(&problem, &linear, &point.starts)
    }

    /// Standard deviations of Mw, I, start angle, start velocity and zero of such a swing.
    fn stds(angle: impl Fn(f64) -> f64, beside: impl Fn(&mut Point)) -> Vec<f64> {
        let found = linearised(angle, beside, |on, linear, starts| with_model_error(on, linear, starts).unwrap());
        (0..5).map(|j| found.std(j).unwrap()).collect()
    }

    #[test]
    fn windows_that_have_a_zero_of_their_own_are_blind_to_one_that_is_off() {
        let off = |time_s: f64| swinging(PENDULUM.inertia_kg_m2)(time_s) + 1e-3;
        let largest = |clusters: &[Cluster], j: usize| {
            clusters.iter().map(|cluster| cluster.sums().gradient[j].abs()).fold(0.0, f64::max)
        };
        linearised(
            off,
            |_| (),
            |on, linear, starts| {
                let (one, own) = (clusters(on, linear, starts, |_| true), clusters_beside_wander(on, linear, starts));
                assert!(one.iter().all(|cluster| cluster.sums().gradient.len() == 3) && largest(&one, 2) > 1e-3);
                assert!(own.len() >= 10 && own.iter().all(|cluster| cluster.sums().gradient.len() == 2));
                for j in 0..2 {
                    assert!(
                        largest(&own, j) < 1e-3 * largest(&one, j),
                        "{j}: {} {}",
                        largest(&own, j),
                        largest(&one, j)
                    );
                }
            },
        );
    }

    const VISCOUS: f64 = 4e-5;

    fn swinging(inertia_kg_m2: f64) -> impl Fn(f64) -> f64 {
        move |time_s| viscous_rad(VISCOUS, inertia_kg_m2, time_s)
    }

    #[test]
    fn a_number_is_no_surer_than_what_the_clusters_would_move_it_by() {
        let inertia = PENDULUM.inertia_kg_m2;
        // Each cluster wants the true inertia, and all of them the same.
        let off_kg_m2 = 1e-6;
        let found = stds(swinging(inertia), |point| point.values[1] += off_kg_m2);
        assert!((found[1] / off_kg_m2 - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn a_number_is_no_surer_than_the_clusters_scatter() {
        // The pendulum is lighter for ten seconds and heavier afterwards; the model is in the middle.
        let (inertia, off_kg_m2) = (PENDULUM.inertia_kg_m2, 1e-6);
        let [light, heavy] = [-off_kg_m2, off_kg_m2].map(|off| swinging(inertia + off));
        let angular = |off: f64| {
            let pivot = PENDULUM.pivot_inertia_kg_m2() + off;
            (PENDULUM.gravity_torque_nm() / pivot).sqrt()
        };
        // The later swing has the phase that the earlier one left.
        let later_s = |time_s: f64| 10.0 * angular(-off_kg_m2) / angular(off_kg_m2) + time_s - 10.0;
        let found = stds(|t| if t < 10.0 { light(t) } else { heavy(later_s(t)) }, |_| ());
        // Seven clusters of +1 and seven of −1: partial sums 1, 2, … 7, … 1, 0, whose squares sum to 231.
        let wandering = off_kg_m2 * (2.0 * 231.0 / 14.0_f64.powi(3)).sqrt() * 4.771 / 1.96;
        assert!((found[1] / wandering - 1.0).abs() < 0.3, "{found:?} {wandering}");
    }
}
