//! Values that stand out from all others: each is compared with the mean and spread of the rest.
//!
//! In: values and how often a value may stand out by chance. Out: indices. The deleted residual `t = (x −
//! x̄₋)/(s₋·√(1 + 1/n₋))`, with mean and spread of the n₋ others, has Student's distribution with n₋ − 1 degrees of
//! freedom (R. D. Cook, S. Weisberg, Residuals and Influence in Regression, 1982, section 2.2). The worst one is
//! taken out and the rest asked again, up to a share of them; the last one that stands out from what is left then decides
//! how many do, so that one does not hide another (B. Rosner, Technometrics 25 (1983) 165; NIST/SEMATECH e-Handbook
//! 1.3.5.17.3).

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Fewer others don't say what is usual.
pub const FEWEST_OTHERS: usize = 5;

/// More than this share are no outliers but another population.
const MOST: f64 = 0.25;

/// Which side stands out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Large values only.
    Above,
    /// Both.
    Both,
}

/// Indices of values that stand out, sorted; by chance alone each value does with this probability.
pub fn outliers(values: &[f64], side: Side, by_chance: f64) -> Vec<usize> {
    let tails = if side == Side::Both { 2.0 } else { 1.0 };
    let mut kept: Vec<usize> = (0..values.len()).collect();
    let (mut taken, mut n_out) = (Vec::new(), 0);
    while kept.len() > FEWEST_OTHERS && (taken.len() as f64) < MOST * values.len() as f64 {
        let (place, t) = worst(values, &kept);
        let freedom = (kept.len() - 2) as f64;
        let beyond = StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |student| tails * student.sf(t.abs()));
        taken.push((kept.remove(place), t));
        if beyond < by_chance {
            n_out = taken.len();
        }
    }
    let counts = |t: f64| side == Side::Both || t > 0.0;
    let mut out: Vec<usize> = taken[..n_out].iter().filter(|(_, t)| counts(*t)).map(|(idx, _)| *idx).collect();
    out.sort_unstable();
    out
}

/// The largest or the smallest of the kept values, whichever stands out more, and how far in terms of the others.
fn worst(values: &[f64], kept: &[usize]) -> (usize, f64) {
    let by_value = |a: &usize, b: &usize| values[kept[*a]].total_cmp(&values[kept[*b]]);
    let largest = (0..kept.len()).max_by(by_value).unwrap_or(0);
    let smallest = (0..kept.len()).min_by(by_value).unwrap_or(0);
    let [above, below] = [largest, smallest].map(|place| (place, residual(values, kept, place)));
    if above.1.abs() >= below.1.abs() { above } else { below }
}

/// How far one of the kept values is above the others, in their terms.
fn residual(values: &[f64], kept: &[usize], place: usize) -> f64 {
    let others = || kept.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, idx)| values[*idx]);
    let n = (kept.len() - 1) as f64;
    let mean = others().sum::<f64>() / n;
    let variance = others().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let off = values[kept[place]] - mean;
    // Others that are all alike: whatever differs stands out.
    if off == 0.0 { 0.0 } else { off / (variance * (1.0 + n.recip())).sqrt().max(f64::MIN_POSITIVE) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_that_stand_out_do_not_hide_each_other_and_small_ones_are_left_alone() {
        let mut values: Vec<f64> = (0..20).map(|idx| f64::from(idx % 5) * 0.01).collect();
        assert_eq!(outliers(&values, Side::Both, 1e-4), [] as [usize; 0]);
        (values[3], values[11], values[15]) = (1.0, 1.2, -1.1);
        assert_eq!(outliers(&values, Side::Above, 1e-4), [3, 11]);
        assert_eq!(outliers(&values, Side::Both, 1e-4), [3, 11, 15]);
        assert_eq!(outliers(&values[..5], Side::Both, 1e-4), [] as [usize; 0]);
    }

    #[test]
    fn to_both_sides_a_value_is_half_as_unlikely() {
        // Mean 0 and variance 0.8 of six others; t of 5 degrees of freedom is beyond 3.365 in 1 % and beyond 4.032 in 0.5 %
        // (tables), on one side.
        let of = |t: f64, side: Side| {
            let far = t * (0.8_f64 * (1.0 + 1.0 / 6.0)).sqrt();
            outliers(&[-1.0, 0.0, 1.0, -1.0, 0.0, 1.0, far], side, 0.01).len()
        };
        assert_eq!([3.3, 3.5, 4.1].map(|t| of(t, Side::Above)), [0, 1, 1]);
        assert_eq!([3.3, 3.9, 4.1].map(|t| of(t, Side::Both)), [0, 0, 1]);
    }
}
