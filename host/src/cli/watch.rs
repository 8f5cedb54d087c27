//! `host watch`: what is missing in the rig's model, said while the pendulum swings.

use super::number::{significant, with_spread};
use super::record::Patience;
use super::{interrupt, output, port};
use crate::error::Failure;
use crate::operations::watch::watch;
use crate::record::{Limits, Stage};
use crate::watch::{Candidate, Event, Judge, Look};
use clap::Args;
use std::io::Write;

/// A bar is so many letters long at most …
const BAR: usize = 30;

/// … and grows by one for so many powers of ten that chance would have to have on its side.
const POWERS_A_LETTER: f64 = 0.5;

/// From this share of the noise's squares on, more than noise is left.
const MORE: f64 = 0.1;

/// So many suspects are shown.
const N_SHOWN: usize = 5;

/// Say which physical effect the rig's model lacks while the pendulum swings.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Watch so many releases; without it one, on a simulated rig until something is named, at most five
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100))]
    swings: Option<u32>,
    #[command(flatten)]
    patience: Patience,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host watch --port /dev/ttyACM0
  host watch --port /dev/ttyACM0 --swings 3      large and small, to both sides
  host watch --port sim:mystery-1 --json

Friction and inertia of the rig's model are put right first, so that wrong numbers accuse no
effect. One release says little, three say most. A rig whose firmware looks by itself has the last
word. Nothing on the rig is changed; `host diagnose` on recordings is the thorough answer.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut session = port::connect(&options.port)?;
    let limits = Limits { wait_s: options.patience.wait, limit_s: options.patience.limit };
    let mut screen = Screen::default();
    let mut tell = |event: Event| screen.show(&event);
    let last = interrupt::orderly(|stop| watch(&mut session, options.swings, limits, &mut tell, stop))?;
    if let Some(look) = last {
        tell_result(&look, options.json);
    }
    Ok(())
}

fn tell_result(look: &Look, is_json: bool) {
    if is_json {
        output::json("watch", look);
    } else {
        output::result(&in_words(look));
    }
}

/// What the swings said, for a person.
fn in_words(look: &Look) -> String {
    let mut parts = vec![sentence(look)];
    if !look.candidates.is_empty() {
        parts.push(bars(look).join("\n"));
    }
    parts.join("\n\n")
}

fn sentence(look: &Look) -> String {
    let Some(first) = look.candidates.first().filter(|_| !look.named.is_empty()) else {
        let reason = look.reason.unwrap_or_default();
        return format!("Nothing is named after {}: {reason}.", releases(look.swings));
    };
    let others: Vec<&str> = look.candidates.iter().skip(1).filter(|other| other.tied).map(|other| other.name).collect();
    let tied = match others.as_slice() {
        [] => String::new(),
        names => format!(" These swings can't tell it from {}.", names.join(" or ")),
    };
    let more = if look.left.is_some_and(|left| left > MORE) { " More than noise is left with it." } else { "" };
    let who = if look.judge == Judge::Rig { "The rig itself names what is missing" } else { "Missing" };
    format!("{who}: {} ({}), after {}.{tied}{more}", first.name, numbers(first), releases(look.swings))
}

fn releases(n: usize) -> String {
    if n == 1 { "one release".to_owned() } else { format!("{n} releases") }
}

fn numbers(candidate: &Candidate) -> String {
    let number = |value: &crate::watch::Value| {
        let unit = if value.unit == "1" { String::new() } else { format!(" {}", value.unit) };
        match value.std {
            Some(std) => format!("{} = {}{unit}", value.name, with_spread(value.value, Some(std))),
            None => format!("{} about {}{unit}", value.name, significant(value.value, 2)),
        }
    };
    candidate.values.iter().map(number).collect::<Vec<_>>().join(", ")
}

/// A bar of evidence for each of the likeliest effects.
fn bars(look: &Look) -> Vec<String> {
    let bar = |candidate: &Candidate| {
        let powers = -candidate.p.max(f64::MIN_POSITIVE).log10();
        let n = ((powers / POWERS_A_LETTER) as usize).min(BAR);
        format!(
            "{:<26}{:<BAR$}  F {:<9} p {:.0e}",
            candidate.name,
            "█".repeat(n),
            significant(candidate.f, 3),
            candidate.p
        )
    };
    look.candidates.iter().take(N_SHOWN).map(bar).collect()
}

/// What the person at the rig sees: on a terminal the bars grow in place, elsewhere changes are told.
#[derive(Default)]
struct Screen {
    n_lines: usize,
    named: Vec<&'static str>,
}

impl Screen {
    fn show(&mut self, event: &Event) {
        match event {
            Event::Stage(stage) => self.stage(*stage),
            Event::Looked(look) => self.looked(look),
            Event::RigLooks => output::say("the rig itself looks …"),
        }
    }

    fn stage(&mut self, stage: Stage) {
        self.n_lines = 0;
        match stage {
            Stage::Settling => output::say("waiting until the pendulum is still …"),
            Stage::Waiting => output::say("still: lift it, hold it, and let it go"),
            Stage::Swinging => output::say("released: watching until it rests (Ctrl-C ends earlier)"),
            Stage::AtRest => {}
        }
    }

    fn looked(&mut self, look: &Look) {
        if output::is_watched() {
            let lines = bars(look);
            let up = if self.n_lines > 0 { format!("\x1b[{}A", self.n_lines) } else { String::new() };
            let text: String = lines.iter().map(|line| format!("\x1b[K{line}\n")).collect();
            let _ = write!(std::io::stderr(), "{up}{text}\x1b[J");
            self.n_lines = lines.len();
        }
        if look.named != self.named {
            self.n_lines = 0;
            self.named.clone_from(&look.named);
            output::say(&sentence(look));
        }
    }
}
