//! `host effects`: what may act on a pendulum, read from the one list.

use super::output;
use crate::error::Failure;
use crate::formula;
use crate::operations::effects::{Shown, acts_on, chosen};
use clap::Args;
use shared::effect::{CUSTOM_FORMULA_NAME, Effect};

/// List the physical effects, or explain one.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Explain this one
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Print all of them as the page docs/effects.md
    #[arg(long, conflicts_with_all = ["name", "json"])]
    markdown: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host effects
  host effects quadratic-drag
  host effects custom                 how to type one of your own";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    if options.name.as_deref() == Some(CUSTOM_FORMULA_NAME) && !options.json {
        output::result(formula::GUIDE);
        return Ok(());
    }
    let chosen = chosen(options.name.as_deref())?;
    if options.json {
        output::json("effects", &Shown::of(&chosen));
    } else if options.markdown {
        output::result(&markdown());
    } else if options.name.is_some() {
        output::result(&chosen.into_iter().map(explained).collect::<String>());
    } else {
        output::result(&listing());
    }
    Ok(())
}

fn listing() -> String {
    let width = Effect::<f64>::ALL.iter().map(|effect| acts_on(effect).chars().count()).max().unwrap_or(0);
    let line = |effect: &Effect<f64>| {
        let symbols: Vec<&str> = effect.parameters.iter().map(|p| p.symbol).collect();
        format!("  {:<26}{:<width$}  {}", effect.name, acts_on(effect), symbols.join(", "))
    };
    let lines: Vec<String> = Effect::ALL.iter().map(line).collect();
    format!(
        "{}\n\n`host effects NAME` explains one, `host effects custom` how to type one of your own.",
        lines.join("\n")
    )
}

fn explained(effect: &Effect<f64>) -> String {
    let number = |p: &shared::effect::Parameter| {
        let unit = if p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
        format!("  {:<5} {} ({} … {}{unit})\n", p.symbol, p.meaning, p.low, p.high)
    };
    let numbers: String = effect.parameters.iter().map(number).collect();
    format!(
        "{} ({})\n{}\n\n  {}\n{numbers}\nshows best: {}\nsource: {}",
        effect.name,
        acts_on(effect),
        effect.summary,
        effect.formula,
        effect.experiment,
        effect.source
    )
}

/// The page of all effects.
fn markdown() -> String {
    let section = |effect: &Effect<f64>| {
        let row = |p: &shared::effect::Parameter| {
            format!("| {} | {} | {} … {} | {} |\n", p.symbol, p.unit, p.low, p.high, p.meaning)
        };
        let rows: String = effect.parameters.iter().map(row).collect();
        format!(
            "\n## {}\n\n{}\n\n    {}\n\nActs on: {}.\n\n| symbol | unit | range | meaning |\n|---|---|---|---|\n{rows}\nShows best: {}\n\nSource: {}.\n",
            effect.name,
            effect.summary,
            effect.formula,
            acts_on(effect),
            effect.experiment,
            effect.source
        )
    };
    let sections: String = Effect::ALL.iter().map(section).collect();
    let own = format!("## A formula of your own\n\n{}", formula::GUIDE);
    format!("# Physical effects\n\nMade from the code by `host effects --markdown`.\n{sections}\n{own}")
        .trim_end()
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_effect_acts_on_and_its_numbers_are_columns_of_their_own() {
        let listing = listing();
        let support = listing.lines().find(|line| line.contains("resonant-support")).unwrap();
        assert!(support.contains("something that swings with it  cs, rs, zs, bs"), "{support}");
    }
}
