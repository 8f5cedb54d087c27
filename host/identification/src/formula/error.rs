//! What is wrong with a formula, and where.

use std::fmt;
use std::ops::Range;

/// A formula that can't be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    /// What is wrong, and what was expected.
    pub problem: String,
    /// The formula.
    pub text: String,
    /// The place, in characters of the text; `None` if it is the whole.
    pub place: Option<Range<usize>>,
}

impl FormulaError {
    /// A problem at some bytes of the text.
    pub(super) fn at(text: &str, bytes: Range<usize>, problem: impl Into<String>) -> Self {
        let characters = |end: usize| text.char_indices().take_while(|(at, _)| *at < end).count();
        let start = characters(bytes.start);
        let end = characters(bytes.end).max(start + 1);
        Self { problem: problem.into(), text: text.to_owned(), place: Some(start..end) }
    }

    /// A problem with all of it.
    pub(super) fn whole(text: &str, problem: impl Into<String>) -> Self {
        Self { problem: problem.into(), text: text.to_owned(), place: None }
    }
}

impl fmt::Display for FormulaError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}\n  {}", self.problem, self.text)?;
        match &self.place {
            None => Ok(()),
            Some(place) => write!(out, "\n  {}{}", " ".repeat(place.start), "^".repeat(place.len())),
        }
    }
}

impl std::error::Error for FormulaError {}
