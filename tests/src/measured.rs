//! A pendulum as the potentiometer sees it: held still, let go, left alone until it rests; with noise and in steps.

use crate::chance::Chance;
use host::recording::Recording;

/// Samples per second.
pub const RATE_HZ: f64 = 1000.0;

/// One step of a 12-bit converter over the potentiometer's 340°, rad.
pub const LSB_RAD: f64 = 340.0 * std::f64::consts::PI / 180.0 / 4096.0;

/// Held still so long before the release.
const LEAD_IN_S: f64 = 0.5;

/// Recorded so long after the last motion.
const REST_S: f64 = 3.0;

/// What is left of the angle's precision: one step of white noise, and the rounding to whole steps.
pub fn noise_rad() -> f64 {
    LSB_RAD * (1.0 + 1.0 / 12.0_f64).sqrt()
}

/// Records a release from an angle until some time after it rests; `advance` moves the pendulum by seconds and gives its angle
/// and velocity. The release falls between two samples.
pub fn recording(start_rad: f64, chance: &mut Chance, advance: impl FnMut(f64) -> (f64, f64)) -> Recording {
    let (mut angles_rad, last_rad) = released(start_rad, chance, advance, usize::MAX);
    angles_rad.extend(std::iter::repeat_n(last_rad, (REST_S * RATE_HZ) as usize));
    read(&angles_rad, chance)
}

/// The same, cut off so many seconds after the release.
pub fn cut_off(start_rad: f64, chance: &mut Chance, seconds: f64, advance: impl FnMut(f64) -> (f64, f64)) -> Recording {
    let (angles_rad, _) = released(start_rad, chance, advance, (seconds * RATE_HZ) as usize);
    read(&angles_rad, chance)
}

/// Angles until it rests, or until there are so many after the release; and the next one.
fn released(
    start_rad: f64,
    chance: &mut Chance,
    mut advance: impl FnMut(f64) -> (f64, f64),
    most: usize,
) -> (Vec<f64>, f64) {
    let step_s = RATE_HZ.recip();
    let mut angles_rad = vec![start_rad; (LEAD_IN_S * RATE_HZ) as usize];
    let most = angles_rad.len().saturating_add(most);
    let first_step_s = chance.within(0.0..step_s);
    let (mut angle_rad, mut velocity_rad_s) = advance(first_step_s);
    while velocity_rad_s != 0.0 && angles_rad.len() < most {
        angles_rad.push(angle_rad);
        (angle_rad, velocity_rad_s) = advance(step_s);
    }
    (angles_rad, angle_rad)
}

/// As the converter has them.
fn read(angles_rad: &[f64], chance: &mut Chance) -> Recording {
    let seen = angles_rad.iter().map(|angle| converted(angle + LSB_RAD * chance.normal())).collect();
    Recording::uniform(RATE_HZ, seen).expect("a recording of seconds has enough samples")
}

fn converted(angle_rad: f64) -> f64 {
    (angle_rad / LSB_RAD).round() * LSB_RAD
}
