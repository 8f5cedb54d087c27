//! The fields of `diagnose --json`.

use crate::diagnose::Diagnosis;
use serde::Serialize;

/// A diagnosis with the recordings it is of.
#[derive(Serialize)]
pub struct Fields<'a> {
    /// Their names.
    pub recordings: &'a [String],
    /// What was found.
    #[serde(flatten)]
    pub diagnosis: &'a Diagnosis,
}
