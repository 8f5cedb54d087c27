//! The windows of a look as at most so many clusters of much the same weight.

use super::column::{MAX_COLUMNS, MAX_JUDGED};
use crate::real::Real;
use heapless::Vec;

/// More clusters than this tell no more of how they scatter.
pub const MAX_CLUSTERS: usize = 14;

/// What is kept of a window, or of neighbours that became one: numbers that add up.
pub struct Share<R> {
    /// How much it says of what is asked.
    pub weight: R,
    /// One number a column.
    pub columns: [R; MAX_COLUMNS],
    /// One number a candidate that is judged.
    pub candidates: [R; MAX_JUDGED],
}

/// Clusters of windows, in their order.
pub struct Clusters<R> {
    list: Vec<Share<R>, { MAX_CLUSTERS + 1 }>,
}

impl<R> Clusters<R> {
    /// None yet.
    pub const fn empty() -> Self {
        Self { list: Vec::new() }
    }

    /// The clusters.
    pub fn list(&self) -> &[Share<R>] {
        &self.list
    }
}

impl<R: Real<Mask = bool>> Share<R> {
    fn join(&mut self, next: &Self) {
        self.weight = self.weight + next.weight;
        let add = |sums: &mut [R], more: &[R]| sums.iter_mut().zip(more).for_each(|(sum, more)| *sum = *sum + *more);
        add(&mut self.columns, &next.columns);
        add(&mut self.candidates, &next.candidates);
    }
}

impl<R: Real<Mask = bool>> Clusters<R> {
    /// None again.
    pub fn clear(&mut self) {
        self.list.clear();
    }

    /// Takes in a window, whose numbers are written where they will stand; where that is one too many, the two
    /// neighbours that say least become one.
    pub fn add(&mut self, write: impl FnOnce(&mut Share<R>)) {
        let zero = R::zero();
        let _ = self.list.push(Share { weight: zero, columns: [zero; MAX_COLUMNS], candidates: [zero; MAX_JUDGED] });
        if let Some(share) = self.list.last_mut() {
            write(share);
        }
        if self.list.len() <= MAX_CLUSTERS {
            return;
        }
        let pair = |first: usize| self.list[first].weight + self.list[first + 1].weight;
        let merged = (1..MAX_CLUSTERS).fold(0, |best, first| if pair(first).lt(pair(best)) { first } else { best });
        if let Some((one, next)) = self.list[merged..].split_first_mut() {
            one.join(&next[0]);
        }
        self.list.remove(merged + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_too_many_windows_the_two_neighbours_that_weigh_least_become_one_with_the_sums_of_both() {
        let mut clusters = Clusters::<f64>::empty();
        let mut weights = [10.0; MAX_CLUSTERS + 1];
        // 2 and 3 weigh least together, though 0.1 weighs least alone and times its neighbour.
        (weights[3], weights[7], weights[8]) = (0.1, 2.0, 3.0);
        for (n, weight) in weights.into_iter().enumerate() {
            clusters.add(|share| {
                share.weight = weight;
                share.columns[1] = n as f64;
                share.candidates[2] = 100.0 * n as f64;
            });
        }
        let list = clusters.list();
        assert_eq!(list.len(), MAX_CLUSTERS);
        assert_eq!((list[6].weight, list[7].weight, list[8].weight), (10.0, 5.0, 10.0));
        assert_eq!((list[7].columns[1], list[7].candidates[2]), (15.0, 1500.0));
        assert_eq!((list[8].columns[1], list[3].weight), (9.0, 0.1));
        clusters.clear();
        assert!(clusters.list().is_empty());
    }
}
