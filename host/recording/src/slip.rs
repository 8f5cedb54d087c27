//! A place at which a clock and what it counts come apart.

/// What a clock lost (positive) or counted twice (negative) between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slip {
    /// The first sample behind it.
    pub(super) idx: usize,
    pub(super) n_samples: isize,
}
