//! Several things at a time, each on one thread from its beginning to its end.
//!
//! Each worker has a pool of one thread, in which everything runs that would otherwise spread over all cores: so the
//! memory is that of so many recordings, however many there are, and sums have one order.

use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Does something with each item until all are done, one fails, or `stop` is set; what is begun is finished.
///
/// # Errors
/// The first that occurs.
pub(super) fn each<T: Sync, E: Send>(
    items: &[T],
    n_workers: usize,
    stop: &AtomicBool,
    work: impl Fn(&T) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let failed: Mutex<Option<E>> = Mutex::new(None);
    let has_failed = || failed.lock().unwrap_or_else(PoisonError::into_inner).is_some();
    let worker = || {
        while let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) {
            if stop.load(Ordering::SeqCst) || has_failed() {
                return;
            }
            if let Err(error) = work(item) {
                failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..n_workers.clamp(1, items.len().max(1)) {
            scope.spawn(|| match ThreadPoolBuilder::new().num_threads(1).build() {
                Ok(pool) => pool.install(worker),
                // Without a thread more, this one will do.
                Err(_) => worker(),
            });
        }
    });
    failed.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_done_once_and_the_first_error_ends_it() {
        let items: Vec<usize> = (0..1000).collect();
        let (sum, never) = (AtomicUsize::new(0), AtomicBool::new(false));
        let add = |item: &usize| {
            assert_eq!(rayon::current_num_threads(), 1);
            sum.fetch_add(*item, Ordering::Relaxed);
            if *item == 2000 { Err("too large") } else { Ok(()) }
        };
        assert_eq!(each(&items, 4, &never, add), Ok(()));
        assert_eq!(sum.load(Ordering::Relaxed), 499_500);
        assert_eq!(each(&[2000, 1, 1, 1], 1, &never, add), Err("too large"));
        assert_eq!(sum.load(Ordering::Relaxed), 501_500);
        assert_eq!(each(&items, 4, &AtomicBool::new(true), |_| Err("not stopped")), Ok(()));
    }
}
