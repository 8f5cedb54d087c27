//! How far chance alone reaches among many looks.
//!
//! In: how many independent, normally distributed numbers are looked at. Out: in standard deviations, what they seldom
//! reach. A limit that serves for a minute is passed by chance in the rest of an hour, because there are more looks:
//! of n numbers the largest grows as √(2 ln n).

/// One recording of so many may be beyond: of 1000 simulated rests of 100,000 numbers none is. With half of it 2 are, with
/// twice of it a limit of 5.7 becomes one of 5.8.
const ODDS: f64 = 100.0;

/// A range has two ends that must both be far off, each of which one of so many may be: of 1000 simulated rests of
/// 100,000 numbers none has a range beyond that. With half of it 5 have, with twice of it swings must be 0.3 larger.
const ODDS_OF_AN_END: f64 = 4.0;

/// What none of `n` numbers reaches, to either side.
pub(super) fn reach(n: f64) -> f64 {
    (2.0 * (ODDS * n).ln()).sqrt()
}

/// From the smallest to the largest of `n` numbers at most.
pub(super) fn range(n: f64) -> f64 {
    2.0 * (2.0 * (ODDS_OF_AN_END * n).ln()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    #[test]
    fn few_of_many_rests_go_beyond_what_chance_reaches() {
        const N: usize = 2000;
        let (mut n_beyond, mut n_wider) = (0, 0);
        let mut noise = Noise::new(1);
        for _ in 0..500 {
            let numbers = (0..N).map(|_| noise.normal());
            let (low, high) = numbers.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
            n_beyond += usize::from(high.max(-low) > reach(N as f64));
            n_wider += usize::from(high - low > range(N as f64));
        }
        assert!(n_beyond < 10 && n_wider < 10, "{n_beyond} {n_wider}");
    }
}
