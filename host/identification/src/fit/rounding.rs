//! What rounding to the steps of a sensor does to the numbers of a fit.
//!
//! Where noise is well below a step, the errors of rounding are no noise but a function of the angle: near the turning
//! points, where the pendulum is slow, they are alike in many samples, and come again in the next swing, which turns nearly
//! there. A rounding error is a saw tooth of the angle, Δ/π·Σ (−1)ᵏ/k·sin(2πkθ/Δ); white noise of the deviation σ, which is
//! there before rounding, leaves exp(−2π²k²σ²/Δ²) of each harmonic in the mean. Where the grid lies, as far as a fit
//! knows, is as likely to be anywhere, and the mean over that is in closed form: each harmonic adds to the covariance of
//! Jᵀe the products of Jᵀcos(2πkθ/Δ) and of Jᵀsin(2πkθ/Δ), times Δ²/(2π²k²)·exp(−4π²k²σ²/Δ²). Readings lie on the grid,
//! so the residuals are θ but for whole steps. Of viscous swings without noise, numbers have variances within
//! 5 % of those that a thousand shifts of the grid give, once what higher harmonics hold is counted as white.
//! Source: B. Widrow, I. Kollár, Quantization Noise (Cambridge 2008), chapters 4 and 9.

use super::linear::{Linear, SwingLinear, dot};
use super::problem::Problem;
use super::solve::Factor;
use crate::recording::noise::smallest_step;
use crate::swing::Swing;
use nalgebra::DMatrix;
use std::f64::consts::{PI, TAU};

/// Harmonics of the saw tooth: what is left of its variance, 6 %, is as good as white.
const HARMONICS: usize = 10;

/// Harmonics that hold less than this share of the variance of what is left do nothing.
const NEGLIGIBLE: f64 = 1e-6;

/// What rounding does to the numbers.
pub(super) struct Rounding {
    /// The covariance that it causes; unknowns first, then the starts.
    pub(super) matrix: DMatrix<f64>,
    /// Its share of the variance of the residuals.
    pub(super) share: f64,
}

/// Of linearised swings; `None` where no sensor has steps that its noise does not hide.
pub(super) fn rounding(on: &Problem, linear: &Linear) -> Option<Rounding> {
    let of_swing = |swing_idx: usize, swing: &SwingLinear| of_swing(&on.swings[swing_idx], swing);
    let swings = linear.each(of_swing);
    if swings.iter().all(|swing| swing.scores.is_empty()) {
        return None;
    }
    let equations = &linear.equations;
    let factor = Factor::new(&equations.normal.dense(), 0.0, |_| true);
    let mut matrix = DMatrix::zeros(equations.gradient.len(), equations.gradient.len());
    for k in 0..2 * HARMONICS {
        // Swings of one sensor are rounded by one grid.
        let moved = factor.solve(&linear.together(swings.iter().map(|swing| swing.scores.get(k))));
        matrix += &moved * moved.transpose();
    }
    let square: f64 = swings.iter().map(|swing| swing.square).sum();
    Some(Rounding { matrix, share: (square / equations.cost).min(1.0) })
}

/// Has a sensor steps that its noise does not hide?
pub(super) fn has_open_steps(on: &Problem, linear: &Linear) -> bool {
    let of_swing = |swing_idx: usize, swing: &SwingLinear| Grid::of(&on.swings[swing_idx], &swing.residuals);
    linear.each(of_swing).iter().any(Option::is_some)
}

/// What rounding does to one swing.
#[derive(Default)]
struct Rounded {
    /// Jᵀe of sine and cosine of each harmonic; none where it is hidden.
    scores: Vec<Vec<f64>>,
    /// eᵀe.
    square: f64,
}

fn of_swing(swing: &Swing, linear: &SwingLinear) -> Rounded {
    let Some(grid) = Grid::of(swing, &linear.residuals) else { return Rounded::default() };
    let score = |wave: Vec<f64>| linear.columns.iter().map(|column| dot(column, &wave)).collect::<Vec<f64>>();
    let scores = grid.waves(&linear.residuals).map(score).collect();
    let square = linear.residuals.len() as f64 * (1..=HARMONICS).map(|k| grid.variance(k)).sum::<f64>();
    Rounded { scores, square }
}

/// Grid of a sensor that its noise does not hide.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    step: f64,
    /// Variance that was there before rounding.
    white: f64,
}

impl Grid {
    /// Of a swing and what a model leaves of it; `None` where there are none, or noise hides them.
    pub(super) fn of(swing: &Swing, residuals: &[f64]) -> Option<Self> {
        let step = smallest_step(&swing.angles_rad)?;
        let left = dot(residuals, residuals) / residuals.len().max(1) as f64;
        // Both hold the noise and the rounding, and either may hold more.
        let white = (left.min(swing.noise_rad.powi(2)) - step * step / 12.0).max(0.0);
        let grid = Self { step, white };
        (grid.variance(1) >= NEGLIGIBLE * left).then_some(grid)
    }

    /// Variance that a harmonic of the saw tooth has.
    fn variance(&self, k: usize) -> f64 {
        weight(k, self.step, self.white)
    }

    /// Sines and cosines of all harmonics, of readings that leave these residuals: the sum of their squares is the mean of
    /// the square of the error over all places of the grid, sample by sample and for any sum of samples.
    pub(super) fn waves(self, residuals: &[f64]) -> impl Iterator<Item = Vec<f64>> {
        (1..=HARMONICS).flat_map(move |k| {
            let (size, turn) = (self.variance(k).sqrt(), TAU * k as f64 / self.step);
            [f64::sin, f64::cos].map(|wave: fn(f64) -> f64| {
                residuals.iter().map(|residual| size * wave(turn * residual)).collect::<Vec<f64>>()
            })
        })
    }

    /// The errors that rounding would make of the same angles on grids that lie elsewhere, evenly spread.
    pub(super) fn errors_elsewhere(self, residuals: &[f64]) -> Vec<Vec<f64>> {
        const FINE: usize = 16;
        let n = N_PLACES * FINE;
        let phase = |i: usize| TAU * i as f64 / n as f64;
        let error = |i| (1..=HARMONICS).map(|k| (2.0 * self.variance(k)).sqrt() * (k as f64 * phase(i)).sin()).sum();
        let saw_tooth: Vec<f64> = (0..n).map(error).collect();
        let place = |residual: &f64| ((residual / self.step).rem_euclid(1.0) * n as f64) as usize;
        let places: Vec<usize> = residuals.iter().map(place).collect();
        let shifted = |shift: usize| places.iter().map(|place| saw_tooth[(place + shift * FINE) % n]).collect();
        (0..N_PLACES).map(shifted).collect()
    }
}

/// Places of the grid that are tried, of which the extremes are nearly those of all.
const N_PLACES: usize = 16;

/// Variance that a harmonic of the saw tooth has where a `white` one was there before rounding, rad².
fn weight(k: usize, step: f64, white: f64) -> f64 {
    let k = k as f64;
    0.5 * (step / (PI * k)).powi(2) * (-white * (TAU * k / step).powi(2)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::covariance::{covariance, with_model_error};
    use crate::fit::linear::{Steps, linearise};
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;
    use crate::fit::tests::{PENDULUM, RELEASE_RAD, at_rest, noise, times_s, viscous_problem, viscous_rad};
    use crate::swing::Window;

    const STEP_RAD: f64 = RELEASE_RAD / 300.0;

    /// Shifts of the grid that are tried, and numbers and starts of the fit.
    const N_SHIFTS: usize = 100;
    const N_NUMBERS: usize = 5;

    type Numbers = [f64; N_NUMBERS];

    /// Means over all shifts of the grid.
    #[derive(Default)]
    struct Means {
        /// Squares of how far the numbers come out off, to first order.
        squares: Numbers,
        /// Variances by rounding alone.
        by_rounding: Numbers,
        /// Variances that are claimed.
        claimed: Numbers,
        /// Variances by white noise alone.
        white: Numbers,
    }

    /// Of a viscous swing that is read in steps, with noise in steps and of so much in all.
    fn over_shifts(noise_steps: &[f64], noise_rad: f64) -> Means {
        const VISCOUS: f64 = 4e-5;
        let (times_s, count) = (times_s(20.0), Tally::default());
        let true_rad: Vec<f64> = times_s.iter().map(|t| viscous_rad(VISCOUS, PENDULUM.inertia_kg_m2, *t)).collect();
        let swings = [Swing::new("one", &times_s, &true_rad, noise_rad)];
        let problem = viscous_problem(&swings, VISCOUS, &count);
        let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
        let known = linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point));
        let columns = known.each(|_, swing| swing.columns.clone()).remove(0);
        let mut means = Means::default();
        for shift in (0..N_SHIFTS).map(|i| (i as f64 + 0.5) / N_SHIFTS as f64) {
            let rounded =
                |(angle, noise): (&f64, &f64)| STEP_RAD * ((angle / STEP_RAD + noise + shift).round() - shift);
            let readings: Vec<f64> = true_rad.iter().zip(noise_steps).map(rounded).collect();
            // The closed form takes sin θ for θ; a swing that it describes has these residuals.
            let residuals = readings.iter().zip(&true_rad).map(|(reading, angle)| reading - angle).collect();
            let linear = Linear::of(2, vec![SwingLinear { residuals, columns: columns.clone() }]);
            let swings = [Swing::new("one", &times_s, &readings, noise_rad)];
            add(&mut means, &problem.on(&swings), &linear, &point);
        }
        means
    }

    fn add(means: &mut Means, on: &Problem, linear: &Linear, point: &Point) {
        let equations = &linear.equations;
        let errors = Factor::new(&equations.normal.dense(), 0.0, |_| true).solve(&equations.gradient);
        let claimed = with_model_error(on, linear, &point.starts).unwrap().matrix;
        let white = covariance(linear).unwrap().matrix;
        let rounding = rounding(on, linear);
        for j in 0..N_NUMBERS {
            means.squares[j] += errors[j].powi(2) / N_SHIFTS as f64;
            means.by_rounding[j] += rounding.as_ref().map_or(0.0, |it| it.matrix[(j, j)]) / N_SHIFTS as f64;
            means.claimed[j] += claimed[(j, j)] / N_SHIFTS as f64;
            means.white[j] += white[(j, j)] / N_SHIFTS as f64;
        }
    }

    #[test]
    fn numbers_of_a_quiet_sensor_scatter_as_claimed_when_its_grid_of_steps_is_shifted() {
        let quiet = vec![0.0; times_s(20.0).len()];
        let Means { squares, by_rounding, claimed, white } = over_shifts(&quiet, STEP_RAD / 12.0_f64.sqrt());
        for j in 0..N_NUMBERS {
            // What ten harmonics lack is a tenth of the offset's variance, in which the lower ones cancel.
            assert!((by_rounding[j] / squares[j] - 1.0).abs() < 0.12, "{j}: {squares:?} {by_rounding:?}");
            // Clusters may say more.
            assert!(claimed[j] > 0.9 * squares[j], "{j}: {squares:?} {claimed:?}");
        }
        // Taken for white, the errors would leave viscous friction with 0.6 of its scatter.
        assert!(white[0] < 0.5 * squares[0], "{squares:?} {white:?}");
    }

    #[test]
    fn a_swing_that_was_recorded_twice_on_one_grid_is_rounded_alike_and_no_surer() {
        let times_s = times_s(20.0);
        let angle = |t: &f64| viscous_rad(4e-5, PENDULUM.inertia_kg_m2, *t);
        let steps = |t: &f64| STEP_RAD * (angle(t) / STEP_RAD).round();
        let one = Swing::new("one", &times_s, &times_s.iter().map(steps).collect::<Vec<f64>>(), 0.0);
        let variances = |n_swings: usize| {
            let (swings, count) = (vec![one.clone(); n_swings], Tally::default());
            let problem = viscous_problem(&swings, 4e-5, &count);
            let starts = at_rest(RELEASE_RAD).repeat(n_swings);
            let point = Point { values: problem.template_values(), starts };
            let linear = linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point));
            rounding(&problem, &linear).unwrap().matrix.diagonal()
        };
        let (one, two) = (variances(1), variances(2));
        assert_eq!(two.len(), 8);
        for (j, variance) in two.iter().enumerate() {
            let of_one = one[if j < N_NUMBERS { j } else { j - 3 }];
            assert!((variance / of_one - 1.0).abs() < 1e-6, "{one} {two}");
        }
    }

    #[test]
    fn steps_below_the_noise_leave_all_variances_as_they_are() {
        // Uniform over four steps, which hides any grid.
        let four_steps: Vec<f64> = noise(times_s(20.0).len()).into_iter().map(|share| 4.0 * share).collect();
        let Means { by_rounding, claimed, white, .. } = over_shifts(&four_steps, STEP_RAD * (17.0_f64 / 12.0).sqrt());
        for j in 0..N_NUMBERS {
            assert_eq!(by_rounding[j], 0.0);
            assert!((claimed[j] / white[j] - 1.0).abs() < 1e-3, "{j}: {claimed:?} {white:?}");
        }
    }

    #[test]
    fn all_harmonics_hold_the_variance_of_rounding_and_noise_of_half_a_step_hides_them() {
        let sum = |white: f64| (1..100_000).map(|k| weight(k, 2.0, white)).sum::<f64>();
        assert!((sum(0.0) / (4.0 / 12.0) - 1.0).abs() < 1e-4);
        assert!(sum(1.0) < 1e-4 * sum(0.0));
    }

    #[test]
    fn the_mean_of_what_noise_and_rounding_make_of_an_angle_has_the_variance_of_the_harmonics() {
        let (sigma, n) = (0.2, 400);
        let mean_error = |angle: f64| {
            let at = |i: i32| f64::from(i) * 0.005;
            let density = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
            let (mut sum, mut total) = (0.0, 0.0);
            for x in (-300..=300).map(at) {
                sum += density(x) * ((angle + x).round() - angle);
                total += density(x);
            }
            sum / total
        };
        let square = (0..n).map(|i| mean_error((f64::from(i) + 0.5) / f64::from(n)).powi(2)).sum::<f64>();
        let harmonics: f64 = (1..=HARMONICS).map(|k| weight(k, 1.0, sigma * sigma)).sum();
        assert!((square / f64::from(n) / harmonics - 1.0).abs() < 0.01, "{square} {harmonics}");
    }
}
