//! What each candidate would gain, how large it would be, and whether all parts of the swings agree.
//!
//! With A the products of all columns over all clusters and g those with the residual, a candidate's block A' and score
//! g' are what the known columns leave of its own; its step γ = A'⁻¹·g' lowers the squares by γᵀ·g'. The scores of the
//! clusters after that step spread as in [`crate::score`]: this is its test, with each candidate beside the known
//! columns alone.
//!
//! All sums come first, then the windows once more: with the steps known, a window needs no matrix of its own, only
//! where each strength would go on to in it, and what it has of each gain ([`Share`]).

use super::clusters::{Clusters, MAX_CLUSTERS, Part};
use super::column::{Candidate, MAX_CANDIDATES, MAX_COLUMNS, MAX_KNOWN, MAX_STRENGTHS, N_STARTS};
use super::sums::Sums;
use crate::real::Real;
use crate::score::{MIN_SPARE_CLUSTERS, inverted};
use heapless::Vec;

/// A candidate of which the known columns leave less than this share is one of them.
const IMITATED: f64 = 1e-7;

type Block<R> = [[R; MAX_STRENGTHS]; MAX_STRENGTHS];
type Sizes<R> = [R; MAX_STRENGTHS];
type Numbers<R> = [R; MAX_KNOWN];

/// What the known columns explain, and what they leave.
pub struct Known<R> {
    inverse: [[R; MAX_KNOWN]; MAX_KNOWN],
    /// The step of the known numbers, starts first.
    pub step: Numbers<R>,
    /// The squares of the residuals after that step, rad².
    pub square: R,
}

/// What a candidate would do.
#[derive(Clone, Debug)]
pub struct Evidence<R> {
    /// Its strengths, in their units.
    pub sizes: Sizes<R>,
    /// Their standard deviations, from how the clusters scatter.
    pub stds: Sizes<R>,
    /// How many there are: q.
    pub n_tested: usize,
    /// The step of the known numbers that goes with them.
    pub known_step: [R; MAX_KNOWN],
    /// By how much it lowers the squares, rad².
    pub gain: R,
    /// What each cluster has of that.
    pub gains: Vec<R, MAX_CLUSTERS>,
    /// F(q, K − q) distributed where the effect is absent.
    pub f: R,
}

/// What a part of the swings says of each candidate, given the steps that all of them together ask for.
pub struct Share<R> {
    /// Shares of the columns' squares, all in all.
    weight: R,
    /// Where each strength would go on to.
    moves: [R; MAX_COLUMNS],
    /// What it has of each candidate's gain.
    gains: [R; MAX_CANDIDATES],
}

/// What a part of the swings says of the known columns.
pub struct KnownShare<R> {
    weight: R,
    products: [Numbers<R>; MAX_KNOWN],
    score: Numbers<R>,
}

/// A candidate's columns, as the sums have them.
#[derive(Clone, Copy)]
struct Own {
    first: usize,
    count: usize,
}

/// A step of a candidate and of the known numbers with it.
struct Step<R> {
    sizes: Sizes<R>,
    known: Numbers<R>,
    /// What a unit of each size is to the known columns: A⁻¹·cross.
    like: [Numbers<R>; MAX_STRENGTHS],
    /// A'⁻¹.
    inverse: Block<R>,
    gain: R,
}

impl<R: Real<Mask = bool>> Known<R> {
    /// Of all windows of a model with so many known columns, starts included. `None` where they can't be told apart.
    pub fn new(all: &Sums<R>, n_known: usize) -> Option<Self> {
        let inverse = inverted(&all.known, N_STARTS, n_known)?;
        let step = inverse.map(|row| dot(&row, &all.known_score));
        let square = all.square - dot(&step, &all.known_score);
        Some(Self { inverse, step, square })
    }

    /// What a window says of each candidate, itself among the windows of `all`.
    pub fn share(&self, all: &Sums<R>, window: &Sums<R>, candidates: &[Candidate<R>]) -> Share<R> {
        let mut share =
            Share { weight: R::zero(), moves: [R::zero(); MAX_COLUMNS], gains: [R::zero(); MAX_CANDIDATES] };
        for (candidate, gain) in candidates.iter().zip(&mut share.gains) {
            let own = Own::of(candidate);
            let Some(step) = self.step_of(all, own) else { continue };
            let moves = step.moves(window, own);
            share.moves[own.columns()].copy_from_slice(&moves[..own.count]);
            *gain = self.gain_in(window, own, &step);
            for column in own.columns() {
                share.weight = share.weight + window.within[0][column] / all.within[0][column];
            }
        }
        share
    }

    /// What a candidate would do. `None` where the known columns can imitate it, or the clusters are too few.
    pub fn evidence(
        &self,
        clusters: &Clusters<Share<R>>,
        all: &Sums<R>,
        index: usize,
        candidate: &Candidate<R>,
    ) -> Option<Evidence<R>> {
        let own = Own::of(candidate);
        if clusters.list.len() < own.count + MIN_SPARE_CLUSTERS {
            return None;
        }
        let step = self.step_of(all, own)?;
        let count = R::of(clusters.list.len() as f64);
        let correction = count / (count - R::one());
        let covariance = spread(clusters, own).map(|row| row.map(|value| value * correction));
        let precision = inverted(&covariance, 0, own.count)?;
        let quadratic = dot(&step.sizes, &precision.map(|row| dot(&row, &step.sizes)));
        let tested = R::of(own.count as f64);
        Some(Evidence {
            sizes: step.sizes,
            stds: core::array::from_fn(|c| covariance[c][c].max(R::zero()).sqrt()),
            n_tested: own.count,
            known_step: step.known,
            gain: step.gain,
            gains: clusters.list.iter().map(|share| share.gains[index]).collect(),
            f: quadratic * (count - tested) / (tested * (count - R::one())),
        })
    }

    fn step_of(&self, all: &Sums<R>, own: Own) -> Option<Step<R>> {
        let like: [Numbers<R>; MAX_STRENGTHS] =
            core::array::from_fn(|c| self.inverse.map(|row| dot(&row, &own.cross(all, c))));
        let alone = own.block(all);
        let block: Block<R> =
            core::array::from_fn(|a| core::array::from_fn(|b| alone[a][b] - dot(&like[b], &own.cross(all, a))));
        if (0..own.count).any(|c| block[c][c].le(R::of(IMITATED) * alone[c][c])) {
            return None;
        }
        let inverse = inverted(&block, 0, own.count)?;
        let score = left(&own.scores(all), &like, &all.known_score);
        let sizes = inverse.map(|row| dot(&row, &score));
        let known = core::array::from_fn(|i| (0..own.count).fold(self.step[i], |step, c| step - like[c][i] * sizes[c]));
        Some(Step { sizes, known, like, inverse, gain: dot(&sizes, &score) })
    }

    /// By how much the squares of a part are lower with the candidate than with the known numbers alone.
    fn gain_in(&self, sums: &Sums<R>, own: Own, step: &Step<R>) -> R {
        let known = |step: &Numbers<R>| {
            let moved = sums.known.map(|row| dot(&row, step));
            (0..MAX_KNOWN)
                .fold(R::zero(), |gain, i| gain + step[i] * (sums.known_score[i] + sums.known_score[i] - moved[i]))
        };
        let (block, scores) = (own.block(sums), own.scores(sums));
        let added = (0..own.count).fold(R::zero(), |gain, c| {
            let rest = scores[c] - dot(&own.cross(sums, c), &step.known);
            gain + step.sizes[c] * (rest + rest - dot(&block[c], &step.sizes))
        });
        known(&step.known) + added - known(&self.step)
    }
}

impl<R: Real<Mask = bool>> Step<R> {
    /// Where a part of the swings would go on to.
    fn moves(&self, sums: &Sums<R>, own: Own) -> Sizes<R> {
        let known_score = core::array::from_fn(|i| {
            let added = (0..own.count).fold(R::zero(), |sum, c| sum + own.cross(sums, c)[i] * self.sizes[c]);
            sums.known_score[i] - dot(&sums.known[i], &self.known) - added
        });
        let (block, scores) = (own.block(sums), own.scores(sums));
        let score =
            core::array::from_fn(|c| scores[c] - dot(&own.cross(sums, c), &self.known) - dot(&block[c], &self.sizes));
        let left = left(&score, &self.like, &known_score);
        self.inverse.map(|row| dot(&row, &left))
    }
}

/// The sum of the clusters' own steps, squared, after the common one.
fn spread<R: Real<Mask = bool>>(clusters: &Clusters<Share<R>>, own: Own) -> Block<R> {
    let mut spread = [[R::zero(); MAX_STRENGTHS]; MAX_STRENGTHS];
    for share in &clusters.list {
        let moved = &share.moves[own.columns()];
        for (row, one) in spread.iter_mut().zip(moved) {
            row.iter_mut().zip(moved).for_each(|(sum, other)| *sum = *sum + *one * *other);
        }
    }
    spread
}

impl<R: Real<Mask = bool>> Part for Share<R> {
    type Number = R;
    fn weight(&self) -> R {
        self.weight
    }
    fn join(&mut self, next: &Self) {
        self.weight = self.weight + next.weight;
        add(&mut self.moves, &next.moves);
        add(&mut self.gains, &next.gains);
    }
}

impl<R: Real<Mask = bool>> KnownShare<R> {
    /// Of a window whose start is eliminated; it weighs as much as it says of one column.
    pub fn new(window: &Sums<R>, column: usize) -> Self {
        Self { weight: window.known[column][column], products: window.known, score: window.known_score }
    }
}

impl<R: Real<Mask = bool>> Part for KnownShare<R> {
    type Number = R;
    fn weight(&self) -> R {
        self.weight
    }
    fn join(&mut self, next: &Self) {
        self.weight = self.weight + next.weight;
        add(&mut self.score, &next.score);
        self.products.iter_mut().zip(&next.products).for_each(|(sum, more)| add(sum, more));
    }
}

/// The step of the known numbers over all clusters, the standard deviations of its numbers, and by how much the step
/// lowers the squares (rad²). The deviations are a jackknife's, which leaves each cluster out in turn. `None` where one
/// of them alone tells two numbers apart.
pub fn jackknife<R: Real<Mask = bool>>(
    clusters: &Clusters<KnownShare<R>>,
    n_known: usize,
) -> Option<(Numbers<R>, Numbers<R>, R)> {
    let (mut products, mut score) = ([[R::zero(); MAX_KNOWN]; MAX_KNOWN], [R::zero(); MAX_KNOWN]);
    for share in &clusters.list {
        add(&mut score, &share.score);
        products.iter_mut().zip(&share.products).for_each(|(sum, more)| add(sum, more));
    }
    let solve = |without: Option<&KnownShare<R>>| {
        let rest: [Numbers<R>; MAX_KNOWN] = core::array::from_fn(|i| match without {
            Some(share) => core::array::from_fn(|j| products[i][j] - share.products[i][j]),
            None => products[i],
        });
        let rest_score: Numbers<R> =
            core::array::from_fn(|i| without.map_or(score[i], |share| score[i] - share.score[i]));
        Some(inverted(&rest, N_STARTS, n_known)?.map(|row| dot(&row, &rest_score)))
    };
    let whole = solve(None)?;
    let mut squares = [R::zero(); MAX_KNOWN];
    for share in &clusters.list {
        let step = solve(Some(share))?;
        squares.iter_mut().zip(step.iter().zip(&whole)).for_each(|(sum, (one, all))| {
            *sum = *sum + (*one - *all) * (*one - *all);
        });
    }
    let count = R::of(clusters.list.len().max(1) as f64);
    let gain = dot(&whole, &score);
    let stds = squares.map(|sum| (sum * (count - R::one()) / count).max(R::zero()).sqrt());
    Some((whole, stds, gain))
}

fn add<R: Real>(sums: &mut [R], more: &[R]) {
    sums.iter_mut().zip(more).for_each(|(sum, value)| *sum = *sum + *value);
}

/// What the known columns leave of a score.
fn left<R: Real>(score: &Sizes<R>, like: &[Numbers<R>; MAX_STRENGTHS], known_score: &Numbers<R>) -> Sizes<R> {
    core::array::from_fn(|c| score[c] - dot(&like[c], known_score))
}

impl Own {
    fn of<R>(candidate: &Candidate<R>) -> Self {
        Self { first: candidate.first, count: candidate.strengths.len() }
    }

    fn columns(self) -> core::ops::Range<usize> {
        self.first..self.first + self.count
    }

    fn cross<R: Real>(self, sums: &Sums<R>, c: usize) -> Numbers<R> {
        let is_there = |i: usize| c < self.count && i >= N_STARTS;
        core::array::from_fn(|i| if is_there(i) { sums.cross[i][self.first + c] } else { R::zero() })
    }

    fn scores<R: Real>(self, sums: &Sums<R>) -> Sizes<R> {
        core::array::from_fn(|c| if c < self.count { sums.score[self.first + c] } else { R::zero() })
    }

    fn block<R: Real>(self, sums: &Sums<R>) -> Block<R> {
        let product = |a: usize, b: usize| match a.max(b) < self.count {
            true => sums.within[a.max(b) - a.min(b)][self.first + a.min(b)],
            false => R::zero(),
        };
        core::array::from_fn(|a| core::array::from_fn(|b| product(a, b)))
    }
}

fn dot<R: Real, const N: usize>(a: &[R; N], b: &[R; N]) -> R {
    a.iter().zip(b).fold(R::zero(), |sum, (a, b)| sum + *a * *b)
}
