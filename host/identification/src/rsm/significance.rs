//! Student's t and Fisher's F turned into probabilities, with defined answers where there is nothing to divide by.

use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// Statistics are cut off here: beyond, statrs overflows, and a probability of less than 1e-49 says all it can.
const LARGEST_STATISTIC: f64 = 1e100;

/// A quotient, none if it is not a finite number.
pub fn ratio(numerator: f64, denominator: f64) -> Option<f64> {
    let quotient = numerator / denominator;
    quotient.is_finite().then_some(quotient)
}

/// Two-sided probability, 0 to 1, of a |t| at least this large by chance; none without degrees of freedom.
pub fn two_sided_t(t: f64, dof: usize) -> Option<f64> {
    let student = StudentsT::new(0.0, 1.0, dof as f64).ok()?;
    probability(2.0 * student.sf(t.abs().min(LARGEST_STATISTIC)))
}

/// Probability, 0 to 1, of an F at least this large by chance; none without degrees of freedom.
pub fn upper_f(f: f64, numerator_dof: usize, denominator_dof: usize) -> Option<f64> {
    let fisher = FisherSnedecor::new(numerator_dof as f64, denominator_dof as f64).ok()?;
    probability(fisher.sf(f.min(LARGEST_STATISTIC)))
}

fn probability(value: f64) -> Option<f64> {
    value.is_finite().then(|| value.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_five_percent_points_are_those_of_printed_tables() {
        assert!((two_sided_t(2.446912, 6).unwrap() - 0.05).abs() < 1e-6);
        assert!((two_sided_t(-2.446912, 6).unwrap() - 0.05).abs() < 1e-6);
        // F(5, 6) at 5 % is 4.387 in printed tables.
        assert!((upper_f(4.387374, 5, 6).unwrap() - 0.05).abs() < 1e-6);
    }

    #[test]
    fn f_with_one_degree_of_freedom_is_t_squared() {
        for t in [0.1, 1.0, 3.0, 30.0] {
            let (by_t, by_f) = (two_sided_t(t, 6).unwrap(), upper_f(t * t, 1, 6).unwrap());
            assert!((by_t - by_f).abs() < 1e-9 * by_t);
        }
    }

    #[test]
    fn extremes_give_probabilities_and_never_nan() {
        for (t, dof) in [(0.0, 6), (1e9, 6), (1e200, 6), (f64::MAX, 1)] {
            assert!((0.0..=1.0).contains(&two_sided_t(t, dof).unwrap()), "t {t}");
            assert!((0.0..=1.0).contains(&upper_f(t, 5, dof).unwrap()), "F {t}");
        }
        assert_eq!(two_sided_t(1.0, 0), None);
        assert_eq!(upper_f(1.0, 5, 0), None);
        assert_eq!(ratio(0.0, 0.0), None);
        assert_eq!(ratio(1.0, 0.0), None);
    }
}
