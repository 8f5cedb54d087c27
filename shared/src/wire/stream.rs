//! What a rig sends while it samples: converter codes, and what it makes of them.

use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Samples in a raw frame.
pub const SAMPLES_PER_FRAME: usize = 16;

/// Points in a live frame.
pub const POINTS_PER_FRAME: usize = 8;

/// What to send while streaming.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stream {
    /// Every converter code.
    pub raw: bool,
    /// A live point every so many samples; 0 for none.
    pub live_every: u16,
}

/// A run of converter codes without a gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Samples {
    /// Counts frames of this stream; a jump means lost frames.
    pub sequence: u32,
    /// Number of the first sample since power-up: the time base. A jump means lost samples.
    pub first_sample: u64,
    /// [`status`] bits.
    pub status: u8,
    /// One code a sample.
    pub codes: Vec<u16, SAMPLES_PER_FRAME>,
}

/// Bits of [`Samples::status`] and [`Live::status`].
pub mod status {
    /// The potentiometer reads an end of its range: broken wire or dead zone.
    pub const DISCONNECTED: u8 = 1;
    /// Samples were lost to a converter overrun or an announced flash erase since the last frame.
    pub const SAMPLES_LOST: u8 = 2;
    /// Frames were dropped since the last one because the link did not take them.
    pub const FRAMES_DROPPED: u8 = 4;
}

/// Live points without a gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Live {
    /// Counts frames of this stream.
    pub sequence: u32,
    /// Sample number of the first point.
    pub first_sample: u64,
    /// Samples from one point to the next.
    pub every: u16,
    /// [`status`] bits.
    pub status: u8,
    /// The points.
    pub points: Vec<Point, POINTS_PER_FRAME>,
}

/// What the board makes of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Filtered measured angle, rad.
    pub filtered_rad: f32,
    /// Observed angle, rad.
    pub angle_rad: f32,
    /// Observed velocity, rad/s.
    pub velocity_rad_s: f32,
    /// Measured minus predicted angle, unfiltered, rad.
    pub innovation_rad: f32,
    /// Friction and added effects, N·m.
    pub friction_nm: f32,
}
