//! `host calibrate`: from codes to angles, measured instead of taken from the data sheet.

use super::table::table;
use super::values::patience;
use super::{output, port, rig};
use crate::calibrate::{self, CalibrationError, HoldError, Known, Line, check_gain, gain_of_swings, hold, line};
use crate::error::Failure;
use crate::link::Session;
use crate::number::significant;
use crate::operations::sensor;
use crate::recording::segment::SegmentOptions;
use crate::recording::{self, ReadOptions, Recording, sensor_name};
use crate::rigfile::{RigFile, USUAL_NAME};
use crate::swing::Swing;
use clap::Args;
use serde::Serialize;
use shared::potentiometer::{ELECTRICAL_TRAVEL_RAD, LINEARITY};
use shared::sensor::{Encoder, Sensor};
use shared::wire::{Command, Stream};
use std::path::{Path, PathBuf};

/// The data sheet's linearity, percent of the travel.
const LINEARITY_PERCENT: f32 = 100.0 * LINEARITY;

/// Gains that differ by less are one: a file has them as text.
const SAME_GAIN: f64 = 1e-6;

/// Measure the sensor's zero and gain, check that its track is even, and save both in the rig and in rig.toml.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT", required_unless_present = "recording")]
    port: Option<String>,
    /// The model file to update, or to make from what the rig reports; ./rig.toml if none is named
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Known angles in degrees from hanging, in the order in which you will hold them
    #[arg(long, value_name = "DEG,DEG", value_delimiter = ',', allow_hyphen_values = true, value_parser = angle)]
    angles: Vec<f64>,
    /// Find the gain from this swing's period against amplitude (may be repeated)
    #[arg(long, value_name = "FILE", conflicts_with = "angles")]
    recording: Vec<PathBuf>,
    /// Read an incremental encoder with so many counts a turn from now on (four times its lines; negative if it counts
    /// the other way), and take its zero
    #[arg(long, value_name = "COUNTS", requires = "port", conflicts_with_all = ["angles", "recording"],
        allow_negative_numbers = true, value_parser = encoder)]
    encoder: Option<Sensor>,
    /// Give up if the pendulum is not still within so many seconds
    #[arg(long, value_name = "S", value_parser = patience, allow_negative_numbers = true, default_value = "120")]
    wait: f64,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host calibrate --port /dev/ttyACM0                      the zero: let it hang still
  host calibrate --port /dev/ttyACM0 --angles 45,90,-45   zero, gain and linearity
  host calibrate --port sim --angles 85.94,-68.75,45.84
  host calibrate --port sim:encoder --encoder 4096        an encoder of 1024 lines
  host calibrate --recording swing.csv --rig rig.toml     the gain, from a wide swing

Nothing is pressed: each angle is taken as soon as the pendulum has been still there for a second.
Readings that are no line through the angles are refused, and a gain that the data sheet does not
allow is saved with a doubt. Recordings made before keep the angles of their old calibration.";

/// An angle that tells something about the gain.
fn angle(text: &str) -> Result<f64, String> {
    match super::values::finite(text.trim())? {
        value if (5.0..180.0).contains(&value.abs()) => Ok(value),
        _ => Err("expected degrees from hanging, between 5 and 180 either way".to_owned()),
    }
}

/// An encoder that a board can count.
fn encoder(text: &str) -> Result<Sensor, String> {
    let counts = text.trim().parse().map_err(|_| "expected a whole number of counts a turn".to_owned())?;
    let sensor = Sensor::from(Encoder::new(counts));
    if sensor.is_valid() { Ok(sensor) } else { Err(sensor.expected().to_owned()) }
}

#[derive(Serialize)]
struct Calibrated {
    port: Option<String>,
    #[serde(serialize_with = "output::lossy")]
    file: PathBuf,
    #[serde(serialize_with = "sensor::as_json")]
    before: Sensor,
    #[serde(serialize_with = "sensor::as_json")]
    after: Sensor,
    known: Vec<Known>,
    line: Option<Line>,
    /// Relative standard deviation of a gain from swings.
    gain_std: Option<f64>,
    /// The largest distance from the line, percent of the travel.
    nonlinearity_percent: Option<f64>,
    /// What speaks against it.
    doubts: Vec<String>,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let path = rig::chosen_path(options.rig.as_deref()).unwrap_or_else(|| USUAL_NAME.into());
    // Before the rig gets anything that no file tells of.
    output::check(&[&path], &options.recording.iter().map(PathBuf::as_path).collect::<Vec<_>>(), true)?;
    let mut session = options.port.as_deref().map(port::connect).transpose()?;
    let mut file = model(&path, session.as_mut())?;
    let mut done = match &mut session {
        Some(session) => at_rig(options, session)?,
        None => untouched(&file)?,
    };
    if !options.recording.is_empty() {
        by_swings(options, &file, &mut done)?;
    }
    if let Some(session) = &mut session {
        session.calibrate(&done.after)?;
    }
    file.set_sensor(done.after);
    file.save(&path)?;
    done.file = path;
    done.doubts.iter().for_each(|doubt| output::warn(&format!("doubtful: {doubt}")));
    if options.json {
        output::json("calibrate", &done)
    } else {
        output::result(&in_words(&done))
    }
    Ok(())
}

/// The file, or what the rig reports if there is none yet.
fn model(path: &Path, session: Option<&mut Session>) -> Result<RigFile, Failure> {
    match session {
        Some(session) if !path.exists() => session.model_file(),
        _ => Ok(RigFile::load(path)?),
    }
}

fn untouched(file: &RigFile) -> Result<Calibrated, Failure> {
    let Some(before) = file.sensor() else {
        return Err(Failure::wrong_use("the model file has no [sensor] table, so there is no gain to correct")
            .next("add --port, so that the rig's calibration is used"));
    };
    Ok(nothing_done(*before))
}

fn nothing_done(before: Sensor) -> Calibrated {
    Calibrated {
        port: None,
        file: PathBuf::new(),
        before,
        after: before,
        known: Vec::new(),
        line: None,
        gain_std: None,
        nonlinearity_percent: None,
        doubts: Vec::new(),
    }
}

/// Zero, and the gain if there are angles; without them the rig reads the sensor that it read before.
fn at_rig(options: &Options, session: &mut Session) -> Result<Calibrated, Failure> {
    let before = session.settings()?;
    if !options.angles.is_empty() {
        check_gain(&before.sensor)?;
    }
    if let Some(encoder) = &options.encoder {
        session.use_sensor(encoder)?;
    }
    let measured = measure(options, session, before.sensor);
    if measured.is_err() && options.encoder.is_some() {
        // The link may be what broke.
        let _ = session.stop();
        let _ = session.tell(&Command::SetSettings(before));
    }
    measured
}

fn measure(options: &Options, session: &mut Session, before: Sensor) -> Result<Calibrated, Failure> {
    let settings = session.settings()?;
    let mut done = Calibrated { port: options.port.clone(), after: settings.sensor, ..nothing_done(before) };
    let stream = Stream { raw: true, live_every: 0 };
    output::say("let the pendulum hang still …");
    session.start(stream)?;
    let zero = hold(session, &settings, &[], options.wait)?.code;
    done.after = done.after.with_zero(zero as f32);
    let mut codes = vec![zero];
    for (idx, degrees) in options.angles.iter().enumerate() {
        output::say(&format!("hold it still at {degrees}° …"));
        if idx > 0 {
            session.start(stream)?;
        }
        let code = hold(session, &settings, &codes, options.wait)?.code;
        codes.push(code);
        done.known.push(Known { angle_rad: degrees.to_radians(), code });
    }
    session.stop()?;
    if !done.known.is_empty() {
        let found = line(zero, &done.known, f64::from(settings.sensor.nominal_step_rad()))?;
        done.after = with_gain(done.after, found.radian_per_code)?;
        let worst_rad = found.off_rad.iter().fold(0.0, |worst: f64, off| worst.max(off.abs()));
        let share = worst_rad / f64::from(ELECTRICAL_TRAVEL_RAD);
        done.nonlinearity_percent = (done.known.len() > 1).then_some(100.0 * share);
        done.line = Some(found);
        done.doubts =
            calibrate::doubts(&before, &done.after, calibrate::From::Angles { rms_rad: rms_rad(&done.known) });
    }
    Ok(done)
}

fn rms_rad(known: &[Known]) -> f64 {
    let square: f64 = known.iter().map(|point| point.angle_rad.powi(2)).sum();
    (square / known.len().max(1) as f64).sqrt()
}

/// All recordings of these files, by their names.
fn recordings(paths: &[PathBuf]) -> Result<Vec<(String, Recording)>, Failure> {
    let mut all = Vec::new();
    for path in paths {
        let runs = recording::read_runs(path, &ReadOptions::default()).map_err(Failure::failed)?;
        all.extend(runs.into_iter().map(|run| (run.name_in(&path.display().to_string()), run.recording)));
    }
    Ok(all)
}

/// The gain from swings, all measured with the one that their files name, or else with the one in use.
fn by_swings(options: &Options, file: &RigFile, done: &mut Calibrated) -> Result<(), Failure> {
    check_gain(&done.before)?;
    let mut swings = Vec::new();
    let in_use = f64::from(done.before.line().radian_per_code);
    let mut gains = Vec::new();
    for (name, recording) in recordings(&options.recording)? {
        let of_another =
            recording.header().sensor.clone().filter(|_| recording.header().sensor != sensor_name(&done.before));
        if let Some(sensor) = of_another {
            let what = format!("{name} was recorded from a sensor of kind {sensor}, the model file means another");
            return Err(Failure::wrong_use(what).next("use recordings of the sensor to be calibrated"));
        }
        gains.push(recording.header().calibration.map_or(in_use, |calibration| calibration.radians_per_code));
        let (swing, _) = Swing::from_recording(&name, &recording, &SegmentOptions::default())
            .map_err(|error| Failure::failed(format!("{name}: {error}")))?;
        swings.push(swing);
    }
    let gain = one_gain(&gains)?;
    output::say("fitting the swings with the gain among the unknowns …");
    let (factor, std) = gain_of_swings(&swings, file.parameters())?;
    done.after = with_gain(done.after, gain / factor)?;
    done.gain_std = Some(std);
    done.doubts = calibrate::doubts(&done.before, &done.after, calibrate::From::Swings);
    Ok(())
}

/// One factor corrects one gain.
fn one_gain(gains: &[f64]) -> Result<f64, Failure> {
    let gain = gains.first().copied().unwrap_or_default();
    match gains.iter().find(|other| (*other / gain - 1.0).abs() > SAME_GAIN) {
        None => Ok(gain),
        Some(other) => {
            let what = format!("the recordings were taken with different gains: {gain} and {other} radians_per_code");
            Err(Failure::wrong_use(what).next("use those of one calibration only"))
        }
    }
}

/// The same sensor with a gain that was measured.
fn with_gain(sensor: Sensor, radian_per_code: f64) -> Result<Sensor, CalibrationError> {
    check_gain(&sensor)?;
    Ok(sensor.with_step(radian_per_code as f32).unwrap_or(sensor))
}

fn in_words(done: &Calibrated) -> String {
    if done.after.gain_is_known() {
        return known_in_words(done);
    }
    let mut text = Vec::new();
    let (before, after) = (&done.before.line(), &done.after.line());
    if done.port.is_some() {
        text.push(format!("zero       code {:.2} (was {:.2})", after.zero_code, before.zero_code));
    }
    let relative = done.line.as_ref().and_then(|line| line.std.map(|std| std / line.radian_per_code.abs()));
    let spread =
        done.gain_std.or(relative).map_or(String::new(), |std| format!(" ± {} %", significant(100.0 * std, 2)));
    let mrad = |line: &shared::sensor::Line| 1e3 * line.radian_per_code;
    text.push(match after.radian_per_code == before.radian_per_code {
        true => format!("gain       {:.5} mrad a code, as before", mrad(after)),
        false => format!("gain       {:.5} mrad a code{spread} (was {:.5})", mrad(after), mrad(before)),
    });
    text.push(linearity(done));
    if let Some(line) = done.line.as_ref().filter(|line| line.off_rad.len() > 1) {
        let row = |(point, off): (&Known, &f64)| {
            let (angle, off) = (point.angle_rad.to_degrees(), off.to_degrees());
            vec![format!("{angle:.2}"), format!("{:.2}", point.code), format!("{off:+.2}")]
        };
        let rows = done.known.iter().zip(&line.off_rad).map(row).collect();
        text.push(format!("\n{}\n", table(["angle (°)", "code", "off the line (°)"], rows, 0)));
    }
    let saved = if done.port.is_some() { "saved in the rig and read back the same; wrote" } else { "wrote" };
    text.push(format!("{saved} {}", done.file.display()));
    text.join("\n")
}

fn known_in_words(done: &Calibrated) -> String {
    let was = if done.before.is_like(&done.after) { String::new() } else { format!(" (was a {})", done.before.name()) };
    format!(
        "sensor     {}{was}\n\
         zero       count {:.2}, until the power goes; then it is where the pendulum hangs when power comes on\n\
         gain       {}\nsaved in the rig and read back the same; wrote {}",
        done.after.name(),
        done.after.line().zero_code,
        done.after,
        done.file.display()
    )
}

fn linearity(done: &Calibrated) -> String {
    match done.nonlinearity_percent {
        None => "linearity  not looked at: that takes two angles or more besides hanging".to_owned(),
        Some(percent) if percent <= f64::from(LINEARITY_PERCENT) => {
            format!(
                "linearity  {percent:.2} % of the travel off a line at most; the data sheet allows {LINEARITY_PERCENT} %"
            )
        }
        Some(percent) => format!(
            "linearity  look here: {percent:.2} % of the travel off a line, the data sheet allows {LINEARITY_PERCENT} %; \
             check the angles, then the potentiometer"
        ),
    }
}

impl From<HoldError> for Failure {
    fn from(error: HoldError) -> Self {
        Self::failed(&error).next(error.next_step())
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        Self::failed(&error).next(error.next_step())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::connect;

    #[test]
    fn a_hold_that_fails_leaves_the_sensor_that_was_read_before() {
        let options = Options {
            port: Some("sim:encoder".to_owned()),
            rig: None,
            angles: Vec::new(),
            recording: Vec::new(),
            encoder: Some(Encoder::new(2000).into()),
            wait: 0.1,
            json: false,
        };
        let mut session = connect("sim:encoder").unwrap();
        let before = session.settings().unwrap();
        let failure = at_rig(&options, &mut session).map(|done| done.after).unwrap_err();
        assert!(failure.what().contains("not still"), "{failure}");
        assert_eq!(session.settings().unwrap(), before);
    }

    #[test]
    fn gains_that_differ_are_none_in_any_order() {
        assert_eq!(one_gain(&[1.5e-3, 1.5e-3 * (1.0 + 1e-8)]).unwrap(), 1.5e-3);
        for gains in [[1.5e-3, 1.4e-3], [1.4e-3, 1.5e-3], [1.5e-3, -1.5e-3]] {
            assert!(one_gain(&gains).unwrap_err().what().contains("different gains"), "{gains:?}");
        }
    }
}
