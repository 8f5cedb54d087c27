//! A free swing over a few periods, and what in its middle goes on otherwise than before.
//!
//! In: places (samples from the middle) and readings. Out: least squares for an offset that drifts and three harmonics, the
//! first of which changes in size and frequency, and for steps of the time, the size and the offset.

use nalgebra::{SMatrix, SVector};

/// Unknowns of a swing.
const SWING: usize = 12;

/// Steps of the time, the size and the offset.
pub(super) const STEPS: usize = 3;

const ALL: usize = SWING + STEPS;

/// The frequency is bettered so many times; its change over the window is among the unknowns.
const BETTERED: usize = 2;

/// It changes by no more than this share at a time.
const LARGEST_CHANGE: f64 = 0.2;

/// Samples, for a slope.
const APART: f64 = 1e-3;

/// What a window says of a step in its middle: steps of the time (samples), the size (share) and the offset, each with
/// what a scatter of 1 makes of itself in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    pub(super) steps: [f64; STEPS],
    pub(super) per_scatter: [f64; STEPS],
    pub(super) scatter: f64,
}

/// A swing fitted to readings at places that are counted in samples.
pub(super) struct Swing {
    places: Vec<f64>,
    readings: Vec<f64>,
    /// rad a sample.
    frequency: f64,
    /// Half width of the window in samples.
    beside: f64,
    found: SVector<f64, SWING>,
    /// What is left, rms.
    pub(super) scatter: f64,
}

impl Swing {
    pub(super) fn fit(places: Vec<f64>, readings: Vec<f64>, frequency: f64, beside: f64) -> Option<Self> {
        let mut swing = Self { places, readings, frequency, beside, found: SVector::zeros(), scatter: 0.0 };
        for left in (0..=BETTERED).rev() {
            let rows = swing.places.iter().map(|place| swing.row(*place));
            swing.found = least_squares(rows, &swing.readings)?.0;
            let (cosine, sine) = (swing.found[2], swing.found[3]);
            let faster = (sine * swing.found[4] - cosine * swing.found[5]) / (cosine * cosine + sine * sine) / beside;
            if left > 0 && faster.is_finite() {
                let most = LARGEST_CHANGE * swing.frequency;
                swing.frequency += faster.clamp(-most, most);
            }
        }
        let off: f64 =
            swing.places.iter().zip(&swing.readings).map(|(place, seen)| (seen - swing.at(*place)).powi(2)).sum();
        swing.scatter = (off / (swing.readings.len().checked_sub(SWING + 1)? as f64)).sqrt();
        Some(swing)
    }

    fn row(&self, place: f64) -> [f64; SWING] {
        let q = place / self.beside;
        let (s, c) = (self.frequency * place).sin_cos();
        let (s2, c2) = (2.0 * s * c, c * c - s * s);
        [1.0, q, c, s, q * c, q * s, q * q * c, q * q * s, c2, s2, c * c2 - s * s2, s * c2 + c * s2]
    }

    pub(super) fn at(&self, place: f64) -> f64 {
        self.row(place).iter().zip(self.found.iter()).map(|(value, found)| value * found).sum()
    }

    /// What it moves in a sample.
    pub(super) fn slope(&self, place: f64) -> f64 {
        (self.at(place + APART) - self.at(place - APART)) / (2.0 * APART)
    }

    pub(super) fn steps(&self) -> Option<Steps> {
        let row = |place: &f64| {
            let swing = self.row(*place);
            let later = f64::from(*place > 0.0);
            let steps = [self.slope(*place), self.at(*place) - self.found[0], 1.0];
            let mut all = [0.0; ALL];
            all[..SWING].copy_from_slice(&swing);
            all[SWING..].iter_mut().zip(steps).for_each(|(cell, step)| *cell = later * step);
            all
        };
        let (found, per_scatter, off) = least_squares(self.places.iter().map(row), &self.readings)?;
        let scatter = (off / (self.readings.len().checked_sub(ALL + 1)? as f64)).sqrt();
        let of_steps = |all: &SVector<f64, ALL>| std::array::from_fn(|step| all[SWING + step]);
        Some(Steps { steps: of_steps(&found), per_scatter: of_steps(&per_scatter), scatter })
    }
}

/// The unknowns, what a scatter of 1 makes of itself in them, and the sum of squares that is left.
fn least_squares<const N: usize>(
    rows: impl Iterator<Item = [f64; N]> + Clone,
    readings: &[f64],
) -> Option<(SVector<f64, N>, SVector<f64, N>, f64)> {
    let mut square = SMatrix::<f64, N, N>::zeros();
    let mut side = SVector::<f64, N>::zeros();
    for (row, reading) in rows.clone().zip(readings) {
        for column in 0..N {
            side[column] += row[column] * reading;
            for other in 0..=column {
                square[(column, other)] += row[column] * row[other];
            }
        }
    }
    let scale = SVector::<f64, N>::from_fn(|column, _| square[(column, column)].sqrt());
    if scale.iter().any(|scale| *scale == 0.0 || !scale.is_finite()) {
        return None;
    }
    let scaled = SMatrix::<f64, N, N>::from_fn(|row, column| {
        square[(row.max(column), row.min(column))] / (scale[row] * scale[column])
    });
    let inverse = scaled.cholesky()?.inverse();
    let found = (inverse * side.component_div(&scale)).component_div(&scale);
    let per_scatter = SVector::from_fn(|column, _| inverse[(column, column)].sqrt() / scale[column]);
    let off = |(row, reading): ([f64; N], &f64)| {
        (reading - row.iter().zip(found.iter()).map(|(value, found)| value * found).sum::<f64>()).powi(2)
    };
    Some((found, per_scatter, rows.zip(readings).map(off).sum()))
}
