//! Friction that no law of the list describes: the diagnosis offers it as a free curve of the speed, with a band that
//! holds the truth, says where it does not hold, and never speaks of one where a named law explains the swings. Of what
//! is left then it says whether that follows angle and speed.

use host::diagnose::of_state::Kind;
use host::diagnose::{FrictionCurve, diagnose};
use host::improve::{Change, change};
use host::verdict::Left;
use tests::hidden::{Hidden, Rig};

/// Friction that is higher about 4 rad/s: strength in N·m, place and width in rad/s.
const STRENGTH_NM: f64 = 1.5e-3;
const PLACE_RAD_S: f64 = 4.0;
const WIDTH_RAD_S: f64 = 0.8;

fn rig(hidden: Vec<Hidden>) -> Rig {
    Rig {
        hidden,
        releases_rad: vec![1.4, -1.0, 0.6],
        rate_hz: 100.0,
        stiction_nm: 0.0,
        velocity_band: 0.0,
        ..Rig::random(5)
    }
}

/// What is found of two releases is found of three too, which take longer. Where nothing may be claimed, and where a band
/// is held against the truth, three show more.
fn released_twice(rig: Rig) -> Rig {
    Rig { releases_rad: rig.releases_rad[..2].to_vec(), ..rig }
}

fn hidden(name: &'static str, size: f64, shape: [f64; 2]) -> Hidden {
    Hidden { name, size, shape, largest: size, is_listed: false }
}

fn bumpy() -> Rig {
    rig(vec![hidden("bump", STRENGTH_NM, [PLACE_RAD_S, WIDTH_RAD_S])])
}

fn truth_nm(rig: &Rig, speed: f64) -> f64 {
    rig.coulomb_nm + rig.viscous * speed + STRENGTH_NM * (-((speed - PLACE_RAD_S) / WIDTH_RAD_S).powi(2)).exp()
}

/// Knots at which the curve is more than so many of its ± from the truth, and a hundredth of the friction.
fn off(curve: &FrictionCurve, rig: &Rig, stds: f64) -> Vec<(f64, f64, f64)> {
    let knots = curve.speeds.iter().zip(&curve.torques).zip(&curve.stds);
    let known = knots.filter_map(|((speed, torque), std)| Some((*speed, curve.built_up + torque, (*std)?)));
    let is_off = |(speed, torque, std): &(f64, f64, f64)| {
        let truth = truth_nm(rig, *speed);
        (torque - truth).abs() > stds * std + 0.01 * truth
    };
    known.filter(is_off).collect()
}

#[test]
fn friction_of_no_law_is_offered_as_a_curve_whose_band_holds_the_truth() {
    let rig = bumpy();
    let (swings, held_out) = (rig.swings(), Rig { releases_rad: vec![-1.2], seed: 77, ..rig.clone() }.swings());
    let diagnosis = diagnose(&swings, &held_out, &rig.known());
    let curve = diagnosis.curve.as_ref().expect("a curve");
    assert!(curve.rmse < 1.1 * diagnosis.noise, "{:.2} noises, {curve:?}", curve.rmse / diagnosis.noise);
    assert!(curve.beside.is_empty(), "{:?}", curve.beside);
    assert!(curve.holds(), "{:?}", curve.contradicted);
    let (far, outside) = (off(curve, &rig, 4.0), off(curve, &rig, 2.0));
    assert!(far.is_empty() && 4 * outside.len() <= curve.speeds.len(), "{outside:?} of {curve:?}");
    assert!(curve.stds.iter().flatten().count() >= 4, "{:?}", curve.stds);
    assert!(curve.closest().is_none_or(|law| law.share > 0.02), "{:?}", curve.resembles);

    // It is taken by hand, and predicts a release that took no part.
    let steps = change(&swings, &held_out, &rig.known(), &[Change::Add(&host::formula::FRICTION_CURVE)]).unwrap();
    assert!(steps[1].held_out.unwrap() < 1.3 * diagnosis.noise && steps[0].held_out.unwrap() > 2.0 * diagnosis.noise);
}

#[test]
fn where_a_named_law_explains_the_swings_no_curve_is_spoken_of() {
    for hidden in [vec![], vec![hidden("quadratic-drag", 2e-4, [0.0; 2])], vec![hidden("stribeck", 1.5e-3, [0.8, 0.0])]]
    {
        let rig = rig(hidden);
        let diagnosis = diagnose(&rig.swings(), &[], &rig.known());
        assert!(diagnosis.curve.is_none() && !diagnosis.unexplained, "{:?}: {:?}", rig.hidden, diagnosis.verdict);
    }
}

/// Brakes beside the path: friction depends on the angle, and no curve of the speed is called an explanation.
#[test]
fn friction_that_depends_on_the_angle_too_is_never_called_explained() {
    let rig = released_twice(rig(vec![hidden("outside", 6e-3, [0.55, 0.12])]));
    let diagnosis = diagnose(&rig.swings(), &[], &rig.known());
    assert!(diagnosis.unexplained, "{:?}", diagnosis.verdict);
    let split = diagnosis.of_state.as_ref().expect("more than the noise is left");
    assert!(matches!(split.kind, Kind::Law | Kind::LawOrScale) && split.torque_removes > 0.9, "{split:?}");
    let explains = diagnosis.curve.filter(|curve| curve.holds() && curve.left != Left::Missing);
    assert!(explains.is_none(), "{explains:?}");
}

/// Its readings come ever later, so that swings seem to jump: no torque of angle and speed does that.
#[test]
fn a_clock_that_loses_time_is_no_law_of_the_motion() {
    let rig = released_twice(Rig { clock_jump_s: 5e-3, ..rig(Vec::new()) });
    let diagnosis = diagnose(&rig.swings(), &[], &rig.known());
    assert!(diagnosis.unexplained, "{:?}", diagnosis.verdict);
    let split = diagnosis.of_state.expect("more than the noise is left");
    assert!(split.kind == Kind::Elsewhere && split.words.contains("There remain clock"), "{split:?}");
}

/// Whoever has no camera is told of no shutter; whoever has one is told of a law or a scale, and which it would be.
#[test]
fn a_picture_that_is_read_line_by_line_is_offered_and_not_claimed() {
    let rig = rig(vec![hidden("rolling-shutter", 5e-3, [0.0; 2])]);
    let diagnosis = diagnose(&rig.swings(), &[], &rig.known());
    assert!(diagnosis.unexplained && diagnosis.verdict.is_empty(), "{:?}", diagnosis.verdict);
    let split = diagnosis.of_state.expect("more than the noise is left");
    assert_eq!(split.kind, Kind::LawOrScale, "{split:?}");
    let offered = split.of_pictures.as_ref().expect("an effect of pictures");
    assert!(offered.effect == "rolling-shutter" && offered.rmse < 1.1 * diagnosis.noise, "{split:?}");
}
