//! An "angle" that was computed from two accelerations beside it. Along a string or a rod that swings freely they show the pull in it
//! and no gravity across, so that their direction hardly turns, however far the pendulum swings.

use super::super::error::{Fault, NoAngle};
use super::super::table::Table;
use super::super::words::may_be_acceleration;
use std::f64::consts::{PI, TAU};

/// The direction of the two is off the angle by no more than this share of what it scatters (rms). Half and twice were not
/// tried: of two strangers' files it is off by a thousandth, and what is no such angle by about as much as it scatters.
const MOST_OFF: f64 = 0.05;

/// The pull in the string changes by more than this share from one row to another; how far from its pivot a point is seen does not.
const LEAST_CHANGE: f64 = 0.03;

/// Why this angle can't be fitted, if it is the direction of two accelerations.
pub(super) fn fault(table: &Table, angle: usize, time: Option<usize>) -> Option<Fault> {
    let may_be = |idx: &usize| {
        *idx != angle && Some(*idx) != time && (table.names.is_none() || table.says(*idx, may_be_acceleration))
    };
    let others: Vec<usize> = (0..table.n_columns).filter(may_be).collect();
    let angles = table.first_numbers(angle);
    let columns: Vec<Vec<f64>> = others.iter().map(|idx| table.first_numbers(*idx)).collect();
    let pairs = (0..others.len()).flat_map(|second| (0..second).map(move |first| [first, second]));
    let is_tilt = |[a, b]: &[usize; 2]| is_direction(&angles, &columns[*a], &columns[*b]);
    let [a, b] = pairs.filter(|[a, b]| changes(&columns[*a], &columns[*b])).find(is_tilt)?;
    let [angle, a, b] = [angle, others[a], others[b]].map(|idx| table.column_name(idx));
    Some(NoAngle::Tilt { angle, a, b }.into())
}

/// Is the angle (rad or degrees) the direction of these two, from whichever axis and to whichever side?
fn is_direction(angles: &[f64], a: &[f64], b: &[f64]) -> bool {
    let directions: Vec<f64> = a.iter().zip(b).map(|(a, b)| a.atan2(*b)).collect();
    let scatter_rad = scatter_of_turns(&directions);
    let is_off_little = |sign: f64, unit: f64| {
        let off: Vec<f64> =
            angles.iter().zip(&directions).map(|(angle, direction)| angle * unit - sign * direction).collect();
        scatter_of_turns(&off) < MOST_OFF * scatter_rad
    };
    [-1.0, 1.0].into_iter().any(|sign| is_off_little(sign, 1.0) || is_off_little(sign, 1_f64.to_radians()))
}

/// Scatter (rms) of angles of which whole turns say nothing, rad.
fn scatter_of_turns(angles_rad: &[f64]) -> f64 {
    let first_rad = angles_rad.first().copied().unwrap_or_default();
    let turned = |angle: &f64| (angle - first_rad + PI).rem_euclid(TAU) - PI;
    let mean = angles_rad.iter().map(turned).sum::<f64>() / angles_rad.len() as f64;
    (angles_rad.iter().map(|angle| (turned(angle) - mean).powi(2)).sum::<f64>() / angles_rad.len() as f64).sqrt()
}

/// Is the length of the two no more the same in all rows than a pull in a string is?
fn changes(a: &[f64], b: &[f64]) -> bool {
    let mut lengths: Vec<f64> = a.iter().zip(b).map(|(a, b)| a.hypot(*b)).collect();
    lengths.sort_by(f64::total_cmp);
    let at = |share: f64| lengths.get((share * lengths.len() as f64) as usize).copied().unwrap_or_default();
    at(0.95) - at(0.05) > LEAST_CHANGE * at(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a sensor on a string of 0.4 m gives along it and across, m/s²: the pull, and but for noise nothing.
    fn axes() -> (Vec<f64>, Vec<f64>) {
        let mut noise = crate::random::Noise::new(3);
        let pull = |idx: i32| 9.81 * (1.0 + 0.1 * (0.2 * f64::from(idx)).cos());
        (0..300).map(|idx| (pull(idx), 0.2 * noise.normal())).unzip()
    }

    #[test]
    fn the_direction_of_two_accelerations_is_told_in_either_unit_and_order() {
        let (along, across) = axes();
        let of = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a.atan2(*b)).collect::<Vec<f64>>();
        let in_degrees: Vec<f64> = of(&along, &across).iter().map(|angle| 90.0 - angle.to_degrees()).collect();
        for angles in [of(&along, &across), of(&across, &along), in_degrees] {
            assert!(is_direction(&angles, &along, &across) && is_direction(&angles, &across, &along));
        }
        assert!(changes(&along, &across));
    }

    /// Whole numbers of a counter, of which whole turns leave as little as of anything.
    #[test]
    fn counts_are_no_direction_of_others() {
        let mut noise = crate::random::Noise::new(5);
        let mut count = || (60_000.0 + 3000.0 * noise.normal()).round();
        let [counts, a, b]: [Vec<f64>; 3] = std::array::from_fn(|_| (0..300).map(|_| count()).collect());
        assert!(!is_direction(&counts, &a, &b));
    }

    #[test]
    fn an_angle_beside_accelerations_and_a_point_of_the_pendulum_are_none() {
        let (along, across) = axes();
        let angles: Vec<f64> = (0..300).map(|idx| 0.5 * (0.1 * f64::from(idx)).cos()).collect();
        assert!(!is_direction(&angles, &along, &across));
        let [x, y] = [f64::sin, f64::cos].map(|of| angles.iter().map(|angle| 0.4 * of(*angle)).collect::<Vec<f64>>());
        assert!(is_direction(&angles, &x, &y) && !changes(&x, &y));
    }
}
