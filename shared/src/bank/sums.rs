//! What a window keeps of its readings: products of the residual and of all columns, as far as a look needs them.
//!
//! Candidates meet the known columns and themselves, never each other: each is judged beside the known ones alone.

use super::column::{Candidate, MAX_COLUMNS, MAX_KNOWN, MAX_STRENGTHS, N_STARTS};
use crate::real::{Mask, Real};

/// Sums over readings.
pub struct Sums<R> {
    /// How many readings.
    pub n: R,
    /// Their square residuals, rad².
    pub square: R,
    /// Known by known.
    pub known: [[R; MAX_KNOWN]; MAX_KNOWN],
    /// Known by residual.
    pub known_score: [R; MAX_KNOWN],
    /// Known by candidate.
    pub cross: [[R; MAX_COLUMNS]; MAX_KNOWN],
    /// Candidate by residual.
    pub score: [R; MAX_COLUMNS],
    /// Each candidate column by itself and by those behind it, by distance.
    pub within: [[R; MAX_COLUMNS]; MAX_STRENGTHS],
}

impl<R: Copy> Sums<R> {
    /// No readings yet, given zero.
    pub const fn empty(zero: R) -> Self {
        Self {
            n: zero,
            square: zero,
            known: [[zero; MAX_KNOWN]; MAX_KNOWN],
            known_score: [zero; MAX_KNOWN],
            cross: [[zero; MAX_COLUMNS]; MAX_KNOWN],
            score: [zero; MAX_COLUMNS],
            within: [[zero; MAX_COLUMNS]; MAX_STRENGTHS],
        }
    }
}

impl<R: Real> Sums<R> {
    /// No readings yet.
    pub fn clear(&mut self) {
        (self.n, self.square) = (R::zero(), R::zero());
        self.known_score.fill(R::zero());
        self.score.fill(R::zero());
        self.known.as_flattened_mut().fill(R::zero());
        self.cross.as_flattened_mut().fill(R::zero());
        self.within.as_flattened_mut().fill(R::zero());
    }

    /// Takes in the readings of a block, and empties it.
    #[inline(never)]
    pub fn add_block(&mut self, block: &mut Block<R>, n_known: usize, n_added: usize) {
        block.fill_up(n_known + n_added);
        let (known, added) = block.columns[..n_known + n_added].split_at(n_known);
        self.n = self.n + block.n_readings;
        self.square = self.square + block.square;
        for (i, own) in known.iter().enumerate() {
            self.known_score[i] = self.known_score[i] + products(own, &block.residuals);
            let weighed = times(own, &block.weights);
            for j in 0..=i {
                self.known[i][j] = self.known[i][j] + products(&weighed, &known[j]);
                self.known[j][i] = self.known[i][j];
            }
            add_dots(&mut self.cross[i], &weighed, added);
        }
        add_dots(&mut self.score, &block.residuals, added);
        for (first, one) in added.iter().enumerate() {
            let weighed = times(one, &block.weights);
            for (sums, other) in self.within.iter_mut().zip(&added[first..]) {
                sums[first] = sums[first] + products(&weighed, other);
            }
        }
        block.empty_out();
    }

    /// Takes in all readings of another window.
    pub fn add(&mut self, other: &Self) {
        self.n = self.n + other.n;
        self.square = self.square + other.square;
        add_all(&mut self.known_score, &other.known_score);
        add_all(&mut self.score, &other.score);
        self.known.iter_mut().zip(&other.known).for_each(|(sum, more)| add_all(sum, more));
        self.cross.iter_mut().zip(&other.cross).for_each(|(sum, more)| add_all(sum, more));
        self.within.iter_mut().zip(&other.within).for_each(|(sum, more)| add_all(sum, more));
    }

    /// Leaves only some of the candidates, given by their places, as [`super::column::Columns::keep`] will.
    #[inline(never)]
    pub fn keep(&mut self, candidates: &[Candidate<R>], is_kept: &dyn Fn(usize) -> bool) {
        let mut to = 0;
        for (_, candidate) in candidates.iter().enumerate().filter(|(place, _)| is_kept(*place)) {
            for from in candidate.columns() {
                self.score[to] = self.score[from];
                self.cross.iter_mut().chain(&mut self.within).for_each(|row| row[to] = row[from]);
                to += 1;
            }
        }
    }

    /// Lets the window's own start answer freely: what is left is what it can't explain.
    pub fn eliminate_starts(&mut self) {
        (0..N_STARTS).for_each(|pivot| self.eliminate(pivot));
    }

    fn eliminate(&mut self, pivot: usize) {
        let weight = self.known[pivot][pivot];
        if !R::zero().lt(weight).all() {
            return;
        }
        let (row, cross, score) = (self.known[pivot], self.cross[pivot], self.known_score[pivot]);
        self.square = self.square - score * score / weight;
        for i in 0..MAX_KNOWN {
            let share = -row[i] / weight;
            self.known_score[i] = self.known_score[i] + share * score;
            add_products(&mut self.known[i], share, &row);
            add_products(&mut self.cross[i], share, &cross);
        }
        add_products(&mut self.score, -score / weight, &cross);
        for (distance, sums) in self.within.iter_mut().enumerate() {
            for ((sum, one), other) in sums.iter_mut().zip(&cross).zip(cross.iter().skip(distance)) {
                *sum = *sum - *one * *other / weight;
            }
        }
    }
}

/// Instants that are taken in together. Sums of sums of eight round a third of what one sum of all does, which in `f32`
/// is most of what F is off by; and a row of eight stays in the registers.
const BLOCK: usize = 8;

/// A few instants at which the columns are known, and the readings about them.
///
/// Where a step passes over readings, each of these counts for the instants on either side, for the nearer one more: as
/// if columns were straight lines between.
pub struct Block<R> {
    n: usize,
    /// How many readings, and the sum of their squares.
    n_readings: R,
    square: R,
    /// Measured minus predicted, summed over the readings about an instant, …
    residuals: [R; BLOCK],
    /// … and how many these are.
    weights: [R; BLOCK],
    /// What the readings passed since the last instant give to the next one: residuals and weight.
    ahead: [R; 2],
    /// Derivatives of the prediction, by column.
    columns: [[R; BLOCK]; MAX_KNOWN + MAX_COLUMNS],
}

impl<R: Copy> Block<R> {
    /// Without readings, given zero.
    pub const fn empty(zero: R) -> Self {
        Self {
            n: 0,
            n_readings: zero,
            square: zero,
            residuals: [zero; BLOCK],
            weights: [zero; BLOCK],
            ahead: [zero; 2],
            columns: [[zero; BLOCK]; MAX_KNOWN + MAX_COLUMNS],
        }
    }

    /// Is there no place for another instant?
    pub fn is_full(&self) -> bool {
        self.n == BLOCK
    }

    /// Writes a derivative of the reading at the instant that comes next.
    pub fn write(&mut self, column: usize, derivative: R) {
        self.columns[column][self.n % BLOCK] = derivative;
    }

    /// Where those of the columns from one on are written.
    pub fn places(&mut self, from: usize) -> impl Iterator<Item = &mut R> {
        let n = self.n % BLOCK;
        self.columns[from..].iter_mut().map(move |column| &mut column[n])
    }

    /// One that was written last.
    pub fn written(&self, column: usize) -> R {
        self.columns[column][self.n % BLOCK]
    }
}

impl<R: Real> Block<R> {
    /// Completes an instant whose derivatives have been written: measured minus predicted there, rad.
    pub fn add(&mut self, residual: R) {
        let place = self.n % BLOCK;
        let [residuals, weight] = self.ahead;
        (self.residuals[place], self.weights[place]) = (residuals + residual, weight + R::one());
        self.ahead = [R::zero(); 2];
        self.n += 1;
        self.count(residual);
    }

    /// A reading on the way from the last instant to the next, at this share of it: measured minus predicted, rad.
    pub fn add_between(&mut self, residual: R, share: R) {
        let (place, rest) = ((self.n + BLOCK - 1) % BLOCK, R::one() - share);
        self.residuals[place] = self.residuals[place] + rest * residual;
        self.weights[place] = self.weights[place] + rest;
        self.ahead = [self.ahead[0] + share * residual, self.ahead[1] + share];
        self.count(residual);
    }

    fn count(&mut self, residual: R) {
        self.n_readings = self.n_readings + R::one();
        self.square = self.square + residual * residual;
    }

    fn fill_up(&mut self, n_columns: usize) {
        for i in self.n..BLOCK {
            (self.residuals[i], self.weights[i]) = (R::zero(), R::zero());
            self.columns[..n_columns].iter_mut().for_each(|column| column[i] = R::zero());
        }
    }

    /// What the next instant has been given stays.
    fn empty_out(&mut self) {
        self.n = 0;
        (self.n_readings, self.square) = (R::zero(), R::zero());
    }
}

#[inline(always)]
fn times<R: Real>(a: &[R; BLOCK], b: &[R; BLOCK]) -> [R; BLOCK] {
    core::array::from_fn(|i| a[i] * b[i])
}

#[inline(always)]
fn products<R: Real>(a: &[R; BLOCK], b: &[R; BLOCK]) -> R {
    let pair = |i: usize| a[i] * b[i] + a[i + 1] * b[i + 1];
    (pair(0) + pair(2)) + (pair(4) + pair(6))
}

#[inline(never)]
fn add_dots<R: Real>(sums: &mut [R], row: &[R; BLOCK], columns: &[[R; BLOCK]]) {
    let row = *row;
    for (sum, column) in sums.iter_mut().zip(columns) {
        *sum = *sum + products(&row, column);
    }
}

fn add_products<R: Real>(sums: &mut [R], factor: R, values: &[R]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = *sum + factor * *value;
    }
}

fn add_all<R: Real>(sums: &mut [R], more: &[R]) {
    add_products(sums, R::one(), more);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between its instants a column is a straight line, so that no reading's product with it may be lost.
    #[test]
    fn readings_between_two_instants_count_for_both_as_on_a_straight_line() {
        let (mut sums, mut block) = (Sums::<f64>::empty(0.0), Block::empty(0.0));
        let residual = |i: usize| [0.3, -1.1, 0.7, 0.2, 0.9][i % 5];
        let column = |i: usize| if i <= 40 { 2.0 + 0.1 * i as f64 } else { 6.0 - 0.3 * (i - 40) as f64 };
        let here = |i: usize, block: &mut Block<f64>| {
            block.write(0, column(i));
            block.write(1, 2.0 * column(i));
            block.add(residual(i));
        };
        here(0, &mut block);
        let mut last = 0;
        for stride in [1, 4, 4, 2, 1, 8, 8, 8, 4, 1, 6, 8, 5] {
            (1..stride).for_each(|i| block.add_between(residual(last + i), i as f64 / stride as f64));
            last += stride;
            if block.is_full() {
                sums.add_block(&mut block, 1, 1);
            }
            here(last, &mut block);
        }
        sums.add_block(&mut block, 1, 1);
        let sum = |of: &dyn Fn(usize) -> f64| (0..=last).map(of).sum::<f64>();
        let (score, square) = (sum(&|i| residual(i) * column(i)), sum(&|i| residual(i) * residual(i)));
        assert_eq!(sums.n, (last + 1) as f64);
        assert!((sums.square - square).abs() < 1e-9);
        assert!((sums.known_score[0] - score).abs() < 1e-9 && (sums.score[0] - 2.0 * score).abs() < 1e-9);
        // Products of columns are taken at the instants: more by the bend of a parabola.
        let products = sum(&|i| column(i) * column(i));
        assert!((sums.known[0][0] / products - 1.0).abs() < 0.05);
        assert!((sums.within[0][0] / sums.known[0][0] - 4.0).abs() < 1e-9);
    }
}
