//! Half swings: what every one lost, how long it took, to which side it went. From turning points, of the measured and
//! of the modelled motion in the same way.
//!
//! Between two turning points the pendulum loses m·g·l·(cos θ₂ − cos θ₁), whatever the friction's law. Divided by the
//! path |θ₂ − θ₁| this is the mean torque of friction: flat against amplitude for Coulomb friction, a line for viscous
//! friction, a parabola for drag.

use crate::recording::turning::{TurningPoint, crossings, turning_points};
use serde::Serialize;

/// One half swing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HalfSwing {
    /// Begin, s since the swing's first sample.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Mean of the angles at both ends, rad.
    pub amplitude_rad: f64,
    /// Did it go counter-clockwise?
    pub is_rising: bool,
    /// Energy lost, J.
    pub lost_j: f64,
    /// Energy lost per path: the mean friction torque, N·m.
    pub loss_nm: f64,
    /// Its standard error, N·m.
    pub loss_spread_nm: f64,
}

/// Two half swings there and back: an error of the sensor's zero nearly cancels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Loss {
    /// Mean amplitude, rad.
    pub amplitude_rad: f64,
    /// Energy lost per path, N·m.
    pub loss_nm: f64,
    /// Its standard error, N·m.
    pub spread_nm: f64,
}

/// One period, from a crossing of the hanging position to the next but one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Period {
    /// Its middle, s.
    pub time_s: f64,
    /// Mean amplitude of the turning points within, rad.
    pub amplitude_rad: f64,
    /// Duration, s.
    pub period_s: f64,
}

/// Everything read off one motion.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Halves {
    /// Half swings in order of time.
    pub halves: Vec<HalfSwing>,
    /// Periods in order of time.
    pub periods: Vec<Period>,
}

impl Halves {
    /// Losses of successive pairs of half swings.
    pub fn losses(&self) -> Vec<Loss> {
        let meet = |pair: &&[HalfSwing]| pair.len() == 2 && pair[0].to_s == pair[1].from_s;
        self.halves.chunks(2).filter(meet).map(Loss::of).collect()
    }
}

impl Loss {
    fn of(pair: &[HalfSwing]) -> Self {
        let path_rad = 2.0 * (pair[0].amplitude_rad + pair[1].amplitude_rad);
        Self {
            amplitude_rad: 0.25 * path_rad,
            loss_nm: (pair[0].lost_j + pair[1].lost_j) / path_rad,
            spread_nm: 0.5 * pair[0].loss_spread_nm.max(pair[1].loss_spread_nm),
        }
    }
}

/// Times from one sample to the next that is so many mean steps away …
const GAP_STEPS: f64 = 2.0;

/// … may hide turns if it is this share of a half swing: two turns are a half swing apart, a third of what then seems to be one.
const HIDES_TURNS: f64 = 0.25;

fn gaps(times_s: &[f64]) -> Vec<[f64; 2]> {
    let mean_s = (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1).max(1) as f64;
    let steps = times_s.windows(2).map(|pair| [pair[0], pair[1]]);
    steps.filter(|[from, to]| to - from > GAP_STEPS * mean_s).collect()
}

/// Is every turn seen between two times that are so many half swings apart?
fn is_seen(gaps: &[[f64; 2]], from_s: f64, to_s: f64, n_halves: f64) -> bool {
    let hides = |[begins, ends]: &[f64; 2]| ends - begins > HIDES_TURNS * (to_s - from_s) / n_halves;
    !gaps.iter().any(|gap| gap[0] < to_s && gap[1] > from_s && hides(gap))
}

/// Reads half swings and periods off a motion around its hanging position (angles without the sensor's zero).
pub fn halves(times_s: &[f64], angles_rad: &[f64], noise_rad: f64, gravity_nm: f64) -> Halves {
    let turns = turning_points(times_s, angles_rad, noise_rad);
    let gaps = gaps(times_s);
    let half = |pair: &[TurningPoint]| {
        let all_seen = is_seen(&gaps, pair[0].time_s, pair[1].time_s, 1.0);
        all_seen.then(|| half_swing(&pair[0], &pair[1], gravity_nm)).flatten()
    };
    let crossings: Vec<f64> =
        crossings(times_s, angles_rad, 0.0, noise_rad).iter().map(|crossing| crossing.time_s).collect();
    let period =
        |three: &[f64]| is_seen(&gaps, three[0], three[2], 2.0).then(|| period(&turns, three[0], three[2])).flatten();
    Halves {
        halves: turns.windows(2).filter_map(half).collect(),
        periods: crossings.windows(3).filter_map(period).collect(),
    }
}

fn half_swing(first: &TurningPoint, second: &TurningPoint, gravity_nm: f64) -> Option<HalfSwing> {
    let (a, b) = (first.angle_rad, second.angle_rad);
    let path_rad = (b - a).abs();
    // Both turns on one side of the hanging position: what is lost there can't be told from the sensor's zero.
    if a * b >= 0.0 {
        return None;
    }
    let lost_j = gravity_nm * (b.cos() - a.cos());
    let spread_j = gravity_nm * (a.sin() * first.spread_rad).hypot(b.sin() * second.spread_rad);
    Some(HalfSwing {
        from_s: first.time_s,
        to_s: second.time_s,
        amplitude_rad: 0.5 * path_rad,
        is_rising: b > a,
        lost_j,
        loss_nm: lost_j / path_rad,
        loss_spread_nm: spread_j / path_rad,
    })
}

fn period(turns: &[TurningPoint], from_s: f64, to_s: f64) -> Option<Period> {
    let within: Vec<f64> =
        turns.iter().filter(|turn| (from_s..=to_s).contains(&turn.time_s)).map(|turn| turn.angle_rad.abs()).collect();
    let amplitude_rad = within.iter().sum::<f64>() / within.len() as f64;
    (within.len() == 2).then_some(Period { time_s: 0.5 * (from_s + to_s), amplitude_rad, period_s: to_s - from_s })
}

/// A curve through points with rising x, read off between them; `None` outside.
pub fn read_off(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = curve.partition_point(|point| point.0 < x);
    let (left, right) = (curve.get(after.checked_sub(1)?)?, curve.get(after)?);
    let share = (x - left.0) / (right.0 - left.0).max(1e-300);
    Some(left.1 + share * (right.1 - left.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coulomb_friction_loses_its_torque_per_path() {
        // Between turns at 1 and −0.9 rad.
        let turn =
            |angle_rad: f64, time_s| TurningPoint { time_s, angle_rad, spread_rad: 1e-4, is_maximum: angle_rad > 0.0 };
        let half = half_swing(&turn(1.0, 0.0), &turn(-0.9, 0.4), 0.2).unwrap();
        let friction_nm = 0.2 * (0.9_f64.cos() - 1.0_f64.cos()) / 1.9;
        assert!((half.loss_nm - friction_nm).abs() < 1e-12 && !half.is_rising);
        assert!(half_swing(&turn(0.03, 0.0), &turn(0.01, 0.4), 0.2).is_none());
    }

    #[test]
    fn what_a_gap_hides_makes_no_long_period() {
        let is_kept = |time_s: &f64| !(3.1..4.3).contains(time_s) && *time_s != 6.0;
        let times_s: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0).filter(is_kept).collect();
        let angles_rad: Vec<f64> =
            times_s.iter().map(|time_s| (std::f64::consts::TAU * time_s).cos() * (-0.01 * time_s).exp()).collect();
        let found = halves(&times_s, &angles_rad, 1e-6, 0.2);
        // 17 of 20 crossings are seen, and two of the 15 periods that begin with them hold the gap; a lost sample is none.
        assert_eq!(found.periods.len(), 13);
        assert!(found.periods.iter().all(|period| (period.period_s - 1.0).abs() < 0.01), "{:?}", found.periods);
        assert!(found.halves.iter().all(|half| (half.to_s - half.from_s - 0.5).abs() < 0.01), "{:?}", found.halves);
    }

    #[test]
    fn a_curve_is_read_off_between_its_points_only() {
        let curve = [(0.0, 1.0), (1.0, 3.0)];
        assert_eq!(read_off(&curve, 0.5), Some(2.0));
        assert_eq!(read_off(&curve, 1.5), None);
        assert_eq!(read_off(&curve, -0.5), None);
    }

    #[test]
    fn the_error_of_a_loss_is_that_of_both_turns() {
        let turn = |angle_rad: f64, spread_rad: f64| TurningPoint {
            time_s: 0.0,
            angle_rad,
            spread_rad,
            is_maximum: angle_rad > 0.0,
        };
        let lost_j = |a: f64, b: f64| half_swing(&turn(a, 0.0), &turn(b, 0.0), 0.2).unwrap().lost_j;
        let (a, b, of_a, of_b) = (1.0, -0.9, 2e-4, 3e-4);
        let half = half_swing(&turn(a, of_a), &turn(b, of_b), 0.2).unwrap();
        let by_a = 0.5 * (lost_j(a + of_a, b) - lost_j(a - of_a, b));
        let by_b = 0.5 * (lost_j(a, b + of_b) - lost_j(a, b - of_b));
        assert!((half.loss_spread_nm / (by_a.hypot(by_b) / 1.9) - 1.0).abs() < 1e-6, "{half:?}");
    }

    #[test]
    fn a_period_has_the_mean_amplitude_of_its_two_turns() {
        let turn = |time_s: f64, angle_rad: f64| TurningPoint {
            time_s,
            angle_rad,
            spread_rad: 1e-4,
            is_maximum: angle_rad > 0.0,
        };
        let turns = [turn(0.0, 1.0), turn(0.5, -0.9), turn(1.0, 0.8), turn(1.5, -0.7)];
        let found = period(&turns, 0.25, 1.25).unwrap();
        assert_eq!((found.time_s, found.period_s), (0.75, 1.0));
        assert!((found.amplitude_rad - 0.85).abs() < 1e-12, "{found:?}");
        assert_eq!(period(&turns, 0.25, 1.75), None);
    }

    #[test]
    fn the_loss_of_two_half_swings_is_that_of_their_common_path() {
        let half = |amplitude_rad: f64, loss_nm: f64, loss_spread_nm: f64| HalfSwing {
            from_s: 0.0,
            to_s: 1.0,
            amplitude_rad,
            is_rising: true,
            lost_j: 2.0 * amplitude_rad * loss_nm,
            loss_nm,
            loss_spread_nm,
        };
        let loss = Loss::of(&[half(1.0, 3e-3, 2e-4), half(0.5, 6e-3, 4e-4)]);
        // 6 mJ and 6 mJ over 2 rad and 1 rad.
        assert!((loss.amplitude_rad - 0.75).abs() < 1e-12 && (loss.loss_nm - 4e-3).abs() < 1e-12, "{loss:?}");
        // The turn that both share makes one lose what the other one does not; half of the larger error stays.
        assert_eq!(loss.spread_nm, 2e-4);
    }
}
