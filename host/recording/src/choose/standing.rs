//! How much a column of numbers looks like a clock.

use super::super::limits::MIN_SAMPLES;
use super::super::median;
use super::super::order;
use super::super::table::Table;

/// A time is off its line by this share of all that it covers, at most: a loop whose steps differ ten times is by 0.03, half a
/// swing from rest by 0.1.
const OFF_LINE: f64 = 0.05;

/// Steps of 0.033 and 0.034 s differ by this share of them, which 200 rows of a swing do where it is fast and has some 10,000
/// a period. With half of it, or twice, the same files are told apart.
const LAST_DIGIT: f64 = 0.04;

/// The column of time where none has a name: the first one, unless another one is more of a clock. Words with which the rows
/// begin are none.
pub(super) fn unnamed_time(table: &Table) -> usize {
    let standing = |idx: usize| Standing::of(&table.first_numbers(idx));
    let first = first_of_numbers(table);
    let best = standing(first);
    // Of equals the first.
    let others = (first + 1..table.n_columns).map(|idx| (idx, standing(idx)));
    let time = others.fold((first, best), |a, b| if b.1 > a.1 { b } else { a }).0;
    let better = || beside_count(table, &[time], |_| true).or_else(|| beside_step(table, time));
    better().unwrap_or(time)
}

/// The first column that goes on from row to row as on a straight line, beside one that stands but for a step or until the
/// last tenth, as what a controller is told does.
fn beside_step(table: &Table, standing: usize) -> Option<usize> {
    let numbers = table.first_numbers(standing);
    let moves: Vec<usize> = (1..numbers.len()).filter(|row| numbers[*row] != numbers[row - 1]).collect();
    let begins_late = moves.first().is_some_and(|row| 10 * row > 9 * numbers.len());
    let stands = numbers.len() >= MIN_SAMPLES && (moves.len() == 1 || begins_late);
    let goes_on = |idx: &usize| {
        let numbers = table.first_numbers(*idx);
        numbers.windows(2).all(|pair| pair[1] > pair[0]) && is_nearly_straight(&numbers)
    };
    (0..table.n_columns).filter(|_| stands && table.n_columns > 2).find(goes_on)
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

/// Rows of a loop that takes unequal times are so far off a straight line, and a swing at most while it is fast.
fn is_nearly_straight(numbers: &[f64]) -> bool {
    let (Some(first), Some(last)) = (numbers.first(), numbers.last()) else { return false };
    let share = |row: usize| row as f64 / (numbers.len() - 1).max(1) as f64;
    let off = |(row, number): (usize, &f64)| (number - first - share(row) * (last - first)).abs();
    numbers.iter().enumerate().map(off).all(|off| off < OFF_LINE * (last - first))
}

/// The column without a name that is the time where those of that name count rows.
pub(super) fn time_without_name(table: &Table, named: &[usize]) -> Option<usize> {
    let names = table.names.as_deref()?;
    beside_count(table, named, |idx| names.get(idx).is_none_or(|name| name.trim().is_empty()))
}

/// A column that goes on evenly, beside times that may be the numbers of the rows and something that was measured.
fn beside_count(table: &Table, times: &[usize], may_be: impl Fn(usize) -> bool) -> Option<usize> {
    let are_counts = !times.is_empty() && times.iter().all(|idx| counts(&table.first_numbers(*idx)));
    if !are_counts || table.n_columns < times.len() + 2 {
        return None;
    }
    let is_time = |idx: &usize| may_be(*idx) && goes_on_evenly(&table.first_numbers(*idx));
    (0..table.n_columns).find(is_time)
}

/// 14, 15, 16, …
pub(super) fn counts(numbers: &[f64]) -> bool {
    numbers.len() >= MIN_SAMPLES && numbers[0].fract() == 0.0 && numbers.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
}

/// By steps that are the same but for their last digit, and are not 1.
fn goes_on_evenly(numbers: &[f64]) -> bool {
    let steps = || numbers.windows(2).map(|pair| pair[1] - pair[0]);
    let mean = steps().sum::<f64>() / steps().len().max(1) as f64;
    let is_even = steps().all(|step| (step - mean).abs() < LAST_DIGIT * mean);
    numbers.len() >= MIN_SAMPLES && mean > 0.0 && is_even && !counts(numbers)
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
