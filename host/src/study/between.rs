//! Which rig differs from the others?
//!
//! Bearings are never alike, so that enough swings tell any two apart. What counts is whether a rig stands out from
//! how the others scatter: each rig's mean is compared with the means of all others (`outlier.rs`).

use super::outlier::{FEWEST_OTHERS, Side, outliers};
use super::percent::percent;
use super::rig::{CHARTED, RigView};
use serde::Serialize;

/// In so many studies without a special rig one is named.
const BY_CHANCE: f64 = 0.01;

/// A quantity over all rigs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Between {
    /// The literature's symbol.
    pub symbol: &'static str,
    /// What it is.
    pub name: &'static str,
    /// SI unit.
    pub unit: String,
    /// Mean of the means.
    pub mean: f64,
    /// Rigs with such a number.
    pub rigs: Vec<Place>,
    /// Are there enough rigs to say what is usual?
    pub is_judged: bool,
}

/// A rig among the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Its folder within the study.
    pub rig: String,
    /// Its mean.
    pub mean: f64,
    /// Its standard error.
    pub std_error: Option<f64>,
    /// Difference to the mean of the others, as a share of that.
    pub difference: Option<f64>,
    /// The difference's standard error, from the swings of all.
    pub difference_std: Option<f64>,
    /// Does it stand out from how the others scatter?
    pub stands_out: bool,
}

impl Between {
    /// How a rig stands among the others, in a sentence.
    pub fn in_words(&self, place: &Place) -> String {
        let Self { symbol, name, .. } = self;
        let Some(share) = place.difference else { return format!("it is the only rig with {symbol}") };
        let side = if share < 0.0 { "lower" } else { "higher" };
        format!("its {name} {symbol} is {} {side} than that of the other rigs", percent(share, place.difference_std))
    }
}

/// Compares rigs in all quantities that are charted.
pub fn between(rigs: &[RigView]) -> Vec<Between> {
    CHARTED.iter().filter_map(|charted| of(rigs, charted.symbol, charted.name)).collect()
}

fn of(rigs: &[RigView], symbol: &'static str, name: &'static str) -> Option<Between> {
    let all: Vec<_> = rigs.iter().filter_map(|rig| Some((&rig.name, rig.friction_of(symbol)?))).collect();
    let means: Vec<f64> = all.iter().map(|(_, friction)| friction.mean.value).collect();
    let unit = all.first()?.1.unit.clone();
    let stands_out = outliers(&means, Side::Both, BY_CHANCE / means.len() as f64);
    let place = |idx: usize| {
        let (rig, friction) = &all[idx];
        let others =
            || all.iter().enumerate().filter(move |(other, _)| *other != idx).map(|(_, (_, other))| other.mean);
        let n = others().count() as f64;
        let usual = others().map(|mean| mean.value).sum::<f64>() / n;
        let variance = |std_error: Option<f64>| std_error.map(|std_error| std_error * std_error);
        let of_others: Option<f64> = others().map(|mean| variance(mean.std_error)).sum();
        let std = variance(friction.mean.std_error).zip(of_others).map(|(own, others)| (own + others / (n * n)).sqrt());
        let is_one_of_many = n > 0.0 && usual != 0.0;
        Place {
            rig: (*rig).clone(),
            mean: friction.mean.value,
            std_error: friction.mean.std_error,
            difference: is_one_of_many.then(|| friction.mean.value / usual - 1.0),
            difference_std: std.filter(|_| is_one_of_many).map(|std| std / usual.abs()),
            stands_out: stands_out.contains(&idx),
        }
    };
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let is_judged = means.len() > FEWEST_OTHERS;
    Some(Between { symbol, name, unit, mean, rigs: (0..all.len()).map(place).collect(), is_judged })
}

#[cfg(test)]
mod tests {
    use super::super::rig::tests::row;
    use super::*;

    #[test]
    fn a_rig_differs_from_the_others_by_its_share_and_that_is_known_as_well_as_all_means() {
        let rig = |(name, value, std)| RigView::new(name, vec![row("swing.csv", value, std)]);
        let rigs = [("a", 1.2, 0.03), ("b", 1.0, 0.04), ("c", 1.0, 0.04)].map(rig);
        let found = &between(&rigs)[0];
        let place = &found.rigs[0];
        assert!((place.difference.unwrap() - 0.2).abs() < 1e-12, "{place:?}");
        // ±0.03 of its own, and ±0.04/√2 of the mean of two others, which is 1.
        let expected = (0.03_f64.powi(2) + 0.04_f64.powi(2) / 2.0).sqrt();
        assert!((place.difference_std.unwrap() - expected).abs() < 1e-12, "{place:?}");
        let words = found.in_words(place);
        assert_eq!(words, "its dry friction Mc is 20.0 ± 4.1 % higher than that of the other rigs");
        assert!(found.in_words(&found.rigs[1]).contains("% lower than"), "{:?}", found.rigs[1]);
        assert!(!found.is_judged);
    }
}
