//! The windows of a look as at most so many clusters of much the same weight.

use crate::real::Real;
use heapless::Vec;

/// More clusters than this tell no more of how they scatter.
pub const MAX_CLUSTERS: usize = 14;

/// What is kept of a window, or of neighbours that became one.
pub trait Part {
    /// The number it is written in.
    type Number: Real<Mask = bool>;
    /// How much it says of what is asked.
    fn weight(&self) -> Self::Number;
    /// Takes in the next one.
    fn join(&mut self, next: &Self);
}

/// Clusters of windows, in their order.
pub struct Clusters<P> {
    /// The clusters.
    pub list: Vec<P, { MAX_CLUSTERS + 1 }>,
}

impl<P> Default for Clusters<P> {
    fn default() -> Self {
        Self { list: Vec::new() }
    }
}

impl<P: Part> Clusters<P> {
    /// Takes in a window; where that is one too many, the two neighbours that say least become one.
    pub fn add(&mut self, window: P) {
        let _ = self.list.push(window);
        if self.list.len() <= MAX_CLUSTERS {
            return;
        }
        let pair = |first: usize| self.list[first].weight() + self.list[first + 1].weight();
        let merged = (1..MAX_CLUSTERS).fold(0, |best, first| if pair(first).lt(pair(best)) { first } else { best });
        let next = self.list.remove(merged + 1);
        self.list[merged].join(&next);
    }
}
