//! Is a rig's zero further off than whoever took it could help?
//!
//! A zero is taken where the pendulum hangs, and there dry friction holds it up to M/(m·g·l) beside its lowest point, M the
//! larger of Ms and Mc. So far off a rig's observer is used to: the torque that it is wrong by is one that friction holds.
//! Further off, it was not taken, or the shaft has turned since.

use super::zero;
use crate::fit::fitted::{Fitted, Stiction};
use crate::fit::found::Fit;
use crate::fit::identify::problem_of;
use crate::fit::problem::Point;
use crate::fit::tally::Tally;
use crate::swing::Swing;
use crate::swing::wandering;
use crate::swing::zero::within_half_a_turn;
use shared::parameters::{Parameters, base};

/// How far beside its lowest point friction may hold the pendulum of a model, rad.
pub fn held_off_rad(parameters: &Parameters<f64>) -> f64 {
    let coulomb_nm = parameters.values(base::COULOMB).and_then(|values| values.first().copied()).unwrap_or_default();
    coulomb_nm.max(Stiction::of(parameters).level_nm) / parameters.pendulum.gravity_torque_nm()
}

/// What a fit says of the zero of the rig whose swings these are, for a person; `None` where it is as right as it can be.
pub fn words(swings: &[Swing], fit: &Fit) -> Option<String> {
    let (off_rad, _) = off_beyond_friction(swings, fit)?;
    if let Some(wandering) = swings.iter().find_map(|swing| wandering::words(swing, off_rad)) {
        return Some(format!("{wandering}; the fit takes off {off_rad:.3} rad throughout"));
    }
    let degrees = off_rad.to_degrees();
    Some(format!(
        "the zero of the sensor is off by {off_rad:.3} rad ({degrees:.1}°): the fit takes it off, but a rig's observer is \
         wrong by it until host calibrate puts it right"
    ))
}

/// How far it is off (rad) and the standard deviation of that, where friction does not hold the pendulum so far off.
pub fn off_beyond_friction(swings: &[Swing], fit: &Fit) -> Option<(f64, f64)> {
    let held_rad = held_off_rad(&fit.parameters);
    // All that follows takes a while, and a zero that is right needs none of it.
    if fit.starts.iter().any(|start| within_half_a_turn(start.offset_rad).abs() <= held_rad) {
        return None;
    }
    let count = Tally::default();
    let problem = problem_of(swings, fit.rig(), &count).without_stiction();
    let point = Point { values: problem.template_values(), starts: fit.starts.clone() };
    let model = Fitted::at(&problem, &point).evaluated(&problem);
    zero::off_rad(&problem, &model).filter(|(off_rad, _)| off_rad.abs() > held_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};
    use crate::fit::identify::{Method, Options, fit};

    /// What is said of a rig whose zero is off by this.
    fn said(off_rad: f64) -> Option<String> {
        said_of(|_| off_rad)
    }

    /// The same of one that is off by something else at any time.
    fn said_of(off_rad: impl Fn(f64) -> f64) -> Option<String> {
        let mut swing = simulated("swing", &rig(), 10.0, 1);
        let times_s = swing.times_s.clone();
        swing.angles_rad.iter_mut().zip(&*times_s).for_each(|(angle, time_s)| *angle += off_rad(*time_s));
        let swings = [swing];
        let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
        words(&swings, &fit(&swings, &[], &rig(), &options, &|_| {}).unwrap())
    }

    #[test]
    fn a_zero_that_is_off_by_more_than_friction_holds_is_named_with_what_puts_it_right() {
        let words = said(0.3).unwrap();
        assert!(words.starts_with("the zero of the sensor is off by 0.300 rad (17.2°)"), "{words}");
        assert!(words.contains("host calibrate"), "{words}");
        assert!(said(-0.02).is_some_and(|words| words.contains("-0.020 rad (-1.1°)")));
    }

    #[test]
    fn a_zero_that_wanders_is_not_calibrated_before_what_moves_is_fastened() {
        let words = said_of(|time_s| 0.12 + 0.06 * (0.6 * time_s).sin()).unwrap();
        assert!(words.starts_with("no one zero is right for swing") && words.contains("Fasten"), "{words}");
    }

    #[test]
    fn a_zero_that_is_as_right_as_it_can_be_is_no_word_worth() {
        // Mc of the paper's pendulum holds it 3.2 mrad off.
        let held_rad = held_off_rad(&rig());
        assert!((3.1e-3..3.3e-3).contains(&held_rad), "{held_rad}");
        assert_eq!([said(0.0), said(0.9 * held_rad)], [None, None]);
    }
}
