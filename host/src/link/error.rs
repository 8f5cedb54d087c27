//! What can go wrong between the program and the rig.

use crate::error::Failure;
use shared::potentiometer::Potentiometer;
use shared::wire::{NEWEST_PROTOCOL, Refusal};
use std::io;
use thiserror::Error;

/// What a push sends.
pub(super) const MODEL: &str = "model";

/// A link that did not come about, or broke.
#[derive(Debug, Error)]
pub enum LinkError {
    /// No device of this name.
    #[error("there is no port {port}; {}", seen_ports(seen))]
    NoSuchPort {
        /// As the user named it.
        port: String,
        /// The ports there are.
        seen: Vec<String>,
    },
    /// No scenario of this name.
    #[error("there is no simulated rig {name}; there are {}", known.join(", "))]
    NoSuchScenario {
        /// As the user named it.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// The system refused for lack of rights.
    #[error("no permission to open {port}")]
    NoPermission {
        /// The port.
        port: String,
    },
    /// Another program, or another run of this one, has it open.
    #[error("{port} is in use{}", by_whom(users))]
    Busy {
        /// The port.
        port: String,
        /// Programs that have it open, as far as they can be seen.
        users: Vec<String>,
    },
    /// Not a serial device, or one that does not work.
    #[error("{port} could not be opened as a serial port: {reason}")]
    NotUsable {
        /// The port.
        port: String,
        /// In the system's words.
        reason: String,
    },
    /// Nothing at all was heard.
    #[error("nothing answers on {port}: not one byte in {seconds} s")]
    Silent {
        /// The port.
        port: String,
        /// How long it was listened to.
        seconds: u64,
    },
    /// Something is there, but it is no rig.
    #[error("what answers on {port} is not a pendulum rig: {n_bytes} bytes in {seconds} s, such as {sample}")]
    Stranger {
        /// The port.
        port: String,
        /// How long it was listened to.
        seconds: u64,
        /// Bytes heard.
        n_bytes: u64,
        /// The first of them, readable.
        sample: String,
    },
    /// Our own words came back.
    #[error("{port} sends back what it is sent")]
    Echo {
        /// The port.
        port: String,
    },
    /// A rig of another version.
    #[error("{name} on {port} (firmware {version}) speaks protocol {theirs}, this program {NEWEST_PROTOCOL}")]
    OtherProtocol {
        /// The port.
        port: String,
        /// The rig.
        name: String,
        /// Its firmware's version.
        version: String,
        /// Its protocol.
        theirs: u16,
    },
    /// The device is gone.
    #[error("the connection to {port} broke: {source}")]
    Lost {
        /// The port.
        port: String,
        /// In the system's words.
        source: io::Error,
    },
    /// The stream dried up.
    #[error("the rig on {port} stopped sending samples")]
    StreamStopped {
        /// The port.
        port: String,
    },
    /// Its sample count began anew.
    #[error("the rig on {port} restarted")]
    Restarted {
        /// The port.
        port: String,
    },
    /// A command was asked several times in vain.
    #[error("the rig on {port} did not answer when asked {n_times} times to {command}")]
    NoAnswer {
        /// The port.
        port: String,
        /// What it was to do.
        command: &'static str,
        /// How often it was asked.
        n_times: u32,
    },
    /// The rig said no.
    #[error("the rig refused to {command}: {refusal}")]
    Refused {
        /// What it was to do.
        command: &'static str,
        /// Its reason.
        refusal: Refusal,
    },
    /// An answer that does not belong to the question.
    #[error("the rig's answer does not fit the question ({command})")]
    WrongAnswer {
        /// What it was to do.
        command: &'static str,
    },
    /// Settings with which nothing can be computed.
    #[error("the rig says that its {what} is {told}, expected {expected}")]
    BadSetting {
        /// Which of them.
        what: &'static str,
        /// As the rig told it.
        told: String,
        /// What it may be.
        expected: String,
    },
    /// In use, but not in flash.
    #[error("the rig uses the new {what} until its power goes, and did not save it: {refusal}")]
    NotSaved {
        /// A model or a calibration.
        what: &'static str,
        /// The rig's reason.
        refusal: Refusal,
    },
    /// What came back from flash is not what was sent.
    #[error("{what} came back from the rig's flash as {got}, sent was {sent}")]
    NotKept {
        /// The value.
        what: String,
        /// As sent, rounded to f32.
        sent: f32,
        /// As read back.
        got: f32,
    },
    /// Firmware from before custom formulas.
    #[error("the rig's firmware does not know custom formulas")]
    NoFormulas,
    /// Its firmware reads a potentiometer and nothing else.
    #[error("{firmware} knows no sensor of kind {sensor}")]
    OldSensors {
        /// Its firmware.
        firmware: String,
        /// The sensor.
        sensor: &'static str,
    },
    /// A calibration that was made with another converter.
    #[error(
        "this calibration is for a converter that reads 0 … {}, and the rig's reads 0 … {}", made_for.full_scale,
        scaled.full_scale
    )]
    OtherScale {
        /// The calibration.
        made_for: Potentiometer,
        /// What it comes to on the rig's scale.
        scaled: Potentiometer,
    },
    /// Firmware that knows no friction curves.
    #[error("the rig's firmware can't run a friction curve")]
    NoCurves,
    /// A formula whose program is not what this program makes of its text.
    #[error("the rig holds a custom formula that this program does not understand")]
    UnknownFormula,
}

impl LinkError {
    /// What to do next.
    pub fn next_step(&self) -> String {
        match self {
            Self::NoSuchPort { .. } => "plug the rig in and name its port, or try without hardware: --port sim",
            Self::NoSuchScenario { .. } => "choose one of them, or --port sim",
            Self::NoPermission { .. } => {
                "join the group that owns the port (often: sudo usermod -aG dialout $USER, then log in again), or add a \
                 udev rule for the board"
            }
            Self::Busy { .. } => "close the other program, or wait until it is done",
            Self::NotUsable { .. } => "name the serial device of the rig, such as /dev/ttyACM0",
            Self::Silent { .. } => {
                "check that this is the rig's port and that its firmware runs (its light blinks); press its reset button"
            }
            Self::Stranger { .. } => "this may be another device, or another firmware: name the rig's port, or flash the rig",
            Self::Echo { .. } => "take the loop-back wire between its pins away, or name the rig's port",
            Self::OtherProtocol { theirs, .. } if *theirs > NEWEST_PROTOCOL => "update this program",
            Self::OtherProtocol { .. } => "update the rig's firmware",
            Self::Restarted { .. } => "repeat the command; `host statistics` tells why the rig last started",
            Self::Lost { .. } => "check the cable, plug it in again and repeat the command",
            Self::StreamStopped { .. } | Self::NoAnswer { .. } | Self::WrongAnswer { .. } => {
                "press the rig's reset button and repeat the command"
            }
            Self::BadSetting { .. } => {
                "press the rig's reset button and repeat the command; if it stays so, its firmware is at fault: flash this \
                 project's (host update --help), or mend your own by docs/protocol.md"
            }
            Self::NotSaved { what: MODEL, refusal } => {
                let saved = "if the model is in no file yet, host fit RECORDING -o rig.toml keeps it, and host push sends it again";
                return format!("{}; {saved}", after_refusal(refusal));
            }
            Self::NotSaved { refusal, .. } => return after_refusal(refusal).to_owned(),
            Self::Refused { refusal, .. } => return after_refusal(refusal).to_owned(),
            Self::NoFormulas => "update the firmware, or take the formula out: host improve … --remove custom",
            Self::OldSensors { .. } => "update the rig's firmware: host update --help",
            Self::OtherScale { scaled, .. } => return for_scale(scaled),
            Self::NoCurves => "update the firmware (host update --help), or push a model without the curve: host improve … \
                               --remove friction-curve",
            Self::UnknownFormula => "update the older of rig and program, or push another model",
            Self::NotKept { .. } => "push again; if it stays so, the rig's flash is worn out or its firmware is another",
        }
        .to_owned()
    }
}

/// How a calibration comes to another converter.
fn for_scale(scaled: &Potentiometer) -> String {
    let Potentiometer { zero_code, radian_per_code, full_scale } = scaled;
    format!(
        "host calibrate measures the rig's own; for the same potentiometer, mounted as it was, set zero_code = {zero_code}, \
         radians_per_code = {radian_per_code} and full_scale = {full_scale} in [sensor] and push again"
    )
}

fn after_refusal(refusal: &Refusal) -> &'static str {
    match refusal {
        Refusal::Protocol { .. } => "update the older of the two",
        Refusal::Parameters(_) => "correct that value, or update the rig's firmware if it does not know the effect",
        Refusal::Setting { index: 3 } => "take a calibration that was made on this rig: host calibrate",
        Refusal::Setting { .. } => "choose a value within the range",
        Refusal::NotStill => "hold the pendulum still and repeat the command",
        Refusal::BadAngle => "hold it at a larger, well-known angle and repeat the command",
        Refusal::SensorDisconnected => "check the sensor's wires",
        Refusal::GainIsKnown => "leave the angles out: its zero is all there is to measure",
        Refusal::NoSuchSensor => "use a board with an input for it (docs/wiring.md), or the sensor that this one has",
        Refusal::Flash => "repeat the command; if it stays so, the rig's flash is worn out",
        Refusal::Supply => "give the rig its full supply, 3.3 V on the chip, and repeat the command",
        Refusal::NothingStored => "store something first with `host push`",
        Refusal::Curve => "give the curve's speeds in rising order from 0, or fit it anew",
        Refusal::Formula => "update the rig's firmware, or write a simpler formula",
        Refusal::NotHere => "use a board that can, or do without",
    }
}

fn seen_ports(seen: &[String]) -> String {
    match seen {
        [] => "no serial port is plugged in".to_owned(),
        ports => format!("seen are {}", ports.join(", ")),
    }
}

fn by_whom(users: &[String]) -> String {
    if users.is_empty() { " by another program".to_owned() } else { format!(" by {}", users.join(" and ")) }
}

impl From<LinkError> for Failure {
    fn from(error: LinkError) -> Self {
        let failure = match error {
            LinkError::NoSuchScenario { .. } => Self::wrong_use(&error),
            _ => Self::failed(&error),
        };
        failure.next(error.next_step())
    }
}
