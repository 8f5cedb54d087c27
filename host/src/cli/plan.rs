//! `host plan`: which experiment would tell the leading models apart?

use super::given::Given;
use super::output;
use super::table::table;
use crate::error::Failure;
use crate::operations::json::all_named;
use crate::operations::plan::Planned;
use crate::plan::{DISTINGUISHABLE, Experiment, Prospect};
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

The models that explain the recordings best are simulated in each experiment. What counts is the difference that stays
when a wrong model moves its parameters as far as the recordings allow.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let file = options.given.model()?;
    let swings = options.given.swings(&file)?;
    output::say("looking for the leading explanations, then simulating experiments with each …");
    let planned = Planned::new(&all_named(&options.given.recordings), &swings, &file);
    if options.given.json {
        output::json("plan", &planned);
    } else {
        output::result(&in_words(&planned));
    }
    Ok(())
}

fn in_words(planned: &Planned) -> String {
    let Planned { models, undecided, experiments: prospects, .. } = planned;
    let Some(best) = prospects.first() else {
        return "Nothing is missing at this noise level, so there is nothing to separate. A release from another angle, \
                or less noise, may show more."
            .to_owned();
    };
    let mut lines = vec![format!("Missing is, by these recordings: {}.", models[0])];
    lines.push(match undecided.as_slice() {
        [] => format!("The next best explanations are {}.", models[1..].join(", ")),
        names => format!("They can't tell it from {}.", names.join(", ")),
    });
    let advice = in_a_sentence(&best.experiment);
    lines.push(if best.worst < DISTINGUISHABLE {
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
