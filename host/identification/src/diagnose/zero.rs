//! Is the sensor's zero off, or does the bearing rub more one way than the other?
//!
//! The offset is a free number of every fit, so it is claimed by its value and not by its gain: common to the
//! recordings, significant, above one step of the converter. Dry friction that differs between the directions shifts the
//! swings just the same; only their last, small ones differ a little. So where an offset shows, the asymmetry stands
//! against it.

use super::models::{ALIKE_NOISES, MOST_LEFT};
use super::physical::is_sound;
use super::value::Value;
use crate::fit::covariance::with_model_error;
use crate::fit::descent::{Tolerance, descend};
use crate::fit::fitted::Fitted;
use crate::fit::linear::Steps;
use crate::fit::prediction::predictions;
use crate::fit::problem::{PER_SWING, Problem, Start};
use crate::fit::refine::Band;
use crate::fit::uncertainty::Status;
use crate::number::with_spread;
use crate::recording::Measured;
use crate::recording::noise::smallest_step;
use crate::swing::wandering::COMMON;
use crate::swing::zero::within_half_a_turn;
use crate::swing::{Swing, Window};
use shared::effect::Effect;

/// The effect that is named when the zero is off.
pub fn offset() -> Option<&'static Effect<f64>> {
    Effect::with(|rules| rules.is_free_offset).next()
}

/// What else shifts the swings.
pub(super) fn resembling() -> Option<&'static Effect<f64>> {
    Effect::with(|rules| rules.resembles_offset).next()
}

/// A common offset is claimed from this many standard errors …
const SIGNIFICANT: f64 = 5.0;

/// … and from one step of the sensor on, where the readings come in steps that are not far below the noise (printed
/// digits are); else from the noise on.
const STEP_SHARE: f64 = 0.25;

/// What no offset can be told below, rad: the coarsest of the sensors counts.
fn visible_rad(problem: &Problem) -> f64 {
    let of_swing = |swing: &Swing| {
        let step_rad = smallest_step(&swing.angles_rad).filter(|step_rad| *step_rad > STEP_SHARE * swing.noise_rad);
        step_rad.unwrap_or(swing.noise_rad)
    };
    problem.swings.iter().map(of_swing).fold(0.0, f64::max)
}

/// What shifts the swings.
#[derive(Clone, Debug)]
pub struct Zero {
    /// The claimed model, with the asymmetry if that is what shifts them.
    pub model: Fitted,
    /// Is the sensor's zero off?
    pub offset_is_missing: bool,
    /// What could stand for the offset.
    pub alike: Option<&'static str>,
}

/// Decides for a fitted model; sums of squares (rad²) closer than `indistinguishable` are no reason for anything.
pub fn decide(problem: &Problem, claimed: Fitted, indistinguishable: f64) -> Zero {
    let offset_is_missing = is_missing(problem, &claimed);
    let keep = |model: Fitted, alike| Zero { model, offset_is_missing, alike };
    let Some(rival) = resembling().filter(|rival| offset_is_missing && !claimed.has(rival.name)) else {
        return keep(claimed, None);
    };
    let Some(asymmetric) = with_rival(problem, &claimed, rival) else { return keep(claimed, None) };
    // Half a step of the converter is no finding.
    let visible_rad = visible_rad(problem);
    let without = cost_with_offsets_within(problem, &asymmetric, 0.5 * visible_rad);
    let is_sound = mean_offset(&asymmetric).abs() < visible_rad && asymmetric.cost < claimed.cost - indistinguishable;
    if is_sound || without < claimed.cost - indistinguishable {
        return Zero { model: asymmetric, offset_is_missing: false, alike: None };
    }
    let is_alike = without < claimed.cost + indistinguishable.max(ALIKE_NOISES.powi(2) * claimed.cost);
    keep(claimed, is_alike.then_some(rival.name))
}

/// Is the zero off beside what a model has, and does that matter?
pub(super) fn is_missing(problem: &Problem, model: &Fitted) -> bool {
    // A gyroscope's bias is usual, and no angle.
    let is_angle = problem.swings.iter().all(|swing| swing.measured == Measured::Angle);
    is_angle && is_off(problem, model) && matters(problem, model)
}

/// Does the error grow visibly when all zeros are right?
fn matters(problem: &Problem, claimed: &Fitted) -> bool {
    let without = cost_with_offsets_within(problem, claimed, 0.0);
    problem.chi_square(claimed.cost).excess() < MOST_LEFT * problem.chi_square(without).excess()
}

fn with_rival(problem: &Problem, claimed: &Fitted, rival: &'static Effect<f64>) -> Option<Fitted> {
    let best = predictions(problem, claimed, &[rival]).into_iter().next()?.fitted(problem);
    Some(best.refined(problem, Band::Level, Tolerance::JUDGE)).filter(|model| is_sound(problem, model))
}

/// The cost with all offsets held within a limit, rad.
pub fn cost_with_offsets_within(problem: &Problem, model: &Fitted, limit_rad: f64) -> f64 {
    let mut fixed = model.problem(problem);
    fixed.offsets_are_free = false;
    let mut point = model.point();
    point.starts.iter_mut().for_each(|start| start.offset_rad = start.offset_rad.clamp(-limit_rad, limit_rad));
    descend(&fixed, &point, Window::Whole, Tolerance::FINE, Steps::new(&fixed)).cost
}

/// How far the zero of a model's swings is off (rad) and the standard deviation of that, where it is off.
pub fn off_rad(problem: &Problem, model: &Fitted) -> Option<(f64, f64)> {
    is_missing(problem, model).then(|| (mean_offset(model), std_of_mean(problem, model)))
}

/// Where the sensor's zero is put right.
pub const PUT_RIGHT: &str = "Every fit takes it off each recording by itself; on a rig, host calibrate puts it right.";

/// How far the zero is off, for a person.
pub fn off_in_words(off_rad: f64, std_rad: Option<f64>) -> String {
    format!("{} mrad", with_spread(1e3 * off_rad, std_rad.map(|std_rad| 1e3 * std_rad)))
}

/// The zero of a model's swings as a number of the effect that it is.
pub(super) fn value(problem: &Problem, model: &Fitted) -> Option<Value> {
    let effect = offset()?;
    let parameter = effect.parameters.first()?;
    Some(Value {
        effect: effect.name,
        symbol: parameter.symbol,
        value: mean_offset(model),
        std: Some(std_of_mean(problem, model)),
        unit: parameter.unit,
        status: Status::Identified,
        upper: None,
    })
}

fn mean_offset(model: &Fitted) -> f64 {
    let starts = &model.starts;
    let first = zero_rad(&starts[0]);
    let from_first = |start: &Start| within_half_a_turn(start.offset_rad - first);
    within_half_a_turn(first + starts.iter().map(from_first).sum::<f64>() / starts.len() as f64)
}

/// Whole turns are no error of a zero.
fn zero_rad(start: &Start) -> f64 {
    within_half_a_turn(start.offset_rad)
}

/// Is the zero off by the same angle in all swings, visibly?
fn is_off(problem: &Problem, model: &Fitted) -> bool {
    let mean = mean_offset(model);
    let differ = |offset: f64| within_half_a_turn(offset - mean).abs() > COMMON * mean.abs();
    if mean.abs() < visible_rad(problem) || model.starts.iter().map(zero_rad).any(differ) {
        return false;
    }
    mean.abs() > SIGNIFICANT * std_of_mean(problem, model)
}

/// What the swings themselves allow, and no less than how their zeros scatter: an encoder that is set to zero before each release
/// has another one each time.
fn std_of_mean(problem: &Problem, model: &Fitted) -> f64 {
    within_swings(problem, model).max(between_swings(model))
}

fn between_swings(model: &Fitted) -> f64 {
    let (mean, n) = (mean_offset(model), model.starts.len() as f64);
    let squares: f64 = model.starts.iter().map(|start| within_half_a_turn(zero_rad(start) - mean).powi(2)).sum();
    if n < 2.0 { 0.0 } else { (squares / (n - 1.0) / n).sqrt() }
}

fn within_swings(problem: &Problem, model: &Fitted) -> f64 {
    let n_swings = problem.swings.len();
    let column = |swing_idx: usize| model.unknowns.len() + PER_SWING * swing_idx + PER_SWING - 1;
    let linear = model.linearised(problem);
    let Some(covariance) = with_model_error(problem, &linear, &model.starts) else { return f64::INFINITY };
    let sum: f64 = (0..n_swings)
        .flat_map(|i| (0..n_swings).map(move |j| (i, j)))
        .map(|(i, j)| covariance.matrix[(column(i), column(j))])
        .sum();
    if sum >= 0.0 { sum.sqrt() / n_swings as f64 } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::base_problem;
    use crate::diagnose::tests::{rig, simulated};
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;

    #[test]
    fn the_coarsest_sensor_says_what_zero_can_be_seen() {
        let count = Tally::default();
        let swings = [(1, 1e-3), (2, 2e-3), (3, 5e-4)].map(|(seed, noise_rad)| {
            let mut swing = simulated("one", &rig(), 3.0, seed);
            swing.noise_rad = noise_rad;
            swing
        });
        let problem = base_problem(&swings, (&rig()).into(), &count);
        assert_eq!(visible_rad(&problem), 2e-3);
    }

    #[test]
    fn zeros_that_differ_from_release_to_release_are_known_no_better_than_they_differ() {
        let count = Tally::default();
        let swings = [1, 2].map(|seed| simulated("one", &rig(), 6.0, seed));
        let problem = base_problem(&swings, (&rig()).into(), &count);
        let with = |offsets: [f64; 2]| {
            let start = |offset_rad| Start { angle_rad: 1.4, velocity_rad_s: 0.0, offset_rad };
            let starts = offsets.map(start).to_vec();
            Fitted::at(&problem, &Point { values: problem.template_values(), starts })
        };
        // Half of their distance is the standard error of two.
        assert!((between_swings(&with([-0.029, -0.067])) - 0.019).abs() < 1e-9);
        let true_zeros = with([0.0, 0.0]).refined(&problem, Band::Held, Tolerance::FINE);
        let mut moved = true_zeros.clone();
        moved.starts[0].offset_rad += 1e-2;
        let [alike, differing] =
            [true_zeros, moved].map(|model| (std_of_mean(&problem, &model), between_swings(&model)));
        assert!(alike.0 < 1e-3 && differing.0 >= differing.1 && differing.1 > 4e-3, "{alike:?} {differing:?}");
    }

    #[test]
    fn zeros_on_either_side_of_half_a_turn_are_next_to_each_other() {
        let count = Tally::default();
        let swings = [1, 2].map(|seed| simulated("one", &rig(), 3.0, seed));
        let problem = base_problem(&swings, (&rig()).into(), &count);
        let start = |offset_rad| Start { angle_rad: 1.4, velocity_rad_s: 0.0, offset_rad };
        let starts = [3.13, -3.13].map(start).to_vec();
        let model = Fitted::at(&problem, &Point { values: problem.template_values(), starts });
        assert!((mean_offset(&model).abs() - std::f64::consts::PI).abs() < 1e-9, "{}", mean_offset(&model));
        assert!(between_swings(&model) < 0.012, "{}", between_swings(&model));
    }

    #[test]
    fn the_mean_zero_of_four_releases_is_known_twice_as_well_as_that_of_one() {
        let count = Tally::default();
        let swings = [1, 2, 3, 4].map(|seed| simulated("one", &rig(), 6.0, seed));
        let std = |swings: &[Swing]| {
            let problem = base_problem(swings, (&rig()).into(), &count);
            let starts = vec![Start { angle_rad: 1.4, velocity_rad_s: 0.0, offset_rad: 0.0 }; swings.len()];
            let model = Fitted::at(&problem, &Point { values: problem.template_values(), starts });
            std_of_mean(&problem, &model)
        };
        let ratio = std(&swings[..1]) / std(&swings);
        // Other numbers, which all releases share, are known better too.
        assert!((1.7..2.6).contains(&ratio), "{ratio}");
    }
}
