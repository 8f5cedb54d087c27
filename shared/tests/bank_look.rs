//! What a look says of swings of the paper's pendulum: nothing of what is right, wrong numbers where they are wrong, and
//! why where nothing can be said; the same in the board's number as in the PC's.

use shared::bank::findings::{Findings, Reason, look};
use shared::bank::refit::Releases;
use shared::model::Model;
use shared::parameters::Parameters;

const INTERVAL_S: f64 = 4e-3;

/// A 12-bit converter's step over 340°, rad.
const STEP_RAD: f64 = 1.45e-3;

/// Of swings that lack nothing, so many may be accused.
const ERROR: f64 = 1e-3;

/// Both sides, large and small.
const RELEASES_RAD: [f64; 3] = [1.4, -1.1, 0.8];

/// Pseudo-random numbers of mean zero and variance one, nearly normal.
struct Chance(u64);

impl Chance {
    fn normal(&mut self) -> f64 {
        let mut even = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| even()).sum::<f64>() - 6.0
    }
}

/// Without a velocity band, so that nothing but what a test says is off.
fn pendulum() -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(5.4e-4, 7.1e-4, 0.0, 0.0);
    parameters
}

/// Readings of so many seconds of swing.
fn swings(truth: &Parameters<f64>, seconds: f64, n_releases: usize) -> Vec<Vec<f64>> {
    let (model, mut chance) = (Model::new(truth), Chance(11));
    let mut release = |angle_rad: &f64| {
        let mut state = model.release(*angle_rad, 0.0);
        let mut sensor = model.sensor_at_rest(&state);
        let mut reading = |_| {
            let exact = model.read(&state, &mut sensor);
            model.step(&mut state, INTERVAL_S);
            ((exact / STEP_RAD + 0.6 * chance.normal()).round()) * STEP_RAD
        };
        (0..(seconds / INTERVAL_S) as usize).map(&mut reading).collect()
    };
    RELEASES_RAD.iter().take(n_releases).map(&mut release).collect()
}

fn looked(given: &Parameters<f64>, swings: &[Vec<f64>]) -> Findings<f64> {
    let parts: Vec<&[f64]> = swings.iter().map(Vec::as_slice).collect();
    look(given, &Releases::new(&parts, INTERVAL_S), ERROR)
}

fn names(findings: &Findings<f64>) -> Vec<&'static str> {
    findings.named().map(|suspect| suspect.effect.name).collect()
}

#[track_caller]
fn check_reason(given: &Parameters<f64>, swings: &[Vec<f64>], reason: Reason) {
    let findings = looked(given, swings);
    assert_eq!(names(&findings), [""; 0], "{:?}", findings.excess);
    assert_eq!(findings.reason, Some(reason), "{:?}", findings.excess);
}

#[test]
fn a_model_that_is_right_lacks_nothing() {
    check_reason(&pendulum(), &swings(&pendulum(), 30.0, 3), Reason::NothingMissing);
}

/// Over windows of several periods the lighter one loses count of the swings; over single ones it does not.
#[test]
fn a_pendulum_of_quite_another_inertia_is_put_right() {
    for factor in [0.6, 1.5] {
        let mut far = pendulum();
        far.pendulum.inertia_kg_m2 *= factor;
        check_reason(&far, &swings(&pendulum(), 30.0, 3), Reason::WrongNumbers);
    }
}

#[test]
fn numbers_that_are_wrong_are_no_missing_physics() {
    let mut wrong = pendulum();
    wrong.set_friction(7e-4, 9.2e-4, 0.0, 0.0);
    wrong.pendulum.inertia_kg_m2 *= 1.05;
    check_reason(&wrong, &swings(&pendulum(), 30.0, 3), Reason::WrongNumbers);
}

#[test]
fn a_wrong_velocity_band_is_a_wrong_number_too() {
    let mut truth = pendulum();
    truth.set_friction(5.4e-4, 7.1e-4, 1e-3, 0.055);
    check_reason(&pendulum(), &swings(&truth, 30.0, 3), Reason::WrongNumbers);
}

#[test]
fn the_model_of_another_pendulum_accuses_nobody() {
    let mut other = pendulum();
    (other.pendulum.mass_kg, other.pendulum.length_m) = (0.4, 0.5);
    let findings = looked(&other, &swings(&pendulum(), 30.0, 3));
    assert_eq!(names(&findings), [""; 0], "{:?}", findings.reason);
}

#[test]
fn a_few_swings_say_that_they_are_too_few() {
    check_reason(&pendulum(), &swings(&pendulum(), 4.0, 1), Reason::TooFewSwings);
    check_reason(&pendulum(), &[], Reason::TooFewSwings);
    check_reason(&pendulum(), &[Vec::new()], Reason::TooFewSwings);
    check_reason(&pendulum(), &[vec![0.1; 5000]], Reason::TooFewSwings);
}

/// A hand that pushes the pendulum on for a tenth of a second, twice: no law does that on all parts of the swings.
#[test]
fn a_hand_in_the_swings_is_no_law() {
    let model = Model::new(&pendulum());
    let mut pushed = swings(&pendulum(), 30.0, 3);
    for (release, from) in [(0, 1500), (1, 3000)] {
        let mut state = model.release(RELEASES_RAD[release], 0.0);
        for (index, reading) in pushed[release].iter_mut().enumerate() {
            if (from..from + 25).contains(&index) {
                state.velocity_rad_s += 0.02 * state.velocity_rad_s.signum();
                model.reconsider(&mut state);
            }
            *reading = (state.angle_rad / STEP_RAD).round() * STEP_RAD;
            model.step(&mut state, INTERVAL_S);
        }
    }
    let findings = looked(&pendulum(), &pushed);
    assert_eq!(names(&findings), [""; 0], "{:?}", findings.reason);
    assert_eq!(findings.reason, Some(Reason::Unexplained));
}

fn with(id: u16, values: &[f64]) -> Parameters<f64> {
    let mut parameters = pendulum();
    parameters.set(id, values).unwrap();
    parameters
}

/// One of each kind: friction, drive, memory, sensor, sensor with a memory; and how exactly its last strength is found.
/// The bristle shares its friction with what the velocity band, free beside it, takes.
fn missing() -> Vec<(&'static str, Parameters<f64>, f64)> {
    vec![
        ("quadratic-drag", with(10, &[8e-5]), 0.02),
        ("detent", with(15, &[6e-4, 4e-4, 6.0]), 0.02),
        ("presliding", with(50, &[6e-4, 5e-3]), 0.3),
        ("sensor-nonlinearity", with(32, &[0.0, 0.03, 0.02]), 0.02),
        ("backlash", with(34, &[0.012, 0.0]), 0.02),
    ]
}

#[test]
fn what_is_missing_is_named_with_its_size() {
    for (name, truth, tolerance) in missing() {
        let findings = looked(&pendulum(), &swings(&truth, 30.0, 3));
        assert_eq!(names(&findings).first(), Some(&name), "{:?}", findings.reason);
        let suspect = findings.named().next().unwrap();
        let hidden = truth.values(suspect.effect.id).unwrap();
        let place = usize::from(*suspect.strengths.last().unwrap());
        let (found, true_size) = (suspect.values[place], hidden[place]);
        assert!((found / true_size - 1.0).abs() < tolerance, "{name}: {found} instead of {true_size}");
        assert!(findings.left.unwrap() < 0.1, "{name} leaves {:?}", findings.left);
    }
}

/// F within 2 %, and the same names: single precision decides nothing.
#[test]
fn the_boards_number_says_the_same() {
    for (name, truth, _) in missing().into_iter().chain([("", pendulum(), 0.0)]) {
        let swings = swings(&truth, 30.0, 3);
        let exact = looked(&pendulum(), &swings);
        let single: Vec<Vec<f32>> =
            swings.iter().map(|swing| swing.iter().map(|angle| *angle as f32).collect()).collect();
        let parts: Vec<&[f32]> = single.iter().map(Vec::as_slice).collect();
        let on = Releases::new(&parts, INTERVAL_S as f32);
        let rounded = look(&pendulum().map(|value| value as f32), &on, ERROR as f32);
        let single_names: Vec<&str> = rounded.named().map(|suspect| suspect.effect.name).collect();
        assert_eq!(single_names.first(), names(&exact).first(), "{name}");
        assert_eq!(rounded.reason, exact.reason, "{name}");
        if let (Some(a), Some(b)) = (exact.named().next(), rounded.named().next()) {
            let ratio = f64::from(b.evidence.f) / a.evidence.f;
            println!("{name}: F {} and {}", a.evidence.f, b.evidence.f);
            assert!((ratio - 1.0).abs() < 0.02, "{name}: F {} and {}", a.evidence.f, b.evidence.f);
        }
    }
}
