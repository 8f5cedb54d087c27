//! Pictures without a model beside the modelled ones: energy lost per path, period, and the difference between both
//! sides, against amplitude.

use super::binned::{Mean, Sample, binned, mean};
use super::halves::{Halves, Period, read_off};
use serde::Serialize;

/// A difference or a torque this many standard errors from zero is a finding …
pub(super) const SIGNIFICANT: f64 = 4.5;

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
    /// Mean of the modelled losses, to compare with, N·m.
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
    let modelled = pairs.iter().flat_map(|pair| pair.modelled.losses());
    let curve = sorted(modelled.map(|loss| (loss.amplitude_rad, loss.loss_nm)).collect());
    let measured: Vec<Sample> = pairs
        .iter()
        .flat_map(|pair| pair.measured.losses())
        .map(|loss| Sample { x: loss.amplitude_rad, value: loss.loss_nm, spread: loss.spread_nm })
        .collect();
    let missing = |sample: &Sample| {
        let value = sample.value - read_off(&curve, sample.x)?;
        Some(Sample { value, ..*sample })
    };
    let loss_measured = binned(&measured);
    Energy {
        side_difference: side_difference(pairs),
        loss_missing: binned(&measured.iter().filter_map(missing).collect::<Vec<_>>()),
        period_off: binned(&pairs.iter().flat_map(|pair| periods_off(pair, pairs)).collect::<Vec<_>>()),
        bump_rad: bump(&loss_measured),
        loss_measured,
        usual_loss_nm: curve.iter().map(|point| point.1).sum::<f64>() / curve.len().max(1) as f64,
    }
}

impl Energy {
    /// Bins in which the pendulum loses significantly more or less than modelled.
    pub fn losses_off(&self) -> Vec<&Mean> {
        let matters = |mean: &&Mean| mean.value.abs() > LOSS_SHARE * self.usual_loss_nm.abs();
        self.loss_missing.iter().filter(matters).filter(|mean| mean.z().abs() > SIGNIFICANT).collect()
    }

    /// The measured bump, if the model loses less there than was measured: some do have one.
    pub fn bump_missing_rad(&self) -> Option<f64> {
        let bump_rad = self.bump_rad?;
        let apart = |mean: &Mean| (mean.x - bump_rad).abs();
        let there = self.loss_missing.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        (there.z() > SIGNIFICANT).then_some(bump_rad)
    }

    /// Bins in which the period is significantly off.
    pub fn periods_off(&self) -> Vec<&Mean> {
        let matters = |mean: &&Mean| mean.value.abs() > PERIOD_SHARE && mean.z().abs() > SIGNIFICANT;
        self.period_off.iter().filter(matters).collect()
    }

    /// The sides' difference, if it is significant.
    pub fn sides_differ(&self) -> Option<&Mean> {
        // A friction that differs by more than its own size would push.
        let usual = self.usual_loss_nm.abs();
        let matters = |mean: &&Mean| (LOSS_SHARE * usual..usual).contains(&mean.value.abs());
        self.side_difference.as_ref().filter(matters).filter(|mean| mean.z().abs() > SIGNIFICANT)
    }
}

fn sorted(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// Rising minus falling loss beyond the model's, at small and at large amplitudes; the smaller of both counts, because
/// friction that differs between the directions does so at every amplitude.
fn side_difference(pairs: &[Pair]) -> Option<Mean> {
    let mut sides: [Vec<Sample>; 2] = [Vec::new(), Vec::new()];
    for pair in pairs {
        let curves = [false, true].map(|rising| side_curve(&pair.modelled, rising));
        for half in &pair.measured.halves {
            let side = usize::from(half.is_rising);
            let Some(modelled) = read_off(&curves[side], half.amplitude_rad) else { continue };
            let value = half.loss_nm - modelled;
            sides[side].push(Sample { x: half.amplitude_rad, value, spread: half.loss_spread_nm });
        }
    }
    sides.iter_mut().for_each(|side| side.sort_by(|a, b| a.x.total_cmp(&b.x)));
    let n = sides[0].len().min(sides[1].len());
    if n < 2 * FEWEST_HALVES {
        return None;
    }
    let difference = |range: fn(&[Sample]) -> &[Sample]| {
        let (down, up) = (mean(range(&sides[0])), mean(range(&sides[1])));
        Mean { x: up.x, value: up.value - down.value, spread: up.spread.hypot(down.spread), n: up.n + down.n }
    };
    let small = difference(|side| &side[..side.len() / 2]);
    let large = difference(|side| &side[side.len() / 2..]);
    let smaller = if small.z().abs() < large.z().abs() { small } else { large };
    (small.value * large.value > 0.0).then_some(smaller)
}

/// Half swings that a mean needs.
const FEWEST_HALVES: usize = 4;

fn side_curve(halves: &Halves, rising: bool) -> Vec<(f64, f64)> {
    let of_side = halves.halves.iter().filter(|half| half.is_rising == rising);
    sorted(of_side.map(|half| (half.amplitude_rad, half.loss_nm)).collect())
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
        let highest_near =
            losses[k.saturating_sub(1)..(k + 2).min(losses.len())].iter().all(|m| m.value <= losses[*k].value);
        highest_near && below.iter().any(|m| beyond(&losses[*k], m)) && above.iter().any(|m| beyond(&losses[*k], m))
    };
    (0..losses.len()).find(is_top).map(|k| losses[k].x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::halves::HalfSwing;

    #[test]
    fn a_bump_is_missing_only_where_the_model_loses_less() {
        let missing = |value: f64| {
            let mean = |x: f64, value: f64| Mean { x, value, spread: 0.01, n: 5 };
            let loss_missing = vec![mean(0.1, 0.0), mean(0.3, value), mean(0.6, 0.0)];
            Energy { bump_rad: Some(0.35), loss_missing, ..Energy::default() }.bump_missing_rad()
        };
        assert_eq!([missing(0.1), missing(0.01), missing(-0.1)], [Some(0.35), None, None]);
    }

    #[test]
    fn a_loss_that_only_rises_has_no_bump() {
        let mean = |x: f64, value: f64| Mean { x, value, spread: 0.01, n: 5 };
        let rising: Vec<Mean> = (0..8).map(|k| mean(f64::from(k), 1.0 + 0.1 * f64::from(k))).collect();
        assert_eq!(bump(&rising), None);
        let mut bumpy = rising.clone();
        bumpy[2].value = 2.0;
        assert_eq!(bump(&bumpy), Some(2.0));
    }

    /// Forty half swings from 1 rad down to 0.22 rad that lose so much per path, by amplitude and side.
    fn halves(loss_nm: impl Fn(f64, bool) -> f64, spread_nm: f64) -> Halves {
        let half = |k: u32| {
            let (amplitude_rad, is_rising) = (1.0 - 0.02 * f64::from(k), k.is_multiple_of(2));
            let loss_nm = loss_nm(amplitude_rad, is_rising);
            let (from_s, to_s) = (f64::from(k), f64::from(k + 1));
            let lost_j = loss_nm * 2.0 * amplitude_rad;
            HalfSwing { from_s, to_s, amplitude_rad, is_rising, lost_j, loss_nm, loss_spread_nm: spread_nm }
        };
        Halves { halves: (0..40).map(half).collect(), periods: Vec::new() }
    }

    fn dry_and_viscous(amplitude_rad: f64, _: bool) -> f64 {
        1e-3 + 5e-4 * amplitude_rad
    }

    #[test]
    fn what_is_lost_beyond_the_model_is_found_at_each_amplitude() {
        let pair = |spread_nm: f64| Pair {
            measured: halves(|a, side| 1.1 * dry_and_viscous(a, side), spread_nm),
            modelled: halves(dry_and_viscous, 0.0),
            noise_rad: 1e-3,
        };
        let found = energy(&[pair(1e-6)]);
        assert!(found.loss_missing.len() >= 4, "{found:?}");
        for mean in &found.loss_missing {
            // Pairs lose the path's mean of a law that is a line, to 1e-4 of it.
            let expected = 0.1 * dry_and_viscous(mean.x, true);
            assert!((mean.value / expected - 1.0).abs() < 1e-2, "{mean:?} {expected}");
        }
        // The mean of a line over amplitudes from 1 to 0.22 rad is that at 0.61 rad.
        assert!((found.usual_loss_nm / dry_and_viscous(0.61, true) - 1.0).abs() < 1e-3, "{}", found.usual_loss_nm);
        assert_eq!(found.losses_off().len(), found.loss_missing.len());
        assert_eq!(energy(&[pair(1e-3)]).losses_off().len(), 0);
    }

    #[test]
    fn sides_differ_by_what_the_model_does_not_say() {
        let one_sided = |a: f64, rising: bool| dry_and_viscous(a, rising) + if rising { 2e-4 } else { -1e-4 };
        let energy = |measured: Halves, modelled: Halves| energy(&[Pair { measured, modelled, noise_rad: 1e-3 }]);
        let found = energy(halves(one_sided, 1e-5), halves(dry_and_viscous, 0.0));
        let difference = found.sides_differ().unwrap();
        assert!((difference.value / 3e-4 - 1.0).abs() < 1e-6, "{difference:?}");
        let known = energy(halves(one_sided, 1e-5), halves(one_sided, 0.0)).side_difference;
        assert!(known.is_none_or(|difference| difference.value.abs() < 1e-9), "{known:?}");
    }

    #[test]
    fn a_period_is_off_by_its_share_and_known_better_the_larger_the_swing() {
        let periods = |factor: f64| {
            let period = |k: u32| {
                let amplitude_rad = 0.1 * f64::from(k);
                Period { time_s: f64::from(k), amplitude_rad, period_s: factor * (1.0 + amplitude_rad) }
            };
            Halves { halves: Vec::new(), periods: (1..=10).map(period).collect() }
        };
        let pair = Pair { measured: periods(1.01), modelled: periods(1.0), noise_rad: 2e-3 };
        let off = periods_off(&pair, std::slice::from_ref(&pair));
        // The smallest amplitude has no modelled one below.
        assert_eq!(off.len(), 9);
        for sample in off {
            assert!((sample.value - 0.01).abs() < 1e-12, "{sample:?}");
            // 15 % of the noise over the amplitude.
            assert!((sample.spread * sample.x / 3e-4 - 1.0).abs() < 1e-12, "{sample:?}");
        }
    }

    #[test]
    fn of_small_and_large_swings_those_count_that_differ_less() {
        let mixed = |small: f64, large: f64| {
            let loss = move |a: f64, rising: bool| {
                let difference = if a < 0.61 { small } else { large };
                dry_and_viscous(a, rising) + if rising { difference } else { 0.0 }
            };
            let pair = Pair { measured: halves(loss, 1e-5), modelled: halves(dry_and_viscous, 0.0), noise_rad: 1e-3 };
            energy(&[pair]).side_difference.map(|mean| mean.value)
        };
        for (small, large) in [(4e-4, 1e-4), (1e-4, 4e-4)] {
            let found = mixed(small, large).unwrap();
            assert!((found / 1e-4 - 1.0).abs() < 0.2, "{small} {large}: {found}");
        }
        assert_eq!(mixed(4e-4, -4e-4), None);
    }
}
