//! Which column is the angle, or which two are x and y of a point.

use super::boxes::Boxes;
use super::names::{all_best, ambiguous, example, find, named_times, no_angle, the_one};
use super::parted::parted;
use super::quaternion::{is_part, quaternion};
use super::rates::rate_columns;
use super::standing::{counts, unnamed_time};
use super::time::unit_in_cell;
use crate::cell::{Cell, Numerals};
use crate::chosen::ReadingSource;
use crate::circle::{Circle, is_arc};
use crate::clock;
use crate::columns::Columns;
use crate::error::{Fault, NoAngle};
use crate::limits::MIN_SAMPLES;
use crate::samples::MOST_COLUMNS;
use crate::table::Table;
use crate::units::AngleUnit;
use crate::words::{self, Meaning, meaning};
use std::f64::consts::FRAC_PI_2;

/// A named angle column, or x and y of a point; without names the first one that is not taken, and the next one with it
/// where both lie on a circle; none at all is fine when there are codes.
pub(super) fn choose_angle(
    table: &Table,
    asked: &Columns,
    code_idx: Option<usize>,
    has_rate: bool,
) -> Result<ReadingSource, Fault> {
    if let Some((column, unit)) = &asked.angle {
        let idx = find(table, column)?;
        return Ok(ReadingSource::Angle { idx, unit: unit.or(angle_unit_of(table, idx)) });
    }
    if let (Some(x), Some(y)) = (&asked.x, &asked.y) {
        return Ok(ReadingSource::Point { x: find(table, x)?, y: find(table, y)?, is_guess: false });
    }
    let named = without_quaternion(table, with_alpha(table, all_best(table, as_angle)));
    let named: Vec<usize> = named.into_iter().map(|(idx, _)| idx).collect();
    let stands = |idx: usize| table.first_numbers(idx).len() >= MIN_SAMPLES && !table.moves(idx);
    match (&named[..], named_point(table)) {
        ([_, _, ..], _) => rivals(table, named),
        // A program that was to work it out from the point, and did not.
        (&[idx], Some((x, y))) if stands(idx) && table.moves(x) && table.moves(y) => {
            Ok(ReadingSource::Point { x, y, is_guess: false })
        }
        (&[idx], _) => Ok(angle_in(table, idx)),
        ([], Some((x, y))) => Ok(ReadingSource::Point { x, y, is_guess: false }),
        ([], None) if code_idx.is_some() => Ok(ReadingSource::Codes),
        ([], None) => unnamed(table, asked, has_rate),
    }
}

/// Of too many nobody can say which one is meant; of a few their rows may.
fn rivals(table: &Table, columns: Vec<usize>) -> Result<ReadingSource, Fault> {
    match columns.len() > MOST_COLUMNS {
        true => Err(ambiguous(table, "angle", &columns)),
        false => Ok(ReadingSource::Rivals { example: example(table, "angle", &columns, None), columns }),
    }
}

fn angle_in(table: &Table, idx: usize) -> ReadingSource {
    ReadingSource::Angle { idx, unit: angle_unit_of(table, idx) }
}

fn named_point(table: &Table) -> Option<(usize, usize)> {
    match Boxes::of(table) {
        Some(boxes) => Some((boxes.x, boxes.y)),
        None => the_one(table, Meaning::X).zip(the_one(table, Meaning::Y)).filter(|(x, _)| !is_part(table, *x)),
    }
}

/// What may be an angle though no name says so.
fn unnamed(table: &Table, asked: &Columns, has_rate: bool) -> Result<ReadingSource, Fault> {
    let has_names = table.names.is_some();
    let mut free = free_columns(table, asked, has_rate).into_iter();
    match (free.next(), free.next()) {
        // An oscilloscope's settings beside the columns say so.
        (Some(idx), _) if !has_names && table.says_volts() => {
            let example = example(table, "angle", &[idx], None);
            Err(NoAngle::OnlyRaw { available: table.available(), example }.into())
        }
        (Some(x), Some(y)) if !has_names && lie_on_circle(table, x, y) => {
            Ok(ReadingSource::Point { x, y, is_guess: true })
        }
        (Some(idx), _) if !has_names || table.n_columns == 1 => Ok(angle_in(table, idx)),
        _ => mute_column(table).map(|idx| angle_in(table, idx)).ok_or_else(|| no_angle(table)),
    }
}

/// Columns of numbers that are neither the time nor count.
fn free_columns(table: &Table, asked: &Columns, has_rate: bool) -> Vec<usize> {
    let fields = table.first_fields();
    let is_clock = |idx: &usize| fields.get(*idx).is_some_and(|field| clock::read(field).is_some());
    let first = (table.n_columns > 1 && !has_rate).then(|| unnamed_time(table));
    let told = asked.time.as_ref().and_then(|(column, _)| find(table, column).ok());
    let time_idx = told.or((0..table.n_columns).find(is_clock)).or(first);
    let rest_idx = first.and_then(|_| parted(table)).map(|parted| parted.rest);
    let is_free = |idx: &usize| ![time_idx, rest_idx].contains(&Some(*idx)) && !counts(&table.first_numbers(*idx));
    let is_number = |idx: &usize| fields.get(*idx).is_some_and(|field| Numerals::new().read(field) != Cell::Text);
    let may_be = |idx: &usize| is_free(idx) && is_number(idx) && table.is_of_numbers(*idx);
    (0..table.n_columns).filter(may_be).take(2).collect()
}

/// Rotary pendulums call the arm theta and the pendulum alpha, and others so the acceleration of theta. It is an angle
/// where it has a rate of its own, also without a theta, or no speed stands beside theta.
fn with_alpha(table: &Table, mut named: Vec<(usize, Option<AngleUnit>)>) -> Vec<(usize, Option<AngleUnit>)> {
    let names = table.names.as_deref().unwrap_or_default();
    let any = |is_it: fn(&str) -> bool| names.iter().any(|name| is_it(name));
    if any(words::is_rate_of_alpha) || !any(words::is_speed) {
        let beside_theta: Vec<_> = named.iter().filter_map(|(idx, _)| words::beside_theta(names.get(*idx)?)).collect();
        let is_alone = named.is_empty() && any(words::is_rate_of_alpha);
        let is_its =
            |name: &String| words::beside_alpha(name).is_some_and(|beside| is_alone || beside_theta.contains(&beside));
        let is_new = |idx: usize| table.is_of_numbers(idx) && named.iter().all(|(other, _)| *other != idx);
        let alphas = names.iter().enumerate().filter(|(idx, name)| is_its(name) && is_new(*idx));
        let alphas: Vec<_> = alphas.map(|(idx, _)| (idx, None)).collect();
        named.extend(alphas);
    }
    named
}

/// x, y and z of an orientation are no angles where a w stands beside them.
fn without_quaternion(table: &Table, mut named: Vec<(usize, Option<AngleUnit>)>) -> Vec<(usize, Option<AngleUnit>)> {
    if quaternion(table).is_some() {
        named.retain(|(idx, _)| !table.says(*idx, words::is_orientation));
    }
    named
}

/// The only column of numbers whose name says nothing (`data`, `value`; `y` beside a `u`, as whoever identifies systems calls
/// output and input), where nothing else was measured than what drives.
pub(super) fn mute_column(table: &Table) -> Option<usize> {
    let names = table.names.as_ref().filter(|_| rate_columns(table).is_empty())?;
    let has_input = names.iter().any(|name| name.eq_ignore_ascii_case("u"));
    let says_nothing = |name: &String| words::says_nothing(name) || (has_input && name.eq_ignore_ascii_case("y"));
    let is_mute = |(idx, name): &(usize, &String)| says_nothing(name) && table.is_of_numbers(*idx);
    let mut mute = names.iter().enumerate().filter(is_mute);
    let (idx, _) = mute.next().filter(|_| mute.next().is_none())?;
    let times = named_times(table);
    let is_other = |other: usize| {
        let is_time = times.contains(&other) || matches!(meaning(&names[other]), Meaning::Time { .. });
        other != idx
            && !is_time
            && table.moves(other)
            && table.is_of_numbers(other)
            && !words::is_of_drive(&names[other])
    };
    (!(0..names.len()).any(is_other)).then_some(idx)
}

/// Are two columns x and y of a point that swings? Angle and rate of a slow pendulum may lie on a circle too, but they go
/// round it.
fn lie_on_circle(table: &Table, x: usize, y: usize) -> bool {
    let (x, y) = (table.first_numbers(x), table.first_numbers(y));
    let n = x.len().min(y.len());
    if n < MIN_SAMPLES {
        return false;
    }
    let Some(circle) = Circle::through(&x[..n], &y[..n], None).ok() else { return is_arc(&x[..n], &y[..n]) };
    let angles_rad = circle.angles_rad(&x[..n], &y[..n]);
    angles_rad.iter().all(|angle_rad| angle_rad.abs() < FRAC_PI_2)
}

pub(super) fn as_angle(meaning: Meaning) -> Option<(Option<AngleUnit>, u8)> {
    match meaning {
        Meaning::Angle { unit, strength } => Some((unit, strength)),
        _ => None,
    }
}

/// From the name of the column, else from its first cell.
pub(super) fn angle_unit_of(table: &Table, idx: usize) -> Option<AngleUnit> {
    let in_name = match table.names.as_ref().and_then(|names| names.get(idx)).map(|name| meaning(name)) {
        Some(Meaning::Angle { unit, .. }) => unit,
        _ => None,
    };
    in_name.or_else(|| unit_in_cell(table, idx, words::angle_unit))
}
