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

/// What a window says of a step in its middle: steps of the time (samples), the size (share) and the offset, each with
/// what a scatter of 1 makes of itself in it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    pub(super) steps: [f64; STEPS],
    pub(super) per_scatter: [f64; STEPS],
    pub(super) scatter: f64,
}

/// A swing fitted to readings at places that are counted in samples.
pub(crate) struct Swing {
    places: Vec<f64>,
    readings: Vec<f64>,
    /// rad a sample.
    frequency: f64,
    /// Half width of the window in samples.
    beside: f64,
    found: SVector<f64, SWING>,
    /// What is left, rms.
    pub(crate) scatter: f64,
}

impl Swing {
    pub(crate) fn fit(places: Vec<f64>, readings: Vec<f64>, frequency: f64, beside: f64) -> Option<Self> {
        let n_spare = readings.len().checked_sub(SWING + 1)?;
        let mut swing = Self { places, readings, frequency, beside, found: SVector::zeros(), scatter: 0.0 };
        for left in (0..=BETTERED).rev() {
            let rows: Vec<[f64; SWING]> = swing.places.iter().map(|place| swing.row(*place)).collect();
            let (found, _, off) = least_squares(&rows, &swing.readings)?;
            (swing.found, swing.scatter) = (found, (off / n_spare as f64).sqrt());
            let (cosine, sine) = (swing.found[2], swing.found[3]);
            let faster = (sine * swing.found[4] - cosine * swing.found[5]) / (cosine * cosine + sine * sine) / beside;
            if left > 0 && faster.is_finite() {
                let most = LARGEST_CHANGE * swing.frequency;
                swing.frequency += faster.clamp(-most, most);
            }
        }
        Some(swing)
    }

    fn row(&self, place: f64) -> [f64; SWING] {
        let q = place / self.beside;
        let [(c, s), (c2, s2), (c3, s3)] = harmonics(self.frequency * place);
        [1.0, q, c, s, q * c, q * s, q * q * c, q * q * s, c2, s2, c3, s3]
    }

    /// What a row changes by in a sample.
    fn change(&self, place: f64) -> [f64; SWING] {
        let (q, dq, w) = (place / self.beside, 1.0 / self.beside, self.frequency);
        let [(c, s), (c2, s2), (c3, s3)] = harmonics(w * place);
        let (dc, ds) = (-w * s, w * c);
        let [dqc, dqs] = [dq * c + q * dc, dq * s + q * ds];
        let [dqqc, dqqs] = [q * (dq * c + dqc), q * (dq * s + dqs)];
        [0.0, dq, dc, ds, dqc, dqs, dqqc, dqqs, -2.0 * w * s2, 2.0 * w * c2, -3.0 * w * s3, 3.0 * w * c3]
    }

    pub(crate) fn at(&self, place: f64) -> f64 {
        self.sum(&self.row(place))
    }

    /// What it moves in a sample.
    pub(super) fn slope(&self, place: f64) -> f64 {
        self.sum(&self.change(place))
    }

    fn sum(&self, row: &[f64; SWING]) -> f64 {
        row.iter().zip(self.found.iter()).map(|(value, found)| value * found).sum()
    }

    pub(super) fn steps(&self) -> Option<Steps> {
        let n_spare = self.readings.len().checked_sub(ALL + 1)?;
        let row = |place: &f64| {
            let swing = self.row(*place);
            let mut all = [0.0; ALL];
            all[..SWING].copy_from_slice(&swing);
            if *place > 0.0 {
                all[SWING..].copy_from_slice(&[self.slope(*place), self.sum(&swing) - self.found[0], 1.0]);
            }
            all
        };
        let rows: Vec<[f64; ALL]> = self.places.iter().map(row).collect();
        let (found, per_scatter, off) = least_squares(&rows, &self.readings)?;
        let scatter = (off / n_spare as f64).sqrt();
        let of_steps = |all: &SVector<f64, ALL>| std::array::from_fn(|step| all[SWING + step]);
        Some(Steps { steps: of_steps(&found), per_scatter: of_steps(&per_scatter), scatter })
    }
}

/// Cosine and sine of an angle, of twice and of three times of it.
fn harmonics(angle_rad: f64) -> [(f64, f64); 3] {
    let (s, c) = angle_rad.sin_cos();
    let (c2, s2) = (c * c - s * s, 2.0 * s * c);
    [(c, s), (c2, s2), (c * c2 - s * s2, s * c2 + c * s2)]
}

/// The unknowns, what a scatter of 1 makes of itself in them, and the sum of squares that is left.
fn least_squares<const N: usize>(
    rows: &[[f64; N]],
    readings: &[f64],
) -> Option<(SVector<f64, N>, SVector<f64, N>, f64)> {
    let mut square = SMatrix::<f64, N, N>::zeros();
    let mut side = SVector::<f64, N>::zeros();
    for (row, reading) in rows.iter().zip(readings) {
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
    let off = |(row, reading): (&[f64; N], &f64)| {
        (reading - row.iter().zip(found.iter()).map(|(value, found)| value * found).sum::<f64>()).powi(2)
    };
    Some((found, per_scatter, rows.iter().zip(readings).map(off).sum()))
}
