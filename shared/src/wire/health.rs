//! How a board fares: its counters, and why it last started.

use heapless::String;
use serde::{Deserialize, Serialize};

/// Why the board last started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResetCause {
    /// Power came on, or nothing is known.
    #[default]
    Power,
    /// By command or by the reset pin.
    Asked,
    /// The watchdog: sampling had stopped.
    Watchdog,
    /// A panic in the program.
    Panic,
    /// A hard fault of the processor.
    HardFault,
}

/// What flash held when the board started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum StoreState {
    /// Nothing yet: defaults are in use.
    #[default]
    Empty,
    /// Valid content, in use.
    Loaded,
    /// Content of another version: defaults are in use.
    OtherVersion,
    /// Damaged content: defaults are in use.
    Damaged,
}

/// Counters since the last reset.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Samples taken.
    pub samples: u64,
    /// Samples lost to converter overruns.
    pub overruns: u32,
    /// Samples not taken during announced flash erases.
    pub paused: u32,
    /// Frames dropped because the link did not take them.
    pub dropped_frames: u32,
    /// Frames received with a wrong check sum or meaning.
    pub bad_frames: u32,
    /// Samples read at an end of the potentiometer's range.
    pub disconnected: u32,
    /// Root mean square of the innovation over the last seconds, rad.
    pub innovation_rms_rad: f32,
    /// What depends on the board.
    pub health: Health,
}

/// What only the board knows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Health {
    /// Share of the processor's time in use, in thousandths; 0 if not measured.
    pub cpu_permille: u16,
    /// Most bytes of stack ever used; 0 if not measured.
    pub stack_used: u32,
    /// Bytes of stack there are.
    pub stack_size: u32,
    /// Restarts since power came on.
    pub resets: u16,
    /// Why it last started.
    pub cause: ResetCause,
    /// What flash held then.
    pub store: StoreState,
    /// Where the last panic or fault was (file:line or address), empty if none.
    pub last_fault: String<48>,
}
