//! What swings that come to rest show of Ms by themselves: it holds the pendulum where it rests, and did not hold it where
//! it last turned before that. Between these two lies little, while a model that stops at another turning point leads
//! the search for Ms and DV astray.

use super::fitted::Fitted;
use super::problem::Problem;
use crate::recording::Measured;
use crate::swing::Swing;
use crate::verdict::SEEN_NOISES;

/// The level in the middle of what all swings leave, N·m; `None` where no angle shows a rest, or where they contradict
/// each other.
pub(super) fn level_nm(on: &Problem, of: &Fitted) -> Option<f64> {
    let gravity_nm = of.parameters.pendulum.gravity_torque_nm();
    let swings = on.swings.iter().zip(&of.starts);
    let angles = swings.filter_map(|(swing, start)| held_and_passed_rad(swing, start.offset_rad));
    let (held, passed) = angles.reduce(|a, b| (a.0.max(b.0), a.1.min(b.1)))?;
    (held < passed).then(|| gravity_nm * 0.5 * (held.sin() + passed.sin()))
}

/// Where a swing rests and its last turning point on the other side, as distances from the middle, rad.
fn held_and_passed_rad(swing: &Swing, offset_rad: f64) -> Option<(f64, f64)> {
    if swing.measured != Measured::Angle || !swing.comes_to_rest() {
        return None;
    }
    let rest_rad = swing.rest() - offset_rad;
    let seen_rad = SEEN_NOISES * swing.noise_rad;
    let backwards = swing.angles_rad.iter().rev().map(|reading| (offset_rad - reading) * rest_rad.signum());
    let other_side = backwards.skip_while(|beyond| *beyond < seen_rad).take_while(|beyond| *beyond > -seen_rad);
    let passed_rad = other_side.fold(0.0, f64::max);
    (passed_rad > 0.0).then_some((rest_rad.abs(), passed_rad))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::problem::{Point, Start};

    const NOISE_RAD: f64 = 1e-3;
    const MIDDLE_RAD: f64 = 0.05;

    /// Half swings of a second to these distances from the middle, at 100 Hz; then at rest at the last one.
    fn swing(turns_rad: &[f64], rests: bool) -> Swing {
        let half = |pair: &[f64]| {
            let (mean, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[0] - pair[1]));
            (0..100).map(move |i| mean + half * (f64::from(i) * std::f64::consts::PI / 100.0).cos()).collect::<Vec<_>>()
        };
        let mut angles_rad = turns_rad.windows(2).map(half).collect::<Vec<_>>().concat();
        if rests {
            angles_rad.extend([turns_rad[turns_rad.len() - 1]; 100]);
        }
        let noise = |i: usize| if i.is_multiple_of(2) { NOISE_RAD } else { -NOISE_RAD };
        let seen: Vec<f64> = angles_rad.iter().enumerate().map(|(i, angle)| MIDDLE_RAD + angle + noise(i)).collect();
        let times_s: Vec<f64> = (0..seen.len()).map(|i| 0.01 * i as f64).collect();
        Swing::new("held", &times_s, &seen, NOISE_RAD)
    }

    #[test]
    fn a_swing_is_held_where_it_rests_and_passed_its_last_turning_point() {
        for sign in [1.0, -1.0] {
            let turns = [0.5, -0.4, 0.3, -0.22, 0.12].map(|angle| sign * angle);
            let (held, passed) = held_and_passed_rad(&swing(&turns, true), MIDDLE_RAD).unwrap();
            assert!((held - 0.12).abs() < 1e-4 && (passed - 0.221).abs() < 1e-4, "{held} {passed}");
        }
    }

    #[test]
    fn a_rest_that_never_crossed_the_middle_is_bounded_by_the_turn_before_that() {
        // From 0.2 down to 0.04, without crossing: the turning point of the other side before it is the bound.
        let (held, passed) = held_and_passed_rad(&swing(&[0.4, -0.3, 0.2, 0.04], true), MIDDLE_RAD).unwrap();
        assert!((held - 0.04).abs() < 1e-4 && (passed - 0.301).abs() < 2e-4, "{held} {passed}");
    }

    #[test]
    fn what_still_swings_shows_no_level() {
        assert_eq!(held_and_passed_rad(&swing(&[0.5, -0.4, 0.3, -0.2], false), MIDDLE_RAD), None);
    }

    #[test]
    fn the_level_lies_between_what_held_and_what_was_passed() {
        let count = crate::fit::tally::Tally::default();
        let swings = [swing(&[0.5, -0.4, 0.3, -0.22, 0.12], true)];
        let parameters = shared::parameters::Parameters::paper();
        let problem = Problem::new(&swings, &parameters, Vec::new(), &count);
        let start = Start { angle_rad: 0.5, velocity_rad_s: 0.0, offset_rad: MIDDLE_RAD };
        let model = Fitted::at(&problem, &Point { values: Vec::new(), starts: vec![start] });
        let gravity_nm = parameters.pendulum.gravity_torque_nm();
        let found_nm = level_nm(&problem, &model).unwrap();
        // Halfway between 0.12 and 0.221 rad, where the sine is 0.17 within 1 %.
        assert!((found_nm / (0.17 * gravity_nm) - 1.0).abs() < 0.01, "{found_nm} of {gravity_nm}");
    }
}
