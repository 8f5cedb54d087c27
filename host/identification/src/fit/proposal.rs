//! Where the surfaces of one design say that the truth lies.

use super::runs::Run;
use super::solve::solve_damped;
use crate::rsm::{Composite, Desirability, Search, Surface, optimum};
use nalgebra::{DMatrix, DVector};

/// The search for the optimum of one stage; coarse, because the simulation decides.
const SEARCH: Search = Search { n_samples: 400, n_starts: 6, smallest_edge: 1e-4, seed: 1 };

/// Responses of the composite desirability: mseA, mseV, ePM, eNM. eZC is the sum of ePM and eNM and would count them
/// twice.
const JUDGED: usize = 4;

/// Points worth a simulation, in coded units: the most desirable one, and the least predicted error in angle.
pub fn proposals(surfaces: &[Surface], runs: &[Run]) -> Vec<Vec<f64>> {
    let judged = &surfaces[..surfaces.len().min(JUDGED)];
    let goals: Result<Vec<Desirability>, _> = (0..judged.len())
        .map(|k| {
            let worst = runs.iter().map(|run| run.responses.values()[k].abs()).fold(1e-12, f64::max);
            if k < 2 { Desirability::minimise(0.0, worst) } else { Desirability::target(-worst, 0.0, worst) }
        })
        .collect();
    let all = goals.and_then(Composite::new).ok().and_then(|goal| optimum(judged, &goal, &SEARCH).ok());
    all.map(|optimum| optimum.coded).into_iter().chain(least_error(&surfaces[0])).collect()
}

/// By how much the surface of mseA says that the error falls from a point of the box to its best one. A parabola may
/// fall below zero, a mean square may not.
pub fn promised_gain(error: &Surface, from_coded: &[f64]) -> f64 {
    let predicted = |coded: &[f64]| error.predict(coded).max(0.0);
    least_error(error).map_or(0.0, |best| predicted(from_coded) - predicted(&best))
}

/// The point of the box with the least predicted error: damped Newton steps on the quadratic, held in the box.
fn least_error(surface: &Surface) -> Option<Vec<f64>> {
    let n_factors = surface.factors().len();
    let curvature = curvature(surface);
    let mut coded = vec![0.0; n_factors];
    let mut free = vec![true; n_factors];
    for _ in 0..=n_factors {
        let gradient = -DVector::from_vec(surface.gradient(&coded));
        let step = solve_damped(&positive(&curvature), &gradient, 1e-9, &free);
        let reach = |j: usize| if step[j] == 0.0 { f64::INFINITY } else { (step[j].signum() - coded[j]) / step[j] };
        let (blocking, share) =
            (0..n_factors).map(|j| (j, reach(j))).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0));
        let share = share.clamp(0.0, 1.0);
        (0..n_factors).for_each(|j| coded[j] = (coded[j] + share * step[j]).clamp(-1.0, 1.0));
        if share >= 1.0 {
            break;
        }
        free[blocking] = false;
    }
    coded.iter().all(|c| c.is_finite()).then_some(coded)
}

/// Second derivatives in coded units, from differences of the gradient (which is linear).
pub fn curvature(surface: &Surface) -> DMatrix<f64> {
    let n_factors = surface.factors().len();
    let base = surface.gradient(&vec![0.0; n_factors]);
    DMatrix::from_fn(n_factors, n_factors, |i, j| {
        let mut coded = vec![0.0; n_factors];
        coded[j] = 1.0;
        surface.gradient(&coded)[i] - base[i]
    })
}

/// The nearest matrix that curves upwards everywhere: eigenvalues below a small share of the largest are raised.
pub fn positive(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let mut eigen = matrix.clone().symmetric_eigen();
    let floor = 1e-6 * eigen.eigenvalues.amax().max(1e-300);
    eigen.eigenvalues.iter_mut().for_each(|value| *value = value.max(floor));
    eigen.recompose()
}
