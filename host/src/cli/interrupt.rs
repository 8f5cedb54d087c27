//! Ctrl-C: while a swing is recorded or a study runs the first one asks for an orderly end; otherwise the program ends at once.

use crate::error::INTERRUPTED;
use std::sync::atomic::{AtomicBool, Ordering};

static RECORDING: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Does something that ends early when its flag is set, by Ctrl-C.
pub(super) fn orderly<T>(work: impl FnOnce(&AtomicBool) -> T) -> T {
    // The handler of an earlier recording is still in place; setting it again fails and does no harm.
    let _ = ctrlc::set_handler(|| {
        if !RECORDING.load(Ordering::SeqCst) || ASKED.swap(true, Ordering::SeqCst) {
            end();
        }
    });
    // Who ended an earlier one has not ended this one.
    ASKED.store(false, Ordering::SeqCst);
    RECORDING.store(true, Ordering::SeqCst);
    let done = work(&ASKED);
    RECORDING.store(false, Ordering::SeqCst);
    done
}

/// Ends the program after an orderly end, as Ctrl-C does otherwise.
pub(super) fn end() -> ! {
    std::process::exit(INTERRUPTED.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_ended_one_recording_has_not_ended_the_next() {
        orderly(|stop| stop.store(true, Ordering::SeqCst));
        assert!(!orderly(|stop| stop.load(Ordering::SeqCst)));
    }
}
