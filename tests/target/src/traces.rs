//! Computations in `f32` whose every result must have the same bits on board and PC.

use crate::noise::Noise;
use shared::curve::{Curve, Knot, MAX_KNOTS};
use shared::effect::Effect;
use shared::filter::{Butterworth, FilterState};
use shared::formula::{Formula, code};
use shared::model::Model;
use shared::observer::Observer;
use shared::parameters::{Parameters, base};
use shared::potentiometer::Potentiometer;
use shared::real::Real;
use shared::rig::Rig;
use shared::units::Code;
use shared::wire::{Command, Frame, MAX_FRAME, StoreState, Stream, encode};

const DT_S: f32 = 1e-3;

/// A swing as long as the paper's recording.
pub const SWING_STEPS: usize = 45_000;

/// Release angle of the swing, rad.
pub const RELEASE_RAD: f32 = 1.5;

/// A computation that gives its results one by one.
pub struct Trace {
    /// What it computes.
    pub name: &'static str,
    /// Does it.
    pub run: fn(&mut dyn FnMut(u32)),
}

/// All of them.
pub const ALL: &[Trace] = &[
    Trace { name: "sine", run: sine },
    Trace { name: "potentiometer", run: potentiometer },
    Trace { name: "filter", run: filter },
    Trace { name: "model", run: |emit| swing(&mut |angle_rad| emit(angle_rad.to_bits())) },
    Trace { name: "every-effect", run: every_effect },
    Trace { name: "formula", run: formula },
    Trace { name: "friction-curve", run: friction_curve },
    Trace { name: "observer", run: observer },
    Trace { name: "rig", run: rig },
];

/// A trace in two numbers: how many results, and their FNV-1a hash.
pub fn fingerprint(trace: &Trace) -> (u32, u32) {
    let (mut n_results, mut hash) = (0, 0x811c_9dc5_u32);
    (trace.run)(&mut |bits| {
        n_results += 1;
        hash = bits.to_le_bytes().iter().fold(hash, |hash, byte| (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193));
    });
    (n_results, hash)
}

/// The paper's pendulum as the board computes it.
pub fn parameters() -> Parameters<f32> {
    Parameters::paper().map(|value| value as f32)
}

/// The angle of each step of a swing without any correction.
pub fn swing(emit: &mut dyn FnMut(f32)) {
    let model = Model::new(&parameters());
    let mut state = model.release(RELEASE_RAD, 0.0);
    for _ in 0..SWING_STEPS {
        model.step(&mut state, DT_S);
        emit(state.angle_rad);
    }
}

/// Codes of a swing with a few codes of noise, on the firmware's scale.
pub fn codes(mut each: impl FnMut(Code), n_samples: usize) {
    let model = Model::new(&parameters());
    let mut state = model.release(1.0, 0.0);
    let potentiometer = Potentiometer::nominal(firmware::ports::FULL_SCALE);
    let mut noise = Noise::new(7);
    for _ in 0..n_samples {
        let measured_rad = state.angle_rad + 1e-3 * noise.symmetric();
        each(potentiometer.code(shared::units::Radian(measured_rad)));
        model.step(&mut state, DT_S);
    }
}

fn sine(emit: &mut dyn FnMut(u32)) {
    for i in -4000..4000 {
        let angle = i as f32 * 1e-2;
        // Named in full: on the PC the standard library has a sine of its own.
        emit(Real::sin(angle).to_bits());
        emit(Real::sqrt(angle * angle).to_bits());
    }
}

fn potentiometer(emit: &mut dyn FnMut(u32)) {
    let potentiometer = Potentiometer::nominal(firmware::ports::FULL_SCALE);
    for code in 0..=firmware::ports::FULL_SCALE {
        emit(potentiometer.angle(Code(code)).0.to_bits());
    }
}

fn filter(emit: &mut dyn FnMut(u32)) {
    for (cutoff_hz, rate_hz) in [(50.0, 1000.0), (1.0, 1000.0), (10.0, 10_000.0), (40.0, 100.0)] {
        let Some(filter) = Butterworth::<f32>::new(cutoff_hz, rate_hz) else { continue };
        let mut noise = Noise::new(3);
        let mut state = FilterState::settled_at(0.5);
        (0..2000).for_each(|_| emit(state.step(&filter, noise.symmetric()).to_bits()));
    }
}

/// The base model and one more effect at a time, each at a quarter of its range.
fn every_effect(emit: &mut dyn FnMut(u32)) {
    for effect in Effect::<f32>::ALL.iter().filter(|effect| !effect.is_base()) {
        let mut values = [0.0; shared::effect::MAX_VALUES];
        for (value, parameter) in values.iter_mut().zip(effect.parameters) {
            *value = (0.75 * parameter.low + 0.25 * parameter.high) as f32;
        }
        let mut parameters = parameters();
        let _ = parameters.set(effect.id, &values[..effect.parameters.len()]);
        let model = Model::new(&parameters);
        let mut state = model.release(1.0, 0.0);
        let mut sensor = model.sensor_at_rest(&state);
        for _ in 0..2000 {
            model.step(&mut state, DT_S);
            emit(state.angle_rad.to_bits());
            emit(model.read(&state, &mut sensor).to_bits());
        }
    }
}

/// A swing with a typed torque: −k·ω·|ω|^p·e^(−(θ/c)²) − ω³·10⁻⁶ + 10⁻⁴·sin 4θ.
fn formula(emit: &mut dyn FnMut(u32)) {
    use code::{
        ABS, ADD, CONSTANT, DIVIDE, EXP, MULTIPLY, NEGATE, OMEGA, PARAMETER, POWER, SINE, SUBTRACT, THETA, WHOLE_POWER,
    };
    let drag = [PARAMETER, NEGATE, OMEGA, MULTIPLY, OMEGA, ABS, PARAMETER + 1, POWER, MULTIPLY];
    let bump = [THETA, CONSTANT, DIVIDE, WHOLE_POWER + 2, NEGATE, EXP, MULTIPLY, OMEGA, WHOLE_POWER + 3];
    let rest = [CONSTANT + 1, MULTIPLY, SUBTRACT, THETA, CONSTANT + 2, MULTIPLY, SINE, CONSTANT + 3, MULTIPLY];
    let mut law = [ADD; 28];
    law[..9].copy_from_slice(&drag);
    law[9..18].copy_from_slice(&bump);
    law[18..27].copy_from_slice(&rest);
    let Some(formula) = Formula::new(&law, &[0.4, 1e-6, 4.0, 1e-4], 2, "") else { return };
    let mut parameters = parameters();
    let _ = parameters.set_formula(&formula, &[2e-4, 1.3]);
    let model = Model::new(&parameters);
    let mut state = model.release(1.0, 0.0);
    for _ in 0..5000 {
        model.step(&mut state, DT_S);
        emit(state.angle_rad.to_bits());
    }
}

/// A swing with a friction curve of as many knots as there may be: a dip, then a rise, beside stiction.
fn friction_curve(emit: &mut dyn FnMut(u32)) {
    let torque = |v: f32| 8e-4 - 3e-4 * v / (0.2 + v * v) + 5e-5 * v * v;
    let knots: [Knot; MAX_KNOTS] = core::array::from_fn(|k| [0.25 * k as f32, torque(0.25 * k as f32)]);
    let Some(curve) = Curve::through(&knots) else { return };
    let mut parameters = parameters();
    [base::VISCOUS, base::COULOMB].into_iter().for_each(|id| parameters.remove(id));
    let _ = parameters.set_curve(&curve);
    let model = Model::new(&parameters);
    let mut state = model.release(1.0, 0.0);
    for _ in 0..5000 {
        model.step(&mut state, DT_S);
        emit(state.angle_rad.to_bits());
    }
}

fn observer(emit: &mut dyn FnMut(u32)) {
    let mut wrong = parameters();
    wrong.pendulum.inertia_kg_m2 *= 1.05;
    let mut observer = Observer::new(&wrong, 3.0);
    let potentiometer = Potentiometer::nominal(firmware::ports::FULL_SCALE);
    let each = |code| {
        let estimate = observer.on_measurement(potentiometer.angle(code).0, DT_S);
        for value in [estimate.angle_rad, estimate.velocity_rad_s, estimate.friction_nm, estimate.innovation_rad] {
            emit(value.to_bits());
        }
    };
    codes(each, 10_000);
}

/// Every byte of the frames that a rig sends.
fn rig(emit: &mut dyn FnMut(u32)) {
    let mut rig = Rig::new("trace", firmware::ports::FULL_SCALE, Err(StoreState::Empty));
    rig.on_frame(Frame::Command(1, Command::Start(Stream { raw: true, live_every: 1 })));
    let each = |code| {
        rig.on_sample(code, |frame| {
            let mut buffer = [0; MAX_FRAME];
            let bytes = encode(&frame, &mut buffer).unwrap_or(&[]);
            bytes.iter().for_each(|byte| emit(u32::from(*byte)));
        });
    };
    codes(each, 5000);
}
