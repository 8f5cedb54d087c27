//! The last seconds before the release, kept until it is known that there was one.

use std::collections::VecDeque;

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Samples since the rig was switched on.
    pub number: u64,
    /// Measured angle, rad.
    pub angle_rad: f64,
    /// The sensor's code.
    pub code: u16,
}

/// The oldest sample makes room for the newest, unless all are to be kept.
pub(super) struct LeadIn {
    samples: VecDeque<Sample>,
    n_kept: usize,
}

impl LeadIn {
    pub(super) fn new(n_kept: usize) -> Self {
        Self { samples: VecDeque::with_capacity(n_kept), n_kept: n_kept.max(1) }
    }

    pub(super) fn push(&mut self, sample: Sample, keep_all: bool) {
        while self.samples.len() >= self.n_kept && !keep_all {
            self.samples.pop_front();
        }
        self.samples.push_back(sample);
    }

    /// Takes the oldest.
    pub(super) fn pop(&mut self) -> Option<Sample> {
        self.samples.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_samples_are_kept_until_all_are_to_be() {
        let sample = |number: u64| Sample { number, angle_rad: 0.0, code: 0 };
        let mut lead_in = LeadIn::new(3);
        (0..5).for_each(|number| lead_in.push(sample(number), false));
        (5..7).for_each(|number| lead_in.push(sample(number), true));
        let kept: Vec<u64> = std::iter::from_fn(|| lead_in.pop()).map(|sample| sample.number).collect();
        assert_eq!(kept, [2, 3, 4, 5, 6]);
    }
}
