//! The verdict in words: how good the model is, whether noise or physics is left, and where it fails.

use super::recording::Judged;
use super::{Comparison, rms};
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
    /// Some recording does not follow the model at all.
    DoesNotFit,
}

/// A residual of more than this many times the noise is more than noise.
const MORE_THAN_NOISE: f64 = 1.1;

/// A slow remainder of less than this share of the noise variance does not matter.
const SLOW_SHARE: f64 = 0.02;

/// Where the noise of the sensor is coloured, only its size can be judged; up to here it may be noise.
const COLOURED_NOISE: f64 = 1.3;

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
        let residuals: Vec<f64> = recordings.iter().flat_map(|r| r.residuals_rad.iter().copied()).collect();
        let n: f64 = recordings.iter().map(|r| r.residuals_rad.len() as f64).sum();
        let weighted = |of: &dyn Fn(&Judged) -> f64| {
            recordings.iter().map(|r| of(r) * r.residuals_rad.len() as f64).sum::<f64>() / n.max(1.0)
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
}

/// Is more than noise left in a recording?
pub fn more_than_noise(recording: &Judged) -> bool {
    let ratio = rms(&recording.residuals_rad) / recording.noise.level_rad().max(1e-300);
    if recording.noise.is_coloured {
        return ratio > COLOURED_NOISE;
    }
    let slow = &recording.slow_excess;
    ratio > MORE_THAN_NOISE || (slow.is_significant() && slow.share > SLOW_SHARE)
}

/// The answer to a comparison.
pub fn answer(comparison: &Comparison) -> Answer {
    if !comparison.mismatches.is_empty() {
        return Answer::DoesNotFit;
    }
    if !comparison.recordings.iter().any(|recording| recording.more_than_noise) {
        return Answer::NothingMissing;
    }
    if findings(comparison).is_empty() { Answer::NoPattern } else { Answer::PhysicsMissing }
}

/// The verdict, a sentence an entry.
pub fn sentences(comparison: &Comparison) -> Vec<String> {
    let mut words = vec![explained(&comparison.totals)];
    match comparison.answer {
        Answer::DoesNotFit => {
            words.extend(comparison.mismatches.iter().map(|mismatch| {
                format!("{} does not fit this model at all: {}.", mismatch.recording, mismatch.reason)
            }));
        }
        Answer::NothingMissing => words.push(nothing(&comparison.totals)),
        Answer::NoPattern => {
            words.push(beyond(&comparison.totals, "so there is more left than noise"));
            words.push(
                "But neither the energy lost per swing nor the torque over angle and velocity shows a pattern that \
                 could be named."
                    .to_owned(),
            );
        }
        Answer::PhysicsMissing => {
            words.push(beyond(&comparison.totals, "so physics is missing"));
            words.extend(fails_most(comparison));
            words.extend(findings(comparison));
        }
    }
    words.extend(held_out(comparison));
    words.extend(parameters(comparison));
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

fn milliradians(totals: &Totals) -> String {
    let (residual, noise) = (in_mrad(totals.residual_rad), in_mrad(totals.noise_rad));
    format!("Residual {residual} mrad, noise {noise} mrad")
}

/// Three significant digits.
pub fn in_mrad(angle_rad: f64) -> String {
    let value = 1e3 * angle_rad;
    let digits = (2 - value.abs().max(1e-3).log10().floor() as i32).clamp(0, 5) as usize;
    format!("{value:.digits$}")
}

fn nothing(totals: &Totals) -> String {
    format!("{}. Nothing is missing at this noise level.", milliradians(totals))
}

fn beyond(totals: &Totals, conclusion: &str) -> String {
    format!("{}: {} times the noise, {conclusion}.", milliradians(totals), times(totals.ratio))
}

fn fails_most(comparison: &Comparison) -> Option<String> {
    let worst: Vec<&str> = comparison.places.iter().take(2).map(|place| place.words.as_str()).collect();
    match worst[..] {
        [] => None,
        [one] => Some(format!("It fails most {one}.")),
        [one, two, ..] => Some(format!("It fails most {one} and {two}.")),
    }
}

/// Patterns that can be named, a sentence each.
pub fn findings(comparison: &Comparison) -> Vec<String> {
    let mut words = Vec::new();
    words.extend(losses(comparison));
    words.extend(comparison.energy.bump_rad.map(|bump_rad| {
        format!("The energy lost per path has a bump near {bump_rad:.2} rad, which no friction of the model has.")
    }));
    words.extend(periods(comparison));
    words.extend(comparison.energy.sides_differ().map(|difference| {
        let (percent, faster) = (
            100.0 * difference.value.abs() / comparison.energy.usual_loss_nm,
            if difference.value > 0.0 { "counter-clockwise" } else { "clockwise" },
        );
        format!("Half swings {faster} lose {percent:.0} % more energy than those back, beyond what the model says.")
    }));
    words.extend(torque(comparison));
    words
}

fn losses(comparison: &Comparison) -> Option<String> {
    let off = comparison.energy.losses_off();
    let worst = off.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
    let percent = 100.0 * worst.value.abs() / comparison.energy.usual_loss_nm.abs().max(1e-300);
    let more = if worst.value > 0.0 { "more" } else { "less" };
    Some(format!(
        "Near {:.2} rad amplitude a half swing loses {:.2} mN·m {more} per radian of path than modelled ({percent:.0} % of \
         the usual loss).",
        worst.x,
        1e3 * worst.value.abs()
    ))
}

fn periods(comparison: &Comparison) -> Option<String> {
    let off = comparison.energy.periods_off();
    let worst = off.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs()))?;
    let longer = if worst.value > 0.0 { "longer" } else { "shorter" };
    let percent = 100.0 * worst.value.abs();
    Some(format!("Near {:.2} rad amplitude the period is {percent:.2} % {longer} than modelled.", worst.x))
}

fn torque(comparison: &Comparison) -> Option<String> {
    let map = comparison.torque.as_ref().filter(|map| map.is_significant)?;
    let bin = map.strongest()?;
    let compared = match map.coulomb_nm {
        coulomb_nm if coulomb_nm > 0.0 => format!(" ({:.1} times Mc)", bin.torque_nm.abs() / coulomb_nm),
        _ => String::new(),
    };
    Some(format!(
        "The torque map lacks most at {:.2} rad and {:.1} rad/s: {:+.2} ± {:.2} mN·m{compared}.",
        bin.angle_rad,
        bin.velocity_rad_s,
        1e3 * bin.torque_nm,
        1e3 * bin.spread_nm
    ))
}

/// A multiple of the noise, with digits that mean something.
fn times(ratio: f64) -> String {
    if ratio < 100.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

fn held_out(comparison: &Comparison) -> Option<String> {
    let totals = comparison.held_out_totals.as_ref()?;
    let conclusion = if !comparison.held_out.iter().any(|recording| recording.more_than_noise) {
        ": the model carries over to them"
    } else if totals.ratio < ALIKE * comparison.totals.ratio {
        ", as on the others: the model carries over, and lacks the same"
    } else {
        ", so the model does not carry over to them: the rig has changed, or they show physics that the others hide"
    };
    let residual = in_mrad(totals.residual_rad);
    Some(format!(
        "On held-out recordings the residual is {residual} mrad, {} times the noise{conclusion}.",
        times(totals.ratio)
    ))
}

fn parameters(comparison: &Comparison) -> Vec<String> {
    let Some(knowledge) = &comparison.knowledge else { return Vec::new() };
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
