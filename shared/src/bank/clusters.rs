//! The windows of a look as at most so many clusters of much the same weight.

use super::column::MAX_COLUMNS;
use super::sums::Sums;
use crate::real::Real;
use heapless::Vec;

/// More clusters than this tell no more of how they scatter.
pub const MAX_CLUSTERS: usize = 14;

/// Clusters of windows, in their order.
pub struct Clusters<R> {
    /// The clusters.
    pub list: Vec<Sums<R>, { MAX_CLUSTERS + 1 }>,
}

impl<R> Default for Clusters<R> {
    fn default() -> Self {
        Self { list: Vec::new() }
    }
}

impl<R: Real<Mask = bool>> Clusters<R> {
    /// Takes in a window; where that is one too many, the two neighbours that say least become one.
    pub fn add(&mut self, window: &Sums<R>) {
        let _ = self.list.push(*window);
        if self.list.len() <= MAX_CLUSTERS {
            return;
        }
        let all = self.all();
        let shares: Vec<R, { MAX_CLUSTERS + 1 }> = self.list.iter().map(|sums| information(sums, &all)).collect();
        let lighter = |best: usize, i: usize| {
            if (shares[i] + shares[i + 1]).lt(shares[best] + shares[best + 1]) { i } else { best }
        };
        let merged = (1..shares.len() - 1).fold(0, lighter);
        let later = self.list.remove(merged + 1);
        self.list[merged].add(&later);
    }

    /// All windows together.
    pub fn all(&self) -> Sums<R> {
        let mut all = Sums::default();
        self.list.iter().for_each(|sums| all.add(sums));
        all
    }
}

/// What a cluster says of all candidates: its shares of the columns' squares.
fn information<R: Real<Mask = bool>>(sums: &Sums<R>, all: &Sums<R>) -> R {
    (0..MAX_COLUMNS).fold(R::zero(), |information, column| {
        let whole = all.within[0][column];
        if R::zero().lt(whole) { information + sums.within[0][column] / whole } else { information }
    })
}
