//! `host simulate`: a swing of the model, written as a recording.

use super::values::{Assignment, custom_effect, finite, not_negative, positive};
use super::{output, rig};
use crate::error::Failure;
use crate::formula::{self, effect_of};
use crate::recording::{Calibration, Existing, Header, WriteError, Writer};
use crate::sim::{Noise, Scenario};
use clap::Args;
use serde::Serialize;
use shared::effect::{CUSTOM_FORMULA_ID, Effect};
use shared::model::Model;
use shared::parameters::Parameters;
use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};
use std::path::{Path, PathBuf};

/// The pendulum is held still at the start angle for so long, s.
const HELD_S: f64 = 0.5;

/// Rates beyond this make files nobody wants.
const HIGHEST_RATE_HZ: f64 = 100_000.0;

/// Longer swings neither.
const LONGEST_S: f64 = 36_000.0;

/// Simulate a swing of the model, held still for 0.5 s first, and write it as a recording.
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
    /// Length of the swing, s
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
    let (model, potentiometer) = match scenario {
        Some(scenario) => (scenario.true_parameters(), None),
        None => {
            let file = rig::load(options.rig.as_deref())?;
            (file.parameters().clone(), file.potentiometer().copied())
        }
    };
    let parameters = with(&model, options.effect, &options.with)?;
    let potentiometer = potentiometer.unwrap_or(Potentiometer::nominal(FULL_SCALE_12_BIT));
    let simulated =
        write(options, path, &parameters, (!options.exact).then_some(potentiometer)).map_err(not_written)?;
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

fn scenario(name: &str) -> Result<&'static Scenario, Failure> {
    Scenario::by_name(name).ok_or_else(|| {
        let names: Vec<&str> = Scenario::ALL.iter().map(|scenario| scenario.name).collect();
        Failure::wrong_use(format!("there is no scenario called {name}"))
            .next(format!("choose one of {}", names.join(", ")))
    })
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
    if options.rate > HIGHEST_RATE_HZ || options.seconds > LONGEST_S {
        let what = format!("{} s at {} Hz is too much", options.seconds, options.rate);
        return Err(Failure::wrong_use(what).next(format!("stay within {LONGEST_S} s and {HIGHEST_RATE_HZ} Hz")));
    }
    let rig = rig::chosen_path(options.rig.as_deref()).filter(|_| options.scenario.is_none());
    output::check(&[path], &rig.as_deref().into_iter().collect::<Vec<_>>(), options.force)
}

fn with(
    parameters: &Parameters<f64>,
    effect: Option<&'static Effect<f64>>,
    assignments: &[Assignment],
) -> Result<Parameters<f64>, Failure> {
    let refused = |error| Failure::wrong_use(error).next("give --with a value within the range");
    let mut parameters = parameters.clone();
    if let Some(effect) = effect {
        let start: Vec<f64> = effect.parameters.iter().map(|parameter| parameter.start).collect();
        formula::add(&mut parameters, effect, &start).map_err(refused)?;
    }
    let custom = effect_of(&parameters, CUSTOM_FORMULA_ID);
    for assignment in assignments {
        let quantity = assignment
            .quantity(custom)
            .map_err(|error| Failure::wrong_use(error).next("name one of them in --with"))?;
        quantity.add_effect(&mut parameters).map_err(refused)?;
        quantity.set(&mut parameters, assignment.value);
    }
    parameters.check().map_err(refused)?;
    Ok(parameters)
}

fn write(
    options: &Options,
    path: &Path,
    parameters: &Parameters<f64>,
    converter: Option<Potentiometer>,
) -> Result<Simulated, WriteError> {
    let mut writer = Writer::whole(path, &header(options, converter), Existing::forced(options.force))?;
    let model = Model::new(parameters);
    let mut state = model.release(options.start, 0.0);
    let mut sensor = model.sensor_at_rest(&state);
    let mut noise = Noise::new(options.seed);
    let n_held = (HELD_S * options.rate).round() as usize;
    let n_samples = n_held + (options.seconds * options.rate).round() as usize + 1;
    for sample_idx in 0..n_samples {
        if sample_idx > n_held {
            model.step(&mut state, 1.0 / options.rate);
        }
        let angle_rad = model.read(&state, &mut sensor) + options.noise * noise.normal();
        let (angle_rad, code) = converter.map_or((angle_rad, None), |potentiometer| convert(&potentiometer, angle_rad));
        writer.write(sample_idx as f64 / options.rate, angle_rad, code)?;
    }
    writer.finish()?;
    Ok(Simulated {
        file: path.to_owned(),
        n_samples,
        rate_hz: options.rate,
        release_rad: options.start,
        final_angle_rad: state.angle_rad,
        rests: state.contact.is_resting(),
    })
}

fn header(options: &Options, converter: Option<Potentiometer>) -> Header {
    let calibration = converter.map(|potentiometer| Calibration {
        zero_code: f64::from(potentiometer.zero_code),
        radians_per_code: f64::from(potentiometer.radian_per_code),
    });
    let comment = format!("simulated, noise {} rad, seed {}", options.noise, options.seed);
    Header { rate_hz: Some(options.rate), calibration, comment: Some(comment), ..Header::default() }
}

/// Through the converter and back, as the rig does it.
fn convert(potentiometer: &Potentiometer, angle_rad: f64) -> (f64, Option<u16>) {
    let (zero, step) = (f64::from(potentiometer.zero_code), f64::from(potentiometer.radian_per_code));
    let code = (angle_rad / step + zero).round().clamp(0.0, f64::from(potentiometer.full_scale)) as u16;
    ((f64::from(code) - zero) * step, Some(code))
}

fn not_written(error: WriteError) -> Failure {
    match error {
        WriteError::BadSample { time_s, angle_rad, .. } => {
            let what = format!("the swing runs away: at {time_s:.3} s its angle is {angle_rad:e} rad");
            Failure::failed(what).next("an effect of the model feeds energy in without end; choose smaller values")
        }
        error => Failure::failed(error),
    }
}
