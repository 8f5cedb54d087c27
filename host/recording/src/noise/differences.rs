//! The noise that differences of neighbours leave, and the order from which on they leave nothing of the motion.
//!
//! Differences of order k, `Σ wⱼ θⱼ` over k + 1 neighbours with weights that cancel every polynomial below degree k and
//! have Σ w² = 1, leave the noise and nearly nothing of the motion. With even steps they are binomial (the fourth:
//! 1 −4 6 −4 1 over √70); with uneven ones they are divided differences with the true times.
//! Fourth differences serve from 100 Hz on; slower recordings leak motion, so the order rises until two more orders
//! change nothing.
//! J. von Neumann et al., Ann. Math. Stat. 12 (1941) 153, is the idea with first differences.

use super::scatter::robust_spread;
use crate::{GAP_STEPS, median_step_s};

/// The first order tried.
const LOWEST_ORDER: usize = 4;

/// The last order tried: beyond it the window spans too much of a swing at the rates where it would be needed.
const HIGHEST_ORDER: usize = 10;

/// Two orders agree when they differ by less than this and chance.
const AGREEMENT: f64 = 0.01;

/// A step that is off the median by less than this share is even: so little are numbers rounded, and 10 rad/s then leak less
/// than a nanoradian.
const EVEN: f64 = 1e-9;

/// The lowest order that the next two confirm; the highest when none is.
pub(super) fn agreeing_order(times_s: &[f64], angles_rad: &[f64], frozen: &[bool]) -> (usize, Differences) {
    let agrees = |lower: &Differences, higher: &Differences| {
        lower.rms() <= higher.rms() * (1.0 + AGREEMENT + 1.0 / (higher.n_windows.max(1) as f64).sqrt())
    };
    // Higher orders cost more, and most recordings do without them.
    let mut all: Vec<Differences> = Vec::new();
    for order in LOWEST_ORDER..=HIGHEST_ORDER {
        all.push(Differences::of_order(order, times_s, angles_rad, frozen));
        if let [.., lower, next, last] = all[..]
            && agrees(&lower, &next)
            && agrees(&lower, &last)
        {
            return (order - 2, lower);
        }
    }
    (HIGHEST_ORDER, all[all.len() - 1])
}

/// Noise from the median size of the differences: what is seldom does not move it.
pub(super) fn robust_of_samples(times_s: &[f64], angles_rad: &[f64]) -> f64 {
    let none_frozen = vec![false; angles_rad.len()];
    let (order, _) = agreeing_order(times_s, angles_rad, &none_frozen);
    let windows = times_s.windows(order + 1).zip(angles_rad.windows(order + 1));
    robust_spread(&windows.map(|(times_s, angles_rad)| difference(times_s, angles_rad)).collect::<Vec<f64>>())
}

/// Sums of squared differences of one order.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Differences {
    sum_of_squares: f64,
    pub(super) n_windows: usize,
}

impl Differences {
    pub(super) fn rms(&self) -> f64 {
        (self.sum_of_squares / self.n_windows.max(1) as f64).sqrt()
    }

    fn of_order(order: usize, times_s: &[f64], angles_rad: &[f64], frozen: &[bool]) -> Self {
        let step_s = median_step_s(times_s);
        let of_even = weights(&(0..=order).map(|idx| idx as f64 * step_s).collect::<Vec<f64>>());
        // How many steps in a row, up to here, are no gap, and even.
        let (mut n_whole, mut n_even) = (0, 0);
        let mut differences = Self::default();
        for end in 1..times_s.len() {
            let this_s = times_s[end] - times_s[end - 1];
            n_whole = if this_s > GAP_STEPS * step_s { 0 } else { n_whole + 1 };
            n_even = if (this_s - step_s).abs() > EVEN * step_s { 0 } else { n_even + 1 };
            if n_whole < order || frozen[end - order] {
                continue;
            }
            let window = end - order..end + 1;
            let difference = if n_even < order {
                difference(&times_s[window.clone()], &angles_rad[window])
            } else {
                weighted(&of_even, &angles_rad[window])
            };
            differences.sum_of_squares += difference.powi(2);
            differences.n_windows += 1;
        }
        differences
    }
}

/// The divided difference of a window, scaled so that white noise keeps its variance.
fn difference(times_s: &[f64], angles_rad: &[f64]) -> f64 {
    weighted(&weights(times_s), angles_rad)
}

fn weighted(weights: &[f64], angles_rad: &[f64]) -> f64 {
    weights.iter().zip(angles_rad).map(|(weight, angle_rad)| weight * angle_rad).sum()
}

/// Of the divided difference over these times, scaled so that their squares add up to 1.
fn weights(times_s: &[f64]) -> Vec<f64> {
    let span_s = times_s[times_s.len() - 1] - times_s[0];
    let of_one = |(j, time_s): (usize, &f64)| {
        let others = times_s.iter().enumerate().filter(|(i, _)| *i != j);
        others.map(|(_, other_s)| (time_s - other_s) / span_s).product::<f64>().recip()
    };
    let mut weights: Vec<f64> = times_s.iter().enumerate().map(of_one).collect();
    let size = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
    weights.iter_mut().for_each(|weight| *weight /= size);
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_even_times_are_binomial_and_even_times_are_a_matter_of_rounding() {
        let binomial = [1.0, -4.0, 6.0, -4.0, 1.0].map(|weight: f64| weight / 70.0_f64.sqrt());
        let found = weights(&[0.0, 0.01, 0.02, 0.03, 0.04]);
        assert!(found.iter().zip(binomial).all(|(found, weight)| (found - weight).abs() < 1e-12), "{found:?}");
        // A cubic leaves nothing, whatever the times; taken for even ones, these leave 4e-6.
        let even_s: Vec<f64> = (0..40).map(|idx| f64::from(idx) / 100.0).collect();
        let mut uneven_s = even_s.clone();
        (0..40).step_by(3).for_each(|idx| uneven_s[idx] += 1e-6);
        for times_s in [even_s, uneven_s] {
            let cubic: Vec<f64> = times_s.iter().map(|time_s| 5.0 * time_s - 30.0 * time_s.powi(3)).collect();
            let found = Differences::of_order(4, &times_s, &cubic, &[false; 40]);
            assert!(found.rms() < 1e-12 && found.n_windows == 36, "{found:?}");
        }
    }
}
