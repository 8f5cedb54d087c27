//! What each candidate would gain, how large it would be, and whether all parts of the swings agree.
//!
//! With A the products of all columns over all clusters and g those with the residual, a candidate's block A' and score
//! g' are what the known columns leave of its own; its step γ = A'⁻¹·g' lowers the squares by γᵀ·g'. The scores of the
//! clusters after that step spread as in [`crate::score`]: this is its test, with each candidate beside the known
//! columns alone.

use super::clusters::{Clusters, MAX_CLUSTERS};
use super::column::{Candidate, MAX_KNOWN, MAX_STRENGTHS, N_STARTS};
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

    /// The standard deviation of a known number, from how the clusters scatter.
    pub fn std(&self, clusters: &Clusters<R>, column: usize) -> R {
        let count = R::of(clusters.list.len() as f64);
        let move_of = |sums: &Sums<R>| {
            let left: Numbers<R> = core::array::from_fn(|i| sums.known_score[i] - dot(&sums.known[i], &self.step));
            dot(&self.inverse[column], &left)
        };
        let spread = clusters.list.iter().fold(R::zero(), |sum, sums| sum + move_of(sums) * move_of(sums));
        (spread * count / (count - R::one())).max(R::zero()).sqrt()
    }

    /// What a candidate would do. `None` where the known columns can imitate it, or the clusters are too few.
    pub fn evidence(&self, clusters: &Clusters<R>, all: &Sums<R>, candidate: &Candidate<R>) -> Option<Evidence<R>> {
        let own = Own { first: candidate.first, count: candidate.strengths.len() };
        if clusters.list.len() < own.count + MIN_SPARE_CLUSTERS {
            return None;
        }
        let step = self.step_of(all, own)?;
        let count = R::of(clusters.list.len() as f64);
        let correction = count / (count - R::one());
        let covariance = step.spread(clusters, own).map(|row| row.map(|value| value * correction));
        let precision = inverted(&covariance, 0, own.count)?;
        let quadratic = dot(&step.sizes, &precision.map(|row| dot(&row, &step.sizes)));
        let tested = R::of(own.count as f64);
        Some(Evidence {
            sizes: step.sizes,
            stds: core::array::from_fn(|c| covariance[c][c].max(R::zero()).sqrt()),
            n_tested: own.count,
            known_step: step.known,
            gain: step.gain,
            gains: clusters.list.iter().map(|sums| self.gain_in(sums, own, &step)).collect(),
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

    /// By how much a cluster's squares are lower with the candidate than with the known numbers alone.
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
    /// The sum of the clusters' own steps, squared, after the common one.
    fn spread(&self, clusters: &Clusters<R>, own: Own) -> Block<R> {
        let mut spread = [[R::zero(); MAX_STRENGTHS]; MAX_STRENGTHS];
        for sums in &clusters.list {
            let moved = self.moves(sums, own);
            for (row, one) in spread.iter_mut().zip(moved) {
                row.iter_mut().zip(moved).for_each(|(sum, other)| *sum = *sum + one * other);
            }
        }
        spread
    }

    /// Where a cluster would go on to.
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

/// What the known columns leave of a score.
fn left<R: Real>(score: &Sizes<R>, like: &[Numbers<R>; MAX_STRENGTHS], known_score: &Numbers<R>) -> Sizes<R> {
    core::array::from_fn(|c| score[c] - dot(&like[c], known_score))
}

impl Own {
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
