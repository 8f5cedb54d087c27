//! What a rate allows: how few hits chance leaves when the rate is as good as promised.

/// One of so many true rates is refused by mistake.
const MISTAKES: f64 = 1e-3;

/// The fewest hits in so many tries that a true rate brings in all but one of a thousand runs.
pub fn fewest_hits(n_tries: usize, rate: f64) -> usize {
    let mut below = 0.0;
    for n_hits in 0..=n_tries {
        below += probability(n_tries, n_hits, rate);
        if below > MISTAKES {
            return n_hits;
        }
    }
    n_tries
}

/// Of the binomial distribution.
fn probability(n_tries: usize, n_hits: usize, rate: f64) -> f64 {
    let ways: f64 = (0..n_hits).map(|k| ((n_tries - k) as f64 / (k + 1) as f64).ln()).sum();
    (ways + n_hits as f64 * rate.ln() + (n_tries - n_hits) as f64 * (1.0 - rate).ln()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Summed by hand: of 10 fair coins, 0 heads fall in 1 of 1024 runs and at most one in 11 of 1024.
    #[test]
    fn a_fair_coin() {
        assert_eq!(fewest_hits(10, 0.5), 1);
        assert_eq!(fewest_hits(9, 0.5), 0);
    }

    /// 0.9^n and the like, where one or two misses decide.
    #[test]
    fn hardly_any_misses() {
        assert_eq!(fewest_hits(1, 0.9), 0);
        // Three misses in three tries fall in one of a thousand runs.
        assert_eq!(fewest_hits(3, 0.89), 0);
        assert_eq!(fewest_hits(3, 0.91), 1);
        assert_eq!(fewest_hits(100, 0.9999), 99);
    }
}
