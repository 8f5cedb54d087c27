//! How a model follows swings of which much else than its own motion was recorded.

use super::diagnose;
use super::tests::{NOISE_RAD, rig, simulated};
use crate::fit::identify::{self, Method, Options};
use crate::random::Noise;
use crate::swing::Swing;
use crate::verdict::Left;

#[test]
fn where_noise_is_as_large_as_the_motion_it_is_said_that_nothing_follows() {
    let follows = |noise_rad: f64| {
        let mut swing = simulated("noisy", &rig(), 6.0, 1);
        let mut noise = Noise::new(2);
        swing.angles_rad.iter_mut().for_each(|angle| *angle += noise_rad * noise.normal());
        swing.noise_rad = noise_rad.hypot(NOISE_RAD);
        let found = diagnose(&[swing], &[], &rig());
        (found.left, found.follows)
    };
    assert_eq!(follows(0.0), (Left::Noise, true));
    assert_eq!(follows(2.0), (Left::Noise, false));
}

/// A swing of the rig in which another pendulum is seen, that begins with this share of its angle.
fn beside_another(share: f64) -> [Swing; 1] {
    let mut swing = simulated("beside", &rig(), 8.0, 1);
    for (time_s, angle_rad) in swing.times_s.iter().zip(&mut swing.angles_rad) {
        *angle_rad += share * 1.4 * (-time_s / 5.0).exp() * (11.0 * time_s).sin();
    }
    [swing]
}

#[test]
fn where_another_motion_is_seen_fit_and_diagnosis_say_that_the_model_hardly_follows() {
    let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
    let hardly = |share: f64| {
        let swings = beside_another(share);
        let fit = identify::fit(&swings, &[], &rig(), &options, &|_| ()).unwrap();
        let is_told = fit.warnings.iter().any(|words| words.contains("hardly follows"));
        let found = diagnose(&swings, &[], &rig());
        assert_eq!(fit.left, Left::Missing);
        [fit.hardly_follows, is_told, found.hardly_follows]
    };
    assert_eq!(hardly(0.4), [true; 3]);
    assert_eq!(hardly(0.1), [false; 3]);
}
