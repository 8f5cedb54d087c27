//! Work on all cores at once.
//!
//! Rayon's own iterators are compiled anew for each closure they are given, at some fifty places; here they are compiled
//! once.

use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// What becomes of each item, in their order.
pub(crate) fn on_all_cores<T: Send, U: Send>(items: impl IntoIterator<Item = T>, of: impl Fn(T) -> U + Sync) -> Vec<U> {
    let places: Vec<Mutex<(Option<T>, Option<U>)>> =
        items.into_iter().map(|item| Mutex::new((Some(item), None))).collect();
    spread(places.len(), &|idx| {
        let mut place = places[idx].lock().unwrap_or_else(PoisonError::into_inner);
        place.1 = place.0.take().map(&of);
    });
    places.into_iter().filter_map(|place| place.into_inner().unwrap_or_else(PoisonError::into_inner).1).collect()
}

/// Each place is visited once, by whichever core is free.
fn spread(n_places: usize, visit: &(dyn Fn(usize) + Sync)) {
    (0..n_places).into_par_iter().for_each(visit);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_item_is_taken_once_and_the_order_stays() {
        let n_items = 1000;
        let within = |i: usize| on_all_cores(0..i % 7, |k| k * i).into_iter().sum::<usize>();
        let expected: Vec<usize> = (0..n_items).map(|i| (0..i % 7).map(|k| k * i).sum()).collect();
        assert_eq!(on_all_cores(0..n_items, within), expected);
        let mut counts = vec![0; n_items];
        on_all_cores(&mut counts, |count| *count += 1);
        assert!(counts.iter().all(|count| *count == 1));
        assert!(on_all_cores(Vec::<u8>::new(), |item| item).is_empty());
    }

    #[test]
    #[should_panic(expected = "of the third")]
    fn a_panic_of_one_item_is_a_panic_of_all() {
        on_all_cores(0..8, |i| assert_ne!(i, 3, "of the third"));
    }
}
