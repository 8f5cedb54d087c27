//! Which experiment next? Every one on a list is simulated with each of the leading models; the best is the one after
//! which no other model could imitate what the true one would show.
//!
//! Two models are told apart by Δχ²: the squared difference of their readings in units of the noise that is left after
//! the imitating model moved its parameters, its start and the sensor's zero as far as the present recordings allow.
//! min over δ of |d − J·δ|²/σ² + δᵀ·P·δ, with d the difference, J the derivatives of the imitating model in the new
//! experiment, and P the precision (inverse covariance) of its parameters from the present recordings.

use crate::cores::on_all_cores;
use crate::fit::fitted::Fitted;
use crate::fit::linear::{Equations, Steps, equations};
use crate::fit::problem::{PER_SWING, Point, Problem, Start, Unknown};
use crate::fit::tally::Tally;
use crate::swing::{Swing, Window};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use shared::motion::Pendulum;
use shared::parameters::Parameters;

/// Release angles, rad, to either side.
const RELEASES_RAD: [f64; 6] = [0.3, 0.6, 1.0, 1.5, 2.0, 2.5];

/// Release angles with another mass or length, rad.
const CHANGED_RELEASES_RAD: [f64; 2] = [0.6, 1.5];

/// How a changed pendulum differs: factors of mass and length.
const CHANGES: [(f64, f64); 4] = [(1.5, 1.0), (0.67, 1.0), (1.0, 1.25), (1.0, 0.8)];

/// A planned recording: length and rate.
const LENGTH_S: f64 = 30.0;
const RATE_HZ: f64 = 100.0;

/// What a model is called that has no effect beyond those of the file.
pub const NOTHING: &str = "nothing";

/// Added to a normal matrix, as a share of its diagonal.
const RIDGE: f64 = 1e-9;

/// Something that could be done.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Experiment {
    /// Release angle, rad.
    pub release_rad: f64,
    /// The mass becomes so many times the present one, its distance from the pivot unchanged.
    pub mass_factor: f64,
    /// The distance from the pivot becomes so many times the present one.
    pub length_factor: f64,
}

/// How well an experiment would separate two models.
#[derive(Clone, Debug, Serialize)]
pub struct Separation {
    /// Names of the two.
    pub models: [String; 2],
    /// Δχ² of the better imitation of the two.
    pub delta_chi_square: f64,
    /// The same as a root mean square difference in units of the noise.
    pub noises: f64,
}

/// An experiment and what it would tell.
#[derive(Clone, Debug, Serialize)]
pub struct Prospect {
    /// What to do.
    pub experiment: Experiment,
    /// The first model and each of the others.
    pub separations: Vec<Separation>,
    /// Δχ² of the pair that is hardest to tell apart.
    pub worst: f64,
}

/// What is known of a model.
struct Known<'a> {
    fitted: &'a Fitted,
    name: String,
    precision: DMatrix<f64>,
}

/// Experiments by what they would tell the first of these fitted models from the others, the best first. With `changes` the pendulum itself may be
/// changed too.
pub fn plan(swings: &[Swing], models: &[Fitted], changes: bool) -> Vec<Prospect> {
    let count = Tally::default();
    let known: Vec<Known> = models.iter().map(|fitted| Known::new(swings, fitted, &count)).collect();
    let noise_rad = problem(swings, &models[0].unknowns, &models[0].parameters, &count).noise_rad();
    let prospect = |experiment: Experiment| {
        let separation = |other: &Known| separation(&known[0], other, experiment, noise_rad, &count);
        let separations: Vec<Separation> = known[1..].iter().map(separation).collect();
        let worst = separations.iter().map(|s| s.delta_chi_square).fold(f64::INFINITY, f64::min);
        Prospect { experiment, separations, worst }
    };
    let mut prospects: Vec<Prospect> = on_all_cores(experiments(changes), prospect);
    prospects.sort_by(|a, b| b.worst.total_cmp(&a.worst));
    prospects
}

fn experiments(changes: bool) -> Vec<Experiment> {
    let sides = |angle: &f64| [*angle, -*angle];
    let as_it_is = RELEASES_RAD.iter().flat_map(sides);
    let as_it_is = as_it_is.map(|release_rad| Experiment { release_rad, mass_factor: 1.0, length_factor: 1.0 });
    let changed = CHANGES.iter().flat_map(|(mass_factor, length_factor)| {
        CHANGED_RELEASES_RAD.iter().map(|release_rad| Experiment {
            release_rad: *release_rad,
            mass_factor: *mass_factor,
            length_factor: *length_factor,
        })
    });
    as_it_is.chain(changed.filter(|_| changes)).collect()
}

fn problem<'a>(swings: &'a [Swing], unknowns: &[Unknown], template: &Parameters<f64>, count: &'a Tally) -> Problem<'a> {
    Problem::new(swings, template, unknowns.to_vec(), count)
}

impl<'a> Known<'a> {
    fn new(swings: &[Swing], fitted: &'a Fitted, count: &Tally) -> Self {
        let problem = problem(swings, &fitted.unknowns, &fitted.parameters, count);
        let linear = fitted.linearised(&problem);
        // A model that leaves more than the noise knows its parameters less well.
        let variance = (linear.equations.cost / linear.equations.n_samples as f64).max(problem.noise_rad().powi(2));
        Self {
            fitted,
            name: if fitted.effects.is_empty() { NOTHING.to_owned() } else { fitted.name() },
            precision: of_unknowns(&linear.equations.normal.dense(), fitted.unknowns.len()) / variance,
        }
    }

    /// The model in an experiment.
    fn changed(&self, experiment: Experiment) -> Parameters<f64> {
        let present = self.fitted.parameters.pendulum;
        let pendulum = Pendulum {
            mass_kg: present.mass_kg * experiment.mass_factor,
            length_m: present.length_m * experiment.length_factor,
            ..present
        };
        Parameters { pendulum, ..self.fitted.parameters.clone() }
    }

    fn readings(&self, experiment: Experiment, at: &[Swing], count: &Tally) -> Vec<f64> {
        let problem = problem(at, &self.fitted.unknowns, &self.changed(experiment), count);
        let mut columns = problem.predict(0, at[0].len(), &[(&self.fitted.point().values, start(experiment))]);
        columns.swap_remove(0)
    }
}

fn start(experiment: Experiment) -> Start {
    Start { angle_rad: experiment.release_rad, velocity_rad_s: 0.0, offset_rad: 0.0 }
}

/// The first pass finds the sizes of the finite differences.
fn twice_linearised(problem: &Problem, point: &Point) -> Equations {
    let mut steps = Steps::new(problem);
    equations(problem, point, Window::Whole, &mut steps);
    equations(problem, point, Window::Whole, &mut steps)
}

/// The normal matrix of the unknowns once starts and offsets took their best values (Schur complement).
fn of_unknowns(normal: &DMatrix<f64>, n_unknowns: usize) -> DMatrix<f64> {
    let n_starts = normal.nrows() - n_unknowns;
    let own = normal.view((0, 0), (n_unknowns, n_unknowns)).into_owned();
    let mixed = normal.view((0, n_unknowns), (n_unknowns, n_starts)).into_owned();
    let starts = with_ridge(normal.view((n_unknowns, n_unknowns), (n_starts, n_starts)).into_owned());
    match starts.cholesky() {
        Some(starts) => own - &mixed * starts.solve(&mixed.transpose()),
        None => own,
    }
}

fn with_ridge(mut matrix: DMatrix<f64>) -> DMatrix<f64> {
    for i in 0..matrix.nrows() {
        matrix[(i, i)] *= 1.0 + RIDGE;
        matrix[(i, i)] = matrix[(i, i)].max(f64::MIN_POSITIVE);
    }
    matrix
}

/// Each of two models in turn is the true one; the better imitation of the two counts.
fn separation(a: &Known, b: &Known, experiment: Experiment, noise_rad: f64, count: &Tally) -> Separation {
    let delta_chi_square =
        imitation(a, b, experiment, noise_rad, count).min(imitation(b, a, experiment, noise_rad, count));
    let noises = (delta_chi_square / (LENGTH_S * RATE_HZ)).sqrt();
    Separation { models: [a.name.clone(), b.name.clone()], delta_chi_square, noises }
}

/// Δχ² that is left after a model imitated what the true one shows.
fn imitation(truth: &Known, model: &Known, experiment: Experiment, noise_rad: f64, count: &Tally) -> f64 {
    let times_s: Vec<f64> = (0..(LENGTH_S * RATE_HZ) as usize).map(|i| i as f64 / RATE_HZ).collect();
    let blank = [Swing::new("experiment", &times_s, &vec![experiment.release_rad; times_s.len()], noise_rad)];
    let shown = [Swing::new("experiment", &times_s, &truth.readings(experiment, &blank, count), noise_rad)];
    let problem = problem(&shown, &model.fitted.unknowns, &model.changed(experiment), count);
    let point = Point { values: model.fitted.point().values, starts: vec![start(experiment)] };
    let linear = twice_linearised(&problem, &point);
    let variance = noise_rad.powi(2);
    let n_unknowns = model.fitted.unknowns.len();
    debug_assert_eq!(linear.normal.len(), n_unknowns + PER_SWING);
    let mut normal = linear.normal.dense() / variance;
    let mut block = normal.view_mut((0, 0), (n_unknowns, n_unknowns));
    block += &model.precision;
    let gradient: DVector<f64> = &linear.gradient / variance;
    let step = with_ridge(normal).cholesky().map_or(DVector::zeros(gradient.len()), |normal| normal.solve(&gradient));
    (linear.cost / variance - gradient.dot(&step)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{fitted, rig, with_drag};
    use crate::fit::descent::Tolerance;
    use crate::fit::identify::problem_of;
    use crate::fit::refine::Band;
    use shared::effect::Effect;

    #[test]
    fn the_rival_that_is_hardest_to_tell_from_the_first_decides_and_their_order_does_not() {
        let (swings, count) = (with_drag(), Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let base = fitted(&problem, &rig());
        let with = |name: &str| {
            let effect = Effect::by_name(name).unwrap();
            base.with(effect, &effect.starts[0]).unwrap().refined(&problem, Band::Held, Tolerance::SCREEN)
        };
        let models = [base.clone(), with("quadratic-drag"), with("torsional-spring")];
        let found = plan(&swings, &models, false);
        let [first, one, another] = models.clone();
        let other = plan(&swings, &[first, another, one], false);
        // Six angles to either side.
        assert_eq!(found.len(), 12);
        for prospect in &found {
            assert_eq!(prospect.separations.len(), 2);
            assert!(prospect.separations.iter().all(|one| one.models[0] == NOTHING), "{prospect:?}");
            let least = prospect.separations.iter().map(|one| one.delta_chi_square).fold(f64::INFINITY, f64::min);
            assert_eq!(prospect.worst, least);
            for one in &prospect.separations {
                // So many noises at each of 3000 samples.
                assert!((3000.0 * one.noises.powi(2) - one.delta_chi_square).abs() <= 1e-9 * one.delta_chi_square);
            }
            let same = other.iter().find(|same| same.experiment == prospect.experiment).unwrap();
            assert!((same.worst - prospect.worst).abs() <= 1e-3 * prospect.worst, "{prospect:?} {same:?}");
        }
        assert!(found.windows(2).all(|pair| pair[0].worst >= pair[1].worst));
    }
}
