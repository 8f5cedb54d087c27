//! What a look says, in words.

use super::{Candidate, Judge, Look, Value};
use crate::number::{significant, with_spread};
use shared::bank::findings::Reason;

/// From this share of the noise's squares on, more than noise is left.
const MORE: f64 = 0.1;

/// The words for why nothing is named.
pub fn of_reason(reason: Reason) -> &'static str {
    match reason {
        Reason::TooFewSwings => "too few swings yet: let it go again, from a large angle",
        Reason::NotThisPendulum => {
            "no friction and inertia make the rig's model follow these swings: check mass, length and calibration"
        }
        Reason::WrongNumbers => "numbers are wrong, and these swings show nothing else: fit the model and push it",
        Reason::FrictionAboutRest => {
            "friction about rest is not as the model has it, which may look like other effects: fit the model and push it"
        }
        Reason::Unexplained => "more than noise is left, but no effect explains it on every part of the swings",
        Reason::NothingMissing => "nothing is missing in these swings: the model follows to the noise",
    }
}

/// What a look says, for a person.
pub fn sentence(look: &Look) -> String {
    let Some(first) = named(look) else {
        let reason = look.reason.unwrap_or_default();
        return format!("Nothing is named after {}: {reason}.", releases(look));
    };
    let tied = match tied(look).as_slice() {
        [] => String::new(),
        names => format!(" These swings can't tell it from {}.", names.join(" or ")),
    };
    let more = if look.left.is_some_and(|left| left > MORE) { " More than noise is left with it." } else { "" };
    let who = if look.judge == Judge::Rig { "The rig itself names what is missing" } else { "Missing" };
    format!("{who}: {} ({}), after {}.{tied}{more}", first.name, numbers(first), releases(look))
}

/// The same in short, where the thorough answer follows.
pub fn at_first_look(look: &Look) -> String {
    let Some(first) = named(look) else {
        return look.reason.unwrap_or("nothing").to_owned();
    };
    let names: Vec<&str> = [first.name].into_iter().chain(tied(look)).collect();
    format!("missing is {}", names.join(" or "))
}

fn named(look: &Look) -> Option<&Candidate> {
    look.candidates.first().filter(|_| !look.named.is_empty())
}

/// What these swings can't tell from the first suspect.
fn tied(look: &Look) -> Vec<&'static str> {
    look.candidates.iter().skip(1).filter(|other| other.tied).map(|other| other.name).collect()
}

/// The releases that were looked at, and of how many, where a rig's tape had no room for all.
fn releases(look: &Look) -> String {
    let n = |n: usize| if n == 1 { "one release".to_owned() } else { format!("{n} releases") };
    match look.swings {
        swings if swings < look.watched => format!("{}, of which the rig keeps the last {swings}", n(look.watched)),
        swings => n(swings),
    }
}

/// A suspect's numbers with their ±.
fn numbers(candidate: &Candidate) -> String {
    let number = |value: &Value| {
        let unit = if value.unit == "1" { String::new() } else { format!(" {}", value.unit) };
        match value.std {
            Some(std) => format!("{} = {}{unit}", value.name, with_spread(value.value, Some(std))),
            None => format!("{} about {}{unit}", value.name, significant(value.value, 2)),
        }
    };
    candidate.values.iter().map(number).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(swings: usize, watched: usize, reason: Reason) -> Look {
        let (named, candidates, excess) = (Vec::new(), Vec::new(), [0.0; 2]);
        let reason = Some(of_reason(reason));
        Look { named, candidates, reason, swings, watched, noise_rad: 1e-4, excess, left: None, judge: Judge::Rig }
    }

    #[test]
    fn releases_are_counted_as_they_were_let_go() {
        let told = |swings, watched| sentence(&look(swings, watched, Reason::Unexplained));
        assert!(told(1, 1).starts_with("Nothing is named after one release: "), "{}", told(1, 1));
        assert!(told(3, 3).starts_with("Nothing is named after 3 releases: "), "{}", told(3, 3));
        let five = told(3, 5);
        assert!(five.starts_with("Nothing is named after 5 releases, of which the rig keeps the last 3: "), "{five}");
    }

    /// Friction that drifts between releases looks like wrong numbers while there is one release.
    #[test]
    fn wrong_numbers_are_no_proof_that_no_physics_is_missing() {
        let told = sentence(&look(1, 1, Reason::WrongNumbers));
        assert!(told.contains("numbers are wrong") && !told.contains("no physics is missing"), "{told}");
    }

    fn suspect(name: &'static str, tied: bool) -> Candidate {
        let value = |name, value, std, unit| Value { name, value, std, unit };
        let values = vec![value("k", 2.5e-4, Some(1e-5), "N·m"), value("p", -1.5, None, "1")];
        Candidate { name, values, f: 50.0, p: 1e-9, windows: 12, tied }
    }

    /// A look that names the first of three, of which the last is tied to it.
    fn naming(judge: Judge, left: f64) -> Look {
        let candidates =
            vec![suspect("quadratic-drag", false), suspect("eddy-brake", false), suspect("power-law-drag", true)];
        let look = look(2, 2, Reason::Unexplained);
        Look { named: vec!["quadratic-drag"], candidates, reason: None, left: Some(left), judge, ..look }
    }

    #[test]
    fn what_is_named_is_told_with_its_numbers_what_it_is_tied_to_and_who_says_so() {
        let numbers = "quadratic-drag (k = (2.50 ± 0.10)e-4 N·m, p about -1.5), after 2 releases.";
        let tied = " These swings can't tell it from power-law-drag.";
        assert_eq!(sentence(&naming(Judge::Program, 0.0)), format!("Missing: {numbers}{tied}"));
        let rig = format!("The rig itself names what is missing: {numbers}{tied} More than noise is left with it.");
        assert_eq!(sentence(&naming(Judge::Rig, 0.2)), rig);
        assert_eq!(at_first_look(&naming(Judge::Program, 0.0)), "missing is quadratic-drag or power-law-drag");
    }

    #[test]
    fn every_reason_has_words_of_its_own() {
        let told = |reason| at_first_look(&look(1, 1, reason));
        assert!(told(Reason::TooFewSwings).contains("let it go again"));
        assert!(told(Reason::NotThisPendulum).contains("check mass, length and calibration"));
        assert!(told(Reason::WrongNumbers).starts_with("numbers are wrong"));
        assert!(told(Reason::FrictionAboutRest).starts_with("friction about rest"));
        assert!(told(Reason::Unexplained).contains("no effect explains it"));
        assert!(told(Reason::NothingMissing).starts_with("nothing is missing"));
    }
}
