//! What drives the pendulum, as another column of the file tells it: a motor's command, voltage, current or torque.
//!
//! In: the numbers of such a column, one a sample. Out: where they move. A pendulum that a motor drives does not swing
//! freely, and its friction can't be found from how its swings become smaller.

use super::median;
use std::ops::Range;

/// A motor whose number is within this share of its largest is off: so little does not overcome its own friction. Half of it
/// would take the offset of a current sensor for a motor; twice of it is torque enough for a pendulum as light as its motor
/// can lift.
const OFF_SHARE: f64 = 0.01;

/// Standard deviations by which numbers that a motor makes follow each other more or less than by chance.
const SURE: f64 = 6.0;

/// So many samples a filter of a sensor may reach; a pendulum's period has more. Of one size alone a swing of four blocks would
/// be noise.
const BLOCKS: [usize; 3] = [8, 12, 16];

/// A column of the file that moves the pendulum where it moves itself.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drive {
    /// What messages call it.
    pub(super) column: String,
    values: Vec<f64>,
    off: f64,
    off_within: f64,
}

impl Drive {
    /// A column of as many numbers as there are samples, NaN where it says none; `None` where it never moves.
    pub(super) fn of(column: String, values: Vec<f64>) -> Option<Self> {
        let known = || values.iter().copied().filter(|value| value.is_finite());
        let first = known().next()?;
        if known().all(|value| value == first) {
            return None;
        }
        let off = if known().any(|value| value == 0.0) { 0.0 } else { most_common(known()) };
        let furthest = known().fold(0.0, |furthest, value| f64::max(furthest, (value - off).abs()));
        let off_within = OFF_SHARE * furthest;
        let drive = Self { column, values, off, off_within };
        (!drive.is_noise(&(0..drive.values.len()))).then_some(drive)
    }

    /// The same of a part of the samples.
    pub(super) fn part(&self, range: Range<usize>) -> Option<Self> {
        Some(Self { values: self.values.get(range)?.to_vec(), column: self.column.clone(), ..*self })
    }

    /// Is it on at a sample?
    pub(super) fn moves_at(&self, idx: usize) -> bool {
        self.values.get(idx).is_some_and(|value| (value - self.off).abs() > self.off_within)
    }

    /// Smallest and largest number within a range, and the share of samples at which it is on; `None` where it stands
    /// still, or trembles by chance as the sensor of a motor does that is off.
    pub(super) fn within(&self, range: &Range<usize>) -> Option<(f64, f64, f64)> {
        let n_on = range.clone().filter(|idx| self.moves_at(*idx)).count();
        if n_on == 0 || self.is_noise(range) {
            return None;
        }
        let known = self.values.get(range.clone())?.iter().filter(|value| value.is_finite());
        let (low, high) = known.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
        Some((low, high, n_on as f64 / range.len() as f64))
    }

    /// Does each number tell nothing of the next, or some of them together nothing of as many behind, as in the noise of a
    /// sensor with a filter?
    fn is_noise(&self, range: &Range<usize>) -> bool {
        let values = self.values.get(range.clone()).unwrap_or_default();
        let mean = |block: &[f64]| block.iter().sum::<f64>() / block.len() as f64;
        let means = |size: usize| values.chunks_exact(size).map(mean).collect::<Vec<f64>>();
        is_white(values) || BLOCKS.iter().all(|size| is_white(&means(*size)))
    }
}

/// Of n numbers without a word of each other the mean square of a step is twice the variance, give or take 2/√n (von Neumann
/// 1941). Few numbers can't tell, and are not taken for noise.
fn is_white(values: &[f64]) -> bool {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n;
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>() / (n - 1.0);
    let spread = SURE * 2.0 / n.sqrt();
    spread < 1.0 && (steps / variance - 2.0).abs() < spread
}

/// Where none of these drives is on, of a range of samples.
pub(super) fn undriven(drives: &[Drive], within: Range<usize>) -> Vec<Range<usize>> {
    let is_on = |idx: &usize| drives.iter().any(|drive| drive.moves_at(*idx));
    let idxs: Vec<usize> = within.collect();
    let runs = idxs.chunk_by(|a, b| is_on(a) == is_on(b)).filter(|run| !is_on(&run[0]));
    runs.map(|run| run[0]..run[run.len() - 1] + 1).collect()
}

/// The number that stands there most often, of equals the middle one.
fn most_common(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let most = sorted.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap_or(0);
    let mut all: Vec<f64> = sorted.chunk_by(|a, b| a == b).filter(|run| run.len() == most).map(|run| run[0]).collect();
    median(&mut all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(value: impl Fn(usize) -> f64) -> Option<Drive> {
        Drive::of("2 (u)".to_owned(), (0..1000).map(value).collect())
    }

    /// From -0.5 to 0.5, each number without a word of the next.
    fn chance(idx: usize) -> f64 {
        let mixed = (idx as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((mixed ^ (mixed >> 27)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    #[test]
    fn a_motor_is_on_where_its_number_is_not_that_of_rest() {
        let pulse = |off: f64, on: f64| drive(move |idx| if (100..300).contains(&idx) { on } else { off }).unwrap();
        for drive in [pulse(0.0, 255.0), pulse(1500.0, 1600.0), pulse(0.0, -3.0)] {
            assert_eq!(undriven(std::slice::from_ref(&drive), 0..1000), [0..100, 300..1000]);
            assert_eq!(drive.within(&(300..1000)), None);
        }
        assert_eq!(pulse(0.0, 255.0).within(&(0..400)), Some((0.0, 255.0, 0.5)));
        assert_eq!(pulse(0.0, 255.0).part(250..500).unwrap().within(&(0..250)), Some((0.0, 255.0, 0.2)));
    }

    #[test]
    fn an_offset_of_a_hundredth_is_no_motor_and_few_numbers_are_no_noise() {
        let step = |idx: usize| if idx < 100 { 0.0 } else { 0.02 };
        let drive = drive(|idx| if (100..300).contains(&idx) { 3.0 } else { step(idx) }).unwrap();
        assert_eq!(undriven(std::slice::from_ref(&drive), 0..1000), [0..100, 300..1000]);
        assert!(Drive::of(String::new(), (0..60).map(chance).collect()).is_some());
    }

    #[test]
    fn a_number_that_stands_still_or_trembles_drives_nothing() {
        assert_eq!(drive(|_| 0.0), None);
        assert_eq!(drive(|_| f64::NAN), None);
        assert_eq!(drive(|idx| 0.02 * chance(idx)), None);
        // The sensor of a current trembles by more than its hundredth where the motor is off.
        let current = drive(|idx| 0.1 * chance(idx) + if idx < 300 { 2.0 * (idx as f64 / 20.0).sin() } else { 0.0 });
        let current = current.unwrap();
        assert!(current.within(&(0..300)).is_some() && current.within(&(300..1000)).is_none());
        assert!(drive(|idx| (idx as f64 / 20.0).sin() + 0.5 * chance(idx)).is_some());
    }

    #[test]
    fn filtered_noise_drives_nothing_and_a_swing_of_four_blocks_does() {
        let long = |value: &dyn Fn(usize) -> f64| Drive::of(String::new(), (0..4000).map(value).collect());
        let filtered = |idx: usize| (0..6).map(|back| 0.6_f64.powi(back) * chance(1000 + idx - back as usize)).sum();
        assert_eq!(long(&filtered), None);
        for block in BLOCKS {
            let swing =
                |idx: usize| (idx as f64 * std::f64::consts::TAU / (4 * block) as f64).sin() + 0.3 * chance(idx);
            assert!(long(&swing).is_some(), "{block}");
        }
    }
}
