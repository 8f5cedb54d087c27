//! The fields of `diagnose --json`.

use super::json::Doubt;
use crate::diagnose::Diagnosis;
use serde::Serialize;

/// A diagnosis with the recordings it is of.
#[derive(Serialize)]
pub struct Fields<'a> {
    /// Their names.
    pub recordings: &'a [String],
    /// What speaks against them.
    pub doubts: Vec<Doubt<'a>>,
    /// What was found.
    #[serde(flatten)]
    pub diagnosis: &'a Diagnosis,
}
