//! Why runs give no surface.

/// Why no surface could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Not one response a run.
    #[error("{found} responses for {expected} runs; give one response a run")]
    ResponseCount {
        /// Responses given.
        found: usize,
        /// Runs of the design.
        expected: usize,
    },
    /// A response is NaN, infinite or beyond 1e100.
    #[error("the response of run {run} is {value}; repeat the run or leave it out of the design")]
    Response {
        /// Run, counted from 1.
        run: usize,
        /// The response.
        value: f64,
    },
    /// Fewer runs than terms.
    #[error("{n_runs} runs cannot fix {n_terms} terms; add at least {} runs", n_terms - n_runs)]
    TooFewRuns {
        /// Runs of the design.
        n_runs: usize,
        /// Terms of the quadratic.
        n_terms: usize,
    },
    /// Enough runs, but they confound some terms.
    #[error("the runs tell only {rank} of {n_terms} terms apart; add runs at further levels")]
    RankDeficient {
        /// Terms that can be told apart.
        rank: usize,
        /// Terms of the quadratic.
        n_terms: usize,
    },
}
