//! Analysis of variance: which groups of terms matter, and whether a quadratic is enough.
//!
//! Each group has a sequential sum of squares (what it adds to the groups before it, in the order linear, square,
//! interaction; these add up to the regression) and an adjusted one (what the surface loses without it). F and p use
//! the adjusted ones, as response-surface packages do. Replicated runs split the residual into pure error and lack of
//! fit.
//!
//! Simulated runs have no chance in them: the residual is what a quadratic cannot follow. F and p then describe how much
//! larger a group is than that, and are no probabilities (J. Sacks, W. J. Welch, T. J. Mitchell, H. P. Wynn, Statist.
//! Sci. 4 (1989) 409).

use super::least_squares::residual_sum_of_squares;
use super::significance::{ratio, upper_f};
use super::surface::Surface;
use super::term::{Term, model_matrix};
use serde::Serialize;

/// Settings of replicates may differ by this many coded units, the rounding of natural values.
const REPLICATE_TOLERANCE: f64 = 1e-9;

/// One row of the table; sums of squares in squared units of the response.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AnovaRow {
    /// What the row is about.
    pub source: String,
    /// Degrees of freedom.
    pub dof: usize,
    /// What the group adds to the groups before it.
    pub sequential_sum_of_squares: f64,
    /// What the surface loses without the group.
    pub adjusted_sum_of_squares: f64,
    /// Adjusted sum of squares per degree of freedom; absent with none.
    pub mean_square: Option<f64>,
    /// Mean square over that of the residual (lack of fit: over that of pure error).
    pub f: Option<f64>,
    /// Probability of such an F by chance, 0 to 1; of runs without chance a description only.
    pub p: Option<f64>,
}

/// The residual, split where replicates allow it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum LackOfFit {
    /// No run is repeated, so scatter and a wrong model cannot be told apart.
    NoReplicates,
    /// A small p says that a quadratic is not enough.
    Tested {
        /// Distance of the replicates' means from the surface.
        lack_of_fit: AnovaRow,
        /// Scatter of replicates about their means.
        pure_error: AnovaRow,
    },
}

/// The whole table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Anova {
    /// All terms but the intercept together.
    pub regression: AnovaRow,
    /// Linear, square and interaction terms; groups without terms are left out.
    pub groups: Vec<AnovaRow>,
    /// What the surface leaves over.
    pub residual: AnovaRow,
    /// The residual's two parts.
    pub lack_of_fit: LackOfFit,
    /// Variation about the mean.
    pub total: AnovaRow,
}

/// The analysis of one fitted surface.
pub fn anova(surface: &Surface) -> Anova {
    let total = surface.total_sum_of_squares();
    let residual = Error { sum_of_squares: surface.residual_sum_of_squares(), dof: surface.residual_dof() };
    let explained = (total - residual.sum_of_squares).max(0.0);
    let n_slopes = surface.terms().len() - 1;
    Anova {
        regression: residual.tests("regression", n_slopes, explained, explained),
        groups: group_rows(surface, &residual),
        lack_of_fit: lack_of_fit(surface),
        total: untested("total", surface.responses().len() - 1, total),
        residual: untested("residual", residual.dof, residual.sum_of_squares),
    }
}

/// One row a factor: all its terms together against the residual. A large p says that the factor has no visible effect.
/// The rows overlap in the interactions, so they do not add up; their sequential sums equal the adjusted ones.
pub fn factor_effects(surface: &Surface) -> Vec<AnovaRow> {
    let residual = Error { sum_of_squares: surface.residual_sum_of_squares(), dof: surface.residual_dof() };
    let row = |(factor_idx, name): (usize, &str)| {
        let belongs = |term: Term| term.involves(factor_idx);
        let dof = surface.terms().iter().filter(|&&term| belongs(term)).count();
        let lost = loss_without(surface, belongs);
        residual.tests(name, dof, lost, lost)
    };
    surface.factors().iter().map(|factor| factor.name()).enumerate().map(row).collect()
}

/// What mean squares are measured against.
struct Error {
    sum_of_squares: f64,
    dof: usize,
}

impl Error {
    fn tests(&self, source: &str, dof: usize, sequential: f64, adjusted: f64) -> AnovaRow {
        let mean_square = ratio(adjusted, dof as f64);
        let error_mean_square = ratio(self.sum_of_squares, self.dof as f64);
        let f = mean_square.zip(error_mean_square).and_then(|(signal, error)| ratio(signal, error));
        let p = f.and_then(|f| upper_f(f, dof, self.dof));
        AnovaRow {
            source: source.to_string(),
            dof,
            sequential_sum_of_squares: sequential,
            adjusted_sum_of_squares: adjusted,
            mean_square,
            f,
            p,
        }
    }
}

fn untested(source: &str, dof: usize, sum_of_squares: f64) -> AnovaRow {
    AnovaRow {
        f: None,
        p: None,
        ..Error { sum_of_squares: 0.0, dof: 0 }.tests(source, dof, sum_of_squares, sum_of_squares)
    }
}

/// The groups in the order in which sequential sums of squares are taken.
fn group_of(term: Term) -> usize {
    match term {
        Term::Intercept => 0,
        Term::Linear(_) => 1,
        Term::Square(_) => 2,
        Term::Interaction(..) => 3,
    }
}

fn group_rows(surface: &Surface, residual: &Error) -> Vec<AnovaRow> {
    let mut rows = Vec::new();
    for (group, source) in [(1, "linear"), (2, "square"), (3, "interaction")] {
        let dof = surface.terms().iter().filter(|&&term| group_of(term) == group).count();
        if dof > 0 {
            let before = left_over(surface, |term| group_of(term) < group);
            let after = left_over(surface, |term| group_of(term) <= group);
            let adjusted = loss_without(surface, |term| group_of(term) == group);
            rows.push(residual.tests(source, dof, (before - after).max(0.0), adjusted));
        }
    }
    rows
}

/// How much the residual sum of squares grows when the chosen terms are left out.
fn loss_without(surface: &Surface, left_out: impl Fn(Term) -> bool) -> f64 {
    (left_over(surface, |term| !left_out(term)) - surface.residual_sum_of_squares()).max(0.0)
}

/// The residual sum of squares of a fit with the chosen terms only.
fn left_over(surface: &Surface, kept: impl Fn(Term) -> bool) -> f64 {
    let terms: Vec<Term> = surface.terms().iter().copied().filter(|&term| kept(term)).collect();
    residual_sum_of_squares(model_matrix(&terms, surface.design().coded_runs()), surface.responses())
}

fn lack_of_fit(surface: &Surface) -> LackOfFit {
    let settings = replicates(surface.design().coded_runs());
    let dof = surface.responses().len() - settings.len();
    if dof == 0 {
        return LackOfFit::NoReplicates;
    }
    let pure = Error { sum_of_squares: settings.iter().map(|runs| scatter(surface, runs)).sum(), dof };
    let lack = (surface.residual_sum_of_squares() - pure.sum_of_squares).max(0.0);
    LackOfFit::Tested {
        lack_of_fit: pure.tests("lack of fit", surface.residual_dof() - dof, lack, lack),
        pure_error: untested("pure error", dof, pure.sum_of_squares),
    }
}

/// Run indices, grouped by equal settings.
fn replicates(coded_runs: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let equal = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < REPLICATE_TOLERANCE);
    let mut settings: Vec<Vec<usize>> = Vec::new();
    for (run_idx, run) in coded_runs.iter().enumerate() {
        match settings.iter_mut().find(|runs| equal(&coded_runs[runs[0]], run)) {
            Some(runs) => runs.push(run_idx),
            None => settings.push(vec![run_idx]),
        }
    }
    settings
}

fn scatter(surface: &Surface, runs: &[usize]) -> f64 {
    let responses = surface.responses().select_rows(runs);
    responses.add_scalar(-responses.mean()).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::coefficients::coefficient_table;
    use crate::rsm::design::Design;

    fn factors(n_factors: usize) -> Vec<Factor> {
        (0..n_factors).map(|idx| Factor::new(format!("x{idx}"), 0.0, 1.0).unwrap()).collect()
    }

    fn noisy_surface(n_factors: usize, n_centre: usize) -> Surface {
        let design = Design::face_centred(factors(n_factors), n_centre).unwrap();
        let responses: Vec<f64> = (0..design.n_runs()).map(|run_idx| (run_idx as f64 * 2.3).sin()).collect();
        Surface::fit(&design, &responses).unwrap()
    }

    fn one_factor(runs: &[f64], responses: &[f64]) -> Anova {
        let design = Design::from_coded(factors(1), runs.iter().map(|&x| vec![x]).collect()).unwrap();
        anova(&Surface::fit(&design, responses).unwrap())
    }

    #[test]
    fn sequential_sums_add_up_to_the_regression_and_all_to_the_total() {
        for n_factors in 2..=6 {
            let table = anova(&noisy_surface(n_factors, 1));
            let groups: f64 = table.groups.iter().map(|row| row.sequential_sum_of_squares).sum();
            let regression = table.regression.sequential_sum_of_squares;
            let total = table.total.sequential_sum_of_squares;
            assert!((groups - regression).abs() < 1e-12 * total);
            assert!((regression + table.residual.sequential_sum_of_squares - total).abs() < 1e-12 * total);
            assert_eq!(table.regression.dof, table.groups.iter().map(|row| row.dof).sum::<usize>());
            assert_eq!(table.total.dof, table.regression.dof + table.residual.dof);
        }
    }

    #[test]
    fn a_group_of_one_term_has_the_f_of_its_squared_t() {
        let surface = noisy_surface(2, 1);
        let interaction = anova(&surface).groups.remove(2);
        let coefficient = coefficient_table(&surface).remove(5);
        assert!((interaction.f.unwrap() - coefficient.t.unwrap().powi(2)).abs() < 1e-9);
        assert!((interaction.p.unwrap() - coefficient.p.unwrap()).abs() < 1e-9);
    }

    #[test]
    fn replicates_split_the_residual_as_worked_by_hand() {
        // Levels −1, 0, 1, 2 in pairs ±0.5 about the cubic (0, 0, 0, 6): pure error 4·0.5 = 2, and the quadratic misses
        // the means by 6/20·(−1, 3, −3, 1), the third orthogonal polynomial: lack of fit 2·(0.3)²·20 = 3.6.
        let runs = [-1.0, -1.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
        let table = one_factor(&runs, &[-0.5, 0.5, -0.5, 0.5, -0.5, 0.5, 5.5, 6.5]);
        let LackOfFit::Tested { lack_of_fit, pure_error } = table.lack_of_fit else { panic!("there are replicates") };
        assert_eq!((lack_of_fit.dof, pure_error.dof), (1, 4));
        assert!((pure_error.adjusted_sum_of_squares - 2.0).abs() < 1e-12);
        assert!((lack_of_fit.adjusted_sum_of_squares - 3.6).abs() < 1e-12);
        assert!((lack_of_fit.f.unwrap() - 7.2).abs() < 1e-12);
    }

    #[test]
    fn without_replicates_the_table_says_so() {
        assert_eq!(anova(&noisy_surface(3, 1)).lack_of_fit, LackOfFit::NoReplicates);
        assert!(matches!(anova(&noisy_surface(3, 2)).lack_of_fit, LackOfFit::Tested { .. }));
    }

    #[test]
    fn saturated_perfect_and_constant_responses_give_tables_without_nan() {
        let saturated = one_factor(&[-1.0, 0.0, 1.0], &[1.0, 2.0, 5.0]);
        let perfect = one_factor(&[-1.0, 0.0, 1.0, 1.0], &[1.0, 2.0, 5.0, 5.0]);
        let constant = one_factor(&[-1.0, 0.0, 0.5, 1.0], &[0.1; 4]);
        for table in [saturated, perfect, constant] {
            assert_eq!((table.regression.f, table.regression.p), (None, None));
            for row in table.groups.iter().chain([&table.regression, &table.residual, &table.total]) {
                assert!(row.sequential_sum_of_squares.is_finite() && row.mean_square.is_none_or(f64::is_finite));
            }
        }
    }

    #[test]
    fn a_factor_without_effect_is_seen_beside_one_with() {
        let design = Design::face_centred(factors(2), 1).unwrap();
        let wiggle = [0.1, -0.1, 0.1, -0.1, -0.1, 0.1, 0.1, 0.1, -0.1];
        let responses: Vec<f64> = design.coded_runs().iter().zip(wiggle).map(|(run, w)| 5.0 * run[0] + w).collect();
        let rows = factor_effects(&Surface::fit(&design, &responses).unwrap());
        assert!(rows[0].p.unwrap() < 0.01 && rows[1].p.unwrap() > 0.1);
        // Its linear, its square and its interaction.
        assert_eq!([rows[0].dof, rows[1].dof], [3, 3]);
    }
}
