//! How surely the geometry of a rig is known, and what that means for a fit.
//!
//! A free swing sees of mass, length and inertia one number, the length (m·l² + I)/(m·l) that its period tells, and of
//! every torque its share of m·g·l. So a fit holds mass and length and seeks I alone, as without tolerances; those of
//! all three are one prior on it. Where only the length has one, I may be anything from 0 on for free, and below 0 to
//! the price of a shorter length. In the end that I is parted: the most likely mass, length and inertia that make the
//! same period, all torques in proportion to the new m·g·l, so that the swing stays what it was.

use crate::formula::effect_of;
use shared::curve::Curve;
use shared::motion::Pendulum;
use shared::parameters::Parameters;

/// A number that was measured by other means than swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// As measured.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
}

/// What is known of the geometry beside its numbers; one without a tolerance means mass and length exactly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// m, kg.
    pub mass: Option<Known>,
    /// l, m.
    pub length: Option<Known>,
    /// I about the centre of mass, kg·m²; without one any inertia may be found.
    pub inertia: Option<Known>,
}

/// The numbers of a rig, and how surely its geometry is known.
#[derive(Clone, Copy, Debug)]
pub struct KnownRig<'a> {
    /// Its numbers.
    pub parameters: &'a Parameters<f64>,
    /// Of its geometry.
    pub tolerances: Tolerances,
}

impl<'a> From<&'a Parameters<f64>> for KnownRig<'a> {
    fn from(parameters: &'a Parameters<f64>) -> Self {
        Self { parameters, tolerances: Tolerances::default() }
    }
}

/// What is known of an unknown before any swing is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Its most likely value.
    pub value: f64,
    /// Standard deviation.
    pub std: f64,
    /// Does it speak against smaller values only?
    pub only_below: bool,
}

impl Prior {
    /// How many standard deviations a value is off.
    pub fn off(&self, value: f64) -> f64 {
        let off = (value - self.value) / self.std;
        if self.only_below { off.min(0.0) } else { off }
    }
}

/// What the tolerances make of the inertia that a fit seeks at the given mass and length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaPrior {
    /// What is known of it.
    pub prior: Prior,
    /// No smaller one is sought.
    pub low: f64,
    /// No larger one is sought.
    pub high: f64,
}

/// Nobody's tolerance is wrong by more than so many standard deviations; beyond, something else is missing. Not tuned:
/// of honest ones, 1 in 16,000 is. A spring of 8 % of m·g·l beside a length known to 0.6 % is named.
const FARTHEST_STDS: f64 = 4.0;

impl Tolerances {
    /// Is nothing known beside the numbers?
    pub fn are_none(&self) -> bool {
        *self == Self::default()
    }

    /// The rig with mass and length as they were measured, whatever a fit made of them since; it swings as before.
    pub fn centred(&self, parameters: &Parameters<f64>) -> Parameters<f64> {
        let pendulum = &parameters.pendulum;
        let mass_kg = self.mass.map_or(pendulum.mass_kg, |known| known.value);
        let length_m = self.length.map_or(pendulum.length_m, |known| known.value);
        with_geometry(parameters, mass_kg, length_m)
    }

    /// What they say of the inertia at the mass and length of a pendulum, if they say anything.
    pub fn of_inertia(&self, pendulum: &Pendulum<f64>) -> Option<InertiaPrior> {
        let shortened = pendulum.mass_kg * pendulum.length_m * self.length.map_or(0.0, |known| known.std);
        let lowest = -FARTHEST_STDS * shortened;
        match self.inertia {
            Some(known) => {
                let slopes = Slopes::of(pendulum, known.value);
                let std = slopes.variance(self, known.std.powi(2)).sqrt();
                let (low, high) = (known.value - FARTHEST_STDS * std, known.value + FARTHEST_STDS * std);
                let prior = Prior { value: known.value, std, only_below: false };
                Some(InertiaPrior { prior, low: low.max(lowest), high })
            }
            None if shortened > 0.0 => {
                let prior = Prior { value: 0.0, std: shortened, only_below: true };
                Some(InertiaPrior { prior, low: lowest, high: f64::INFINITY })
            }
            None => None,
        }
    }

    /// The most likely geometry with which a rig swings as it does; `centred` has mass and length as they were
    /// measured.
    pub fn settled(&self, centred: &Parameters<f64>) -> Parameters<f64> {
        let pendulum = &centred.pendulum;
        let Pendulum { mass_kg, length_m, inertia_kg_m2, .. } = *pendulum;
        if let Some(known) = self.inertia {
            let slopes = Slopes::of(pendulum, known.value);
            let pull = (inertia_kg_m2 - known.value) / slopes.variance(self, known.std.powi(2));
            let [mass, length] = [self.mass, self.length].map(variance);
            let moved =
                with_geometry(centred, mass_kg + slopes.mass * mass * pull, length_m + slopes.length * length * pull);
            if moved.pendulum.inertia_kg_m2 >= 0.0 {
                return moved;
            }
        }
        if inertia_kg_m2 >= 0.0 {
            return centred.clone();
        }
        let mut point = with_geometry(centred, mass_kg, pendulum.pivot_inertia_kg_m2() / (mass_kg * length_m));
        point.pendulum.inertia_kg_m2 = 0.0;
        point
    }

    /// How surely mass and length are known once the swings have told the period: variances of m and l, and what they
    /// share.
    pub(super) fn left(&self, pendulum: &Pendulum<f64>) -> [f64; 3] {
        let [mass, length] = [self.mass, self.length].map(variance);
        let Some(known) = self.inertia else { return [mass, length, 0.0] };
        let slopes = Slopes::of(pendulum, known.value);
        let all = slopes.variance(self, known.std.powi(2));
        let [by_mass, by_length] = [slopes.mass * mass, slopes.length * length];
        [mass - by_mass.powi(2) / all, length - by_length.powi(2) / all, -by_mass * by_length / all]
    }
}

fn variance(known: Option<Known>) -> f64 {
    known.map_or(0.0, |known| known.std.powi(2))
}

/// By how much the inertia that a fit seeks at the given mass and length changes with the true ones, the true inertia
/// being the same.
#[derive(Clone, Copy, Debug)]
struct Slopes {
    mass: f64,
    length: f64,
}

impl Slopes {
    fn of(pendulum: &Pendulum<f64>, inertia_kg_m2: f64) -> Self {
        let Pendulum { mass_kg, length_m, .. } = *pendulum;
        Self { mass: -inertia_kg_m2 / mass_kg, length: mass_kg * length_m - inertia_kg_m2 / length_m }
    }

    fn variance(&self, tolerances: &Tolerances, of_inertia: f64) -> f64 {
        let [mass, length] = [tolerances.mass, tolerances.length].map(variance);
        self.mass.powi(2) * mass + self.length.powi(2) * length + of_inertia
    }
}

/// The same swing with another mass and length: the same period, every torque in proportion to m·g·l.
fn with_geometry(parameters: &Parameters<f64>, mass_kg: f64, length_m: f64) -> Parameters<f64> {
    let before = parameters.pendulum;
    let (heavier, longer) = (mass_kg / before.mass_kg, length_m / before.length_m);
    if heavier == 1.0 && longer == 1.0 {
        return parameters.clone();
    }
    let mut moved = parameters.clone();
    let inertia_kg_m2 = heavier * longer * before.pivot_inertia_kg_m2() - mass_kg * length_m.powi(2);
    moved.pendulum = Pendulum { mass_kg, length_m, inertia_kg_m2, ..before };
    for present in &mut moved.effects {
        let Some(effect) = effect_of(parameters, present.id) else { continue };
        for (value, parameter) in present.values.iter_mut().zip(effect.parameters) {
            let (of_mass, of_length) = powers(parameter.unit);
            *value *= heavier.powi(of_mass) * longer.powi(of_length);
        }
    }
    let torques = moved.curve.as_mut().map(Curve::torques_nm_mut);
    torques.into_iter().flatten().for_each(|torque| *torque *= heavier * longer);
    moved
}

/// With which powers of mass and length a number grows for the swing to stay the same, by its unit: torques with m·g·l,
/// forces with m·g.
pub(super) fn powers(unit: &str) -> (i32, i32) {
    match unit {
        _ if unit.starts_with("N·m") => (1, 1),
        "m" => (0, 1),
        "m/N" => (-1, 1),
        _ => (0, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::model::Model;

    fn tolerances(mass: f64, length: f64, inertia: Option<f64>) -> Tolerances {
        let known = |value: f64, std: f64| (std > 0.0).then_some(Known { value, std });
        let Pendulum { mass_kg, length_m, inertia_kg_m2, .. } = Parameters::paper().pendulum;
        let inertia = inertia.and_then(|std| known(inertia_kg_m2, std));
        Tolerances { mass: known(mass_kg, mass), length: known(length_m, length), inertia }
    }

    /// The paper's rig with an inertia that only a shorter length explains.
    fn with_inertia(inertia_kg_m2: f64) -> Parameters<f64> {
        let mut parameters = Parameters::paper();
        parameters.pendulum.inertia_kg_m2 = inertia_kg_m2;
        parameters
    }

    fn acceleration(parameters: &Parameters<f64>, angle_rad: f64, velocity_rad_s: f64) -> f64 {
        let model = Model::new(parameters);
        let state = model.release(angle_rad, velocity_rad_s);
        let pendulum = &parameters.pendulum;
        let drive_nm = -pendulum.gravity_torque_nm() * angle_rad.sin() + model.friction_torque_nm(&state);
        drive_nm / pendulum.pivot_inertia_kg_m2()
    }

    #[test]
    fn an_inertia_below_zero_is_a_shorter_length_with_the_same_swing() {
        let centred = with_inertia(-2e-5);
        let settled = tolerances(1e-3, 1e-3, None).settled(&centred);
        assert_eq!(settled.pendulum.inertia_kg_m2, 0.0);
        let shorter_m = 2e-5 / (centred.pendulum.mass_kg * centred.pendulum.length_m);
        assert!((centred.pendulum.length_m - settled.pendulum.length_m - shorter_m).abs() < 1e-9);
        for (angle_rad, velocity_rad_s) in [(0.3, 2.0), (-1.2, 0.5), (0.0, -4.0)] {
            let [before, after] = [&centred, &settled].map(|rig| acceleration(rig, angle_rad, velocity_rad_s));
            assert!((before - after).abs() < 1e-9 * before.abs(), "{before} {after}");
        }
    }

    #[test]
    fn what_was_settled_is_centred_again() {
        let known = tolerances(1e-3, 1e-3, Some(3e-5));
        for inertia_kg_m2 in [0.0026, 0.0028, -1e-5] {
            let centred = with_inertia(inertia_kg_m2);
            let again = known.centred(&known.settled(&centred));
            assert!((again.pendulum.inertia_kg_m2 - inertia_kg_m2).abs() < 1e-12, "{again:?}");
            assert!(
                again.effects.iter().zip(&centred.effects).all(|(a, b)| (a.values[0] / b.values[0] - 1.0).abs() < 1e-9)
            );
        }
    }

    #[test]
    fn no_geometry_that_makes_the_same_period_is_likelier_than_the_settled_one() {
        let known = tolerances(2e-3, 1e-3, Some(2e-5));
        let centred = with_inertia(0.00268);
        let off = |rig: &Parameters<f64>| {
            let off = |value: f64, known: Option<Known>| {
                known.map_or(0.0, |known| ((value - known.value) / known.std).powi(2))
            };
            let pendulum = &rig.pendulum;
            off(pendulum.mass_kg, known.mass)
                + off(pendulum.length_m, known.length)
                + off(pendulum.inertia_kg_m2, known.inertia)
        };
        let settled = known.settled(&centred);
        let (mass_kg, length_m) = (settled.pendulum.mass_kg, settled.pendulum.length_m);
        for (heavier, longer) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)] {
            let other = with_geometry(&centred, mass_kg + heavier, length_m + longer);
            assert!(off(&other) > off(&settled), "{other:?}");
        }
        // It costs what the prior on the inertia says.
        let prior = known.of_inertia(&centred.pendulum).unwrap().prior;
        assert!((off(&settled) / prior.off(0.00268).powi(2) - 1.0).abs() < 0.05);
    }

    #[test]
    fn a_length_that_is_known_exactly_allows_no_inertia_below_zero() {
        assert_eq!(tolerances(1e-3, 0.0, None).of_inertia(&Parameters::paper().pendulum), None);
        let of_length = tolerances(0.0, 1e-3, None).of_inertia(&Parameters::paper().pendulum).unwrap();
        assert!(of_length.low < 0.0 && of_length.prior.off(1e-3) == 0.0 && of_length.prior.off(of_length.low) < -3.9);
    }
}
