//! Noise whose neighbouring readings are alike, where no rest shows it: told by what a model leaves.
//!
//! A filter in the sensor or in its logger, and much else, makes noise with a memory of some samples, of which neighbours tell
//! only a part. What a law lacks is remembered much longer: it comes back with each half swing, or stays for many. So where means
//! of what is left over a tenth of a period hardly know of each other, nearly all of it is noise, however large.

use super::fitted::Fitted;
use super::problem::Problem;
use crate::number::significant;
use crate::pace;
use crate::recording::noise::Colour;
use crate::swing::Swing;
use crate::verdict::Left;
use serde::Serialize;
use shared::motion::Pendulum;
use std::ops::RangeInclusive;

/// Blocks of a period. Half and twice were not tried.
const BLOCKS_A_PERIOD: f64 = 10.0;

/// Lags that are looked at, in blocks: two periods, without the first, in which a short memory still shows.
const LAGS: RangeInclusive<usize> = 2..=20;

/// Fewer blocks say nothing of so many lags.
const FEWEST_BLOCKS: usize = 100;

/// No more than this share of what is left beyond the noise may be remembered. Filters in the loggers of simulated rigs leave 0.00
/// to 0.13 of it, what laws lack 0.18 to 1 in 242 rigs and 0.17 to 1 in 59 real recordings, half of them below 0.5. Half of it
/// misses one filter; twice of it would take a dozen real recordings for noise.
const MOST_REMEMBERED: f64 = 0.2;

/// That noise was told by what a model leaves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ShortMemory {
    /// The noise, rms over all swings, in the unit of the readings.
    pub noise: f64,
    /// What neighbouring readings, or a rest, tell of it.
    pub as_read: f64,
}

impl ShortMemory {
    /// In a sentence, with numbers in this unit, a thousandth of that of the readings.
    pub fn words(&self, milli_unit: &str) -> String {
        let [noise, as_read] = [self.noise, self.as_read].map(|rms| significant(1e3 * rms, 3));
        format!(
            "The noise is taken as {noise} {milli_unit} rms, not as the {as_read} that neighbouring readings tell: these are \
             alike, as a filter in the sensor or its logger makes them. For what the model leaves is forgotten within a tenth of \
             a period; what a law lacks is remembered for many. A rest at the end of a recording tells it for sure."
        )
    }
}

/// The noise of a swing that its residuals tell.
#[derive(Clone, Copy, Debug)]
pub struct NoiseLeft {
    /// rms, in the unit of the readings.
    pub noise_rad: f64,
    /// Of the residuals.
    pub colour: Colour,
}

/// The swings of a problem in the noise that a model leaves, where more than their own is left and hardly any of that is
/// remembered.
pub fn swings_in_what_is_left(on: &Problem, model: &Fitted) -> Option<(Vec<Swing>, ShortMemory)> {
    if on.chi_square(model.cost).left() == Left::Noise {
        return None;
    }
    let left: Vec<Vec<f64>> = (0..on.swings.len()).map(|swing_idx| residuals(on, model, swing_idx)).collect();
    let rows: Vec<&[f64]> = left.iter().map(Vec::as_slice).collect();
    let noises = noises_left(on.swings, &rows, &model.parameters.pendulum)?;
    let swings: Vec<Swing> =
        on.swings.iter().zip(noises).map(|(swing, noise)| swing.in_noise(noise.noise_rad, noise.colour)).collect();
    let told = ShortMemory { noise: on.on(&swings).noise_rad(), as_read: on.noise_rad() };
    Some((swings, told))
}

/// The noise of each swing that a pendulum's model leaves so much of, sample by sample; `None` where more of it than chance makes
/// is remembered for longer than a tenth of a period, and where a rest has told of each already.
pub fn noises_left(swings: &[Swing], left: &[&[f64]], pendulum: &Pendulum<f64>) -> Option<Vec<NoiseLeft>> {
    if swings.iter().all(|swing| swing.colour.is_some()) {
        return None;
    }
    let block_s = pace::small_period_s(pendulum) / BLOCKS_A_PERIOD;
    let means_of = |(swing, left): (&Swing, &&[f64])| {
        let n_block = (block_s * (swing.len() - 1) as f64 / swing.duration_s()) as usize;
        (n_block > 1).then(|| means(left, n_block))
    };
    let means = swings.iter().zip(left).map(means_of).collect::<Option<Vec<Vec<f64>>>>()?;
    if means.iter().map(Vec::len).sum::<usize>() < FEWEST_BLOCKS {
        return None;
    }
    let n_samples = left.iter().map(|left| left.len()).sum::<usize>() as f64;
    let as_read = swings.iter().map(|swing| swing.noise_rad.powi(2) * swing.len() as f64).sum::<f64>() / n_samples;
    let square = left.iter().map(|left| sum_of_squares(left)).sum::<f64>() / n_samples;
    let remembered = LAGS.map(|lag| covariance(&means, lag).abs()).fold(0.0, f64::max);
    let noise_of = |(swing, left): (&Swing, &&[f64])| {
        let noise_rad = ((1.0 - remembered / square) * sum_of_squares(left) / left.len() as f64).sqrt();
        NoiseLeft { noise_rad: swing.noise_rad.max(noise_rad), colour: Colour::of(left) }
    };
    (remembered < MOST_REMEMBERED * (square - as_read)).then(|| swings.iter().zip(left).map(noise_of).collect())
}

fn residuals(on: &Problem, model: &Fitted, swing_idx: usize) -> Vec<f64> {
    let (problem, point, swing) = (model.problem(on), model.point(), &on.swings[swing_idx]);
    let start = point.starts[swing_idx];
    let predicted = problem.predict(swing_idx, swing.len(), &[(&point.values, start)]).remove(0);
    swing.angles_rad.iter().zip(predicted).map(|(reading, angle)| reading - angle - start.offset_rad).collect()
}

/// Means over so many neighbours, about their own mean.
fn means(left: &[f64], n_block: usize) -> Vec<f64> {
    let means: Vec<f64> = left.chunks_exact(n_block).map(|block| block.iter().sum::<f64>() / n_block as f64).collect();
    let middle = means.iter().sum::<f64>() / means.len().max(1) as f64;
    means.iter().map(|mean| mean - middle).collect()
}

/// Mean product of the values of all rows that are so far apart.
fn covariance(rows: &[Vec<f64>], lag: usize) -> f64 {
    let pairs = rows.iter().flat_map(|row| row.iter().skip(lag).zip(row));
    let (sum, n) = pairs.fold((0.0, 0), |(sum, n), (a, b)| (sum + a * b, n + 1));
    sum / f64::from(n.max(1))
}

fn sum_of_squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{NOISE_RAD, effect, fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;
    use crate::random::Noise;
    use shared::parameters::Parameters;

    /// Of the noise that a filter of so many samples passes.
    const FILTERED_RAD: f64 = 1e-3;

    /// A swing of a truth with filtered noise, of which neighbours tell `as_read`.
    fn swing(truth: &Parameters<f64>, seconds: f64, rho: f64, as_read: f64) -> Swing {
        let (white, mut noise, mut last) = (simulated("one", truth, seconds, 1), Noise::new(2), 0.0);
        let mut filtered = || {
            last = rho * last + (1.0 - rho * rho).sqrt() * FILTERED_RAD * noise.normal();
            last
        };
        let angles_rad: Vec<f64> = white.angles_rad.iter().map(|angle| angle + filtered()).collect();
        Swing::new("one", &white.times_s, &angles_rad, as_read)
    }

    /// What is told of the noise by what the base model leaves of a swing.
    fn told_of(swing: Swing) -> Option<ShortMemory> {
        let (swings, count) = ([swing], Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        swings_in_what_is_left(&problem, &fitted(&problem, &rig())).map(|(_, told)| told)
    }

    fn told(truth: &Parameters<f64>, seconds: f64, rho: f64, as_read: f64) -> Option<ShortMemory> {
        told_of(swing(truth, seconds, rho, as_read))
    }

    fn with(name: &str, values: &[f64]) -> Parameters<f64> {
        let mut truth = rig();
        truth.set(effect(name).id, values).unwrap();
        truth
    }

    #[test]
    fn what_is_soon_forgotten_is_noise_and_what_a_law_lacks_is_none() {
        // Beside white noise of half that size; a memory of three samples, of which 65 are a period.
        let true_rad = FILTERED_RAD.hypot(NOISE_RAD);
        let plain = told(&rig(), 20.0, 0.7, 6e-4).unwrap();
        assert!((plain.noise / true_rad - 1.0).abs() < 0.1 && plain.as_read == 6e-4, "{plain:?}");
        assert!(plain.words("mrad").contains("The noise is taken as 1."), "{}", plain.words("mrad"));
        // Where the noise is known, nothing has to be told.
        assert_eq!(told(&rig(), 20.0, 0.7, true_rad), None);
        // Too few swings to tell what comes back with them.
        assert_eq!(told(&rig(), 5.0, 0.7, 6e-4), None);
        // What a rest has told stands.
        let colour = Colour { independent_share: 0.3, n_independent: 100.0 };
        assert_eq!(told_of(swing(&rig(), 20.0, 0.7, 6e-4).in_noise(6e-4, colour)), None);
        // As slow as the swing: it may be anything.
        assert_eq!(told(&rig(), 20.0, 0.98, 6e-4), None);
    }

    #[test]
    fn a_law_that_is_missing_is_remembered_beside_white_noise_and_beside_filtered() {
        let true_rad = FILTERED_RAD.hypot(NOISE_RAD);
        for (name, values) in [("quadratic-drag", [1e-4, 0.0]), ("torsional-spring", [2e-3, 0.3])] {
            let values = &values[..effect(name).parameters.len()];
            assert_eq!(told(&with(name, values), 20.0, 0.7, 6e-4), None, "{name}");
            assert_eq!(told(&with(name, values), 20.0, 0.0, true_rad), None, "{name}");
        }
    }
}
