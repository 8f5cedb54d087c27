//! A friction curve in words: what it leaves, where it is known, on which parts it holds, which law it resembles.

use super::table::wrapped;
use crate::diagnose::curve::Contradiction;
use crate::diagnose::{Diagnosis, FrictionCurve};
use crate::number::{noises, with_spread};
use crate::verdict::Left;
use shared::effect::Effect;

/// Speeds that are told, spread over the knots whose torque is known.
const TOLD: usize = 4;

/// The curve for a person.
pub(super) fn in_words(diagnosis: &Diagnosis, curve: &FrictionCurve) -> String {
    let unit = diagnosis.measured.milli_unit();
    let milli = |value: f64| format!("{:.2}", 1e3 * value);
    let beside = match curve.beside.as_slice() {
        [] => String::new(),
        names => format!(" beside {}", names.join(" and ")),
    };
    // The sensor's zero is free beside every model.
    let is_law = |name: &&str| Effect::<f64>::by_name(name).is_none_or(|effect| !effect.rules.is_free_offset);
    let laws: Vec<&str> = diagnosis.verdict.iter().copied().filter(is_law).collect();
    let replaced: Vec<&str> = laws.iter().copied().filter(|name| !curve.beside.contains(name)).collect();
    let beside = match replaced.as_slice() {
        [] => beside,
        names => format!("{beside} in place of {}", names.join(" and ")),
    };
    let what = if laws.is_empty() {
        "No law of the list reaches the noise"
    } else {
        "No law brings the rest down to the noise"
    };
    let mut sentences = vec![format!(
        "{what}; a free friction curve{beside} leaves {} {unit} of {}, {} times the noise.",
        milli(curve.rmse),
        milli(diagnosis.rmse_after),
        noises(curve.rmse / diagnosis.noise)
    )];
    sentences.push(format!(
        "{} blocks of the swings, each left out in turn, are predicted to {} {unit}, by viscous and coulomb friction in \
         its place to {}.",
        curve.blocks,
        milli(curve.left_out),
        milli(curve.left_out_straight)
    ));
    sentences.push(resembles(curve));
    sentences.push(if curve.holds() && curve.left == Left::Missing {
        let part = curve.closest().filter(|law| laws.is_empty() && law.effect != "none").map(|law| law.effect);
        let part = part.map_or(String::new(), |law| format!(" Friction like {law} is likely a part of it."));
        format!(
            "No part of the swings contradicts it within its ±, but what it leaves is no noise: it is not the whole \
             law.{part}"
        )
    } else if curve.holds() {
        "No part of the swings contradicts it.".to_owned()
    } else {
        let where_it_fails: Vec<String> = curve.contradicted.iter().map(contradicted).collect();
        format!(
            "But {}: friction depends on more than the speed there, and the curve is a picture, not a law.",
            where_it_fails.join("; ")
        )
    });
    let mut lines = vec![wrapped(&sentences.join(" "), 0)];
    lines.extend(told(curve).map(|(speed, torque, std)| {
        format!("  friction at {speed:.2} rad/s is {} mN·m", with_spread(1e3 * torque, std.map(|std| 1e3 * std)))
    }));
    lines.push("Take it: host improve … --add friction-curve -o rig.toml; draw it with --plot".to_owned());
    lines.join("\n")
}

/// Speed, torque and standard deviation at some knots.
fn told(curve: &FrictionCurve) -> impl Iterator<Item = (f64, f64, Option<f64>)> {
    let knots = curve.speeds.iter().zip(&curve.torques).zip(&curve.stds);
    let known: Vec<(f64, f64, Option<f64>)> = knots
        .filter(|(_, std)| std.is_some())
        .map(|((speed, torque), std)| (*speed, curve.built_up + torque, *std))
        .collect();
    let n_told = TOLD.min(known.len());
    (0..n_told).map(move |k| known[k * (known.len() - 1) / (n_told - 1).max(1)])
}

fn resembles(curve: &FrictionCurve) -> String {
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let called = |effect: &str| match effect {
        "none" => "viscous and coulomb friction alone".to_owned(),
        name => name.to_owned(),
    };
    match (curve.closest(), curve.resembles.first()) {
        (Some(law), _) => {
            format!("It resembles {}, from which it differs by {}.", called(law.effect), percent(law.share))
        }
        (None, Some(law)) => format!(
            "It resembles no law of the list: {}, the closest one, differs by {}.",
            called(law.effect),
            percent(law.share)
        ),
        (None, None) => String::new(),
    }
}

fn contradicted(found: &Contradiction) -> String {
    let [one, other] = &found.between;
    let speeds = match found.from_rad_s == found.to_rad_s {
        true => format!("at {:.1} rad/s", found.from_rad_s),
        false => format!("between {:.1} and {:.1} rad/s", found.from_rad_s, found.to_rad_s),
    };
    format!("{one} and {other} want other curves {speeds}")
}
