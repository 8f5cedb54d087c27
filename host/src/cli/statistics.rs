//! `host statistics`: the rig's counters since its last reset.

use super::{output, port};
use crate::error::Failure;
use clap::Args;
use serde::Serialize;
use shared::wire::{Chip, Clock, Cycles, ResetCause, Statistics, StoreState};

/// Show the rig's counters since its last reset: samples, losses, health.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host statistics --port /dev/ttyACM0";

#[derive(Serialize)]
struct Shown {
    port: String,
    firmware: String,
    #[serde(flatten)]
    statistics: Statistics,
    /// Absent from firmware that does not tell.
    chip: Option<Chip>,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut session = port::connect(&options.port)?;
    let statistics = session.statistics()?;
    let chip = session.chip()?;
    let shown = Shown { port: options.port.clone(), firmware: session.firmware(), statistics, chip };
    if options.json {
        output::json("statistics", &shown)
    } else {
        output::result(&in_words(&shown))
    }
    Ok(())
}

fn in_words(shown: &Shown) -> String {
    let Shown { statistics, .. } = shown;
    let health = &statistics.health;
    let measured = |value: bool, text: String| if value { text } else { "not measured".to_owned() };
    let cpu = measured(health.cpu_permille > 0, format!("{:.1} %", f64::from(health.cpu_permille) / 10.0));
    let stack = measured(health.stack_size > 0, format!("{} of {} bytes", health.stack_used, health.stack_size));
    // Without a sample nothing was predicted.
    let innovation = match statistics.samples {
        0 => "–".to_owned(),
        _ => format!("{:.2} mrad", 1e3 * statistics.innovation_rms_rad),
    };
    let fault = if health.last_fault.is_empty() { "none" } else { health.last_fault.as_str() };
    let rows = [
        ("rig", shown.firmware.clone()),
        ("samples", statistics.samples.to_string()),
        ("lost to overruns", statistics.overruns.to_string()),
        ("not taken while saving", statistics.paused.to_string()),
        ("frames dropped", statistics.dropped_frames.to_string()),
        ("bad frames received", statistics.bad_frames.to_string()),
        ("samples disconnected", statistics.disconnected.to_string()),
        ("innovation, rms", innovation),
        ("processor in use", cpu),
        ("stack used at most", stack),
        ("restarts", format!("{}, the last {}", health.resets, cause(health.cause))),
        ("flash at start", store(health.store).to_owned()),
        ("last fault", fault.to_owned()),
    ];
    let of_chip = shown.chip.iter().flat_map(chip_rows);
    let lines: Vec<String> =
        rows.into_iter().chain(of_chip).map(|(what, value)| format!("{what:<24}{value}")).collect();
    lines.join("\n")
}

/// What the chip tells of itself, as far as it does.
fn chip_rows(chip: &Chip) -> Vec<(&'static str, String)> {
    let serial = (!chip.serial.is_empty()).then(|| ("serial number", chip.serial.to_string()));
    let clock = match chip.clock {
        Clock::Unknown => None,
        Clock::Crystal => Some("crystal"),
        Clock::Internal => {
            Some("the chip's own, 1 % off at 25 °C and up to 4 % from -10 to 85 °C: the crystal does not run")
        }
    };
    let stages = [
        ("cycles a sample", chip.sample),
        ("cycles the observer", chip.observer),
        ("cycles a frame", chip.frame),
        ("cycles a save", chip.save),
    ];
    let took = |cycles: Cycles| {
        let us = |cycles: f64| 1e6 * cycles / f64::from(chip.clock_hz);
        let (mean, worst) = (f64::from(cycles.mean), f64::from(cycles.worst));
        format!("{mean:.0} ({:.1} µs), at most {worst:.0} ({:.1} µs)", us(mean), us(worst))
    };
    let measured = stages.into_iter().filter(|(_, cycles)| cycles.count > 0 && chip.clock_hz > 0);
    serial
        .into_iter()
        .chain(clock.map(|clock| ("clock", clock.to_owned())))
        .chain(measured.map(|(what, cycles)| (what, took(cycles))))
        .collect()
}

fn cause(cause: ResetCause) -> &'static str {
    match cause {
        ResetCause::Power => "at power-on",
        ResetCause::Asked => "on request: by command, reset button or debug probe",
        ResetCause::Watchdog => "by the watchdog",
        ResetCause::Panic => "after a panic",
        ResetCause::HardFault => "after a hard fault",
    }
}

fn store(state: StoreState) -> &'static str {
    match state {
        StoreState::Empty => "no model: defaults in use",
        StoreState::Loaded => "valid, in use",
        StoreState::OtherVersion => "of another version: defaults in use",
        StoreState::Damaged => "damaged: defaults in use",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::wire::Health;

    fn said(statistics: Statistics, chip: Option<Chip>) -> Vec<String> {
        let shown = Shown { port: "sim".to_owned(), firmware: "rig 1.2.3".to_owned(), statistics, chip };
        in_words(&shown).lines().map(str::to_owned).collect()
    }

    #[test]
    fn each_counter_stands_behind_its_name_in_its_unit() {
        let health = Health { cpu_permille: 123, ..Health::default() };
        let (samples, overruns, paused, dropped_frames, bad_frames, disconnected) = (1000, 1, 2, 3, 4, 5);
        let innovation_rms_rad = 1.5e-3;
        let told = said(
            Statistics {
                samples,
                overruns,
                paused,
                dropped_frames,
                bad_frames,
                disconnected,
                innovation_rms_rad,
                health,
            },
            None,
        );
        for (what, value) in [
            ("samples", "1000"),
            ("lost to overruns", "1"),
            ("not taken while saving", "2"),
            ("frames dropped", "3"),
            ("bad frames received", "4"),
            ("samples disconnected", "5"),
            ("innovation, rms", "1.50 mrad"),
            ("processor in use", "12.3 %"),
            ("stack used at most", "not measured"),
        ] {
            assert!(told.contains(&format!("{what:<24}{value}")), "{what}: {told:?}");
        }
    }

    #[test]
    fn without_a_sample_there_is_no_innovation() {
        let told = said(Statistics::default(), None);
        assert!(told.contains(&format!("{:<24}–", "innovation, rms")), "{told:?}");
    }

    #[test]
    fn cycles_are_told_in_microseconds_too() {
        let sample = Cycles { count: 9, mean: 1680.0, worst: 3360 };
        let chip = Chip { clock_hz: 168_000_000, sample, ..Chip::default() };
        let told = said(Statistics::default(), Some(chip));
        assert!(told.contains(&format!("{:<24}1680 (10.0 µs), at most 3360 (20.0 µs)", "cycles a sample")), "{told:?}");
    }
}
