//! `host improve`: add what is missing, refit, watch the error fall, and keep the enlarged model.

use super::given::Given;
use super::values::custom_effect;
use super::{evidence, output, rig};
use crate::error::Failure;
use crate::fit::identify::Carries;
use crate::improve::{Change, Step};
use crate::operations::improve::{Improved, METHOD, effect_named, improve};
use crate::plot::staircase::{Tread, staircase};
use crate::plot::svg::svg;
use crate::recording::Measured;
use crate::rigfile::Source;
use crate::swing::kind;
use clap::Args;
use shared::effect::Effect;
use shared::parameters::Parameters;
use std::path::PathBuf;

/// Add the missing effects to the model, refit everything, and show how the error falls.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// A recording that takes no part (may be repeated)
    #[arg(long, value_name = "FILE")]
    hold_out: Vec<PathBuf>,
    /// Add this effect by hand instead of asking the diagnosis (may be repeated)
    #[arg(long, value_name = "NAME")]
    add: Vec<String>,
    /// Try this torque of your own; with --add custom it is added in any case
    #[arg(long, value_name = "FORMULA", value_parser = custom_effect, allow_hyphen_values = true)]
    effect: Option<&'static Effect<f64>>,
    /// Take this effect out by hand (may be repeated)
    #[arg(long, value_name = "NAME")]
    remove: Vec<String>,
    /// Write the enlarged model here
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace other files that exist there
    #[arg(long)]
    force: bool,
    /// Draw the error after each step here (SVG)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    // Last, because what follows these stands under their heading in the help.
    #[command(flatten)]
    given: Given,
}

const EXAMPLE: &str = "\
Example:
  host improve swing*.csv --rig rig.toml -o rig.toml         until nothing is missing
  host improve swing*.csv --plot falling.svg                 … and a picture of it
  host improve swing*.csv --add quadratic-drag -o rig.toml   one step by hand
  host improve swing*.csv --remove viscous                   what would that cost?

`host effects` lists the names.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut model = options.given.model()?;
    let changes = changes(options, model.parameters())?;
    check_outputs(options)?;
    let swings = options.given.swings(&model)?;
    let held_out = options.given.held_out(&model, &options.hold_out, &swings)?;
    let improved = improve(&swings, &held_out, model.known(), options.effect, &changes)?;
    if options.given.json {
        output::json("improve", &improved);
    } else {
        output::result(&in_words(&improved, kind(&swings).milli_unit()));
    }
    draw(options, &improved, kind(&swings))?;
    if let Some(path) = &options.output {
        let source = Source::of_swings(METHOD, &swings);
        improved.write_into(&mut model, &source)?;
        model.save(path)?;
        output::say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

fn check_outputs(options: &Options) -> Result<(), Failure> {
    let (rig, model, drawing) = (options.given.rig.as_deref(), options.output.as_deref(), options.plot.as_deref());
    rig::check_outputs(rig, model, drawing, &[&options.given.recordings, &options.hold_out], options.force)
}

fn changes(options: &Options, rig: &Parameters<f64>) -> Result<Vec<Change>, Failure> {
    let effect = |name: &String| effect_named(name, options.effect, rig);
    let added = options.add.iter().map(|name| Ok(Change::Add(effect(name)?)));
    let removed = options.remove.iter().map(|name| Ok(Change::Remove(effect(name)?)));
    added.chain(removed).collect()
}

fn draw(options: &Options, improved: &Improved, measured: Measured) -> Result<(), Failure> {
    let Some(path) = &options.plot else { return Ok(()) };
    let (treads, noise) = match improved {
        Improved::Diagnosed(diagnosis) => (evidence::treads(diagnosis), diagnosis.noise),
        Improved::Changed { steps, .. } => (treads(steps), steps.first().map_or(0.0, |step| step.noise)),
    };
    output::write(path, &svg(&staircase(&treads, noise, measured)), options.force)
}

fn treads(steps: &[Step]) -> Vec<Tread> {
    let tread = |step: &Step| Tread { words: step.words.clone(), rmse_rad: step.rmse, held_out_rad: step.held_out };
    steps.iter().map(tread).collect()
}

fn in_words(improved: &Improved, unit: &str) -> String {
    match improved {
        Improved::Diagnosed(diagnosis) => evidence::in_words(diagnosis),
        Improved::Changed { steps, .. } => error_after_each(steps, unit),
    }
}

fn error_after_each(steps: &[Step], unit: &str) -> String {
    let line = |step: &Step| {
        let held_out = step.held_out.map_or(String::new(), |rmse| format!("  held out {:.3} {unit}", 1e3 * rmse));
        let noises = step.rmse / step.noise;
        let said = match step.carries {
            Some(Carries::Confirmed) => ", confirmed",
            Some(Carries::Contradicted) => ", contradicted",
            Some(Carries::CannotTell) => ", can't tell",
            None => "",
        };
        format!("  {:<32}{:>9.3} {unit}  {noises:>6.2} noises{held_out}{said}", step.words, 1e3 * step.rmse)
    };
    std::iter::once("Error after each step".to_owned()).chain(steps.iter().map(line)).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_step_is_told_with_its_error_and_what_held_out_swings_say() {
        let step = |carries| Step {
            words: "+ quadratic-drag".to_owned(),
            rmse: 2e-3,
            held_out: Some(3e-3),
            carries,
            noise: 1e-3,
            values: Vec::new(),
            parameters: Parameters::paper(),
        };
        let told =
            error_after_each(&[Carries::Confirmed, Carries::Contradicted].map(|carries| step(Some(carries))), "mrad");
        let lines: Vec<&str> = told.lines().skip(1).collect();
        assert!(lines[0].ends_with("    2.000 mrad    2.00 noises  held out 3.000 mrad, confirmed"), "{told}");
        assert!(lines[1].ends_with(", contradicted"), "{told}");
    }
}
