//! Friction as a free, smooth curve of the speed, fitted: from a fitted model, its laws of speed alone folded into the
//! curve, to the curve that predicts blocks left out best.
//!
//! The torques at the knots are unknowns of the ordinary least squares; how many knots and how stiff a ridge,
//! [`super::blocks`] decides, once where the model comes from and once more where the fit led to.

use super::blocks::{Begin, Choice, between, choice};
use super::descent::Tolerance;
use super::fitted::Fitted;
use super::problem::Problem;
use super::refine::Band;
use super::ridge::Ridge;
use crate::recording::Measured;
use crate::swing::Swing;
use shared::curve::{Curve, MAX_KNOTS};
use shared::effect::{Action, CURVE_ID, Effect};
use shared::model::Model;
use shared::motion::Motion;
use shared::parameters::{EffectValues, Parameters};

/// So many of the knots stand evenly over all speeds, the others where the path is covered at them, of which the last
/// swings have little. On a simulated bump of 0.8 rad/s at half the largest speed none would leave it three knots; all
/// would leave dense speeds no more than empty ones.
const EVENLY: f64 = 0.5;

/// Two knots are no closer than this share of the largest speed.
const CLOSEST: f64 = 2e-3;

/// Where a law of friction is looked at: angles (rad), times (s); it is one of speed alone if it is the same at all.
const ANGLES_RAD: [f64; 3] = [0.0, 0.7, -1.1];
const TIMES_S: [f64; 2] = [0.0, 7.0];

/// Knots and ridge are chosen so often at most, …
const MAX_ROUNDS: usize = 3;

/// … and again where the fit with them left less than this share of the squares. Half and twice of neither were tried.
const WORTH_ANOTHER_ROUND: f64 = 0.95;

/// A curve of many knots bends the valley of the error more than a law of two numbers does.
const PATIENT: Tolerance = Tolerance { max_iterations: 40, least_gain: 3.0, least_share: 3e-4, ..Tolerance::FINE };

/// Sliding so far builds up whatever builds up, rad.
const FAR_RAD: f64 = 30.0;

/// A friction curve and how well its torques are known.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownCurve {
    /// The knots.
    pub curve: Curve<f64>,
    /// Standard deviations of the torques, N·m, where they are known.
    pub stds: Vec<Option<f64>>,
}

/// A fitted curve and what the blocks say of it.
#[derive(Clone, Debug)]
pub struct Curved {
    /// The model with the curve; its cost is without the ridge.
    pub model: Fitted,
    /// The ridge it was fitted with.
    pub ridge: Ridge,
    /// What was chosen, and how well blocks left out are predicted.
    pub choice: Choice,
}

/// Fits a curve in place of the laws of speed of a model; `None` where the swings are too short to choose one, or where
/// it is no better than the model.
pub fn curved(on: &Problem, from: &Fitted) -> Option<Curved> {
    let decimated = on.decimated();
    let rough = on.on(&decimated);
    let begun = begun(from, &placed(&rough, from)?)?;
    settled(on, &rough, &begun, Begin::Anew).filter(|found| found.model.cost < from.cost)
}

/// The same with one more effect beside the curve, from one of its starts; `None` where that is no better.
pub fn extended(on: &Problem, from: &Curved, effect: &'static Effect<f64>, start: &[f64]) -> Option<Curved> {
    let decimated = on.decimated();
    let rough = on.on(&decimated);
    let ridged = Problem { ridge: Some(from.ridge.clone()), ..rough.clone() };
    let curve = from.model.parameters.curve.as_ref()?;
    let begun = from.model.without(CURVE_ID).with(effect, start)?.with_curve(curve)?;
    settled(on, &rough, &descended(&begun, &ridged), Begin::GoesOn).filter(|found| found.model.cost < from.model.cost)
}

/// Chosen and fitted in turn until that changes nothing, then fitted to all samples.
fn settled(on: &Problem, rough: &Problem, from: &Fitted, first: Begin) -> Option<Curved> {
    let speeds = placed(rough, from)?;
    let mut found = from.evaluated(rough);
    let mut chosen: Option<Choice> = None;
    for round in 0..MAX_ROUNDS {
        let begin = if round == 0 { first } else { Begin::GoesOn };
        let choice = choice(rough, &finer(&found, &speeds)?, begin)?;
        if chosen.as_ref().is_some_and(|before| choice.left_out_rad > before.left_out_rad) {
            break;
        }
        let next = fitted(rough, &found, &choice)?;
        let before = std::mem::replace(&mut found, next).cost;
        chosen = Some(choice);
        if round > 0 && found.cost > WORTH_ANOTHER_ROUND * before {
            break;
        }
    }
    let choice = chosen?;
    let ridge = Ridge::new(choice.curve.speeds_rad_s(), choice.strength);
    let ridged = Problem { ridge: Some(ridge.clone()), ..on.clone() };
    let [held, level] =
        [Band::Held, Band::Level].map(|band| found.refined(&ridged, band, Tolerance::JUDGE).evaluated(on));
    let model = held.better(level);
    Some(Curved { model, ridge, choice })
}

/// The model with the chosen knots and ridge, fitted on decimated swings: from the friction it has, or from the chosen
/// one where that comes nearer. Its cost is without the ridge.
fn fitted(rough: &Problem, from: &Fitted, choice: &Choice) -> Option<Fitted> {
    let ridge = Some(Ridge::new(choice.curve.speeds_rad_s(), choice.strength));
    let ridged = Problem { ridge, ..rough.clone() };
    let present = finer(from, choice.curve.speeds_rad_s())?.evaluated(&ridged);
    let wanted = from.with_curve(&choice.curve)?.evaluated(&ridged);
    Some(descended(&present.better(wanted), &ridged).evaluated(rough))
}

/// Where swings rest also first without the last swings before that, in which the error has edges that hold a descent
/// up.
fn descended(from: &Fitted, on: &Problem) -> Fitted {
    let whole = || from.refined(on, Band::Held, PATIENT);
    if !on.comes_to_rest() {
        return whole();
    }
    let (lively, whole) = rayon::join(|| from.lively(on, PATIENT).refined(on, Band::Held, PATIENT), whole);
    lively.better(whole)
}

/// The model with the same friction as a curve of many knots.
fn begun(from: &Fitted, speeds_rad_s: &[f32]) -> Option<Fitted> {
    let torques: Vec<f64> =
        speeds_rad_s.iter().map(|speed| friction_of_speed_nm(&from.parameters, f64::from(*speed)).max(0.0)).collect();
    let laws =
        from.effects.iter().filter(|effect| effect.id != CURVE_ID && is_of_speed_alone(&from.parameters, effect.id));
    let without = laws.fold(from.clone(), |model, effect| model.without(effect.id));
    without.with_curve(&Curve::new(speeds_rad_s, &torques)?)
}

/// A model with a curve, which gets other knots; its friction stays as it is.
fn finer(model: &Fitted, speeds_rad_s: &[f32]) -> Option<Fitted> {
    let curve = model.parameters.curve.as_ref()?;
    let torques =
        between(curve.speeds_rad_s(), speeds_rad_s) * nalgebra::DVector::from_column_slice(curve.torques_nm());
    let torques: Vec<f64> = torques.iter().map(|torque| torque.max(0.0)).collect();
    model.with_curve(&Curve::new(speeds_rad_s, &torques)?)
}

/// All friction that depends on the speed alone, at a speed in rad/s, N·m, positive.
pub fn friction_of_speed_nm(parameters: &Parameters<f64>, speed_rad_s: f64) -> f64 {
    let mut only = Parameters::frictionless(parameters.pendulum);
    let of_speed = parameters.effects.iter().filter(|effect| is_of_speed_alone(parameters, effect.id));
    only.effects.extend(of_speed.cloned());
    (only.formula, only.curve) = (parameters.formula.clone(), parameters.curve.clone());
    -Model::new(&only).friction_of_sliding_nm(0.0, speed_rad_s, 1.0, 0.0)
}

/// What torques with a memory add once they have built up in steady sliding, N·m, positive against the motion.
pub fn built_up_nm(parameters: &Parameters<f64>) -> f64 {
    let motion = |angle_rad: f64| Motion {
        angle_rad,
        velocity_rad_s: 1.0,
        direction: 1.0,
        time_s: 0.0,
        pendulum: parameters.pendulum,
    };
    let of = |present: &EffectValues<f64>| {
        let Some(Action::State(memory)) = Effect::<f64>::by_id(present.id).map(|effect| effect.action) else {
            return 0.0;
        };
        let values = std::array::from_fn(|i| present.values.get(i).copied().unwrap_or(0.0));
        let (before, after) = (motion(0.0), motion(FAR_RAD));
        let built_up = (memory.advance)(&before, &after, &(memory.start)(&before, &values), &values);
        -(memory.torque)(&after, &built_up, &values)
    };
    parameters.effects.iter().map(of).sum()
}

/// Is an effect friction that neither angle nor time nor direction changes?
pub fn is_of_speed_alone(parameters: &Parameters<f64>, id: u16) -> bool {
    let mut only = Parameters::frictionless(parameters.pendulum);
    only.effects.extend(parameters.effects.iter().filter(|effect| effect.id == id).cloned());
    (only.formula, only.curve) = (parameters.formula.clone(), parameters.curve.clone());
    let model = Model::new(&only);
    let speeds = [0.1, 1.0, 5.0];
    let is_same = |speed: f64| {
        let here = model.friction_of_sliding_nm(0.0, speed, 1.0, 0.0);
        let like = |there: f64| (there - here).abs() <= 1e-12 * here.abs();
        let instants = ANGLES_RAD.iter().flat_map(|angle| TIMES_S.iter().map(move |time| (*angle, *time)));
        instants.into_iter().all(|(angle, time)| {
            let back = -model.friction_of_sliding_nm(angle, -speed, -1.0, time);
            like(model.friction_of_sliding_nm(angle, speed, 1.0, time)) && like(back)
        })
    };
    let acts = |speed: f64| model.friction_of_sliding_nm(0.0, speed, 1.0, 0.0) != 0.0;
    speeds.into_iter().all(is_same) && speeds.into_iter().any(acts)
}

/// As many knots as there may be, at quantiles of the speed of the model's swings; `None` if nothing moves.
pub(super) fn placed(on: &Problem, model: &Fitted) -> Option<Vec<f32>> {
    let mut speeds = speeds_rad_s(on, model);
    speeds.retain(|speed| speed.is_finite() && *speed > 0.0);
    speeds.sort_by(f64::total_cmp);
    let largest = *speeds.last()?;
    let total: f64 = speeds.iter().sum();
    let mut knots: Vec<f32> = vec![0.0];
    let mut sum = 0.0;
    for speed in &speeds {
        sum += speed;
        let reached = EVENLY * speed / largest + (1.0 - EVENLY) * sum / total;
        let wanted = knots.len() as f64 / (MAX_KNOTS - 1) as f64;
        let last = f64::from(knots[knots.len() - 1]);
        if reached >= wanted && speed - last > CLOSEST * largest && largest - speed > CLOSEST * largest {
            knots.push(*speed as f32);
        }
    }
    knots.truncate(MAX_KNOTS - 1);
    knots.push(largest as f32);
    Some(knots)
}

/// Speeds of a model along the swings it was fitted to, at even times, rad/s.
fn speeds_rad_s(on: &Problem, model: &Fitted) -> Vec<f64> {
    let (problem, point) = (model.problem(on), model.point());
    let of_swing = |(idx, swing): (usize, &Swing)| -> Vec<f64> {
        let readings = problem.predict(idx, swing.len(), &[(&point.values, point.starts[idx])]).swap_remove(0);
        if swing.measured == Measured::Rate {
            return readings.iter().map(|rate| rate.abs()).collect();
        }
        let pairs = swing.times_s.windows(2).zip(readings.windows(2));
        pairs.map(|(times, angles)| ((angles[1] - angles[0]) / (times[1] - times[0])).abs()).collect()
    };
    on.swings.iter().enumerate().flat_map(of_swing).collect()
}
