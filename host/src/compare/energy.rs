//! Pictures without a model beside the modelled ones: energy lost per path, period, and the difference between both
//! sides, against amplitude.

use super::binned::{Mean, Sample, binned, mean};
use super::halves::{HalfSwing, Halves, Period, read_off};
use serde::Serialize;

/// A difference this many standard errors from zero is a finding …
const SIGNIFICANT: f64 = 4.5;

/// … if it is more than this share of the modelled loss …
const LOSS_SHARE: f64 = 0.04;

/// … or of the period.
const PERIOD_SHARE: f64 = 5e-4;

/// Periods are known about this well per unit of relative noise: crossings average over some samples.
const PERIOD_NOISE: f64 = 0.15;

/// What energy and period show.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Energy {
    /// Measured minus modelled loss per path against amplitude (rad, N·m).
    pub loss_missing: Vec<Mean>,
    /// Measured loss per path against amplitude (rad, N·m).
    pub loss_measured: Vec<Mean>,
    /// Relative difference of the period against amplitude (rad, 1).
    pub period_off: Vec<Mean>,
    /// Loss of rising minus falling half swings beyond the model's (N·m).
    pub side_difference: Option<Mean>,
    /// Amplitude at which the measured loss has a bump, rad.
    pub bump_rad: Option<f64>,
    /// Modelled loss at mid amplitude, to compare with, N·m.
    pub usual_loss_nm: f64,
}

/// Measured and modelled motion of one recording.
#[derive(Clone, Debug, Default)]
pub struct Pair {
    /// As measured.
    pub measured: Halves,
    /// As modelled in a free run.
    pub modelled: Halves,
    /// Noise of the angle, rad.
    pub noise_rad: f64,
}

/// Compares loss and period of all recordings.
pub fn energy(pairs: &[Pair]) -> Energy {
    let curve = |rising: bool| {
        let of_side = pairs.iter().flat_map(|pair| &pair.modelled.halves).filter(|half| half.is_rising == rising);
        sorted(of_side.map(|half| (half.amplitude_rad, half.loss_nm)).collect())
    };
    let curves = [curve(false), curve(true)];
    let all: Vec<&HalfSwing> = pairs.iter().flat_map(|pair| &pair.measured.halves).collect();
    let missing = |half: &HalfSwing| {
        let modelled = read_off(&curves[usize::from(half.is_rising)], half.amplitude_rad)?;
        Some(Sample { x: half.amplitude_rad, value: half.loss_nm - modelled, spread: half.loss_spread_nm })
    };
    let differences = |rising: bool| -> Vec<Sample> {
        all.iter().filter(|half| half.is_rising == rising).filter_map(|half| missing(half)).collect()
    };
    let [falling, rising] = [differences(false), differences(true)];
    let side = |half: &&HalfSwing| Sample { x: half.amplitude_rad, value: half.loss_nm, spread: half.loss_spread_nm };
    let loss_measured = binned(&all.iter().map(side).collect::<Vec<_>>());
    let modelled: Vec<f64> = curves.iter().flatten().map(|point| point.1).collect();
    Energy {
        side_difference: side_difference(&rising, &falling),
        loss_missing: binned(&[falling, rising].concat()),
        period_off: binned(&pairs.iter().flat_map(|pair| periods_off(pair, pairs)).collect::<Vec<_>>()),
        bump_rad: bump(&loss_measured),
        loss_measured,
        usual_loss_nm: modelled.iter().sum::<f64>() / modelled.len().max(1) as f64,
    }
}

impl Energy {
    /// Bins in which the pendulum loses significantly more or less than modelled.
    pub fn losses_off(&self) -> Vec<&Mean> {
        let matters = |mean: &&Mean| mean.value.abs() > LOSS_SHARE * self.usual_loss_nm.abs();
        self.loss_missing.iter().filter(matters).filter(|mean| mean.z().abs() > SIGNIFICANT).collect()
    }

    /// Bins in which the period is significantly off.
    pub fn periods_off(&self) -> Vec<&Mean> {
        let matters = |mean: &&Mean| mean.value.abs() > PERIOD_SHARE && mean.z().abs() > SIGNIFICANT;
        self.period_off.iter().filter(matters).collect()
    }

    /// The sides' difference, if it is significant.
    pub fn sides_differ(&self) -> Option<&Mean> {
        let matters = |mean: &&Mean| mean.value.abs() > LOSS_SHARE * self.usual_loss_nm.abs();
        self.side_difference.as_ref().filter(matters).filter(|mean| mean.z().abs() > SIGNIFICANT)
    }
}

fn sorted(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

fn side_difference(rising: &[Sample], falling: &[Sample]) -> Option<Mean> {
    if rising.len() < 3 || falling.len() < 3 {
        return None;
    }
    let (up, down) = (mean(rising), mean(falling));
    let spread = up.spread.hypot(down.spread);
    Some(Mean { x: up.x, value: up.value - down.value, spread, n: up.n + down.n })
}

fn periods_off(pair: &Pair, pairs: &[Pair]) -> Vec<Sample> {
    let modelled = pairs.iter().flat_map(|pair| &pair.modelled.periods);
    let curve = sorted(modelled.map(|period| (period.amplitude_rad, period.period_s)).collect());
    let off = |period: &Period| {
        let expected_s = read_off(&curve, period.amplitude_rad)?;
        let value = period.period_s / expected_s - 1.0;
        let spread = PERIOD_NOISE * pair.noise_rad / period.amplitude_rad;
        Some(Sample { x: period.amplitude_rad, value, spread })
    };
    pair.measured.periods.iter().filter_map(off).collect()
}

/// Where the loss rises above both sides; Coulomb, viscous and drag friction rise with amplitude throughout.
fn bump(losses: &[Mean]) -> Option<f64> {
    let beyond = |top: &Mean, other: &Mean| {
        let difference = top.value - other.value;
        difference > SIGNIFICANT * top.spread.hypot(other.spread) && difference > LOSS_SHARE * top.value
    };
    let is_top = |k: &usize| {
        let (below, above) = (&losses[..*k], &losses[k + 1..]);
        let highest_near = losses[k.saturating_sub(1)..(k + 2).min(losses.len())].iter().all(|m| m.value <= losses[*k].value);
        highest_near && below.iter().any(|m| beyond(&losses[*k], m)) && above.iter().any(|m| beyond(&losses[*k], m))
    };
    (0..losses.len()).find(is_top).map(|k| losses[k].x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loss_that_only_rises_has_no_bump() {
        let mean = |x: f64, value: f64| Mean { x, value, spread: 0.01, n: 5 };
        let rising: Vec<Mean> = (0..8).map(|k| mean(f64::from(k), 1.0 + 0.1 * f64::from(k))).collect();
        assert_eq!(bump(&rising), None);
        let mut bumpy = rising.clone();
        bumpy[2].value = 2.0;
        assert_eq!(bump(&bumpy), Some(2.0));
    }
}
