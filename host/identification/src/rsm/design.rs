//! Designs: which runs to make. Face-centred central composites for two to six factors, or runs given by the user.
//!
//! A face-centred composite has a two-level part, two runs on opposite faces for each factor, and centre runs, so every
//! factor takes only the levels −1, 0, +1. Up to four factors the two-level part is complete; five factors use the half
//! with E = ABCD (resolution V), six the half with F = ABCDE (resolution VI): no term of the quadratic is confounded.
//! Source: G. E. P. Box, K. B. Wilson, J. R. Stat. Soc. B 13 (1951) 1; the order of runs is that of the paper's tables.

use super::coding::{Factor, coded_point, natural_point};
use super::least_squares::{condition_number, rank};
use super::term::{Term, model_matrix};
use nalgebra::DMatrix;

/// Factor counts for which a face-centred composite is offered.
pub const COMPOSITE_FACTORS: std::ops::RangeInclusive<usize> = 2..=6;
/// Above this count the last factor of the two-level part is generated from the others.
const MOST_FACTORS_IN_FULL: usize = 4;
/// Settings this close to −1, 0, +1 are these levels; the difference is rounding of printed values.
const LEVEL_TOLERANCE: f64 = 1e-9;
/// Settings farther out than this come from a wrong range or unit, not from a design.
const FARTHEST_SETTING: f64 = 100.0;

/// Factors and the runs to make with them; runs are rows in coded units, one value a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    factors: Vec<Factor>,
    coded_runs: Vec<Vec<f64>>,
}

/// Why runs do not make a design.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// No composite for this number of factors.
    #[error("a face-centred design takes 2 to 6 factors, not {n_factors}; hold some factors fixed")]
    FactorCount {
        /// Factors given.
        n_factors: usize,
    },
    /// Two factors have one name.
    #[error("two factors are named {name}; rename one")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// No factor or no run.
    #[error("a design needs at least one factor and one run")]
    Empty,
    /// A run has too few or too many settings.
    #[error("run {run} has {found} settings, expected {expected}, one for each factor")]
    RunLength {
        /// Run, counted from 1.
        run: usize,
        /// Settings given.
        found: usize,
        /// Factors.
        expected: usize,
    },
    /// A setting is NaN, infinite or absurdly far outside the factor's range.
    #[error("run {run}: {factor} is set to {coded} coded units; expected −1 to +1, check the factor's range and unit")]
    Setting {
        /// Run, counted from 1.
        run: usize,
        /// The factor.
        factor: String,
        /// The setting in coded units.
        coded: f64,
    },
}

impl Design {
    /// The face-centred central composite: two-level part in Yates order, faces A−, A+, B−, B+ …, then `n_centre`
    /// centre runs (the paper uses 1; more than 1 gives pure error). 2 to 6 factors.
    pub fn face_centred(factors: Vec<Factor>, n_centre: usize) -> Result<Self, DesignError> {
        let n_factors = factors.len();
        if !COMPOSITE_FACTORS.contains(&n_factors) {
            return Err(DesignError::FactorCount { n_factors });
        }
        let mut runs = two_level_runs(n_factors);
        runs.extend(face_runs(n_factors));
        runs.extend(vec![vec![0.0; n_factors]; n_centre]);
        Self::from_coded(factors, runs)
    }

    /// A design from runs in coded units.
    pub fn from_coded(factors: Vec<Factor>, coded_runs: Vec<Vec<f64>>) -> Result<Self, DesignError> {
        check_factors(&factors)?;
        let design = Self { factors, coded_runs: Vec::new() };
        if coded_runs.is_empty() {
            return Err(DesignError::Empty);
        }
        design.with_runs(coded_runs)
    }

    /// A design from runs in natural units; printed levels are recognised as −1, 0, +1 despite their rounding.
    pub fn from_natural(factors: Vec<Factor>, natural_runs: &[Vec<f64>]) -> Result<Self, DesignError> {
        if let Some(run_idx) = natural_runs.iter().position(|run| run.len() != factors.len()) {
            return Err(run_length(run_idx, natural_runs[run_idx].len(), factors.len()));
        }
        let coded_runs = natural_runs.iter().map(|run| snapped(coded_point(&factors, run))).collect();
        Self::from_coded(factors, coded_runs)
    }

    /// The design augmented by further runs in coded units, in the order given: replicates, centres, or a region of
    /// interest.
    pub fn with_runs(mut self, coded_runs: Vec<Vec<f64>>) -> Result<Self, DesignError> {
        for run in coded_runs {
            check_run(&self.factors, self.coded_runs.len(), &run)?;
            self.coded_runs.push(run);
        }
        Ok(self)
    }

    /// The factors, in the order of each run's settings.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// The runs in coded units.
    pub fn coded_runs(&self) -> &[Vec<f64>] {
        &self.coded_runs
    }

    /// The runs in natural units.
    pub fn natural_runs(&self) -> Vec<Vec<f64>> {
        self.coded_runs.iter().map(|run| natural_point(&self.factors, run)).collect()
    }

    /// Number of runs.
    pub fn n_runs(&self) -> usize {
        self.coded_runs.len()
    }

    /// The terms of the full quadratic in this design's factors.
    pub fn terms(&self) -> Vec<Term> {
        Term::full_quadratic(self.factors.len())
    }

    /// The full quadratic's regression matrix, runs × terms.
    pub fn model_matrix(&self) -> DMatrix<f64> {
        model_matrix(&self.terms(), &self.coded_runs)
    }

    /// How many terms of the full quadratic the runs can tell apart.
    pub fn rank(&self) -> usize {
        rank(&self.model_matrix())
    }

    /// Largest over smallest singular value of the regression matrix in coded units; none if the rank is short.
    pub fn condition_number(&self) -> Option<f64> {
        condition_number(&self.model_matrix())
    }
}

/// Sign patterns in Yates order: the first factor changes fastest.
fn two_level_runs(n_factors: usize) -> Vec<Vec<f64>> {
    let generated = n_factors > MOST_FACTORS_IN_FULL;
    let n_free = if generated { n_factors - 1 } else { n_factors };
    let mut runs: Vec<Vec<f64>> = (0..1usize << n_free).map(|run_idx| yates_signs(run_idx, n_free)).collect();
    if generated {
        runs.iter_mut().for_each(|signs| signs.push(signs.iter().product()));
    }
    runs
}

fn yates_signs(run_idx: usize, n_free: usize) -> Vec<f64> {
    (0..n_free).map(|factor_idx| if run_idx >> factor_idx & 1 == 1 { 1.0 } else { -1.0 }).collect()
}

fn face_runs(n_factors: usize) -> impl Iterator<Item = Vec<f64>> {
    (0..n_factors).flat_map(move |factor_idx| {
        [-1.0, 1.0].map(|level| {
            let mut run = vec![0.0; n_factors];
            run[factor_idx] = level;
            run
        })
    })
}

fn snapped(mut run: Vec<f64>) -> Vec<f64> {
    for setting in &mut run {
        let level = setting.round();
        if level.abs() <= 1.0 && (*setting - level).abs() < LEVEL_TOLERANCE {
            *setting = level;
        }
    }
    run
}

fn check_factors(factors: &[Factor]) -> Result<(), DesignError> {
    if factors.is_empty() {
        return Err(DesignError::Empty);
    }
    let repeated = |idx: usize| factors[..idx].iter().any(|earlier| earlier.name() == factors[idx].name());
    match (0..factors.len()).find(|&idx| repeated(idx)) {
        Some(idx) => Err(DesignError::DuplicateName { name: factors[idx].name().to_string() }),
        None => Ok(()),
    }
}

fn check_run(factors: &[Factor], run_idx: usize, run: &[f64]) -> Result<(), DesignError> {
    if run.len() != factors.len() {
        return Err(run_length(run_idx, run.len(), factors.len()));
    }
    match run.iter().position(|setting| !setting.is_finite() || setting.abs() > FARTHEST_SETTING) {
        Some(idx) => {
            let factor = factors[idx].name().to_string();
            Err(DesignError::Setting { run: run_idx + 1, factor, coded: run[idx] })
        }
        None => Ok(()),
    }
}

fn run_length(run_idx: usize, found: usize, expected: usize) -> DesignError {
    DesignError::RunLength { run: run_idx + 1, found, expected }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn factors(n_factors: usize) -> Vec<Factor> {
        (0..n_factors).map(|idx| Factor::new(format!("x{idx}"), 0.0, 1.0 + idx as f64).unwrap()).collect()
    }

    #[test]
    fn run_counts_are_those_of_the_literature() {
        for (n_factors, n_runs) in [(2, 9), (3, 15), (4, 25), (5, 27), (6, 45)] {
            assert_eq!(Design::face_centred(factors(n_factors), 1).unwrap().n_runs(), n_runs);
        }
    }

    #[test]
    fn two_factors_run_through_corners_faces_and_centre() {
        let design = Design::face_centred(factors(2), 1).unwrap();
        let expected = [[-1, -1], [1, -1], [-1, 1], [1, 1], [-1, 0], [1, 0], [0, -1], [0, 1], [0, 0]]
            .map(|run| run.map(f64::from));
        assert_eq!(design.coded_runs(), expected.map(|run| run.to_vec()));
    }

    #[test]
    fn one_and_seven_factors_are_refused() {
        for n_factors in [0, 1, 7] {
            assert_eq!(Design::face_centred(factors(n_factors), 1), Err(DesignError::FactorCount { n_factors }));
        }
    }

    #[test]
    fn unusable_runs_are_refused_with_their_number() {
        let with = |runs: Vec<Vec<f64>>| Design::from_coded(factors(2), runs).unwrap_err();
        assert_eq!(with(vec![]), DesignError::Empty);
        assert_eq!(with(vec![vec![0.0; 2], vec![0.0]]), DesignError::RunLength { run: 2, found: 1, expected: 2 });
        assert!(matches!(with(vec![vec![f64::NAN, 0.0]]), DesignError::Setting { run: 1, .. }));
        assert!(matches!(with(vec![vec![0.0, 1e200]]), DesignError::Setting { run: 1, .. }));
        let twice = vec![factors(1).remove(0), factors(1).remove(0)];
        assert!(matches!(Design::face_centred(twice, 1), Err(DesignError::DuplicateName { .. })));
    }

    #[test]
    fn too_few_levels_leave_the_rank_short() {
        let design = Design::from_coded(factors(2), two_level_runs(2)).unwrap();
        assert_eq!(design.rank(), 4);
        assert_eq!(design.condition_number(), None);
    }

    #[test]
    fn added_replicates_follow_the_runs() {
        let design = Design::face_centred(factors(3), 1).unwrap().with_runs(vec![vec![0.0; 3]; 4]).unwrap();
        assert_eq!(design, Design::face_centred(factors(3), 5).unwrap());
    }

    proptest! {
        #[test]
        fn every_composite_tells_all_terms_apart(n_factors in COMPOSITE_FACTORS, n_centre in 0usize..6) {
            let design = Design::face_centred(factors(n_factors), n_centre).unwrap();
            prop_assert_eq!(design.rank(), design.terms().len());
            prop_assert!(design.condition_number().unwrap() < 20.0);
        }

        #[test]
        fn natural_units_and_back_give_the_same_runs(n_factors in COMPOSITE_FACTORS) {
            let design = Design::face_centred(factors(n_factors), 1).unwrap();
            prop_assert_eq!(&Design::from_natural(factors(n_factors), &design.natural_runs()).unwrap(), &design);
        }
    }
}
