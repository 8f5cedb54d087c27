//! A diagnosis in words and tables: what is missing, how sure that is, and what it gains.

mod before;
mod claims;

use self::claims::{suspected, unproven};
use super::curve_words;
use super::table::wrapped;
use crate::diagnose::value::BASE_TITLE;
use crate::diagnose::zero::PUT_RIGHT;
use crate::diagnose::{Candidate, Diagnosis, NotTried, Standing, Step, Suggestion, Value};
use crate::fit::identify::Carries;
use crate::formula::effect_of;
use crate::geometry::{PER_GRAVITY, is_unknown, unit_of};
use crate::number::{angle, noises, with_spread};
use crate::plot::staircase::Tread;
use crate::verdict::{Left, far_below, is_far_below_noise};
use shared::effect::Effect;
use shared::motion::Pendulum;

/// For what no effect explains.
const HINT: &str = "With --formulas small formulas are searched for what remains; that takes up to a minute.";

/// The whole diagnosis for a person.
pub(super) fn in_words(diagnosis: &Diagnosis) -> String {
    let mut parts = said(diagnosis);
    parts.extend(diagnosis.verdict.iter().filter_map(|name| claimed(diagnosis, name)));
    parts.extend(doubts(diagnosis));
    if diagnosis.verdict.is_empty() && !diagnosis.unexplained {
        return parts.join("\n\n");
    }
    parts.extend(diagnosis.curve.as_ref().map(|curve| curve_words::in_words(diagnosis, curve)));
    parts.extend(diagnosis.of_state.as_ref().map(|split| wrapped(&split.words, 0)));
    parts.extend(left_out(diagnosis));
    parts.extend(formulas(diagnosis));
    parts.push(staircase(diagnosis));
    parts.extend(ranking(diagnosis));
    parts.join("\n\n")
}

/// What is missing, and what speaks against each claim, a sentence or a few each, not broken into lines.
pub(super) fn sentences(diagnosis: &Diagnosis) -> Vec<String> {
    let mut parts = [said(diagnosis), doubts(diagnosis)].concat();
    parts.extend(diagnosis.of_state.as_ref().map(|split| split.words.clone()));
    parts.extend(left_out(diagnosis));
    parts.iter().map(|part| part.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

/// What is missing, or likely missing.
fn said(diagnosis: &Diagnosis) -> Vec<String> {
    let mut parts = before::in_words(diagnosis);
    if diagnosis.follows || diagnosis.unexplained || !diagnosis.verdict.is_empty() {
        parts.push(verdict(diagnosis));
    }
    parts.extend(diagnosis.levels.as_ref().map(|levels| wrapped(&format!("{}.", levels.words), 0)));
    parts.extend(diagnosis.suspect().map(|claim| suspected(diagnosis, claim)));
    parts
}

/// What can't be told apart, was not claimed, or was not tried.
fn doubts(diagnosis: &Diagnosis) -> Vec<String> {
    let mut parts = Vec::new();
    if let Some(family) = &diagnosis.family {
        let words = format!(
            "It is {}; its shape is undecided between {}. A release from a larger angle may tell.",
            family.words,
            family.members.join(" and ")
        );
        parts.push(wrapped(&words, 0));
    } else if !diagnosis.undecided.is_empty() {
        let words = format!(
            "These data can't tell {} from {}; a release from a larger angle may.",
            diagnosis.undecided.join(" or "),
            diagnosis.verdict.join(" + ")
        );
        parts.push(wrapped(&words, 0));
    }
    parts.extend(diagnosis.special_cases.iter().map(|case| {
        let number = with_spread(case.value, Some(case.std));
        format!(
            "{} in place of {} finds {} = {number}: it is {}.",
            case.effect, case.special, case.symbol, case.special
        )
    }));
    let suspect = diagnosis.suspect().map(|claim| claim.effect);
    let unit = diagnosis.measured.milli_unit();
    parts.extend(diagnosis.short_memory.map(|told| wrapped(&told.words(unit), 0)));
    let others = diagnosis.unproven.iter().filter(|claim| Some(claim.effect) != suspect);
    parts.extend(others.map(|claim| unproven(claim, unit)));
    parts.extend(held_out(diagnosis));
    parts.extend(not_tried(diagnosis));
    parts.extend(is_unknown(&diagnosis.parameters.pendulum).then(|| wrapped(PER_GRAVITY, 0)));
    parts
}

/// What the held-out swings say.
fn held_out(diagnosis: &Diagnosis) -> Vec<String> {
    let vetoed = diagnosis.vetoed.iter().map(|name| {
        format!(
            "Not claimed: {name}. The error on the fitted swings falls, but on the held-out ones it rises by more than twice \
             its own uncertainty."
        )
    });
    let said = diagnosis.carries.map(|carries| match carries {
        Carries::Confirmed => "The held-out swings confirm it: their error falls too.",
        Carries::Contradicted => "The held-out swings contradict it: their error rises.",
        Carries::CannotTell => {
            "The held-out swings can't tell: their error stays as it is, within its own uncertainty."
        }
    });
    let said = said.map(str::to_owned).into_iter().chain(without_level(diagnosis));
    vetoed.chain(said).map(|words| wrapped(&words, 0)).collect()
}

/// A release that took no part has a level that nobody knows, so that its error may rise with levels that are right.
fn without_level(diagnosis: &Diagnosis) -> Option<String> {
    let (before, after) = diagnosis.held_out_before.zip(diagnosis.held_out_after)?;
    let unit = diagnosis.measured.milli_unit();
    let words = format!(
        "With the levels the error on the held-out swings rises from {:.2} to {:.2} {unit}: their own level is not the mean one, \
         or the levels imitate another law. Fit them as well to see.",
        1e3 * before,
        1e3 * after
    );
    (diagnosis.levels.is_some() && diagnosis.verdict.is_empty() && after > before).then_some(words)
}

/// That stages were left out, and what to do about it.
fn left_out(diagnosis: &Diagnosis) -> Option<String> {
    let words = format!(
        "These recordings are long or hard to explain: after {} million simulated steps, stages of the search were left \
         out. Where much is left, choose a stretch with --from and --to, or fewer recordings.",
        diagnosis.effort.million_steps
    );
    diagnosis.effort.reached.then(|| wrapped(&words, 0))
}

fn not_tried(diagnosis: &Diagnosis) -> Option<String> {
    let words = |not: &NotTried| wrapped(&format!("Not tried: {} {}.", not.effect, not.reason), 0);
    let is_searched = !diagnosis.verdict.is_empty() || diagnosis.unexplained;
    let all: Vec<String> = diagnosis.not_tried.iter().filter(|_| is_searched).map(words).collect();
    (!all.is_empty()).then(|| all.join("\n"))
}

fn verdict(diagnosis: &Diagnosis) -> String {
    let unit = diagnosis.measured.milli_unit();
    let left = |rmse: f64| format!("{:.2} {unit}, {} times the noise", 1e3 * rmse, noises(rmse / diagnosis.noise));
    let (before, after) = (left(diagnosis.rmse_before), left(diagnosis.rmse_after));
    match (diagnosis.verdict.as_slice(), diagnosis.unexplained) {
        ([], false) if diagnosis.levels.is_some() => {
            let words = format!(
                "No effect is missing: with a friction level for each release the base model leaves {after}; with one \
                 for all it leaves {before}."
            );
            wrapped(&words, 0)
        }
        ([], false) if is_far_below_noise(diagnosis.rmse_after / diagnosis.noise) => {
            let told = if diagnosis.has_no_noise { "Nothing is missing" } else { "What is missing can't be told" };
            let why = far_below(diagnosis.has_no_noise);
            wrapped(&format!("{told}: the base model leaves {after}, {why}."), 0)
        }
        ([], false) => format!("Nothing is missing at this noise level: the base model leaves {after}."),
        (offset, true) if diagnosis.has_no_law() => {
            let zero = match offset {
                [] if diagnosis.levels.is_some() => {
                    format!(" With a friction level for each release it leaves {after}.")
                }
                [] if diagnosis.zero_is_doubtful => {
                    format!(
                        " With the sensor's zero fitted, which these swings don't prove to be off, it leaves {after}."
                    )
                }
                [] => String::new(),
                names => {
                    let level = if diagnosis.levels.is_some() { " and a friction level for each release" } else { "" };
                    format!(" With the sensor's zero put right ({}){level} it leaves {after}.", names.join(" and "))
                }
            };
            wrapped(&format!("The base model leaves {before}.{zero} More than noise is left{}", unnamed(diagnosis)), 0)
        }
        (names, is_unexplained) => {
            let it = if names.len() == 1 { "it" } else { "them" };
            let level = if diagnosis.levels.is_some() { " and a friction level for each release" } else { "" };
            let rest = match diagnosis.suspect {
                _ if !is_unexplained => "",
                // Who is likely is told next.
                Some(_) => " More than noise is left.",
                None => " What remains is not explained by any candidate.",
            };
            format!(
                "Missing: {}. With {it}{level} the error falls from {before},\nto {after}.{rest}",
                names.join(" and ")
            )
        }
    }
}

/// How a sentence ends that says that something is missing, where no law is named: who is suspected is told next.
fn unnamed(diagnosis: &Diagnosis) -> String {
    if diagnosis.suspect.is_some() {
        return ".".to_owned();
    }
    let is_told = |standing: &[Standing]| diagnosis.unproven.iter().any(|claim| !standing.contains(&claim.standing));
    let why = match () {
        () if is_told(&[Standing::OutOfRange, Standing::Vague]) => "holds on every part of the swings",
        () if is_told(&[Standing::OutOfRange]) => "is sure enough to be claimed",
        () => "brings it down to the noise",
    };
    format!(", but no effect of the list {why}: none of these. Look where it fails with `host compare`.")
}

/// One claimed effect: what it is, its numbers, and what it does.
fn claimed(diagnosis: &Diagnosis, name: &str) -> Option<String> {
    let (present, pendulum) = (&diagnosis.parameters.effects, &diagnosis.parameters.pendulum);
    let in_model = present.iter().filter_map(|present| effect_of(&diagnosis.parameters, present.id));
    let effect = in_model.chain(Effect::by_name(name)).find(|effect| effect.name == name)?;
    let mut lines = vec![format!("{name}: {}", effect.summary), format!("  {}", effect.formula)];
    let values = diagnosis.values.iter().filter(|value| value.effect == name);
    lines.extend(values.map(|value| format!("  {}", number(value, pendulum))));
    if let Some(evidence) = diagnosis.evidence.iter().find(|evidence| evidence.effect == name) {
        lines.push(format!("  {}", wrapped(&evidence.words, 4)));
        lines.push(format!("  shows in:   {} (host compare --report)", evidence.picture));
    }
    let claim = diagnosis.holds_on.iter().find(|claim| claim.effect == name);
    lines.extend(claim.map(|claim| format!("  holds on:   {}", wrapped(&claim.seen_on(), 14))));
    if effect.rules.is_free_offset {
        lines.push(format!("  put right:  {}", wrapped(PUT_RIGHT, 14)));
    }
    lines.push(format!("  shows best: {}", wrapped(effect.experiment, 14)));
    Some(lines.join("\n"))
}

fn number(value: &Value, pendulum: &Pendulum<f64>) -> String {
    let unit = unit_of(value.unit, pendulum);
    let end = if value.is_on_an_end() { ", the end of its range" } else { "" };
    format!("{:<4} = {} {unit}", value.symbol, with_spread(value.value, value.std)).trim_end().to_owned() + end
}

/// What the formulas say that were found for the rest, and how far they can be trusted.
fn formulas(diagnosis: &Diagnosis) -> Option<String> {
    let Some(best) = diagnosis.formulas.first() else {
        return diagnosis.unexplained.then(|| HINT.to_owned());
    };
    let pendulum = &diagnosis.parameters.pendulum;
    let mut parts = vec![format!("What remains is something like\n  torque = {}", best.words)];
    parts.extend(best.parameters.iter().map(|value| format!("  {}", number(value, pendulum))));
    parts.push(wrapped(&trust(diagnosis, best), 0));
    for other in &diagnosis.formulas[1..] {
        parts.push(format!("  also: torque = {:<44} {:.2} noises", other.words, other.rmse / diagnosis.noise));
    }
    let add = format!("Try it: host improve … --effect '{}' --add custom", best.formula);
    parts.push(add);
    Some(parts.join("\n"))
}

fn trust(diagnosis: &Diagnosis, best: &Suggestion) -> String {
    let noises = best.rmse / diagnosis.noise;
    let mut words = format!("It takes {:.0} % of what is left beyond the noise", 100.0 * best.removed);
    words += &match best.beside.as_slice() {
        [] if diagnosis.verdict.is_empty() => String::new(),
        [] => " in place of the effects named above".to_owned(),
        names => format!(", beside {}", names.join(" and ")),
    };
    words += &if best.left == Left::Noise {
        format!(" and reaches the noise ({noises:.2} times it).")
    } else {
        format!("; {noises:.2} times the noise stays, so it is a picture of the missing law at most, not the law.")
    };
    let rivals = diagnosis.formulas[1..].iter().filter(|other| other.rmse < RIVAL * best.rmse).count();
    if rivals > 0 {
        words += " The other formulas below do nearly as well: its form is not certain.";
    }
    if let Some((before, after)) = diagnosis.held_out_after.zip(best.held_out) {
        let unit = diagnosis.measured.milli_unit();
        words += &format!(" On held-out swings the error goes from {:.2} to {:.2} {unit}.", 1e3 * before, 1e3 * after);
    } else {
        words += " No held-out swing has confirmed it.";
    }
    words + &format!(" It was seen within {} rad and says nothing beyond.", angle(best.within_rad))
}

/// An error within this factor of the best formula's is as good.
const RIVAL: f64 = 1.1;

fn staircase(diagnosis: &Diagnosis) -> String {
    let highest = diagnosis.rmse_before.max(diagnosis.noise);
    let bar = |rmse: f64| "█".repeat((BAR_WIDTH * rmse / highest).round().max(1.0) as usize);
    let held_out = |rmse: Option<f64>| rmse.map_or(String::new(), |rmse| format!("  held out {:.2}", 1e3 * rmse));
    let mut lines = vec![format!("Error, {} rms", diagnosis.measured.milli_unit())];
    lines.extend(treads(diagnosis).iter().map(|tread| {
        let Tread { words, rmse_rad, held_out_rad } = tread;
        format!("  {words:<28}{:>8.2}  {}{}", 1e3 * rmse_rad, bar(*rmse_rad), held_out(*held_out_rad))
    }));
    lines.push(format!("  {:<28}{:>8.2}  {}", "noise", 1e3 * diagnosis.noise, bar(diagnosis.noise)));
    lines.join("\n")
}

/// The steps of the staircase with their names; where no law is claimed, the sensor's zero is a step of its own, as a
/// fit has it put right.
pub(super) fn treads(diagnosis: &Diagnosis) -> Vec<Tread> {
    let tread = |step: &Step| {
        let words = if step.added == "base" { BASE_TITLE.to_owned() } else { format!("+ {}", step.added) };
        Tread { words, rmse_rad: step.rmse, held_out_rad: step.held_out }
    };
    let zero = match diagnosis.verdict.as_slice() {
        _ if !diagnosis.has_no_law() => None,
        [] => diagnosis.zero_is_doubtful.then(|| "zero of the fit".to_owned()),
        names => Some(names.join(" + ")),
    };
    let put_right = zero.map(|zero| Tread {
        words: format!("+ {zero}"),
        rmse_rad: diagnosis.rmse_after,
        held_out_rad: diagnosis.held_out_after,
    });
    diagnosis.staircase.iter().map(tread).chain(put_right).collect()
}

/// Widest bar of the staircase, characters.
const BAR_WIDTH: f64 = 30.0;

/// What was tried; nothing where that was the base model alone, whose zero is free in every fit.
fn ranking(diagnosis: &Diagnosis) -> Option<String> {
    let shown: Vec<&Candidate> = diagnosis.tried().take(SHOWN).collect();
    if shown.iter().all(|candidate| candidate.is_base()) {
        return None;
    }
    let widest = shown.iter().map(|candidate| candidate.title().len()).fold(NAME_WIDTH, usize::max);
    let line = |candidate: &&Candidate| {
        let noises = candidate.rmse / diagnosis.noise;
        format!("  {:<widest$}{:>8.2}  {noises:>7.2}", candidate.title(), 1e3 * candidate.rmse)
    };
    let head =
        format!("{:<width$}{:>8}  {:>7}", "Tried", diagnosis.measured.milli_unit(), "noises", width = widest + 2);
    let lines = shown.iter().map(line);
    Some(std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n"))
}

/// Room for a usual name.
const NAME_WIDTH: usize = 44;

/// So many candidates are shown; `--json` has all.
const SHOWN: usize = 8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Levels;
    use crate::examples::{claim, diagnosis};
    use crate::fit::uncertainty::Status;

    fn told(diagnosis: Diagnosis) -> Diagnosis {
        Diagnosis { rmse_before: 5e-3, rmse_after: 1.5e-3, noise: 1e-3, ..diagnosis }
    }

    fn with_drag() -> Diagnosis {
        let step = |added, rmse| Step { added, rmse, held_out: None };
        let staircase = vec![step("base", 5e-3), step("quadratic-drag", 1.5e-3)];
        told(Diagnosis { verdict: vec!["quadratic-drag"], staircase, ..diagnosis() })
    }

    #[test]
    fn the_error_falls_from_before_to_after() {
        let words = verdict(&with_drag());
        let expected =
            "With it the error falls from 5.00 mrad, 5.00 times the noise,\nto 1.50 mrad, 1.50 times the noise.";
        assert_eq!(words, format!("Missing: quadratic-drag. {expected}"));
        let nothing = verdict(&told(diagnosis()));
        assert_eq!(
            nothing,
            "Nothing is missing at this noise level: the base model leaves 1.50 mrad, 1.50 times the noise."
        );
        let doubtful = verdict(&Diagnosis { noise: 3e-3, ..told(diagnosis()) });
        assert!(doubtful.starts_with("What is missing can't be told") && doubtful.contains("0.5"), "{doubtful}");
        let simulated = verdict(&Diagnosis { noise: 3e-3, has_no_noise: true, ..told(diagnosis()) });
        assert!(simulated.starts_with("Nothing is missing") && simulated.contains("no noise of"), "{simulated}");
    }

    #[test]
    fn the_highest_stair_is_thirty_characters_wide_and_the_others_are_as_high_as_their_error() {
        let words = staircase(&with_drag());
        let widths: Vec<usize> = words.lines().skip(1).map(|line| line.matches('█').count()).collect();
        assert_eq!(widths, [30, 9, 6], "{words}");
    }

    #[test]
    fn a_number_on_the_end_of_its_range_is_told_to_be_there() {
        let exponent = |status| Value {
            effect: "general-presliding",
            symbol: "iD",
            value: 0.25,
            std: None,
            unit: "1",
            status,
            upper: None,
        };
        assert_eq!(number(&exponent(Status::AtBound), &Pendulum::paper()), "iD   = 0.2500, the end of its range");
        assert_eq!(number(&exponent(Status::Identified), &Pendulum::paper()), "iD   = 0.2500");
        assert_eq!(number(&Value { value: 0.0, ..exponent(Status::AtBound) }, &Pendulum::paper()), "iD   = 0");
    }

    #[test]
    fn what_is_worse_than_the_base_model_is_not_shown() {
        let tried =
            |name: &str, rmse: f64| Candidate { name: name.to_owned(), rmse, criterion: 0.0, parameters: vec![] };
        let candidates = vec![
            tried("quadratic-drag", 2e-3),
            tried("none", 5.17e-3),
            tried("backlash", 5.66e-3),
            tried("sensor-lag", 1.6e16),
            tried("detent", f64::NAN),
        ];
        let alone = vec![tried("none", 1.0e-3)];
        assert_eq!(ranking(&told(Diagnosis { candidates: alone, ..diagnosis() })), None);
        let told = ranking(&told(Diagnosis { candidates, ..diagnosis() })).unwrap();
        let names: Vec<&str> = told.lines().skip(1).map(|line| line[2..30].trim()).collect();
        assert_eq!(names, ["quadratic-drag", "base model"], "{told}");
    }

    #[test]
    fn where_somebody_is_suspected_nobody_says_that_it_is_none_of_the_list() {
        let told = |diagnosis: Diagnosis| {
            let words = verdict(&told(Diagnosis { unexplained: true, ..diagnosis }));
            words.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        let unproven = || vec![claim(Standing::Partly, Some(0.2))];
        let suspected = told(Diagnosis { suspect: Some("quadratic-drag"), unproven: unproven(), ..diagnosis() });
        assert!(suspected.ends_with("5.00 times the noise. More than noise is left."), "{suspected}");
        let partly = told(Diagnosis { unproven: unproven(), ..diagnosis() });
        assert!(partly.contains("no effect of the list holds on every part of the swings: none of these."), "{partly}");
        let beside = |suspect| verdict(&Diagnosis { suspect, unexplained: true, ..with_drag() });
        assert!(beside(Some("detent")).ends_with("noise. More than noise is left."), "{}", beside(Some("detent")));
        assert!(beside(None).ends_with("not explained by any candidate."), "{}", beside(None));
        let nothing = told(diagnosis());
        assert!(nothing.contains("no effect of the list brings it down to the noise: none of these."), "{nothing}");
        let vague = told(Diagnosis { unproven: vec![claim(Standing::Vague, None)], ..diagnosis() });
        assert!(vague.contains("no effect of the list is sure enough to be claimed: none of these."), "{vague}");
    }

    fn with_levels(unexplained: bool) -> Diagnosis {
        let levels =
            Levels { words: "The level changed".to_owned(), windows: 9, p: None, p_without_two: None, parts: vec![] };
        let step = |added| Step { added, rmse: 5e-3, held_out: None };
        let staircase = vec![step("base"), step("friction levels")];
        told(Diagnosis { levels: Some(levels), unexplained, staircase, ..diagnosis() })
    }

    #[test]
    fn levels_that_leave_more_than_noise_are_no_missing_effect_without_a_name() {
        let words = verdict(&with_levels(true)).replace('\n', " ");
        assert!(words.contains("With a friction level for each release it leaves 1.50 mrad, 1.50 times"), "{words}");
        assert!(words.contains("More than noise is left") && !words.contains("Missing: "), "{words}");
        let staircase = [with_drag().staircase, with_levels(true).staircase].concat();
        let law = Diagnosis { verdict: vec!["quadratic-drag"], staircase, ..with_levels(true) };
        assert!(verdict(&law).contains("With it and a friction level for each release the error"), "{}", verdict(&law));
    }

    #[test]
    fn an_error_on_held_out_swings_that_rises_with_levels_is_told() {
        let told = |after: f64| {
            let held_out =
                Diagnosis { held_out_before: Some(9.47e-3), held_out_after: Some(after), ..with_levels(false) };
            super::held_out(&held_out).join(" ").replace('\n', " ")
        };
        assert!(told(27.19e-3).contains("held-out swings rises from 9.47 to 27.19 mrad"), "{}", told(27.19e-3));
        assert!(told(5e-3).is_empty(), "{}", told(5e-3));
    }

    fn suggestion(rmse: f64) -> Suggestion {
        let (words, formula) = ("-3.1e-5·ω".to_owned(), "torque = -k*omega".to_owned());
        let (criterion, parameters, beside) = (0.0, Vec::new(), Vec::new());
        let (left, held_out, removed, within_rad) = (Left::Missing, None, 0.75, 1.2);
        Suggestion { words, formula, rmse, left, held_out, removed, criterion, parameters, beside, within_rad }
    }

    #[test]
    fn a_formula_is_trusted_as_far_as_it_reaches_and_as_its_rivals_let_it() {
        let best = suggestion(2e-3);
        let alone = told(Diagnosis { formulas: vec![best.clone(), suggestion(3e-3)], ..diagnosis() });
        let words = trust(&alone, &best);
        assert!(
            words.starts_with("It takes 75 % of what is left beyond the noise; 2.00 times the noise stays"),
            "{words}"
        );
        assert!(
            words.ends_with("No held-out swing has confirmed it. It was seen within 1.20 rad and says nothing beyond.")
        );
        assert!(!words.contains("its form is not certain"), "{words}");
        let rivals = told(Diagnosis { formulas: vec![best.clone(), suggestion(2.1e-3)], ..diagnosis() });
        assert!(trust(&rivals, &best).contains("its form is not certain"));
        let held_out = Suggestion { held_out: Some(2.5e-3), ..best };
        let tested = Diagnosis { held_out_after: Some(4e-3), ..alone };
        assert!(trust(&tested, &held_out).contains("On held-out swings the error goes from 4.00 to 2.50 mrad."));
    }
}
