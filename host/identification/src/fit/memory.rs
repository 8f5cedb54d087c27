//! How long residuals stay alike, and whether they do so again in the next swing: beyond chance, and beyond what rounding to
//! the steps of a sensor makes of them.
//!
//! Where the pendulum turns, and for as long as it rests, a sensor whose steps no noise hides is wrong alike in many samples,
//! and a period later nearly so again. That is no sign of a model that lacks physics. So residuals count as alike where
//! they are more so than the errors of rounding the same angles would be, wherever the grid of the steps lies.

use super::linear::dot;
use super::rounding::Grid;
use crate::swing::Swing;
use crate::verdict::NO_CHANCE_STDS;

/// What a model leaves of a swing.
pub(super) struct Residuals<'a> {
    residuals: &'a [f64],
    grid: Option<Grid>,
    /// What rounding alone would leave, by places of the grid; found when it is first asked for.
    rounded: Option<Vec<Vec<f64>>>,
}

impl<'a> Residuals<'a> {
    /// Of a sensor without steps.
    pub(super) fn new(residuals: &'a [f64]) -> Self {
        Self { residuals, grid: None, rounded: None }
    }

    /// Of a sensor that may have them.
    pub(super) fn rounded(swing: &Swing, residuals: &'a [f64]) -> Self {
        Self { residuals, grid: Grid::of(swing, residuals), rounded: None }
    }

    /// Samples over which they stay correlated: 0 for white ones.
    pub(super) fn memory(&mut self) -> usize {
        let n_samples = self.residuals.len();
        (1..n_samples / 4).take_while(|lag| self.is_alike(*lag, n_samples as f64)).count()
    }

    /// Are those a period apart alike? An error of the model comes again with every swing; noise that a filter has coloured
    /// does not, and blocks say all about it.
    pub(super) fn come_again(&mut self, crossings: &[usize], memory: usize) -> bool {
        let Some((first, last)) = crossings.first().zip(crossings.last()).filter(|(first, last)| first < last) else {
            return true;
        };
        let period = (last - first) / (crossings.len() - 1);
        self.is_alike(period.min(self.residuals.len()), self.residuals.len() as f64 / memory.max(1) as f64)
    }

    /// Are those so many samples apart correlated beyond chance, with so many of them independent, and beyond rounding?
    fn is_alike(&mut self, lag: usize, n_independent: f64) -> bool {
        let chance = NO_CHANCE_STDS / n_independent.sqrt() * dot(self.residuals, self.residuals);
        let beyond_chance = product(self.residuals, lag) - chance;
        let of_rounding = |rounded: &Vec<f64>| product(rounded, lag);
        beyond_chance > 0.0 && self.errors_of_rounding().iter().map(of_rounding).all(|product| beyond_chance > product)
    }

    fn errors_of_rounding(&mut self) -> &[Vec<f64>] {
        let (grid, residuals) = (self.grid, self.residuals);
        self.rounded.get_or_insert_with(|| grid.map_or(Vec::new(), |grid| grid.errors_elsewhere(residuals)))
    }
}

fn product(values: &[f64], lag: usize) -> f64 {
    let later = &values[lag..];
    dot(&values[..later.len()], later)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::tests::{PENDULUM, RELEASE_RAD, noise, times_s, viscous_rad};

    const STEP_RAD: f64 = RELEASE_RAD / 6.0;

    /// What the truth leaves of a viscous swing that a sensor without noise read in steps, with a grid that lies there.
    fn rounded(shift: f64) -> (Swing, Vec<f64>) {
        let times_s = times_s(20.0);
        let angles_rad: Vec<f64> = times_s.iter().map(|t| viscous_rad(4e-5, PENDULUM.inertia_kg_m2, *t)).collect();
        let round = |angle: &f64| STEP_RAD * ((angle / STEP_RAD + shift).round() - shift);
        let readings: Vec<f64> = angles_rad.iter().map(round).collect();
        let residuals = readings.iter().zip(&angles_rad).map(|(reading, angle)| reading - angle).collect();
        (Swing::new("in steps", &times_s, &readings, STEP_RAD / 12.0_f64.sqrt()), residuals)
    }

    #[test]
    fn what_a_sensor_rounds_alike_in_many_samples_is_no_memory() {
        for shift in (0..20).map(|i| f64::from(i) / 20.0) {
            let (swing, residuals) = rounded(shift);
            // Taken for noise, it is coloured.
            assert!(Residuals::new(&residuals).memory() > 0, "{shift}");
            assert_eq!(Residuals::rounded(&swing, &residuals).memory(), 0, "{shift}");
        }
    }

    #[test]
    fn what_a_model_lacks_is_seen_beside_rounding_and_comes_again() {
        let (swing, mut residuals) = rounded(0.3);
        let period = 160;
        for (i, residual) in residuals.iter_mut().enumerate() {
            *residual += 0.7 * STEP_RAD * (std::f64::consts::TAU * i as f64 / period as f64).sin();
        }
        let crossings: Vec<usize> = (0..residuals.len()).step_by(period).collect();
        let mut seen = Residuals::rounded(&swing, &residuals);
        let memory = seen.memory();
        assert!((10..period / 2).contains(&memory), "{memory}");
        assert!(seen.come_again(&crossings, memory));
    }

    #[test]
    fn noise_that_a_filter_coloured_has_a_memory_and_does_not_come_again() {
        let white = noise(4000);
        let residuals: Vec<f64> = white.windows(8).map(|window| window.iter().sum()).collect();
        let mut seen = Residuals::new(&residuals);
        let memory = seen.memory();
        assert!((5..12).contains(&memory), "{memory}");
        let crossings: Vec<usize> = (0..residuals.len()).step_by(160).collect();
        assert!(!seen.come_again(&crossings, memory));
    }
}
