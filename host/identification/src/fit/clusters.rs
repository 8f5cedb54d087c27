//! Swings cut into clusters, each of which tells the numbers anew: how far these scatter is how well they are known.
//!
//! Residuals that are no noise are coherent over a whole decay, so that samples, or blocks of a period, are no independent
//! witnesses. Every swing is cut into windows of a few periods; in each the model may begin anew, so that what a wrong
//! one has gathered before is not held against it again. That needs no further simulation: to first order a new start adds
//! a solution of the homogeneous variational equation, of which the derivatives to the swing's own start are two, so these
//! are taken out of every column within each window. From six releases on, whole releases are the clusters.
//! Neighbours are joined until about `WANTED` clusters tell about the same.
//!
//! The spread is a delete-one jackknife over the clusters: as independent values, by Student's t of K − 1 degrees of
//! freedom, and as values that wander in the order of time, because a misfit that depends on the amplitude goes on from
//! window to window; the larger one counts.
//! Source: A. C. Cameron, D. L. Miller, J. Human Resources 50 (2015) 317, section VI; P. Young, Recursive Estimation and
//! Time-Series Analysis (Springer 1984) for windows with starts of their own.

use super::linear::{Linear, SwingLinear, dot};
use super::phase;
use super::problem::{PER_SWING, Problem, Start};
use super::solve::Factor;
use crate::cores::on_all_cores;
use crate::verdict::SEEN_NOISES;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::Range;

/// So many clusters are wanted: a spread from 14 is known to 20 %, and more would be shorter than what they shall judge.
const WANTED: usize = 14;

/// Periods in a window: the longest that leave enough clusters, none of which tells a number alone. How the loss depends on
/// the amplitude shows in a window the better the longer it is, but what a wrong model gathers grows too.
const PERIODS: [usize; 5] = [8, 5, 3, 2, 1];

/// With so many clusters a spread is known to a quarter.
const ENOUGH: usize = 10;

/// From so many releases on, each is a cluster.
pub const RELEASES: usize = 6;

/// Where one cluster alone tells a number to this share, nothing repeats it.
const ALONE: f64 = 0.75;

/// Squared length that is left of a column of length one when others explain it: rounding.
const DEPENDENT: f64 = 1e-10;

/// The normal equations of samples, over the numbers that all clusters share.
#[derive(Clone, Debug)]
pub struct Sums {
    /// ZᵀZ.
    pub matrix: DMatrix<f64>,
    /// Zᵀr.
    pub gradient: DVector<f64>,
}

impl Sums {
    /// Of no samples.
    pub fn zeros(size: usize) -> Self {
        Self { matrix: DMatrix::zeros(size, size), gradient: DVector::zeros(size) }
    }

    /// Both together.
    pub fn add(&mut self, other: &Self) {
        self.matrix += &other.matrix;
        self.gradient += &other.gradient;
    }

    /// The first without the second.
    pub fn without(&self, other: &Self) -> Self {
        Self { matrix: &self.matrix - &other.matrix, gradient: &self.gradient - &other.gradient }
    }
}

/// Samples that are one witness.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// The swing it is of.
    pub swing_idx: usize,
    /// Its samples, by the windows that begin anew.
    pub windows: Vec<Range<usize>>,
    /// Its samples left of the middle and right of it.
    pub sides: [Sums; 2],
}

impl Cluster {
    /// All of its samples.
    pub fn sums(&self) -> Sums {
        let mut sums = self.sides[0].clone();
        sums.add(&self.sides[1]);
        sums
    }
}

/// What clusters say of the numbers they share.
#[derive(Clone, Debug)]
pub struct Spread {
    /// By how much the clusters together would move each number from where the model has it.
    pub step: DVector<f64>,
    /// Standard deviations, widened so that ± 1.96 of them hold 95 %; `None` where one cluster alone tells a number.
    pub stds: Vec<Option<f64>>,
    /// The jackknife's standard errors, as they are.
    pub errors: Vec<Option<f64>>,
    /// K, how many clusters there are.
    pub n_clusters: usize,
}

/// The clusters of linearised swings: normal equations over the unknowns and, where windows are cut, one offset a swing;
/// cut so that no cluster alone tells one of the columns that matter.
pub fn clusters(on: &Problem, linear: &Linear, starts: &[Start], matters: impl Fn(usize) -> bool) -> Vec<Cluster> {
    clusters_with(on, linear, starts, PER_SWING - 1, matters)
}

/// The same where the zero wanders: each window has its own one, and says nothing of the swing's.
pub fn clusters_beside_wander(on: &Problem, linear: &Linear, starts: &[Start]) -> Vec<Cluster> {
    clusters_with(on, linear, starts, PER_SWING, |_| true)
}

fn clusters_with(
    on: &Problem,
    linear: &Linear,
    starts: &[Start],
    n_own: usize,
    matters: impl Fn(usize) -> bool,
) -> Vec<Cluster> {
    if linear.n_swings() >= RELEASES {
        return whole_swings(on, linear);
    }
    let quarters_of = |swing_idx, swing: &SwingLinear| {
        let predicted = predicted(on, swing, swing_idx, starts[swing_idx].offset_rad);
        phase::quarters(&predicted, seen_rad(on, swing_idx))
    };
    let quarters: Vec<Vec<usize>> = linear.each(quarters_of);
    let mut best: (usize, Vec<Cluster>) = (usize::MAX, Vec::new());
    for periods in PERIODS {
        let found = joined(windows(on, linear, &quarters, periods, n_own));
        let n_doubtful = match spread(&found) {
            Some(spread) if found.len() >= ENOUGH => {
                (0..spread.stds.len()).filter(|j| matters(*j) && spread.stds[*j].is_none()).count()
            }
            _ => linear.equations.gradient.len() + ENOUGH.saturating_sub(found.len()),
        };
        if n_doubtful < best.0 {
            best = (n_doubtful, found);
        }
        if n_doubtful == 0 {
            break;
        }
    }
    best.1
}

/// Windows of so many periods, to which so many of a swing's start, velocity and offset belong.
fn windows(on: &Problem, linear: &Linear, quarters: &[Vec<usize>], periods: usize, n_own: usize) -> Vec<Cluster> {
    let n_unknowns = linear.n_unknowns();
    let size = n_unknowns + (PER_SWING - n_own) * linear.n_swings();
    let of_swing = |swing_idx: usize, swing: &SwingLinear| -> Vec<Cluster> {
        let (own, offset) = swing.columns[n_unknowns..].split_at(n_own);
        let mut shared: Vec<(usize, &[f64])> =
            swing.columns[..n_unknowns].iter().map(Vec::as_slice).enumerate().collect();
        shared.extend(offset.iter().map(|offset| (n_unknowns + swing_idx, offset.as_slice())));
        let of_window = |range| cluster(on, swing_idx, swing, range, own, &shared, size);
        on_all_cores(phase::windows(&quarters[swing_idx], periods, swing.residuals.len()), of_window)
    };
    linear.each(of_swing).concat()
}

/// Whole releases, each with its start and offset taken out.
fn whole_swings(on: &Problem, linear: &Linear) -> Vec<Cluster> {
    let n_unknowns = linear.n_unknowns();
    linear.each(|swing_idx, swing| {
        let (shared, own) = swing.columns.split_at(n_unknowns);
        let shared: Vec<(usize, &[f64])> = shared.iter().map(Vec::as_slice).enumerate().collect();
        cluster(on, swing_idx, swing, 0..swing.residuals.len(), own, &shared, n_unknowns)
    })
}

/// Where the predicted angle goes upward through the middle.
pub(super) fn upward_crossings(on: &Problem, swing: &SwingLinear, swing_idx: usize, offset_rad: f64) -> Vec<usize> {
    phase::upward_crossings(&predicted(on, swing, swing_idx, offset_rad), seen_rad(on, swing_idx))
}

/// The predicted angle in rad, without its offset.
fn predicted(on: &Problem, swing: &SwingLinear, swing_idx: usize, offset_rad: f64) -> Vec<f64> {
    let angles_rad = &on.swings[swing_idx].angles_rad;
    swing.residuals.iter().zip(angles_rad).map(|(residual, angle)| angle - residual - offset_rad).collect()
}

/// A swing beyond zero that rises by less is none.
fn seen_rad(on: &Problem, swing_idx: usize) -> f64 {
    SEEN_NOISES * on.swings[swing_idx].noise_rad
}

/// One window: what its own columns explain is taken out of residuals and shared columns, which stand at the given
/// places.
fn cluster(
    on: &Problem,
    swing_idx: usize,
    swing: &SwingLinear,
    range: Range<usize>,
    own: &[Vec<f64>],
    shared: &[(usize, &[f64])],
    size: usize,
) -> Cluster {
    let basis = orthonormal(own.iter().map(|column| &column[range.clone()]));
    let residuals = beyond(&swing.residuals[range.clone()], &basis);
    let columns: Vec<Vec<f64>> = shared.iter().map(|(_, column)| beyond(&column[range.clone()], &basis)).collect();
    let angles = &on.swings[swing_idx].angles_rad[range.clone()];
    let side = |is_right: bool| {
        let mut sums = Sums::zeros(size);
        let mask: Vec<f64> = angles.iter().map(|angle| f64::from(u8::from((*angle >= 0.0) == is_right))).collect();
        let masked = |column: &[f64]| column.iter().zip(&mask).map(|(x, m)| x * m).collect::<Vec<f64>>();
        let here: Vec<Vec<f64>> = columns.iter().map(|column| masked(column)).collect();
        for (i, (at, _)) in shared.iter().enumerate() {
            sums.gradient[*at] = dot(&here[i], &residuals);
            for (j, (other, _)) in shared[..=i].iter().enumerate() {
                let product = dot(&here[i], &columns[j]);
                (sums.matrix[(*at, *other)], sums.matrix[(*other, *at)]) = (product, product);
            }
        }
        sums
    };
    let sides = [side(false), side(true)];
    Cluster { swing_idx, windows: vec![range], sides }
}

/// Columns of length one at right angles that span the given ones.
pub(super) fn orthonormal<'a>(columns: impl Iterator<Item = &'a [f64]>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for column in columns {
        // Twice, because one pass loses digits where columns are nearly alike.
        let left = beyond(&beyond(column, &basis), &basis);
        let (before, after) = (dot(column, column), dot(&left, &left));
        if after > DEPENDENT * before && after > 0.0 {
            let length = after.sqrt();
            basis.push(left.into_iter().map(|x| x / length).collect());
        }
    }
    basis
}

/// What is left of a column that the basis does not explain.
pub(super) fn beyond(column: &[f64], basis: &[Vec<f64>]) -> Vec<f64> {
    let mut left = column.to_vec();
    for direction in basis {
        let share = dot(&left, direction);
        left.iter_mut().zip(direction).for_each(|(x, d)| *x -= share * d);
    }
    left
}

/// Neighbours joined until there are about [`WANTED`] clusters that tell about the same.
fn joined(windows: Vec<Cluster>) -> Vec<Cluster> {
    let Some(first) = windows.first() else { return windows };
    let mut all = Sums::zeros(first.sides[0].gradient.len());
    windows.iter().for_each(|window| all.add(&window.sums()));
    let told = information(&windows, &all);
    let a_share = told.iter().sum::<f64>() / WANTED as f64;
    let mut clusters: Vec<Cluster> = Vec::new();
    let mut filled = f64::INFINITY;
    for (window, told) in windows.into_iter().zip(told) {
        match clusters.last_mut() {
            Some(last) if last.swing_idx == window.swing_idx && filled + 0.5 * told < a_share => {
                (0..2).for_each(|side| last.sides[side].add(&window.sides[side]));
                last.windows.extend(window.windows);
                filled += told;
            }
            _ => {
                clusters.push(window);
                filled = told;
            }
        }
    }
    clusters
}

/// How much each window tells of all numbers: the trace of A⁻¹·Aₖ.
fn information(windows: &[Cluster], all: &Sums) -> Vec<f64> {
    let factor = Factor::new(&all.matrix, 0.0, |_| true);
    let inverse = factor.inverse();
    windows.iter().map(|window| inverse.component_mul(&window.sums().matrix).sum()).collect()
}

/// What another model leaves in the same clusters, rad², with a new start in each window; its linearisation may have the
/// columns of the starts alone. Clusters stand in the order of their swings.
pub fn squares(linear: &Linear, like: &[Cluster]) -> Vec<f64> {
    let of_window = |swing: &SwingLinear, range: &Range<usize>| {
        let starts = &swing.columns[swing.columns.len() - PER_SWING..];
        let basis = orthonormal(starts.iter().map(|column| &column[range.clone()]));
        let left = beyond(&swing.residuals[range.clone()], &basis);
        dot(&left, &left)
    };
    let of_swing = |swing_idx: usize, swing: &SwingLinear| -> Vec<f64> {
        let own = like.iter().filter(|cluster| cluster.swing_idx == swing_idx);
        own.map(|cluster| cluster.windows.iter().map(|range| of_window(swing, range)).sum()).collect()
    };
    linear.each(of_swing).concat()
}

/// Does a sum over clusters differ from zero, by Student's t at 95 %?
pub fn is_beyond_chance(values: &[f64]) -> bool {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let Ok(freedom) = StudentsT::new(0.0, 1.0, values.len().saturating_sub(1) as f64) else { return false };
    mean.abs() > freedom.inverse_cdf(0.975) * std_of_mean(values)
}

/// The jackknife over clusters; `None` with fewer than two.
pub fn spread(clusters: &[Cluster]) -> Option<Spread> {
    let sums: Vec<Sums> = clusters.iter().map(Cluster::sums).collect();
    spread_of(&sums)
}

/// The same over any sums.
pub fn spread_of(sums: &[Sums]) -> Option<Spread> {
    let n_clusters = sums.len();
    let size = sums.first()?.gradient.len();
    let mut all = Sums::zeros(size);
    sums.iter().for_each(|sums| all.add(sums));
    let factor = Factor::new(&all.matrix, 0.0, |_| true);
    let (step, variances) = (factor.solve(&all.gradient), factor.inverse().diagonal());
    let freedom = StudentsT::new(0.0, 1.0, n_clusters.checked_sub(1).filter(|n| *n > 0)? as f64).ok()?;
    let widening = freedom.inverse_cdf(0.975) / NORMAL_95;
    let mut is_alone = vec![false; size];
    let mut values: Vec<DVector<f64>> = Vec::new();
    for one in sums {
        let rest = all.without(one);
        let factor = Factor::new(&rest.matrix, 0.0, |_| true);
        let wider = factor.inverse().diagonal();
        (0..size).for_each(|j| is_alone[j] |= wider[j] * (1.0 - ALONE) > variances[j] || wider[j] <= 0.0);
        // The jackknife's pseudo-value: what this cluster alone would have said.
        values.push(&step * n_clusters as f64 - factor.solve(&rest.gradient) * (n_clusters - 1) as f64);
    }
    let of_column = |j: usize| -> Vec<f64> { values.iter().map(|value| value[j]).collect() };
    let error = |j: usize| (!is_alone[j]).then(|| std_of_mean(&of_column(j)));
    let std = |j: usize| Some((widening * error(j)?).max(KIEFER_95 / NORMAL_95 * std_of_wandering(&of_column(j))));
    let (stds, errors) = ((0..size).map(std).collect(), (0..size).map(error).collect());
    Some(Spread { stds, errors, step, n_clusters })
}

/// Standard error of the mean of independent values.
pub(super) fn std_of_mean(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt()
}

/// The same of values in order that may wander: 2/n²·ΣS², with S the partial sums of the deviations from the mean.
/// Source: N. M. Kiefer, T. J. Vogelsang, Econometrica 70 (2002) 2093.
fn std_of_wandering(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let sums = values.iter().scan(0.0, |sum, value| {
        *sum += value - mean;
        Some(*sum)
    });
    (2.0 * sums.map(|sum: f64| sum * sum).sum::<f64>() / n.powi(3)).sqrt()
}

/// Half width of the 95 % interval of the mean in standard errors of wandering values (the same source, table II).
const KIEFER_95: f64 = 4.771;

/// Half width of a 95 % interval in standard deviations.
pub const NORMAL_95: f64 = 1.96;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::swing::Swing;

    /// Clusters that each measure one number directly, with a weight.
    fn measuring(values: &[f64], weights: &[f64]) -> Vec<Sums> {
        let sums = |(value, weight): (&f64, &f64)| Sums {
            matrix: DMatrix::from_element(1, 1, *weight),
            gradient: DVector::from_element(1, weight * value),
        };
        values.iter().zip(weights).map(sums).collect()
    }

    #[test]
    fn values_that_only_scatter_are_as_uncertain_as_students_t_says() {
        let values: Vec<f64> = (0..12).map(|k| if k % 2 == 0 { 3.1 } else { 2.9 }).collect();
        let found = spread_of(&measuring(&values, &[1.0; 12])).unwrap();
        // Deviations of 0.1 each; t of 11 degrees of freedom is 2.201 (tables).
        let expected = 2.201 / 1.96 * (12.0 * 0.01 / (12.0 * 11.0_f64)).sqrt();
        assert!((found.step[0] - 3.0).abs() < 1e-12);
        assert!((found.stds[0].unwrap() / expected - 1.0).abs() < 1e-3, "{:?} {expected}", found.stds);
    }

    #[test]
    fn values_that_rise_from_window_to_window_are_less_certain_than_their_scatter() {
        let values: Vec<f64> = (0..13).map(|k| f64::from(k) - 6.0).collect();
        let found = spread_of(&measuring(&values, &[1.0; 13])).unwrap().stds[0].unwrap();
        // Partial sums of −6 … 6 by hand: −6, −11, −15, −18, −20, −21, −21, −20, …; their squares sum to 3,094.
        let expected = 4.771 / 1.96 * (2.0 * 3094.0 / 13.0_f64.powi(3)).sqrt();
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        assert!(found > 2.0 * std_of_mean(&values));
    }

    #[test]
    fn what_one_cluster_alone_tells_has_no_spread() {
        let mut weights = [0.1; 8];
        weights[2] = 10.0;
        let found = spread_of(&measuring(&[1.0; 8], &weights)).unwrap();
        assert_eq!(found.stds, [None]);
        assert!(spread_of(&measuring(&[1.0], &[1.0])).is_none());
    }

    #[test]
    fn a_basis_has_length_one_and_right_angles_and_spans_its_columns() {
        let wave = |k: f64| (0..50).map(|i| 3.0 + (0.1 * k * f64::from(i)).cos()).collect::<Vec<f64>>();
        let (one, two) = (wave(1.0), wave(2.0));
        let both: Vec<f64> = one.iter().zip(&two).map(|(a, b)| 2.0 * a - b).collect();
        let basis = orthonormal([&one, &two, &both, &vec![0.0; 50]].into_iter().map(Vec::as_slice));
        assert_eq!(basis.len(), 2);
        for i in 0..2 {
            for j in 0..2 {
                assert!((dot(&basis[i], &basis[j]) - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
        assert!([&one, &two, &both].into_iter().all(|column| beyond(column, &basis).iter().all(|x| x.abs() < 1e-12)));
    }

    #[test]
    fn samples_below_zero_are_on_the_left_and_those_above_on_the_right() {
        let times_s: Vec<f64> = (0..5).map(f64::from).collect();
        let angles_rad = [-0.3, -0.2, 0.1, 0.2, 0.4];
        let swings = [Swing::new("one", &times_s, &angles_rad, 1e-3)];
        let (parameters, count) = (shared::parameters::Parameters::paper(), crate::fit::tally::Tally::default());
        let problem = Problem::new(&swings, &parameters, Vec::new(), &count);
        let linear = SwingLinear { residuals: vec![1.0, 2.0, 10.0, 20.0, 30.0], columns: Vec::new() };
        let found = cluster(&problem, 0, &linear, 0..5, &[], &[(0, &[1.0; 5])], 1);
        let [left, right] = [0, 1].map(|side| (found.sides[side].matrix[(0, 0)], found.sides[side].gradient[0]));
        assert_eq!((left, right), ((2.0, 3.0), (3.0, 60.0)));
    }
}
