//! What still stretches tell of the noise: its whole size and its colour. Neighbours tell only the part of it that changes
//! from sample to sample; a filter in the sensor, hum or a wandering zero have less of that than of the rest.

use super::colour::CORRELATED_STDS;
use super::{Noise, of_part, of_still};
use crate::noise::Colour;
use crate::{Recording, median_step_s};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::f64::consts::TAU;
use std::ops::Range;

/// Still samples tell of colour from so many on. Half and twice of it tell the same of 264 simulated recordings; with five times
/// of it the hum of a rest of a second at 200 Hz is missed.
const MIN_STILL: usize = 40;

/// Scatter beyond this many times that of neighbours, and beyond what its own error may make of it, is colour: a scatter
/// of n samples is known to 1/√(2n) of itself.
const COLOURED_RATIO: f64 = 1.1;

/// Excess beyond this many standard errors is significant.
const SIGNIFICANT: f64 = 5.0;

/// Fewer blocks tell nothing.
const MIN_BLOCKS: usize = 8;

/// Blocks of a period, whose means are looked at: as long as the windows in which a hold is looked for, and as those that
/// are smoothed before small swings are counted.
const BLOCKS_A_PERIOD: [usize; 2] = [40, 10];

/// A piece whose scatter is below this share of the recording's range is quiet: less than a swing that counts. With half of
/// it a noise of that size is missed, with twice of it the bends of small swings are taken for noise.
const QUIET_SHARE: f64 = 0.02;

/// What blocks of residuals show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SlowExcess {
    /// Variance of the slow remainder over that of the noise.
    pub share: f64,
    /// The share in standard errors.
    pub z: f64,
}

impl SlowExcess {
    /// Far beyond chance?
    pub fn is_significant(&self) -> bool {
        self.z > SIGNIFICANT
    }

    /// From the mean square of so many means over blocks.
    fn of_means(mean_square: f64, n_means: usize, noise_rad: f64, block: usize) -> Self {
        if n_means < MIN_BLOCKS || noise_rad <= 0.0 {
            return Self::default();
        }
        let excess = mean_square * block as f64 / noise_rad.powi(2) - 1.0;
        Self { share: excess / block as f64, z: excess / (2.0 / n_means as f64).sqrt() }
    }
}

/// Looks for a slow remainder in residuals whose white noise is known, by means over `block` samples.
///
/// The mean of a block of `m` white residuals has the variance σ²/m. A slow remainder of variance s² adds nearly all of
/// s² to it, so the blocks' variance is σ²/m + s²: with blocks of 20 samples a remainder of 2 % of σ² stands out by
/// 40 %, while the total variance could not tell it from an error in σ.
pub fn slow_excess(residuals: &[f64], noise_rad: f64, block: usize) -> SlowExcess {
    let block = block.max(2);
    let means = means(residuals, block);
    let mean_square = means.iter().map(|mean| mean * mean).sum::<f64>() / means.len() as f64;
    SlowExcess::of_means(mean_square, means.len(), noise_rad, block)
}

fn means(values: &[f64], block: usize) -> Vec<f64> {
    values.chunks_exact(block).map(|chunk| chunk.iter().sum::<f64>() / block as f64).collect()
}

impl Noise {
    /// The same with what these stretches tell, in which the pendulum hangs still, and one in which it is held. It may be a
    /// hand that trembles there, so that colour is told only by the stillest of those in which it hangs.
    pub(crate) fn beside_still<const N: usize>(
        self,
        recording: &Recording,
        hanging: [Option<Range<usize>>; N],
        held: Option<Range<usize>>,
    ) -> Self {
        let known = hanging.into_iter().flatten().filter_map(|range| Still::of(recording, range));
        let Some(still) = known.min_by(|a, b| a.at_most().total_cmp(&b.at_most())) else {
            let held = held.and_then(|range| Still::of(recording, range));
            let wanders_where_held = held.as_ref().is_some_and(|held| held.is_beyond(self.total_rms));
            return Self { still_rms: held.map(|held| held.rms), wanders_where_held, ..self };
        };
        let is_coloured = still.is_beyond(self.total_rms) || still.alternates_in(self.total_rms);
        Self { still_rms: Some(still.rms), colour: is_coloured.then_some(still.colour), ..self }
    }
}

/// The scatter of a still stretch.
struct Still {
    rms: f64,
    /// What its neighbours say.
    of_neighbours_rms: f64,
    /// The sensor's step, 0 without.
    step: f64,
    colour: Colour,
}

impl Still {
    fn of(recording: &Recording, range: Range<usize>) -> Option<Self> {
        let noise = of_still(recording, range.clone()).filter(|_| range.len() >= MIN_STILL)?;
        let of_neighbours_rms = of_part(recording, range.clone()).total_rms;
        let angles_rad = &recording.angles_rad()[range];
        let mean = angles_rad.iter().sum::<f64>() / angles_rad.len() as f64;
        let scatter: Vec<f64> = angles_rad.iter().map(|angle| angle - mean).collect();
        let (rms, step) = (noise.total_rms, noise.lsb.unwrap_or(0.0));
        Some(Self { rms, of_neighbours_rms, step, colour: Colour::of(&scatter) })
    }

    /// Relative standard error of the scatter.
    fn chance(&self) -> f64 {
        (2.0 * self.colour.n_independent).sqrt().recip()
    }

    /// Does it scatter more than white noise of this rms would? Between two codes it toggles by half a step, however small the
    /// noise.
    fn is_beyond(&self, rms: f64) -> bool {
        // Neighbours that are alike tell it from chance already.
        let chance = if self.colour.is_seen() { 0.0 } else { CORRELATED_STDS * self.chance() };
        self.rms > (COLOURED_RATIO + chance) * rms.max(self.step / 2.0)
    }

    /// Do neighbours differ more than independent ones would, here as in the whole recording, which this rms says of it? Hum of
    /// half the sampling rate does so. Within a step of the sensor it can't be told.
    fn alternates_in(&self, rms: f64) -> bool {
        let is_seen = self.rms > self.step && rms < COLOURED_RATIO * self.of_neighbours_rms;
        is_seen && (COLOURED_RATIO + CORRELATED_STDS * self.chance()) * self.rms < self.of_neighbours_rms
    }

    /// With its standard error.
    fn at_most(&self) -> f64 {
        self.rms * (1.0 + self.chance())
    }
}

/// The white noise (rms) that would scatter means over parts of a swing as this noise does; that of neighbours where no
/// more is seen. Of means over a fortieth of a period neighbours tell it again; where whole periods are quiet, also what they
/// have beside a small swing, because slow noise is alike in neighbouring means as well.
pub(crate) fn noise_of_means(times_s: &[f64], readings: &[f64], rms: f64, half_swing_s: f64) -> f64 {
    let n_period = (2.0 * half_swing_s / median_step_s(times_s)) as usize;
    // A block has two samples at least.
    let blocks = BLOCKS_A_PERIOD.map(|n_blocks| (n_period >= 2 * n_blocks).then_some(n_period / n_blocks));
    if blocks == [None; 2] {
        return rms;
    }
    let quiet = quiet_pieces(readings, n_period);
    let swing = SmallSwing::new(n_period);
    let of_quiet = blocks.map(|block| {
        let Some(block) = block else { return rms };
        let excess = swing.excess(&quiet, rms, block);
        if excess.is_significant() { rms * (1.0 + block as f64 * excess.share).sqrt() } else { rms }
    });
    let of_neighbours = blocks[0].map_or(rms, |block| of_neighbouring_means(times_s, readings, rms, block));
    log::debug!("noise {rms:.3e}, as means scatter {of_neighbours:.3e}, where it is quiet {of_quiet:?}");
    of_quiet.into_iter().fold(of_neighbours, f64::max)
}

/// The same from neighbouring means alone, of which a hand that moves some does not count.
fn of_neighbouring_means(times_s: &[f64], readings: &[f64], rms: f64, block: usize) -> f64 {
    let (times_s, readings) = (means(times_s, block), means(readings, block));
    let of_means = super::robust_of_samples(&times_s, &readings) * (block as f64).sqrt();
    let chance = CORRELATED_STDS / (2.0 * readings.len() as f64).sqrt();
    if of_means > (COLOURED_RATIO + chance) * rms { of_means } else { rms }
}

/// Periods, one behind the other, in which the pendulum hardly moves.
fn quiet_pieces(readings: &[f64], n_period: usize) -> Vec<&[f64]> {
    let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let is_quiet = |piece: &&[f64]| {
        let mean = piece.iter().sum::<f64>() / n_period as f64;
        let square = piece.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n_period as f64;
        square.sqrt() < QUIET_SHARE * (high - low)
    };
    readings.chunks_exact(n_period).filter(is_quiet).collect()
}

/// A small swing of a frequency about an even drift, whose size and frequency may change a little.
struct SmallSwing {
    columns: DMatrix<f64>,
}

/// Of a constant, a slope, a sine and a cosine, and both times the time.
const N_COLUMNS: usize = 6;

impl SmallSwing {
    /// Of a period of so many samples.
    fn new(n_samples: usize) -> Self {
        let phase = TAU / n_samples as f64;
        let x = |row: usize| 2.0 * row as f64 / n_samples as f64 - 1.0;
        let columns = DMatrix::from_fn(n_samples, N_COLUMNS, |row, column| {
            let (sin, cos) = (phase * row as f64).sin_cos();
            [1.0, x(row), cos, sin, x(row) * cos, x(row) * sin][column]
        });
        Self { columns: columns.qr().q() }
    }

    /// What such pieces have beside it, in means over blocks.
    fn excess(&self, pieces: &[&[f64]], rms: f64, block: usize) -> SlowExcess {
        let mut squares: Vec<f64> = pieces.iter().map(|piece| self.square_of_means(piece, block)).collect();
        squares.sort_by(f64::total_cmp);
        // The pendulum may come to rest within a piece, or somebody touch it.
        let Some(typical) = squares.get(squares.len().saturating_sub(1) / 2) else { return SlowExcess::default() };
        let n_free = self.columns.nrows() / block - N_COLUMNS;
        SlowExcess::of_means(*typical, n_free * pieces.len(), rms, block)
    }

    /// Mean square of the means over blocks of what a piece has beside it.
    fn square_of_means(&self, piece: &[f64], block: usize) -> f64 {
        let readings = DVector::from_column_slice(piece);
        let left = &readings - &self.columns * (self.columns.transpose() * &readings);
        let means = means(left.as_slice(), block);
        means.iter().map(|mean| mean * mean).sum::<f64>() / (means.len() - N_COLUMNS) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise as Random;
    use std::f64::consts::PI;

    const RMS: f64 = 1e-3;

    fn white(n: usize, seed: u64) -> Vec<f64> {
        let mut noise = Random::new(seed);
        (0..n).map(|_| RMS * noise.normal()).collect()
    }

    /// A first-order process with this correlation from sample to sample and a standard deviation of [`RMS`].
    fn first_order(n: usize, rho: f64, seed: u64) -> Vec<f64> {
        let scale = (1.0 - rho * rho).sqrt();
        let walk = white(n, seed).into_iter().scan(0.0, |last, x| {
            *last = rho * *last + scale * x;
            Some(*last)
        });
        walk.collect()
    }

    /// A swing that decays to rest within a fifth of 10,000 samples of 5 ms, with a noise.
    fn to_rest(noise: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let times_s: Vec<f64> = (0..noise.len()).map(|idx| 0.005 * idx as f64).collect();
        let angle = |t: f64| (1.0 - 0.1 * t).max(0.0) * (TAU * t).cos();
        let readings = times_s.iter().zip(noise).map(|(t, noise)| angle(*t) + noise).collect();
        (times_s, readings)
    }

    #[test]
    fn white_residuals_have_no_slow_excess_and_a_slow_sine_of_a_seventh_of_the_noise_has() {
        let residuals = white(20_000, 1);
        assert!(!slow_excess(&residuals, 1e-3, 20).is_significant());
        let with_sine: Vec<f64> =
            residuals.iter().enumerate().map(|(i, r)| r + 0.2e-3 * (i as f64 * 0.01).sin()).collect();
        let excess = slow_excess(&with_sine, 1e-3, 20);
        assert!(excess.is_significant() && (excess.share - 0.02).abs() < 0.008, "{excess:?}");
    }

    #[test]
    fn scatter_of_a_fifth_more_is_chance_in_fifty_samples_unless_neighbours_are_alike() {
        let still = |independent_share: f64, rms: f64| Still {
            rms,
            of_neighbours_rms: 1.0,
            step: 0.0,
            colour: Colour { independent_share, n_independent: 50.0 },
        };
        assert!(!still(1.0, 1.2).is_beyond(1.0) && still(1.0, 1.5).is_beyond(1.0));
        assert!(still(0.5, 1.2).is_beyond(1.0) && !still(0.5, 1.05).is_beyond(1.0));
    }

    #[test]
    fn means_of_white_noise_scatter_as_white_noise() {
        for seed in 1..20 {
            let (times_s, readings) = to_rest(&white(10_000, seed));
            assert_eq!(noise_of_means(&times_s, &readings, RMS, 0.5), RMS, "{seed}");
        }
    }

    #[test]
    fn means_of_a_first_order_process_scatter_as_its_spectrum_at_zero_says() {
        for (rho, seed) in [(0.5, 1), (0.8, 2)] {
            let (times_s, readings) = to_rest(&first_order(10_000, rho, seed));
            // A mean over twenty samples holds a little less than the spectrum at zero, (1 + ρ)/(1 − ρ):
            let lags = (1..20).map(|lag| 2.0 * (1.0 - f64::from(lag) / 20.0) * rho.powi(lag));
            let expected = RMS * (1.0 + lags.sum::<f64>()).sqrt();
            let found = noise_of_means(&times_s, &readings, RMS, 0.5);
            assert!((found / expected - 1.0).abs() < 0.15, "{rho}: {found} {expected}");
        }
    }

    #[test]
    fn with_forty_samples_a_period_means_tell_where_it_is_quiet() {
        let found = |noise: &[f64]| {
            let times_s: Vec<f64> = (0..noise.len()).map(|idx| 0.025 * idx as f64).collect();
            let angle = |t: f64| (1.0 - 0.1 * t).max(0.0) * (TAU * t).cos();
            let readings: Vec<f64> = times_s.iter().zip(noise).map(|(t, noise)| angle(*t) + noise).collect();
            let of_neighbours = crate::noise::robust_of_samples(&times_s, &readings);
            noise_of_means(&times_s, &readings, of_neighbours, 0.5) / of_neighbours
        };
        for seed in 1..20 {
            assert_eq!(found(&white(2000, seed)), 1.0, "{seed}");
        }
        // Neighbours tell half of it, and means over four samples scatter 1.8 times as far as so many independent ones; what is
        // as slow as the swing does not show.
        let found = found(&first_order(2000, 0.8, 3));
        assert!((1.5..3.6).contains(&found), "{found}");
    }

    #[test]
    fn a_small_swing_is_no_noise_and_noise_of_a_swing_that_goes_on_shows_in_neighbouring_means() {
        let noise = white(10_000, 5);
        let times_s: Vec<f64> = (0..noise.len()).map(|idx| 0.005 * idx as f64).collect();
        let angle = |t: f64| (-0.1 * t).exp() * (6.0 * t).cos();
        let readings: Vec<f64> = times_s.iter().zip(&noise).map(|(t, noise)| angle(*t) + noise).collect();
        assert_eq!(noise_of_means(&times_s, &readings, RMS, PI / 6.0), RMS);
        // Neighbouring means of five samples are alike to two thirds, which hides half of their scatter.
        let lively = 4000;
        let coloured: Vec<f64> =
            readings[..lively].iter().zip(first_order(lively, 0.9, 6)).map(|(a, b)| a + b).collect();
        let found = noise_of_means(&times_s[..lively], &coloured, 0.5 * RMS, PI / 6.0);
        assert!((1.0..2.2).contains(&(found / RMS)), "{found}");
    }
}
