//! Tables 4, 6 and 9: the printed optima, what our simulation gives there, and the optima of the fitted surfaces.
//!
//! Desirability: target 0 for all five responses, weights 1. Table 9 comes out with bounds that were found by trying;
//! where no bounds are known, the largest response of the design serves.

use super::data::{BOUNDS_OF_TABLE_9, Published, PublishedOptimum, SYMBOLS, Values};
use super::designs::DesignComparison;
use super::replay::Replay;
use crate::cores::on_all_cores;
use crate::fit::quality::Responses;
use crate::rsm::coding::coded_point;
use crate::rsm::{Composite, Desirability, Search, Surface, optimum};
use serde::Serialize;

/// One printed optimum beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OptimumComparison {
    /// 4, 6 or 9.
    pub table: usize,
    /// The design it belongs to.
    pub design: usize,
    /// Mw, Mc, Ms, DV, I as printed.
    pub published: Values,
    /// The responses stated with it.
    pub published_responses: Responses,
    /// Where these come from: the authors' simulation, or Eqs 18–22.
    pub published_by: &'static str,
    /// What the replay gives at the printed optimum.
    pub simulated: Responses,
    /// What our surfaces predict at the printed optimum.
    pub predicted: Responses,
    /// The optimum of our surfaces.
    pub ours: OurOptimum,
    /// Our composite desirability at the printed optimum, same bounds.
    pub desirability_at_published: f64,
    /// Largest distance between the two optima in coded units.
    pub coded_distance: f64,
    /// A point better than the printed one in all five fitted responses, sought for Table 4 only.
    pub better_in_all: Option<OurOptimum>,
    /// Why the printed optimum cannot be had; null if it can.
    pub why_not: Option<String>,
}

/// An optimum of fitted surfaces.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OurOptimum {
    /// Mw, Mc, Ms, DV, I.
    pub values: Values,
    /// What the surfaces predict there.
    pub predicted: Responses,
    /// Composite desirability, 0 to 1.
    pub desirability: f64,
    /// Upper bounds of the desirabilities, in the order of the responses.
    pub bounds: [f64; 5],
    /// What the replay gives there.
    pub simulated: Responses,
}

const NOT_TABLE_6: &str =
    "the 27 runs of design 2 were never published; ours come from the replay, on a rebuilt recording";

/// Sets the three optima beside ours.
pub fn compare(published: &Published, replay: &Replay, designs: &[DesignComparison]) -> Vec<OptimumComparison> {
    let pairs = published.optima.iter().zip(designs);
    on_all_cores(pairs, |(printed, design)| compare_one(printed, design, replay))
}

fn compare_one(printed: &PublishedOptimum, design: &DesignComparison, replay: &Replay) -> OptimumComparison {
    let bounds = if printed.table == 9 { BOUNDS_OF_TABLE_9 } else { natural_bounds(&design.surfaces) };
    let factors = design.surfaces[0].factors();
    let coded = coded_point(factors, &printed.values);
    let predicted: Vec<f64> = design.surfaces.iter().map(|surface| surface.predict(&coded)).collect();
    let ours = best(&design.surfaces, bounds, replay);
    let better = (printed.table == 4).then(|| best(&design.surfaces, as_bounds(&predicted), replay));
    let better_in_all = better.filter(|better| better.desirability > 0.0);
    let distance = |(a, b): (&f64, f64)| (a - b).abs();
    OptimumComparison {
        table: printed.table,
        design: design.number,
        published: printed.values,
        published_responses: printed.responses,
        published_by: if printed.table == 9 { "Eqs 18–22" } else { "simulation" },
        simulated: replay.responses(&printed.values),
        desirability_at_published: goals(bounds).of(&predicted),
        predicted: as_responses(&predicted),
        coded_distance: coded.iter().zip(coded_point(factors, &ours.values)).map(distance).fold(0.0, f64::max),
        ours,
        why_not: why_not(printed, &predicted, better_in_all.as_ref()),
        better_in_all,
    }
}

/// Limits at a point's own responses: only a point that is better in all of them is acceptable.
fn as_bounds(responses: &[f64]) -> [f64; 5] {
    std::array::from_fn(|k| responses[k].abs())
}

fn why_not(printed: &PublishedOptimum, predicted: &[f64], better: Option<&OurOptimum>) -> Option<String> {
    let better = match printed.table {
        4 => better?,
        6 => return Some(NOT_TABLE_6.to_owned()),
        _ => return None,
    };
    let point = SYMBOLS.iter().zip(better.values).map(|(symbol, value)| format!("{symbol} {value:.2e}"));
    Some(format!(
        "another point of its box ({}) is better in all five fitted responses at once, so no desirability with target 0 \
         leads there; and the surface of mseA says {:.1e} where the authors' simulation gave {:.1e}",
        point.collect::<Vec<_>>().join(", "),
        predicted[0],
        printed.responses.mse_angle
    ))
}

/// The most desirable point of a box.
pub fn best(surfaces: &[Surface], bounds: [f64; 5], replay: &Replay) -> OurOptimum {
    let found = optimum(surfaces, &goals(bounds), &Search::default()).expect("five surfaces of one design");
    let values: Values = std::array::from_fn(|j| found.natural[j]);
    OurOptimum {
        values,
        predicted: as_responses(&found.responses),
        desirability: found.composite,
        bounds,
        simulated: replay.responses(&values),
    }
}

/// The largest response of the design, for each response.
pub fn natural_bounds(surfaces: &[Surface]) -> [f64; 5] {
    std::array::from_fn(|k| surfaces[k].responses().amax())
}

/// Target 0 within ± the bounds, weights and importance 1.
fn goals(bounds: [f64; SYMBOLS.len()]) -> Composite {
    let goal = |bound: f64| Desirability::target(-bound, 0.0, bound).expect("bounds are above zero");
    Composite::new(bounds.map(goal).to_vec()).expect("five responses")
}

fn as_responses(values: &[f64]) -> Responses {
    super::data::of_values(std::array::from_fn(|k| values[k]))
}
