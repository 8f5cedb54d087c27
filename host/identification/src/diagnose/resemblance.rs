//! Which named law a friction curve resembles: Coulomb and viscous friction, alone and with each law of speed of the
//! list, laid through the curve by least squares.

use crate::fit::curve::{built_up_nm, friction_of_speed_nm, is_of_speed_alone};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use shared::effect::{Effect, Parameter};
use shared::model::Model;
use shared::motion::Pendulum;
use shared::parameters::Parameters;

/// A law's shape (a speed, an exponent) is sought at so many places of its range, in equal factors.
const SHAPES: usize = 40;

/// Points of the curve that are compared.
const POINTS: usize = 60;

/// A named law beside a curve.
#[derive(Clone, Debug, Serialize)]
pub struct Resemblance {
    /// The law beside Coulomb and viscous friction; `none` for these alone.
    pub effect: &'static str,
    /// What it leaves of the curve: root mean square difference as a share of the mean friction.
    pub share: f64,
    /// The law at the speeds of the knots, N·m.
    pub torques: Vec<f64>,
    /// The numbers of all of it.
    #[serde(skip)]
    pub numbers: Numbers,
}

/// Friction that is laid through a curve.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    /// Mc, N·m.
    pub coulomb_nm: f64,
    /// Mw, N·m·s/rad.
    pub viscous: f64,
    /// Those of the law.
    pub law: Vec<f64>,
}

/// So many laws are kept beside the curve.
const MOST_LAWS: usize = 3;

/// The laws closest to a model's friction of sliding, at the speeds of its curve.
pub fn of_model(parameters: &Parameters<f64>) -> Vec<Resemblance> {
    let Some(curve) = &parameters.curve else { return Vec::new() };
    let speeds: Vec<f64> = curve.speeds_rad_s().iter().map(|speed| f64::from(*speed)).collect();
    let built_up = built_up_nm(parameters);
    let friction = |speed: f64| built_up + friction_of_speed_nm(parameters, speed);
    let mut found = resemblances(&parameters.pendulum, &speeds, friction);
    found.truncate(MOST_LAWS);
    found
}

/// The named laws from the closest on; `curve` is the friction at a speed in rad/s.
pub fn resemblances(pendulum: &Pendulum<f64>, speeds_rad_s: &[f64], curve: impl Fn(f64) -> f64) -> Vec<Resemblance> {
    let largest = speeds_rad_s.last().copied().unwrap_or(0.0);
    let points: Vec<f64> = (1..=POINTS).map(|k| largest * k as f64 / POINTS as f64).collect();
    let wanted: Vec<f64> = points.iter().map(|speed| curve(*speed)).collect();
    let mean = wanted.iter().sum::<f64>() / POINTS as f64;
    let alone = best(&points, &wanted, speeds_rad_s, &[None]);
    let mut found: Vec<Resemblance> = alone.into_iter().map(|fit| fit.named("none", mean)).collect();
    for effect in Effect::<f64>::usual() {
        let shapes: Vec<Option<Law>> = laws(pendulum, effect).into_iter().map(Some).collect();
        found.extend(best(&points, &wanted, speeds_rad_s, &shapes).map(|fit| fit.named(effect.name, mean)));
    }
    found.sort_by(|a, b| a.share.total_cmp(&b.share));
    found
}

/// A law of speed at strength one.
struct Law {
    friction: Box<dyn Fn(f64) -> f64>,
    values: Vec<f64>,
    is_strength: Vec<bool>,
}

impl Law {
    /// Its numbers at another strength.
    fn of_strength(&self, strength: f64) -> Vec<f64> {
        let number = |(value, is_strength): (&f64, &bool)| if *is_strength { value * strength } else { *value };
        self.values.iter().zip(&self.is_strength).map(number).collect()
    }
}

/// An effect at strength one with each of the shapes; empty unless it is a law of speed alone.
fn laws(pendulum: &Pendulum<f64>, effect: &'static Effect<f64>) -> Vec<Law> {
    let is_strength = |index: usize| effect.starts.iter().all(|start| start[index] == 0.0);
    let shape = (0..effect.parameters.len()).find(|index| !is_strength(*index));
    let values = |k: usize| -> Vec<f64> {
        let value = |(index, p): (usize, &Parameter)| match Some(index) == shape {
            true => shape_at(p, k),
            false if is_strength(index) => 1.0,
            false => p.start,
        };
        effect.parameters.iter().enumerate().map(value).collect()
    };
    let law = |k: usize| -> Option<Law> {
        let mut only = Parameters::frictionless(*pendulum);
        only.set(effect.id, &values(k)).ok()?;
        is_of_speed_alone(&only, effect.id).then(|| {
            let model = Model::new(&only);
            let friction = Box::new(move |speed: f64| -model.friction_of_sliding_nm(0.0, speed, 1.0, 0.0));
            Law { friction, values: values(k), is_strength: (0..effect.parameters.len()).map(is_strength).collect() }
        })
    };
    (0..if shape.is_some() { SHAPES } else { 1 }).filter_map(law).collect()
}

fn shape_at(parameter: &Parameter, k: usize) -> f64 {
    let share = k as f64 / (SHAPES - 1) as f64;
    let low = parameter.low.max(1e-3 * parameter.high);
    low * (parameter.high / low).powf(share)
}

/// A law laid through a curve.
struct Fit {
    square: f64,
    torques: Vec<f64>,
    numbers: Numbers,
}

impl Fit {
    fn named(self, effect: &'static str, mean: f64) -> Resemblance {
        let share = self.square.sqrt() / mean.max(f64::MIN_POSITIVE);
        Resemblance { effect, share, torques: self.torques, numbers: self.numbers }
    }
}

fn best(points: &[f64], wanted: &[f64], speeds: &[f64], laws: &[Option<Law>]) -> Option<Fit> {
    let fits = laws.iter().filter_map(|law| fit(points, wanted, speeds, law.as_ref()));
    fits.min_by(|a, b| a.square.total_cmp(&b.square))
}

/// Coulomb, viscous and the law's strength, none of them negative: what would be is left out, one after the other.
fn fit(points: &[f64], wanted: &[f64], speeds: &[f64], law: Option<&Law>) -> Option<Fit> {
    let column = |j: usize, speed: f64| match j {
        0 => 1.0,
        1 => speed,
        _ => law.map_or(0.0, |law| (law.friction)(speed)),
    };
    let mut chosen: Vec<usize> = (0..if law.is_some() { 3 } else { 2 }).collect();
    loop {
        let rows = DMatrix::from_fn(points.len(), chosen.len(), |i, j| column(chosen[j], points[i]));
        let lengths: Vec<f64> = rows.column_iter().map(|column| column.norm()).collect();
        let scaled = DMatrix::from_fn(points.len(), chosen.len(), |i, j| rows[(i, j)] / lengths[j].max(1e-300));
        let found = scaled.clone().svd(true, true).solve(&DVector::from_column_slice(wanted), 1e-12).ok()?;
        let lowest = (0..chosen.len()).min_by(|a, b| found[*a].total_cmp(&found[*b]))?;
        if found[lowest] < 0.0 && chosen.len() > 1 {
            chosen.remove(lowest);
            continue;
        }
        let square = (scaled * &found - DVector::from_column_slice(wanted)).norm_squared() / points.len() as f64;
        let mut strengths = [0.0; 3];
        chosen.iter().enumerate().for_each(|(j, which)| strengths[*which] = found[j] / lengths[j].max(1e-300));
        let torque = |speed: &f64| (0..3).map(|which| strengths[which] * column(which, *speed)).sum();
        let [coulomb_nm, viscous, strength] = strengths;
        let numbers = Numbers { coulomb_nm, viscous, law: law.map_or(Vec::new(), |law| law.of_strength(strength)) };
        return Some(Fit { square, torques: speeds.iter().map(torque).collect(), numbers });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::curve::Curve;

    const SPEEDS: [f64; 4] = [0.0, 2.0, 5.0, 9.0];

    fn closest(curve: impl Fn(f64) -> f64) -> Resemblance {
        resemblances(&Pendulum::paper(), &SPEEDS, curve).swap_remove(0)
    }

    #[test]
    fn a_curve_that_is_a_law_is_recognised() {
        let drag = closest(|speed| 1e-3 + 2e-4 * speed * speed);
        assert!(drag.effect.ends_with("drag") && drag.share < 1e-3, "{drag:?}");
        let stribeck = closest(|speed| 1e-3 + 1e-4 * speed + 2e-3 * (-(speed / 1.1_f64).powi(2)).exp());
        assert!(stribeck.effect.contains("stribeck") && stribeck.share < 0.02, "{stribeck:?}");
        let straight = closest(|speed| 1e-3 + 3e-4 * speed);
        assert!(straight.share < 1e-9, "{straight:?}");
        assert!((straight.torques[2] - 2.5e-3).abs() < 1e-9, "{straight:?}");
    }

    #[test]
    fn a_bump_is_like_no_law_of_the_list() {
        let bump = closest(|speed| 1e-3 + 2e-4 * speed + 2e-3 * (-(speed - 4.0).powi(2)).exp());
        assert!(bump.share > 0.1, "{bump:?}");
    }

    #[test]
    fn shapes_go_by_equal_factors_from_end_to_end() {
        let parameter = Parameter { symbol: "p", unit: "1", low: 0.25, high: 4.0, start: 1.0, meaning: "" };
        assert!(
            (shape_at(&parameter, 0) - 0.25).abs() < 1e-12 && (shape_at(&parameter, SHAPES - 1) - 4.0).abs() < 1e-12
        );
        let factor = shape_at(&parameter, 1) / shape_at(&parameter, 0);
        assert!((factor.powi(SHAPES as i32 - 1) / 16.0 - 1.0).abs() < 1e-9, "{factor}");
        // From nothing on there are no equal factors.
        assert!((shape_at(&Parameter { low: 0.0, ..parameter }, 0) - 4e-3).abs() < 1e-12);
    }

    #[test]
    fn friction_that_has_built_up_is_part_of_what_a_curve_resembles() {
        let mut rig = Parameters::frictionless(Pendulum::paper());
        rig.set_friction(0.0, 0.0, 0.0, 0.0);
        rig.set(Effect::<f64>::by_name("presliding").unwrap().id, &[5e-4, 5e-3]).unwrap();
        rig.set_curve(&Curve::new(&[0.0, 2.0, 8.0], &[1e-3, 1.4e-3, 2.6e-3]).unwrap()).unwrap();
        let found = of_model(&rig);
        assert_eq!(found.len(), MOST_LAWS);
        assert!(found[0].share < 1e-3, "{found:?}");
        let expected = [1.5e-3, 1.9e-3, 3.1e-3];
        assert!(found[0].torques.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{found:?}");
    }
}
