//! The noise of a swing with few samples a period: what pieces of it leave beyond sinusoids.
//!
//! Where differences of neighbours still hold motion, pieces of a few periods are fitted with a swing and its odd
//! harmonics: a₀ + (a₁ + a₂t + a₃t²)·cos ωt + … + (…)·cos 3ωt + … + cos 5ωt, ω sought for each piece because it
//! depends on the amplitude. What is left over the degrees of freedom is an upper bound of the noise, as differences
//! are: whatever a motion has beside these adds to it.

use crate::median_step_s;
use crate::turning::half_swing_s;

/// Samples of a piece: twice as many as it has unknowns.
const PIECE: usize = 28;

/// Fewer pieces than this, with 65 degrees of freedom, tell a noise to no better than a tenth.
const MIN_PIECES: usize = 5;

/// The amplitude may change evenly and with its square, that of the third harmonic evenly, that of the fifth not.
const POWERS: [(f64, i32); 3] = [(1.0, 3), (3.0, 2), (5.0, 1)];

/// From the swings' middle frequency that of a piece is sought within this share: at 2 rad a pendulum is slower by a
/// third than in small swings.
const REACH: f64 = 0.25;

/// Frequencies that are tried first: so close that the phase at the ends of a piece of five periods differs by half a
/// radian between two of them.
const TRIED: usize = 15;

/// Then the best one is narrowed so often, to 1e-4 of the way between two of them.
const NARROWED: usize = 20;

/// A frequency that is the best of several minima takes more than one degree of freedom. Of 48 simulated swings with 6 to
/// 12 samples a period and noises of 0.05 to 2 % of the swing, with one the noise comes out 5 % too small on average, with
/// two 1 %, with four 7 % too large.
const OF_FREQUENCY: usize = 2;

/// A column with so small a share of its length beside the others depends on them: a harmonic that the sampling folds
/// onto another one.
const DEPENDENT: f64 = 1e-4;

/// From so many samples a period on, differences of order 10 leave 3e-5 rad of the third harmonic of a swing of 1 rad,
/// which is θ³/192; of eight samples 4 mrad.
const ENOUGH_A_PERIOD: f64 = 16.0;

/// Rms noise of samples that swing with few of them a period; `None` of others and of too few.
pub(super) fn rms(times_s: &[f64], readings: &[f64], frozen: &[bool], rough: f64) -> Option<f64> {
    let half_swing_s = half_swing_s(times_s, readings, rough)?;
    if 2.0 * half_swing_s > ENOUGH_A_PERIOD * median_step_s(times_s) {
        return None;
    }
    let middle_rad_s = std::f64::consts::PI / half_swing_s;
    let pieces = (0..times_s.len() / PIECE).map(|piece| piece * PIECE..(piece + 1) * PIECE);
    let moving = pieces.filter(|piece| frozen[piece.clone()].iter().all(|frozen| !frozen));
    let left: Vec<(f64, usize)> =
        moving.map(|piece| left_of(&times_s[piece.clone()], &readings[piece], middle_rad_s)).collect();
    let squares: f64 = left.iter().map(|(squares, _)| squares).sum();
    let n_free: usize = left.iter().map(|(_, n_free)| n_free).sum();
    (left.len() >= MIN_PIECES).then(|| (squares / n_free as f64).sqrt())
}

/// Sum of squares that a piece leaves at its own frequency, and its degrees of freedom.
fn left_of(times_s: &[f64], readings: &[f64], middle_rad_s: f64) -> (f64, usize) {
    let at = |factor: f64| beyond(times_s, readings, middle_rad_s * factor);
    let spacing = 2.0 * REACH / (TRIED - 1) as f64;
    let tried = (0..TRIED).map(|i| 1.0 - REACH + spacing * i as f64);
    let best = tried.min_by(|a, b| at(*a).0.total_cmp(&at(*b).0)).unwrap_or(1.0);
    let (mut low, mut high) = (best - spacing, best + spacing);
    for _ in 0..NARROWED {
        let (left, right) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if at(left).0 < at(right).0 { high = right } else { low = left }
    }
    let (squares, n_free) = at(0.5 * (low + high));
    (squares, n_free.saturating_sub(OF_FREQUENCY))
}

/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// What readings have beyond sinusoids of a frequency and its harmonics: sum of squares and degrees of freedom.
fn beyond(times_s: &[f64], readings: &[f64], rad_s: f64) -> (f64, usize) {
    let middle_s = (times_s[0] + times_s[times_s.len() - 1]) / 2.0;
    let column = |of: &dyn Fn(f64) -> f64| times_s.iter().map(|t| of(t - middle_s)).collect::<Vec<f64>>();
    let mut columns = vec![column(&|_| 1.0)];
    for (harmonic, n_powers) in POWERS {
        for power in 0..n_powers {
            columns.push(column(&|t| t.powi(power) * (harmonic * rad_s * t).cos()));
            columns.push(column(&|t| t.powi(power) * (harmonic * rad_s * t).sin()));
        }
    }
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mut column in columns {
        let before = dot(&column, &column).sqrt();
        // Twice, because once leaves what rounding lost.
        (0..2).for_each(|_| basis.iter().for_each(|other| take_out(&mut column, other)));
        let length = dot(&column, &column).sqrt();
        if length > DEPENDENT * before {
            column.iter_mut().for_each(|value| *value /= length);
            basis.push(column);
        }
    }
    let mut left = readings.to_vec();
    basis.iter().for_each(|column| take_out(&mut left, column));
    (dot(&left, &left), readings.len() - basis.len())
}

fn take_out(of: &mut [f64], column: &[f64]) {
    let share = dot(of, column);
    of.iter_mut().zip(column).for_each(|(value, other)| *value -= share * other);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A sine of a period of 1 s with so many samples a period.
    fn sine(n_samples: usize, a_period: f64, rad_s: f64) -> (Vec<f64>, Vec<f64>) {
        let times_s: Vec<f64> = (0..n_samples).map(|idx| idx as f64 / a_period).collect();
        let readings = times_s.iter().map(|t| (rad_s * t).sin()).collect();
        (times_s, readings)
    }

    #[test]
    fn a_swing_with_many_samples_a_period_or_few_pieces_is_left_to_the_differences() {
        let found = |n_samples: usize, a_period: f64| {
            let (times_s, readings) = sine(n_samples, a_period, TAU);
            rms(&times_s, &readings, &vec![false; n_samples], 1e-3).is_some()
        };
        assert!(found(10 * PIECE, 13.0));
        assert!(!found(10 * PIECE, 20.0));
        assert!(found(MIN_PIECES * PIECE, 9.0));
        assert!(!found(MIN_PIECES * PIECE - 1, 9.0));
    }

    #[test]
    fn a_piece_that_swings_a_quarter_faster_or_slower_than_most_leaves_nothing() {
        for share in [-0.24, -0.1, 0.0, 0.1, 0.24] {
            let (times_s, readings) = sine(PIECE, 9.0, TAU * (1.0 + share));
            let (squares, n_free) = left_of(&times_s, &readings, TAU);
            assert!(squares.sqrt() < 1e-4, "{share}: {squares}");
            // Without what a constant, twelve columns of sinusoids and the frequency take.
            assert_eq!(n_free, PIECE - 13 - OF_FREQUENCY, "{share}");
        }
    }
}
