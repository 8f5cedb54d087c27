//! What the rig itself found: its answer as a look, once it has looked.

use super::{Candidate, Judge, Look, Value, in_words};
use crate::link::{LinkError, Session, patient};
use shared::bank::chance::upper_tail;
use shared::effect::{Effect, Parameter};
use shared::wire::{Suspected, Suspects};
use std::time::Duration;

/// A board takes less than a minute to look at three long releases.
const PATIENCE: Duration = Duration::from_secs(180);

/// Between two questions.
const ASK_EVERY: Duration = Duration::from_millis(200);

/// Waits until the rig has looked more often than `n_before`. `None` if it does not: its firmware is older, or what it
/// saw was no release.
///
/// # Errors
/// As [`Session::ask`].
pub fn wait_for_look(session: &mut Session, n_before: u32) -> Result<Option<Look>, LinkError> {
    let give_up = session.elapsed() + patient(PATIENCE);
    while let Some(said) = session.suspects()? {
        if said.n_looks > n_before {
            return Ok(Some(look_of(&said)));
        }
        if !said.is_looking || session.elapsed() > give_up {
            break;
        }
        session.receive(ASK_EVERY)?;
    }
    Ok(None)
}

/// The rig's answer as a look. Effects that this program does not know are left out.
fn look_of(said: &Suspects) -> Look {
    let candidates: Vec<Candidate> = said.suspects.iter().filter_map(|one| candidate(one, said.n_clusters)).collect();
    Look {
        named: candidates.iter().take(usize::from(said.names())).map(|first| first.name).collect(),
        candidates,
        reason: said.reason.map(in_words),
        swings: usize::from(said.n_releases),
        noise_rad: f64::from(said.noise_rad),
        excess: said.excess.map(f64::from),
        left: said.left.map(f64::from),
        judge: Judge::Rig,
    }
}

fn candidate(suspected: &Suspected, n_clusters: u8) -> Option<Candidate> {
    let effect = Effect::<f64>::by_id(suspected.effect)?;
    let numbers = suspected.values.iter().zip(&suspected.stds);
    let value = |(parameter, (value, std)): (&Parameter, (&f32, &Option<f32>))| Value {
        name: parameter.symbol,
        value: f64::from(*value),
        std: std.map(f64::from),
        unit: parameter.unit,
    };
    let n_tested = usize::from(suspected.n_tested);
    let n_spare = usize::from(n_clusters).saturating_sub(n_tested).max(1);
    Some(Candidate {
        name: effect.name,
        values: effect.parameters.iter().zip(numbers).map(value).collect(),
        f: f64::from(suspected.f),
        p: upper_tail(f64::from(suspected.f), n_tested, n_spare),
        windows: usize::from(n_clusters),
        tied: suspected.is_tied,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An unknown effect has no name here, and no answer of a rig makes a division by nothing.
    #[test]
    fn whatever_a_rig_says_becomes_a_look() {
        let known = Suspected {
            effect: 10,
            values: [1e-4].into_iter().collect(),
            stds: [Some(2e-6)].into_iter().collect(),
            f: 900.0,
            n_tested: 1,
            is_tied: false,
        };
        let unknown = Suspected { effect: 9999, ..known.clone() };
        let said = |suspects: &[&Suspected], n_clusters| Suspects {
            reason: None,
            n_clusters,
            suspects: suspects.iter().map(|one| (*one).clone()).collect(),
            ..Suspects::none()
        };
        let look = look_of(&said(&[&known, &unknown], 14));
        assert_eq!((look.named.as_slice(), look.candidates.len()), (&["quadratic-drag"][..], 1));
        assert!(look.candidates[0].p < 1e-9 && look.candidates[0].values[0].std.is_some());
        let nonsense = look_of(&said(&[&Suspected { n_tested: 0, f: f32::NAN, ..known.clone() }], 0));
        assert_eq!(nonsense.candidates.len(), 1);
        assert!(look_of(&said(&[], 14)).named.is_empty());
        assert_eq!(look_of(&Suspects::none()).reason, Some(in_words(shared::bank::findings::Reason::TooFewSwings)));
    }
}
