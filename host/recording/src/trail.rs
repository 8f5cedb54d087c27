//! Readings that go on one way to the end, without noise: a tracker lost what it followed for good, and its program drew on to
//! where it was told that the video ends. Whoever takes that for a rest finds friction that never lets go.
//!
//! In: times and all lists of readings, in any unit. Out: from which row on nobody measured. A free pendulum turns within
//! each half swing, at rest it goes nowhere, a hand trembles, and a sensor that drifts has its noise.

use super::straight::white;
use super::turning;

/// A second difference is none below this share of the noise; white noise makes one of ten so small (the density of N(0, √6) at
/// 0 is 0.16). A line of a video bends by as much where its numbers are rounded to a tenth of the noise. Half and twice were not
/// tried.
const EXACT: f64 = 0.3;

/// So many of them in a row are no chance: of white noise 1 in 1e12.
const FEWEST: usize = 12;

/// The first row of those that go on one way to the end, for a half swing at least.
pub(super) fn trail(times_s: &[f64], lists: &[&[f64]]) -> Option<usize> {
    let readings = *lists.first()?;
    let first = lists.iter().map(|list| smooth_from(list)).max()?.max(one_way_from(readings));
    if first + FEWEST > readings.len() {
        return None;
    }
    let (before_s, before) = (&times_s[..first], &readings[..first]);
    let half_swing_s = turning::half_swing_s(before_s, before, white(before))?;
    (times_s.last()? - times_s[first] > half_swing_s).then_some(first)
}

/// What is said of them.
pub(super) fn note(first: usize, times_s: &[f64]) -> String {
    format!(
        "the {} readings from {:.3} s on go one way to the end without any noise and do not swing, as when a tracker lost it for \
         good and its frames were filled in: left out",
        times_s.len() - first,
        times_s[first]
    )
}

/// From which row on every step goes the way of the last one.
fn one_way_from(readings: &[f64]) -> usize {
    let goes = |pair: &[f64]| pair[1].total_cmp(&pair[0]);
    let last = readings.windows(2).next_back().map(goes).filter(|way| way.is_ne());
    readings.windows(2).rposition(|pair| Some(goes(pair)) != last).map_or(0, |idx| idx + 1)
}

/// From which row on no second difference is more than rounding beside the noise.
fn smooth_from(list: &[f64]) -> usize {
    let limit = EXACT * white(list);
    let is_bent = |three: &[f64]| (three[0] - 2.0 * three[1] + three[2]).abs() > limit;
    list.windows(3).rposition(is_bent).map_or(0, |idx| idx + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Forty seconds of a swing of 1.2 s at 30 samples a second with noise of a thousandth, and then twenty of this.
    fn found(then: impl Fn(f64) -> f64) -> Option<f64> {
        let mut noise = crate::random::Noise::new(5);
        let times_s: Vec<f64> = (0..1800_u32).map(|idx| f64::from(idx) / 30.0).collect();
        let swing = |t: f64, noise: f64| (-t / 20.0).exp() * (TAU / 1.2 * t).cos() + 1e-3 * noise;
        let reading = |t: &f64| if *t < 40.0 { swing(*t, noise.normal()) } else { then(*t - 40.0) };
        let readings: Vec<f64> = times_s.iter().map(reading).collect();
        trail(&times_s, &[&readings]).map(|first| times_s[first])
    }

    #[test]
    fn what_goes_on_one_way_to_the_end_is_no_reading() {
        let round = |reading: f64| (reading * 1e4).round() / 1e4;
        let begins = |then: Option<f64>| then.is_some_and(|first_s| (40.0..40.2).contains(&first_s));
        assert!(begins(found(|t| 0.1 - 0.004 * t)));
        assert!(begins(found(|t| round(0.2 - 0.009 * t + 1e-4 * t * t))));
    }

    #[test]
    fn a_rest_a_drift_with_noise_steps_and_a_swing_stay() {
        let tremble = |t: f64| 1e-3 * (1e4 * t * t).sin();
        assert_eq!(found(|_| 0.0), None);
        assert_eq!(found(|t| 0.1 - 0.004 * t + tremble(t)), None);
        assert_eq!(found(|t| (1e2 * (0.1 - 0.004 * t)).round() / 1e2), None);
        assert_eq!(found(|t| 0.1 * (TAU / 1.2 * t).cos()), None);
        assert_eq!(trail(&[], &[&[]]), None);
    }
}
