//! What rig and PC say to each other: postcard messages with a CRC-32 inside COBS frames that end with a zero byte.
//!
//! After any damage the reader is in step again at the next zero byte. [`Hello`] is frozen: it keeps its bytes in
//! every version, so that any two versions can at least name themselves. All other messages may change with
//! [`PROTOCOL`]; variants of [`Frame`] keep their numbers for ever.

use crate::bank::findings::Reason;
use crate::curve::{Knot, MAX_KNOTS};
use crate::effect::{CUSTOM_FORMULA_ID, Effect, MAX_VALUES};
use crate::formula::MAX_BYTES;
use crate::parameters::ParameterError;
use crate::sensor::Sensor;
use crate::units::Radian;
use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

mod framing;
mod numbers;

pub use framing::{Deframer, MAX_FRAME, WireError, decode, encode};
pub use numbers::Numbers;

/// Version of all messages but [`Hello`]: what programs say, and rigs whose sensor is a potentiometer.
pub const PROTOCOL: u16 = 1;

/// What rigs with another sensor say, so that a program that reads potentiometers only refuses them by name; see
/// [`Sensor::protocol`]. In all else it is [`PROTOCOL`].
pub const NEWEST_PROTOCOL: u16 = 2;

/// First bytes of every [`Hello`].
pub const MAGIC: [u8; 4] = *b"PNDL";

/// Samples in a raw frame.
pub const SAMPLES_PER_FRAME: usize = 16;

/// Points in a live frame.
pub const POINTS_PER_FRAME: usize = 8;

/// Who speaks; frozen. Sent by the PC to open a session and by the rig in answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`PROTOCOL`] of the speaker.
    pub protocol: u16,
    /// [`catalogue_hash`] of the speaker: equal if both know the same effects.
    pub catalogue: u32,
    /// Version of the firmware or program: major, minor, patch.
    pub version: [u8; 3],
    /// The board, or `host`.
    pub name: String<24>,
}

impl Hello {
    /// The speaker of this build.
    pub fn new(name: &str) -> Self {
        let mut short = String::new();
        for c in name.chars() {
            if short.push(c).is_err() {
                break;
            }
        }
        Self { magic: MAGIC, protocol: PROTOCOL, catalogue: catalogue_hash(), version: version(), name: short }
    }
}

/// This package's version.
fn version() -> [u8; 3] {
    let number = |text: &str| text.parse().unwrap_or(0);
    [
        number(env!("CARGO_PKG_VERSION_MAJOR")),
        number(env!("CARGO_PKG_VERSION_MINOR")),
        number(env!("CARGO_PKG_VERSION_PATCH")),
    ]
}

/// A fingerprint (FNV-1a) of the effects this build knows: ids and numbers of parameters.
pub fn catalogue_hash() -> u32 {
    let feed = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    Effect::<f32>::ALL.iter().fold(0x811c_9dc5, |hash, effect| {
        let [low, high] = effect.id.to_le_bytes();
        [low, high, effect.parameters.len() as u8].into_iter().fold(hash, feed)
    })
}

/// Everything that crosses the wire, either way.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Frame {
    /// Frozen.
    Hello(Hello),
    /// PC to rig; the number comes back in the answer.
    Command(u16, Command),
    /// Rig to PC, with the command's number.
    Answer(u16, Answer),
    /// Rig to PC: converter codes.
    Samples(Samples),
    /// Rig to PC: what filter and observer make of them.
    Live(Live),
    /// The law of the effect [`CUSTOM_FORMULA_ID`], as [`crate::formula::Formula::bytes`]. From the PC: hold this
    /// one, and use it from the next parameters on; empty: tell me. From the rig: this one is held; empty: none.
    CustomFormula(Vec<u8, MAX_BYTES>),
    /// The knots of the effect [`crate::effect::CURVE_ID`], in the same way. Firmware from before there were curves counts
    /// it as a bad frame.
    FrictionCurve(Vec<Knot, MAX_KNOTS>),
}

/// What the PC may ask.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Start sending samples, live points or both.
    Start(Stream),
    /// Stop sending; sampling goes on.
    Stop,
    /// Give the parameters in use.
    GetParameters,
    /// Use these parameters from now on.
    SetParameters(Numbers),
    /// Keep parameters, settings and calibration in flash.
    Save,
    /// Take them from flash again.
    Load,
    /// Use the defaults from now on; flash keeps what it has.
    Defaults,
    /// Give settings and calibration.
    GetSettings,
    /// Use these settings from now on.
    SetSettings(Settings),
    /// The pendulum hangs at rest: this is zero.
    ZeroHere,
    /// The pendulum is held at a known angle: compute the gain.
    CalibrateGain(Radian),
    /// Give the counters.
    Statistics,
    /// Restart the firmware.
    Reset,
    /// Restart into the chip's bootloader (USB DFU), to be updated.
    Bootloader,
    /// Give what is known of the chip. Firmware from before this command counts it as a bad frame.
    Chip,
    /// Give what the rig itself found missing in its model. Firmware that does not look refuses; firmware from before this
    /// command counts it as a bad frame.
    Suspects,
}

/// What the rig answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Done as asked.
    Done,
    /// Not done, and why; everything stays as it was.
    Refused(Refusal),
    /// The parameters in use.
    Parameters(Numbers),
    /// The settings in use.
    Settings(Settings),
    /// The counters.
    Statistics(Statistics),
    /// The chip.
    Chip(Chip),
    /// What the rig found.
    Suspects(Suspects),
}

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// The two speak different versions.
    Protocol {
        /// The PC's version.
        host: u16,
        /// The rig's version.
        rig: u16,
    },
    /// Parameters that can't be used.
    Parameters(ParameterError),
    /// Settings outside their range: which, by position in [`Settings`].
    Setting {
        /// 0 rate, 1 cut-off, 2 bandwidth, 3 sensor.
        index: u8,
    },
    /// The pendulum moves, so that it can't be calibrated now.
    NotStill,
    /// The known angle is too near zero, or the gain it gives is absurd.
    BadAngle,
    /// The potentiometer seems to be disconnected.
    SensorDisconnected,
    /// Flash could not be written or read back.
    Flash,
    /// There is nothing (usable) in flash.
    NothingStored,
    /// This board can't do that.
    NotHere,
    /// What came is no program of a formula that this firmware can run.
    Formula,
    /// The supply is too low to write to flash.
    Supply,
    /// The sensor's gain is a number of its own, which no angle can tell better.
    GainIsKnown,
    /// This board has no input for that sensor.
    NoSuchSensor,
    /// What came are no knots of a friction curve.
    Curve,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Protocol { host, rig } => {
                write!(f, "the program speaks protocol {host}, the rig {rig}; update the older of the two")
            }
            Self::Parameters(error) => write!(f, "{error}"),
            Self::Setting { index } => {
                let what = ["sampling rate", "filter cut-off", "observer bandwidth", "sensor's calibration"];
                write!(f, "the {} is outside its range", what.get(usize::from(*index)).copied().unwrap_or("setting"))
            }
            Self::NotStill => write!(f, "the pendulum is moving; hold it still and ask again"),
            Self::BadAngle => write!(f, "that angle gives no sensible gain; hold it at 0.5 rad or more from zero"),
            Self::SensorDisconnected => write!(f, "the potentiometer reads an end of its range; check its wires"),
            Self::Flash => write!(f, "the flash memory could not be written"),
            Self::NothingStored => write!(f, "nothing usable is stored in flash"),
            Self::NotHere => write!(f, "this board cannot do that"),
            Self::Formula => write!(f, "its firmware cannot run this formula; is the firmware older?"),
            Self::Supply => write!(f, "its supply is below 2.9 V, too low to write to flash"),
            Self::GainIsKnown => {
                write!(f, "its sensor's gain follows from its counts a turn; there is nothing to measure")
            }
            Self::NoSuchSensor => write!(f, "this board has no input for that sensor"),
            Self::Curve => {
                write!(f, "the knots of the friction curve are not 2 to {MAX_KNOTS} speeds that rise from 0")
            }
        }
    }
}

/// What to send while streaming.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stream {
    /// Every converter code.
    pub raw: bool,
    /// A live point every so many samples; 0 for none.
    pub live_every: u16,
}

/// What can be set besides the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Samples per second, 50 … 10 000. A rig that cannot make a rate exactly takes the nearest one it can, and gives
    /// that.
    pub rate_hz: f32,
    /// Cut-off of the Butterworth filter, below 0.45 of the rate.
    pub cutoff_hz: f32,
    /// Bandwidth of the observer, 0 … 100 rad/s; 0 lets the model run alone.
    pub bandwidth_rad_s: f32,
    /// Which sensor, and its calibration.
    #[serde(with = "crate::sensor::bytes")]
    pub sensor: Sensor,
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

/// What only the chip knows of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Chip {
    /// Its unique number as its bootloader and its USB give it, 12 hexadecimal digits; empty if it has none.
    pub serial: String<12>,
    /// What its cycles come from.
    pub clock: Clock,
    /// Cycles in a second; 0 if they are not counted.
    pub clock_hz: u32,
    /// Making a sample of its conversions.
    pub sample: Cycles,
    /// Potentiometer, filter and observer, for one sample.
    pub observer: Cycles,
    /// Encoding one frame.
    pub frame: Cycles,
    /// Saving to flash, with everything that goes on meanwhile.
    pub save: Cycles,
}

/// Version of [`Suspects`]: 1.
pub const SUSPECTS: u8 = 1;

/// Suspects that are told.
pub const MAX_SUSPECTS: usize = 5;

/// What the rig itself says of its model after the last releases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspects {
    /// [`SUSPECTS`].
    pub version: u8,
    /// Is it looking, or about to?
    pub is_looking: bool,
    /// How often it has looked since power-up; what follows is of the last look.
    pub n_looks: u32,
    /// Releases it looked at.
    pub n_releases: u8,
    /// Windows that these gave …
    pub n_windows: u16,
    /// … in so many clusters: K.
    pub n_clusters: u8,
    /// Noise of the readings, rad.
    pub noise_rad: f32,
    /// What is left beyond the noise, as a share of the noise's squares: by the model as it is, and put right.
    pub excess: [f32; 2],
    /// The same with the first suspect in the model, where it is named.
    pub left: Option<f32>,
    /// Why none is named; none if the first one is.
    pub reason: Option<Reason>,
    /// The likeliest first.
    pub suspects: Vec<Suspected, MAX_SUSPECTS>,
    /// What the look took, in processor cycles of the chip; 0 if not measured.
    pub cycles: u64,
}

/// An effect that may be missing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspected {
    /// Its id.
    pub effect: u16,
    /// Its values.
    pub values: Vec<f32, MAX_VALUES>,
    /// Their standard deviations; none for a shape that was assumed.
    pub stds: Vec<Option<f32>, MAX_VALUES>,
    /// F(q, K − q) distributed where the effect is absent …
    pub f: f32,
    /// … with this q.
    pub n_tested: u8,
    /// Can't be told from the first one.
    pub is_tied: bool,
}

impl Suspects {
    /// Before the first look.
    pub const fn none() -> Self {
        Self {
            version: SUSPECTS,
            is_looking: false,
            n_looks: 0,
            n_releases: 0,
            n_windows: 0,
            n_clusters: 0,
            noise_rad: 0.0,
            excess: [0.0; 2],
            left: None,
            reason: Some(Reason::TooFewSwings),
            suspects: Vec::new(),
            cycles: 0,
        }
    }

    /// Is something named?
    pub fn names(&self) -> bool {
        self.reason.is_none() && !self.suspects.is_empty()
    }
}

/// Where a chip's cycles come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Clock {
    /// It does not say.
    #[default]
    Unknown,
    /// A crystal, good for 50 ppm.
    Crystal,
    /// The chip's own oscillator, good for 1 %, because the crystal does not run.
    Internal,
}

/// How long a stage of the work took, in processor cycles, since the last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycles {
    /// How often.
    pub count: u32,
    /// On average, the last ten thousand times.
    pub mean: f32,
    /// At most.
    pub worst: u32,
}

impl Cycles {
    /// Once more.
    pub fn took(&mut self, cycles: u32) {
        const REMEMBERED: u32 = 10_000;
        self.count = self.count.saturating_add(1);
        self.mean += (cycles as f32 - self.mean) / self.count.min(REMEMBERED) as f32;
        self.worst = self.worst.max(cycles);
    }
}

/// [`Frame`] as far as a rig receives it, with the same numbers.
#[derive(Deserialize)]
enum ForRig {
    Hello(Hello),
    Command(u16, Command),
    Answer,
    Samples,
    Live,
    CustomFormula(Vec<u8, MAX_BYTES>),
    FrictionCurve(Vec<Knot, MAX_KNOTS>),
}

impl From<ForRig> for Frame {
    fn from(frame: ForRig) -> Self {
        match frame {
            ForRig::Hello(hello) => Self::Hello(hello),
            ForRig::Command(number, command) => Self::Command(number, command),
            ForRig::CustomFormula(program) => Self::CustomFormula(program),
            ForRig::FrictionCurve(knots) => Self::FrictionCurve(knots),
            // Their content is missing, so they never pass the check for left-over bytes.
            ForRig::Answer | ForRig::Samples | ForRig::Live => Self::CustomFormula(Vec::new()),
        }
    }
}

const _: () = assert!(CUSTOM_FORMULA_ID > 255, "small ids belong to the list");

#[cfg(test)]
mod tests;
