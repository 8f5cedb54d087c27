//! The header lines of our own recording format.
//!
//! `# key: value`, one fact a line, before the column names:
//! ```text
//! # format: pendulum-recording 1
//! # rate_hz: 1000
//! # firmware: 0.1.0
//! # zero_code: 2048
//! # radians_per_code: 0.00144874
//! # sensor: encoder
//! # cutoff_hz: 10
//! # started: 2025-03-01T12:00:00Z
//! # measured: angle
//! # comment: brass bush, 0.5 rad
//! t,theta,code
//! ```
//! Unknown keys are left alone, so that later versions may add some. `key=value` is read too. Files of others say in words
//! how many samples a second there are, or how far apart they lie.

use std::fmt;

use super::cell::number_and_unit;
use super::error::Fault;
use super::limits::{FORMAT_NAME, FORMAT_VERSION, LONGEST_STEP_S};
use super::units::time_unit;
use shared::measured::Measured;
use shared::sensor::Sensor;
use shared::wire::Clock;

/// Facts about how a recording was taken; what is not known is `None`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Header {
    /// Version of our format; `None` for files of others.
    pub version: Option<u32>,
    /// Sampling rate, Hz: nominal, or as measured by the board.
    pub rate_hz: Option<f64>,
    /// Version of the firmware that took it.
    pub firmware: Option<String>,
    /// What the board ran on if it was no crystal.
    pub clock: Option<String>,
    /// The sensor's name if it is no potentiometer.
    pub sensor: Option<String>,
    /// From code to angle.
    pub calibration: Option<Calibration>,
    /// Cut-off of the filter that runs on the board, Hz. The recorded angles are not filtered.
    pub cutoff_hz: Option<f64>,
    /// Start, date and time as text (ISO 8601).
    pub started: Option<String>,
    /// What the readings are; `None` = angles, or what the column names say.
    pub measured: Option<Measured>,
    /// Anything a person wrote; may have several lines.
    pub comment: Option<String>,
}

/// The straight line from code to angle: `angle = (code − zero_code) · radians_per_code`, for a sensor that turns for
/// ever with as many wraps as there were.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// Code at which the pendulum hangs; need not be whole.
    pub zero_code: f64,
    /// Angle of one code step, rad; negative when the potentiometer turns the other way.
    pub radians_per_code: f64,
}

impl Calibration {
    /// A sensor's.
    pub fn of(sensor: &Sensor) -> Self {
        let line = sensor.line();
        Self { zero_code: f64::from(line.zero_code), radians_per_code: f64::from(line.radian_per_code) }
    }

    /// Angle of a code, rad.
    pub fn angle_rad(&self, code: u16) -> f64 {
        (f64::from(code) - self.zero_code) * self.radians_per_code
    }
}

/// What [`Header::clock`] says of a board without its crystal.
const OWN_OSCILLATOR: &str = "internal";

/// What it says of a clock.
pub fn clock_name(clock: Clock) -> Option<String> {
    (clock == Clock::Internal).then(|| OWN_OSCILLATOR.to_owned())
}

impl Header {
    /// What speaks against the times, if anything does. Source: data sheets of STM32F405 and F446, internal oscillator.
    pub(super) fn doubt(&self) -> Option<&'static str> {
        (self.clock.as_deref() == Some(OWN_OSCILLATOR)).then_some(
            "doubtful: recorded by a board that ran on its own oscillator, because no clock came from outside: every time is \
             off by up to 1 % at 25 °C, 4 % from -10 to 85 °C, and inertia by twice that; host doctor says what to check",
        )
    }
}

/// What [`Header::sensor`] says of a sensor.
pub fn sensor_name(sensor: &Sensor) -> Option<String> {
    (!matches!(sensor, Sensor::Potentiometer(_))).then(|| sensor.name().to_owned())
}

impl fmt::Display for Header {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "# format: {FORMAT_NAME} {FORMAT_VERSION}")?;
        write_number(out, "rate_hz", self.rate_hz)?;
        write_text(out, "firmware", self.firmware.as_deref())?;
        write_text(out, "clock", self.clock.as_deref())?;
        write_text(out, "sensor", self.sensor.as_deref())?;
        write_number(out, "zero_code", self.calibration.map(|calibration| calibration.zero_code))?;
        write_number(out, "radians_per_code", self.calibration.map(|calibration| calibration.radians_per_code))?;
        write_number(out, "cutoff_hz", self.cutoff_hz)?;
        write_text(out, "started", self.started.as_deref())?;
        write_text(out, "measured", self.measured.map(Measured::name))?;
        write_text(out, "comment", self.comment.as_deref())
    }
}

fn write_number(out: &mut fmt::Formatter<'_>, key: &str, value: Option<f64>) -> fmt::Result {
    value.map_or(Ok(()), |value| writeln!(out, "# {key}: {value}"))
}

fn write_text(out: &mut fmt::Formatter<'_>, key: &str, value: Option<&str>) -> fmt::Result {
    value.unwrap_or_default().lines().try_for_each(|line| writeln!(out, "# {key}: {}", line.trim()))
}

/// Collects header lines while a file is read.
#[derive(Debug, Default)]
pub(super) struct HeaderReader {
    header: Header,
    zero_code: Option<f64>,
    radians_per_code: Option<f64>,
    /// What files of others say of it in words.
    said_rate_hz: Option<f64>,
}

impl HeaderReader {
    /// Takes one comment line, with its number from 1. Lines that say nothing we know are passed over.
    pub(super) fn take(&mut self, line: usize, text: &str) -> Result<(), Fault> {
        let Some((key, value)) = split_line(text) else { return Ok(()) };
        match key.as_str() {
            "format" => self.take_format(line, value),
            "rate_hz" => self.number(line, &key, value).map(|n| self.header.rate_hz = n.or(self.header.rate_hz)),
            "cutoff_hz" => self.number(line, &key, value).map(|n| self.header.cutoff_hz = n),
            "zero_code" => self.number(line, &key, value).map(|n| self.zero_code = n),
            "radians_per_code" => self.number(line, &key, value).map(|n| self.radians_per_code = n),
            // In files of others it may be any sensor's name, with steps that nobody knows.
            "sensor" if self.header.version.is_some() => set_text(&mut self.header.sensor, value),
            "clock" if self.header.version.is_some() => set_text(&mut self.header.clock, value),
            "firmware" => set_text(&mut self.header.firmware, value),
            "started" => set_text(&mut self.header.started, value),
            "measured" => self.measured(line, value),
            "comment" => set_text(&mut self.header.comment, value),
            key if self.header.version.is_none() => {
                self.said_rate_hz = said_rate_hz(key, value).or(self.said_rate_hz);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Samples a second, where a comment says so in words: `# Sampling frequency: 100 Hz`.
    pub(super) fn said_rate_hz(&self) -> Option<f64> {
        self.said_rate_hz
    }

    /// What was found.
    pub(super) fn finish(self) -> Header {
        let calibration = self
            .zero_code
            .zip(self.radians_per_code)
            .map(|(zero_code, radians_per_code)| Calibration { zero_code, radians_per_code });
        Header { calibration, ..self.header }
    }

    fn take_format(&mut self, line: usize, value: &str) -> Result<(), Fault> {
        let Some(number) = value.strip_prefix(FORMAT_NAME) else { return Ok(()) };
        let Ok(version) = number.trim().parse() else {
            return Err(bad_value(line, "format", value, "pendulum-recording and a version number"));
        };
        if version > FORMAT_VERSION {
            return Err(Fault::NewerFormat { line, version });
        }
        self.header.version = Some(version);
        Ok(())
    }

    fn measured(&mut self, line: usize, value: &str) -> Result<(), Fault> {
        match value.parse() {
            Err(()) if self.header.version.is_some() => Err(bad_value(line, "measured", value, "angle or rate")),
            found => {
                self.header.measured = found.ok();
                Ok(())
            }
        }
    }

    /// In our own files a number that does not parse is an error; in files of others the line meant something else.
    fn number(&self, line: usize, key: &str, value: &str) -> Result<Option<f64>, Fault> {
        let number = value.parse::<f64>().ok().filter(|number| is_possible(key, *number));
        match number {
            None if self.header.version.is_some() => Err(bad_value(line, key, value, expected(key))),
            number => Ok(number),
        }
    }
}

fn is_possible(key: &str, number: f64) -> bool {
    match key {
        "rate_hz" | "cutoff_hz" => number.is_finite() && number > 0.0,
        "radians_per_code" => number.is_finite() && number != 0.0,
        _ => number.is_finite(),
    }
}

fn expected(key: &str) -> &'static str {
    match key {
        "rate_hz" | "cutoff_hz" => "a positive number of Hz",
        "radians_per_code" => "a number of radians that is not 0",
        _ => "a number",
    }
}

fn bad_value(line: usize, key: &str, value: &str, expected: &'static str) -> Fault {
    Fault::HeaderValue { line, key: key.to_owned(), value: value.to_owned(), expected }
}

/// Several lines of the same key make one text of several lines.
fn set_text(text: &mut Option<String>, value: &str) -> Result<(), Fault> {
    match text {
        Some(text) => *text = format!("{text}\n{value}"),
        None => *text = Some(value.to_owned()),
    }
    Ok(())
}

/// `# key: value` or `# key=value`, whichever sign comes first.
/// Does a line say nothing but how many samples a second there are? `Sample rate: 100 Hz`, `fs=100`, `dt = 10 ms`.
pub(super) fn says_rate(line: &str) -> bool {
    split_line(line).is_some_and(|(key, value)| said_rate_hz(&key, value).is_some())
}

/// Samples a second as a key and its value say them, or the time between two; MATLAB's data acquisition says `ActualRate`.
pub(super) fn said_rate_hz(key: &str, value: &str) -> Option<f64> {
    match key {
        "fs" | "f_s" | "actualrate" => number_of_hertz(value),
        key if says_sampling_rate(key) => number_of_hertz(value),
        key if says_sampling_interval(key) => seconds_of_interval(value).map(f64::recip),
        _ => None,
    }
}

fn says_sampling_interval(key: &str) -> bool {
    let is_of_samples = ["sampl", "abtast", "échantillon", "muestreo", "campionamento"];
    let is_interval = ["interval", "intervall", "period", "time", "zeit", "période", "tiempo", "tempo"];
    let has = |words: &[&str]| words.iter().any(|word| key.contains(word));
    matches!(key, "dt" | "δt" | "ts" | "time step" | "timestep") || has(&is_of_samples) && has(&is_interval)
}

/// `0.01`, `10 ms`: seconds unless it says otherwise. What is longer is how long somebody measured.
fn seconds_of_interval(value: &str) -> Option<f64> {
    let value = value.replace(',', ".");
    let number = match number_and_unit(&value) {
        Some((number, unit)) => number.parse::<f64>().ok()? * time_unit(&unit.to_lowercase())?.seconds(),
        None => value.trim().parse::<f64>().ok()?,
    };
    (number > 0.0 && number < LONGEST_STEP_S).then_some(number)
}

fn says_sampling_rate(key: &str) -> bool {
    let is_of_samples = ["sampl", "frame", "fps", "abtast", "échantillon", "muestreo", "campionamento"];
    let is_rate = ["rate", "freq", "fréq", "frec", "hz", "fps"];
    let has = |words: &[&str]| words.iter().any(|word| key.contains(word));
    has(&is_of_samples) && has(&is_rate)
}

/// `100`, `100 Hz`, `100,0 Hz`; kilohertz and intervals are left alone.
fn number_of_hertz(value: &str) -> Option<f64> {
    let end = value.find(|letter: char| !matches!(letter, '0'..='9' | '.' | ',')).unwrap_or(value.len());
    let (number, unit) = value.split_at(end);
    let is_hertz = matches!(unit.trim().to_lowercase().as_str(), "" | "hz" | "fps" | "sps" | "1/s");
    number.replace(',', ".").parse().ok().filter(|rate: &f64| is_hertz && *rate > 0.0)
}

fn split_line(text: &str) -> Option<(String, &str)> {
    let text = text.trim_start_matches(['#', '%', '/', ' ', '\t']);
    let (key, value) = text.split_once([':', '='])?;
    Some((key.trim().to_lowercase(), value.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Header, Fault> {
        let mut reader = HeaderReader::default();
        text.lines().enumerate().try_for_each(|(idx, line)| reader.take(idx + 1, line))?;
        Ok(reader.finish())
    }

    fn full() -> Header {
        Header {
            version: Some(FORMAT_VERSION),
            rate_hz: Some(1000.0),
            clock: clock_name(Clock::Internal),
            firmware: Some("0.1.0".to_owned()),
            sensor: Some("encoder".to_owned()),
            calibration: Some(Calibration { zero_code: 2047.5, radians_per_code: 340f64.to_radians() / 4096.0 }),
            cutoff_hz: Some(10.0),
            started: Some("2025-03-01T12:00:00Z".to_owned()),
            measured: Some(Measured::Rate),
            comment: Some("brass bush\nsecond line".to_owned()),
        }
    }

    #[test]
    fn what_is_written_is_read_back() {
        assert_eq!(parse(&full().to_string()).unwrap(), full());
    }

    #[test]
    fn an_equals_sign_is_read_too() {
        assert_eq!(parse("# rate_hz=200").unwrap().rate_hz, Some(200.0));
    }

    #[test]
    fn a_newer_format_asks_for_an_update() {
        let fault = parse("# format: pendulum-recording 9").unwrap_err();
        assert!(fault.to_string().contains("update the program"), "{fault}");
    }

    #[test]
    fn a_bad_rate_in_our_own_file_names_line_and_value() {
        let fault = parse("# format: pendulum-recording 1\n# rate_hz: fast").unwrap_err().to_string();
        assert!(fault.contains("line 2") && fault.contains("fast"), "{fault}");
    }

    #[test]
    fn numbers_that_cannot_be_are_refused_in_our_own_file() {
        for line in ["rate_hz: 0", "rate_hz: inf", "cutoff_hz: -1", "radians_per_code: 0", "radians_per_code: nan"] {
            let fault = parse(&format!("# format: pendulum-recording 1\n# {line}"));
            assert!(matches!(fault, Err(Fault::HeaderValue { line: 2, .. })), "{line}: {fault:?}");
        }
        let turned = parse("# format: pendulum-recording 1\n# zero_code: 0\n# radians_per_code: -0.002").unwrap();
        assert_eq!(turned.calibration, Some(Calibration { zero_code: 0.0, radians_per_code: -0.002 }));
    }

    #[test]
    fn samples_a_second_are_said_in_many_ways() {
        let said = |line: &str| {
            let mut reader = HeaderReader::default();
            reader.take(1, line).unwrap();
            reader.said_rate_hz()
        };
        for line in
            ["# fs=100", "fs = 100 Hz", "# Sample rate: 100 Hz", "dt: 10 ms", "# Ts = 0,01", "Abtastzeit: 0.01 s"]
        {
            assert!(said(line).is_some_and(|rate_hz| (rate_hz - 100.0).abs() < 1e-9), "{line}");
            assert!(says_rate(line), "{line}");
        }
        for line in [
            "Sampling time: 20 s",
            "# fs=fast",
            "dt = 0",
            "fs=100 kHz",
            "# time: 12",
            "t,theta",
            "theta: 3",
            "rate: 100",
            "date: 2026",
        ] {
            assert!(said(line).is_none() && !says_rate(line), "{line}");
        }
    }

    #[test]
    fn a_strange_line_in_a_foreign_file_is_passed_over() {
        assert_eq!(parse("# rate_hz: as fast as possible\n# Origin: lab 3").unwrap(), Header::default());
    }
}
