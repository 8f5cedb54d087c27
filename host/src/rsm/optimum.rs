//! The best point of the coded box: the search for the largest composite desirability.
//!
//! Desirability has kinks and flat regions, so no derivatives are used. Random points cover the box; from the best of
//! them a direct search polls along randomly turned axes, with a step that grows with success and shrinks with failure.
//! Random turns are what lets it follow a ridge. Everything random comes from a seed, so results repeat exactly.
//! Source: C. Audet, J. E. Dennis, SIAM J. Optim. 17 (2006) 188 (mesh adaptive direct search, here without the mesh).

use super::coding::natural_point;
use super::desirability::Composite;
use super::surface::Surface;
use serde::Serialize;

/// Polls, each along newly turned axes, that must fail before the step shrinks.
const PATIENCE: usize = 6;
/// The first step, half the way from the centre to a face.
const FIRST_STEP: f64 = 0.5;
/// A coded value this close to ±1 lies on the face.
const FACE_TOLERANCE: f64 = 1e-6;

/// How thoroughly to search.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Random points to choose starts from.
    pub n_samples: usize,
    /// Starts, the best of the random points.
    pub n_starts: usize,
    /// The step, in coded units, at which a search ends; above 0.
    pub smallest_step: f64,
    /// Equal seeds give equal results.
    pub seed: u64,
}

impl Default for Search {
    /// Finds the paper's optimum to 1e-6 from any seed in a fraction of a second.
    fn default() -> Self {
        Self { n_samples: 4000, n_starts: 24, smallest_step: 1e-8, seed: 1 }
    }
}

/// The best point and what is expected there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Optimum {
    /// The point in coded units, −1 to +1, one value a factor.
    pub coded: Vec<f64>,
    /// The point in natural units.
    pub natural: Vec<f64>,
    /// The surfaces' predictions, one a response.
    pub responses: Vec<f64>,
    /// Each response's desirability, 0 to 1.
    pub desirabilities: Vec<f64>,
    /// The composite, 0 to 1; 0 if no point of the box is acceptable in every response: then this is the point that
    /// misses the limits least.
    pub composite: f64,
    /// Names of the factors that stand on a face of the box: their true optimum may lie outside.
    pub at_bound: Vec<String>,
}

/// Why there is nothing to search.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OptimumError {
    /// Not one goal a surface.
    #[error("{n_surfaces} surfaces but {n_goals} desirabilities; give one desirability a surface")]
    GoalCount {
        /// Surfaces given.
        n_surfaces: usize,
        /// Desirabilities given.
        n_goals: usize,
    },
    /// The surfaces belong to different boxes.
    #[error("the surfaces differ in their factors or ranges; fit all responses to one design")]
    DifferentFactors,
    /// The search could never begin or never end.
    #[error("the search needs at least one sample, one start, and a smallest step above 0")]
    Search,
}

/// Searches the coded box of the surfaces for the largest composite desirability.
pub fn optimum(surfaces: &[Surface], composite: &Composite, search: &Search) -> Result<Optimum, OptimumError> {
    check(surfaces, composite, search)?;
    let predict = |point: &[f64]| -> Vec<f64> { surfaces.iter().map(|surface| surface.predict(point)).collect() };
    let factors = surfaces[0].factors();
    let coded = best_point(factors.len(), search, |point| composite.merit(&predict(point)));
    let responses = predict(&coded);
    let on_face = |value: f64| 1.0 - value.abs() < FACE_TOLERANCE;
    let at_bound = factors.iter().zip(&coded).filter(|&(_, &value)| on_face(value));
    Ok(Optimum {
        natural: natural_point(factors, &coded),
        desirabilities: composite.each(&responses),
        composite: composite.of(&responses),
        at_bound: at_bound.map(|(factor, _)| factor.name().to_string()).collect(),
        coded,
        responses,
    })
}

fn check(surfaces: &[Surface], composite: &Composite, search: &Search) -> Result<(), OptimumError> {
    if surfaces.len() != composite.n_responses() {
        return Err(OptimumError::GoalCount { n_surfaces: surfaces.len(), n_goals: composite.n_responses() });
    }
    if surfaces.iter().any(|surface| surface.factors() != surfaces[0].factors()) {
        return Err(OptimumError::DifferentFactors);
    }
    let step_is_positive = search.smallest_step > 0.0;
    if search.n_samples == 0 || search.n_starts == 0 || !step_is_positive {
        return Err(OptimumError::Search);
    }
    Ok(())
}

/// A point with its merit.
#[derive(Clone)]
struct Candidate {
    point: Vec<f64>,
    merit: f64,
}

fn best_point(n_factors: usize, search: &Search, merit: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut random = Random(search.seed);
    let judged = |point: Vec<f64>| Candidate { merit: merit(&point), point };
    let mut candidates: Vec<Candidate> =
        (0..search.n_samples).map(|_| judged(random.point_in_box(n_factors))).collect();
    candidates.push(judged(vec![0.0; n_factors]));
    candidates.sort_by(|a, b| b.merit.total_cmp(&a.merit));
    candidates.truncate(search.n_starts);
    let climbed = candidates.into_iter().map(|start| climb(start, search.smallest_step, &mut random, &judged));
    climbed
        .reduce(|best, next| if next.merit > best.merit { next } else { best })
        .map_or(vec![0.0; n_factors], |c| c.point)
}

/// Direct search from one start to a point that no poll improves.
fn climb(
    start: Candidate,
    smallest_step: f64,
    random: &mut Random,
    judged: impl Fn(Vec<f64>) -> Candidate,
) -> Candidate {
    let (mut best, mut step, mut n_failed) = (start, FIRST_STEP, 0);
    while step > smallest_step {
        let next = polled(&best.point, step, random, &judged);
        if next.merit > best.merit {
            (best, step, n_failed) = (next, (2.0 * step).min(FIRST_STEP), 0);
        } else {
            n_failed += 1;
            if n_failed == PATIENCE {
                (step, n_failed) = (0.5 * step, 0);
            }
        }
    }
    best
}

/// The best neighbour, one step either way along each of the turned axes, within the box.
fn polled(centre: &[f64], step: f64, random: &mut Random, judged: impl Fn(Vec<f64>) -> Candidate) -> Candidate {
    let axes = random.turned_axes(centre.len());
    let steps = axes.iter().flat_map(|axis| [(axis, step), (axis, -step)]);
    let moved = |(axis, step): (&Vec<f64>, f64)| {
        centre.iter().zip(axis).map(|(value, part)| (value + step * part).clamp(-1.0, 1.0)).collect()
    };
    let neighbours = steps.map(|along| judged(moved(along)));
    neighbours.max_by(|a, b| a.merit.total_cmp(&b.merit)).expect("a box has at least one axis")
}

/// SplitMix64: small, repeatable, and good enough to scatter points.
/// Source: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014.
struct Random(u64);

impl Random {
    /// Uniform, −1 to +1.
    fn coded(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn point_in_box(&mut self, n_factors: usize) -> Vec<f64> {
        (0..n_factors).map(|_| self.coded()).collect()
    }

    /// Orthonormal axes: the box's own, mirrored at a random plane (Householder).
    fn turned_axes(&mut self, n_factors: usize) -> Vec<Vec<f64>> {
        let normal = self.point_in_box(n_factors);
        let squared_length: f64 = normal.iter().map(|part| part * part).sum::<f64>().max(f64::MIN_POSITIVE);
        let mirrored = |row: usize, column: usize| {
            let own = if row == column { 1.0 } else { 0.0 };
            own - 2.0 * normal[row] * normal[column] / squared_length
        };
        (0..n_factors).map(|row| (0..n_factors).map(|column| mirrored(row, column)).collect()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::design::Design;
    use crate::rsm::desirability::Desirability;

    fn surface_of(height: impl Fn(&[f64]) -> f64) -> Surface {
        let factors = ["a", "b"].map(|name| Factor::new(name, 10.0, 20.0).unwrap());
        let design = Design::face_centred(factors.to_vec(), 1).unwrap();
        let responses: Vec<f64> = design.coded_runs().iter().map(|run| height(run)).collect();
        Surface::fit(&design, &responses).unwrap()
    }

    fn goal(low: f64, target: f64, high: f64) -> Desirability {
        Desirability::target(low, target, high).unwrap()
    }

    #[test]
    fn a_bowl_is_left_at_its_lowest_point() {
        let bowl = surface_of(|x| (x[0] - 0.3).powi(2) + 2.0 * (x[1] + 0.6).powi(2));
        let composite = Composite::new(vec![Desirability::minimise(0.0, 10.0).unwrap()]).unwrap();
        let best = optimum(&[bowl], &composite, &Search::default()).unwrap();
        // The height is flat at the bottom: rounding of 1e-16 is a distance of 1e-8.
        assert!((best.coded[0] - 0.3).abs() < 1e-6 && (best.coded[1] + 0.6).abs() < 1e-6);
        assert!((best.natural[0] - 16.5).abs() < 1e-5);
        assert!(best.at_bound.is_empty());
    }

    #[test]
    fn a_slope_is_followed_to_the_face_and_the_face_is_named() {
        let slope = surface_of(|x| x[0] + (x[1] - 0.2).powi(2));
        let composite = Composite::new(vec![Desirability::minimise(-5.0, 10.0).unwrap()]).unwrap();
        let best = optimum(&[slope], &composite, &Search::default()).unwrap();
        assert_eq!(best.at_bound, ["a"]);
        assert_eq!(best.natural[0], 10.0);
    }

    #[test]
    fn the_crossing_of_two_kinked_ridges_is_found() {
        let surfaces = [surface_of(|x| x[0] + x[1] - 0.5), surface_of(|x| x[0] - 3.0 * x[1] + 0.7)];
        let composite = Composite::new(vec![goal(-9.0, 0.0, 9.0), goal(-0.1, 0.0, 0.1)]).unwrap();
        let best = optimum(&surfaces, &composite, &Search::default()).unwrap();
        assert!((best.coded[0] - 0.2).abs() < 1e-6 && (best.coded[1] - 0.3).abs() < 1e-6, "{:?}", best.coded);
    }

    #[test]
    fn a_small_acceptable_region_is_found_across_the_flat() {
        let bowl = surface_of(|x| (x[0] - 0.77).powi(2) + (x[1] - 0.77).powi(2));
        let composite = Composite::new(vec![goal(-1e-6, 0.0, 1e-6)]).unwrap();
        assert!(optimum(&[bowl], &composite, &Search::default()).unwrap().composite > 0.999);
    }

    #[test]
    fn where_nothing_is_acceptable_the_least_miss_is_reported_as_nothing() {
        let bowl = surface_of(|x| 5.0 + (x[0] - 0.5).powi(2) + x[1] * x[1]);
        let composite = Composite::new(vec![goal(-1.0, 0.0, 1.0)]).unwrap();
        let best = optimum(&[bowl], &composite, &Search::default()).unwrap();
        assert_eq!(best.composite, 0.0);
        assert!((best.coded[0] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn equal_seeds_give_equal_results() {
        let bowl = [surface_of(|x| x[0] * x[1])];
        let composite = Composite::new(vec![goal(-1.0, 0.5, 1.0)]).unwrap();
        let run = || optimum(&bowl, &composite, &Search::default()).unwrap();
        assert_eq!(run(), run());
    }

    #[test]
    fn mismatched_goals_and_endless_searches_are_refused() {
        let surfaces = [surface_of(|x| x[0])];
        let two = Composite::new(vec![goal(-1.0, 0.0, 1.0), goal(-1.0, 0.0, 1.0)]).unwrap();
        let refused = optimum(&surfaces, &two, &Search::default()).unwrap_err();
        assert_eq!(refused, OptimumError::GoalCount { n_surfaces: 1, n_goals: 2 });
        let one = Composite::new(vec![goal(-1.0, 0.0, 1.0)]).unwrap();
        for smallest_step in [0.0, -1.0, f64::NAN] {
            let search = Search { smallest_step, ..Search::default() };
            assert_eq!(optimum(&surfaces, &one, &search), Err(OptimumError::Search));
        }
    }
}
