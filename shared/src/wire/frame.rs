//! What crosses the wire: commands, answers, and what the rig sends by itself.

use super::chip::Chip;
use super::health::Statistics;
use super::hello::Hello;
use super::numbers::Numbers;
use super::refusal::Refusal;
use super::settings::Settings;
use super::stream::{Live, Samples, Stream};
use super::suspects::Suspects;
use crate::curve::{Knot, MAX_KNOTS};
use crate::effect::CUSTOM_FORMULA_ID;
use crate::formula::MAX_BYTES;
use crate::units::Radian;
use heapless::Vec;
use serde::{Deserialize, Serialize};

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

/// [`Frame`] as far as a rig receives it, with the same numbers.
#[derive(Deserialize)]
pub(super) enum ForRig {
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
            // With their content they never pass the check for left-over bytes; without it they change nothing, as a
            // program of no length is the question whether this rig knows formulas.
            ForRig::Answer | ForRig::Samples | ForRig::Live => Self::CustomFormula(Vec::new()),
        }
    }
}

const _: () = assert!(CUSTOM_FORMULA_ID > 255, "small ids belong to the list");
