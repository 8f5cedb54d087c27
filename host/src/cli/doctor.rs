//! `host doctor`: is everything well between the pendulum and this program?

use super::{output, rig};
use crate::doctor::{Checkup, Finding, UDEV_RULE, examine};
use crate::error::Failure;
use crate::rigfile::RigFile;
use clap::Args;
use std::path::PathBuf;

/// Check ports, board, signal, calibration and model, and say what to do next.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME; the only USB serial port if there is one
    #[arg(long, value_name = "PORT")]
    port: Option<String>,
    /// Compare with this model file; ./rig.toml if there is one
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Print the rule that lets everybody use the rig's port, for /etc/udev/rules.d/99-pendulum-rig.rules
    #[arg(long, exclusive = true)]
    udev_rule: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host doctor                        what is attached, and is it well?
  host doctor --port /dev/ttyACM0 --rig rig.toml
  host doctor --udev-rule | sudo tee /etc/udev/rules.d/99-pendulum-rig.rules

Nothing on the rig is changed. Let the pendulum hang still meanwhile. The exit code is 0 whatever
was found; `healthy` in --json tells whether there is anything to look at.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    if options.udev_rule {
        output::result(UDEV_RULE.trim_end());
        return Ok(());
    }
    let path = rig::chosen_path(options.rig.as_deref());
    let model = path.map(|path| RigFile::load(&path)).transpose()?;
    let listens = || output::say("looking, for about three seconds …");
    let checkup = examine(options.port.as_deref(), model.as_ref(), &listens);
    if options.json {
        output::json("doctor", &checkup)
    } else {
        output::result(&in_words(&checkup))
    }
    Ok(())
}

fn in_words(checkup: &Checkup) -> String {
    let n_to_look = checkup.findings.iter().filter(|finding| !finding.ok).count();
    let end = match (n_to_look, &checkup.port) {
        (_, None) => "No rig was looked at: there is no port that must be its.".to_owned(),
        (0, _) => "Everything is as it should be.".to_owned(),
        (1, _) => "One thing to look at.".to_owned(),
        (n_to_look, _) => format!("{n_to_look} things to look at."),
    };
    let lines: Vec<String> = checkup.findings.iter().map(line).collect();
    format!("{}\n\n{end}", lines.join("\n"))
}

fn line(finding: &Finding) -> String {
    let verdict = if finding.ok { "ok" } else { "look here" };
    let head = format!("{verdict:<11}{:<15}{}", finding.what, finding.found);
    match &finding.next {
        None => head,
        Some(next) => format!("{head}\n{:<26}next: {}", "", next.replace('\n', "\n  ")),
    }
}
