//! Can a potentiometer have this gain? What speaks against it, in words for a person.

use crate::number::significant;
use shared::potentiometer::GAIN_TOLERANCE;
use shared::sensor::Sensor;

/// What a new gain follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum From {
    /// Angles that somebody set, of this root mean square in rad.
    Angles {
        /// Their root mean square, rad.
        rms_rad: f64,
    },
    /// Swings.
    Swings,
}

/// What speaks against the gain that was measured, after the one before.
pub fn doubts(before: &Sensor, after: &Sensor, from: From) -> Vec<String> {
    [of_size(before, after, from), of_sign(before, after, from)].into_iter().flatten().collect()
}

/// A gain that was measured before confirms one that the data sheet does not have.
fn of_size(before: &Sensor, after: &Sensor, from: From) -> Option<String> {
    let off = |reference: f32| f64::from(after.step_rad() / reference) - 1.0;
    let (off_nominal, off_before) = (off(after.nominal_step_rad()), off(before.step_rad()));
    let allowed = f64::from(GAIN_TOLERANCE);
    if off_nominal.abs().min(off_before.abs()) <= allowed {
        return None;
    }
    let [off_nominal, allowed] = [off_nominal, allowed].map(|share| 100.0 * share);
    Some(format!(
        "the gain is {off_nominal:+.1} % off the data sheet's, which allows {allowed:.1} %: {}",
        more_likely(off_before, from)
    ))
}

fn more_likely(off: f64, from: From) -> String {
    match from {
        From::Angles { rms_rad } => {
            let wrong_degrees = significant((off.abs() * rms_rad).to_degrees(), 2);
            format!("angles that are wrong by {wrong_degrees}° are more likely; measure them again, from hanging")
        }
        From::Swings => "a spring, a magnet or another mass is more likely; see what host diagnose says".to_owned(),
    }
}

fn of_sign(before: &Sensor, after: &Sensor, from: From) -> Option<String> {
    let flips = before.line().radian_per_code * after.line().radian_per_code < 0.0;
    let turned = "the sign of the gain is another than before: what counted as positive is negative now. Right if \
                  counter-clockwise is positive now; if not, give the angles with the other sign";
    (flips && from != From::Swings).then(|| turned.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::potentiometer::Potentiometer;

    const NOMINAL: Potentiometer = Potentiometer::nominal(4095);

    fn told(before: f32, after: f32, from: From) -> Vec<String> {
        let with = |share| Potentiometer { radian_per_code: share * NOMINAL.radian_per_code, ..NOMINAL }.into();
        doubts(&with(before), &with(after), from)
    }

    #[test]
    fn a_gain_that_no_potentiometer_has_is_doubted_with_the_angle_that_would_explain_it() {
        let from = From::Angles { rms_rad: 1.0 };
        assert_eq!(told(1.0, 1.01, from), Vec::<String>::new());
        let [doubt] = told(1.0, 1.05, from).try_into().unwrap();
        // 5 % of a radian.
        assert!(doubt.contains("+5.0 % off") && doubt.contains("allows 1.2 %") && doubt.contains("by 2.9°"), "{doubt}");
        let [doubt] = told(1.0, 0.95, From::Swings).try_into().unwrap();
        assert!(doubt.contains("-5.0 % off") && doubt.contains("host diagnose"), "{doubt}");
    }

    #[test]
    fn a_gain_that_was_measured_before_confirms_one_of_another_potentiometer() {
        assert_eq!(told(1.13, 1.135, From::Angles { rms_rad: 1.0 }), Vec::<String>::new());
        assert_eq!(told(1.13, 1.0, From::Angles { rms_rad: 1.0 }), Vec::<String>::new());
    }

    #[test]
    fn a_sign_that_is_another_than_before_is_remarked() {
        let [doubt] = told(1.0, -1.0, From::Angles { rms_rad: 1.0 }).try_into().unwrap();
        assert!(doubt.contains("sign of the gain"), "{doubt}");
        assert_eq!(told(-1.0, -1.0, From::Angles { rms_rad: 1.0 }), Vec::<String>::new());
    }
}
