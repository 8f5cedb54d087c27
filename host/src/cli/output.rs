//! Where words go: results to stdout, everything else to stderr.

use crate::error::Failure;
use env_logger::Env;
use env_logger::fmt::Formatter;
use log::Record;
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Version of every `--json` object.
const JSON_FORMAT: u32 = 1;

/// A result for a person. A reader that went away (`| head`) is no failure.
pub(super) fn result(text: &str) {
    let _ = writeln!(io::stdout().lock(), "{text}");
}

/// The one object of `--json`: the command's own fields behind its name.
pub(super) fn json(command: &str, fields: &impl Serialize) {
    #[derive(Serialize)]
    struct Object<'a, T> {
        format: u32,
        command: &'a str,
        #[serde(flatten)]
        fields: &'a T,
    }
    let object = Object { format: JSON_FORMAT, command, fields };
    let text = serde_json::to_string_pretty(&object).expect("plain numbers and texts");
    result(&text);
}

/// Writes a picture, a report or a program that was asked for.
pub(super) fn write(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|error| not_written(path, &error))
}

/// Why a file or folder that was asked for is not there.
pub(super) fn not_written(path: &Path, error: &io::Error) -> Failure {
    Failure::failed(format!("could not write {}: {error}", path.display()))
        .next("name one in a folder that exists and may be written to")
}

/// Set once, before the command begins.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From now on no progress is shown; warnings and errors still are.
pub(super) fn be_quiet() {
    QUIET.store(true, Ordering::Relaxed);
}

/// Was `--quiet` given?
pub(super) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// From now on what the library notes goes to stderr: as much as `-v` was given, or as RUST_LOG chooses.
pub(super) fn keep_a_log(verbosity: u8) {
    let usual = match verbosity {
        0 => "off",
        1 => "host=debug",
        _ => "host=trace",
    };
    let wanted = Env::default().default_filter_or(usual);
    let line = |out: &mut Formatter, note: &Record| writeln!(out, "{}: {}", note.target(), note.args());
    // A second logger would be refused; there is only this one.
    let _ = env_logger::Builder::from_env(wanted).format(line).try_init();
}

/// Progress and questions.
pub(super) fn say(text: &str) {
    if !is_quiet() {
        tell(text);
    }
}

fn tell(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// A heading within a result: bold where a person reads it.
pub(super) fn heading(text: &str) -> String {
    if io::stdout().is_terminal() && colours_are_welcome() { in_colour(text, BOLD) } else { text.to_owned() }
}

/// Is a person watching stderr?
pub(super) fn is_watched() -> bool {
    io::stderr().is_terminal()
}

/// What went wrong and what to do next.
pub(super) fn complain(failure: &Failure) {
    tell(&format!("{} {}", painted("error:", RED), failure.what()));
    if let Some(next) = failure.next_step() {
        tell(&format!("{} {next}", painted("next:", BOLD)));
    }
}

/// Something a person should know although there is a result.
pub(super) fn warn(text: &str) {
    tell(&format!("{} {text}", painted("note:", BOLD)));
}

const RED: &str = "1;31";
const BOLD: &str = "1";

/// In colour if a person watches stderr.
fn painted(text: &str, colour: &str) -> String {
    if is_watched() && colours_are_welcome() { in_colour(text, colour) } else { text.to_owned() }
}

fn in_colour(text: &str, colour: &str) -> String {
    format!("\x1b[{colour}m{text}\x1b[0m")
}

/// Unless NO_COLOR (no-color.org) is set.
fn colours_are_welcome() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}
