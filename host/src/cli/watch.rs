//! `host watch`: what is missing in the rig's model, said while the pendulum swings.

use super::record::Patience;
use super::{interrupt, output, port};
use crate::error::Failure;
use crate::look::{Candidate, Look, sentence};
use crate::number::significant;
use crate::operations::watch::{is_simulated, watch};
use crate::record::{Limits, Stage};
use crate::watch::Event;
use clap::Args;
use std::io::Write;

/// A bar is so many letters long at most …
const BAR: usize = 30;

/// … and grows by one for so many powers of ten that chance would have to have on its side.
const POWERS_A_LETTER: f64 = 0.5;

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
    let mut screen = Screen { is_simulated: is_simulated(session.port()), ..Screen::default() };
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
        let lines: Vec<String> = key(look).map(str::to_owned).into_iter().chain(bars(look)).collect();
        parts.push(lines.join("\n"));
    }
    parts.join("\n\n")
}

/// What the bars mean, where there are some.
fn key(look: &Look) -> Option<&'static str> {
    (!look.candidates.is_empty())
        .then_some("suspects, the largest gain first; the longer its bar, the less likely one is chance:")
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
    /// Does the pendulum let go by itself?
    is_simulated: bool,
    n_lines: usize,
    /// What was named, or why nothing was, when it was last told.
    told: Option<(Vec<&'static str>, Option<&'static str>)>,
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
            Stage::Waiting if self.is_simulated => output::say("still: the simulated pendulum is lifted and let go"),
            Stage::Waiting => output::say("still: lift it, hold it, and let it go"),
            Stage::Swinging => output::say("released: watching until it rests (Ctrl-C ends earlier)"),
            Stage::AtRest => {}
        }
    }

    fn looked(&mut self, look: &Look) {
        if output::is_watched() {
            let lines: Vec<String> = key(look).map(str::to_owned).into_iter().chain(bars(look)).collect();
            let up = if self.n_lines > 0 { format!("\x1b[{}A", self.n_lines) } else { String::new() };
            let text: String = lines.iter().map(|line| format!("\x1b[K{line}\n")).collect();
            let _ = write!(std::io::stderr(), "{up}{text}\x1b[J");
            self.n_lines = lines.len();
        }
        let told = Some((look.named.clone(), look.reason));
        // What is too early to be said is no news while it swings.
        if told != self.told && !look.is_too_early() {
            self.n_lines = 0;
            self.told = told;
            output::say(&sentence(look));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::Judge;

    #[test]
    fn a_bar_grows_by_two_letters_for_each_power_of_ten() {
        let candidate =
            |p: f64| Candidate { name: "quadratic-drag", values: Vec::new(), f: 12.345, p, windows: 9, tied: false };
        let candidates = [1e-10, 1e-3, 1e-40, 1.0].map(candidate).to_vec();
        let look = Look {
            named: Vec::new(),
            candidates,
            reason: None,
            swings: 1,
            watched: 1,
            noise_rad: 1e-3,
            excess: [0.0; 2],
            left: None,
            judge: Judge::Program,
        };
        assert!(key(&look).unwrap().contains("largest gain first"));
        assert_eq!(key(&Look { candidates: Vec::new(), ..look.clone() }), None);
        let bars = bars(&look);
        assert_eq!(bars.iter().map(|bar| bar.matches('█').count()).collect::<Vec<_>>(), [20, 6, BAR, 0]);
        assert!(bars[0].ends_with("F 12.3      p 1e-10"), "{bars:?}");
    }
}
