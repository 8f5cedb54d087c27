//! What rig and PC say to each other: postcard messages with a CRC-32 inside COBS frames that end with a zero byte.
//!
//! After any damage the reader is in step again at the next zero byte. [`Hello`] is frozen: it keeps its bytes in
//! every version, so that any two versions can at least name themselves. All other messages may change with
//! [`PROTOCOL`]; variants of [`Frame`] keep their numbers for ever.

mod chip;
mod frame;
mod framing;
mod health;
mod hello;
mod numbers;
mod refusal;
mod settings;
mod stream;
mod suspects;

pub use crate::protocol::{NEWEST_PROTOCOL, PROTOCOL};
pub use chip::{Chip, Clock, Cycles};
pub use frame::{Answer, Command, Frame};
pub use framing::{Deframer, MAX_FRAME, WireError, decode, encode};
pub use health::{Health, ResetCause, Statistics, StoreState};
pub use hello::{Hello, MAGIC, catalogue_hash};
pub use numbers::Numbers;
pub use refusal::Refusal;
pub use settings::Settings;
pub use stream::{Live, POINTS_PER_FRAME, Point, SAMPLES_PER_FRAME, Samples, Stream, status};
pub use suspects::{MAX_SUSPECTS, SUSPECTS, Suspected, Suspects};

#[cfg(test)]
mod tests;
