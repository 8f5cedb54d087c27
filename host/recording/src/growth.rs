//! How much the period grows with the amplitude, as a share of what a pendulum's grows: T(A) = T0 · 2 K(sin A/2) / π.
//!
//! In: amplitude (rad) and period (s) of each swing. Out: the growth as a share of the prediction, its standard error, and
//! the predicted growth from the smallest to the largest swing.

use super::median;
use std::f64::consts::PI;

/// Fewer periods tell nothing about their growth.
pub(super) const MIN_PERIODS: usize = 6;

/// Swings below this share of the largest say little: play, stiction and noise act there.
pub(super) const SMALLEST_SHARE: f64 = 0.15;

/// Standard errors that a verdict wants.
pub(super) const SURE: f64 = 4.0;

/// Of swings that are not far smaller than the largest.
pub(super) fn growth_of(periods: &[(f64, f64)], largest_rad: f64) -> Option<(f64, f64, f64)> {
    growth(&points(periods, largest_rad), <[Point]>::to_vec)
}

/// The same of the longest run of swings each of which is smaller than the one before, as those of a free swing are; a
/// hand or a motor breaks it off. Two periods end at the turning point at which it lets go.
pub(super) fn growth_while_falling(periods: &[(f64, f64)]) -> Option<(f64, f64, f64)> {
    let falls = |a: &(f64, f64), b: &(f64, f64)| b.0 < a.0;
    let run = periods.chunk_by(falls).max_by_key(|run| run.len())?;
    let free = run.get(2..).filter(|free| !free.is_empty())?;
    growth_of(free, free[0].0)
}

/// The same with what friction takes that bends before it slides: the force with which it bends is bounded, so that the
/// larger the swing, the less it shortens the period, by about one over the amplitude. Gravity adds to the period by the
/// square of the amplitude, in whatever unit, so that large swings tell the unit and small ones the bending.
pub(super) fn growth_beside_bending(periods: &[(f64, f64)], largest_rad: f64) -> Option<(f64, f64, f64)> {
    growth(&points(periods, largest_rad), without_bending)
}

/// Predicted growth, period (s) and weight of a swing.
type Point = (f64, f64, f64);

fn points(periods: &[(f64, f64)], largest_rad: f64) -> Vec<Point> {
    let least_rad = SMALLEST_SHARE * largest_rad;
    let is_seen = |(amplitude, _): &&(f64, f64)| *amplitude > least_rad && *amplitude < 0.98 * PI;
    let point = |(amplitude, period_s): &(f64, f64)| (lengthening(*amplitude) - 1.0, *period_s, amplitude.powi(2));
    periods.iter().filter(is_seen).map(point).collect()
}

/// Growth and period less what goes with one over the amplitude, about their means.
fn without_bending(points: &[Point]) -> Vec<Point> {
    let sum = |term: &dyn Fn(&Point) -> f64| points.iter().map(|p| p.2 * term(p)).sum::<f64>();
    let weight = sum(&|_| 1.0);
    let mean = sum(&|p| p.2.sqrt().recip()) / weight;
    let bent = |p: &Point| p.2.sqrt().recip() - mean;
    let across = sum(&|p| bent(p).powi(2));
    let slope = |of: &dyn Fn(&Point) -> f64| sum(&|p| bent(p) * of(p)) / across;
    let (of_growth, of_period) = (slope(&|p| p.0), slope(&|p| p.1));
    points.iter().map(|p| (p.0 - of_growth * bent(p), p.1 - of_period * bent(p), p.2)).collect()
}

/// Growth of the period as a share of the prediction, its standard error, and the predicted growth from the smallest to
/// the largest swing: weighted least squares of `T = T0 + b (f − 1)`, twice without what is far off.
fn growth(points: &[Point], seen: impl Fn(&[Point]) -> Vec<Point>) -> Option<(f64, f64, f64)> {
    let mut all = points.to_vec();
    let mut found = None;
    for _ in 0..3 {
        if all.len() < MIN_PERIODS {
            return None;
        }
        let kept = seen(&all);
        let sum = |term: &dyn Fn(&(f64, f64, f64)) -> f64| kept.iter().map(term).sum::<f64>();
        let weight = sum(&|p| p.2);
        let (mean_f, mean_t) = (sum(&|p| p.2 * p.0) / weight, sum(&|p| p.2 * p.1) / weight);
        let across = sum(&|p| p.2 * (p.0 - mean_f).powi(2));
        let slope = sum(&|p| p.2 * (p.0 - mean_f) * (p.1 - mean_t)) / across;
        let t0 = mean_t - slope * mean_f;
        let off = |p: &Point| p.1 - t0 - slope * p.0;
        let variance = sum(&|p| p.2 * off(p).powi(2)) / (kept.len() - 2) as f64;
        if !(across > 0.0 && t0 > 0.0) {
            return None;
        }
        // Neighbouring periods share a turning point.
        let spread = 1.5 * (variance / across).sqrt() / t0;
        let (low, high) = kept.iter().fold((f64::MAX, 0.0_f64), |(low, high), p| (low.min(p.0), high.max(p.0)));
        found = Some((slope / t0, spread, high - low));
        let mut sizes: Vec<f64> = kept.iter().map(|p| off(p).abs() * p.2.sqrt()).collect();
        let limit = 6.0 * median(&mut sizes);
        let is_near = |p: &Point| off(p).abs() * p.2.sqrt() <= limit;
        all = all.iter().zip(&kept).filter(|(_, seen)| is_near(seen)).map(|(point, _)| *point).collect();
    }
    found
}

/// Period at an amplitude (rad, below π) over that of small swings, by the arithmetic-geometric mean.
pub fn lengthening(amplitude_rad: f64) -> f64 {
    let (mut a, mut b) = (1.0, (amplitude_rad / 2.0).cos());
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    a.recip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_at_ninety_degrees_is_a_sixth_longer() {
        // K(sin 45°) · 2/π = 1.18034 (Abramowitz and Stegun, table 17.1).
        assert!((lengthening(PI / 2.0) - 1.180_340_6).abs() < 1e-6);
    }

    /// A hand that lifts and turns it makes a few long periods before and between two free swings.
    #[test]
    fn of_swings_that_a_hand_breaks_off_the_longest_free_run_tells_the_growth() {
        let scatter = |idx: u32| 1e-4 * (f64::from(idx.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5);
        let swing = |size: f64, idx: u32| (size, lengthening(size) + scatter(idx));
        let free = |largest: f64, n: u32| (0..n).map(move |idx| swing(largest * 0.9_f64.powf(idx.into()), idx));
        let periods: Vec<(f64, f64)> =
            [(3.0, 9.0), (1.6, 2.0)].into_iter().chain(free(2.3, 3)).chain([(2.9, 7.0)]).chain(free(2.6, 20)).collect();
        let of_all = growth_of(&periods, 3.0);
        assert!(
            of_all.is_none_or(|(growth, spread, _)| spread > 0.1 || (growth - 1.0).abs() > 0.3),
            "no case: {of_all:?}"
        );
        let (growth, spread, _) = growth_while_falling(&periods).unwrap();
        assert!((growth - 1.0).abs() < 0.01 && spread < 0.01, "{growth} ± {spread}");
    }
}
