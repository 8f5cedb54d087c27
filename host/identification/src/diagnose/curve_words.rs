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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::diagnose;
    use crate::diagnose::resemblance::Numbers;
    use crate::diagnose::resemblance::Resemblance;
    use crate::diagnose::tests::{fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;

    #[test]
    fn a_curve_is_told_by_what_it_leaves_and_how_it_predicts() {
        let (swings, count) = ([simulated("one", &rig(), 6.0, 3)], Tally::default());
        let mut diagnosis = diagnose(&swings, &[], &rig());
        (diagnosis.rmse_before, diagnosis.rmse_after, diagnosis.noise) = (9e-3, 4e-3, 1e-3);
        let (torques, numbers) = (Vec::new(), Numbers::default());
        let resembles = vec![Resemblance { effect: "quadratic-drag", share: 0.012, torques, numbers }];
        let mut curve = FrictionCurve {
            speeds: Vec::new(),
            torques: Vec::new(),
            stds: Vec::new(),
            built_up: 0.0,
            beside: vec!["presliding"],
            rmse: 2e-3,
            left: Left::Missing,
            left_out: 2.5e-3,
            left_out_straight: 6e-3,
            blocks: 12,
            windows: 14,
            contradicted: Vec::new(),
            resembles,
            parameters: rig(),
            model: fitted(&problem_of(&swings, &rig(), &count), &rig()),
        };
        let words = curve.in_words(&diagnosis);
        for expected in [
            "a free friction curve beside presliding leaves 2.00 mrad of 4.00, 2.00 times the noise.",
            "12 blocks of the swings, each left out in turn, are predicted to 2.50 mrad, by viscous and coulomb friction in \
             its place to 6.00.",
            "It resembles quadratic-drag, from which it differs by 1 %.",
            "No part of the swings contradicts it within its ±, but what it leaves is no noise",
        ] {
            assert!(words.contains(expected), "{expected}: {words}");
        }
        let between = ["early", "late"].map(str::to_owned);
        curve.contradicted = vec![Contradiction { between, from_rad_s: 1.0, to_rad_s: 2.5 }];
        let words = curve.in_words(&diagnosis);
        assert!(words.contains("But early and late want other curves between 1.0 and 2.5 rad/s: friction"), "{words}");
    }
}
