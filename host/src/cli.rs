//! The command line: one file a command, and the conventions they share.
//!
//! Results go to stdout, progress and questions to stderr. With `--json` stdout is exactly one object in SI units.
//! Exit codes: 0 a result was produced, whatever it says; 2 wrong use; 1 failed; 130 stopped by Ctrl-C.

mod calibrate;
mod columns;
mod compare;
mod comparison;
mod completions;
mod curve_words;
mod diagnose;
mod doctor;
mod effects;
mod evidence;
mod export;
mod fit;
mod given;
mod improve;
mod init;
mod interrupt;
mod output;
mod plan;
mod port;
mod pull;
mod push;
mod record;
mod restart;
mod rig;
mod serve;
mod simulate;
mod statistics;
mod study;
mod table;
mod undo;
mod update;
mod values;
mod watch;

use crate::error::Failure;
use crate::link;
use clap::{ArgAction, Parser, Subcommand};
use std::process::ExitCode;

/// The variable that says how many times longer than usual to wait for a rig.
const PATIENCE: &str = "RIG_PATIENCE";

/// Characters of a line of help at most.
const HELP_WIDTH: usize = 100;

/// What every command has stands in its help behind what is its own, and before --help.
const BEHIND_OTHERS: usize = 900;

/// Identify a pendulum's friction from a free swing, and write it back to the rig.
#[derive(Debug, Parser)]
#[command(name = "host", version, after_help = EXAMPLE, max_term_width = HELP_WIDTH, arg_required_else_help = true)]
pub struct Arguments {
    /// No progress on stderr; warnings and errors stay
    #[arg(short, long, global = true, display_order = BEHIND_OTHERS)]
    quiet: bool,
    /// Tell what is done on the way; twice tells more
    #[arg(short, long, global = true, display_order = BEHIND_OTHERS, action = ArgAction::Count, conflicts_with = "quiet")]
    verbose: u8,
    #[command(subcommand)]
    command: Command,
}

const EXAMPLE: &str = "\
Example:
  host fit --port sim                                    everything at once, without hardware
  host init --mass 0.147 --length 0.156 --inertia 0.00284 -o rig.toml
  host record --port /dev/ttyACM0 -o swing.csv           let the pendulum go when asked
  host fit swing.csv --rig rig.toml -o rig.toml
  host compare swing.csv --rig rig.toml --report report.html
  host diagnose swing*.csv --rig rig.toml                which physical effect is missing?
  host plan swing*.csv --rig rig.toml                    which experiment next?
  host push --rig rig.toml --port /dev/ttyACM0
  host serve --port sim                                  all of it in the browser

Ports are serial devices, sim (the simulated rig), or sim:NAME (one of its scenarios).
`host COMMAND --help` explains a command.

Exit codes: 0 there is a result, whatever it says; 2 wrong use; 1 failed; 130 stopped by Ctrl-C.
Results go to stdout, everything else to stderr. NO_COLOR switches colours off; RUST_LOG, such as
host::link=trace, chooses what -v tells; RIG_PATIENCE=20 waits 20 times longer for a rig.";

#[derive(Debug, Subcommand)]
enum Command {
    Init(init::Options),
    Record(record::Options),
    Watch(watch::Options),
    Fit(fit::Options),
    Compare(compare::Options),
    Diagnose(diagnose::Options),
    Improve(improve::Options),
    Plan(plan::Options),
    Study(study::Options),
    Effects(effects::Options),
    Doctor(doctor::Options),
    Calibrate(calibrate::Options),
    Push(push::Options),
    Pull(pull::Options),
    Undo(undo::Options),
    Statistics(statistics::Options),
    Restart(restart::Options),
    Update(update::Options),
    Simulate(simulate::Options),
    Serve(serve::Options),
    Export(export::Options),
    Completions(completions::Completions),
    Man(completions::Manual),
}

/// Reads the command line; on wrong use and for help the program ends here, as clap does it.
pub fn understand() -> Arguments {
    Arguments::parse()
}

/// Does what was asked.
///
/// # Errors
/// Whatever keeps the command from a result.
pub fn carry_out(arguments: Arguments) -> Result<(), Failure> {
    if arguments.quiet {
        output::be_quiet();
    }
    output::keep_a_log(arguments.verbose);
    take_patience()?;
    let done = run(arguments.command);
    // What was done is told first; a result that was not written is a failure all the same.
    done.and_then(|()| output::finish())
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Init(options) => init::run(&options),
        Command::Record(options) => record::run(&options),
        Command::Watch(options) => watch::run(&options),
        Command::Fit(options) => fit::run(&options),
        Command::Compare(options) => compare::run(&options),
        Command::Diagnose(options) => diagnose::run(&options),
        Command::Improve(options) => improve::run(&options),
        Command::Plan(options) => plan::run(&options),
        Command::Study(options) => study::run(&options),
        Command::Effects(options) => effects::run(&options),
        Command::Doctor(options) => doctor::run(&options),
        Command::Calibrate(options) => calibrate::run(&options),
        Command::Push(options) => push::run(&options),
        Command::Pull(options) => pull::run(&options),
        Command::Undo(options) => undo::run(&options),
        Command::Statistics(options) => statistics::run(&options),
        Command::Restart(options) => restart::run(&options),
        Command::Update(options) => update::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Serve(options) => serve::run(&options),
        Command::Export(options) => export::run(&options),
        Command::Completions(options) => {
            completions::completions(&options);
            Ok(())
        }
        Command::Man(options) => completions::manual(&options),
    }
}

fn take_patience() -> Result<(), Failure> {
    let Some(given) = std::env::var_os(PATIENCE) else { return Ok(()) };
    let factor = given.to_str().and_then(|text| text.parse().ok()).filter(|factor| link::FACTORS.contains(factor));
    let (least, most) = (link::FACTORS.start(), link::FACTORS.end());
    let what = || format!("{PATIENCE} is {given:?}; expected a number from {least} to {most}");
    let next = "unset it, or set it to how many times longer than usual to wait for the rig";
    link::be_patient(factor.ok_or_else(|| Failure::wrong_use(what()).next(next))?);
    Ok(())
}

/// Tells on stderr what went wrong and what to do next.
pub fn explain(failure: &Failure) -> ExitCode {
    output::complain(failure);
    ExitCode::from(failure.exit_code())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        Arguments::command().debug_assert();
    }

    /// A longer line would be broken in its middle, and a shorter one begin behind it.
    #[test]
    fn no_line_of_a_help_is_wider_than_the_help() {
        for command in Arguments::command().get_subcommands() {
            let text = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let widest = text.lines().max_by_key(|line| line.chars().count()).unwrap_or_default();
            assert!(widest.chars().count() <= HELP_WIDTH, "{}: {widest}", command.get_name());
        }
    }

    #[test]
    fn only_what_is_about_reading_stands_under_the_heading_of_reading() {
        const HEADING: Option<&str> = Some("Reading recordings");
        let mut n_commands = 0;
        for command in Arguments::command().get_subcommands() {
            let of_reading = command.get_arguments().filter(|argument| argument.get_help_heading() == HEADING);
            let names: Vec<&str> = of_reading.map(|argument| argument.get_id().as_str()).collect();
            n_commands += usize::from(!names.is_empty());
            let expected =
                ["columns", "degrees", "radians", "rate", "zero", "pivot", "mirror", "from", "to", "run"].as_slice();
            assert!(names.is_empty() || names == expected, "{}: {names:?}", command.get_name());
        }
        assert!(n_commands > 4, "{n_commands}");
    }
}
