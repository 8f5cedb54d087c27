//! Laws are held, used by the observer, and kept in flash; what is none is refused.

use super::*;
use crate::effect::Effect;
use crate::parameters::ParameterError;
use crate::rig::{MAX_STORED, Outcome, Request, Rig, Stored};
use crate::units::Code;
use crate::wire::{Answer, Command, Frame, StoreState, Stream};

fn rig() -> Rig {
    Rig::new("test", 4095, Err(StoreState::Empty))
}

fn tell(rig: &mut Rig, frame: Frame) -> Frame {
    match rig.on_frame(frame) {
        Outcome::Send(frame) => frame,
        other => panic!("no answer but {other:?}"),
    }
}

fn ask(rig: &mut Rig, command: Command) -> Answer {
    let Frame::Answer(1, answer) = tell(rig, Frame::Command(1, command)) else { panic!("no answer") };
    answer
}

fn refused(error: ParameterError) -> Answer {
    Answer::Refused(Refusal::Parameters(error))
}

/// −k·ω·|ω|, k a parameter.
fn drag() -> Formula {
    use crate::formula::code::{ABS, MULTIPLY, NEGATE, OMEGA, PARAMETER};
    let code = [PARAMETER, NEGATE, OMEGA, MULTIPLY, OMEGA, ABS, MULTIPLY];
    Formula::new(&code, &[], 1, "-k*omega*abs(omega); k in 0..1e-2 N·m").unwrap()
}

fn with_drag(rig: &Rig) -> Parameters<f32> {
    let mut parameters = rig.parameters().clone();
    parameters.set(CUSTOM_FORMULA_ID, &[1e-3]).unwrap();
    parameters
}

fn formula_frame(bytes: &[u8]) -> Frame {
    Frame::CustomFormula(bytes.iter().copied().collect())
}

/// The rig's own Coulomb and viscous friction as a curve, at as many knots as it may have; and a drag in it.
fn knots(drag: f32) -> Vec<Knot, MAX_KNOTS> {
    let speed = |k: usize| 0.3 * k as f32;
    (0..MAX_KNOTS).map(speed).map(|v| [v, 5.5e-4 + 5.5e-4 * v + drag * v * v]).collect()
}

fn with_curve(rig: &Rig) -> Parameters<f32> {
    let mut parameters = rig.parameters().clone();
    parameters.remove(crate::parameters::base::VISCOUS);
    parameters.remove(crate::parameters::base::COULOMB);
    parameters.set(CURVE_ID, &[]).unwrap();
    parameters
}

/// The rig after a restart, with what it saves.
fn restarted(rig: &mut Rig) -> Rig {
    assert_eq!(rig.on_frame(Frame::Command(5, Command::Save)), Outcome::Do(5, Request::Save));
    let (stored, mut buffer) = (rig.stored(), [0; MAX_STORED]);
    let read = Stored::decode(stored.encode(&mut buffer).unwrap());
    assert_eq!(read, Ok(stored));
    Rig::new("test", 4095, read)
}

/// What the observer makes of a swing.
fn swing(rig: &mut Rig) -> std::vec::Vec<f32> {
    ask(rig, Command::Start(Stream { raw: false, live_every: 1 }));
    let code = |i: u32| Code((2048.0 + 500.0 * libm::cosf(i as f32 * 8e-3)) as u16);
    let mut angles = std::vec::Vec::new();
    (0..4000).for_each(|i| {
        rig.on_sample(code(i), |frame| {
            let Frame::Live(live) = frame else { panic!() };
            angles.extend(live.points.iter().map(|point| point.angle_rad));
        })
    });
    angles
}

/// What it makes of it with the listed drag, and without.
fn with_the_listed_drag_and_without() -> [std::vec::Vec<f32>; 2] {
    let mut listed = rig();
    let mut known = listed.parameters().clone();
    known.set(Effect::<f32>::by_name("quadratic-drag").unwrap().id, &[1e-3]).unwrap();
    assert_eq!(ask(&mut listed, Command::SetParameters((&known).into())), Answer::Done);
    [swing(&mut listed), swing(&mut rig())]
}

fn apart(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
#[cfg_attr(miri, ignore = "too long for an interpreter")]
fn a_formula_is_held_used_by_the_observer_and_kept_in_flash() {
    let mut rig = rig();
    let law = formula_frame(drag().bytes());
    assert_eq!(tell(&mut rig, formula_frame(&[])), formula_frame(&[]));
    assert_eq!(tell(&mut rig, law.clone()), law);
    let parameters = with_drag(&rig);
    assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), Answer::Done);

    let mut restarted = restarted(&mut rig);
    assert_eq!(tell(&mut restarted, formula_frame(&[])), law);
    let ([listed, plain], typed) = (with_the_listed_drag_and_without(), swing(&mut restarted));
    assert!(apart(&typed, &listed) < 1e-5, "{}", apart(&typed, &listed));
    assert!(apart(&typed, &plain) > 1e-2, "{}", apart(&typed, &plain));
}

#[test]
#[cfg_attr(miri, ignore = "too long for an interpreter")]
fn a_friction_curve_is_held_used_by_the_observer_and_kept_in_flash_beside_a_formula() {
    let mut rig = rig();
    let curve = Frame::FrictionCurve(knots(1e-3));
    assert_eq!(tell(&mut rig, Frame::FrictionCurve(Vec::new())), Frame::FrictionCurve(Vec::new()));
    assert_eq!(tell(&mut rig, curve.clone()), curve);
    let mut parameters = with_curve(&rig);
    assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), Answer::Done);

    let mut alone = restarted(&mut rig);
    assert_eq!(tell(&mut alone, Frame::FrictionCurve(Vec::new())), curve);
    let ([listed, plain], curved) = (with_the_listed_drag_and_without(), swing(&mut alone));
    assert!(apart(&curved, &listed) < 1e-5, "{}", apart(&curved, &listed));
    assert!(apart(&curved, &plain) > 1e-2, "{}", apart(&curved, &plain));

    // With a formula behind it in flash, of no strength.
    tell(&mut rig, formula_frame(drag().bytes()));
    parameters.set(CUSTOM_FORMULA_ID, &[0.0]).unwrap();
    assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), Answer::Done);
    let mut both = restarted(&mut rig);
    assert_eq!(tell(&mut both, Frame::FrictionCurve(Vec::new())), curve);
    assert_eq!(tell(&mut both, formula_frame(&[])), formula_frame(drag().bytes()));
    assert_eq!(swing(&mut both), curved);
}

#[test]
fn values_without_a_formula_and_bytes_without_a_program_are_refused() {
    let mut rig = rig();
    let parameters = with_drag(&rig);
    let unknown = refused(ParameterError::UnknownEffect { id: CUSTOM_FORMULA_ID });
    assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), unknown);
    let no_program = tell(&mut rig, formula_frame(&[1, 0, 0, 0xff]));
    assert_eq!(no_program, Frame::Answer(0, Answer::Refused(Refusal::Formula)));
    tell(&mut rig, formula_frame(drag().bytes()));
    let mut two_values = rig.parameters().clone();
    two_values.set(CUSTOM_FORMULA_ID, &[1.0, 2.0]).unwrap();
    let count = ParameterError::WrongCount { id: CUSTOM_FORMULA_ID, expected: 1, got: 2 };
    assert_eq!(ask(&mut rig, Command::SetParameters((&two_values).into())), refused(count));
    let mut no_number = rig.parameters().clone();
    no_number.set(CUSTOM_FORMULA_ID, &[f32::NAN]).unwrap();
    let range = ParameterError::OutOfRange { id: CUSTOM_FORMULA_ID, index: 0 };
    assert_eq!(ask(&mut rig, Command::SetParameters((&no_number).into())), refused(range));
}

#[test]
fn a_curve_that_is_none_is_refused_and_the_one_before_stays() {
    let mut rig = rig();
    let parameters = with_curve(&rig);
    let unknown = refused(ParameterError::UnknownEffect { id: CURVE_ID });
    assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), unknown);
    let good = Frame::FrictionCurve(knots(0.0));
    tell(&mut rig, good.clone());
    let bad: [&[Knot]; 5] = [
        &[[0.0, 1e-3]],
        &[[0.1, 1e-3], [1.0, 1e-3]],
        &[[0.0, 1e-3], [1.0, 1e-3], [1.0, 1e-3]],
        &[[0.0, 1e-3], [f32::NAN, 1e-3]],
        &[[0.0, 1e-3], [f32::INFINITY, 1e-3]],
    ];
    for knots in bad {
        let answer = tell(&mut rig, Frame::FrictionCurve(Vec::from_slice(knots).unwrap()));
        assert_eq!(answer, Frame::Answer(0, Answer::Refused(Refusal::Curve)), "{knots:?}");
    }
    assert_eq!(tell(&mut rig, Frame::FrictionCurve(Vec::new())), good);

    // No torque at all, or one that drives, is told when the curve is to act; so is friction beside it.
    for torque in [f32::NAN, -1e-6] {
        tell(&mut rig, Frame::FrictionCurve(Vec::from_slice(&[[0.0, 1e-3], [1.0, torque]]).unwrap()));
        let range = ParameterError::OutOfRange { id: CURVE_ID, index: 1 };
        assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), refused(range));
    }
    tell(&mut rig, good);
    let mut beside = rig.parameters().clone();
    beside.set(CURVE_ID, &[]).unwrap();
    let twice = ParameterError::BesideCurve { id: crate::parameters::base::VISCOUS };
    assert_eq!(ask(&mut rig, Command::SetParameters((&beside).into())), refused(twice));
}

#[test]
fn content_whose_curve_is_cut_is_damaged() {
    let mut rig = rig();
    tell(&mut rig, Frame::FrictionCurve(knots(0.0)));
    let parameters = with_curve(&rig);
    assert_eq!(ask(&mut rig, Command::SetParameters((&parameters).into())), Answer::Done);
    assert_eq!(rig.on_frame(Frame::Command(5, Command::Save)), Outcome::Do(5, Request::Save));
    let (stored, mut buffer) = (rig.stored(), [0; MAX_STORED]);
    let bytes = stored.encode(&mut buffer).unwrap();
    for n_bytes in bytes.len() - 8 * MAX_KNOTS - 1..bytes.len() {
        assert_eq!(Stored::decode(&bytes[..n_bytes]), Err(StoreState::Damaged), "{n_bytes}");
    }
}
