//! What the rig believes against what the file says.

use super::{Finding, Signal};
use crate::diagnose::zero_of_rig::held_off_rad;
use crate::rigfile::{Quantity, RigFile};
use shared::parameters::Parameters;
use shared::sensor::{Reader, Sensor};
use shared::units::{Code, Radian};

/// A rig knows its friction no better than by this factor before it was fitted.
const HELD_FACTOR: f64 = 2.0;

pub(super) fn calibration(in_use: &Sensor) -> Finding {
    Finding::of("calibration", in_use.to_string(), in_use.complaint())
}

/// Does the pendulum hang where the calibration has its zero? None where its readings are not of one that hangs.
pub(super) fn zero(signal: &Signal, sensor: &Sensor, rig: &Parameters<f64>) -> Option<Finding> {
    let code = signal.hangs_at_code.filter(|_| signal.n_clipped == 0)?;
    let Radian(angle_rad) = Reader::new(*sensor).read(Code(code.round() as u16))?;
    let held_rad = held_off_rad(rig);
    let allowed_rad = HELD_FACTOR * held_rad + f64::from(sensor.step_rad());
    let [off, held] = [f64::from(angle_rad), held_rad].map(|rad| format!("{rad:.3} rad ({:.1}°)", rad.to_degrees()));
    let found = format!("the pendulum hangs at {off}; friction may hold it up to {held} off");
    let next = "let it hang still, nudge it from both sides, then `host calibrate --port PORT`";
    Some(Finding::of("zero", found, (f64::from(angle_rad.abs()) > allowed_rad).then_some(next)))
}

pub(super) fn parameters(rig: &Parameters<f32>, sensor: &Sensor, file: Option<&RigFile>) -> Vec<Finding> {
    let Some(file) = file else {
        return vec![Finding::ok("model", "no model file here to compare with; name one with --rig")];
    };
    vec![numbers(rig, file), sensors(sensor, file)]
}

/// The rig counts with 32 bits, so that is how they are compared.
fn numbers(rig: &Parameters<f32>, file: &RigFile) -> Finding {
    let (ours, theirs) = (file.parameters(), rig.map(f64::from));
    let mut all = Quantity::all(ours);
    all.extend(Quantity::all(&theirs).into_iter().filter(|quantity| quantity.get(ours).is_none()));
    let as_stored = |of, quantity: &Quantity| quantity.get(of).map(|value| value as f32);
    let differs = |quantity: &&Quantity| as_stored(ours, quantity) != as_stored(&theirs, quantity);
    let mut different: Vec<&str> = all.iter().filter(differs).map(|quantity| quantity.symbol()).collect();
    if ours.formula != theirs.formula {
        different.push("formula");
    }
    if different.is_empty() {
        return Finding::ok("model", format!("all {} numbers as in the file", all.len()));
    }
    Finding::look(
        "model",
        format!("the rig's {} differ from the file's", different.join(", ")),
        "`host push --rig FILE` sends the file's model, `host pull --force -o FILE` takes the rig's",
    )
}

fn sensors(rig: &Sensor, file: &RigFile) -> Finding {
    let what = "sensor in file";
    match file.sensor() {
        Some(ours) if ours.taken_over(rig) == *rig => Finding::ok(what, "the calibration is the rig's"),
        Some(ours) if !ours.is_like(rig) => Finding::look(
            what,
            format!("the file means a sensor of kind {}, the rig reads one of kind {}", ours.name(), rig.name()),
            "`host push --calibration` makes the rig read the file's, `host pull --force` takes the rig's",
        ),
        Some(_) => Finding::look(
            what,
            "the file's calibration is not the rig's",
            "`host push --calibration` sends the file's, `host calibrate` measures it anew",
        ),
        None => Finding::ok(what, "the file holds no calibration"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::sensor::{Encoder, Potentiometer};

    /// Of the paper's pendulum, hanging at this code.
    fn found(sensor: impl Into<Sensor>, code: f64) -> Option<Finding> {
        let signal = Signal { hangs_at_code: Some(code), ..Signal::default() };
        zero(&signal, &sensor.into(), &Parameters::paper())
    }

    #[test]
    fn a_pendulum_that_hangs_further_off_than_friction_holds_is_seen() {
        let potentiometer = Potentiometer::nominal(4095);
        let is_ok = |off_rad: f32| found(potentiometer, potentiometer.code(Radian(off_rad)).0.into()).unwrap().ok;
        // Ms holds it 4.5 mrad off, by the paper's number of it, and a code is 1.4 mrad.
        assert_eq!([0.0, 0.004, -0.009, 0.013, -0.3].map(is_ok), [true, true, true, false, false]);
        let said = found(potentiometer, 2255.0).unwrap();
        assert!(said.found.starts_with("the pendulum hangs at 0.300 rad (17.2°); friction"), "{}", said.found);
        assert!(said.next.unwrap().contains("host calibrate"));
        assert!(found(Encoder::new(4096), 32_768.0).unwrap().ok && !found(Encoder::new(4096), 33_000.0).unwrap().ok);
    }

    #[test]
    fn where_nothing_hangs_or_nothing_is_connected_there_is_no_word_of_the_zero() {
        assert_eq!(zero(&Signal::default(), &Potentiometer::nominal(4095).into(), &Parameters::paper()), None);
        assert_eq!(found(Potentiometer::nominal(4095), 0.0), None);
    }
}
