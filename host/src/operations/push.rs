//! A model onto the rig.

use super::model::{Value, values};
use crate::error::Failure;
use crate::link::Session;
use crate::rigfile::RigFile;
use serde::Serialize;

/// What the rig has now, as `--json` tells it.
#[derive(Clone, Debug, Serialize)]
pub struct Pushed {
    port: String,
    /// Who has it.
    pub firmware: String,
    calibration: bool,
    parameters: Vec<Value>,
}

/// Sends a model, and the calibration if that is wanted; saves it, reads it back and compares.
///
/// # Errors
/// Effects of another sensor; no calibration to send; the link, or a value that came back different.
pub fn push(session: &mut Session, file: &RigFile, calibration: bool, warn: &dyn Fn(&str)) -> Result<Pushed, Failure> {
    file.check_sensor()?;
    let calibration = calibrate(session, file, calibration, warn)?;
    session.push(file.parameters())?.iter().for_each(|note| warn(note));
    let (port, firmware) = (session.port().to_owned(), session.firmware());
    Ok(Pushed { port, firmware, calibration, parameters: values(file) })
}

/// Sends the calibration if that is wanted; else says when the rig has another one than the file.
fn calibrate(session: &mut Session, file: &RigFile, wanted: bool, warn: &dyn Fn(&str)) -> Result<bool, Failure> {
    let Some(sensor) = file.sensor() else {
        let nothing = Failure::wrong_use("the model file has no [sensor] table, so there is no calibration to send")
            .next("leave --calibration out, or take the rig's with `host pull`");
        return if wanted { Err(nothing) } else { Ok(false) };
    };
    let in_use = session.settings()?.sensor;
    if sensor.taken_over(&in_use) == in_use {
        return Ok(false);
    }
    if wanted {
        session.use_sensor(sensor)?;
    } else if sensor.is_like(&in_use) {
        warn("the rig's calibration differs from the file's and stays; --calibration sends the file's");
    } else {
        let (ours, rigs) = (sensor.name(), in_use.name());
        warn(&format!(
            "the rig reads a sensor of kind {rigs}, the file means one of kind {ours}; --calibration changes the rig's"
        ));
    }
    Ok(wanted)
}
