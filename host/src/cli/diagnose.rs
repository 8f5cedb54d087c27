//! `host diagnose`: which physical effect is missing from the model?

use super::given::Given;
use super::values::custom_effect;
use super::{evidence, output};
use crate::diagnose::{Diagnosis, Value, Wishes, diagnose_with};
use crate::error::Failure;
use crate::geometry::slower_than_seen;
use crate::look::{Look, at_first_look};
use crate::operations::diagnose::Fields;
use crate::operations::json::{all_named, doubts};
use crate::plot::friction::friction;
use crate::plot::svg::svg;
use crate::report::diagnosis::report;
use crate::swing::Swing;
use crate::verdict::Left;
use clap::Args;
use shared::effect::Effect;
use shared::parameters::Parameters;
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
    if diagnosis.contradicts_its_first_look() {
        output::say("the thorough search says otherwise, and it counts:");
    }
    already_there(&diagnosis, model.parameters()).iter().for_each(|words| output::warn(words));
    without_inertia(&diagnosis, model.parameters(), &swings).iter().for_each(|words| output::warn(words));
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

/// Of what the base model lacks the given one may have some already, as after `host improve`.
fn already_there(diagnosis: &Diagnosis, parameters: &Parameters<f64>) -> Option<String> {
    let is_there = |name: &&&str| {
        let id = Effect::<f64>::by_name(name).map(|effect| effect.id);
        parameters.effects.iter().any(|effect| Some(effect.id) == id)
    };
    let there: Vec<&str> = diagnosis.verdict.iter().filter(is_there).copied().collect();
    let (what, is) = (there.join(" and "), if there.len() == 1 { "is" } else { "are" });
    (!there.is_empty()).then(|| {
        format!(
            "{what} {is} in this model already: what is missing is told of the base model; host compare tells what this one leaves"
        )
    })
}

/// Where more than the noise is left and the inertia ended at zero, the length may be too large.
fn without_inertia(diagnosis: &Diagnosis, parameters: &Parameters<f64>, swings: &[Swing]) -> Option<String> {
    let is_zero = |value: &Value| value.effect == "inertia" && value.value == 0.0;
    let ends_at_zero = diagnosis.left == Left::Missing && diagnosis.values.iter().any(is_zero);
    ends_at_zero.then(|| slower_than_seen(parameters, swings)).flatten()
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

#[cfg(test)]
mod tests {
    use crate::diagnose::Diagnosis;
    use crate::examples::diagnosis;
    use crate::look::{Candidate, Judge, Look, of_reason};
    use shared::bank::findings::Reason;

    /// A look that names the first of these, the second of which it can't tell from it.
    fn look(names: &[&'static str], reason: Option<Reason>) -> Look {
        let candidate = |(idx, name): (usize, &&'static str)| Candidate {
            name,
            values: Vec::new(),
            f: 9.0,
            p: 1e-9,
            windows: 9,
            tied: idx > 0,
        };
        Look {
            named: names.iter().copied().take(1).collect(),
            candidates: names.iter().enumerate().map(candidate).collect(),
            reason: reason.map(of_reason),
            swings: 1,
            watched: 1,
            noise_rad: 1e-4,
            excess: [0.0; 2],
            left: None,
            judge: Judge::Program,
        }
    }

    #[test]
    fn a_first_look_is_contradicted_where_the_thorough_answer_is_another_one() {
        let contradicts = |look: Look, verdict: &[&'static str]| {
            let found = Diagnosis { first_look: Some(look), verdict: verdict.to_vec(), ..diagnosis() };
            found.contradicts_its_first_look()
        };
        let nothing = || look(&[], Some(Reason::NothingMissing));
        assert!(contradicts(nothing(), &["presliding"]) && !contradicts(nothing(), &[]));
        assert!(!contradicts(look(&[], Some(Reason::Unexplained)), &["presliding"]));
        let drags = || look(&["quadratic-drag", "power-law-drag"], None);
        assert!(contradicts(drags(), &[]) && contradicts(drags(), &["detent"]));
        assert!(!contradicts(drags(), &["quadratic-drag"]) && !contradicts(drags(), &["power-law-drag"]));
    }
}
