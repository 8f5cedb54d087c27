//! Is what remains white? Autocorrelation and spectrum; a slow remainder far below the noise is seen by means over blocks
//! (`recording/src/noise/still.rs`).

use serde::Serialize;

/// Autocorrelation of residuals.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Autocorrelation {
    /// Lags, s.
    pub lags_s: Vec<f64>,
    /// Correlation at each lag, −1 … 1.
    pub values: Vec<f64>,
    /// White residuals stay within ± this, 95 % of the time.
    pub band: f64,
}

/// So many lags are shown.
const N_LAGS: usize = 200;

/// Autocorrelation up to a lag (s) of residuals in (nearly) even steps.
pub fn autocorrelation(residuals: &[f64], step_s: f64, longest_s: f64) -> Autocorrelation {
    let n = residuals.len();
    let longest = ((longest_s / step_s) as usize).clamp(1, (n / 2).max(1));
    let stride = longest.div_ceil(N_LAGS);
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    let at = |lag: usize| residuals[lag..].iter().zip(residuals).map(|(a, b)| a * b).sum::<f64>() / square;
    let lags: Vec<usize> = (1..=longest).step_by(stride).collect();
    if n < 4 || square == 0.0 {
        return Autocorrelation::default();
    }
    Autocorrelation {
        lags_s: lags.iter().map(|lag| *lag as f64 * step_s).collect(),
        values: lags.iter().map(|lag| at(*lag)).collect(),
        band: 1.96 / (n as f64).sqrt(),
    }
}

/// Spectrum of residuals.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Spectrum {
    /// Hz, rising by equal factors.
    pub frequencies_hz: Vec<f64>,
    /// One-sided power density, rad²/Hz.
    pub densities: Vec<f64>,
    /// The density of white noise of the recording's level, rad²/Hz.
    pub white_density: f64,
}

/// Frequencies shown.
const N_FREQUENCIES: usize = 60;

/// Blocks that a spectrum is averaged over, at least.
const N_SPECTRUM_BLOCKS: usize = 4;

/// Samples that enter a spectrum at most; above that the highest frequencies are left out.
const MAX_SPECTRUM_SAMPLES: usize = 4096;

/// Averaged spectrum of residuals in (nearly) even steps: Hann windows that overlap by half (P. D. Welch, IEEE Trans.
/// Audio Electroacoust. 15 (1967) 70), each frequency by Goertzel's recursion.
pub fn spectrum(residuals: &[f64], step_s: f64, noise_rad: f64) -> Spectrum {
    let stride = residuals.len().div_ceil(MAX_SPECTRUM_SAMPLES);
    let averaged: Vec<f64> =
        residuals.chunks_exact(stride.max(1)).map(|chunk| chunk.iter().sum::<f64>() / chunk.len() as f64).collect();
    let (step_s, length) = (step_s * stride as f64, averaged.len() / N_SPECTRUM_BLOCKS * 2);
    if length < 16 {
        return Spectrum::default();
    }
    let window: Vec<f64> =
        (0..length).map(|i| 0.5 - 0.5 * (std::f64::consts::TAU * (i as f64 + 0.5) / length as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let (low_hz, high_hz) = (2.0 / (length as f64 * step_s), 0.45 / step_s);
    let frequency = |k: usize| low_hz * (high_hz / low_hz).powf(k as f64 / (N_FREQUENCIES - 1) as f64);
    let density = |frequency_hz: f64| {
        let blocks: Vec<&[f64]> = averaged.windows(length).step_by(length / 2).collect();
        let sum: f64 = blocks.iter().map(|block| goertzel(block, &window, frequency_hz * step_s)).sum();
        2.0 * step_s * sum / (power * blocks.len() as f64)
    };
    let frequencies_hz: Vec<f64> = (0..N_FREQUENCIES).map(frequency).collect();
    let densities = frequencies_hz.iter().map(|frequency_hz| density(*frequency_hz)).collect();
    let white_density = 2.0 * (step_s / stride as f64) * noise_rad.powi(2);
    Spectrum { frequencies_hz, densities, white_density }
}

/// |Σ wᵢ xᵢ exp(−2πi·f·i)|², f in cycles per sample.
fn goertzel(values: &[f64], window: &[f64], cycles_per_sample: f64) -> f64 {
    let angle = std::f64::consts::TAU * cycles_per_sample;
    let factor = 2.0 * angle.cos();
    let (last, before) =
        values.iter().zip(window).fold((0.0, 0.0), |(s1, s2), (value, weight)| (value * weight + factor * s1 - s2, s1));
    last * last + before * before - factor * last * before
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    fn white(n: usize, seed: u64) -> Vec<f64> {
        let mut noise = Noise::new(seed);
        (0..n).map(|_| 1e-3 * noise.normal()).collect()
    }

    #[test]
    fn the_spectrum_of_white_noise_is_flat_at_its_level() {
        let spectrum = spectrum(&white(16_000, 2), 1e-3, 1e-3);
        let mean = spectrum.densities.iter().sum::<f64>() / spectrum.densities.len() as f64;
        assert!((mean / spectrum.white_density - 1.0).abs() < 0.3, "{mean} {}", spectrum.white_density);
    }

    #[test]
    fn white_residuals_stay_within_the_band_of_the_autocorrelation() {
        let found = autocorrelation(&white(10_000, 3), 1e-3, 0.1);
        let outside = found.values.iter().filter(|value| value.abs() > found.band).count();
        assert!(outside <= 12, "{outside}");
    }

    #[test]
    fn a_sine_stands_in_the_spectrum_with_its_power_and_leaks_no_farther_than_hanns_window_lets_it() {
        // The power A²/2 over the noise bandwidth of Hann's window, 1.5 bins; its side lobes fall by 18 dB an octave.
        // Source: F. J. Harris, Proc. IEEE 66 (1978) 51, Table 1.
        let (step_s, size) = (1e-2, 1e-3);
        let sine = |frequency_hz: f64| -> Vec<f64> {
            (0..4000).map(|i| size * (std::f64::consts::TAU * frequency_hz * step_s * f64::from(i)).sin()).collect()
        };
        let frequencies_hz = spectrum(&sine(1.0), step_s, 1e-6).frequencies_hz;
        let found = spectrum(&sine(frequencies_hz[30]), step_s, 1e-6);
        let bin_hz = 1.0 / (2000.0 * step_s);
        let expected = size * size / 2.0 / (1.5 * bin_hz);
        assert!((found.densities[30] / expected - 1.0).abs() < 1e-2, "{} {expected}", found.densities[30]);
        let far = frequencies_hz
            .iter()
            .zip(&found.densities)
            .filter(|(f, _)| (*f - frequencies_hz[30]).abs() > 10.0 * bin_hz);
        assert!(far.clone().count() > 40);
        far.for_each(|(f, density)| assert!(*density < 1e-5 * expected, "{f} {density}"));
    }

    #[test]
    fn a_sine_remembers_itself_as_a_cosine_of_the_lag() {
        // Over whole waves, less the share of the samples that have no partner.
        let n = 10_000;
        let residuals: Vec<f64> = (0..n).map(|i| (std::f64::consts::TAU * f64::from(i) / 100.0).sin()).collect();
        let found = autocorrelation(&residuals, 0.01, 1.0);
        assert_eq!(found.values.len(), 100);
        for (lag_s, value) in found.lags_s.iter().zip(&found.values) {
            let expected = (std::f64::consts::TAU * lag_s).cos() * (1.0 - 100.0 * lag_s / f64::from(n));
            assert!((value - expected).abs() < 5e-3, "{lag_s} {value} {expected}");
        }
        assert!((found.band - 0.0196).abs() < 1e-12);
    }
}
