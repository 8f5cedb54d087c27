//! Is the sensor's zero off, or does the bearing rub more one way than the other?
//!
//! The offset is a free number of every fit, so it is claimed by its value and not by its gain: common to the
//! recordings, significant, above one step of the converter. Dry friction that differs between the directions shifts the
//! swings just the same; only their last, small ones differ a little. So where an offset shows, the asymmetry stands
//! against it.

use super::excess::excess;
use super::extension::fit_promise;
use super::physical::is_sound;
use super::score::promises;
use super::trial::{Trial, finish};
use crate::fit::covariance::covariance;
use crate::fit::descent::{Patience, descend};
use crate::fit::linear::{Steps, linearise};
use crate::fit::problem::{PER_SWING, Problem};
use crate::swing::Window;
use shared::effect::Effect;

/// Named when the zero is off.
pub const ANGLE_OFFSET: &str = "angle-offset";

/// What else shifts the swings.
pub(super) const ASYMMETRIC: &str = "asymmetric-coulomb";

/// A common offset is claimed from this many standard errors …
const SIGNIFICANT: f64 = 5.0;

/// … and from this angle on, if the converter's step is not known: one step of 12 bits over 340°.
const LSB_RAD: f64 = 340.0 * std::f64::consts::PI / 180.0 / 4096.0;

/// Offsets of the recordings may differ by this share of their mean.
const COMMON: f64 = 0.5;

/// The offset may leave this share of the excess that is there without it.
const MOST_LEFT: f64 = 0.6;

/// Sums of squares closer than this share mean predictions closer than 0.05 × the noise.
const ALIKE: f64 = 0.0025;

/// What shifts the swings.
#[derive(Clone, Debug)]
pub struct Zero {
    /// The claimed model, with the asymmetry if that is what shifts them.
    pub model: Trial,
    /// Is the sensor's zero off?
    pub offset_is_missing: bool,
    /// What could stand for the offset.
    pub alike: Option<&'static str>,
}

/// Decides for a fitted model; sums of squares (rad²) closer than `indistinguishable` are no reason for anything.
pub fn decide(problem: &Problem, claimed: Trial, indistinguishable: f64) -> Zero {
    let offset_is_missing = is_off(problem, &claimed) && matters(problem, &claimed);
    let keep = |model: Trial, alike| Zero { model, offset_is_missing, alike };
    if !offset_is_missing || claimed.has(ASYMMETRIC) {
        return keep(claimed, None);
    }
    let Some(asymmetric) = with_asymmetry(problem, &claimed) else { return keep(claimed, None) };
    // Half a step of the converter is no finding.
    let without = cost_with_offsets_within(problem, &asymmetric, 0.5 * LSB_RAD);
    let is_sound = mean_offset(&asymmetric).abs() < LSB_RAD && asymmetric.cost < claimed.cost - indistinguishable;
    if is_sound || without < claimed.cost - indistinguishable {
        return Zero { model: asymmetric, offset_is_missing: false, alike: None };
    }
    let is_alike = without < claimed.cost + indistinguishable.max(ALIKE * claimed.cost);
    keep(claimed, is_alike.then_some(ASYMMETRIC))
}

/// Does the error grow visibly when all zeros are right?
fn matters(problem: &Problem, claimed: &Trial) -> bool {
    let without = cost_with_offsets_within(problem, claimed, 0.0);
    excess(problem, claimed.cost) < MOST_LEFT * excess(problem, without)
}

fn with_asymmetry(problem: &Problem, claimed: &Trial) -> Option<Trial> {
    let effect = Effect::by_name(ASYMMETRIC)?;
    let best = promises(problem, claimed, &[effect]).into_iter().next()?;
    Some(finish(problem, &fit_promise(problem, claimed, &best)?)).filter(|trial| is_sound(problem, trial))
}

/// The cost with all offsets held within a limit, rad.
pub fn cost_with_offsets_within(problem: &Problem, trial: &Trial, limit_rad: f64) -> f64 {
    let mut fixed = trial.problem(problem);
    fixed.offsets_are_free = false;
    let mut point = trial.point.clone();
    point.starts.iter_mut().for_each(|start| start.offset_rad = start.offset_rad.clamp(-limit_rad, limit_rad));
    descend(&fixed, &point, Window::Whole, Patience::FINE, Steps::new(&fixed)).cost
}

fn mean_offset(trial: &Trial) -> f64 {
    let starts = &trial.point.starts;
    starts.iter().map(|start| start.offset_rad).sum::<f64>() / starts.len() as f64
}

/// Is the zero off by the same angle in all swings, visibly?
fn is_off(problem: &Problem, trial: &Trial) -> bool {
    let mean = mean_offset(trial);
    let differ = |offset: f64| (offset - mean).abs() > COMMON * mean.abs();
    if mean.abs() < LSB_RAD || trial.point.starts.iter().any(|start| differ(start.offset_rad)) {
        return false;
    }
    mean.abs() > SIGNIFICANT * std_of_mean(problem, trial)
}

fn std_of_mean(problem: &Problem, trial: &Trial) -> f64 {
    let problem = trial.problem(problem);
    let linear = linearise(&problem, &trial.point, Window::Whole, &mut Steps::new(&problem));
    let n_swings = problem.swings.len();
    let column = |swing_idx: usize| problem.unknowns.len() + PER_SWING * swing_idx + PER_SWING - 1;
    let Some(covariance) = covariance(&linear) else { return 0.0 };
    let sum: f64 = (0..n_swings)
        .flat_map(|i| (0..n_swings).map(move |j| (i, j)))
        .map(|(i, j)| covariance.matrix[(column(i), column(j))])
        .sum();
    sum.max(0.0).sqrt() / n_swings as f64
}
