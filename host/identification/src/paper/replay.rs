//! The paper's simulation of one setting, compared with the rebuilt recording.
//!
//! Plain 1 ms steps from rest at the paper's start angle over the recording's 46.2 s, with the paper's sign inside the
//! velocity band. The floors of the reconstruction stand for the noise of the authors' own recording, which the rebuilt
//! one does not have.

use super::data::{Published, Values};
use crate::cores::on_all_cores;
use crate::fit::quality::Responses;
use crate::responses::responses;
use serde::Serialize;
use shared::paper::PaperSimulation;
use shared::parameters::Parameters;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The paper's integration step, s.
const STEP_S: f64 = 1e-3;

/// How runs are simulated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Simulation {
    /// Release angle, rad.
    pub start_rad: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Integration step, s.
    pub step_s: f64,
    /// Added to every mseA, rad².
    pub floor_angle: f64,
    /// Added to every mseV, rad²/s².
    pub floor_velocity: f64,
}

/// The recording, ready for comparisons.
#[derive(Debug)]
pub struct Replay<'a> {
    published: &'a Published,
    n_simulations: AtomicUsize,
}

impl<'a> Replay<'a> {
    /// For the bundled recording.
    pub fn new(published: &'a Published) -> Self {
        Self { published, n_simulations: AtomicUsize::new(0) }
    }

    /// How it is done.
    pub fn simulation(&self) -> Simulation {
        let Published { recording_rad, interval_s, start_rad, floor_angle, floor_velocity, .. } = self.published;
        Simulation {
            start_rad: *start_rad,
            duration_s: (recording_rad.len() - 1) as f64 * interval_s,
            step_s: STEP_S,
            floor_angle: *floor_angle,
            floor_velocity: *floor_velocity,
        }
    }

    /// Swings simulated so far.
    pub fn n_simulations(&self) -> usize {
        self.n_simulations.load(Ordering::Relaxed)
    }

    /// The angle at the recording's times, rad.
    pub fn angles_rad(&self, values: &Values) -> Vec<f64> {
        self.n_simulations.fetch_add(1, Ordering::Relaxed);
        let [viscous, coulomb, stiction, velocity_band, inertia_kg_m2] = *values;
        let mut parameters = Parameters::paper();
        parameters.pendulum.inertia_kg_m2 = inertia_kg_m2;
        parameters.set_friction(viscous, coulomb, stiction, velocity_band);
        let mut simulation = PaperSimulation::release(&parameters, self.published.start_rad);
        let n_steps = (self.published.interval_s / STEP_S).round() as usize;
        let sample = |_: &f64| {
            let angle_rad = simulation.angle_rad();
            (0..n_steps).for_each(|_| simulation.step(STEP_S));
            angle_rad
        };
        self.published.recording_rad.iter().map(sample).collect()
    }

    /// The five responses of one setting.
    pub fn responses(&self, values: &Values) -> Responses {
        let Published { recording_rad, interval_s, floor_angle, floor_velocity, .. } = self.published;
        let bare = responses(recording_rad, &self.angles_rad(values), *interval_s);
        Responses {
            mse_angle: bare.angle_mean_square + floor_angle,
            mse_velocity: bare.velocity_mean_square + floor_velocity,
            positive_peaks: f64::from(bare.positive_peaks),
            negative_peaks: f64::from(bare.negative_peaks),
            zero_crossings: f64::from(bare.zero_crossings),
        }
    }

    /// The same for many settings at once, on all cores.
    pub fn all(&self, settings: &[Values]) -> Vec<Responses> {
        on_all_cores(settings, |values| self.responses(values))
    }
}
