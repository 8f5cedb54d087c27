//! What a window keeps of its readings: products of the residual and of all columns, as far as a look needs them.
//!
//! Candidates meet the known columns and themselves, never each other: each is judged beside the known ones alone.

use super::column::{MAX_COLUMNS, MAX_KNOWN, MAX_STRENGTHS, N_STARTS};
use crate::real::{Mask, Real};

/// Sums over readings.
#[derive(Clone, Copy)]
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

impl<R: Real> Default for Sums<R> {
    fn default() -> Self {
        Self {
            n: R::zero(),
            square: R::zero(),
            known: [[R::zero(); MAX_KNOWN]; MAX_KNOWN],
            known_score: [R::zero(); MAX_KNOWN],
            cross: [[R::zero(); MAX_COLUMNS]; MAX_KNOWN],
            score: [R::zero(); MAX_COLUMNS],
            within: [[R::zero(); MAX_COLUMNS]; MAX_STRENGTHS],
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

    /// Takes in a reading: measured minus predicted, and the derivatives of the prediction.
    pub fn add_reading(&mut self, residual: R, known: &[R], added: &[R]) {
        self.n = self.n + R::one();
        self.square = self.square + residual * residual;
        for (i, own) in known.iter().enumerate() {
            self.known_score[i] = self.known_score[i] + *own * residual;
            add_products(&mut self.known[i], *own, known);
            add_products(&mut self.cross[i], *own, added);
        }
        add_products(&mut self.score, residual, added);
        for (distance, sums) in self.within.iter_mut().enumerate() {
            let later = added.iter().skip(distance);
            for ((sum, one), other) in sums.iter_mut().zip(added).zip(later) {
                *sum = *sum + *one * *other;
            }
        }
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

fn add_products<R: Real>(sums: &mut [R], factor: R, values: &[R]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum = *sum + factor * *value;
    }
}

fn add_all<R: Real>(sums: &mut [R], more: &[R]) {
    add_products(sums, R::one(), more);
}
