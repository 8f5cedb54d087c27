//! The verdict in words: how good the model is, whether noise or physics is left, and where it fails.

use super::energy::Energy;
use super::knowledge::{Estimate, Knowledge};
use super::mismatch::Mismatch;
use super::numbers::Refit;
use super::per_swing::Place;
use super::recording::Judged;
use super::rms;
use super::torque::TorqueMap;
use crate::diagnose::zero;
use crate::fit::touch::Touch;
use crate::number::{angle, noises, significant, with_spread};
use crate::recording::Measured;
use crate::verdict::{ChiSquare, LOOK_FIRST, Left, hardly_follows};
use serde::Serialize;
use shared::effect::Effect;

/// What the comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// The residual is the noise.
    NothingMissing,
    /// More than noise is left, but neither energy nor torque shows a pattern.
    NoPattern,
    /// Physics is missing, and it is visible where.
    PhysicsMissing,
    /// The numbers are not those of these recordings; until a fit nobody knows whether physics is missing too.
    NumbersDoNotFit,
    /// Some recording does not follow the model at all.
    DoesNotFit,
}

/// Held-out recordings that are missed by less than this many times what the others are, are missed alike.
const ALIKE: f64 = 1.2;

/// Explained, residual, noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Totals {
    /// Share of the motion's variance that the model explains.
    pub explained: f64,
    /// 1 − rms residual / rms motion.
    pub nrmse_fit: f64,
    /// Root mean square residual, rad.
    pub residual_rad: f64,
    /// Noise, rad.
    pub noise_rad: f64,
    /// Residual over noise.
    pub ratio: f64,
}

/// Less motion than this no sensor sees, rad.
const LEAST_MOTION_RAD: f64 = 1e-9;

impl Totals {
    /// Over several recordings.
    pub fn of(recordings: &[Judged]) -> Self {
        let residuals: Vec<f64> = recordings.iter().flat_map(|r| r.curves.residuals_rad.iter().copied()).collect();
        let n: f64 = recordings.iter().map(|r| r.curves.residuals_rad.len() as f64).sum();
        let weighted = |of: &dyn Fn(&Judged) -> f64| {
            recordings.iter().map(|r| of(r) * r.curves.residuals_rad.len() as f64).sum::<f64>() / n.max(1.0)
        };
        let residual_rad = rms(&residuals);
        let motion = weighted(&|r| r.motion_rad.powi(2)).sqrt();
        // What does not move has nothing to explain; a share of zero would be no number.
        let share = residual_rad / motion.max(LEAST_MOTION_RAD);
        let noise_rad = weighted(&|r| r.noise.level_rad().powi(2)).sqrt();
        Self {
            explained: 1.0 - share.powi(2),
            nrmse_fit: 1.0 - share,
            residual_rad,
            noise_rad,
            ratio: residual_rad / noise_rad.max(1e-300),
        }
    }

    /// Is so much of the motion left, beyond the noise, that something else than an effect should be looked for first?
    fn hardly_follows(&self) -> bool {
        let left_of_noise = 1.0 - self.ratio.max(1.0).powi(-2);
        hardly_follows(((1.0 - self.explained) * left_of_noise).sqrt())
    }
}

/// Where it is open whether physics is missing.
const MORE_THAN_NOISE: &str = ", so there is more left than noise";

/// Everything that a comparison looked at, before its verdict.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// What the recordings hold.
    pub measured: Measured,
    /// Each recording.
    pub recordings: &'a [Judged],
    /// Each held-out recording.
    pub held_out: &'a [Judged],
    /// Over all recordings that are not held out.
    pub totals: &'a Totals,
    /// Over the held-out ones.
    pub held_out_totals: Option<&'a Totals>,
    /// Where the residual is larger than elsewhere, worst first.
    pub places: &'a [Place],
    /// Energy and period against amplitude.
    pub energy: &'a Energy,
    /// Missing torque over angle and velocity.
    pub torque: Option<&'a TorqueMap>,
    /// What the recordings say about the parameters.
    pub knowledge: Option<&'a Knowledge>,
    /// Recordings that do not fit at all.
    pub mismatches: &'a [Mismatch],
    /// What a fit would leave.
    pub refit: Option<&'a Refit>,
}

impl Seen<'_> {
    /// What there is to be said first.
    pub fn answer(&self) -> Answer {
        if self.numbers_are_to_blame() {
            return Answer::NumbersDoNotFit;
        }
        if !self.mismatches.is_empty() {
            return Answer::DoesNotFit;
        }
        if !self.recordings.iter().any(|recording| recording.verdict.more_than_noise) {
            return Answer::NothingMissing;
        }
        if findings(self).is_empty() { Answer::NoPattern } else { Answer::PhysicsMissing }
    }

    /// Would a fit help? Not with a recording that goes its own way from the first swing on.
    fn numbers_are_to_blame(&self) -> bool {
        let begin_well = self.mismatches.iter().all(|mismatch| mismatch.begins_well);
        begin_well && self.refit.is_some_and(|refit| refit.blames_the_numbers(self.totals.ratio))
    }

    /// The verdict, a sentence an entry.
    pub fn sentences(&self) -> Vec<String> {
        let mut words = vec![explained(self.totals)];
        let answer = self.answer();
        let is_doubtful = matches!(answer, Answer::NoPattern | Answer::PhysicsMissing) && self.totals.hardly_follows();
        words.extend(
            is_doubtful.then(|| format!("It hardly follows: before you ask what physics is missing, {LOOK_FIRST}.")),
        );
        match answer {
            Answer::NumbersDoNotFit => words.extend(numbers(self)),
            Answer::DoesNotFit => {
                words.extend(self.mismatches.iter().map(|mismatch| {
                    format!("{} does not fit this model at all: {}.", mismatch.recording, mismatch.reason)
                }));
            }
            Answer::NothingMissing => words.push(nothing(self)),
            Answer::NoPattern => {
                words.push(beyond(self, MORE_THAN_NOISE));
                words.push(
                    if self.measured == Measured::Rate {
                        "Rates alone do not show where; host diagnose tells which effect is missing."
                    } else {
                        "But neither the energy lost per swing nor the torque over angle and velocity shows a pattern \
                     that could be named."
                    }
                    .to_owned(),
                );
            }
            Answer::PhysicsMissing => {
                words.push(beyond(self, if is_doubtful { MORE_THAN_NOISE } else { ", so physics is missing" }));
                words.extend(fails_most(self));
                words.extend(findings(self));
            }
        }
        words.extend(held_out(self));
        words.extend(parameters(self));
        words
    }
}

/// Wrong numbers come first: what else is missing shows only once they fit.
fn numbers(seen: &Seen) -> Vec<String> {
    let is_near = ChiSquare::of_rms(seen.totals.ratio, 1.0, f64::INFINITY).left() != Left::Missing;
    let told = match is_near {
        true => "These numbers are a little off for these recordings: fit to all that you have.",
        false => "These numbers do not fit these recordings: fit first, or physics is missing.",
    };
    let mut words = vec![beyond(seen, ""), told.to_owned()];
    words.extend(seen.refit.map(|refit| {
        let rest = match refit.left {
            Left::Missing => "what is then left is missing physics",
            Left::Nearly | Left::Noise => "nothing else is missing",
        };
        format!(
            "Fitted to them, the same model leaves {} {}, {} times the noise: {rest}.",
            in_mrad(refit.residual_rad),
            seen.measured.milli_unit(),
            noises(refit.ratio)
        )
    }));
    words
}

fn explained(totals: &Totals) -> String {
    let percent = |share: f64| {
        let percent = 100.0 * share;
        if percent > 99.95 { format!("{percent:.3}") } else { format!("{percent:.1}") }
    };
    if totals.explained <= 0.0 {
        return "The model explains nothing of the motion.".to_owned();
    }
    let (explained, fit) = (percent(totals.explained), percent(totals.nrmse_fit));
    format!("The model explains {explained} % of the motion (fit {fit} % NRMSE).")
}

fn milliradians(seen: &Seen) -> String {
    let (residual, noise) = (in_mrad(seen.totals.residual_rad), in_mrad(seen.totals.noise_rad));
    let unit = seen.measured.milli_unit();
    format!("Residual {residual} {unit}, noise {noise} {unit}")
}

/// Three significant digits.
pub fn in_mrad(angle_rad: f64) -> String {
    let value = 1e3 * angle_rad;
    let digits = (2 - value.abs().max(1e-3).log10().floor() as i32).clamp(0, 5) as usize;
    format!("{value:.digits$}")
}

/// What a touch leaves is neither missing physics nor a wrong number.
pub(super) fn touched(touch: &Touch) -> String {
    let (sentence, alone) = (touch.sentence(), touch.alone("compare"));
    format!("{sentence} Only the longer part of that swing is looked at here, as if by {alone}.")
}

/// The recordings were compared with their zeros taken off; one that is off is missing all the same.
fn nothing(seen: &Seen) -> String {
    let off = |zero: Estimate| {
        format!(
            " but the sensor's zero, which is off by {}. {}",
            zero::off_in_words(zero.value, zero.std),
            zero::PUT_RIGHT
        )
    };
    let zero = seen.knowledge.and_then(|knowledge| knowledge.zero).map(off);
    format!("{}. Nothing is missing at this noise level{}", milliradians(seen), zero.unwrap_or_else(|| ".".to_owned()))
}

fn beyond(seen: &Seen, conclusion: &str) -> String {
    format!("{}: {} times the noise{conclusion}.", milliradians(seen), noises(seen.totals.ratio))
}

fn fails_most(seen: &Seen) -> Option<String> {
    let worst: Vec<&str> = seen.places.iter().take(2).map(|place| place.words.as_str()).collect();
    match worst[..] {
        [] => None,
        [one] => Some(format!("It fails most {one}.")),
        [one, two, ..] => Some(format!("It fails most {one} and {two}.")),
    }
}

/// The same sentence of a pendulum of which only the motion is known: its torques are per m·g·l.
pub fn per_gravity(sentence: &str) -> String {
    sentence.replace("mN·m", "thousandths of m·g·l")
}

/// Patterns that can be named, a sentence each.
fn findings(seen: &Seen) -> Vec<String> {
    let mut words = Vec::new();
    words.extend(losses(seen));
    words.extend(seen.energy.bump_missing_rad().map(|bump_rad| {
        format!("The energy lost per path has a bump near {} rad, which no friction of the model has.", angle(bump_rad))
    }));
    words.extend(periods(seen));
    words.extend(seen.energy.sides_differ().map(|difference| {
        let (percent, faster) = (
            100.0 * difference.value.abs() / seen.energy.usual_loss_nm,
            if difference.value > 0.0 { "counter-clockwise" } else { "clockwise" },
        );
        format!("Half swings {faster} lose {percent:.0} % more energy than those back, beyond what the model says.")
    }));
    words.extend(torque(seen));
    words
}

fn losses(seen: &Seen) -> Option<String> {
    let off = seen.energy.losses_off();
    let worst = off.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
    let percent = 100.0 * worst.value.abs() / seen.energy.usual_loss_nm.abs().max(1e-300);
    let more = if worst.value > 0.0 { "more" } else { "less" };
    Some(format!(
        "Near {} rad amplitude a half swing loses {} mN·m {more} per radian of path than modelled ({percent:.0} % of \
         the usual loss).",
        angle(worst.x),
        significant(1e3 * worst.value.abs(), 2)
    ))
}

fn periods(seen: &Seen) -> Option<String> {
    let off = seen.energy.periods_off();
    let worst = off.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
    let longer = if worst.value > 0.0 { "longer" } else { "shorter" };
    let percent = 100.0 * worst.value.abs();
    let at = angle(worst.x);
    Some(format!("Near {at} rad amplitude the period is {} % {longer} than modelled.", significant(percent, 2)))
}

fn torque(seen: &Seen) -> Option<String> {
    let map = seen.torque.filter(|map| map.is_significant)?;
    let bin = map.strongest()?;
    let compared = match map.coulomb_nm {
        coulomb_nm if coulomb_nm > 0.0 => format!(" ({} times Mc)", significant(bin.torque_nm.abs() / coulomb_nm, 2)),
        _ => String::new(),
    };
    Some(format!(
        "The torque map lacks most at {} rad and {} rad/s: {} mN·m{compared}.",
        angle(bin.angle_rad),
        significant(bin.velocity_rad_s, 2),
        with_spread(1e3 * bin.torque_nm, Some(1e3 * bin.spread_nm))
    ))
}

fn held_out(seen: &Seen) -> Option<String> {
    let totals = seen.held_out_totals?;
    let conclusion = if !seen.held_out.iter().any(|recording| recording.verdict.more_than_noise) {
        ": the model carries over to them"
    } else if totals.ratio < ALIKE * seen.totals.ratio {
        ", as on the others: the model carries over, and lacks the same"
    } else {
        ", so the model does not carry over to them: the rig has changed, or they show physics that the others hide"
    };
    let residual = in_mrad(totals.residual_rad);
    Some(format!(
        "On held-out recordings the residual is {residual} {}, {} times the noise{conclusion}.",
        seen.measured.milli_unit(),
        noises(totals.ratio)
    ))
}

fn parameters(seen: &Seen) -> Vec<String> {
    let Some(knowledge) = seen.knowledge else { return Vec::new() };
    let mut words = Vec::new();
    for known in &knowledge.parameters {
        let is_base = Effect::<f64>::by_name(known.name).is_some_and(Effect::is_base);
        if known.is_zero() && is_base {
            words.push(format!("These recordings want {} friction ({}) to be zero.", known.name, known.symbol));
        } else if known.drifts() {
            words.push(format!("{} drifts from recording to recording.", known.symbol));
        } else if known.disagrees() {
            words.push(format!("The recordings do not agree on {}.", known.symbol));
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::binned::Mean;
    use crate::compare::grid::Grid;
    use crate::compare::tests::judged;
    use crate::compare::torque::Bin;

    fn seen<'a>(energy: &'a Energy, totals: &'a Totals) -> Seen<'a> {
        Seen {
            measured: Measured::Angle,
            recordings: &[],
            held_out: &[],
            totals,
            held_out_totals: None,
            places: &[],
            energy,
            torque: None,
            knowledge: None,
            mismatches: &[],
            refit: None,
        }
    }

    fn mean(x: f64, value: f64) -> Mean {
        Mean { x, value, spread: 1e-6, n: 5 }
    }

    #[test]
    fn an_angle_is_told_with_three_digits() {
        assert_eq!([0.1234, 0.01234, 1.234e-3, 1.234e-4].map(in_mrad), ["123", "12.3", "1.23", "0.123"]);
    }

    #[test]
    fn what_hardly_follows_the_motion_is_not_called_missing_physics() {
        let mut judged = judged();
        judged.verdict.more_than_noise = true;
        let (energy, recordings) = (Energy::default(), [judged]);
        let said = |ratio: f64, explained: f64| {
            let totals = Totals { ratio, explained, ..Totals::default() };
            Seen { recordings: &recordings, ..seen(&energy, &totals) }.sentences().join(" ")
        };
        let hardly = "It hardly follows: before you ask what physics is missing";
        // 30 % of the motion is left, 27 % beyond the noise; 20 %; and 30 % of which most is noise.
        assert!(said(2.3, 0.91).contains(hardly), "{}", said(2.3, 0.91));
        assert!(!said(2.3, 0.96).contains(hardly) && !said(1.2, 0.91).contains(hardly));
    }

    #[test]
    fn the_worst_loss_is_told_with_its_share_of_the_usual_one() {
        let words = |loss_missing: Vec<Mean>| {
            let energy = Energy { loss_missing, usual_loss_nm: 1e-3, ..Energy::default() };
            losses(&seen(&energy, &Totals::default()))
        };
        assert_eq!(
            words(vec![mean(0.3, 1e-4), mean(0.6, -2.5e-4)]).as_deref(),
            Some(
                "Near 0.60 rad amplitude a half swing loses 0.25 mN·m less per radian of path than modelled (25 % of \
                 the usual loss)."
            )
        );
        assert_eq!(words(vec![mean(0.3, 1e-6)]), None);
    }

    #[test]
    fn of_very_small_swings_too_the_place_and_the_torque_are_told_with_digits() {
        let loss_missing = vec![Mean { spread: 1e-10, ..mean(1.23e-3, 2e-8) }];
        let period_off = vec![mean(2.5e-3, 2e-3)];
        let energy = Energy { loss_missing, period_off, usual_loss_nm: 1e-7, ..Energy::default() };
        let words = findings(&seen(&energy, &Totals::default()));
        assert!(words[0].starts_with("Near 1.2e-3 rad amplitude a half swing loses 2.0e-5 mN·m more"), "{words:?}");
        assert!(words[1].starts_with("Near 2.5e-3 rad amplitude the period is 0.20 % longer"), "{words:?}");
    }

    #[test]
    fn a_zero_that_is_off_is_all_that_is_missing() {
        let zero = Some(Estimate { value: -4.45e-3, std: Some(1.1e-5) });
        let knowledge = Knowledge { zero, ..Knowledge::default() };
        let (energy, totals) = (Energy::default(), Totals::default());
        let words = nothing(&Seen { knowledge: Some(&knowledge), ..seen(&energy, &totals) });
        assert!(
            words.contains("missing at this noise level but the sensor's zero, which is off by -4.450 ± 0.011 mrad.")
        );
        assert!(nothing(&seen(&energy, &totals)).ends_with("Nothing is missing at this noise level."));
    }

    #[test]
    fn the_side_that_loses_more_and_the_period_that_is_off_are_told() {
        let said = |difference: f64, off: f64| {
            let (side_difference, period_off) = (Some(mean(0.5, difference)), vec![mean(0.3, off)]);
            let energy = Energy { side_difference, period_off, usual_loss_nm: 1e-3, ..Energy::default() };
            findings(&seen(&energy, &Totals::default()))
        };
        assert_eq!(
            said(2e-4, 2e-3),
            [
                "Near 0.30 rad amplitude the period is 0.20 % longer than modelled.",
                "Half swings counter-clockwise lose 20 % more energy than those back, beyond what the model says."
            ]
        );
        let other = said(-2e-4, -2e-3);
        assert!(
            other[0].contains("0.20 % shorter") && other[1].starts_with("Half swings clockwise lose 20 %"),
            "{other:?}"
        );
    }

    #[test]
    fn the_torque_that_is_lacked_most_is_told_with_its_standard_error() {
        let bin = |place: usize, torque_nm: f64| {
            let (angle_rad, velocity_rad_s, spread_nm, n_visits, n_samples) = (0.5, 2.0, 1e-4, 9, 90);
            Bin { place, angle_rad, velocity_rad_s, torque_nm, spread_nm, n_visits, n_samples }
        };
        let (grid, bins) = (Grid { angle_rad: 1.0, velocity_rad_s: 6.0 }, vec![bin(0, 1e-3), bin(1, -2e-3)]);
        let map = TorqueMap { grid, bins, coulomb_nm: 1e-3, evidence: 99.0, explained: 0.9, is_significant: true };
        let (energy, totals) = (Energy::default(), Totals::default());
        assert_eq!(
            torque(&Seen { torque: Some(&map), ..seen(&energy, &totals) }).as_deref(),
            Some("The torque map lacks most at 0.50 rad and 2.0 rad/s: -2.00 ± 0.10 mN·m (2.0 times Mc).")
        );
        let map = TorqueMap { coulomb_nm: 0.05, ..map };
        let told = torque(&Seen { torque: Some(&map), ..seen(&energy, &totals) }).unwrap();
        assert!(told.ends_with("(0.040 times Mc)."), "{told}");
    }

    #[test]
    fn numbers_that_leave_a_twentieth_more_than_the_noise_are_a_little_off() {
        let refit = Refit { residual_rad: 1e-3, ratio: 1.0, left: Left::Noise };
        let told = |ratio: f64| {
            let (energy, totals) = (Energy::default(), Totals { ratio, ..Totals::default() });
            numbers(&Seen { refit: Some(&refit), ..seen(&energy, &totals) }).join(" ")
        };
        assert!(told(1.05).contains("1.05 times the noise. These numbers are a little off"), "{}", told(1.05));
        assert!(told(1.3).contains("These numbers do not fit these recordings: fit first"), "{}", told(1.3));
    }

    #[test]
    fn a_model_carries_over_to_held_out_recordings_that_it_misses_alike() {
        let mut judged = judged();
        let (energy, totals) = (Energy::default(), Totals { ratio: 2.0, ..Totals::default() });
        let mut said = |ratio: f64, more_than_noise: bool| {
            judged.verdict.more_than_noise = more_than_noise;
            let of_others = Totals { residual_rad: ratio * 1e-3, ratio, ..Totals::default() };
            let held = [judged.clone()];
            held_out(&Seen { held_out: &held, held_out_totals: Some(&of_others), ..seen(&energy, &totals) }).unwrap()
        };
        assert!(said(2.2, true).contains("residual is 2.20 mrad, 2.20 times the noise, as on the others"));
        assert!(said(5.0, true).contains("5.00 times the noise, so the model does not carry over to them"));
        assert!(said(1.0, false).ends_with("1.00 times the noise: the model carries over to them."));
    }
}
