//! Work on a thread of its own while Python's thread hears of its progress, and of Ctrl-C.

use crate::errors::raised;
use host::error::Failure;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Signals are looked for this often. Half of it would wake the processor for nothing; at twice, Ctrl-C feels late.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Computations have the stack that the program's main thread has; bytes.
const STACK: usize = 8 << 20;

/// What a worker says.
pub(crate) enum Message<T> {
    News(String),
    Done(Result<T, Failure>),
}

/// Tells what happens, from any thread.
pub(crate) type Tell<'a> = &'a (dyn Fn(String) + Sync);

/// Computes without the interpreter's lock. After Ctrl-C the caller goes on at once, and what was begun ends by itself.
pub(crate) fn compute<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(Tell<'_>) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    let run = move || reply(&sender, work);
    std::thread::Builder::new().stack_size(STACK).spawn(run)?;
    hear(py, receiver, progress, None)
}

/// Does the work, and sends its news and its result.
pub(crate) fn reply<T: Send>(sender: &Sender<Message<T>>, work: impl FnOnce(Tell<'_>) -> Result<T, Failure>) {
    // Nobody listens any more after Ctrl-C.
    let done = work(&|news| drop(sender.send(Message::News(news))));
    drop(sender.send(Message::Done(done)));
}

/// Hears a worker out. With a flag, Ctrl-C asks for an orderly end and is raised once the worker is through.
pub(crate) fn hear<T: Send>(
    py: Python<'_>,
    receiver: Receiver<Message<T>>,
    progress: Option<&Bound<'_, PyAny>>,
    stop: Option<&Arc<AtomicBool>>,
) -> PyResult<T> {
    let receiver = Mutex::new(receiver);
    let next = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK_EVERY);
    let mut raised_meanwhile = None;
    loop {
        let trouble = match py.detach(next) {
            Ok(Message::Done(done)) => {
                return raised_meanwhile.map_or_else(|| done.map_err(|failure| raised(&failure)), Err);
            }
            Ok(Message::News(news)) => progress.map_or(Ok(()), |tell| tell.call1((news,)).map(drop)),
            Err(RecvTimeoutError::Timeout) => py.check_signals(),
            Err(RecvTimeoutError::Disconnected) => {
                let broken = Failure::failed("the computation broke off").next("report this, with what was asked for");
                return Err(raised(&broken));
            }
        };
        match (trouble, stop) {
            (Ok(()), _) => {}
            (Err(error), Some(stop)) => {
                stop.store(true, Ordering::SeqCst);
                raised_meanwhile.get_or_insert(error);
            }
            (Err(error), None) => return Err(error),
        }
    }
}
