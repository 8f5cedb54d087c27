//! What the rig believes against what the file says.

use super::Finding;
use crate::rigfile::{Quantity, RigFile};
use shared::parameters::Parameters;
use shared::sensor::Sensor;

pub(super) fn calibration(in_use: &Sensor) -> Finding {
    Finding::of("calibration", in_use.to_string(), in_use.complaint())
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
