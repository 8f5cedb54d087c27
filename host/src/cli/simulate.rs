//! `host simulate`: a swing of the model, written as a recording.

use super::values::{custom_effect, finite, not_negative, positive};
use super::{output, rig};
use crate::error::Failure;
use crate::operations::simulate::{Assignment, Simulation, check_size, check_start, runs_away, scenario, with};
use crate::recording::{Existing, WriteError, Writer};
use crate::sim::Scenario;
use clap::Args;
use serde::Serialize;
use shared::effect::Effect;
use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};
use std::path::{Path, PathBuf};

/// Simulate a swing of the model and write it as a recording.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// A scenario instead of a model file, such as mystery-1
    #[arg(value_name = "SCENARIO", conflicts_with = "rig")]
    scenario: Option<String>,
    /// Tell what is hidden in the scenario; nothing is simulated
    #[arg(long, requires = "scenario", conflicts_with = "output")]
    reveal: bool,
    /// The model file; ./rig.toml if there is one
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Release angle, rad
    #[arg(long, value_name = "RAD", value_parser = finite, allow_negative_numbers = true, default_value = "1.5")]
    start: f64,
    /// Length of the swing, s; it is held still for 0.5 s before
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true, default_value = "46")]
    seconds: f64,
    /// Standard deviation of white noise on the angle, rad
    #[arg(long, value_name = "RAD", value_parser = not_negative, allow_negative_numbers = true)]
    #[arg(default_value = "0.001")]
    noise: f64,
    /// Equal seeds give equal noise
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
    /// Samples per second
    #[arg(long, value_name = "HZ", value_parser = positive, allow_negative_numbers = true, default_value = "1000")]
    rate: f64,
    /// Set a number of the model for this swing; adds its effect if need be (may be repeated)
    #[arg(long, value_name = "NAME=VALUE")]
    with: Vec<Assignment>,
    /// A torque of your own for this swing; give its parameters values with --with
    #[arg(long, value_name = "FORMULA", value_parser = custom_effect, allow_hyphen_values = true)]
    effect: Option<&'static Effect<f64>>,
    /// Write the angle as it is, not through a 12-bit converter
    #[arg(long)]
    exact: bool,
    /// The recording to write
    #[arg(short, long, value_name = "FILE", required_unless_present = "reveal")]
    output: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host simulate --rig rig.toml --start 1.5 --seconds 46 --noise 0.001 --seed 1 -o swing.csv
  host simulate --rig rig.toml --with Cq=1e-4 -o with-air-drag.csv
  host simulate --effect 'torque = -k*omega^3; k in 0..1e-4' --with k=2e-5 -o cubic.csv
  host simulate mystery-1 --start -1.2 -o swing2.csv
  host simulate mystery-1 --reveal";

#[derive(Serialize)]
struct Simulated {
    #[serde(serialize_with = "output::lossy")]
    file: PathBuf,
    n_samples: usize,
    rate_hz: f64,
    release_rad: f64,
    final_angle_rad: f64,
    rests: bool,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let scenario = options.scenario.as_deref().map(scenario).transpose()?;
    if let Some(scenario) = scenario.filter(|_| options.reveal) {
        return reveal(options, scenario);
    }
    let Some(path) = &options.output else {
        return Err(Failure::wrong_use("no file was named for the swing").next("name one with -o"));
    };
    check(options, path)?;
    let (model, sensor) = match scenario {
        Some(scenario) => (scenario.true_parameters(), None),
        None => {
            let file = rig::load(options.rig.as_deref())?;
            (file.parameters().clone(), file.sensor().copied())
        }
    };
    let parameters = with(&model, options.effect, &options.with)?;
    let sensor = sensor.unwrap_or(Potentiometer::nominal(FULL_SCALE_12_BIT).into());
    let simulation = Simulation {
        parameters,
        start_rad: options.start,
        seconds: options.seconds,
        noise_rad: options.noise,
        seed: options.seed,
        rate_hz: options.rate,
        converter: (!options.exact).then_some(sensor),
    };
    let simulated = write(options, path, &simulation).map_err(not_written)?;
    if options.json {
        output::json("simulate", &simulated);
    } else {
        let Simulated { n_samples, final_angle_rad, .. } = simulated;
        let end = if simulated.rests { "rests" } else { "still swings" };
        output::result(&format!(
            "wrote {} with {n_samples} samples; at the end the pendulum {end} at {final_angle_rad:.4} rad",
            path.display()
        ));
    }
    Ok(())
}

#[derive(Serialize)]
struct Revealed {
    scenario: &'static str,
    hidden: Vec<&'static str>,
    truth: Vec<(&'static str, f64)>,
}

fn reveal(options: &Options, scenario: &'static Scenario) -> Result<(), Failure> {
    let hidden = scenario.hidden_effects();
    let words =
        if hidden.is_empty() { "nothing is hidden".to_owned() } else { format!("hidden: {}", hidden.join(", ")) };
    if options.json {
        output::json("simulate", &Revealed { scenario: scenario.name, hidden, truth: scenario.truth.to_vec() });
    } else {
        let numbers = scenario.truth.iter().map(|(name, value)| format!("\n  {name} = {value}"));
        output::result(&format!("{}: {words}{}", scenario.name, numbers.collect::<String>()));
    }
    Ok(())
}

fn check(options: &Options, path: &Path) -> Result<(), Failure> {
    check_size(options.seconds, options.rate)?;
    check_start(options.start)?;
    let rig = rig::chosen_path(options.rig.as_deref()).filter(|_| options.scenario.is_none());
    output::check(&[path], &rig.as_deref().into_iter().collect::<Vec<_>>(), options.force)
}

fn write(options: &Options, path: &Path, simulation: &Simulation) -> Result<Simulated, WriteError> {
    let mut writer = Writer::whole(path, &simulation.header(), Existing::forced(options.force))?;
    let end = simulation.run(|time_s, angle_rad, code| writer.write(time_s, angle_rad, code))?;
    writer.finish()?;
    Ok(Simulated {
        file: path.to_owned(),
        n_samples: end.n_samples,
        rate_hz: options.rate,
        release_rad: options.start,
        final_angle_rad: end.final_angle_rad,
        rests: end.rests,
    })
}

fn not_written(error: WriteError) -> Failure {
    match error {
        WriteError::BadSample { time_s, angle_rad, .. } => runs_away(time_s, angle_rad),
        error => Failure::failed(error),
    }
}
