//! Readings that nobody took and those that jump out of the swing and back become gaps.

use super::{Samples, keep};
use crate::stuck::{self, What};
use crate::{frozen, rails, spikes, straight, trail};
use std::borrow::Cow;

/// What was found by one look at the samples and their times (s): in words, and which samples are to be left out.
type Found = Option<(String, Vec<bool>)>;

impl Samples {
    /// Looks for all of them, one after the other; of several axes none is looked at before one is chosen.
    pub(in super::super) fn leave_out_losses(&mut self, times_s: &mut Vec<f64>, notes: &mut Vec<String>) {
        if self.readings.len() > 2 || times_s.len() != self.len() {
            return;
        }
        let looks: [fn(&Self, &[f64]) -> Found; 6] =
            [Self::trail, Self::drawn_lines, Self::ends_of_track, Self::standstill, Self::frozen, Self::spikes];
        for look in looks {
            if let Some((note, which)) = look(self, times_s) {
                notes.push(note);
                self.leave_out(times_s, &which);
            }
        }
    }

    fn trail(&self, times_s: &[f64]) -> Found {
        let first = trail::trail(times_s, &self.lists())?;
        Some((trail::note(first, times_s), (0..times_s.len()).map(|idx| idx >= first).collect()))
    }

    fn drawn_lines(&self, times_s: &[f64]) -> Found {
        let is_drawn = straight::drawn(times_s, &self.lists());
        Some((straight::note(&is_drawn, times_s)?, is_drawn))
    }

    fn ends_of_track(&self, times_s: &[f64]) -> Found {
        let is_rail = rails::rails(times_s, &self.first());
        Some((rails::note(&is_rail, &self.first(), times_s)?, is_rail))
    }

    fn standstill(&self, times_s: &[f64]) -> Found {
        let found = stuck::standstill(times_s, &self.first())?;
        let is_stuck = |idx| found.what == What::Stuck && idx > found.first;
        Some((stuck::note(&found, times_s), (0..times_s.len()).map(is_stuck).collect()))
    }

    fn frozen(&self, times_s: &[f64]) -> Found {
        let is_frozen = frozen::frozen(times_s, &self.first());
        Some((frozen::note(&is_frozen, times_s)?, is_frozen))
    }

    /// Of a point x tells: y is level where the pendulum hangs, and stands there in steps.
    fn spikes(&self, times_s: &[f64]) -> Found {
        let is_spike = spikes::spikes(times_s, &self.first());
        Some((spikes::note(&is_spike, times_s)?, is_spike))
    }

    fn lists(&self) -> Vec<&[f64]> {
        self.readings.iter().map(Vec::as_slice).collect()
    }

    /// The first list of readings, or else the codes of a converter.
    fn first(&self) -> Cow<'_, [f64]> {
        match self.readings.first() {
            Some(readings) => Cow::Borrowed(readings),
            None => self.codes.iter().map(|code| f64::from(*code)).collect(),
        }
    }

    fn leave_out(&mut self, times_s: &mut Vec<f64>, which: &[bool]) {
        let kept: Vec<bool> = which.iter().map(|is_out| !is_out).collect();
        keep(times_s, &kept);
        self.keep(&kept);
    }
}
