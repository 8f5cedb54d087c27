//! What the rig itself found: its answer as a look, once it has looked.

use crate::link::{LinkError, Session, patient};
use crate::look::of_reason;
use crate::look::{Candidate, Judge, Look, Value};
use shared::bank::chance::upper_tail;
use shared::effect::{Effect, Parameter};
use shared::wire::{Suspected, Suspects};
use std::time::Duration;

/// A board takes less than a minute to look at three long releases.
const PATIENCE: Duration = Duration::from_secs(180);

/// Between two questions.
const ASK_EVERY: Duration = Duration::from_millis(200);

/// The looks that a rig makes by itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct OwnLooks {
    /// How many there were when it was last asked; none if it does not look.
    n_known: Option<u32>,
}

/// What a rig says when it is asked whether it has looked.
#[derive(Debug)]
pub enum Asked {
    /// Not yet: it looks, or is about to.
    Looking,
    /// It has.
    Looked(Box<Look>),
    /// It does not: its firmware is older, or what it saw was no release.
    Nothing,
}

impl OwnLooks {
    /// Those of the rig behind a session, so far.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn of(session: &mut Session) -> Result<Self, LinkError> {
        Ok(Self::with_last(session)?.0)
    }

    /// The same, with what it found last, if it has looked at all.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn with_last(session: &mut Session) -> Result<(Self, Option<Look>), LinkError> {
        let said = session.suspects()?;
        let last = said.as_ref().filter(|said| said.n_looks > 0 && said.n_releases > 0).map(look_of);
        Ok((Self { n_known: said.map(|said| said.n_looks) }, last))
    }

    /// Does the rig look by itself?
    pub fn are_made(self) -> bool {
        self.n_known.is_some()
    }

    /// Has it looked since it was last asked?
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn ask(&mut self, session: &mut Session) -> Result<Asked, LinkError> {
        let Some(n_known) = self.n_known else { return Ok(Asked::Nothing) };
        let Some(said) = session.suspects()? else { return Ok(Asked::Nothing) };
        // What it has found while it goes on looking is of the releases before.
        if said.is_looking {
            return Ok(Asked::Looking);
        }
        self.n_known = Some(said.n_looks);
        Ok(if said.n_looks > n_known { Asked::Looked(Box::new(look_of(&said))) } else { Asked::Nothing })
    }

    /// Waits for the look that the last release is due.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn wait(&mut self, session: &mut Session) -> Result<Option<Look>, LinkError> {
        let give_up = session.elapsed() + patient(PATIENCE);
        loop {
            match self.ask(session)? {
                Asked::Looked(look) => return Ok(Some(*look)),
                Asked::Looking if session.elapsed() < give_up => {}
                Asked::Looking | Asked::Nothing => return Ok(None),
            }
            session.receive(ASK_EVERY)?;
        }
    }
}

/// The rig's answer as a look. Effects that this program does not know are left out.
fn look_of(said: &Suspects) -> Look {
    let candidates: Vec<Candidate> = said.suspects.iter().filter_map(|one| candidate(one, said.n_clusters)).collect();
    Look {
        named: candidates.iter().take(usize::from(said.names())).map(|first| first.name).collect(),
        candidates,
        reason: said.reason.map(of_reason),
        swings: usize::from(said.n_releases),
        watched: usize::from(said.n_releases),
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
        // Of fourteen parts one tells the number.
        let weak = Suspected { f: 4.0, is_tied: true, ..known.clone() };
        let second = &look_of(&Suspects { noise_rad: 2e-3, ..said(&[&known, &weak], 14) });
        assert_eq!((second.candidates[0].tied, second.candidates[1].tied), (false, true));
        // F of 1 and 13 degrees of freedom exceeds 4.667 with 5 % (tables).
        let five = look_of(&said(&[&Suspected { f: 4.667, ..known.clone() }], 14)).candidates[0].p;
        assert!((five - 0.05).abs() < 1e-4, "{five}");
        assert!((second.noise_rad - 2e-3).abs() < 1e-9, "{}", second.noise_rad);
        let nonsense = look_of(&said(&[&Suspected { n_tested: 0, f: f32::NAN, ..known.clone() }], 0));
        assert_eq!(nonsense.candidates.len(), 1);
        assert!(look_of(&said(&[], 14)).named.is_empty());
        assert_eq!(look_of(&Suspects::none()).reason, Some(of_reason(shared::bank::findings::Reason::TooFewSwings)));
    }
}
