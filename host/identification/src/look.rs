//! What the bank says of swings ([`shared::bank`]): which physics a model lacks, as data for pages and as a sentence.

mod words;

pub use words::{at_first_look, of_reason, sentence};

use serde::Serialize;
use shared::bank::findings::{Findings, Reason, Suspect};

/// The bank looks at so many readings a second; faster ones are averaged.
pub const RATE_HZ: f64 = 250.0;

/// One number of a suspect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// The literature's symbol.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard deviation; `None` for a shape that was assumed.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
}

/// An effect that may be missing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// The effect.
    pub name: &'static str,
    /// Its numbers.
    pub values: Vec<Value>,
    /// The test's F.
    pub f: f64,
    /// How likely F is so large where the effect is absent.
    pub p: f64,
    /// In how many parts of the swings it was tested.
    pub windows: usize,
    /// Can't be told from the first one by these swings.
    pub tied: bool,
}

/// Who looked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Judge {
    /// The rig itself.
    Rig,
    /// This program, by what the rig sent.
    #[default]
    Program,
}

/// What a look says.
#[derive(Clone, Debug, Serialize)]
pub struct Look {
    /// What is missing: the first candidate, or nothing.
    pub named: Vec<&'static str>,
    /// The likeliest first.
    pub candidates: Vec<Candidate>,
    /// Why nothing is named.
    pub reason: Option<&'static str>,
    /// How many swings were looked at.
    pub swings: usize,
    /// How many there were; a rig's tape may have room for the last ones only.
    pub watched: usize,
    /// Noise of the readings as the bank takes them, rad.
    pub noise_rad: f64,
    /// Squares of the residuals over those of the noise, less one: by the model as the rig has it, and with its own
    /// numbers put right.
    pub excess: [f64; 2],
    /// The same with what is named in the model.
    pub left: Option<f64>,
    /// Who says so.
    pub judge: Judge,
}

impl Look {
    /// Are there too few swings yet to say anything?
    pub fn is_too_early(&self) -> bool {
        self.reason == Some(of_reason(Reason::TooFewSwings))
    }

    /// Is it not physics that is missing, but a fit of the numbers?
    pub fn asks_for_a_fit(&self) -> bool {
        let reasons = [Reason::WrongNumbers, Reason::FrictionAboutRest].map(of_reason);
        self.reason.is_some_and(|reason| reasons.contains(&reason))
    }
}

/// What was found in so many swings.
pub fn said(findings: &Findings<f64>, swings: usize) -> Look {
    Look {
        named: findings.named().take(1).map(|suspect| suspect.effect.name).collect(),
        candidates: findings.suspects.iter().map(|suspect| candidate(suspect, findings.n_clusters)).collect(),
        reason: findings.reason.map(of_reason),
        swings,
        watched: swings,
        noise_rad: findings.noise_rad,
        excess: findings.excess,
        left: findings.left,
        judge: Judge::Program,
    }
}

fn candidate(suspect: &Suspect<f64>, windows: usize) -> Candidate {
    let parameters = suspect.effect.parameters.iter().enumerate();
    let value = |(index, parameter): (usize, &shared::effect::Parameter)| {
        let place = suspect.strengths.iter().position(|strength| usize::from(*strength) == index);
        let std = place.map(|place| suspect.evidence.stds[place]);
        Value { name: parameter.symbol, value: suspect.values[index], std, unit: parameter.unit }
    };
    Candidate {
        name: suspect.effect.name,
        values: parameters.map(value).collect(),
        f: suspect.evidence.f,
        p: suspect.p,
        windows,
        tied: suspect.is_tied,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;
    use shared::bank::findings::look;
    use shared::bank::refit::Releases;
    use shared::model::Model;
    use shared::parameters::Parameters;

    /// What the bank finds in a swing with a drag that the model lacks.
    fn found() -> Findings<f64> {
        let mut truth = Parameters::paper();
        truth.set(10, &[2e-4]).unwrap();
        let (model, mut noise) = (Model::new(&truth), Noise::new(7));
        let mut state = model.release(1.4, 0.0);
        let mut reading = || {
            (0..4).for_each(|_| model.step(&mut state, 1e-3));
            state.angle_rad + 5e-4 * noise.normal()
        };
        let readings: Vec<f64> = (0..6250).map(|_| reading()).collect();
        look(&Parameters::paper(), &Releases::new(&[readings.as_slice()], 1.0 / RATE_HZ), 1e-3)
    }

    #[test]
    fn a_look_says_of_each_suspect_what_the_bank_found() {
        let findings = found();
        let told = said(&findings, 3);
        assert_eq!((told.named, told.swings, told.watched), (vec!["quadratic-drag"], 3, 3));
        // Put right, the rig's own numbers leave less.
        assert!(told.excess[0] > told.excess[1] && told.left.unwrap() < told.excess[1], "{:?}", told.excess);
        assert_eq!(told.candidates.len(), findings.suspects.len());
        for (candidate, suspect) in told.candidates.iter().zip(&findings.suspects) {
            assert_eq!((candidate.name, candidate.tied), (suspect.effect.name, suspect.is_tied));
            for (place, strength) in suspect.strengths.iter().enumerate() {
                let value = &candidate.values[usize::from(*strength)];
                assert_eq!(value.std, Some(suspect.evidence.stds[place]), "{candidate:?}");
            }
        }
        assert!(findings.suspects.iter().any(|suspect| suspect.strengths.len() > 1));
    }

    #[test]
    fn one_swing_that_says_nothing_is_no_news() {
        let mut told = said(&found(), 1);
        assert!(!told.is_too_early());
        told.reason = Some(of_reason(Reason::TooFewSwings));
        assert!(told.is_too_early());
    }

    #[test]
    fn wrong_numbers_and_friction_about_rest_ask_for_a_fit_and_nothing_else_does() {
        let mut told = said(&found(), 1);
        let mut asks = |reason| {
            told.reason = Some(of_reason(reason));
            told.asks_for_a_fit()
        };
        assert!(asks(Reason::WrongNumbers) && asks(Reason::FrictionAboutRest));
        assert!(
            ![Reason::TooFewSwings, Reason::NotThisPendulum, Reason::Unexplained, Reason::NothingMissing]
                .map(asks)
                .contains(&true)
        );
    }
}
