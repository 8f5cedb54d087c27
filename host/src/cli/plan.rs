//! `host plan`: which experiment would tell the leading models apart?

use super::given::Given;
use super::output;
use super::table::table;
use crate::diagnose::INDISTINGUISHABLE;
use crate::error::Failure;
use crate::operations::json::all_named;
use crate::operations::plan::Planned;
use crate::plan::{Experiment, NOTHING, Prospect};
use crate::verdict::Left;
use clap::Args;

/// Find the experiment that would best separate the leading explanations: release angle and side, mass, length.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    #[command(flatten)]
    given: Given,
}

const EXAMPLE: &str = "\
Example:
  host plan swing1.csv swing2.csv --rig rig.toml

The models that explain the recordings best are simulated in each experiment. What counts is the
difference that stays when a wrong model moves its parameters as far as the recordings allow.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let file = options.given.model()?;
    let swings = options.given.swings(&file)?;
    output::say("looking for the leading explanations, then simulating experiments with each …");
    let planned = Planned::new(&all_named(&swings), &swings, &file);
    if options.given.json {
        output::json("plan", &planned);
    } else {
        output::result(&in_words(&planned));
    }
    Ok(())
}

fn in_words(planned: &Planned) -> String {
    let Planned { models, undecided, experiments: prospects, left: (left, noises), .. } = planned;
    let is_missing = *left == Left::Missing;
    let Some(best) = prospects.first() else {
        return if is_missing {
            format!(
                "The model leaves {noises:.1} times the noise, but nothing that is known explains it, so there is nothing \
                 to separate. `host diagnose` says more."
            )
        } else {
            "Nothing is missing at this noise level, so there is nothing to separate. A release from another angle, or \
             less noise, may show more."
                .to_owned()
        };
    };
    let mut lines = vec![match models[0].as_str() {
        NOTHING if is_missing => format!(
            "The model leaves {noises:.1} times the noise, but these recordings prove no single effect to be missing."
        ),
        NOTHING => "By these recordings nothing is missing.".to_owned(),
        names => format!("Missing is, by these recordings: {names}."),
    }];
    lines.push(match undecided.as_slice() {
        [] => format!("The next best explanations are {}.", models[1..].join(", ")),
        names => format!("They can't tell it from {}.", names.join(", ")),
    });
    let advice = in_a_sentence(&best.experiment);
    lines.push(if best.worst < INDISTINGUISHABLE {
        format!("No experiment of the list would separate them; the best is: {advice}.")
    } else {
        format!("Best: {advice}.")
    });
    lines.push(String::new());
    lines.push(listed(&prospects[..prospects.len().min(SHOWN)]));
    lines
        .push("Noises: how far the models stay apart, rms, when each imitates the other as well as it can.".to_owned());
    lines.join("\n")
}

/// So many experiments are shown; `--json` has all.
const SHOWN: usize = 6;

fn in_a_sentence(experiment: &Experiment) -> String {
    let release = format!("a release from {:+.1} rad", experiment.release_rad);
    match changed(experiment) {
        None => release,
        Some(change) => format!("{release} with {change}"),
    }
}

fn changed(experiment: &Experiment) -> Option<String> {
    let factor = |factor: f64, what: &str| (factor != 1.0).then(|| format!("{factor} times the {what}"));
    factor(experiment.mass_factor, "mass").or(factor(experiment.length_factor, "length"))
}

fn listed(prospects: &[Prospect]) -> String {
    let row = |prospect: &Prospect| {
        let hardest = prospect.separations.iter().min_by(|a, b| a.delta_chi_square.total_cmp(&b.delta_chi_square))?;
        Some(vec![
            format!("{:+.1} rad", prospect.experiment.release_rad),
            changed(&prospect.experiment).unwrap_or("as it is".to_owned()),
            hardest.models.join(" and "),
            format!("{:.2}", hardest.noises),
        ])
    };
    let rows = prospects.iter().filter_map(row).collect();
    table(["release", "pendulum", "hardest to separate", "noises"], rows, 3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Separation;

    fn planned(models: &[&str], left: Left) -> Planned {
        let models: Vec<String> = models.iter().map(|name| (*name).to_owned()).collect();
        let separation = Separation { models: ["a".to_owned(), "b".to_owned()], delta_chi_square: 100.0, noises: 0.5 };
        let experiment = Experiment { release_rad: 1.0, mass_factor: 1.0, length_factor: 1.0 };
        let prospect = Prospect { experiment, separations: vec![separation], worst: 100.0 };
        let experiments = if models.len() < 2 { Vec::new() } else { vec![prospect] };
        Planned { recordings: Vec::new(), models, undecided: Vec::new(), experiments, left: (left, 17.25) }
    }

    #[test]
    fn nothing_is_missing_only_where_nothing_is_left() {
        for models in [&[NOTHING, "eddy-brake"][..], &[NOTHING]] {
            let much = in_words(&planned(models, Left::Missing));
            assert!(much.contains("17.2 times the noise") && !much.contains("othing is missing"), "{much}");
            let noise = in_words(&planned(models, Left::Noise));
            assert!(noise.to_lowercase().contains("nothing is missing"), "{noise}");
        }
        let named = in_words(&planned(&["viscous", "coulomb"], Left::Noise));
        assert!(named.starts_with("Missing is, by these recordings: viscous."), "{named}");
    }

    #[test]
    fn the_best_experiment_is_told_with_what_is_changed_unless_none_separates() {
        let mut found = planned(&["viscous", "coulomb"], Left::Noise);
        found.experiments[0].experiment = Experiment { release_rad: -0.6, mass_factor: 1.0, length_factor: 1.25 };
        let said = in_words(&found);
        assert!(said.contains("Best: a release from -0.6 rad with 1.25 times the length."), "{said}");
        found.experiments[0].experiment = Experiment { release_rad: 0.6, mass_factor: 0.67, length_factor: 1.0 };
        found.experiments[0].worst = 0.9 * INDISTINGUISHABLE;
        let said = in_words(&found);
        let none = "No experiment of the list would separate them; the best is: a release from +0.6 rad with 0.67 times the mass.";
        assert!(said.contains(none), "{said}");
    }
}
