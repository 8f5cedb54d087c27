//! How large Ms and DV may be where the covariance says nothing of them.
//!
//! Without a rest no swing was held at a turn, and what a level holds over a band shows as one number: the same level may be
//! low over a wide band or high over a narrow one. So Ms is below what would have held a swing at a turn, however narrow the
//! band, and DV below the widest band that the swings allow with any level from dry friction up to there.

use super::answered::{answered_costs, likely_rise};
use super::covariance::Covariance;
use super::fitted::{Fitted, Stiction};
use super::linear::{Linear, Steps, SwingLinear, linearise};
use super::number::{Number, Status, UNKNOWN_SHARE};
use super::problem::{PER_SWING, Problem};
use super::rounding::has_open_steps;
use super::stop_level;
use crate::swing::{Swing, Window};
use shared::parameters::base;

/// Steps of a profile: each so many times the one before. Half and twice were not tried, nor of the next two.
const PROFILE_GROWTH: f64 = 1.25;

/// Those of DV begin with this share of what matters …
const PROFILE_FROM: f64 = 0.02;

/// … and are so many: the last one is 0.02 · 1.25³⁵ = 49 times what matters.
const N_PROFILE: usize = 36;

/// Those of Ms begin with dry friction, or with this share of m·g·l, which holds a pendulum within 0.1 mrad.
const LOWEST_SHARE: f64 = 1e-4;

/// Levels with which the widest band is sought: each twice the one before.
const LEVEL_GROWTH: f64 = 2.0;

/// What tells of the numbers that are smooth.
pub(super) struct Smooth<'a> {
    pub(super) linear: Linear<'a>,
    pub(super) covariance: Option<Covariance>,
    /// Are Ms and DV among the columns?
    pub(super) with_stiction: bool,
}

/// Puts bounds to Ms and DV of a model, from what is known of its other numbers.
pub(super) fn bound(on: &Problem, model: &Fitted, smooth: &Smooth, level: &mut Number, band: &mut Number) {
    let Smooth { linear, covariance, .. } = smooth;
    let likely_rise = likely_rise(on, linear);
    let decimated = with_all_that_is_left(on, model, linear);
    let rough = on.on(&decimated);
    let allowed = rough.share_of_samples(on) * likely_rise;
    let profile = Profile::new(&rough, model, allowed);
    (band.status, band.std) = (Status::UpperBound, None);
    let mut levels_nm = vec![model.stiction().level_nm, profile.coulomb_nm];
    if on.comes_to_rest() {
        // What rounding leaves open is alike in so many samples as there are.
        let (looked_at, allowed) = if has_open_steps(on, linear) { (on, likely_rise) } else { (&rough, allowed) };
        let (low, high) = stop_level::likely(looked_at, model, allowed);
        let spread = mean_square_about(level.value, (low, high)) + stop_variance(linear, covariance.as_ref(), model);
        level.std = (high > low).then(|| spread.sqrt());
        let is_known = level.std.is_some_and(|std| std < UNKNOWN_SHARE * level.value);
        level.status = if is_known { Status::Identified } else { Status::NotIdentified };
    } else {
        (level.status, level.std) = (Status::UpperBound, None);
        level.upper = profile.highest_level_nm();
        levels_nm.extend(profile.levels_nm(LEVEL_GROWTH, level.upper.unwrap_or(f64::INFINITY)));
    }
    band.upper = profile.widest_band(&levels_nm, band.unknown.scale);
}

/// Fewer readings that tell what all of them do: what the model leaves of each is the mean of what it leaves about it.
fn with_all_that_is_left(on: &Problem, model: &Fitted, linear: &Linear) -> Vec<Swing> {
    let decimated = on.decimated();
    let (rough, values) = (model.problem(on).on(&decimated), model.point().values);
    let told = |swing_idx: usize, all: &SwingLinear| {
        let (few, start) = (&decimated[swing_idx], model.starts[swing_idx]);
        let every = all.residuals.len().div_ceil(few.len()).max(1);
        let mut predicted = rough.predict(swing_idx, few.len(), &[(values.as_slice(), start)]).swap_remove(0);
        let left = |i: usize| mean(about(&all.residuals, every * i, every));
        predicted.iter_mut().enumerate().for_each(|(i, reading)| *reading += start.offset_rad + left(i));
        few.reading(predicted)
    };
    linear.each(told)
}

/// So many values with a place in their middle, or what there is of them.
fn about(values: &[f64], place: usize, n: usize) -> &[f64] {
    let from = place.saturating_sub(n / 2);
    &values[from..(from + n).min(values.len())]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// How the error of a model rises with Ms or DV, the other numbers answering to first order.
struct Profile<'a> {
    model: &'a Fitted,
    /// The error may rise by so much, rad².
    allowed: f64,
    coulomb_nm: f64,
    problem: Problem<'a>,
    linear: Linear<'a>,
}

impl<'a> Profile<'a> {
    fn new(on: &'a Problem<'a>, model: &'a Fitted, allowed: f64) -> Self {
        let coulomb_nm = model.parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
        let (problem, point) = (model.problem(on), model.point());
        let linear = linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point));
        Self { model, allowed, coulomb_nm, problem, linear }
    }

    /// From dry friction up to a limit, or to all that gravity can ask for.
    fn levels_nm(&self, growth: f64, below_nm: f64) -> impl Iterator<Item = f64> {
        let gravity_nm = self.model.parameters.pendulum.gravity_torque_nm();
        let first_nm = self.coulomb_nm.max(LOWEST_SHARE * gravity_nm);
        let next = move |level_nm: &f64| Some(growth * level_nm);
        std::iter::successors(Some(first_nm), next).take_while(move |level_nm| *level_nm < below_nm.min(gravity_nm))
    }

    /// Of a level over no band only the turns tell: it is below what holds a swing there. `None` if no level does.
    fn highest_level_nm(&self) -> Option<f64> {
        let levels_nm: Vec<f64> = self.levels_nm(PROFILE_GROWTH, f64::INFINITY).collect();
        let costs = self.costs(levels_nm.iter().copied().map(Stiction::level));
        levels_nm.get(last_likely(&costs, costs.first()? + self.allowed)? + 1).copied()
    }

    /// The widest band that is likely with one of some levels; `None` where it has no end.
    fn widest_band(&self, levels_nm: &[f64], scale: f64) -> Option<f64> {
        let more: Vec<f64> = (0..N_PROFILE).map(|k| PROFILE_FROM * scale * PROFILE_GROWTH.powi(k as i32)).collect();
        let own = self.model.stiction();
        let most = self.costs([own].into_iter())[0] + self.allowed;
        let mut widest: f64 = 0.0;
        for level_nm in levels_nm.iter().copied() {
            let from = if level_nm == own.level_nm { own.velocity_band } else { 0.0 };
            let bands: Vec<f64> = [from].into_iter().chain(more.iter().map(|more| from + more)).collect();
            let costs_of =
                |bands: &[f64]| self.costs(bands.iter().map(|band| Stiction { level_nm, velocity_band: *band }));
            let costs = costs_of(&bands);
            let in_valley = || {
                let (k, lowest) = valley(&bands, &costs)?;
                (costs_of(&[lowest])[0] <= most).then_some(k)
            };
            if let Some(last_likely) = last_likely(&costs, most).or_else(in_valley) {
                widest = widest.max(*bands.get(last_likely + 1)?);
            }
        }
        Some(widest)
    }

    /// What pairs cost, rad².
    fn costs(&self, tried: impl Iterator<Item = Stiction>) -> Vec<f64> {
        answered_costs(&self.problem, &self.linear, &self.model.point(), &tried.collect::<Vec<Stiction>>())
    }
}

fn last_likely(costs: &[f64], most: f64) -> Option<usize> {
    costs.iter().rposition(|cost| *cost <= most)
}

/// Which of some values costs least, and where beside it a parabola has its lowest place: steps may be longer than a valley is
/// wide. `None` at the ends.
fn valley(values: &[f64], costs: &[f64]) -> Option<(usize, f64)> {
    let k = (0..costs.len()).min_by(|i, j| costs[*i].total_cmp(&costs[*j]))?;
    let [x, y] = [values, costs].map(|of| of.get(k.checked_sub(1)?..=k + 1));
    let (x, y) = (x?, y?);
    let [left, right] = [(y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])];
    let curvature = (right - left) / (x[2] - x[0]);
    (curvature > 0.0).then(|| (k, 0.5 * (x[0] + x[1] - left / curvature)))
}

/// Of values that are as likely anywhere in a range, about one that need not be in its middle.
fn mean_square_about(value: f64, (low, high): (f64, f64)) -> f64 {
    ((low + high) / 2.0 - value).powi(2) + (high - low).powi(2) / 12.0
}

/// Variance of the torque at which the model stops, (N·m)²: its last angle is known no better than its numbers.
fn stop_variance(linear: &Linear, covariance: Option<&Covariance>, model: &Fitted) -> f64 {
    let Some(covariance) = covariance else { return 0.0 };
    let gravity = model.parameters.pendulum.gravity_torque_nm();
    let n_unknowns = linear.n_unknowns();
    let of_swing = |swing_idx: usize, swing: &SwingLinear| {
        let place = |j: usize| if j < n_unknowns { j } else { j + PER_SWING * swing_idx };
        let last: Vec<f64> = swing.columns.iter().map(|column| column.last().copied().unwrap_or(0.0)).collect();
        let product = |i: usize, j: usize| last[i] * last[j] * covariance.matrix[(place(i), place(j))];
        let sum: f64 =
            (0..last.len()).flat_map(|i| (0..last.len()).map(move |j| (i, j))).map(|(i, j)| product(i, j)).sum();
        sum
    };
    let largest = linear.each(of_swing).into_iter().filter(|x| x.is_finite()).fold(0.0, f64::max);
    gravity.powi(2) * largest
}

#[cfg(test)]
mod tests {
    use super::super::descent::Tolerance;
    use super::super::identify::problem_of;
    use super::super::problem::{Point, Start};
    use super::super::refine::Band;
    use super::super::tally::Tally;
    use super::super::uncertainty::uncertainty;
    use super::*;
    use shared::model::Model;
    use shared::parameters::Parameters;

    const NOISE_RAD: f64 = 2e-4;

    const RELEASE_RAD: f64 = 0.4;

    /// Eight seconds after a release, which end long before the rest.
    fn swing(truth: &Parameters<f64>, rate_hz: usize) -> Swing {
        let model = Model::new(truth);
        let mut state = model.release(RELEASE_RAD, 0.0);
        let times_s: Vec<f64> = (0..8 * rate_hz).map(|i| i as f64 / rate_hz as f64).collect();
        let mut angles_rad = Vec::new();
        for i in 0..times_s.len() {
            let noise_rad = NOISE_RAD * if i % 2 == 0 { 1.0 } else { -1.0 };
            angles_rad.push(state.angle_rad + noise_rad);
            (0..400 / rate_hz).for_each(|_| model.step(&mut state, 2.5e-3));
        }
        Swing::new("one", &times_s, &angles_rad, NOISE_RAD)
    }

    fn starts() -> Vec<Start> {
        vec![Start { angle_rad: RELEASE_RAD, velocity_rad_s: 0.0, offset_rad: 0.0 }]
    }

    #[test]
    fn every_fourth_sample_is_a_quarter() {
        let count = Tally::default();
        let swings = [swing(&Parameters::paper(), 200)];
        let all = problem_of(&swings, &Parameters::paper(), &count);
        let few = [swings[0].thinned(50.0)];
        assert_eq!(all.on(&few).share_of_samples(&all), 0.25);
    }

    /// Without a rest what a level holds over a band shows as one number: a high one over a narrow band is as good as the truth,
    /// be that much above dry friction or not.
    #[test]
    fn bounds_hold_a_truth_that_holds_less_over_a_wider_band() {
        for [level_nm, velocity_band] in [[3e-4, 0.1], [2e-3, 0.1], [4e-3, 0.05]] {
            let (mut truth, count) = (Parameters::paper(), Tally::default());
            truth.set_friction(2e-4, 2e-4, level_nm, velocity_band);
            let swings = [swing(&truth, 200)];
            let on = problem_of(&swings, &truth, &count);
            let narrow = Stiction { level_nm: 2.0 * level_nm, velocity_band: 0.5 * velocity_band };
            let begun = Fitted::at(&on, &Point { values: on.template_values(), starts: starts() });
            let found = uncertainty(&on, &begun.with_stiction(narrow).refined(&on, Band::Held, Tolerance::JUDGE));
            let [.., level, band] = &found.numbers[..] else { panic!("{found:?}") };
            assert!(level.upper.unwrap() > level_nm, "{level_nm}: {level:?}");
            assert!(band.upper.is_none_or(|upper| upper > velocity_band), "{level_nm}: {band:?}");
        }
    }

    #[test]
    fn a_valley_between_the_values_that_are_tried_is_seen() {
        let x = [0.5, 1.0, 1.5, 2.0, 3.0];
        let y = x.map(|x| 40.0 * (x - 1.2_f64).powi(2) + 7.0);
        let (k, lowest) = valley(&x, &y).unwrap();
        assert!(k == 1 && (lowest - 1.2).abs() < 1e-12, "{lowest}");
        assert!(valley(&x[2..], &y[2..]).is_none() && valley(&x[..2], &y[..2]).is_none());
    }

    #[test]
    fn without_a_rest_ms_is_below_what_would_have_held_the_last_turn() {
        let (mut truth, count) = (Parameters::paper(), Tally::default());
        truth.set_friction(2e-4, 2e-4, 0.0, 0.0);
        let swings = [swing(&truth, 200)];
        let on = problem_of(&swings, &truth, &count);
        let model = Fitted::at(&on, &Point { values: on.template_values(), starts: starts() });
        let found = uncertainty(&on, &model.with_stiction(Stiction::NONE));
        let upper_nm = found.numbers[found.numbers.len() - 2].upper.unwrap();
        let angles_rad = &swings[0].angles_rad;
        let mut turns = angles_rad.windows(3).filter(|of| (of[1] - of[0]) * (of[2] - of[1]) < 0.0 && of[1].abs() > 0.1);
        let last_rad = turns.next_back().unwrap()[1].abs();
        let held_nm = truth.pendulum.gravity_torque_nm() * last_rad.sin();
        assert!((0.98 * held_nm..PROFILE_GROWTH * held_nm).contains(&upper_nm), "{upper_nm} {held_nm}");
    }

    #[test]
    fn a_bound_from_the_fewer_samples_of_a_rough_look_is_that_of_all() {
        let count = Tally::default();
        let mut truth = Parameters::paper();
        truth.set_friction(2e-4, 2e-4, 2.4e-4, 0.0);
        let swings = [swing(&truth, 400)];
        let on = problem_of(&swings, &truth, &count);
        let begun = Fitted::at(&on, &Point { values: on.template_values(), starts: starts() });
        let model = begun.with_stiction(Stiction::level(2.4e-4));
        let found = uncertainty(&on, &model);
        let band = found.numbers.last().unwrap();
        let allowed = likely_rise(&on, &model.linearised(&on));
        let profile = Profile::new(&on, &model, allowed);
        let levels_nm: Vec<f64> = profile.levels_nm(LEVEL_GROWTH, f64::INFINITY).collect();
        let all = profile.widest_band(&levels_nm, band.unknown.scale).unwrap();
        assert!(on.on(&on.decimated()).share_of_samples(&on) < 0.3);
        // Two steps of the profile beside each other are neighbours.
        let ratio = band.upper.unwrap() / all;
        assert!((1.0 / PROFILE_GROWTH - 0.01..PROFILE_GROWTH + 0.01).contains(&ratio), "{ratio} {band:?}");
    }
}
