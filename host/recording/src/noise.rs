//! The noise of a recording, from the recording itself.
//!
//! In: raw times (s) and angles (rad). Out: total rms (rad) = white noise and quantisation together, and its parts.
//! Differences of order k, `Σ wⱼ θⱼ` over k + 1 neighbours with weights that cancel every polynomial below degree k and
//! have Σ w² = 1, leave the noise and nearly nothing of the motion. With even steps they are binomial (the fourth:
//! 1 −4 6 −4 1 over √70); with uneven ones they are divided differences with the true times.
//! Fourth differences serve from 100 Hz on; slower recordings leak motion, so the order rises until two more orders
//! change nothing; of a swing with few samples a period pieces are fitted with sinusoids (`sinusoids`). On simulated rigs
//! of known noise (0.6–1.8 steps of the converter, 200–400 Hz) within 2 %.
//! J. von Neumann et al., Ann. Math. Stat. 12 (1941) 153, is the idea with first differences.

mod colour;
mod sinusoids;
mod still;

use std::ops::Range;

use crate::{Recording, median_step_s};
use serde::Serialize;

pub use colour::Colour;
pub(crate) use still::noise_of_means;
pub use still::{SlowExcess, slow_excess};

/// The first order tried.
const LOWEST_ORDER: usize = 4;

/// The last order tried: beyond it the window spans too much of a swing at the rates where it would be needed.
const HIGHEST_ORDER: usize = 10;

/// Two orders agree when they differ by less than this and chance.
const AGREEMENT: f64 = 0.01;

/// A window across a step longer than this many median steps is left out.
pub(crate) const GAP_STEPS: f64 = 1.5;

/// A step that is off the median by less than this share is even: so little are numbers rounded, and 10 rad/s then leak less
/// than a nanoradian.
const EVEN: f64 = 1e-9;

/// Samples of a block that is tested for being frozen.
const BLOCK: usize = 32;

/// Fewer still samples than this give no noise of their own.
const MIN_STILL: usize = 20;

/// Noise beyond so many times what most samples have is not theirs: that of a camera that blurs, or of rates that are worse the
/// faster it swings, is within a few times of it. A reading on the other side of a swing of 30° in 25 frames a second makes it 30
/// times. Half and twice: that reading is told as well.
const OUTWEIGHED: f64 = 8.0;

/// The median size of what is normally distributed, in standard deviations.
const MEDIAN_SIZE: f64 = 0.6745;

/// Noise of a recording; all rms values in rad.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Noise {
    /// White noise and quantisation together, from differences of neighbours.
    pub total_rms: f64,
    /// Smallest step of the sensor; `None` when the angles are not in steps.
    pub lsb: Option<f64>,
    /// Step / √12; 0 without steps.
    pub quantisation_rms: f64,
    /// What remains of the total.
    pub white_rms: f64,
    /// Scatter of the stillest still stretch.
    pub still_rms: Option<f64>,
    /// Present if neighbours are not independent while the pendulum hangs still: then they say too little or too much.
    #[serde(rename = "is_coloured", serialize_with = "is_there")]
    pub colour: Option<Colour>,
    /// Does it wander while the pendulum is held, and is there no rest to tell the sensor from a hand?
    #[serde(skip)]
    pub wanders_where_held: bool,
    /// How it was found, in words.
    #[serde(skip)]
    pub method: String,
}

impl Noise {
    /// What a perfect model leaves, rad.
    pub fn level_rad(&self) -> f64 {
        match self.still_rms {
            Some(still_rms) if self.colour.is_some() => still_rms,
            _ => self.total_rms,
        }
    }
}

fn is_there<S: serde::Serializer>(colour: &Option<Colour>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(colour.is_some())
}

/// Noise of a whole recording from differences of neighbours; motion does not disturb it.
pub fn estimate(recording: &Recording) -> Noise {
    of_part(recording, 0..recording.len())
}

/// The same of a part of it: where it was put down or let go, the angle may jump.
pub fn of_part(recording: &Recording, part: Range<usize>) -> Noise {
    of_samples(&recording.times_s()[part.clone()], &recording.angles_rad()[part], lsb(recording))
}

/// Smallest step of a recording's sensor, rad.
fn lsb(recording: &Recording) -> Option<f64> {
    let header = recording.header();
    if let (Some(_), Some(calibration)) = (&header.sensor, header.calibration) {
        // It counts, so that a code is a step, however few of them there are.
        return Some(calibration.radians_per_code.abs());
    }
    match (recording.codes(), header.calibration) {
        (Some(codes), Some(calibration)) => {
            let codes: Vec<f64> = codes.iter().map(|code| f64::from(*code)).collect();
            smallest_step(&codes).map(|step| step * calibration.radians_per_code.abs())
        }
        _ => smallest_step(recording.angles_rad()),
    }
}

/// Noise of bare samples, with the sensor's step if it is known.
pub fn of_samples(times_s: &[f64], angles_rad: &[f64], lsb: Option<f64>) -> Noise {
    let frozen = frozen_blocks(angles_rad, lsb);
    let (order, differences) = agreeing_order(times_s, angles_rad, &frozen);
    // Both are upper bounds.
    if let Some(rms) = sinusoids::rms(times_s, angles_rad, &frozen, differences.rms())
        && rms < differences.rms()
    {
        return with_parts(rms, lsb, "what pieces of a few periods leave beyond sinusoids".to_owned());
    }
    let method = format!("differences of order {order} over {} windows", differences.n_windows);
    with_parts(differences.rms(), lsb, method)
}

/// The same from the median size of the differences: what is seldom does not move it.
fn robust_of_samples(times_s: &[f64], angles_rad: &[f64]) -> f64 {
    let none_frozen = vec![false; angles_rad.len()];
    let (order, _) = agreeing_order(times_s, angles_rad, &none_frozen);
    let windows = times_s.windows(order + 1).zip(angles_rad.windows(order + 1));
    robust_spread(&windows.map(|(times_s, angles_rad)| difference(times_s, angles_rad)).collect::<Vec<f64>>())
}

/// White noise (rms) of most samples where a few outweigh all others, as when a tracker takes another point; else the noise as
/// it is.
pub(crate) fn of_most_samples(times_s: &[f64], angles_rad: &[f64], noise: &Noise) -> f64 {
    let most = robust_of_samples(times_s, angles_rad).max(noise.quantisation_rms);
    if most > 0.0 && noise.total_rms > OUTWEIGHED * most { most } else { noise.total_rms }
}

/// Noise of a stretch in which the pendulum is still (held before the release, or at rest); a slow drift is removed.
/// `None` for a stretch that is too short, or frozen within one step of the sensor.
pub fn of_still(recording: &Recording, still: Range<usize>) -> Option<Noise> {
    let angles_rad = recording.angles_rad().get(still)?;
    let n = angles_rad.len();
    if n < MIN_STILL {
        return None;
    }
    let lsb = lsb(recording);
    let rms = rms_about_line(angles_rad);
    let is_frozen = rms < lsb.unwrap_or(0.0) / 4.0 || rms == 0.0;
    (!is_frozen).then(|| with_parts(rms, lsb, format!("scatter of {n} still samples")))
}

/// Splits the total. With a step the total cannot be below step / √12 while the pendulum moves across many steps.
fn with_parts(rms: f64, lsb: Option<f64>, method: String) -> Noise {
    let quantisation_rms = lsb.unwrap_or(0.0) / 12f64.sqrt();
    let total_rms = rms.max(quantisation_rms);
    let white_rms = (total_rms.powi(2) - quantisation_rms.powi(2)).sqrt();
    Noise {
        total_rms,
        lsb,
        quantisation_rms,
        white_rms,
        still_rms: None,
        colour: None,
        wanders_where_held: false,
        method,
    }
}

/// Sums of squared differences of one order.
#[derive(Debug, Clone, Copy, Default)]
struct Differences {
    sum_of_squares: f64,
    n_windows: usize,
}

impl Differences {
    fn rms(&self) -> f64 {
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

/// Standard deviation of what is normally distributed about zero, by its median size: what is seldom does not move it.
pub(crate) fn robust_spread(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() { 0.0 } else { *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN_SIZE }
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

/// The lowest order that the next two confirm; the highest when none is.
fn agreeing_order(times_s: &[f64], angles_rad: &[f64], frozen: &[bool]) -> (usize, Differences) {
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

/// Where a stepped sensor shows at most two neighbouring values for a whole block it tells nothing about the noise.
/// Nothing is left out when everything is frozen.
fn frozen_blocks(angles_rad: &[f64], lsb: Option<f64>) -> Vec<bool> {
    let step = 1.01 * lsb.unwrap_or(0.0);
    let is_frozen = |block: &[f64]| {
        let lowest = block.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = block.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        highest - lowest <= step
    };
    let frozen: Vec<bool> =
        angles_rad.chunks(BLOCK).flat_map(|block| std::iter::repeat_n(is_frozen(block), block.len())).collect();
    if frozen.iter().all(|frozen| *frozen) { vec![false; angles_rad.len()] } else { frozen }
}

/// The step of which all distances between neighbouring distinct values are multiples; `None` when there is none.
pub fn smallest_step(values: &[f64]) -> Option<f64> {
    /// A distance fits when it is off a whole number of steps by less than this share of a step.
    const FIT: f64 = 0.05;
    /// This share must fit; encoders with a few uneven lines still count as stepped.
    const SHARE: f64 = 0.7;
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let mut distances: Vec<f64> =
        sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|distance| *distance > 1e-12).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let candidate = *distances.get(distances.len() / 10)?;
    let whole = |distance: &f64| (distance / candidate).round();
    let fitting: Vec<f64> = distances
        .iter()
        .copied()
        .filter(|distance| (distance / candidate - whole(distance)).abs() < FIT && whole(distance) > 0.0)
        .collect();
    let is_stepped = fitting.len() as f64 >= SHARE * distances.len() as f64;
    is_stepped.then(|| fitting.iter().sum::<f64>() / fitting.iter().map(whole).sum::<f64>())
}

/// Scatter about a straight line (rms), in the unit of the values.
pub fn rms_about_line(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let centred = |idx: usize| idx as f64 - (n - 1.0) / 2.0;
    let spread: f64 = (0..values.len()).map(|idx| centred(idx).powi(2)).sum();
    let slope = values.iter().enumerate().map(|(idx, value)| centred(idx) * (value - mean)).sum::<f64>() / spread;
    let residuals = values.iter().enumerate().map(|(idx, value)| value - mean - slope * centred(idx));
    (residuals.map(|residual| residual * residual).sum::<f64>() / (n - 2.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Calibration, Header};

    /// A small generator with a seed, good enough for noise (Knuth's MMIX constants, upper bits, sum of twelve).
    struct Random(u64);

    impl Random {
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
        }
    }

    const LSB: f64 = 0.001_448_74;

    /// Twenty seconds and more of an anharmonic decaying swing with noise and steps.
    fn swing(rate_hz: f64, angular_hz: f64, sigma_rad: f64, lsb: f64, seed: u64) -> Recording {
        let mut random = Random(seed);
        let n = (rate_hz * 40.0).clamp(10000.0, 20000.0) as usize;
        let angle = |time_s: f64| {
            let phase = angular_hz * time_s;
            1.3 * (-0.02 * time_s).exp() * (phase.cos() + 0.01 * (3.0 * phase).cos())
        };
        let angles_rad: Vec<f64> = (0..n)
            .map(|idx| angle(idx as f64 / rate_hz) + sigma_rad * random.normal())
            .map(|angle_rad| if lsb > 0.0 { (angle_rad / lsb).round() * lsb } else { angle_rad })
            .collect();
        Recording::uniform(rate_hz, angles_rad).unwrap()
    }

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

    #[test]
    fn noise_of_half_to_three_steps_is_found_within_three_percent() {
        for rate_hz in [100.0, 200.0, 500.0, 1000.0] {
            for n_steps in [0.5, 1.0, 3.0] {
                let noise = estimate(&swing(rate_hz, 8.5, n_steps * LSB, LSB, 7));
                let expected = LSB * (n_steps * n_steps + 1.0 / 12.0_f64).sqrt();
                let ratio = noise.total_rms / expected;
                assert!((ratio - 1.0).abs() < 0.03, "{rate_hz} Hz, {n_steps} steps: {ratio} ({})", noise.method);
                assert!((noise.lsb.unwrap() / LSB - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn slow_sampling_is_answered_by_a_higher_order() {
        let noise = estimate(&swing(20.0, 4.0, 1.5e-3, 0.0, 11));
        assert!((noise.total_rms / 1.5e-3 - 1.0).abs() < 0.06, "{noise:?}");
        assert_eq!(noise.lsb, None);
    }

    #[test]
    fn six_to_twelve_samples_a_period_are_enough() {
        // A swing from 1 rad: a pendulum's third harmonic is θ³/192 of it, and its frequency falls by θ²/16.
        let angle = |time_s: f64| {
            let size = (-time_s / 300.0_f64).exp();
            let phase = 6.0 * (time_s - 300.0 / 32.0 * (1.0 - size * size));
            size * phase.cos() - size.powi(3) / 192.0 * (3.0 * phase).cos()
        };
        for n_samples in [6.0, 6.5, 7.0, 8.0, 10.0, 12.0] {
            for sigma_rad in [5e-4, 5e-3] {
                let mut random = Random(13);
                let times_s: Vec<f64> =
                    (0..600).map(|idx| f64::from(idx) * std::f64::consts::TAU / 6.0 / n_samples).collect();
                let angles_rad: Vec<f64> = times_s.iter().map(|t| angle(*t) + sigma_rad * random.normal()).collect();
                let noise = of_samples(&times_s, &angles_rad, None);
                let ratio = noise.total_rms / sigma_rad;
                assert!((0.9..1.1).contains(&ratio), "{n_samples} a period, {sigma_rad}: {ratio} ({})", noise.method);
            }
        }
    }

    #[test]
    fn a_swing_without_noise_has_the_noise_of_its_steps() {
        let noise = estimate(&swing(200.0, 8.5, 0.0, LSB, 1));
        assert!((noise.total_rms / (LSB / 12f64.sqrt()) - 1.0).abs() < 0.1, "{noise:?}");
    }

    #[test]
    fn jitter_of_the_clock_does_not_become_noise_when_the_times_are_true() {
        let mut random = Random(3);
        let times_s: Vec<f64> = (0..4000).map(|idx| 0.005 * f64::from(idx) + 0.001 * random.uniform()).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|t| (8.0 * t).sin() + 1e-3 * random.normal()).collect();
        let noise = of_samples(&times_s, &angles_rad, None);
        assert!((noise.total_rms / 1e-3 - 1.0).abs() < 0.03, "{noise:?}");
    }

    #[test]
    fn numbers_that_are_not_in_steps_have_no_smallest_step() {
        let mut random = Random(5);
        let values: Vec<f64> = (0..3000).map(|_| (random.normal() * 1e6).round() / 1e6).collect();
        assert_eq!(smallest_step(&values), None);
        assert_eq!(smallest_step(&[1.0; 30]), None);
    }

    #[test]
    fn still_samples_give_their_scatter_and_a_drift_does_not_count() {
        let mut random = Random(9);
        let angles_rad = (0..5000).map(|idx| 0.3 + 1e-6 * f64::from(idx) + 1e-3 * random.normal()).collect();
        let recording = Recording::uniform(500.0, angles_rad).unwrap();
        let noise = of_still(&recording, 0..5000).unwrap();
        assert!((noise.total_rms / 1e-3 - 1.0).abs() < 0.03, "{noise:?}");
        assert_eq!(of_still(&recording, 0..5), None);
    }

    /// Half swinging across many steps, half held about an angle, all in steps; so many steps of noise where it is held.
    fn held_after_a_swing(noise_steps: impl Fn(usize) -> f64) -> Recording {
        let angle_steps = |idx: usize| {
            if idx < 2000 { (500.0 * (0.05 * idx as f64).sin()).round() } else { (100.0 + noise_steps(idx)).round() }
        };
        Recording::uniform(200.0, (0..4000).map(|idx| LSB * angle_steps(idx)).collect()).unwrap()
    }

    #[test]
    fn still_samples_in_steps_have_white_noise_beside_that_of_the_steps() {
        let mut random = Random(15);
        let noise_steps: Vec<f64> = (0..4000).map(|_| 0.7 * random.normal()).collect();
        let noise = of_still(&held_after_a_swing(|idx| noise_steps[idx]), 2000..4000).unwrap();
        // Chance alone is 1.6 % for 2000 samples.
        assert!((noise.white_rms / (0.7 * LSB) - 1.0).abs() < 0.05, "{noise:?}");
        assert!((noise.quantisation_rms / (LSB / 12f64.sqrt()) - 1.0).abs() < 1e-6, "{noise:?}");
        assert!((noise.total_rms - noise.white_rms.hypot(noise.quantisation_rms)).abs() < 1e-12);
    }

    #[test]
    fn still_samples_within_one_step_tell_no_noise() {
        // One of forty is a step off: the scatter is √(1/40 · 39/40) = 0.16 steps.
        let recording = held_after_a_swing(|idx| f64::from(idx % 40 == 0));
        assert_eq!(of_still(&recording, 2000..4000), None);
        assert_eq!(of_still(&held_after_a_swing(|_| 0.0), 2000..4000), None);
    }

    #[test]
    fn a_rest_within_one_step_does_not_dilute_the_noise_of_the_swing() {
        let mut random = Random(17);
        let angle_steps = |idx: usize| {
            let size_steps = 500.0 * (1.0 - idx as f64 / 4000.0);
            if idx < 4000 { size_steps * (0.05 * idx as f64).sin() + random.normal() } else { 0.0 }
        };
        let steps: Vec<f64> = (0..8000).map(angle_steps).collect();
        let recording = Recording::uniform(200.0, steps.iter().map(|n| LSB * n.round()).collect()).unwrap();
        let noise = estimate(&recording);
        let expected = LSB * (1.0 + 1.0 / 12.0_f64).sqrt();
        assert!((noise.total_rms / expected - 1.0).abs() < 0.04, "{noise:?}");
    }

    #[test]
    fn recorded_codes_tell_the_step_by_the_calibration() {
        let codes: Vec<u16> = (0..400).map(|idx| (2000.0 + 300.0 * (0.1 * f64::from(idx)).sin()) as u16).collect();
        let calibration = Calibration { zero_code: 2000.0, radians_per_code: -0.002 };
        let angles_rad: Vec<f64> = codes.iter().map(|code| calibration.angle_rad(*code)).collect();
        let times_s = (0..400).map(|idx| f64::from(idx) / 100.0).collect();
        let header = Header { calibration: Some(calibration), ..Header::default() };
        let recording = Recording::new(header, times_s, angles_rad, Some(codes)).unwrap();
        assert!((estimate(&recording).lsb.unwrap() / 0.002 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn distances_far_below_a_step_do_not_count_for_one() {
        // 13 of 20 distances are a step: fewer than the share that makes steps.
        let distances = [vec![0.01; 2], vec![1.0; 13], vec![1.5; 5]].concat();
        let sums = |distances: &[f64]| -> Vec<f64> {
            (0..=distances.len()).map(|n| distances[..n].iter().sum::<f64>()).collect()
        };
        assert_eq!(smallest_step(&sums(&distances)), None);
        assert_eq!(smallest_step(&sums(&distances[2..17])), Some(1.0));
    }

    #[test]
    fn scatter_about_a_line_has_two_degrees_of_freedom_less_than_samples() {
        // 1, −1, −1, 1 has neither mean nor slope: Σ r² / (4 − 2) = 2.
        let values: Vec<f64> =
            [1.0, -1.0, -1.0, 1.0].iter().enumerate().map(|(i, r)| 5.0 + 3.0 * i as f64 + r).collect();
        assert!((rms_about_line(&values) - 2f64.sqrt()).abs() < 1e-12);
    }
}
