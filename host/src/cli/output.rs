//! Where words go: results to stdout, everything else to stderr.

use crate::error::Failure;
use serde::Serialize;
use std::io::{self, IsTerminal, Write};

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

/// Progress, warnings, questions.
pub(super) fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Is a person watching stderr?
pub(super) fn is_watched() -> bool {
    io::stderr().is_terminal()
}

/// What went wrong and what to do next.
pub(super) fn complain(failure: &Failure) {
    say(&format!("{} {}", painted("error:", RED), failure.what()));
    if let Some(next) = failure.next_step() {
        say(&format!("{} {next}", painted("next:", BOLD)));
    }
}

/// Something a person should know although there is a result.
pub(super) fn warn(text: &str) {
    say(&format!("{} {text}", painted("note:", BOLD)));
}

const RED: &str = "1;31";
const BOLD: &str = "1";

/// In colour on a terminal, unless NO_COLOR (no-color.org) is set.
fn painted(text: &str, colour: &str) -> String {
    let plain = !is_watched() || std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    if plain { text.to_owned() } else { format!("\x1b[{colour}m{text}\x1b[0m") }
}
