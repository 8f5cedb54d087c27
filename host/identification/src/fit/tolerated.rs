//! Numbers of a fitted model in its most likely geometry: what scales with m·g·l does so, and its ± holds the
//! tolerances of mass and length too. Mass and length stand behind the others, where they have a tolerance.

use super::fitted::Fitted;
use super::number::{Number, Status, Uncertainty};
use super::problem::{Problem, Quantity, Unknown};
use super::tolerance::powers;
use shared::motion::Pendulum;
use shared::parameters::Parameters;

/// By how much a number changes with mass and length, the swing staying what it is.
type Slopes = [f64; 2];

/// What the swings say of the numbers of a model, with what is known of its geometry.
pub fn tolerated(on: &Problem, model: &Fitted, found: Uncertainty) -> Uncertainty {
    if on.tolerances.are_none() {
        return found;
    }
    let settled = on.tolerances.settled(&model.parameters);
    let left = on.tolerances.left(&model.parameters.pendulum);
    let slopes: Vec<Slopes> = found.numbers.iter().map(|number| slopes(&number.unknown, &settled)).collect();
    let stds: Vec<Option<f64>> = found.numbers.iter().map(|number| number.std).collect();
    let numbers = found.numbers.iter().zip(&slopes).map(|(number, slopes)| widened(number, slopes, &settled, &left));
    let mut all = Uncertainty { numbers: numbers.collect(), ..found };
    let count = all.numbers.len();
    for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
        let own = all.correlations[i][j].zip(stds[i]).zip(stds[j]).map(|((r, one), other)| r * one * other);
        let both = own.zip(all.numbers[i].std).zip(all.numbers[j].std);
        let shared = covariance(&slopes[i], &slopes[j], &left);
        all.correlations[i][j] = both.map(|((own, one), other)| (own + shared) / (one * other));
    }
    add_geometry(on, &settled, &left, &slopes, &mut all);
    all
}

/// A number in the settled geometry. It keeps its distance from zero in its own ±, so that its status stays.
fn widened(number: &Number, slopes: &Slopes, settled: &Parameters<f64>, left: &[f64; 3]) -> Number {
    let value = number.unknown.get(settled);
    let scale =
        if number.value != 0.0 && number.unknown.quantity != Quantity::Inertia { value / number.value } else { 1.0 };
    let of_geometry = covariance(slopes, slopes, left);
    let std = number.std.map(|std| ((std * scale).powi(2) + of_geometry).sqrt());
    Number { value, std, upper: number.upper.map(|upper| upper * scale), ..at_bound_where_settled(number, value) }
}

/// An inertia below zero was settled by a shorter length.
fn at_bound_where_settled(number: &Number, value: f64) -> Number {
    let is_settled = number.unknown.quantity == Quantity::Inertia && value != number.value && value == 0.0;
    let status = if is_settled { Status::AtBound } else { number.status };
    Number { status, ..number.clone() }
}

fn slopes(unknown: &Unknown, settled: &Parameters<f64>) -> Slopes {
    let Pendulum { mass_kg, length_m, inertia_kg_m2, .. } = settled.pendulum;
    match unknown.quantity {
        Quantity::Inertia => [inertia_kg_m2 / mass_kg, (inertia_kg_m2 - mass_kg * length_m.powi(2)) / length_m],
        _ => {
            let (of_mass, of_length) = powers(unknown.unit);
            let value = unknown.get(settled);
            [value * f64::from(of_mass) / mass_kg, value * f64::from(of_length) / length_m]
        }
    }
}

fn covariance(one: &Slopes, other: &Slopes, left: &[f64; 3]) -> f64 {
    let [mass, length, both] = left;
    one[0] * other[0] * mass + one[1] * other[1] * length + (one[0] * other[1] + one[1] * other[0]) * both
}

/// Mass and length themselves.
fn add_geometry(on: &Problem, settled: &Parameters<f64>, left: &[f64; 3], slopes: &[Slopes], all: &mut Uncertainty) {
    let mut slopes = slopes.to_vec();
    let geometry =
        [(Quantity::Mass, on.tolerances.mass, [1.0, 0.0]), (Quantity::Length, on.tolerances.length, [0.0, 1.0])];
    for (quantity, known, own) in
        geometry.into_iter().filter_map(|(quantity, known, own)| Some((quantity, known?, own)))
    {
        let unknown = Unknown::of_geometry(quantity, &known);
        let std = covariance(&own, &own, left).sqrt();
        let value = unknown.get(settled);
        let with = |(slopes, number): (&Slopes, &Number)| Some(covariance(slopes, &own, left) / (number.std? * std));
        let row: Vec<Option<f64>> = slopes.iter().zip(&all.numbers).map(with).collect();
        all.correlations.iter_mut().zip(&row).for_each(|(other, correlation)| other.push(*correlation));
        all.correlations.push(row.into_iter().chain([Some(1.0)]).collect());
        all.numbers.push(Number { unknown, value, std: Some(std), status: Status::Identified, upper: None });
        slopes.push(own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::effect::Effect;

    #[test]
    fn what_is_known_of_mass_and_length_together_goes_into_every_spread() {
        // Of a·m + b·l the variance is a²·var m + b²·var l + 2ab·cov.
        let left = [4.0, 9.0, -5.0];
        assert_eq!(covariance(&[1.0, 2.0], &[1.0, 2.0], &left), 4.0 + 36.0 - 20.0);
        assert_eq!(covariance(&[1.0, 0.0], &[0.0, 1.0], &left), -5.0);
    }

    #[test]
    fn a_bound_grows_with_the_number_it_is_of() {
        let mut settled = Parameters::paper();
        settled.set_friction(1e-4, 3e-3, 0.0, 0.0);
        let coulomb = Effect::by_name("coulomb").unwrap();
        let unknown = Unknown::all_of_effect(coulomb, &settled).remove(0);
        let number = Number { unknown, value: 2e-3, std: Some(1e-4), status: Status::UpperBound, upper: Some(4e-3) };
        let found = widened(&number, &[0.0; 2], &settled, &[0.0; 3]);
        assert!((found.value - 3e-3).abs() < 1e-12, "{found:?}");
        assert!(
            (found.std.unwrap() - 1.5e-4).abs() < 1e-12 && (found.upper.unwrap() - 6e-3).abs() < 1e-12,
            "{found:?}"
        );
    }
}
