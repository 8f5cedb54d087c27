//! For tests: the simulated rig behind something that changes what it says.

use super::{LinkError, Port, Session, open};
use shared::wire::{Deframer, Frame, MAX_FRAME, encode};
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// The rig, and what becomes of its frames.
struct Changed<F> {
    rig: Box<dyn Port>,
    deframer: Deframer,
    unread: VecDeque<u8>,
    change: F,
}

/// A session with the rig of `sim`, each of whose frames arrives as `change` has it.
pub(crate) fn session(change: impl FnMut(Frame) -> Vec<Frame> + Send + 'static) -> Result<Session, LinkError> {
    let (rig, deframer, unread) = (open("sim")?, Deframer::new(), VecDeque::new());
    Ok(Session::open(Box::new(Changed { rig, deframer, unread, change }))?.keeping_in(None))
}

impl<F: FnMut(Frame) -> Vec<Frame>> Changed<F> {
    fn take(&mut self, bytes: &[u8]) {
        for frame in bytes.iter().filter_map(|byte| self.deframer.push(*byte)?.ok()) {
            for frame in (self.change)(frame) {
                self.unread.extend(encode(&frame, &mut [0; MAX_FRAME]).expect("every frame fits the longest"));
            }
        }
    }
}

impl<F: FnMut(Frame) -> Vec<Frame> + Send> Port for Changed<F> {
    fn name(&self) -> &str {
        "changed"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if self.unread.is_empty() {
            let mut heard = [0; 4096];
            let n_heard = self.rig.read(&mut heard, timeout)?;
            self.take(&heard[..n_heard]);
        }
        let n_bytes = self.unread.len().min(buffer.len());
        self.unread.drain(..n_bytes).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        Ok(n_bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.rig.write(bytes)
    }

    fn elapsed(&self) -> Duration {
        self.rig.elapsed()
    }
}
