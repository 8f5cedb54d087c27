//! `host update`: a new firmware image onto the rig.

use super::{output, port};
use crate::error::Failure;
use crate::link::{self, Session};
use crate::update::{Image, Way, bootloaders};
use clap::Args;
use serde::Serialize;
use shared::wire::Command;
use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// The chip's bootloader and the new firmware show themselves within so long, or something is wrong.
const PATIENCE: Duration = Duration::from_secs(20);
const LOOK_EVERY: Duration = Duration::from_millis(500);

/// A chip that was told to leave its bootloader is gone from USB within so long.
const LEAVES_WITHIN: Duration = Duration::from_secs(2);

/// Bring a new firmware onto the rig; saved model and calibration stay.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number
    #[arg(long, value_name = "PORT")]
    port: String,
    /// The image, or the folder of a release with the image of every board
    #[arg(value_name = "FILE")]
    image: PathBuf,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host update --port /dev/ttyACM0 pendulum-rig-0.2.0-firmware/
  host update --port /dev/ttyACM0 feather-f405.dfu

A Feather is updated over its USB by dfu-util, a Nucleo through the probe on its board by probe-rs;
the one that is needed has to be installed. The image is checked before anything is changed, the
version afterwards.";

#[derive(Serialize)]
struct Updated {
    port: String,
    board: String,
    from: String,
    to: String,
    image: PathBuf,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut session = port::connect(&options.port)?;
    let board = session.rig().name.to_string();
    let from = session.version();
    let way = Way::of(&board)?;
    let image = Image::read(&options.image, &board, way)?;
    way.check_tool()?;

    let serial = session.chip()?.map(|chip| chip.serial.to_string());
    if way == Way::Usb {
        session.tell(&Command::Bootloader)?;
    }
    drop(session);
    let which = if way == Way::Usb { found(serial.as_deref())? } else { link::probe_of(&options.port) };
    carry_out(way, &image, which.as_deref())?;
    let to = back(&options.port)?.version();
    if to != image.version {
        let what = format!("the rig on {} says it runs {to}, not {}", options.port, image.version);
        return Err(Failure::failed(what).next("repeat the command"));
    }
    let updated = Updated { port: options.port.clone(), board, from, to, image: image.path };
    if options.json {
        output::json("update", &updated)
    } else {
        let Updated { port, board, from, to, .. } = &updated;
        output::result(&format!("{board} on {port} runs {to}; before it was {from}. What was saved is still there."));
    }
    Ok(())
}

/// Waits for the bootloader; gives its serial number if several are there.
fn found(serial: Option<&str>) -> Result<Option<String>, Failure> {
    output::say("waiting for the chip's bootloader …");
    let end = Instant::now() + PATIENCE;
    loop {
        let seen = bootloaders();
        if let Some(own) = seen.iter().find(|seen| Some(seen.as_str()) == serial) {
            return Ok(Some(own.clone()));
        }
        match (Instant::now() > end, seen.as_slice()) {
            (false, _) => std::thread::sleep(LOOK_EVERY),
            (true, [_]) => return Ok(None),
            (true, []) => {
                return Err(Failure::failed("the chip's bootloader does not show itself on USB").next(
                    "on Linux the rule of `host doctor --udev-rule` lets you use it; press reset to start the old firmware",
                ));
            }
            (true, _) => {
                return Err(Failure::failed(format!("several bootloaders are on USB: {}", seen.join(", ")))
                    .next("unplug all but this rig's, press its reset and repeat the command"));
            }
        }
    }
}

fn carry_out(way: Way, image: &Image, which: Option<&str>) -> Result<(), Failure> {
    way.calls(&image.path, which).iter().try_for_each(|arguments| call(way, arguments, which))
}

fn call(way: Way, arguments: &[String], which: Option<&str>) -> Result<(), Failure> {
    let line = format!("{} {}", way.tool(), arguments.join(" "));
    output::say(&line);
    // Its progress goes where ours does; our result stays alone on stdout.
    let status = std::process::Command::new(way.tool()).args(arguments).stdout(Stdio::null()).status();
    let reason = match status {
        Ok(status) if status.success() => return Ok(()),
        // dfu-util does not hear back from a chip that has left its bootloader: what runs then tells.
        Ok(_) if way == Way::Usb && has_left(which) => return Ok(()),
        Ok(status) => format!("{} ended with {status}: the image is not on the chip", way.tool()),
        Err(error) => format!("could not start {}: {error}", way.tool()),
    };
    Err(Failure::failed(reason).next(format!(
        "look at what it said; a chip that is protected against reading takes no image, and without that protection \
         it is empty; press reset to start what is on it. By hand it is: {line}"
    )))
}

/// Is the bootloader gone, or soon gone?
fn has_left(serial: Option<&str>) -> bool {
    let end = Instant::now() + LEAVES_WITHIN;
    loop {
        let is_there = bootloaders().iter().any(|seen| serial.is_none_or(|own| seen == own));
        if !is_there || Instant::now() > end {
            return !is_there;
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

/// The rig, once it runs again.
fn back(port: &str) -> Result<Session, Failure> {
    output::say("waiting for the rig …");
    let end = Instant::now() + PATIENCE;
    loop {
        match link::connect(port) {
            Ok(session) => return Ok(session),
            Err(error) if Instant::now() > end => {
                return Err(Failure::failed(format!("the rig does not answer after its update: {error}")).next(
                    "press its reset; if it stays silent, its bootloader takes the image again (docs/board-checks.md)",
                ));
            }
            Err(_) => std::thread::sleep(LOOK_EVERY),
        }
    }
}
