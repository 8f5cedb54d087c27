//! How well each number of a fitted model is known: standard deviations, upper bounds, correlations, and a status.
//!
//! One covariance serves every command. A number on its bound is known to be there and takes no part in it.
//! Ms and DV act in jumps: without a velocity band, Ms is what all levels share that stop the pendulum alike; without a
//! rest it has an upper bound only, and so has a DV that no swing shows: the value at which the error, profiled over
//! the other numbers to first order, rises beyond what is likely. What a band that no swing shows would move the other
//! numbers by is part of their uncertainty.

use super::answered::stiction_unknowns;
use super::covariance::{Covariance, with_model_error};
use super::fitted::{Fitted, Stiction};
pub use super::number::{Number, Status, UNKNOWN_SHARE, Uncertainty};
use super::problem::{Problem, Quantity, Unknown};
use super::stiction_bounds::{Smooth, bound};
use super::tolerated::tolerated;
use super::unseen::with_unseen_band;

/// Numbers that are correlated beyond this, and uncertain by more than half their value, are only known together.
const ALIKE_CORRELATION: f64 = 0.995;

/// The uncertainty of a model that was fitted to the swings of a problem.
pub fn uncertainty(on: &Problem, model: &Fitted) -> Uncertainty {
    let (mut found, smooth) = of_smooth_numbers(on, model);
    if let [.., level, band] = found.numbers.as_mut_slice() {
        if !smooth.with_stiction {
            bound(on, model, &smooth, level, band);
        } else if band.status == Status::NotIdentified {
            // Without a band, where the pendulum stops depends on Ms in jumps, of which no slope at a band tells.
            (level.status, level.std) = (Status::NotIdentified, None);
        }
    }
    tolerated(on, model, found)
}

/// The same without what bounds Ms and DV where the covariance says nothing of them, which takes many simulations.
pub fn without_bounds(on: &Problem, model: &Fitted) -> Uncertainty {
    tolerated(on, model, of_smooth_numbers(on, model).0)
}

/// The same with the rig's own numbers free where they lie on a bound: a law of a wrong shape may have driven them
/// there.
pub fn with_the_rig_free(on: &Problem, model: &Fitted) -> Uncertainty {
    tolerated(on, model, of_numbers(on, model, Unknown::is_of_the_rig).0)
}

fn of_smooth_numbers<'a>(on: &Problem<'a>, model: &Fitted) -> (Uncertainty, Smooth<'a>) {
    of_numbers(on, model, |_| false)
}

/// Of what is not on a bound, or free in any case.
fn of_numbers<'a>(on: &Problem<'a>, model: &Fitted, is_free: impl Fn(&Unknown) -> bool) -> (Uncertainty, Smooth<'a>) {
    let mut unknowns = model.unknowns.clone();
    unknowns.extend(stiction_unknowns(&model.parameters));
    let has_stiction = model.has_band() && on.comes_to_rest();
    let value = |unknown: &Unknown| unknown.get(&model.parameters);
    let is_inside = |unknown: &Unknown| value(unknown) > unknown.low && value(unknown) < unknown.high;
    // Without a rest, Ms and DV make up for each other; DV takes part for both of them.
    let is_told = |unknown: &Unknown| !unknown.is_stiction() || has_stiction || (model.has_band() && unknown.is_band());
    let takes_part = |unknown: &Unknown| (is_inside(unknown) || is_free(unknown)) && is_told(unknown);
    let known: Vec<usize> = (0..unknowns.len()).filter(|j| takes_part(&unknowns[*j])).collect();
    let part = Fitted { unknowns: known.iter().map(|j| unknowns[*j].clone()).collect(), steps: None, ..model.clone() };
    let linear = part.linearised(on);
    let covariance = with_model_error(on, &linear, &model.starts).map(|covariance| match has_stiction {
        true => no_surer_than_without_a_band(covariance, on, &part),
        false => with_unseen_band(covariance, on, &part, &linear),
    });
    let column = |j: usize| known.iter().position(|k| *k == j);
    let correlation = |i: usize, j: usize| covariance.as_ref()?.correlation(column(i)?, column(j)?);
    let number = |(j, unknown): (usize, &Unknown)| {
        let is_told = has_stiction || !unknown.is_stiction();
        let std =
            column(j).filter(|_| is_told).and_then(|k| covariance.as_ref()?.std(k)).filter(|std| says(unknown, *std));
        let status = match std.map(|std| std / size(unknown, model)) {
            _ if !is_inside(unknown) => Status::AtBound,
            Some(relative) if relative < UNKNOWN_SHARE => Status::Identified,
            _ => Status::NotIdentified,
        };
        Number { unknown: unknown.clone(), value: value(unknown), std, status, upper: None }
    };
    let mut numbers: Vec<Number> = unknowns.iter().enumerate().map(number).collect();
    let alike = alike(&mut numbers, &correlation, model);
    let row = |i: usize| (0..unknowns.len()).map(|j| correlation(i, j)).collect();
    let correlations = (0..unknowns.len()).map(row).collect();
    let coloured = covariance.as_ref().is_some_and(|covariance| covariance.coloured);
    (Uncertainty { numbers, correlations, alike, coloured }, Smooth { linear, covariance, with_stiction: has_stiction })
}

/// Of a band that the swings do not tell no slope says what the other numbers would be beside another one: they are known no
/// better than without any. One of a few 1e-5 rad/s, which a search had kept beside a wandering zero, made Mw eighty times as
/// sure, 17 of its ± off.
fn no_surer_than_without_a_band(covariance: Covariance, on: &Problem, part: &Fitted) -> Covariance {
    let is_stiction = |j: usize| part.unknowns.get(j).is_some_and(Unknown::is_stiction);
    let band = part.unknowns.iter().position(Unknown::is_band);
    let is_told =
        band.and_then(|j| covariance.std(j)).is_some_and(|std| std < UNKNOWN_SHARE * part.stiction().velocity_band);
    if is_told {
        return covariance;
    }
    let unknowns = part.unknowns.iter().filter(|unknown| !unknown.is_stiction()).cloned().collect();
    let rest = Fitted { unknowns, steps: None, ..part.with_stiction(Stiction::level(part.stiction().level_nm)) };
    let linear = rest.linearised(on);
    let Some(without) = with_model_error(on, &linear, &rest.starts) else { return covariance };
    let without = with_unseen_band(without, on, &rest, &linear);
    let kept: Vec<usize> = (0..covariance.matrix.nrows()).filter(|j| !is_stiction(*j)).collect();
    covariance.no_surer(|j| kept.iter().position(|k| *k == j).map(|k| without.matrix[(k, k)]))
}

/// Ms and DV act in jumps: a standard deviation of them beyond all that they may be says nothing.
fn says(unknown: &Unknown, std: f64) -> bool {
    !unknown.is_stiction() || std < unknown.high - unknown.low
}

impl Uncertainty {
    /// Where a quantity stands.
    pub fn index_of(&self, quantity: Quantity) -> Option<usize> {
        self.numbers.iter().position(|number| number.unknown.quantity == quantity)
    }
}

/// What a standard deviation is compared with: the inertia about the centre is a small part of the one about the pivot,
/// which the period tells.
pub fn size(unknown: &Unknown, model: &Fitted) -> f64 {
    match unknown.quantity {
        Quantity::Inertia => model.parameters.pendulum.pivot_inertia_kg_m2(),
        _ => unknown.get(&model.parameters).abs(),
    }
}

/// Marks numbers that make up for each other, and says which.
fn alike(
    numbers: &mut [Number],
    correlation: &dyn Fn(usize, usize) -> Option<f64>,
    model: &Fitted,
) -> Vec<Vec<&'static str>> {
    let is_vague = |number: &Number| number.std.is_none_or(|std| std > UNKNOWN_SHARE * size(&number.unknown, model));
    let vague: Vec<bool> = numbers.iter().map(is_vague).collect();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for i in 0..numbers.len() {
        let partners: Vec<usize> = (0..numbers.len())
            .filter(|j| *j != i && vague[i] && vague[*j])
            .filter(|j| correlation(i, *j).is_some_and(|r| r.abs() > ALIKE_CORRELATION))
            .collect();
        if partners.is_empty() {
            continue;
        }
        numbers[i].status = Status::NotIdentified;
        match groups.iter_mut().find(|group| partners.iter().any(|partner| group.contains(partner))) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    let names = |group: Vec<usize>| group.into_iter().map(|i| numbers[i].unknown.symbol).collect::<Vec<_>>();
    groups.into_iter().filter(|group| group.len() > 1).map(names).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::descent::Tolerance;
    use crate::fit::identify::problem_of;
    use crate::fit::problem::{Point, Start};
    use crate::fit::refine::Band;
    use crate::fit::tally::Tally;
    use crate::swing::Swing;
    use shared::model::Model;
    use shared::parameters::Parameters;

    #[test]
    fn a_deviation_of_ms_beyond_its_range_is_none() {
        let level = &stiction_unknowns(&Parameters::paper())[0];
        let range = level.high - level.low;
        assert!(level.symbol == "Ms" && range < 1.0, "{level:?}");
        assert!(says(level, 0.9 * range) && !says(level, 1745.0));
    }

    /// A swing to rest, of a sensor whose zero wanders by 2 mrad.
    fn beside_a_wander(truth: &Parameters<f64>) -> Swing {
        let model = Model::new(truth);
        let mut state = model.release(1.0, 0.0);
        let times_s: Vec<f64> = (0..4000).map(|i| f64::from(i) / 100.0).collect();
        let mut angles_rad = Vec::new();
        for (i, time_s) in times_s.iter().enumerate() {
            let noise_rad = 5e-4 * if i % 2 == 0 { 1.0 } else { -1.0 };
            angles_rad.push(state.angle_rad + noise_rad + 2e-3 * (time_s / 4.0).sin());
            (0..5).for_each(|_| model.step(&mut state, 2e-3));
        }
        Swing::new("one", &times_s, &angles_rad, 5e-4)
    }

    #[test]
    fn beside_a_band_of_no_account_the_numbers_are_no_surer_than_without_any() {
        let (mut truth, count) = (Parameters::paper(), Tally::default());
        truth.set_friction(3e-4, 3e-3, 4e-3, 0.0);
        let swings = [beside_a_wander(&truth)];
        assert!(swings[0].comes_to_rest());
        let on = problem_of(&swings, &truth, &count);
        let starts = vec![Start { angle_rad: 1.0, velocity_rad_s: 0.0, offset_rad: 0.0 }];
        let begun =
            Fitted::at(&on, &Point { values: on.template_values(), starts }).with_stiction(Stiction::level(4e-3));
        let without = begun.refined(&on, Band::Held, Tolerance::JUDGE);
        let slight = without.with_stiction(Stiction { velocity_band: 3e-5, ..without.stiction() });
        let [with, without] = [&slight, &without].map(|model| uncertainty(&on, model).numbers);
        for (with, without) in with.iter().zip(&without).filter(|(number, _)| !number.unknown.is_stiction()) {
            assert!(with.std >= without.std.map(|std| 0.99 * std), "{with:?} {without:?}");
        }
        let [.., level, _] = &with[..] else { panic!("{with:?}") };
        assert!(level.status == Status::NotIdentified && level.std.is_none(), "{level:?}");
    }
}
