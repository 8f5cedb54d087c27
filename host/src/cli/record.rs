//! `host record`: a swing from the rig into a file.

use super::values::patience;
use super::{interrupt, output, port};
use crate::error::Failure;
use crate::link::Session;
use crate::now;
use crate::operations::record::{Recorded, at_rate};
use crate::record::{Limits, Live, Plan, RecordError, Stage, Taken, Watch, in_words, record, usable};
use crate::recording::Existing;
use clap::Args;
use shared::rig::{HIGHEST_RATE_HZ, LOWEST_RATE_HZ};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The live line is written this often.
const LIVE_EVERY: Duration = Duration::from_millis(100);

/// Record a swing from the rig: from the still pendulum until it rests again.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// The recording to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// Sample at this rate, 50 to 10000 Hz, or the nearest that the rig can make; afterwards as before
    #[arg(long, value_name = "HZ", value_parser = rate, allow_negative_numbers = true)]
    rate: Option<f32>,
    #[command(flatten)]
    patience: Patience,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// When to give up.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct Patience {
    /// Give up if the pendulum was not let go within so many seconds
    #[arg(long, value_name = "S", value_parser = patience, allow_negative_numbers = true, default_value_t = Limits::USUAL.wait_s)]
    pub(super) wait: f64,
    /// End the recording so many seconds after the release
    #[arg(long, value_name = "S", value_parser = patience, allow_negative_numbers = true, default_value_t = Limits::USUAL.limit_s)]
    pub(super) limit: f64,
}

const EXAMPLE: &str = "\
Example:
  host record --port /dev/ttyACM0 -o swing.csv
  host record --port sim -o swing.csv
  host record --port 326A36603830 --rate 200 -o slow.csv     the rig with this serial number

Ctrl-C ends a recording early and keeps it. The file holds raw, unfiltered angles and converter
codes.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut session = port::connect(&options.port)?;
    let (taken, rate_hz) = at_rate(&mut session, options.rate, &output::say, |session| {
        take(session, &options.output, Existing::forced(options.force), &options.patience)
    })?;
    if options.json {
        output::json("record", &Recorded::new(&taken, rate_hz))
    } else {
        output::result(&in_words(&taken))
    }
    Ok(())
}

/// 50 … 10 000 Hz.
fn rate(text: &str) -> Result<f32, String> {
    let range = LOWEST_RATE_HZ..=HIGHEST_RATE_HZ;
    let within = text.parse().ok().filter(|rate_hz| range.contains(rate_hz));
    within.ok_or_else(|| format!("expected {} to {} samples a second", range.start(), range.end()))
}

/// Records one swing; anything but a usable one is a failure, told together with what was kept.
pub(super) fn take(
    session: &mut Session,
    path: &Path,
    existing: Existing,
    patience: &Patience,
) -> Result<Taken, Failure> {
    only_usable(attempt(session, path, existing, patience)?)
}

/// The same, whatever came of it.
pub(super) fn attempt(
    session: &mut Session,
    path: &Path,
    existing: Existing,
    patience: &Patience,
) -> Result<Taken, RecordError> {
    let started = Some(now::iso());
    let plan = Plan { path, existing, wait_s: patience.wait, limit_s: patience.limit, started, live_every: 0 };
    let mut screen = Screen::new();
    let taken = interrupt::orderly(|stop| record(session, &plan, &mut screen, stop));
    screen.clear();
    taken
}

/// Says what is worth a warning.
pub(super) fn only_usable(taken: Taken) -> Result<Taken, Failure> {
    if let Some(note) = usable(&taken)? {
        output::warn(&note);
    }
    Ok(taken)
}

/// What the person at the rig sees.
struct Screen {
    is_terminal: bool,
    shown: Option<Instant>,
}

impl Screen {
    fn new() -> Self {
        Self { is_terminal: output::is_watched(), shown: None }
    }

    /// Takes the live line away.
    fn clear(&mut self) {
        if self.shown.take().is_some() {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}

impl Watch for Screen {
    fn stage(&mut self, stage: Stage) {
        self.clear();
        match stage {
            Stage::Settling => output::say("waiting until the pendulum is still …"),
            Stage::Waiting => output::say("still: lift it, hold it, and let it go"),
            Stage::Swinging => output::say("released: recording until it rests (Ctrl-C ends earlier)"),
            Stage::AtRest => {}
        }
    }

    fn live(&mut self, live: &Live) {
        let due = self.shown.is_none_or(|shown| shown.elapsed() >= LIVE_EVERY);
        if !self.is_terminal || !due {
            return;
        }
        self.shown = Some(Instant::now());
        let (angle, amplitude) = (live.angle_rad.to_degrees(), live.amplitude_rad.to_degrees());
        let _ = write!(
            std::io::stderr(),
            "\r\x1b[Kangle {angle:+7.1}°  amplitude {amplitude:6.1}°  elapsed {:6.1} s  frames lost {}",
            live.elapsed_s,
            live.frames_lost
        );
    }
}
