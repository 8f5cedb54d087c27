//! How well found values predict swings that took no part, and whether a change of the model carries over to them.

use super::fitted::Fitted;
use super::problem::{Point, Problem};
use super::start;
use crate::fit::tally::Tally;
use crate::swing::Swing;
use crate::verdict::CHANCE_STDS;
use serde::Serialize;
use shared::parameters::Parameters;

/// Error on swings that took no part: only their starts are fitted.
#[derive(Clone, Debug)]
pub struct HeldOut {
    /// Root mean square, rad.
    pub rmse_rad: f64,
    /// Squared residuals summed over stretches of the swings, rad².
    stretches: Vec<f64>,
}

/// What held-out swings say to a change of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Carries {
    /// Their error falls with it.
    Confirmed,
    /// Their error rises with it.
    Contradicted,
    /// Their error stays as it is, within its own uncertainty.
    CannotTell,
}

/// A held-out swing is cut into so many stretches; each is longer than the residuals' memory on a usual swing.
const N_STRETCHES: usize = 24;

impl HeldOut {
    /// Of parameters on some swings; `None` without any.
    pub fn of(held_out: &[Swing], parameters: &Parameters<f64>, count: &Tally) -> Option<Self> {
        if held_out.is_empty() {
            return None;
        }
        let problem = Problem::new(held_out, parameters, Vec::new(), count);
        let point = Point { values: Vec::new(), starts: start::starts(held_out) };
        let started = Fitted::at(&problem, &point).started(&problem);
        let stretches = held_out.iter().enumerate().flat_map(|(swing_idx, swing)| {
            let start = started.starts[swing_idx];
            let predicted = problem.predict(swing_idx, swing.len(), &[(&[], start)]).remove(0);
            let squares = swing.angles_rad.iter().zip(predicted).map(|(m, p)| (m - p - start.offset_rad).powi(2));
            let squares: Vec<f64> = squares.collect();
            let length = squares.len().div_ceil(N_STRETCHES);
            squares.chunks(length).map(|stretch| stretch.iter().sum()).collect::<Vec<f64>>()
        });
        Some(Self { rmse_rad: problem.rmse_rad(started.cost), stretches: stretches.collect() })
    }

    /// What these swings say to this model after another one: the change of the squared error against its standard
    /// error, from the scatter of the stretches.
    pub fn after(&self, before: &Self) -> Carries {
        let changes: Vec<f64> =
            self.stretches.iter().zip(&before.stretches).map(|(after, before)| after - before).collect();
        let n = changes.len() as f64;
        let mean = changes.iter().sum::<f64>() / n;
        let variance = changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
        let limit = CHANCE_STDS * (variance / n).sqrt();
        match mean {
            mean if mean > limit => Carries::Contradicted,
            mean if mean < -limit => Carries::Confirmed,
            _ => Carries::CannotTell,
        }
    }
}

/// Error on swings that took no part, rad; `None` without any.
pub fn held_out_rmse(held_out: &[Swing], parameters: &Parameters<f64>, count: &Tally) -> Option<f64> {
    HeldOut::of(held_out, parameters, count).map(|held_out| held_out.rmse_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;
    use shared::model::Model;

    fn held_out(stretches: &[f64]) -> HeldOut {
        HeldOut { rmse_rad: 0.0, stretches: stretches.to_vec() }
    }

    #[test]
    fn a_change_counts_beyond_twice_its_own_standard_error() {
        let before = held_out(&[1.0; 24]);
        let after = |of: &dyn Fn(usize) -> f64| held_out(&(0..24).map(of).collect::<Vec<f64>>()).after(&before);
        assert_eq!(after(&|k| 1.2 + 0.1 * (k % 2) as f64), Carries::Contradicted);
        assert_eq!(after(&|k| 0.7 + 0.1 * (k % 2) as f64), Carries::Confirmed);
        // One stretch that is worse does not contradict the others.
        assert_eq!(after(&|k| if k == 3 { 9.0 } else { 1.0 }), Carries::CannotTell);
        assert_eq!(after(&|_| 1.0), Carries::CannotTell);
    }

    #[test]
    fn the_stretches_of_a_swing_hold_its_whole_error_about_the_zero() {
        let (zero_rad, noise_rad, mut noise) = (0.05, 1e-3, Noise::new(3));
        let times_s: Vec<f64> = (0..1200).map(|i| f64::from(i) / 100.0).collect();
        let (model, mut angles_rad) = (Model::new(&Parameters::paper()), Vec::new());
        let mut state = model.release(0.8, 0.0);
        for _ in &times_s {
            angles_rad.push(zero_rad + state.angle_rad + noise_rad * noise.normal());
            (0..5).for_each(|_| model.step(&mut state, 2e-3));
        }
        let swings = [Swing::new("held out", &times_s, &angles_rad, noise_rad)];
        let found = HeldOut::of(&swings, &Parameters::paper(), &Tally::default()).unwrap();
        let squares: f64 = found.stretches.iter().sum();
        assert_eq!(found.stretches.len(), N_STRETCHES);
        assert!((found.rmse_rad / noise_rad - 1.0).abs() < 0.1, "{found:?}");
        assert!((squares / (1200.0 * found.rmse_rad.powi(2)) - 1.0).abs() < 1e-3, "{found:?}");
    }
}
