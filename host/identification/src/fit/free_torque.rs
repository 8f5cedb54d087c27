//! Is what a model leaves a law of the motion? A free torque of angle and speed, one number at each knot of a coarse
//! grid, is fitted beside the model to two thirds of the swings and asked for the rest.
//!
//! The swings are cut into blocks of two periods, every third of which is left out, as for a friction curve
//! ([`super::blocks`]); a swing has one start, so that a block left out also shows what the torque has gathered until
//! then. The model is linearised and its own numbers answer too, with the torque and without it. The same grid, read at
//! once instead of acting as a torque, says what an uneven scale of the sensor would explain: such a scale and a torque
//! can't be told apart, because a bent angle has a law of motion too. Nor can a clock that goes wrong alike in each release
//! where these pass few sizes at several times: so what it would explain is asked for as well (`clock_knots.rs`).

use super::clock_knots;
use super::clusters::{Sums, upward_crossings};
use super::fitted::Fitted;
use super::left_out::{self, FEWEST, FOLDS, least_periods};
use super::linear::{SwingLinear, dot};
use super::problem::{PER_SWING, Problem};
use super::response::Path;
use super::scouts::scouts;
use super::solve::Factor;
use super::state_grid::{Grid, N_KNOTS};
use crate::cores::on_all_cores;
use crate::recording::Measured;
use crate::swing::Swing;
use nalgebra::{DMatrix, DVector};
use std::array;
use std::ops::Range;

/// Strengths of the ridge that are tried, in powers of ten of what a knot tells.
const STRENGTHS: std::ops::RangeInclusive<i32> = -6..=1;

/// Less than this share of the noise's variance is no excess that could be split.
const LEAST_EXCESS: f64 = 0.05;

/// What free functions of angle and speed take of what a model leaves beyond the noise, on blocks that they were not
/// fitted to: 1 for all of it, below zero where they only make it worse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeTorque {
    /// As a torque.
    pub as_torque: f64,
    /// Added to the readings.
    pub as_reading: f64,
    /// As a clock that goes wrong alike in each of several releases; `None` of one, and of rates.
    pub as_clock: Option<f64>,
    /// How many blocks there were.
    pub n_blocks: usize,
    /// From knot to knot: along the angle, rad, and along the speed, rad/s.
    pub widths: [f64; 2],
}

/// Splits what a model leaves of the swings, or of a few of many; `None` where they are too short, or nothing is left
/// within them.
pub fn free_torque(on: &Problem, model: &Fitted) -> Option<FreeTorque> {
    let few = scouts(on.swings);
    let swings: Vec<Swing> = few.iter().map(|idx| on.swings[*idx].clone()).collect();
    let starts = few.iter().map(|idx| model.starts[*idx]).collect();
    of_all(&on.on(&swings), &Fitted { starts, ..model.clone() })
}

fn of_all(on: &Problem, model: &Fitted) -> Option<FreeTorque> {
    let swings: Vec<SwingLinear> = model.linearised(on).each(|_, swing| swing.clone());
    let ranges = ranges(on, model, &swings);
    let path = |idx: usize| Path::of(&model.parameters, model.starts[idx], &on.swings[idx]);
    let paths: Vec<Path> = on_all_cores(0..swings.len(), path);
    let grid = Grid::over(&paths)?;
    let n_blocks = ranges.iter().map(Vec::len).sum();
    if n_blocks < FEWEST {
        return None;
    }
    let place = Place { n_unknowns: model.unknowns.len(), n_swings: swings.len() };
    let noise = on.noise_rad().powi(2);
    let removes = |columns: Vec<Vec<Vec<f64>>>, ridge: DMatrix<f64>| {
        Folds::new(&place, &swings, &columns, &ranges).removes(noise, ridge)
    };
    let as_torque = on_all_cores(&paths, |path| path.answers(N_KNOTS, |at| grid.weights(at)));
    let as_reading = on_all_cores(&paths, |path| grid.readings(path));
    let (as_torque, as_reading) =
        rayon::join(|| removes(as_torque, Grid::ridge()), || removes(as_reading, Grid::ridge()));
    let as_clock = of_clock(on, &paths).and_then(|columns| removes(columns, clock_knots::ridge()));
    Some(FreeTorque { as_torque: as_torque?, as_reading: as_reading?, as_clock, n_blocks, widths: grid.widths() })
}

/// What a clock would do that goes wrong alike in each release; within one any law of the period does the same.
fn of_clock(on: &Problem, paths: &[Path]) -> Option<Vec<Vec<Vec<f64>>>> {
    let is_angle = on.swings.iter().all(|swing| swing.measured == Measured::Angle);
    let all = || paths.iter().zip(on.swings);
    let of_swing = |(path, swing): (&Path, &Swing)| clock_knots::readings(path, &swing.times_s, on.longest_s());
    (is_angle && paths.len() > 1).then(|| all().map(of_swing).collect())
}

/// The blocks of each swing.
fn ranges(on: &Problem, model: &Fitted, swings: &[SwingLinear]) -> Vec<Vec<Range<usize>>> {
    let crossings_of = |(idx, swing)| upward_crossings(on, swing, idx, model.starts[idx].offset_rad);
    let crossings: Vec<Vec<usize>> = swings.iter().enumerate().map(crossings_of).collect();
    let periods = least_periods(crossings.iter().map(Vec::len).sum());
    let blocks_of = |(idx, swing): (usize, &SwingLinear)| {
        left_out::ranges(on, idx, &crossings[idx], periods, swing.residuals.len())
    };
    swings.iter().enumerate().map(blocks_of).collect()
}

/// Where the numbers stand: the model's, then the starts of all swings, then knots.
struct Place {
    n_unknowns: usize,
    n_swings: usize,
}

impl Place {
    fn first_knot(&self) -> usize {
        self.n_unknowns + PER_SWING * self.n_swings
    }

    /// The columns of a swing within a block, with their places.
    fn columns<'a>(
        &self,
        idx: usize,
        swing: &'a SwingLinear,
        knots: &'a [Vec<f64>],
        range: &Range<usize>,
    ) -> Vec<(usize, &'a [f64])> {
        let (unknowns, own) = swing.columns.split_at(self.n_unknowns);
        let places = (0..self.n_unknowns)
            .chain(self.n_unknowns + PER_SWING * idx..)
            .take(self.n_unknowns + PER_SWING)
            .chain(self.first_knot()..);
        let columns = unknowns.iter().chain(own).chain(knots);
        // A knot that the block does not touch takes no time.
        let here = places.zip(columns).map(|(at, column)| (at, &column[range.clone()]));
        here.filter(|(_, column)| column.iter().any(|x| *x != 0.0)).collect()
    }
}

/// The normal equations of all blocks that are left out together.
struct Fold {
    sums: Sums,
    square: f64,
    n_samples: usize,
}

impl Fold {
    fn add(&mut self, columns: &[(usize, &[f64])], residuals: &[f64]) {
        for (i, (at, column)) in columns.iter().enumerate() {
            self.sums.gradient[*at] += dot(column, residuals);
            for (other, with) in &columns[..=i] {
                let product = dot(column, with);
                self.sums.matrix[(*at, *other)] += product;
                if at != other {
                    self.sums.matrix[(*other, *at)] += product;
                }
            }
        }
        self.square += dot(residuals, residuals);
        self.n_samples += residuals.len();
    }

    /// The sum of squares that some numbers leave.
    fn left(&self, solution: &DVector<f64>) -> f64 {
        self.square - 2.0 * self.sums.gradient.dot(solution) + solution.dot(&(&self.sums.matrix * solution))
    }
}

struct Folds {
    folds: [Fold; FOLDS],
    first_knot: usize,
}

impl Folds {
    fn new(place: &Place, swings: &[SwingLinear], knots: &[Vec<Vec<f64>>], ranges: &[Vec<Range<usize>>]) -> Self {
        let blocks: Vec<(usize, &Range<usize>)> =
            ranges.iter().enumerate().flat_map(|(idx, ranges)| ranges.iter().map(move |range| (idx, range))).collect();
        let size = place.first_knot() + N_KNOTS;
        let fold = |fold: usize| {
            let mut left_out = Fold { sums: Sums::zeros(size), square: 0.0, n_samples: 0 };
            for (idx, range) in blocks.iter().skip(fold).step_by(FOLDS) {
                let columns = place.columns(*idx, &swings[*idx], &knots[*idx], range);
                left_out.add(&columns, &swings[*idx].residuals[(*range).clone()]);
            }
            left_out
        };
        Self { folds: array::from_fn(fold), first_knot: place.first_knot() }
    }

    /// Share of the excess over the noise's variance that the knots remove, with the ridge that suits them best.
    fn removes(&self, noise: f64, ridge: DMatrix<f64>) -> Option<f64> {
        let noise = noise * self.folds.iter().map(|fold| fold.n_samples).sum::<usize>() as f64;
        let without = self.left_out(None) - noise;
        let ridge = self.told() * ridge;
        let strengths: Vec<f64> = STRENGTHS.map(|power| 10f64.powi(power)).collect();
        let with = on_all_cores(strengths, |strength| self.left_out(Some(&(strength * &ridge))) - noise);
        let best = with.into_iter().min_by(f64::total_cmp)?;
        (without > LEAST_EXCESS * noise && best.is_finite()).then(|| 1.0 - best / without)
    }

    /// What the samples tell of a knot, on average.
    fn told(&self) -> f64 {
        let of_fold = |fold: &Fold| fold.sums.matrix.diagonal().rows(self.first_knot, N_KNOTS).sum();
        self.folds.iter().map(of_fold).sum::<f64>() / N_KNOTS as f64
    }

    /// The sum of squares of all blocks, each predicted from the folds it is not in; without a ridge no knot answers.
    fn left_out(&self, ridge: Option<&DMatrix<f64>>) -> f64 {
        let left = |fold: usize| self.folds[fold].left(&self.solution_without(fold, ridge));
        (0..FOLDS).map(left).sum()
    }

    fn solution_without(&self, fold: usize, ridge: Option<&DMatrix<f64>>) -> DVector<f64> {
        let mut kept = Sums::zeros(self.first_knot + N_KNOTS);
        let others = self.folds.iter().enumerate().filter(|(k, _)| *k != fold);
        others.for_each(|(_, other)| kept.add(&other.sums));
        let mut squares: Vec<f64> = kept.matrix.diagonal().iter().copied().collect();
        if let Some(ridge) = ridge {
            let mut corner = kept.matrix.view_mut((self.first_knot, self.first_knot), (N_KNOTS, N_KNOTS));
            corner += ridge;
            squares = kept.matrix.diagonal().iter().copied().collect();
        }
        Factor::of_squares(&kept.matrix, &squares, |j| j < self.first_knot || ridge.is_some()).solve(&kept.gradient)
    }
}
