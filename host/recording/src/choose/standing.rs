//! How much a column of numbers looks like a clock.

use super::super::limits::MIN_SAMPLES;
use super::super::median;
use super::super::order;
use super::super::table::Table;

/// The column of time where none has a name: the first one, unless another one is more of a clock. Words with which the rows
/// begin are none.
pub(super) fn unnamed_time(table: &Table) -> usize {
    let standing = |idx: usize| Standing::of(&table.first_numbers(idx));
    let first = first_of_numbers(table);
    let best = standing(first);
    // Of equals the first.
    let others = (first + 1..table.n_columns).map(|idx| (idx, standing(idx)));
    others.fold((first, best), |a, b| if b.1 > a.1 { b } else { a }).0
}

/// Do the rows begin with words, and is none of their numbers a time?
pub(super) fn has_words_and_no_time(table: &Table) -> bool {
    first_of_numbers(table) > 0 && Standing::of(&table.first_numbers(unnamed_time(table))) == Standing::No
}

/// The first column, unless words stand in it.
fn first_of_numbers(table: &Table) -> usize {
    (0..table.n_columns).find(|idx| !table.is_of_words(*idx)).unwrap_or(0)
}

/// How much a column looks like a clock in the first rows.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
enum Standing {
    /// It goes back, or never moves.
    No,
    /// By even steps, but for a row or so that is out of order.
    RisesButForStrays,
    /// A coarse clock, or an angle that begins to move.
    NeverFalls,
    /// By steps that are even for the most part, as those of a swing are not.
    RisesEvenly,
}

impl Standing {
    fn of(numbers: &[f64]) -> Self {
        let never_falls = numbers.windows(2).all(|pair| pair[1] >= pair[0]) && numbers.last() > numbers.first();
        match never_falls {
            _ if numbers.len() < MIN_SAMPLES => Self::No,
            true if rises_evenly(numbers) => Self::RisesEvenly,
            true => Self::NeverFalls,
            false if rises_evenly(&without_strays(numbers)) => Self::RisesButForStrays,
            false => Self::No,
        }
    }
}

/// The numbers without those that are out of order where the others go on; all of them where that are more than a few.
fn without_strays(numbers: &[f64]) -> Vec<f64> {
    let Some(kept) = order::kept(numbers, |_| false) else { return numbers.to_vec() };
    numbers.iter().zip(kept).filter(|(_, kept)| *kept).map(|(number, _)| *number).collect()
}

/// Nine of ten steps are about as long as the typical one, and none is none.
pub(super) fn rises_evenly(numbers: &[f64]) -> bool {
    let steps: Vec<f64> = numbers.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let typical = median(&mut steps.clone());
    let is_even = |step: &f64| (0.5 * typical..=1.5 * typical).contains(step);
    let n_even = steps.iter().filter(|step| is_even(step)).count();
    steps.iter().all(|step| *step > 0.0) && 10 * n_even > 9 * steps.len()
}
