//! How many knots a friction curve needs, and how stiff it is to be: the swings are cut into blocks of a few periods,
//! every third of which is left out and predicted from the others.
//!
//! A linearisation with as many knots as there may be decides without any further simulation: a curve of fewer knots is
//! a linear combination of them. Far from the curve each block begins anew, its start and zero being taken out of its
//! columns as in [`super::clusters`], and shows what the curve says of the loss within it. Near the curve a swing has
//! one start, so that a block left out also shows what the curve has gathered until then.

use super::clusters::{Sums, beyond, orthonormal, std_of_mean, upward_crossings};
use super::fitted::Fitted;
use super::left_out::{FEWEST, FOLDS, least_periods, ranges};
use super::linear::{SwingLinear, dot};
use super::problem::{PER_SWING, Problem, Quantity, Unknown};
use super::ridge::roughness;
use super::solve::Factor;
use crate::cores::on_all_cores;
use nalgebra::{DMatrix, DVector};
use shared::curve::{Curve, Spline};
use shared::effect::Effect;
use std::array;
use std::ops::Range;

/// Numbers of knots that are tried, beside two: a straight line, Coulomb and viscous friction.
const N_KNOTS: [usize; 7] = [4, 6, 9, 14, 20, 26, 32];

/// Strengths of the ridge that are tried, in powers of ten of what a sample tells of a knot.
const STRENGTHS: std::ops::RangeInclusive<i32> = -7..=1;

/// So many blocks are wanted, of two periods, or of one where that leaves too few. Measured on the real recordings that
/// come with the project: with half as many the choice follows single blocks, with twice as many a block is too short
/// to show how the loss bends.
const WANTED: usize = 24;

/// A block's normal equations over unknowns and knots, counted from no friction at all, and the sum of squares there.
struct Block {
    sums: Sums,
    square: f64,
    n_samples: usize,
}

/// What the blocks prefer.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Knots of the curve with their torques, N·m, none negative.
    pub curve: Curve<f64>,
    /// Strength of the ridge, as [`super::ridge::Ridge`] takes it.
    pub strength: f64,
    /// Root mean square error of blocks left out, their geometric mean, rad.
    pub left_out_rad: f64,
    /// The same with a straight curve.
    pub straight_rad: f64,
    /// By how many of its standard errors the curve predicts blocks left out better than the straight one.
    pub better_by: f64,
    /// How many blocks there were.
    pub n_blocks: usize,
}

/// How a block begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begin {
    /// Each anew.
    Anew,
    /// Where the one before ended: a swing has one start.
    GoesOn,
}

/// Chooses knots and ridge for a model that has a curve of as many knots as there may be; `None` with too few blocks.
pub fn choice(on: &Problem, fine: &Fitted, begin: Begin) -> Option<Choice> {
    let (first_unknown, curve) = (fine.problem(on).knots()?.start, fine.parameters.curve.clone()?);
    let blocks = blocks(on, fine, first_unknown, &curve, begin);
    let mut free: Vec<bool> = fine.unknowns[..first_unknown].iter().map(is_straight).collect();
    if begin == Begin::GoesOn {
        free.extend(std::iter::repeat_n(true, PER_SWING * on.swings.len()));
    }
    let first = free.len();
    if blocks.len() < FEWEST {
        return None;
    }
    let all = total(blocks.iter());
    let n_samples: usize = blocks.iter().map(|block| block.n_samples).sum();
    let told = (0..curve.torques_nm().len()).map(|k| all.matrix[(first + k, first + k)]).sum::<f64>();
    let unit = told / (curve.torques_nm().len() * n_samples) as f64;
    let n_fine = curve.torques_nm().len();
    let shape = |n_knots: usize| Shape::new(&curve, &free, n_knots);
    let straight_squares = shape(2).left_out(&blocks, &[0.0]).swap_remove(0);
    let strengths: Vec<f64> = STRENGTHS.map(|power| unit * 10f64.powi(power)).collect();
    let tried: Vec<Shape> = N_KNOTS.into_iter().filter(|n_knots| *n_knots <= n_fine).map(shape).collect();
    let left_out: Vec<Vec<Vec<f64>>> = on_all_cores(&tried, |shape| shape.left_out(&blocks, &strengths));
    let mut best: Option<(f64, &Shape, f64, &Vec<f64>)> = None;
    for (shape, of_strengths) in tried.iter().zip(&left_out) {
        for (strength, squares) in strengths.iter().zip(of_strengths) {
            let left = mean_of_logs(squares);
            if left.is_finite() && best.as_ref().is_none_or(|(lowest, ..)| left < *lowest) {
                best = Some((left, shape, *strength, squares));
            }
        }
    }
    let (lowest, shape, strength, squares) = best?;
    let solution = shape.solution(shape.sums(&all), n_samples, strength);
    let torques: Vec<f64> = solution.iter().skip(first).map(|torque| torque.max(0.0)).collect();
    Some(Choice {
        curve: Curve::new(&shape.speeds_rad_s, &torques)?,
        strength,
        left_out_rad: (0.5 * lowest).exp(),
        straight_rad: (0.5 * mean_of_logs(&straight_squares)).exp(),
        better_by: better_by(squares, &straight_squares),
        n_blocks: blocks.len(),
    })
}

/// Inertia, and what is zero where its effect is absent: the linearisation may be trusted with these, however far they
/// go.
fn is_straight(unknown: &Unknown) -> bool {
    match unknown.quantity {
        Quantity::Effect { id, index } => {
            Effect::<f64>::by_id(id).is_some_and(|effect| effect.starts.iter().all(|start| start[index] == 0.0))
        }
        _ => true,
    }
}

/// By how many standard errors some blocks are predicted better than by another curve: each by its own ratio, so that
/// no single one decides.
fn better_by(squares: &[f64], than: &[f64]) -> f64 {
    let gains: Vec<f64> = than.iter().zip(squares).map(|(than, own)| (than / own).ln()).collect();
    mean(&gains) / std_of_mean(&gains)
}

/// Of the squares of blocks, which are above zero.
fn mean_of_logs(squares: &[f64]) -> f64 {
    mean(&squares.iter().map(|square| square.ln()).collect::<Vec<_>>())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn total<'a>(blocks: impl Iterator<Item = &'a Block>) -> Sums {
    let sums = blocks.map(|block| block.sums.clone()).reduce(|mut sum, block| {
        sum.add(&block);
        sum
    });
    sums.unwrap_or(Sums::zeros(0))
}

/// A number of knots.
struct Shape {
    speeds_rad_s: Vec<f32>,
    /// The finest curve's torques from this one's: a column a knot.
    finer: DMatrix<f64>,
    first: usize,
    /// Which of the other unknowns may answer.
    free: Vec<bool>,
}

impl Shape {
    fn new(fine: &Curve<f64>, free: &[bool], n_knots: usize) -> Self {
        let speeds_rad_s = knots(fine.speeds_rad_s(), n_knots);
        let finer = between(&speeds_rad_s, fine.speeds_rad_s());
        Self { speeds_rad_s, finer, first: free.len(), free: free.to_vec() }
    }

    /// The equations of samples over the unknowns and this curve's knots.
    fn sums(&self, fine: &Sums) -> Sums {
        let (n_fine, n_own) = self.finer.shape();
        let mut change = DMatrix::zeros(self.first + n_fine, self.first + n_own);
        (0..self.first).for_each(|j| change[(j, j)] = 1.0);
        change.view_mut((self.first, self.first), (n_fine, n_own)).copy_from(&self.finer);
        Sums { matrix: change.tr_mul(&(&fine.matrix * &change)), gradient: change.tr_mul(&fine.gradient) }
    }

    /// The numbers that suit samples best, of which these are the [`Shape::sums`], with a ridge of this strength.
    fn solution(&self, sums: Sums, n_samples: usize, strength: f64) -> DVector<f64> {
        let Sums { mut matrix, gradient } = sums;
        let n_knots = self.speeds_rad_s.len();
        let squares: Vec<f64> = matrix.diagonal().iter().copied().collect();
        let mut corner = matrix.view_mut((self.first, self.first), (n_knots, n_knots));
        corner += strength * n_samples as f64 * roughness(&self.speeds_rad_s);
        Factor::of_squares(&matrix, &squares, |j| self.free.get(j).is_none_or(|free| *free)).solve(&gradient)
    }

    /// The mean square of each block, predicted from the others, for each strength of the ridge. All of them share
    /// what the knots make of the blocks, which takes longer than to solve for the torques.
    fn left_out(&self, blocks: &[Block], strengths: &[f64]) -> Vec<Vec<f64>> {
        let own: Vec<Sums> = blocks.iter().map(|block| self.sums(&block.sums)).collect();
        let kept = |fold: usize| {
            let kept = || blocks.iter().enumerate().filter(move |(k, _)| k % FOLDS != fold).map(|(_, block)| block);
            (self.sums(&total(kept())), kept().map(|block| block.n_samples).sum::<usize>())
        };
        let kept: [(Sums, usize); FOLDS] = array::from_fn(kept);
        let with = |strength: &f64| {
            let solve = |(sums, n_samples): &(Sums, usize)| self.solution(sums.clone(), *n_samples, *strength);
            let solutions = kept.each_ref().map(solve);
            let square = |(k, block): (usize, &Block)| {
                let (Sums { matrix, gradient }, solution) = (&own[k], &solutions[k % FOLDS]);
                let square = block.square - 2.0 * gradient.dot(solution) + solution.dot(&(matrix * solution));
                // Rounding may take the last digit of a block that is met exactly.
                (square / block.n_samples as f64).max(f64::MIN_POSITIVE)
            };
            blocks.iter().enumerate().map(square).collect()
        };
        strengths.iter().map(with).collect()
    }
}

/// So many of the knots, the first and the last among them.
fn knots(of: &[f32], n_knots: usize) -> Vec<f32> {
    let n_knots = n_knots.min(of.len());
    (0..n_knots).map(|k| of[(k * (of.len() - 1) + (n_knots - 1) / 2) / (n_knots - 1)]).collect()
}

/// What curves through knots at some speeds are at others, a column a knot: a curve is linear in its torques.
pub fn between(from_rad_s: &[f32], to_rad_s: &[f32]) -> DMatrix<f64> {
    let at = |torques: &[f64]| -> Vec<f64> {
        let spline = Curve::new(from_rad_s, torques).map(|curve| Spline::new(&curve));
        let torque = |speed: &f32| spline.as_ref().map_or(0.0, |spline| spline.torque_nm(f64::from(*speed)));
        to_rad_s.iter().map(torque).collect()
    };
    // Around a curve that is one everywhere, so that none of them falls below zero, where it would be cut.
    let columns = (0..from_rad_s.len()).map(|j| {
        let one_more: Vec<f64> = (0..from_rad_s.len()).map(|k| if k == j { 2.0 } else { 1.0 }).collect();
        DVector::from_iterator(to_rad_s.len(), at(&one_more).into_iter().map(|torque| torque - 1.0))
    });
    DMatrix::from_columns(&columns.collect::<Vec<_>>())
}

fn blocks(on: &Problem, fine: &Fitted, first: usize, curve: &Curve<f64>, begin: Begin) -> Vec<Block> {
    let linear = fine.linearised(on);
    let crossings: Vec<Vec<usize>> =
        linear.each(|idx, swing| upward_crossings(on, swing, idx, fine.starts[idx].offset_rad));
    let n_periods: usize = crossings.iter().map(Vec::len).sum();
    let periods = (n_periods / WANTED).max(least_periods(n_periods));
    let place = Place { first, n_unknowns: linear.n_unknowns(), n_swings: linear.n_swings(), begin };
    let of_swing = |idx: usize, swing: &SwingLinear| -> Vec<Block> {
        let ranges = ranges(on, idx, &crossings[idx], periods, swing.residuals.len());
        ranges.into_iter().map(|range| place.block(idx, swing, range, curve.torques_nm())).collect()
    };
    linear.each(of_swing).into_iter().flatten().collect()
}

/// Where the numbers of a block stand: unknowns, then the starts of all swings where a swing has one, then knots.
struct Place {
    first: usize,
    n_unknowns: usize,
    n_swings: usize,
    begin: Begin,
}

impl Place {
    /// One block, counted from no friction, where the torques are `present_nm` now.
    fn block(&self, idx: usize, swing: &SwingLinear, range: Range<usize>, present_nm: &[f64]) -> Block {
        let (columns, own) = swing.columns.split_at(self.n_unknowns);
        let own: Vec<&[f64]> = own.iter().map(|column| &column[range.clone()]).collect();
        let basis = match self.begin {
            Begin::Anew => orthonormal(own.iter().copied()),
            Begin::GoesOn => Vec::new(),
        };
        let residuals = beyond(&swing.residuals[range.clone()], &basis);
        let mut all: Vec<Vec<f64>> = columns.iter().map(|column| beyond(&column[range.clone()], &basis)).collect();
        let knots = all.split_off(self.first);
        if self.begin == Begin::GoesOn {
            let nothing = vec![0.0; range.len()];
            let starts_of = |swing_idx: usize| {
                own.iter().map(move |column| if swing_idx == idx { Some(column.to_vec()) } else { None })
            };
            let starts = (0..self.n_swings).flat_map(starts_of);
            all.extend(starts.map(|column| column.unwrap_or_else(|| nothing.clone())));
        }
        let mut present = DVector::zeros(all.len() + knots.len());
        present.rows_mut(all.len(), knots.len()).copy_from_slice(present_nm);
        all.extend(knots);
        let matrix = DMatrix::from_fn(all.len(), all.len(), |i, j| dot(&all[i], &all[j]));
        let gradient = DVector::from_fn(all.len(), |i, _| dot(&all[i], &residuals));
        let pull = &matrix * &present;
        let square = dot(&residuals, &residuals) + 2.0 * gradient.dot(&present) + present.dot(&pull);
        Block { sums: Sums { gradient: gradient + pull, matrix }, square, n_samples: range.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::parameters::Parameters;

    #[test]
    fn a_curve_is_better_by_the_mean_of_its_gains_over_their_standard_error() {
        // Gains of 0.1, 0.2, 0.3 and 0.4: a mean of 0.25, a variance of 0.05/3, of which a quarter is the mean's.
        let squares = [1e-4, 2e-4, 3e-4, 4e-4];
        let than: Vec<f64> = squares.iter().enumerate().map(|(k, own)| own * (0.1 * (k + 1) as f64).exp()).collect();
        assert!((better_by(&squares, &than) - 0.25 / (0.05_f64 / 12.0).sqrt()).abs() < 1e-9);
        assert!((better_by(&than, &squares) + 0.25 / (0.05_f64 / 12.0).sqrt()).abs() < 1e-9);
    }

    #[test]
    fn a_linearisation_is_trusted_with_the_size_of_a_torque_but_not_with_its_shape() {
        let rig = Parameters::paper();
        assert!(is_straight(&Unknown::inertia(&rig)));
        let of = |name: &str| {
            let effect = Effect::<f64>::by_name(name).unwrap();
            Unknown::all_of_effect(effect, &rig).iter().map(is_straight).collect::<Vec<_>>()
        };
        assert_eq!(of("quadratic-drag"), [true]);
        assert_eq!(of("stribeck"), [true, false]);
    }
}
