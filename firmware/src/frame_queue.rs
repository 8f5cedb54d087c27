//! Frames on their way to the link: bounded, never waiting. When it is full the oldest frames make room.

use core::cell::RefCell;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use heapless::{Deque, Vec};
use shared::wire::{Frame, MAX_FRAME, encode};

/// Bytes in the queue: a quarter of a second of raw codes and live points at 1 kHz.
pub const CAPACITY: usize = 6144;

/// An encoded frame, delimiter included.
pub type Encoded = Vec<u8, MAX_FRAME>;

/// The queue. One side pushes, the other takes, both in the same executor.
pub struct FrameQueue {
    bytes: RefCell<Deque<u8, CAPACITY>>,
    filled: Signal<NoopRawMutex, ()>,
    emptied: Signal<NoopRawMutex, ()>,
}

impl Default for FrameQueue {
    fn default() -> Self {
        Self::new()
    }
}

impl FrameQueue {
    /// An empty queue.
    pub const fn new() -> Self {
        Self { bytes: RefCell::new(Deque::new()), filled: Signal::new(), emptied: Signal::new() }
    }

    /// Adds a frame; gives how many old ones had to go.
    pub fn push(&self, frame: &Frame) -> u32 {
        let mut buffer = [0; MAX_FRAME];
        // Every frame that the messages allow fits the buffer: shared::wire tests the longest of each kind.
        let Ok(encoded) = encode(frame, &mut buffer) else { return 0 };
        let mut bytes = self.bytes.borrow_mut();
        let mut n_dropped = 0;
        while CAPACITY - bytes.len() < encoded.len() {
            while bytes.pop_front().is_some_and(|byte| byte != 0) {}
            n_dropped += 1;
        }
        bytes.extend(encoded.iter().copied());
        self.filled.signal(());
        n_dropped
    }

    /// Forgets everything, for a listener that has just arrived.
    pub fn clear(&self) {
        self.bytes.borrow_mut().clear();
    }

    /// Waits for a frame and takes it out.
    pub async fn take(&self, encoded: &mut Encoded) {
        loop {
            encoded.clear();
            {
                let mut bytes = self.bytes.borrow_mut();
                while let Some(byte) = bytes.pop_front() {
                    // A frame is never longer than what it was encoded into.
                    let _ = encoded.push(byte);
                    if byte == 0 {
                        return;
                    }
                }
            }
            self.emptied.signal(());
            self.filled.wait().await;
        }
    }

    /// Waits until everything pushed so far has been taken and the taker has come back for more.
    pub async fn drained(&self) {
        self.emptied.reset();
        self.filled.signal(());
        self.emptied.wait().await;
    }
}
