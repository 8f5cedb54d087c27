//! Claims in words: what is suspected, what was dropped and why, and on which parts of the swings one holds.

use crate::cli::table::wrapped;
use crate::diagnose::holds::ALPHA;
use crate::diagnose::{Diagnosis, Holding, Standing};

/// Why what stands beside a law that explains much more is not claimed.
const SLIGHT: &str = "by less than a tenth of what is claimed, whose own law may be as far from the truth";

/// Why what would have to be stronger than it can be is not claimed.
const OUT_OF_RANGE: &str =
    "only at the end of its range: these swings ask for more than it can be, or for something else";

/// Why what has no number that is known is not claimed.
const VAGUE: &str = "all its numbers are within their own errors, so that nobody knows by what";

/// The claim that would explain most of what is left, but is not proven.
pub(super) fn suspected(diagnosis: &Diagnosis, claim: &Holding) -> String {
    let (name, unit) = (claim.effect, diagnosis.measured.milli_unit());
    let why = match claim.standing {
        Standing::TooShort => {
            let windows = counted(claim.windows, "window of a few periods", "windows of a few periods");
            format!("there are only {windows} to check it on")
        }
        Standing::Slight => SLIGHT.to_owned(),
        Standing::OutOfRange => OUT_OF_RANGE.to_owned(),
        Standing::Vague => VAGUE.to_owned(),
        _ => format!(
            "a few periods carry it and the rest can't tell it from chance{}: a hand or a slip may look like this too",
            if may_be_chance(claim) { String::new() } else { chance(claim) }
        ),
    };
    let with = ["it", "both", "all"][claim.beside.len().min(2)];
    let adding: String = claim.beside.iter().chain([&name]).map(|name| format!(" --add {name}")).collect();
    let words = format!(
        "Likely, but not proven: {name}{}. With {with} the error would fall to {:.2} {unit}, but {why}. Record another release \
         and give both files; or take it as it is: host improve …{adding} -o rig.toml",
        beside(claim),
        1e3 * claim.rmse
    );
    wrapped(&words, 0)
}

/// Beside which other effects, that are not claimed either, it has its error.
fn beside(claim: &Holding) -> String {
    if claim.beside.is_empty() { String::new() } else { format!(" beside {}", claim.beside.join(" and ")) }
}

/// A claim that was dropped.
pub(super) fn unproven(claim: &Holding, unit: &str) -> String {
    let name = format!("{}{} (to {:.2} {unit})", claim.effect, beside(claim), 1e3 * claim.rmse);
    let words = match claim.standing {
        Standing::TooShort => format!(
            "Not claimed: {name}. It lowers the error, but there are only {} to check it on; a longer recording, or more \
             releases, can tell.",
            counted(claim.windows, "window of a few periods", "windows of a few periods")
        ),
        Standing::Slight => format!("Not claimed: {name}. It lowers the error, but {SLIGHT}."),
        Standing::OutOfRange => format!("Not claimed: {name}. It lowers the error, but {OUT_OF_RANGE}."),
        Standing::Vague => format!("Not claimed: {name}. It lowers the error, but {VAGUE}."),
        _ => format!(
            "Not claimed: {name}. It lowers the error, but not on every part of the swings: without a few periods it can't \
             be told from chance{}.",
            chance(claim)
        ),
    };
    wrapped(&words, 0)
}

fn counted(n: usize, one: &str, many: &str) -> String {
    if n == 1 { format!("1 {one}") } else { format!("{n} {many}") }
}

/// Would chance do as well, without the few periods that carry it, more often than one in twenty times? How often says nothing then.
fn may_be_chance(claim: &Holding) -> bool {
    claim.standing == Standing::Partly && claim.p_without_two.is_some_and(|p| p > CHANCE)
}

/// The usual level of a test.
const CHANCE: f64 = 0.05;

/// How likely chance does as well: small for this effect alone may be too much for all that were tried.
fn chance(claim: &Holding) -> String {
    match claim.p_without_two {
        Some(p) if p < ALPHA => format!(" among all that was tried (p = {} for this one alone)", probability(p)),
        Some(p) => format!(" (p = {})", probability(p)),
        None => String::new(),
    }
}

fn probability(p: f64) -> String {
    if p < 1e-2 { format!("{p:.0e}") } else { format!("{p:.2}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::{claim, diagnosis};

    #[test]
    fn chance_that_is_small_alone_may_be_too_much_for_all_that_was_tried() {
        let told = |p| chance(&claim(Standing::Partly, p));
        assert_eq!(told(Some(1e-4)), " among all that was tried (p = 1e-4 for this one alone)");
        assert_eq!(told(Some(0.2)), " (p = 0.20)");
        assert_eq!(told(None), "");
    }

    #[test]
    fn a_suspect_is_told_with_the_reason_why_it_is_not_claimed() {
        let why =
            |standing| suspected(&diagnosis(), &claim(standing, None)).split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(why(Standing::Slight).contains("fall to 2.00 mrad, but by less than a tenth of what is claimed"));
        assert!(why(Standing::OutOfRange).contains("but only at the end of its range"));
        assert!(why(Standing::TooShort).contains("but there are only 14 windows of a few periods to check it on"));
        assert!(why(Standing::Vague).contains("but all its numbers are within their own errors"));
        let partly = |p| suspected(&diagnosis(), &claim(Standing::Partly, Some(p))).replace('\n', " ");
        assert!(partly(0.04).contains("(p = 0.04)") && !partly(0.06).contains("p ="), "{}", partly(0.06));
        let dropped =
            |standing| unproven(&claim(standing, None), "mrad").split_whitespace().collect::<Vec<_>>().join(" ");
        let vague = "Not claimed: quadratic-drag (to 2.00 mrad). It lowers the error, but all its numbers are within";
        assert!(dropped(Standing::Vague).starts_with(vague), "{}", dropped(Standing::Vague));
    }

    #[test]
    fn an_error_that_takes_more_than_one_effect_is_told_with_all_of_them() {
        let beside = |names: &[&'static str]| Holding { beside: names.to_vec(), ..claim(Standing::Partly, None) };
        let suspect = suspected(&diagnosis(), &beside(&["detent"])).replace('\n', " ");
        assert!(suspect.contains("quadratic-drag beside detent. With both the error"), "{suspect}");
        assert!(suspect.contains("host improve … --add detent --add quadratic-drag -o"), "{suspect}");
        let three = suspected(&diagnosis(), &beside(&["detent", "stribeck"])).replace('\n', " ");
        assert!(three.contains("beside detent and stribeck. With all the error"), "{three}");
        let dropped = unproven(&beside(&["detent"]), "mrad").replace('\n', " ");
        assert!(dropped.starts_with("Not claimed: quadratic-drag beside detent (to 2.00 mrad)."), "{dropped}");
    }
}
