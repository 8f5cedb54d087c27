//! The best point of the coded box: the search for the largest composite desirability.
//!
//! Desirability has kinks where a response crosses its target and is flat where one is unacceptable, so no derivatives
//! are used. Random points cover the box, and Nelder–Mead climbs from the best of them. Everything random comes from a
//! seed, so results repeat exactly.

use super::coding::natural_point;
use super::desirability::Composite;
use super::nelder_mead::{Candidate, climb};
use super::random::Random;
use super::surface::Surface;
use super::term::Term;
use crate::cores::on_all_cores;
use serde::Serialize;

/// A coded value this close to ±1 lies on the face.
const FACE_TOLERANCE: f64 = 1e-6;

/// How thoroughly to search.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// Random points to choose starts from.
    pub n_samples: usize,
    /// Starts, the best of the random points.
    pub n_starts: usize,
    /// Edge of the smallest simplex, in coded units, at which a climb ends; above 0.
    pub smallest_edge: f64,
    /// Equal seeds give equal results.
    pub seed: u64,
}

impl Default for Search {
    /// Finds the paper's optimum to 1e-6 from any seed in a fraction of a second.
    fn default() -> Self {
        Self { n_samples: 4000, n_starts: 24, smallest_edge: 1e-8, seed: 1 }
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
    #[error("the search needs at least one sample, one start, and a smallest edge above 0")]
    Search,
}

/// Searches the coded box of the surfaces for the largest composite desirability.
pub fn optimum(surfaces: &[Surface], composite: &Composite, search: &Search) -> Result<Optimum, OptimumError> {
    check(surfaces, composite, search)?;
    let factors = surfaces[0].factors();
    let together = Together::new(surfaces);
    let merit = |point: &[f64]| {
        let mut responses = [0.0; MOST_AT_ONCE];
        match responses.get_mut(..surfaces.len()) {
            Some(responses) => together.predict(point, responses),
            None => return composite.merit(&together.predicted(point)),
        }
        composite.merit(&responses[..surfaces.len()])
    };
    let coded = best_point(factors.len(), search, merit);
    let responses = together.predicted(&coded);
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

/// So many responses need no memory of their own at every point of the search: the paper has five.
const MOST_AT_ONCE: usize = 8;

/// Surfaces of one design, whose terms are worked out once a point.
struct Together<'a> {
    terms: &'a [Term],
    /// A coefficient a surface, term by term.
    coefficients: Vec<f64>,
}

impl<'a> Together<'a> {
    fn new(surfaces: &'a [Surface]) -> Self {
        let terms = surfaces[0].terms();
        let of_term = |term: usize| surfaces.iter().map(move |surface| surface.coefficients()[term]);
        Self { terms, coefficients: (0..terms.len()).flat_map(of_term).collect() }
    }

    fn n_surfaces(&self) -> usize {
        self.coefficients.len() / self.terms.len()
    }

    fn predicted(&self, point: &[f64]) -> Vec<f64> {
        let mut responses = vec![0.0; self.n_surfaces()];
        self.predict(point, &mut responses);
        responses
    }

    fn predict(&self, point: &[f64], responses: &mut [f64]) {
        for (term, coefficients) in self.terms.iter().zip(self.coefficients.chunks_exact(responses.len())) {
            let value = term.value(point);
            responses.iter_mut().zip(coefficients).for_each(|(sum, coefficient)| *sum += coefficient * value);
        }
    }
}

fn check(surfaces: &[Surface], composite: &Composite, search: &Search) -> Result<(), OptimumError> {
    if surfaces.len() != composite.n_responses() {
        return Err(OptimumError::GoalCount { n_surfaces: surfaces.len(), n_goals: composite.n_responses() });
    }
    if surfaces.iter().any(|surface| surface.factors() != surfaces[0].factors()) {
        return Err(OptimumError::DifferentFactors);
    }
    let edge_is_positive = search.smallest_edge > 0.0;
    if search.n_samples == 0 || search.n_starts == 0 || !edge_is_positive {
        return Err(OptimumError::Search);
    }
    Ok(())
}

/// The best of many climbs: one from the centre and one from each of the best random points.
fn best_point(n_factors: usize, search: &Search, merit: impl Fn(&[f64]) -> f64 + Sync) -> Vec<f64> {
    let mut random = Random::new(search.seed);
    let judged = |point: Vec<f64>| Candidate { merit: merit(&point), point };
    let mut starts: Vec<Candidate> = (0..search.n_samples).map(|_| judged(random.point_in_box(n_factors))).collect();
    starts.sort_by(|a, b| b.merit.total_cmp(&a.merit));
    starts.truncate(search.n_starts);
    starts.push(judged(vec![0.0; n_factors]));
    let climbed = |(climb_idx, start)| {
        let mut random = Random::new(search.seed.wrapping_add(1 + climb_idx as u64));
        climb(start, search.smallest_edge, &mut random, judged)
    };
    let reached: Vec<Candidate> = on_all_cores(starts.into_iter().enumerate(), climbed);
    let best = reached.into_iter().max_by(|a, b| a.merit.total_cmp(&b.merit));
    best.map_or_else(|| vec![0.0; n_factors], |best| best.point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::design::Design;
    use crate::rsm::desirability::Desirability;
    use proptest::prelude::*;

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

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]
        #[test]
        fn the_crossing_of_five_kinked_ridges_is_found(
            seed in 0u64..1000,
            slopes in prop::collection::vec(-1.0..1.0, 25),
            sharpness in prop::collection::vec(0.0..2.0, 5),
        ) {
            let factors: Vec<Factor> = (0..5).map(|idx| Factor::new(format!("x{idx}"), 0.0, 1.0).unwrap()).collect();
            let design = Design::face_centred(factors, 1).unwrap();
            let crossing = [0.1, -0.8, 0.5, 0.3, -0.2];
            let mut surfaces = Vec::new();
            let mut goals = Vec::new();
            for (slopes, sharpness) in slopes.chunks(5).zip(&sharpness) {
                let height = |x: &Vec<f64>| (0..5).map(|idx| slopes[idx] * (x[idx] - crossing[idx])).sum::<f64>();
                let responses: Vec<f64> = design.coded_runs().iter().map(height).collect();
                surfaces.push(Surface::fit(&design, &responses).unwrap());
                let limit = 10.0 * 10f64.powf(-sharpness);
                goals.push(goal(-limit, 0.0, limit));
            }
            let search = Search { seed, ..Search::default() };
            let best = optimum(&surfaces, &Composite::new(goals).unwrap(), &search).unwrap();
            prop_assert!(best.composite > 0.999, "{}", best.composite);
        }
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
    fn more_responses_than_usual_change_nothing_but_the_time() {
        let bowl = || surface_of(|x| (x[0] - 0.3).powi(2) + 2.0 * (x[1] + 0.6).powi(2));
        let best = |n_surfaces: usize| {
            let surfaces: Vec<Surface> = (0..n_surfaces).map(|_| bowl()).collect();
            let goals = (0..n_surfaces).map(|_| Desirability::minimise(0.0, 10.0).unwrap()).collect();
            optimum(&surfaces, &Composite::new(goals).unwrap(), &Search::default()).unwrap()
        };
        let (few, many) = (best(1), best(MOST_AT_ONCE + 1));
        assert_eq!(
            (many.responses.len(), &many.responses[1..]),
            (MOST_AT_ONCE + 1, &[many.responses[0]; MOST_AT_ONCE][..])
        );
        assert!(few.coded.iter().zip(&many.coded).all(|(few, many)| (few - many).abs() < 1e-6), "{few:?} {many:?}");
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
        for smallest_edge in [0.0, -1.0, f64::NAN] {
            let search = Search { smallest_edge, ..Search::default() };
            assert_eq!(optimum(&surfaces, &one, &search), Err(OptimumError::Search));
        }
    }
}
