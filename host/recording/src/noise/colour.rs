//! Noise whose neighbouring samples are alike tells its variance as well as fewer samples of white noise would.

/// Within so many standard errors a correlation or a scatter may be chance, as 99.7 % of those of white noise are. Half of it and twice of
/// it were not tried.
pub(super) const CORRELATED_STDS: f64 = 3.0;

/// Samples whose lags are looked at, at most, because the time grows with their square where a zero wanders slowly: a tenth
/// of a second. Half of it tells slow noise with less certainty, twice of it takes four times as long.
const MOST_LOOKED_AT: usize = 10_000;

/// Noise whose neighbouring samples are alike, as still ones show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Share of its samples that are as good as independent for a variance.
    pub independent_share: f64,
    /// So many independent samples tell its variance.
    pub n_independent: f64,
}

impl Colour {
    /// Of samples of the noise itself, with a mean of zero.
    pub fn of(noise: &[f64]) -> Self {
        let independent_share = independent_share(noise);
        Self { independent_share, n_independent: independent_share * noise.len() as f64 }
    }

    /// Are neighbours alike beyond chance?
    pub fn is_seen(&self) -> bool {
        self.independent_share < 1.0
    }

    /// Of several together: what is known of the worst.
    pub fn worst(self, other: Self) -> Self {
        Self {
            independent_share: self.independent_share.min(other.independent_share),
            n_independent: self.n_independent.min(other.n_independent),
        }
    }
}

/// Share of samples that are as good as independent for a variance, from samples of the noise itself (a still pendulum,
/// a mean of zero): 1/(1 + 2·Σρ²) over the first lags that are alike. 1 for white noise, and for hum of half the sampling
/// rate, whose variance each pair tells.
/// Source: M. S. Bartlett, J. R. Stat. Soc. Suppl. 8 (1946) 27.
fn independent_share(noise: &[f64]) -> f64 {
    let noise = &noise[..noise.len().min(MOST_LOOKED_AT)];
    let square: f64 = noise.iter().map(|x| x * x).sum();
    let limit = CORRELATED_STDS / (noise.len().max(1) as f64).sqrt();
    let correlation = |lag: usize| noise[lag..].iter().zip(noise).map(|(a, b)| a * b).sum::<f64>() / square;
    let correlated = (1..noise.len() / 4).map(correlation).take_while(|rho| *rho > limit);
    (1.0 + 2.0 * correlated.map(|rho| rho * rho).sum::<f64>()).recip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_two_has_the_least_of_both() {
        let colour = Colour { independent_share: 0.25, n_independent: 800.0 };
        let other = Colour { independent_share: 0.5, n_independent: 100.0 };
        assert_eq!(colour.worst(other), Colour { independent_share: 0.25, n_independent: 100.0 });
    }

    #[test]
    fn noise_that_wanders_has_fewer_independent_samples() {
        let mut state = 1_u64;
        let mut white = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let plain: Vec<f64> = (0..20_000).map(|_| white()).collect();
        let rho = 0.8;
        let walk = plain.iter().scan(0.0, |last, x| {
            *last = rho * *last + x;
            Some(*last)
        });
        assert!(independent_share(&plain) > 0.99);
        let colour = Colour::of(&plain);
        assert_eq!(colour.n_independent, colour.independent_share * 20_000.0);
        // Of a first-order process: (1 − ρ²)/(1 + ρ²).
        let share = independent_share(&walk.collect::<Vec<f64>>());
        assert!((share - (1.0 - rho * rho) / (1.0 + rho * rho)).abs() < 0.03, "{share}");
    }
}
