//! The three designs: each printed run beside ours, and how far the fitted surfaces can be believed.

use super::data::{Published, PublishedDesign, Values};
use super::replay::Replay;
use crate::fit::quality::Responses;
use crate::rsm::{Design, Surface, goodness};
use serde::Serialize;

/// One design beside ours.
#[derive(Clone, Debug, Serialize)]
pub struct DesignComparison {
    /// 1 to 3.
    pub number: usize,
    /// The table of its ranges.
    pub levels_table: usize,
    /// The table of its runs; null for design 2, whose responses were never published.
    pub runs_table: Option<usize>,
    /// Its ranges.
    pub ranges: Vec<Range>,
    /// Its runs.
    pub runs: Vec<RunComparison>,
    /// How well ours agree; null without published runs.
    pub agreement: Option<Agreement>,
    /// R² of the five surfaces, of the published responses, or of ours where there are none.
    pub r_squared: Vec<RSquared>,
    /// The surfaces, in the order of [`Responses::NAMES`], of the same responses.
    #[serde(skip)]
    pub surfaces: Vec<Surface>,
}

/// A factor's range, SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Range {
    /// `Mw` and so on.
    pub symbol: String,
    /// Coded −1.
    pub low: f64,
    /// Coded +1.
    pub high: f64,
}

/// A run beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunComparison {
    /// Its place in the table, from 1.
    pub run: usize,
    /// Mw, Mc, Ms, DV, I in SI units.
    pub values: Values,
    /// The same as signs.
    pub signs: String,
    /// As printed.
    pub published: Option<Responses>,
    /// As simulated here.
    pub ours: Responses,
}

impl RunComparison {
    /// How many of the three counts differ.
    pub fn n_wrong_counts(&self) -> usize {
        let counts = |r: &Responses| [r.positive_peaks, r.negative_peaks, r.zero_crossings];
        let ours = counts(&self.ours);
        self.published.map_or(0, |published| counts(&published).iter().zip(ours).filter(|(p, o)| **p != *o).count())
    }
}

/// How well our runs agree with a printed table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Root mean square of ln(ours/published) over mseA and mseV of all runs.
    pub rms_log_error: f64,
    /// Printed counts.
    pub n_counts: usize,
    /// Counts that differ.
    pub n_wrong_counts: usize,
}

/// R² of one surface, per cent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RSquared {
    /// `mseA` and so on.
    pub response: &'static str,
    /// As printed; null if it was not.
    pub printed_percent: Option<f64>,
    /// Explained variation.
    pub percent: f64,
    /// The same per degree of freedom.
    pub adjusted_percent: f64,
    /// The same for runs left out; negative is worse than no surface at all.
    pub predicted_percent: f64,
}

/// Replays a design and sets it beside the printed one.
pub fn compare(published: &Published, replay: &Replay, design: &PublishedDesign) -> DesignComparison {
    let composite = Design::face_centred(design.factors.clone(), 1).expect("five factors have a design");
    let settings: Vec<Values> = match design.runs_table {
        Some(_) => design.runs.iter().map(|run| run.values).collect(),
        None => composite.natural_runs().iter().map(|run| std::array::from_fn(|j| run[j])).collect(),
    };
    let runs: Vec<RunComparison> = replay
        .all(&settings)
        .into_iter()
        .enumerate()
        .map(|(idx, ours)| RunComparison {
            run: idx + 1,
            values: settings[idx],
            signs: design.signs(&settings[idx]),
            published: design.runs.get(idx).map(|run| run.responses),
            ours,
        })
        .collect();
    let responses: Vec<Responses> = runs.iter().map(|run| run.published.unwrap_or(run.ours)).collect();
    let surfaces = surfaces(&composite, &responses);
    DesignComparison {
        number: design.number,
        levels_table: design.levels_table,
        runs_table: design.runs_table,
        ranges: ranges(design),
        agreement: agreement(&runs),
        r_squared: surfaces.iter().enumerate().map(|(k, s)| r_squared(published, design, k, s)).collect(),
        runs,
        surfaces,
    }
}

/// The five surfaces of a design.
pub fn surfaces(design: &Design, responses: &[Responses]) -> Vec<Surface> {
    let surface = |k: usize| {
        let column: Vec<f64> = responses.iter().map(|r| r.values()[k]).collect();
        Surface::fit(design, &column).expect("27 finite responses determine 21 terms")
    };
    (0..Responses::NAMES.len()).map(surface).collect()
}

fn ranges(design: &PublishedDesign) -> Vec<Range> {
    let range = |factor: &crate::rsm::Factor| Range {
        symbol: factor.name().to_owned(),
        low: factor.low(),
        high: factor.high(),
    };
    design.factors.iter().map(range).collect()
}

fn agreement(runs: &[RunComparison]) -> Option<Agreement> {
    let pairs: Vec<(Responses, Responses)> = runs.iter().filter_map(|run| Some((run.published?, run.ours))).collect();
    let log = |ours: f64, published: f64| (ours / published).ln().powi(2);
    let squares =
        pairs.iter().map(|(p, o)| log(o.mse_angle, p.mse_angle) + log(o.mse_velocity, p.mse_velocity)).sum::<f64>();
    (!pairs.is_empty()).then(|| Agreement {
        rms_log_error: (squares / (2 * pairs.len()) as f64).sqrt(),
        n_counts: 3 * pairs.len(),
        n_wrong_counts: runs.iter().map(RunComparison::n_wrong_counts).sum(),
    })
}

fn r_squared(published: &Published, design: &PublishedDesign, response_idx: usize, surface: &Surface) -> RSquared {
    let fit = goodness(surface);
    let percent = |share: Option<f64>| 100.0 * share.expect("six degrees of freedom are left");
    RSquared {
        response: Responses::NAMES[response_idx],
        printed_percent: (design.number == 3).then(|| published.r_squared_percent[response_idx]),
        percent: percent(fit.r_squared),
        adjusted_percent: percent(fit.r_squared_adjusted),
        predicted_percent: percent(fit.r_squared_predicted),
    }
}
