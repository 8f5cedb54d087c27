//! What each candidate would gain, how large it would be, and whether all parts of the swings agree.
//!
//! With A the products of all columns over all clusters and g those with the residual, a candidate's block A' and score
//! g' are what the known columns leave of its own; its step γ = A'⁻¹·g' lowers the squares by γᵀ·g'. The scores of the
//! clusters after that step spread as in [`crate::score`]: this is its test, with each candidate beside the known
//! columns alone.
//!
//! All sums come first, then the windows once more: with the steps known, a window needs no matrix of its own, only
//! where each strength would go on to in it, and what it has of each gain ([`Share`]).

use super::clusters::{Clusters, MAX_CLUSTERS, Share};
use super::column::{Candidate, MAX_COLUMNS, MAX_KNOWN, MAX_STRENGTHS, N_STARTS};
use super::sums::Sums;
use crate::real::Real;
use crate::score::{MIN_SPARE_CLUSTERS, invert, inverted};
use core::ops::Range;
use heapless::Vec;

/// A candidate of which the known columns leave less than this share is one of them.
const IMITATED: f64 = 1e-7;

type Block<R> = [[R; MAX_STRENGTHS]; MAX_STRENGTHS];
/// Strengths of a candidate.
pub type Sizes<R> = [R; MAX_STRENGTHS];
type Numbers<R> = [R; MAX_KNOWN];

/// What the known columns explain, and what they leave.
pub struct Known<R> {
    /// How many there are, starts included: the work grows with its square.
    n: usize,
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

impl<R: Copy> Known<R> {
    /// Nothing yet, given zero.
    pub const fn empty(zero: R) -> Self {
        Self { n: 0, inverse: [[zero; MAX_KNOWN]; MAX_KNOWN], step: [zero; MAX_KNOWN], square: zero }
    }
}

impl<R: Real<Mask = bool>> Known<R> {
    /// Of all windows of a model with so many known columns, starts included. False where they can't be told apart.
    #[inline(never)]
    pub fn solve(&mut self, all: &Sums<R>, n_known: usize) -> bool {
        self.n = n_known;
        let has_inverse = invert(&all.known, N_STARTS, n_known, &mut self.inverse);
        for (step, row) in self.step.iter_mut().zip(&self.inverse) {
            *step = dot(row, &all.known_score);
        }
        self.square = all.square - self.gain(all);
        has_inverse
    }

    /// By how much the step lowers the squares, rad².
    pub fn gain(&self, all: &Sums<R>) -> R {
        dot(&self.step, &all.known_score)
    }

    /// What a candidate promises, judged by all windows: its strengths, and by how much it lowers the squares (rad²).
    /// `None` where the known columns can imitate it.
    #[inline(never)]
    pub fn promise(&self, all: &Sums<R>, candidate: &Candidate<R>) -> Option<(Sizes<R>, R)> {
        self.step_of(all, Own::of(candidate)).map(|step| (step.sizes, step.gain))
    }

    /// Writes down what a window says of each candidate, itself among the windows of `all`, given the steps that all of
    /// them together ask for: where each strength would go on to, and what it has of each candidate's gain. It weighs
    /// its shares of the columns' squares.
    #[inline(never)]
    pub fn share(&self, all: &Sums<R>, window: &Sums<R>, candidates: &[Candidate<R>], share: &mut Share<R>) {
        for (candidate, gain) in candidates.iter().zip(&mut share.candidates) {
            let own = Own::of(candidate);
            let Some(step) = self.step_of(all, own) else { continue };
            let moves = self.moves(window, own, &step);
            share.columns[own.columns()].copy_from_slice(&moves[..own.count]);
            *gain = self.gain_in(window, own, &step);
            for column in own.columns() {
                share.weight = share.weight + window.within[0][column] / all.within[0][column];
            }
        }
    }

    /// What a candidate would do. `None` where the known columns can imitate it, or the clusters are too few.
    #[inline(never)]
    pub fn evidence(
        &self,
        clusters: &Clusters<R>,
        all: &Sums<R>,
        index: usize,
        candidate: &Candidate<R>,
    ) -> Option<Evidence<R>> {
        let own = Own::of(candidate);
        if clusters.list().len() < own.count + MIN_SPARE_CLUSTERS {
            return None;
        }
        let step = self.step_of(all, own)?;
        let count = R::of(clusters.list().len() as f64);
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
            gains: clusters.list().iter().map(|share| share.candidates[index]).collect(),
            f: quadratic * (count - tested) / (tested * (count - R::one())),
        })
    }

    #[inline(never)]
    fn step_of(&self, all: &Sums<R>, own: Own) -> Option<Step<R>> {
        let zero = R::zero();
        let mut like = [[zero; MAX_KNOWN]; MAX_STRENGTHS];
        for (c, like) in like.iter_mut().enumerate().take(own.count) {
            self.range().for_each(|i| like[i] = own.with_known(all, c, &self.inverse[i], self.range()));
        }
        let alone = own.block(all);
        let mut block = alone;
        for (a, b) in own.pairs() {
            block[a][b] = alone[a][b] - own.with_known(all, a, &like[b], self.range());
        }
        if (0..own.count).any(|c| block[c][c].le(R::of(IMITATED) * alone[c][c])) {
            return None;
        }
        let inverse = inverted(&block, 0, own.count)?;
        let scores = own.scores(all);
        let left = core::array::from_fn(|c| scores[c] - part(&like[c], &all.known_score, self.range()));
        let sizes = inverse.map(|row| dot(&row, &left));
        let mut known = self.step;
        for (like, size) in like.iter().zip(&sizes).take(own.count) {
            self.range().for_each(|i| known[i] = known[i] - like[i] * *size);
        }
        Some(Step { sizes, known, like, inverse, gain: dot(&sizes, &left) })
    }

    /// The known columns but the starts.
    fn range(&self) -> Range<usize> {
        N_STARTS..self.n
    }

    /// By how much the squares of a part are lower with the candidate than with the known numbers alone.
    #[inline(never)]
    fn gain_in(&self, sums: &Sums<R>, own: Own, step: &Step<R>) -> R {
        let known = |step: &Numbers<R>| {
            self.range().fold(R::zero(), |gain, i| {
                let score = sums.known_score[i];
                gain + step[i] * (score + score - part(&sums.known[i], step, self.range()))
            })
        };
        let (block, scores) = (own.block(sums), own.scores(sums));
        let added = (0..own.count).fold(R::zero(), |gain, c| {
            let rest = scores[c] - own.with_known(sums, c, &step.known, self.range());
            gain + step.sizes[c] * (rest + rest - dot(&block[c], &step.sizes))
        });
        known(&step.known) + added - known(&self.step)
    }

    /// Where a part of the swings would go on to after a step.
    #[inline(never)]
    fn moves(&self, sums: &Sums<R>, own: Own, step: &Step<R>) -> Sizes<R> {
        let mut known_score = [R::zero(); MAX_KNOWN];
        for i in self.range() {
            let added = (0..own.count).fold(R::zero(), |sum, c| sum + sums.cross[i][own.first + c] * step.sizes[c]);
            known_score[i] = sums.known_score[i] - part(&sums.known[i], &step.known, self.range()) - added;
        }
        let (block, scores) = (own.block(sums), own.scores(sums));
        let mut left = [R::zero(); MAX_STRENGTHS];
        for c in 0..own.count {
            let score = scores[c] - own.with_known(sums, c, &step.known, self.range()) - dot(&block[c], &step.sizes);
            left[c] = score - part(&step.like[c], &known_score, self.range());
        }
        step.inverse.map(|row| dot(&row, &left))
    }
}

/// The sum of the clusters' own steps, squared, after the common one.
fn spread<R: Real<Mask = bool>>(clusters: &Clusters<R>, own: Own) -> Block<R> {
    let mut spread = [[R::zero(); MAX_STRENGTHS]; MAX_STRENGTHS];
    for share in clusters.list() {
        let moved = &share.columns[own.columns()];
        for (row, one) in spread.iter_mut().zip(moved) {
            row.iter_mut().zip(moved).for_each(|(sum, other)| *sum = *sum + *one * *other);
        }
    }
    spread
}

/// Numbers of a window on its known columns but the starts: the score, then the triangle of the products.
const N_PACKED: usize = N_SHARED * (N_SHARED + 3) / 2;
const N_SHARED: usize = MAX_KNOWN - N_STARTS;
const _: () = assert!(N_PACKED <= MAX_COLUMNS);

/// Writes down what a window says of the known columns, its start eliminated; it weighs what it says of one of them.
pub fn share_of_known<R: Real<Mask = bool>>(window: &Sums<R>, column: usize, share: &mut Share<R>) {
    share.weight = window.known[column][column];
    let (score, products) = share.columns.split_at_mut(N_SHARED);
    score.copy_from_slice(&window.known_score[N_STARTS..]);
    let mut triangle = products.iter_mut();
    for (i, row) in window.known.iter().enumerate().skip(N_STARTS) {
        row[N_STARTS..=i].iter().zip(&mut triangle).for_each(|(product, place)| *place = *product);
    }
}

/// Solves for the known numbers by what a share, or the sum of many, says of them. `None` where they can't be told
/// apart.
#[inline(never)]
fn solved<R: Real<Mask = bool>>(packed: &[R; MAX_COLUMNS], n_known: usize) -> Option<Numbers<R>> {
    let zero = R::zero();
    let (mut products, mut inverse) = ([[zero; MAX_KNOWN]; MAX_KNOWN], [[zero; MAX_KNOWN]; MAX_KNOWN]);
    let (shared, triangle) = packed.split_at(N_SHARED);
    let mut triangle = triangle.iter();
    for i in N_STARTS..MAX_KNOWN {
        for j in N_STARTS..=i {
            let product = triangle.next().copied().unwrap_or(zero);
            (products[i][j], products[j][i]) = (product, product);
        }
    }
    let mut score = [zero; MAX_KNOWN];
    score[N_STARTS..].copy_from_slice(shared);
    let has_inverse = invert(&products, N_STARTS, n_known, &mut inverse);
    has_inverse.then(|| core::array::from_fn(|i| dot(&inverse[i], &score)))
}

/// The step of the known numbers over all clusters, the standard deviations of its numbers, and by how much the step
/// lowers the squares (rad²). The deviations are a jackknife's, which leaves each cluster out in turn. `None` where one
/// of them alone tells two numbers apart.
#[inline(never)]
pub fn jackknife<R: Real<Mask = bool>>(clusters: &Clusters<R>, n_known: usize) -> Option<(Numbers<R>, Numbers<R>, R)> {
    let mut sum = [R::zero(); MAX_COLUMNS];
    for share in clusters.list() {
        sum.iter_mut().zip(&share.columns).for_each(|(sum, more)| *sum = *sum + *more);
    }
    let whole = solved(&sum, n_known)?;
    let mut squares = [R::zero(); MAX_KNOWN];
    for share in clusters.list() {
        let step = solved(&core::array::from_fn(|i| sum[i] - share.columns[i]), n_known)?;
        squares.iter_mut().zip(step.iter().zip(&whole)).for_each(|(sum, (one, all))| {
            *sum = *sum + (*one - *all) * (*one - *all);
        });
    }
    let count = R::of(clusters.list().len().max(1) as f64);
    let gain = whole[N_STARTS..].iter().zip(&sum).fold(R::zero(), |gain, (step, score)| gain + *step * *score);
    let stds = squares.map(|sum| (sum * (count - R::one()) / count).max(R::zero()).sqrt());
    Some((whole, stds, gain))
}

impl Own {
    fn of<R>(candidate: &Candidate<R>) -> Self {
        Self { first: usize::from(candidate.first), count: candidate.strengths.len() }
    }

    fn columns(self) -> Range<usize> {
        self.first..self.first + self.count
    }

    /// The products of one of its columns with some of the known ones, each times a factor, summed.
    fn with_known<R: Real>(self, sums: &Sums<R>, c: usize, factors: &Numbers<R>, range: Range<usize>) -> R {
        range.fold(R::zero(), |sum, i| sum + factors[i] * sums.cross[i][self.first + c])
    }

    /// All pairs of its columns.
    fn pairs(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.count).flat_map(move |a| (0..self.count).map(move |b| (a, b)))
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

/// The same over some of the numbers.
fn part<R: Real>(a: &Numbers<R>, b: &Numbers<R>, range: Range<usize>) -> R {
    a[range.clone()].iter().zip(&b[range]).fold(R::zero(), |sum, (a, b)| sum + *a * *b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clusters with these numbers in the first columns.
    fn clusters<const N: usize>(of_each: &[[f64; N]]) -> Clusters<f64> {
        let mut clusters = Clusters::empty();
        for numbers in of_each {
            clusters.add(|share| share.columns[..N].copy_from_slice(numbers));
        }
        clusters
    }

    #[test]
    fn the_spread_is_the_sum_of_the_products_of_steps() {
        let spread = spread(&clusters(&[[9.0, 1.0, 2.0], [9.0, 3.0, -1.0]]), Own { first: 1, count: 2 });
        assert_eq!([spread[0][0], spread[0][1], spread[1][0], spread[1][1]], [10.0, -1.0, -1.0, 5.0]);
    }

    /// One known number beside the starts, of which each cluster has a score and a product: steps are their quotients.
    #[test]
    fn a_jackknife_leaves_each_cluster_out_in_turn() {
        let (scores, products) = ([1.0, 2.0, 6.0], [2.0, 1.0, 5.0]);
        let mut all = [[0.0; N_SHARED + 1]; 3];
        for (numbers, (score, product)) in all.iter_mut().zip(scores.iter().zip(&products)) {
            (numbers[0], numbers[N_SHARED]) = (*score, *product);
        }
        let (step, stds, gain) = jackknife(&clusters(&all), N_STARTS + 1).unwrap();
        let whole = 9.0 / 8.0;
        let left_out: [f64; 3] = core::array::from_fn(|i| (9.0 - scores[i]) / (8.0 - products[i]));
        let squares: f64 = left_out.iter().map(|one| (one - whole) * (one - whole)).sum();
        let off = [step[N_STARTS] - whole, stds[N_STARTS] - (squares * 2.0 / 3.0).sqrt(), gain - 9.0 * whole];
        assert!(off.iter().all(|off| off.abs() < 1e-12), "{off:?}");
    }
}
