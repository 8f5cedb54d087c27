//! The paper, replayed: its three designs through its own simulation, its statistics through ours, side by side.
//!
//! In: nothing but the data in `host/data/paper`, which is part of the program. Out: [`Comparison`], everything that
//! can be set beside the printed tables. One file a step: `data` (what was printed) → `replay` (the simulation) →
//! `designs` (Tables 3 and 8, R²) → `equations` (Eqs 18–22) → `optima` (Tables 4, 6, 9) → `sequence` (would the
//! method have arrived there by itself?) → `verdict` (all of it in plain words).
//!
//! Source: S. Bicakci, D. Akdas, A. D. Karaoglan, "Optimizing Karnopp friction model parameters of a pendulum using
//! RSM", European Journal of Control, 2014.

pub mod data;
pub mod designs;
pub mod equations;
pub mod optima;
pub mod replay;
pub mod sequence;
pub mod verdict;

use data::Published;
use designs::DesignComparison;
use equations::EquationComparison;
use optima::OptimumComparison;
use replay::{Replay, Simulation};
use sequence::SequenceComparison;
use serde::Serialize;
use std::time::Instant;
use verdict::PlainWords;

/// Everything that can be set beside the paper.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// How the runs were simulated.
    pub simulation: Simulation,
    /// The three designs: ranges, runs, R².
    pub designs: Vec<DesignComparison>,
    /// Eqs 18–22.
    pub equations: Vec<EquationComparison>,
    /// Tables 4, 6 and 9.
    pub optima: Vec<OptimumComparison>,
    /// Where the paper's sequence of designs leads.
    pub sequence: SequenceComparison,
    /// What comes out and what does not.
    pub verdict: PlainWords,
    /// Simulated swings.
    pub simulations: usize,
    /// Time taken.
    pub seconds: f64,
}

/// Replays the paper; `progress` is told what begins.
pub fn compare(progress: &dyn Fn(&str)) -> Comparison {
    let began = Instant::now();
    let published = Published::embedded();
    let replay = Replay::new(&published);
    progress("replaying the three designs of 27 runs each …");
    let designs: Vec<DesignComparison> =
        published.designs.iter().map(|design| designs::compare(&published, &replay, design)).collect();
    progress("fitting surfaces and equations …");
    let equations = equations::compare(&published, &designs[2]);
    progress("searching the optima …");
    let optima = optima::compare(&published, &replay, &designs);
    progress("following the sequence of designs by itself …");
    let sequence = sequence::compare(&published, &replay, &designs);
    let verdict = verdict::in_plain_words(&designs, &equations, &optima, &sequence);
    Comparison {
        simulation: replay.simulation(),
        designs,
        equations,
        optima,
        sequence,
        verdict,
        simulations: replay.n_simulations(),
        seconds: began.elapsed().as_secs_f64(),
    }
}
