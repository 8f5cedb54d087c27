//! A friction curve in words: what it leaves, on which parts it holds, which law it resembles.

use super::curve::Contradiction;
use super::{Diagnosis, FrictionCurve};
use crate::number::noises;
use crate::verdict::Left;
use shared::effect::Effect;

impl FrictionCurve {
    /// For a person, beside what the diagnosis that offers it says.
    pub fn in_words(&self, diagnosis: &Diagnosis) -> String {
        let unit = diagnosis.measured.milli_unit();
        let milli = |value: f64| format!("{:.2}", 1e3 * value);
        let beside = match self.beside.as_slice() {
            [] => String::new(),
            names => format!(" beside {}", names.join(" and ")),
        };
        // The sensor's zero is free beside every model.
        let is_law = |name: &&str| Effect::<f64>::by_name(name).is_none_or(|effect| !effect.rules.is_free_offset);
        let laws: Vec<&str> = diagnosis.verdict.iter().copied().filter(is_law).collect();
        let replaced: Vec<&str> = laws.iter().copied().filter(|name| !self.beside.contains(name)).collect();
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
            milli(self.rmse),
            milli(diagnosis.rmse_after),
            noises(self.rmse / diagnosis.noise)
        )];
        sentences.push(format!(
            "{} blocks of the swings, each left out in turn, are predicted to {} {unit}, by viscous and coulomb friction \
             in its place to {}.",
            self.blocks,
            milli(self.left_out),
            milli(self.left_out_straight)
        ));
        sentences.push(resembles(self));
        sentences.push(if self.holds() && self.left == Left::Missing {
            let part = self.closest().filter(|law| laws.is_empty() && law.effect != "none").map(|law| law.effect);
            let part = part.map_or(String::new(), |law| format!(" Friction like {law} is likely a part of it."));
            format!(
                "No part of the swings contradicts it within its ±, but what it leaves is no noise: it is not the whole \
                 law.{part}"
            )
        } else if self.holds() {
            "No part of the swings contradicts it.".to_owned()
        } else {
            let where_it_fails: Vec<String> = self.contradicted.iter().map(contradicted).collect();
            format!(
                "But {}: friction depends on more than the speed there, and the curve is a picture, not a law.",
                where_it_fails.join("; ")
            )
        });
        sentences.join(" ")
    }
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
