//! Why the program could not do what was asked: what happened, and what to do next.
//!
//! The parts of the library have errors of their own; the program turns each into a [`Failure`] at the file or port
//! it belongs to. The hint stays apart from the error, so that messages can be compared and hints improved.

use crate::files::FileError;
use std::fmt;

/// Exit code of a program that was interrupted: 128 + SIGINT.
pub const INTERRUPTED: u8 = 130;

/// Whose mistake it is decides the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The command line cannot be meant like this: exit code 2.
    WrongUse,
    /// It was meant well and did not work: exit code 1.
    Failed,
    /// Ctrl-C came before there was a result: exit code 130.
    Interrupted,
}

/// What the program says before it ends without a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    kind: Kind,
    what: String,
    next: Option<String>,
}

impl Failure {
    /// It did not work: exit code 1.
    pub fn failed(what: impl fmt::Display) -> Self {
        Self { kind: Kind::Failed, what: what.to_string(), next: None }
    }

    /// The command line cannot be meant like this: exit code 2.
    pub fn wrong_use(what: impl fmt::Display) -> Self {
        Self { kind: Kind::WrongUse, ..Self::failed(what) }
    }

    /// Ctrl-C came before there was a result: exit code 130.
    pub fn interrupted(what: impl fmt::Display) -> Self {
        Self { kind: Kind::Interrupted, ..Self::failed(what) }
    }

    /// Adds what to do next.
    pub fn next(self, hint: impl fmt::Display) -> Self {
        Self { next: Some(hint.to_string()), ..self }
    }

    /// 2 for wrong use, 130 after Ctrl-C as in other programs (128 + SIGINT), 1 otherwise; 0 is for results.
    pub fn exit_code(&self) -> u8 {
        match self.kind {
            Kind::WrongUse => 2,
            Kind::Failed => 1,
            Kind::Interrupted => INTERRUPTED,
        }
    }

    /// What happened.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// What to do next.
    pub fn next_step(&self) -> Option<&str> {
        self.next.as_deref()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.what)?;
        self.next.as_ref().map_or(Ok(()), |next| write!(out, "\nnext: {next}"))
    }
}

impl std::error::Error for Failure {}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        let failure = match error {
            FileError::Io { .. } => Self::failed(&error),
            _ => Self::wrong_use(&error),
        };
        failure.next(error.next_step())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hint_follows_on_a_line_of_its_own() {
        let failure = Failure::wrong_use("the mass is -1 kg").next("give a positive mass");
        assert_eq!(failure.to_string(), "the mass is -1 kg\nnext: give a positive mass");
        assert_eq!(failure.exit_code(), 2);
        assert_eq!(Failure::failed("no").exit_code(), 1);
        assert_eq!(Failure::interrupted("stopped").exit_code(), 130);
    }
}
