//! What is unknown, and what a guess at it predicts.

use super::ridge::Ridge;
use super::tolerance::{Known, Prior, Tolerances};
use crate::cores::on_all_cores;
use crate::fit::tally::Tally;
use crate::pace;
use crate::recording::Measured;
use crate::swing::{Swing, Window, pace};
use crate::verdict::{ChiSquare, Colour};
use serde::Serialize;
use shared::curve::Curve;
use shared::effect::{Effect, Parameter};
use shared::parameters::{Parameters, base};
use simulation::{AT_ONCE, Release, Schedule, readings_of_each};
use std::f64::consts::FRAC_2_PI;
use std::ops::Range;

/// Where in the parameters an unknown sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// m, which no swing tells; known to a tolerance.
    Mass,
    /// l, which no swing tells; known to a tolerance.
    Length,
    /// I, the moment of inertia about the centre of mass.
    Inertia,
    /// A number of an effect.
    Effect {
        /// The effect's id.
        id: u16,
        /// Position in its parameter list.
        index: usize,
    },
    /// The torque at a knot of the friction curve, by its position.
    Knot(usize),
    /// How much the friction level of the swings differs, by a contrast of them ([`super::levels`]).
    Level {
        /// Of which part of the friction.
        part: Part,
        /// Which contrast, from 1.
        contrast: usize,
    },
}

/// Which part of the friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// Coulomb friction, stiction, and what else is a torque at every speed.
    Dry,
    /// Viscous friction and drags.
    Speed,
}

impl Part {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Dry => "dry friction",
            Self::Speed => "what grows with the speed",
        }
    }
}

impl Part {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Dry, Self::Speed];
}

/// A number to be identified.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// Where it sits.
    pub quantity: Quantity,
    /// The literature's symbol.
    pub symbol: &'static str,
    /// The effect's name, or `inertia`.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Smallest value allowed.
    pub low: f64,
    /// Largest value allowed.
    pub high: f64,
    /// A change that matters; steps and damping are measured against it.
    pub scale: f64,
    /// What is known of it before any swing is seen.
    pub prior: Option<Prior>,
    /// The present value of a level, which no parameters hold.
    pub own: f64,
}

impl Unknown {
    /// The moment of inertia of a pendulum, between nothing and ten times its moment about the pivot.
    pub fn inertia(parameters: &Parameters<f64>) -> Self {
        let pivot = parameters.pendulum.pivot_inertia_kg_m2();
        let (symbol, name, unit) = ("I", "inertia", "kg·m²");
        let (low, high, scale) = (0.0, 10.0 * pivot, 0.1 * pivot);
        Self { quantity: Quantity::Inertia, symbol, name, unit, low, high, scale, prior: None, own: 0.0 }
    }

    /// The same where the geometry of the pendulum is known to tolerances.
    pub fn inertia_within(tolerances: &Tolerances, parameters: &Parameters<f64>) -> Self {
        let free = Self::inertia(parameters);
        let Some(known) = tolerances.of_inertia(&parameters.pendulum) else { return free };
        Self { low: known.low, high: known.high.min(free.high), prior: Some(known.prior), ..free }
    }

    /// Mass or length, which is measured by other means.
    pub fn of_geometry(quantity: Quantity, known: &Known) -> Self {
        let (symbol, unit) = if quantity == Quantity::Mass { ("m", "kg") } else { ("l", "m") };
        let Known { value, std } = *known;
        let prior = Some(Prior { value, std, only_below: false });
        Self { quantity, symbol, name: "pendulum", unit, low: 0.0, high: f64::INFINITY, scale: std, prior, own: 0.0 }
    }

    /// A number of an effect, within its physical range. Friction scales with m·g·l, and what has seconds in its unit
    /// with the period; viscous and dry friction may be as large as a pendulum can have that still swings.
    pub fn of_effect(effect: &'static Effect<f64>, index: usize, parameters: &Parameters<f64>) -> Self {
        let parameter: &Parameter = &effect.parameters[index];
        let size = parameters.pendulum.gravity_torque_nm() / USUAL_GRAVITY_TORQUE_NM;
        let grows = if parameter.unit.starts_with("N·m") { size.max(1.0) } else { 1.0 };
        let grows = grows * pace::scale(parameter.unit, pace::of_pendulum(&parameters.pendulum));
        let high = parameter.high * grows;
        Self {
            quantity: Quantity::Effect { id: effect.id, index },
            symbol: parameter.symbol,
            name: effect.name,
            unit: parameter.unit,
            low: parameter.low * grows,
            high: match effect.id {
                base::VISCOUS => high.max(critical_damping(parameters)),
                base::COULOMB => high.max(MOST_DRY_FRICTION * parameters.pendulum.gravity_torque_nm()),
                _ => high,
            },
            scale: SCALE_OF_RANGE * (parameter.high - parameter.low) * grows,
            prior: None,
            own: 0.0,
        }
    }

    /// All numbers of an effect.
    pub fn all_of_effect(effect: &'static Effect<f64>, parameters: &Parameters<f64>) -> Vec<Self> {
        (0..effect.parameters.len()).map(|index| Self::of_effect(effect, index, parameters)).collect()
    }

    /// Does its value in a set of parameters lie on an end of its range?
    pub fn is_at_end(&self, parameters: &Parameters<f64>) -> bool {
        let value = self.get(parameters);
        value <= self.low || value >= self.high
    }

    /// Its value in a set of parameters; zero for an absent effect.
    pub fn get(&self, parameters: &Parameters<f64>) -> f64 {
        match self.quantity {
            Quantity::Mass => parameters.pendulum.mass_kg,
            Quantity::Length => parameters.pendulum.length_m,
            Quantity::Inertia => parameters.pendulum.inertia_kg_m2,
            Quantity::Effect { id, index } => {
                parameters.values(id).and_then(|values| values.get(index)).copied().unwrap_or(0.0)
            }
            Quantity::Knot(index) => {
                parameters.curve.as_ref().and_then(|curve| curve.torques_nm().get(index)).copied().unwrap_or(0.0)
            }
            Quantity::Level { .. } => self.own,
        }
    }

    /// Sets it; the effect must be present. A level is no number of the parameters.
    pub fn set(&self, parameters: &mut Parameters<f64>, value: f64) {
        match self.quantity {
            Quantity::Mass => parameters.pendulum.mass_kg = value,
            Quantity::Length => parameters.pendulum.length_m = value,
            Quantity::Inertia => parameters.pendulum.inertia_kg_m2 = value,
            Quantity::Effect { id, index } => {
                let effect = parameters.effects.iter_mut().find(|effect| effect.id == id);
                if let Some(slot) = effect.and_then(|effect| effect.values.get_mut(index)) {
                    *slot = value;
                }
            }
            Quantity::Knot(index) => {
                let torques = parameters.curve.as_mut().map(Curve::torques_nm_mut);
                if let Some(slot) = torques.and_then(|torques| torques.get_mut(index)) {
                    *slot = value;
                }
            }
            Quantity::Level { .. } => {}
        }
    }

    /// Is it of the rig itself, inertia or friction that every model has?
    pub fn is_of_the_rig(&self) -> bool {
        let is_base = |id: u16| base::has(id) && id != base::STICTION;
        matches!(self.quantity, Quantity::Inertia)
            || matches!(self.quantity, Quantity::Effect { id, .. } if is_base(id))
    }

    /// Is it Ms or DV, in which the error is not smooth?
    pub fn is_stiction(&self) -> bool {
        matches!(self.quantity, Quantity::Effect { id: base::STICTION, .. })
    }

    /// Is it DV?
    pub fn is_band(&self) -> bool {
        matches!(self.quantity, Quantity::Effect { id: base::STICTION, index: 1 })
    }
}

/// The effects' ranges are meant for a pendulum of about this m·g·l.
const USUAL_GRAVITY_TORQUE_NM: f64 = 0.22;

/// The usual change of a parameter as a share of its range.
const SCALE_OF_RANGE: f64 = 0.02;

/// Readings without any noise are as good as this, rad².
const LEAST_VARIANCE: f64 = 1e-14;

/// With more dry friction, as a share of m·g·l, one that falls from upright does not pass the lowest point: π·Mc = 2·m·g·l.
const MOST_DRY_FRICTION: f64 = FRAC_2_PI;

/// Viscous friction with which a pendulum swings no more, N·m·s/rad: 2·√(m·g·l·J). Source: any textbook of vibrations.
fn critical_damping(parameters: &Parameters<f64>) -> f64 {
    let pendulum = &parameters.pendulum;
    2.0 * (pendulum.gravity_torque_nm() * pendulum.pivot_inertia_kg_m2()).sqrt()
}

/// How one swing began, and where the sensor's zero lay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// θ at the first sample, rad.
    pub angle_rad: f64,
    /// ω at the first sample, rad/s.
    pub velocity_rad_s: f64,
    /// Added to the model's reading, rad.
    pub offset_rad: f64,
}

impl Start {
    /// How a simulation of this swing begins.
    pub fn release(&self, swing: &Swing) -> Release {
        Release { angle_rad: self.angle_rad, velocity_rad_s: self.velocity_rad_s, begins_s: swing.begins_s }
    }
}

/// Numbers per swing that are fitted beside the unknowns.
pub const PER_SWING: usize = 3;

/// A guess at everything.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// One value an unknown.
    pub values: Vec<f64>,
    /// One start a swing.
    pub starts: Vec<Start>,
}

/// What is to be identified from which swings.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// The measurements.
    pub swings: &'a [Swing],
    /// Fixed numbers, and the effects that are present.
    pub template: Parameters<f64>,
    /// What to identify.
    pub unknowns: Vec<Unknown>,
    /// Is the sensor's zero of each swing fitted too?
    pub offsets_are_free: bool,
    /// How surely the geometry is known.
    pub tolerances: Tolerances,
    /// What a crooked friction curve costs, while one is sought.
    pub ridge: Option<Ridge>,
    /// What was simulated so far.
    pub tally: &'a Tally,
}

/// Errors beyond this share of the motion mean that the model does not follow it.
const HOPELESS_SHARE: f64 = 0.6;

impl<'a> Problem<'a> {
    /// Of swings and parameters; the sensor's zero of each swing is free.
    pub fn new(swings: &'a [Swing], template: &Parameters<f64>, unknowns: Vec<Unknown>, tally: &'a Tally) -> Self {
        let (template, tolerances) = (template.clone(), Tolerances::default());
        Self { swings, template, unknowns, offsets_are_free: true, tolerances, ridge: None, tally }
    }

    /// Is an effect the scale of a sensor of rates? Then it is free in every fit, and no finding.
    pub fn is_free_scale(&self, effect: &Effect<f64>) -> bool {
        effect.rules.is_calibrated && self.swings.iter().any(|swing| swing.measured == Measured::Rate)
    }

    /// The parameters that a guess means.
    pub fn parameters(&self, values: &[f64]) -> Parameters<f64> {
        let mut parameters = self.template.clone();
        for (unknown, value) in self.unknowns.iter().zip(values) {
            unknown.set(&mut parameters, *value);
        }
        parameters
    }

    /// The unknowns' present values in the template, within their bounds.
    pub fn template_values(&self) -> Vec<f64> {
        self.unknowns.iter().map(|unknown| unknown.get(&self.template).clamp(unknown.low, unknown.high)).collect()
    }

    /// The same without Ms and DV among its unknowns.
    pub fn without_stiction(&self) -> Self {
        let unknowns = self.unknowns.iter().filter(|unknown| !unknown.is_stiction()).cloned().collect();
        Self { unknowns, ..self.clone() }
    }

    /// Values in the order of the unknowns: Ms and DV from `own`, the others from those of [`Problem::without_stiction`].
    pub fn with_values_but_stiction(&self, own: &[f64], smooth: &[f64]) -> Vec<f64> {
        let mut smooth = smooth.iter();
        let value = |(unknown, own): (&Unknown, &f64)| match unknown.is_stiction() {
            true => *own,
            false => smooth.next().copied().unwrap_or(*own),
        };
        self.unknowns.iter().zip(own).map(value).collect()
    }

    /// Readings without offset of one swing for several guesses, one column a guess, over its first samples.
    pub fn predict(&self, swing_idx: usize, n_samples: usize, guesses: &[(&[f64], Start)]) -> Vec<Vec<f64>> {
        let batch = |batch| self.predict_batch(swing_idx, n_samples, batch);
        on_all_cores(guesses.chunks(AT_ONCE), batch).into_iter().flatten().collect()
    }

    fn predict_batch(&self, swing_idx: usize, n_samples: usize, batch: &[(&[f64], Start)]) -> Vec<Vec<f64>> {
        let (swing, schedule) = (&self.swings[swing_idx], self.schedule(swing_idx));
        let run = |(values, start): &(&[f64], Start)| {
            let mut parameters = self.parameters(values);
            self.put_level(&mut parameters, swing_idx, values);
            (parameters, start.release(swing))
        };
        let runs: Vec<(Parameters<f64>, Release)> = batch.iter().map(run).collect();
        self.tally.add(&self.template, batch.len(), schedule.n_steps_to(n_samples));
        readings_of_each(&runs, schedule, n_samples)
    }

    fn schedule(&self, swing_idx: usize) -> &Schedule {
        self.swings[swing_idx].schedule(&self.template)
    }

    /// Sums of squared errors within a window, one a guess, all swings together.
    pub fn costs(&self, window: Window, guesses: &[Point]) -> Vec<f64> {
        let of_swing = |swing_idx: usize| -> Vec<f64> {
            let swing = &self.swings[swing_idx];
            let n_samples = swing.samples_within(window);
            let columns: Vec<(&[f64], Start)> =
                guesses.iter().map(|point| (point.values.as_slice(), point.starts[swing_idx])).collect();
            let predicted = self.predict(swing_idx, n_samples, &columns);
            let cost = |(column, (_, start)): (&Vec<f64>, &(&[f64], Start))| -> f64 {
                let error = |(m, p): (&f64, &f64)| (m - p - start.offset_rad).powi(2);
                swing.angles_rad.iter().zip(column).map(error).sum()
            };
            predicted.iter().zip(&columns).map(cost).collect()
        };
        let per_swing: Vec<Vec<f64>> = on_all_cores(0..self.swings.len(), of_swing);
        let penalty = |guess: usize| self.penalty(window, &guesses[guess].values);
        let cost = |guess: usize| per_swing.iter().map(|costs| costs[guess]).sum::<f64>() + penalty(guess);
        (0..guesses.len()).map(cost).collect()
    }

    /// Where the torques at the knots of a friction curve stand among the unknowns.
    pub fn knots(&self) -> Option<Range<usize>> {
        let is_knot = |unknown: &Unknown| matches!(unknown.quantity, Quantity::Knot(_));
        let first = self.unknowns.iter().position(is_knot)?;
        Some(first..first + self.unknowns.iter().filter(|unknown| is_knot(unknown)).count())
    }

    /// What a crooked friction curve, and numbers far from what is known of them, cost beside the errors, rad².
    fn penalty(&self, window: Window, values: &[f64]) -> f64 {
        let off = |(unknown, value): (&Unknown, &f64)| unknown.prior.map_or(0.0, |prior| prior.off(*value).powi(2));
        let of_priors = self.least_variance() * self.unknowns.iter().zip(values).map(off).sum::<f64>();
        let Some((ridge, knots)) = self.ridge.as_ref().zip(self.knots()) else { return of_priors };
        of_priors + ridge.penalty(self.n_samples(window), &values[knots])
    }

    /// What one standard deviation off a prior costs, rad²: as much as one of a reading.
    pub fn least_variance(&self) -> f64 {
        self.noise_rad().powi(2).max(LEAST_VARIANCE)
    }

    /// The same with other swings.
    pub fn on<'b>(&self, swings: &'b [Swing]) -> Problem<'b>
    where
        'a: 'b,
    {
        Problem { swings, ..self.clone() }
    }

    /// Enough of its swings to find the way.
    pub fn decimated(&self) -> Vec<Swing> {
        self.swings.iter().map(Swing::decimated).collect()
    }

    /// Number of samples within a window, all swings together.
    pub fn n_samples(&self, window: Window) -> usize {
        self.swings.iter().map(|swing| swing.samples_within(window)).sum()
    }

    /// Does a swing come to rest?
    pub fn comes_to_rest(&self) -> bool {
        self.swings.iter().any(Swing::comes_to_rest)
    }

    /// The longest swing, s.
    pub fn longest_s(&self) -> f64 {
        self.swings.iter().map(Swing::duration_s).fold(0.0, f64::max)
    }

    /// How slowly the pendulum swings.
    pub fn pace(&self) -> f64 {
        pace(self.swings)
    }

    /// The reduced chi-square of a cost, rad².
    pub fn chi_square(&self, cost: f64) -> ChiSquare {
        let n_fitted = self.unknowns.len() + PER_SWING * self.swings.len();
        let colours = self.swings.iter().filter_map(|swing| swing.colour);
        let n_samples = self.n_samples(Window::Whole) as f64;
        ChiSquare::new(cost, self.noise_rad(), n_samples, n_fitted).beside(colours.reduce(Colour::worst))
    }

    /// The root mean square error of a cost, rad.
    pub fn rmse_rad(&self, cost: f64) -> f64 {
        (cost / self.n_samples(Window::Whole).max(1) as f64).sqrt()
    }

    /// Does a model of this cost follow the swings at all?
    pub fn is_followed(&self, cost: f64) -> bool {
        self.share_of_motion(cost) <= HOPELESS_SHARE
    }

    /// How far the widest swing goes, rad.
    pub fn largest_rad(&self) -> f64 {
        self.swings.iter().map(Swing::largest_rad).fold(0.0, f64::max)
    }

    /// The cost of a model that hangs still.
    pub fn motion(&self) -> f64 {
        self.swings.iter().map(Swing::motion).sum()
    }

    /// The error of a cost as a share of the readings about their zeros, both root mean square.
    pub fn share_of_motion(&self, cost: f64) -> f64 {
        (cost / self.motion()).sqrt()
    }

    /// How many of the samples of another problem this one has, as a share.
    pub fn share_of_samples(&self, all: &Self) -> f64 {
        self.n_samples(Window::Whole) as f64 / all.n_samples(Window::Whole).max(1) as f64
    }

    /// What a model of this cost leaves beyond the noise, as a share of the readings, both root mean square.
    pub fn left_of_motion(&self, cost: f64) -> f64 {
        self.share_of_motion((cost - self.noise_cost()).max(0.0))
    }

    /// The cost that noise alone leaves, rad².
    pub fn noise_cost(&self) -> f64 {
        self.noise_rad().powi(2) * self.n_samples(Window::Whole) as f64
    }

    /// Root mean square noise over all swings, rad.
    pub fn noise_rad(&self) -> f64 {
        let squares: f64 = self.swings.iter().map(|swing| swing.noise_rad.powi(2) * swing.len() as f64).sum();
        (squares / self.n_samples(Window::Whole).max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Falling from upright to the lowest point frees 2·m·g·l, and dry friction takes π·Mc on the way.
    #[test]
    fn friction_may_be_as_large_as_a_pendulum_has_that_still_swings() {
        for size in [0.1, 1.0, 30.0] {
            let mut rig = Parameters::<f64>::paper();
            rig.pendulum.mass_kg *= size;
            let high = |id: u16| Unknown::of_effect(Effect::by_id(id).unwrap(), 0, &rig).high;
            assert!(PI * high(base::COULOMB) >= 2.0 * rig.pendulum.gravity_torque_nm() * (1.0 - 1e-12), "{size}");
            assert!(high(base::VISCOUS) >= critical_damping(&rig), "{size}");
        }
    }
}
