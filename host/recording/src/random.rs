//! Repeatable Gaussian noise, by the transform of Box and Muller (Ann. Math. Stat. 29 (1958) 610).

use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A source of normal numbers; equal seeds give equal numbers.
#[derive(Clone, Debug)]
pub struct Noise {
    bits: SplitMix64,
    spare: Option<f64>,
}

impl Noise {
    /// Any seed will do, zero included.
    pub fn new(seed: u64) -> Self {
        Self { bits: SplitMix64::seed_from_u64(seed), spare: None }
    }

    /// The next number of mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let (number, spare) = normal_pair(self.above_zero(), self.above_zero());
        self.spare = Some(spare);
        number
    }

    /// Uniform, above 0 and up to 1.
    fn above_zero(&mut self) -> f64 {
        ((self.bits.next_u64() >> 11) + 1) as f64 / (1u64 << 53) as f64
    }
}

/// Two normal numbers from two uniform ones: the first above 0 and up to 1, the second any share of a turn.
pub fn normal_pair(above_zero: f64, turn: f64) -> (f64, f64) {
    let radius = (-2.0 * above_zero.ln()).sqrt();
    let (sine, cosine) = (2.0 * std::f64::consts::PI * turn).sin_cos();
    (radius * cosine, radius * sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_spread_and_kurtosis_are_those_of_a_normal_distribution() {
        let mut noise = Noise::new(3);
        let n = 100_000;
        let values: Vec<f64> = (0..n).map(|_| noise.normal()).collect();
        let moment = |power: i32| values.iter().map(|value| value.powi(power)).sum::<f64>() / f64::from(n);
        // Five standard errors: 1/√n, √(2/n) and √(96/n).
        assert!(moment(1).abs() < 0.016 && (moment(2) - 1.0).abs() < 0.023 && (moment(4) - 3.0).abs() < 0.16);
    }
}
