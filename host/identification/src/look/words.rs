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
            "with no friction and inertia does the rig's model follow these swings: check mass, length and calibration"
        }
        Reason::WrongNumbers => "numbers are wrong, no physics is missing: fit the model and push it",
        Reason::FrictionAboutRest => {
            "friction about rest is not as the model has it, which may look like other effects: fit the model and push it"
        }
        Reason::Unexplained => "more than noise is left, but no effect explains it on every part of the swings",
        Reason::NothingMissing => "nothing is missing: the model follows to the noise",
    }
}

/// What a look says, for a person.
pub fn sentence(look: &Look) -> String {
    let Some(first) = named(look) else {
        let reason = look.reason.unwrap_or_default();
        return format!("Nothing is named after {}: {reason}.", releases(look.swings));
    };
    let tied = match tied(look).as_slice() {
        [] => String::new(),
        names => format!(" These swings can't tell it from {}.", names.join(" or ")),
    };
    let more = if look.left.is_some_and(|left| left > MORE) { " More than noise is left with it." } else { "" };
    let who = if look.judge == Judge::Rig { "The rig itself names what is missing" } else { "Missing" };
    format!("{who}: {} ({}), after {}.{tied}{more}", first.name, numbers(first), releases(look.swings))
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

fn releases(n: usize) -> String {
    if n == 1 { "one release".to_owned() } else { format!("{n} releases") }
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
