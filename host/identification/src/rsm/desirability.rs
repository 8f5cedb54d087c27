//! Desirability: several responses become one number, 0 (some response is unacceptable) to 1 (all are on target).
//!
//! Each response has a target and, on each side of it, either a limit beyond which it is unacceptable or no limit at
//! all. Between target and limit d = ((limit − y)/(limit − target))^weight. The composite is the geometric mean of
//! the d, weighted by importance. Target 0 with limits on both sides and weight 1 is what reproduces the paper's
//! optimum.
//! Source: G. Derringer, R. Suich, J. Qual. Technol. 12 (1980) 214.

use serde::Serialize;

/// What one response should be; built by `minimise`, `maximise` or `target`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Desirability {
    target: f64,
    below: Side,
    above: Side,
    importance: f64,
}

/// One side of the target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
enum Side {
    /// As good as the target itself.
    Welcome,
    /// Worse and worse up to the limit.
    Falling { limit: f64, weight: f64 },
}

/// Why a desirability is not one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesirabilityError {
    /// Limits and target are not in rising order, or too close to be told apart.
    #[error("limits and target must rise by steps: {first} is not below {second}")]
    Order {
        /// What should be smaller.
        first: f64,
        /// What should be larger.
        second: f64,
    },
    /// A weight or importance is zero, negative, NaN or infinite.
    #[error("a weight or importance of {value} is not possible; expected a positive number, 1 for none in particular")]
    NotPositive {
        /// The value given.
        value: f64,
    },
    /// No response to judge by.
    #[error("a composite desirability needs at least one response")]
    Empty,
}

impl Desirability {
    /// The smaller the better: 1 up to `target`, 0 from `high`.
    pub fn minimise(target: f64, high: f64) -> Result<Self, DesirabilityError> {
        check_order(target, high)?;
        Ok(Self { target, below: Side::Welcome, above: Side::to(high), importance: 1.0 })
    }

    /// The larger the better: 0 up to `low`, 1 from `target`.
    pub fn maximise(low: f64, target: f64) -> Result<Self, DesirabilityError> {
        check_order(low, target)?;
        Ok(Self { target, below: Side::to(low), above: Side::Welcome, importance: 1.0 })
    }

    /// The nearer the better: 1 at `target`, 0 up to `low` and from `high`.
    pub fn target(low: f64, target: f64, high: f64) -> Result<Self, DesirabilityError> {
        check_order(low, target)?;
        check_order(target, high)?;
        Ok(Self { target, below: Side::to(low), above: Side::to(high), importance: 1.0 })
    }

    /// With exponents below and above the target: 1 straight, more than 1 insists on the target, less is content
    /// nearby.
    pub fn weighted(mut self, below: f64, above: f64) -> Result<Self, DesirabilityError> {
        self.below = self.below.weighted(below)?;
        self.above = self.above.weighted(above)?;
        Ok(self)
    }

    /// With an importance relative to the other responses; 1 unless set.
    pub fn with_importance(self, importance: f64) -> Result<Self, DesirabilityError> {
        check_positive(importance)?;
        Ok(Self { importance, ..self })
    }

    /// How welcome a response is, 0 to 1; 0 if it is NaN.
    pub fn of(&self, response: f64) -> f64 {
        self.logarithm(response).exp()
    }

    /// Natural logarithm of [`Desirability::of`]: 0 down to −∞.
    fn logarithm(&self, response: f64) -> f64 {
        match self.side(response) {
            Side::Welcome => 0.0,
            Side::Falling { weight, .. } => weight * (1.0 - self.distance(response)).max(0.0).ln(),
        }
    }

    /// How far a response is beyond its limit, in distances between target and limit; 0 if it is acceptable.
    pub fn excess(&self, response: f64) -> f64 {
        (self.distance(response) - 1.0).max(0.0)
    }

    /// Distance from the target: 0 on it or on a welcome side, 1 at the limit, infinite for NaN.
    fn distance(&self, response: f64) -> f64 {
        let distance = match self.side(response) {
            Side::Welcome => 0.0,
            Side::Falling { limit, .. } => (response - self.target) / (limit - self.target),
        };
        if distance.is_nan() { f64::INFINITY } else { distance }
    }

    fn side(&self, response: f64) -> Side {
        if response.is_nan() {
            Side::to(f64::NAN)
        } else if response < self.target {
            self.below
        } else {
            self.above
        }
    }
}

impl Side {
    fn to(limit: f64) -> Self {
        Self::Falling { limit, weight: 1.0 }
    }

    fn weighted(self, weight: f64) -> Result<Self, DesirabilityError> {
        check_positive(weight)?;
        Ok(match self {
            Self::Welcome => Self::Welcome,
            Self::Falling { limit, .. } => Self::Falling { limit, weight },
        })
    }
}

fn check_order(first: f64, second: f64) -> Result<(), DesirabilityError> {
    let rises = (second - first).is_normal() && second > first;
    rises.then_some(()).ok_or(DesirabilityError::Order { first, second })
}

fn check_positive(value: f64) -> Result<(), DesirabilityError> {
    let positive = value.is_normal() && value > 0.0;
    positive.then_some(()).ok_or(DesirabilityError::NotPositive { value })
}

/// All responses together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Composite {
    parts: Vec<Desirability>,
}

impl Composite {
    /// One desirability a response, in the order of the responses.
    pub fn new(parts: Vec<Desirability>) -> Result<Self, DesirabilityError> {
        if parts.is_empty() { Err(DesirabilityError::Empty) } else { Ok(Self { parts }) }
    }

    /// Number of responses judged.
    pub fn n_responses(&self) -> usize {
        self.parts.len()
    }

    /// Each response's own desirability, 0 to 1.
    pub fn each(&self, responses: &[f64]) -> Vec<f64> {
        self.parts.iter().zip(responses).map(|(part, &response)| part.of(response)).collect()
    }

    /// The geometric mean weighted by importance, 0 to 1; 0 as soon as one response is unacceptable.
    pub fn of(&self, responses: &[f64]) -> f64 {
        let largest = self.parts.iter().map(|part| part.importance).fold(0.0, f64::max);
        let (mut sum, mut shares) = (0.0, 0.0);
        for (part, &response) in self.parts.iter().zip(responses) {
            let share = part.importance / largest;
            sum += share * part.logarithm(response);
            shares += share;
        }
        (sum / shares).exp()
    }

    /// The composite where it is positive; elsewhere minus the sum of the excesses, so that a search finds its way
    /// across the flat region where some response is unacceptable.
    pub fn merit(&self, responses: &[f64]) -> f64 {
        let excess: f64 = self.parts.iter().zip(responses).map(|(part, &response)| part.excess(response)).sum();
        if excess > 0.0 { -excess } else { self.of(responses) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn each_goal_has_its_shape() {
        let smaller = Desirability::minimise(1.0, 3.0).unwrap();
        assert_eq!([0.0, 1.0, 2.0, 3.0, 4.0].map(|y| smaller.of(y)), [1.0, 1.0, 0.5, 0.0, 0.0]);
        let larger = Desirability::maximise(1.0, 3.0).unwrap();
        assert_eq!([0.0, 1.0, 2.0, 3.0, 4.0].map(|y| larger.of(y)), [0.0, 0.0, 0.5, 1.0, 1.0]);
        let nearer = Desirability::target(-2.0, 0.0, 4.0).unwrap().weighted(2.0, 1.0).unwrap();
        assert_eq!([-2.0, -1.0, 0.0, 1.0, 4.0].map(|y| nearer.of(y)), [0.0, 0.25, 1.0, 0.75, 0.0]);
    }

    #[test]
    fn importance_pulls_the_composite_towards_its_response() {
        let (plain, strong) =
            (Desirability::minimise(0.0, 1.0).unwrap(), Desirability::minimise(0.0, 1.0).unwrap().with_importance(3.0));
        let composite = Composite::new(vec![plain, strong.unwrap()]).unwrap();
        // d = 0.5 and 0.1 with importance 1 and 3: (0.5·0.1³)^(1/4).
        assert!((composite.of(&[0.5, 0.9]) - 0.0005f64.powf(0.25)).abs() < 1e-15);
        assert_eq!(composite.of(&[0.5, 1.0]), 0.0);
        let each = composite.each(&[0.25, 0.9]);
        assert!((each[0] - 0.75).abs() < 1e-12 && (each[1] - 0.1).abs() < 1e-12, "{each:?}");
    }

    #[test]
    fn unacceptable_responses_are_ranked_by_their_excess() {
        let part = Desirability::target(-1.0, 0.0, 1.0).unwrap();
        let composite = Composite::new(vec![part.clone(), part]).unwrap();
        assert_eq!(composite.merit(&[3.0, -2.0]), -3.0);
        assert_eq!(composite.merit(&[1.0, 0.5]), 0.0);
        assert_eq!(composite.merit(&[0.0, 0.0]), 1.0);
        assert_eq!(composite.merit(&[f64::NAN, 0.0]), f64::NEG_INFINITY);
    }

    #[test]
    fn impossible_goals_are_refused() {
        assert!(Desirability::minimise(1.0, 1.0).is_err());
        assert!(Desirability::maximise(2.0, 1.0).is_err());
        assert!(Desirability::target(0.0, f64::NAN, 1.0).is_err());
        assert!(Desirability::target(f64::NEG_INFINITY, 0.0, 1.0).is_err());
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Desirability::minimise(0.0, 1.0).unwrap().weighted(1.0, value).is_err());
            assert!(Desirability::minimise(0.0, 1.0).unwrap().with_importance(value).is_err());
        }
        assert_eq!(Composite::new(vec![]), Err(DesirabilityError::Empty));
    }

    proptest! {
        #[test]
        fn desirability_stays_between_nothing_and_everything(
            low in -1e6..1e6, span in 1e-3..1e6, share in 0.01..0.99, response in proptest::num::f64::ANY,
            weights in (0.1..10.0, 0.1..10.0), importance in 0.1..10.0,
        ) {
            let (target, high) = (low + share * span, low + span);
            let nearer = Desirability::target(low, target, high).unwrap().weighted(weights.0, weights.1).unwrap();
            let parts = vec![
                nearer.with_importance(importance).unwrap(),
                Desirability::minimise(target, high).unwrap(),
                Desirability::maximise(low, target).unwrap(),
            ];
            for part in &parts {
                prop_assert!((0.0..=1.0).contains(&part.of(response)));
            }
            let composite = Composite::new(parts).unwrap();
            prop_assert!((0.0..=1.0).contains(&composite.of(&[response; 3])));
            prop_assert!((0.0..=1.0).contains(&composite.of(&[target; 3])) && composite.of(&[target; 3]) > 0.999_999);
        }
    }
}
