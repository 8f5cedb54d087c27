//! The numbers of an effect that make it: its strengths, and what lies on the end of its range.

use crate::fit::fitted::Fitted;
use crate::fit::problem::Quantity;
use shared::effect::Effect;

/// Which of an effect's numbers stands in a column, if one does.
pub(super) fn index_in(model: &Fitted, effect: &Effect<f64>, column: usize) -> Option<usize> {
    match model.unknowns.get(column)?.quantity {
        Quantity::Effect { id, index } if id == effect.id => Some(index),
        _ => None,
    }
}

/// Which numbers of an effect are zero where it is absent: those that are zero at every start of a fit, or the first.
pub(super) fn strengths(effect: &Effect<f64>) -> Vec<usize> {
    let is_strength = |index: &usize| effect.starts.iter().all(|start| start[*index] == 0.0);
    let found: Vec<usize> = (0..effect.parameters.len()).filter(is_strength).collect();
    if found.is_empty() { vec![0] } else { found }
}

/// Does a number of an effect lie on an end of its range that must lie within?
pub(super) fn stands_for_another(model: &Fitted, effect: &Effect<f64>) -> bool {
    let Some(must) = effect.rules.must_lie_within.map(usize::from) else { return false };
    model
        .unknowns
        .iter()
        .enumerate()
        .any(|(j, unknown)| index_in(model, effect, j) == Some(must) && unknown.is_at_end(&model.parameters))
}

/// Does a strength of an effect lie on the end of its range? Zero, where the range of many begins, is none.
pub(super) fn is_as_strong_as_can_be(model: &Fitted, effect: &Effect<f64>) -> bool {
    let strong = strengths(effect);
    model.unknowns.iter().enumerate().any(|(j, unknown)| {
        let is_strength = index_in(model, effect, j).is_some_and(|index| strong.contains(&index));
        is_strength && unknown.get(&model.parameters) != 0.0 && unknown.is_at_end(&model.parameters)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, rig};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;

    #[test]
    fn a_detent_of_as_few_notches_as_there_can_be_stands_for_another_law() {
        let (detent, count) = (effect("detent"), Tally::default());
        let problem = problem_of(&[], &rig(), &count);
        let base = Fitted::at(&problem, &Point { values: problem.template_values(), starts: Vec::new() });
        let of_notches = |n: f64| stands_for_another(&base.with(detent, &[1e-3, 0.0, n, 0.0]).unwrap(), detent);
        let notches = &detent.parameters[2];
        assert!(!of_notches(6.0) && of_notches(notches.low) && of_notches(notches.high));
    }
}
