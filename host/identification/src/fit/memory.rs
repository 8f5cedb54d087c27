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

/// A stride is so small a part of the lag that no half swing is passed over, in which what swings is unlike.
const STRIDES: usize = 16;

/// What a model leaves of a swing.
pub(super) struct Residuals<'a> {
    residuals: &'a [f64],
    grid: Option<Grid>,
    /// What rounding alone would leave, by places of the grid; found when it is first asked for.
    rounded: Option<Vec<Vec<f64>>>,
}

/// Do residuals that are alike for a while come again?
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Again {
    /// Noise that a filter has coloured does not, and blocks say all about it.
    No,
    /// An error of the model does with every swing.
    EachPeriod,
    /// Those of a zero that wanders are alike for a whole period and more: of blocks that are longer than these there are few.
    Always,
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

    /// Samples over which they stay correlated: 0 for white ones, a quarter of all at most. What stays alike for long, as where the
    /// zero wanders, is looked at in strides, and between the last one that is alike and the first one that is not by halves.
    pub(super) fn memory(&mut self) -> usize {
        let n_samples = self.residuals.len();
        let most = (n_samples / 4).saturating_sub(1);
        let (mut alike, mut unlike) = (0, most + 1);
        while unlike - alike > 1 {
            let lag =
                if unlike <= most { usize::midpoint(alike, unlike) } else { most.min(alike + 1 + alike / STRIDES) };
            if self.is_alike(lag, n_samples as f64) { alike = lag } else { unlike = lag }
        }
        alike
    }

    /// Are those a period apart alike?
    pub(super) fn come_again(&mut self, crossings: &[usize], memory: usize) -> Again {
        let Some((first, last)) = crossings.first().zip(crossings.last()).filter(|(first, last)| first < last) else {
            return Again::EachPeriod;
        };
        let period = (last - first) / (crossings.len() - 1);
        let n_independent = self.residuals.len() as f64 / memory.max(1) as f64;
        match () {
            () if memory >= period => Again::Always,
            () if self.is_alike(period.min(self.residuals.len()), n_independent) => Again::EachPeriod,
            () => Again::No,
        }
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
    use std::f64::consts::TAU;

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
    fn what_wanders_for_long_is_alike_for_a_quarter_of_its_period() {
        let period = 4000_u16;
        let wandering: Vec<f64> = (0..60_000).map(|i| (TAU * f64::from(i) / f64::from(period)).sin()).collect();
        let mut seen = Residuals::new(&wandering);
        let memory = seen.memory();
        let crossings = |period: usize| (0..wandering.len()).step_by(period).collect::<Vec<usize>>();
        assert_eq!([500, 2000].map(|period| seen.come_again(&crossings(period), memory)), [Again::Always, Again::No]);
        // Less by what chance allows: 4 of 245 standard deviations, as a share of a sine's slope.
        assert!((960..=1000).contains(&memory), "{memory}");
        let every_lag = |residuals: &[f64]| {
            let mut seen = Residuals::new(residuals);
            (1..residuals.len() / 4).take_while(|lag| seen.is_alike(*lag, residuals.len() as f64)).count()
        };
        assert_eq!(memory, every_lag(&wandering));
        let level = vec![1.0; 400];
        assert_eq!([Residuals::new(&level).memory(), every_lag(&level)], [99, 99]);
        assert_eq!([0, 3, 4, 8].map(|n| Residuals::new(&level[..n]).memory()), [0; 4]);
    }

    #[test]
    fn what_a_model_lacks_is_seen_beside_rounding_and_comes_again() {
        let (swing, mut residuals) = rounded(0.3);
        let period = 160;
        for (i, residual) in residuals.iter_mut().enumerate() {
            *residual += 0.7 * STEP_RAD * (TAU * i as f64 / period as f64).sin();
        }
        let crossings: Vec<usize> = (0..residuals.len()).step_by(period).collect();
        let mut seen = Residuals::rounded(&swing, &residuals);
        let memory = seen.memory();
        assert!((10..period / 2).contains(&memory), "{memory}");
        assert_eq!(seen.come_again(&crossings, memory), Again::EachPeriod);
    }

    #[test]
    fn noise_that_a_filter_coloured_has_a_memory_and_does_not_come_again() {
        let white = noise(4000);
        let residuals: Vec<f64> = white.windows(8).map(|window| window.iter().sum()).collect();
        let mut seen = Residuals::new(&residuals);
        let memory = seen.memory();
        assert!((5..12).contains(&memory), "{memory}");
        let crossings: Vec<usize> = (0..residuals.len()).step_by(160).collect();
        assert_eq!(seen.come_again(&crossings, memory), Again::No);
    }
}
