//! Where words go: results to stdout, everything else to stderr.

use crate::error::Failure;
use crate::files::{self, Existing, FileError};
use crate::operations::json;
use env_logger::Env;
use env_logger::fmt::Formatter;
use log::Record;
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// What went wrong with stdout, told when the command is through.
static LOST: Mutex<Option<String>> = Mutex::new(None);

/// A result for a person.
pub(super) fn result(text: &str) {
    let mut stdout = io::stdout().lock();
    keep_error(writeln!(stdout, "{text}").and_then(|()| stdout.flush()));
}

/// A reader that went away (`| head`) is no failure; a full disk is.
fn keep_error(written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        lose(&error.to_string());
    }
}

fn lose(why: &str) {
    LOST.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_with(|| why.to_owned());
}

/// Did every result reach stdout?
pub(super) fn finish() -> Result<(), Failure> {
    let lost = LOST.lock().unwrap_or_else(PoisonError::into_inner).take();
    match lost {
        None => Ok(()),
        Some(why) => Err(Failure::failed(format!("could not write the result to standard output: {why}"))
            .next("send it to a file on a disk with space; files that were asked for are written")),
    }
}

/// The one object of `--json`: the command's own fields behind its name.
pub(super) fn json(command: &str, fields: &impl Serialize) {
    match json::text(command, fields) {
        Ok(text) => result(&text),
        Err(error) => lose(&error.to_string()),
    }
}

/// A path in a `--json` object; what is not UTF-8 in it stands there as �.
pub(super) fn lossy<S: Serializer>(path: &impl AsRef<Path>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.as_ref().display())
}

/// Writes a picture, a report or a program that was asked for; replaces a file with `force` only.
pub(super) fn write(path: &Path, text: &str, force: bool) -> Result<(), Failure> {
    Ok(files::write(path, text, Existing::forced(force))?)
}

/// May these files be written by a command that reads those, and can they be? Asked before anything is computed.
pub(super) fn check(writes: &[&Path], reads: &[&Path], force: bool) -> Result<(), Failure> {
    Ok(files::check(writes, reads, Existing::forced(force))?)
}

/// Can a folder for pictures be made, and written to? Asked before anything is computed.
pub(super) fn check_folder(path: &Path) -> Result<(), Failure> {
    Ok(files::check_folder(path)?)
}

/// Makes a folder for pictures or pages that were asked for.
pub(super) fn make_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|source| FileError::Io { path: path.to_owned(), source }.into())
}

/// A command line for a person to copy, its words quoted where a shell would take them apart.
pub(super) fn command(words: &[&str]) -> String {
    words.iter().map(|word| shlex::try_quote(word).unwrap_or(Cow::Borrowed(word))).collect::<Vec<_>>().join(" ")
}

/// A file in such a line; one whose name begins with a dash is not taken for an option.
pub(super) fn file(path: &Path) -> String {
    command(&[&file_word(path)])
}

fn file_word(path: &Path) -> String {
    let name = path.to_string_lossy();
    if name.starts_with('-') { format!("./{name}") } else { name.into_owned() }
}

/// Recordings in such a line; of many only the first, and their number.
pub(super) fn recordings(paths: &[PathBuf]) -> String {
    let names: Vec<_> = paths.iter().map(|path| file_word(path)).collect();
    let words: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    match words.len() {
        n if n > MOST_NAMED => format!("{} … (the same {n} recordings)", command(&words[..1])),
        _ => command(&words),
    }
}

/// More recordings than so many are counted in a line to copy.
const MOST_NAMED: usize = 8;

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
        1 => "host=debug,identification=debug,recording=debug",
        _ => "host=trace,identification=trace,recording=trace",
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
