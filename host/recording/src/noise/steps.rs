//! The smallest step of a sensor, and where readings stay within one.

use crate::Recording;

/// Samples of a block that is tested for being frozen.
const BLOCK: usize = 32;

/// Smallest step of a recording's sensor, rad.
pub(super) fn lsb(recording: &Recording) -> Option<f64> {
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

/// Where a stepped sensor shows at most two neighbouring values for a whole block it tells nothing about the noise.
/// Nothing is left out when everything is frozen.
pub(super) fn frozen_blocks(angles_rad: &[f64], lsb: Option<f64>) -> Vec<bool> {
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
