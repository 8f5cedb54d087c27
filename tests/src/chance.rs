//! Repeatable chance.

use host::random::normal_pair;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::ops::Range;

/// A source of random numbers; equal seeds give equal numbers.
#[derive(Clone, Debug)]
pub struct Chance(SplitMix64);

impl Chance {
    /// Any seed will do.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// Uniform from the start of a range up to its end.
    pub fn within(&mut self, range: Range<f64>) -> f64 {
        range.start + (range.end - range.start) * self.share()
    }

    /// Mean 0, standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        normal_pair(1.0 - self.share(), self.share()).0
    }

    /// True half of the time.
    pub fn coin(&mut self) -> bool {
        self.share() < 0.5
    }

    fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
