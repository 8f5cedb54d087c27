//! Ctrl-C: while a swing is recorded or a study runs the first one asks for an orderly end; otherwise the program ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

static RECORDING: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was interrupted: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Does something that ends early when its flag is set, by Ctrl-C.
pub(super) fn orderly<T>(work: impl FnOnce(&AtomicBool) -> T) -> T {
    // The handler of an earlier recording is still in place; setting it again fails and does no harm.
    let _ = ctrlc::set_handler(|| {
        if !RECORDING.load(Ordering::SeqCst) || ASKED.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
    });
    RECORDING.store(true, Ordering::SeqCst);
    let done = work(&ASKED);
    RECORDING.store(false, Ordering::SeqCst);
    done
}

/// Ends the program after an orderly end, as Ctrl-C does otherwise.
pub(super) fn end() -> ! {
    std::process::exit(INTERRUPTED)
}
