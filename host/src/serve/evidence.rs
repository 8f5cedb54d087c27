//! What the page shows of the evidence that grows while the pendulum swings.

use crate::error::Failure;
use crate::look::{Candidate, Judge, Look, sentence};
use crate::record::Stage;
use serde::Serialize;

/// What the bank, or the rig itself, says of the rig's model; and what goes on meanwhile.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Evidence {
    /// What is waited for, or what the pendulum does.
    stage: Option<Stage>,
    /// Does the rig look by itself, and so has the last word?
    pub(super) rig_looks_by_itself: bool,
    /// Is the rig to be asked what it found?
    pub(super) is_rig_due: bool,
    /// Who judged, what, and in which words.
    judge: Option<Judge>,
    sentence: Option<String>,
    /// First of those that stand in `candidates`, or none.
    named: Vec<&'static str>,
    /// The likeliest first.
    candidates: Vec<Candidate>,
    /// Is a fit of the numbers what is missing?
    asks_for_a_fit: bool,
    /// What kept a swing from being judged, and what to do.
    trouble: Option<(String, Option<String>)>,
}

impl Evidence {
    /// Before anything was seen of a rig; one that looks by itself may have looked before.
    pub(super) fn of_rig(rig_looks_by_itself: bool) -> Self {
        Self { rig_looks_by_itself, ..Self::default() }
    }

    /// Somebody has looked.
    pub(super) fn show(&mut self, look: &Look) {
        self.judge = Some(look.judge);
        self.sentence = Some(sentence(look));
        self.named.clone_from(&look.named);
        self.candidates.clone_from(&look.candidates);
        self.asks_for_a_fit = look.asks_for_a_fit();
        self.trouble = None;
    }

    /// What was found is of another model.
    pub(super) fn forget(&mut self) {
        let Self { stage, is_rig_due, rig_looks_by_itself, .. } = *self;
        *self = Self { stage, is_rig_due, ..Self::of_rig(rig_looks_by_itself) };
    }

    /// What the pendulum does now, or what is waited for.
    pub(super) fn goes_on(&mut self, stage: Option<Stage>) {
        self.stage = stage;
        if stage == Some(Stage::Waiting) {
            self.trouble = None;
        }
    }

    /// A swing can't be judged.
    pub(super) fn fails(&mut self, failure: &Failure) {
        self.trouble = Some((failure.what().to_owned(), failure.next_step().map(str::to_owned)));
    }
}
