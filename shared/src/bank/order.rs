//! A look as a board does it: what it is asked to look at, and what it answers.

use super::findings::{Findings, Room, Suspect};
use super::refit::{MAX_RELEASES, Releases};
use super::tape::{Span, Tape, Taped};
use crate::parameters::Parameters;
use crate::wire::{MAX_SUSPECTS, Suspected, Suspects};
use heapless::Vec;

/// Of the looks at swings that lack nothing, so many may accuse.
pub const ERROR_A_LOOK: f32 = 1e-3;

/// A look to be done.
#[derive(Clone, Debug)]
pub struct Order {
    /// The model.
    pub parameters: Parameters<f32>,
    /// What a step on the tape is, rad.
    pub radian_per_step: f32,
    /// Between two of them, s.
    pub interval_s: f32,
    /// The releases, the last one last.
    pub releases: Vec<Span, MAX_RELEASES>,
}

impl Order {
    /// Looks, in this room. `None` if the releases were written over meanwhile.
    pub fn carry_out(&self, tape: &Tape, room: &mut Room<f32>) -> Option<Suspects> {
        let taped: Vec<Taped, MAX_RELEASES> =
            self.releases.iter().map(|span| tape.read(*span, self.radian_per_step)).collect();
        let parts: Vec<&Taped, MAX_RELEASES> = taped.iter().collect();
        room.look(&self.parameters, &Releases::new(&parts, self.interval_s), ERROR_A_LOOK);
        self.releases.iter().all(|span| tape.still_has(*span)).then(|| self.said(&room.findings))
    }

    fn said(&self, findings: &Findings<f32>) -> Suspects {
        Suspects {
            n_releases: self.releases.len() as u8,
            n_windows: findings.n_windows as u16,
            n_clusters: findings.n_clusters as u8,
            noise_rad: findings.noise_rad,
            excess: findings.excess,
            left: findings.left,
            reason: findings.reason,
            suspects: findings.suspects.iter().take(MAX_SUSPECTS).map(suspected).collect(),
            ..Suspects::none()
        }
    }
}

fn suspected(suspect: &Suspect<f32>) -> Suspected {
    let n_values = suspect.effect.parameters.len();
    let std = |index: usize| {
        let place = suspect.strengths.iter().position(|strength| usize::from(*strength) == index)?;
        Some(suspect.evidence.stds[place])
    };
    Suspected {
        effect: suspect.effect.id,
        values: suspect.values.iter().take(n_values).copied().collect(),
        stds: (0..n_values).map(std).collect(),
        f: suspect.evidence.f,
        n_tested: suspect.evidence.n_tested as u8,
        is_tied: suspect.is_tied,
    }
}
