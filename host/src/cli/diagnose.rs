//! `host diagnose`: which physical effect is missing from the model?

use super::given::Given;
use super::values::custom_effect;
use super::{evidence, output};
use crate::diagnose::{Diagnosis, Wishes, diagnose_with};
use crate::error::Failure;
use crate::look::{Look, at_first_look};
use crate::operations::diagnose::Fields;
use crate::operations::json::{all_named, doubts};
use crate::plot::friction::friction;
use crate::plot::svg::svg;
use crate::report::diagnosis::report;
use clap::Args;
use shared::effect::Effect;
use std::path::{Path, PathBuf};

/// Find out which physical effect is missing: fit the base model, then try every effect there is.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// A recording that takes no part and shows how well each model predicts (may be repeated)
    #[arg(long, value_name = "FILE")]
    hold_out: Vec<PathBuf>,
    /// Try this torque of your own beside the effects of the list
    #[arg(long, value_name = "FORMULA", value_parser = custom_effect, allow_hyphen_values = true)]
    effect: Option<&'static Effect<f64>>,
    /// Search small formulas for what no effect explains; takes up to a minute
    #[arg(long)]
    formulas: bool,
    /// Draw the friction curve here, where no law explains the swings (SVG)
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Write a report for the browser, one file that needs no network
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Replace a drawing and a report that exist there
    #[arg(long)]
    force: bool,
    // Last, because what follows these stands under their heading in the help.
    #[command(flatten)]
    given: Given,
}

const EXAMPLE: &str = "\
Example:
  host diagnose swing1.csv swing2.csv swing3.csv --rig rig.toml
  host diagnose swing*.csv --hold-out other.csv --json
  host diagnose swing*.csv --report missing.html
  host diagnose swing*.csv --formulas
  host diagnose swing*.csv --effect 'torque = -k*omega^3; k in 0..1e-4 N·m·s³'";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let new: Vec<&Path> = options.plot.iter().chain(&options.report).map(PathBuf::as_path).collect();
    options.given.check_outputs(&new, &options.hold_out, options.force)?;
    let model = options.given.model()?;
    let swings = options.given.swings(&model)?;
    let held_out = options.given.held_out(&model, &options.hold_out, &swings)?;
    output::say("fitting the base model, then every effect …");
    let wishes = Wishes { typed: options.effect, formulas: options.formulas, at_first_look: Some(first_look) };
    let diagnosis = diagnose_with(&swings, &held_out, model.known(), wishes);
    if options.given.json {
        output::json(
            "diagnose",
            &Fields { recordings: &all_named(&swings), doubts: doubts(&swings), diagnosis: &diagnosis },
        );
    } else {
        output::result(&evidence::in_words(&diagnosis));
    }
    draw(options, &diagnosis)?;
    let Some(path) = &options.report else { return Ok(()) };
    let page = report(&diagnosis, &evidence::sentences(&diagnosis), &evidence::treads(&diagnosis));
    output::write(path, &page, options.force)
}

fn first_look(look: &Look) {
    output::say(&format!("first look, as a rig makes it by itself: {}", at_first_look(look)));
}

fn draw(options: &Options, diagnosis: &Diagnosis) -> Result<(), Failure> {
    let Some(path) = &options.plot else { return Ok(()) };
    let picture = diagnosis.curve.as_ref().and_then(|curve| friction(&curve.parameters, &curve.stds));
    match picture {
        Some(picture) => output::write(path, &svg(&picture), options.force),
        None => {
            output::say("nothing is drawn: no friction curve is better than the named laws");
            Ok(())
        }
    }
}
