//! Columns by their names: as the user writes them, or by what they mean.

use super::super::columns::ColumnRef;
use super::super::error::{Fault, NoAngle};
use super::super::plausible::SHORTEST_PERIOD_S;
use super::super::runs::is_one_of_several;
use super::super::table::Table;
use super::super::words::{
    Meaning, is_acceleration, is_any_acceleration, is_distance, is_duration, is_estimate, is_estimate_of, is_length,
    is_of_carrier, is_of_drive, is_of_pendulum, is_other_quantity, is_raw, is_turn_sensor, meaning, says_nothing_else,
};
use super::parted::parted;
use super::quaternion::quaternion;
use super::standing::{rises_evenly, time_without_name, unnamed_time};

/// Estimates that are looked at, at most: a state has some numbers.
const MOST_ESTIMATES: usize = 32;

/// So many examples are shown of what could be told.
pub(super) const SHOWN: usize = 3;

/// The only column whose name means this.
pub(super) fn the_one(table: &Table, wanted: Meaning) -> Option<usize> {
    let mut all = table.names.iter().flatten().enumerate().filter(|(_, name)| meaning(name) == wanted);
    all.next().map(|(idx, _)| idx).filter(|_| all.next().is_none())
}

/// Columns `x`, `y` and `z` that say nothing else: of a sensor's three axes, if not of a point in space.
pub(super) fn bare_axes(table: &Table) -> Option<Vec<usize>> {
    let names = table.names.as_deref()?;
    let place = |wanted: &str| names.iter().position(|name| name.trim().eq_ignore_ascii_case(wanted));
    ["x", "y", "z"].into_iter().map(place).collect()
}

/// The first of columns `ax` and `ay`, or all three, that say nothing else; one of them alone may be anything.
fn bare_accelerations(table: &Table) -> Option<usize> {
    let names = table.names.as_deref()?;
    let place = |wanted: &str| names.iter().position(|name| name.trim().eq_ignore_ascii_case(wanted));
    let found: Vec<usize> = ["ax", "ay", "az"].into_iter().filter_map(place).collect();
    found.first().copied().filter(|_| found.len() > 1)
}

/// No column can be the angle; of accelerations and periods it is said why they can't, and of volts and counts how they
/// can.
pub(super) fn no_angle(table: &Table) -> Fault {
    let available = table.available();
    let runs: Vec<usize> = table
        .names
        .iter()
        .flatten()
        .enumerate()
        .filter(|(_, name)| is_one_of_several(name))
        .map(|(idx, _)| idx)
        .collect();
    if runs.len() > 1 {
        return ambiguous(table, "angle", &runs);
    }
    let first = |is_it: fn(&str) -> bool| table.names.iter().flatten().position(|name| is_it(name));
    let raw = the_raw(table);
    match (first(is_acceleration).or_else(|| bare_accelerations(table)), periods(table), raw, quaternion(table)) {
        // A phone's battery has volts too.
        (Some(_), _, raw, _) if raw.is_none_or(|idx| !table.says(idx, is_turn_sensor)) => {
            NoAngle::OnlyAccelerations { available }.into()
        }
        (_, Some(_), ..) => NoAngle::OnlyDurations { available }.into(),
        (.., Some(drive), _) if let Some(moved) = moved_by(table, drive) => {
            let (drive, moved, example) =
                (table.column_name(drive), table.column_name(moved), example(table, "angle", &[moved], None));
            NoAngle::BesideDrive { available, drive, moved, example }.into()
        }
        (.., Some(idx), _) => NoAngle::OnlyRaw { available, example: example(table, "angle", &[idx], None) }.into(),
        (.., Some(_)) => NoAngle::OnlyQuaternions { available }.into(),
        _ => {
            let one = || x_alone(table).or_else(|| distance_alone(table));
            let none = || NoAngle::NoColumn { available, example: unknown_that_moves(table) }.into();
            several_points(table).or_else(one).unwrap_or_else(none)
        }
    }
}

/// The column of volts or counts, of several the pendulum's, or the one that is not said to be of what carries it.
fn the_raw(table: &Table) -> Option<usize> {
    let names = table.names.as_deref()?;
    let raw = (0..names.len()).filter(|idx| is_raw(&names[*idx]) && table.is_of_numbers(*idx));
    let raw = raw.filter(|idx| !is_acceleration(&names[*idx]));
    raw.min_by_key(|idx| {
        let name = &names[*idx];
        (!is_of_pendulum(name), is_of_carrier(name), !is_turn_sensor(name))
    })
}

/// The first column that this one may move by its name, where that is the voltage or the current of a motor.
fn moved_by(table: &Table, drive: usize) -> Option<usize> {
    table.says(drive, is_of_drive).then(|| moving(table).next())?
}

/// An example with columns that move and whose names nobody knows, beside a time that goes on; a unit would be of something
/// else.
fn unknown_that_moves(table: &Table) -> Option<String> {
    let time = named_times(table).first().map(|time| table.first_numbers(*time))?;
    let goes_on = time.windows(2).all(|pair| pair[0] <= pair[1]);
    let is_else = |name: &str| is_any_acceleration(name) || name.contains(['(', '[']);
    let shown: Vec<usize> = moving(table).filter(|idx| !table.says(*idx, is_else)).take(SHOWN).collect();
    (goes_on && !shown.is_empty()).then(|| example(table, "angle", &shown, None))
}

/// Columns that move, and are no time and no other quantity by their names.
fn moving(table: &Table) -> impl Iterator<Item = usize> {
    let times = named_times(table);
    let is_else = |name: &str| is_of_drive(name) || is_raw(name) || is_acceleration(name) || is_other_quantity(name);
    let may_be = move |idx: &usize| {
        let numbers = table.first_numbers(*idx);
        let is_free = !times.contains(idx) && !table.says(*idx, |name| is_else(name) || is_time(name));
        is_free && table.is_of_numbers(*idx) && table.moves(*idx) && !rises_evenly(&numbers)
    };
    (0..table.n_columns).filter(may_be)
}

/// The column of periods, where there is one: named so, or `T` beside a length or above numbers that stay about the same.
fn periods(table: &Table) -> Option<usize> {
    let names = table.names.as_deref()?;
    let has_length = names.iter().any(|name| is_length(name));
    let symbol = || (0..names.len()).find(|idx| is_symbol(&names[*idx]) && (has_length || are_alike(table, *idx)));
    // A time that stands beside a length, and nothing that moved.
    let time = || (0..names.len()).find(|idx| is_time(&names[*idx]) && has_length && are_few(table, *idx));
    names.iter().position(|name| is_duration(name)).or_else(symbol).or_else(time)
}

fn is_time(name: &str) -> bool {
    matches!(meaning(name), Meaning::Time { .. })
}

fn are_few(table: &Table, idx: usize) -> bool {
    (2..MOST_PERIODS).contains(&table.first_numbers(idx).len())
}

/// Is it the time by its name and yet a few periods, `T` or `Period (s)` above numbers that stay about the same?
pub(super) fn is_of_periods(table: &Table, idx: usize) -> bool {
    let name = table.names.as_ref().and_then(|names| names.get(idx));
    let has = |is_it: fn(&str) -> bool| name.is_some_and(|name| is_it(name));
    let least = || SHORTEST_PERIOD_S / seconds_of(name);
    (has(is_duration) || has(is_symbol)) && are_alike(table, idx)
        || has(is_duration) && lie_together(&table.first_numbers(idx), least())
}

/// Seconds of the unit that a name says.
fn seconds_of(name: Option<&String>) -> f64 {
    match name.map(|name| meaning(name)) {
        Some(Meaning::Time { unit: Some(unit), .. }) => unit.seconds(),
        _ => 1.0,
    }
}

fn is_symbol(name: &str) -> bool {
    name.split(|letter: char| !letter.is_alphabetic()).next() == Some("T")
}

fn are_alike(table: &Table, idx: usize) -> bool {
    are_few(table, idx) && lie_together(&table.first_numbers(idx), 0.0)
}

/// Are all alike, and longer than this?
fn lie_together(numbers: &[f64], least: f64) -> bool {
    let (low, high) = numbers.iter().fold((f64::MAX, 0.0_f64), |(low, high), x| (low.min(*x), high.max(*x)));
    numbers.len() > 1 && low > least && high < PERIODS_ALIKE * low
}

/// Of a pendulum whose length or release angle is changed, nobody measures more periods …
const MOST_PERIODS: usize = 100;

/// … and from the smallest to the largest release angle they grow by less than this factor, while a time grows from 0.
const PERIODS_ALIKE: f64 = 3.0;

/// How far a point is to one side is no angle, but nearly is one where it swings little.
fn x_alone(table: &Table) -> Option<Fault> {
    let x =
        the_one(table, Meaning::X).or_else(|| the_one(table, Meaning::Y)).filter(|idx| table.is_of_numbers(*idx))?;
    Some(only_x(table, x))
}

/// So is how far away it is, as a ranger tells, or how far from its middle.
fn distance_alone(table: &Table) -> Option<Fault> {
    let names = table.names.as_deref()?;
    let is_its = |idx: &usize| is_distance(&names[*idx]) && !is_of_carrier(&names[*idx]) && table.is_of_numbers(*idx);
    (0..names.len()).find(is_its).map(|idx| only_x(table, idx))
}

fn only_x(table: &Table, idx: usize) -> Fault {
    NoAngle::OnlyX { column: table.column_name(idx), example: example(table, "angle", &[idx], None) }.into()
}

/// x and y of several points: each x goes with the y behind it.
fn several_points(table: &Table) -> Option<Fault> {
    let names = table.names.as_deref()?;
    let all = |wanted: Meaning| (0..names.len()).filter(move |idx| meaning(&names[*idx]) == wanted);
    let y_of = |x: usize| all(Meaning::Y).find(|y| *y > x);
    let points: Vec<(usize, usize)> = all(Meaning::X).filter_map(|x| Some((x, y_of(x)?))).collect();
    let time = names.iter().position(|name| matches!(meaning(name), Meaning::Time { .. }));
    let time = time.map_or(String::new(), |idx| format!("t={idx},"));
    let example: Vec<String> = points.iter().take(SHOWN).map(|(x, y)| format!("{time}x={x},y={y}")).collect();
    let columns: Vec<usize> = points.iter().flat_map(|(x, y)| [*x, *y]).collect();
    (points.len() > 1).then(|| Fault::AmbiguousColumn {
        role: "x and y of the pendulum",
        candidates: listed(table, &columns),
        example: example.join(" or "),
    })
}

/// Nothing tells which of these columns is meant.
pub(super) fn ambiguous(table: &Table, role: &'static str, several: &[usize]) -> Fault {
    Fault::AmbiguousColumn { role, candidates: listed(table, several), example: example(table, role, several, None) }
}

/// The columns whose names fit best, with the unit that stands there.
pub(super) fn all_best<U: Copy>(
    table: &Table,
    fits: impl Fn(Meaning) -> Option<(Option<U>, u8)>,
) -> Vec<(usize, Option<U>)> {
    let names = table.names.as_deref().unwrap_or_default();
    // A sensor that was never connected leaves the estimate alone.
    let is_of_any = |name: &str| (0..names.len()).any(|idx| is_estimate_of(name, &names[idx]) && table.moves(idx));
    // Of thousands of columns few are.
    let estimates: Vec<usize> = (0..names.len()).filter(|idx| is_estimate(&names[*idx])).take(MOST_ESTIMATES).collect();
    let estimates: Vec<usize> = estimates.into_iter().filter(|idx| is_of_any(&names[*idx])).collect();
    let named = || names.iter().enumerate().filter(|(idx, _)| !estimates.contains(idx));
    let all = || named().filter_map(|(idx, name)| fits(meaning(name)).map(|fit| (idx, fit)));
    let is_pendulums = |idx: usize| is_of_pendulum(&names[idx]);
    let is_free = |idx: usize| !is_of_carrier(&names[idx]);
    let is_any = |is_it: &dyn Fn(usize) -> bool| all().any(|(idx, _)| is_it(idx));
    let (names_pendulum, names_free) = (is_any(&is_pendulums), is_any(&is_free));
    // Programs keep the columns of a second run that was never made.
    let is_there = |idx: usize| table.is_filled(idx);
    let any_is_there = is_any(&is_there);
    let may_be = |idx: usize| {
        (is_there(idx) || !any_is_there) && if names_pendulum { is_pendulums(idx) } else { is_free(idx) || !names_free }
    };
    let fitting = || all().filter(|(idx, _)| may_be(*idx));
    let strongest = fitting().map(|(_, (_, strength))| strength).max();
    let strongest = fitting().filter(|(_, (_, strength))| Some(*strength) == strongest);
    let winners: Vec<(usize, Option<U>)> = strongest.map(|(idx, (unit, _))| (idx, unit)).collect();
    let exact: Vec<_> = winners.iter().filter(|(idx, _)| says_nothing_else(&names[*idx])).copied().collect();
    if exact.is_empty() { winners } else { exact }
}

/// Says which names were passed over because another one is the pendulum's, or says nothing else.
pub(super) fn note_rivals<U: Copy>(
    table: &Table,
    role: &str,
    taken: usize,
    fits: impl Fn(Meaning) -> Option<(Option<U>, u8)>,
    notes: &mut Vec<String>,
) {
    let strength = |name: &String| fits(meaning(name)).map(|(_, strength)| strength);
    let names = table.names.as_deref().unwrap_or_default();
    let Some(own) = names.get(taken).and_then(strength) else { return };
    let all = |is_it: &dyn Fn(&String) -> bool| -> Vec<usize> {
        let rivals = names.iter().enumerate().filter(|(idx, name)| *idx != taken && is_it(name));
        rivals.map(|(idx, _)| idx).collect()
    };
    let says_least = says_nothing_else(&names[taken]);
    let is_pendulums = is_of_pendulum(&names[taken]);
    let is_others = |name: &String| {
        let is_told_apart = if is_pendulums { !is_of_pendulum(name) } else { is_of_carrier(name) && !says_least };
        strength(name).is_some() && is_told_apart
    };
    let is_estimate = |name: &String| strength(name).is_some() && is_estimate_of(name, &names[taken]);
    let is_longer = |name: &String| says_least && strength(name) == Some(own) && !is_others(name) && !is_estimate(name);
    let others = if is_of_carrier(&names[taken]) { Vec::new() } else { all(&is_others) };
    let reasons = [
        (others, "the pendulum's by its name"),
        (all(&is_longer), "whose name says nothing else"),
        (all(&is_estimate), "which was measured"),
    ];
    for (rivals, why) in reasons {
        if !rivals.is_empty() {
            let (taken, rivals) = (table.column_name(taken), listed(table, &rivals));
            notes.push(format!("{taken} taken as the {role}, {why}, and not {rivals}"));
        }
    }
}

/// Says which of several columns of numbers without names is read as the angle.
pub(super) fn note_unnamed(table: &Table, taken: usize, time: Option<usize>, notes: &mut Vec<String>) {
    let is_other = |idx: usize| idx != taken && time != Some(idx) && table.is_of_numbers(idx);
    if (0..table.n_columns).any(is_other) {
        notes.extend(unnamed(table, taken));
    }
}

/// That note; none where the columns have names.
pub(super) fn unnamed(table: &Table, taken: usize) -> Option<String> {
    let n_columns = table.names.is_none().then_some(table.n_columns)?;
    Some(format!("column {taken} of {n_columns} read as the angle; --columns theta=... takes another one"))
}

pub(super) fn listed(table: &Table, columns: &[usize]) -> String {
    columns.iter().map(|idx| table.column_name(*idx)).collect::<Vec<_>>().join(", ")
}

/// The columns that are named as times, without those that stand still or step once where another one goes on; or the one
/// without a name where they count rows.
pub(super) fn named_times(table: &Table) -> Vec<usize> {
    let names = table.names.as_deref().unwrap_or_default();
    let named = || (0..names.len()).filter(|idx| matches!(meaning(&names[*idx]), Meaning::Time { .. }));
    let goes_on = |idx: &usize| table.first_numbers(*idx).windows(2).filter(|pair| pair[1] > pair[0]).count() > 1;
    let going: Vec<usize> = named().filter(goes_on).collect();
    let times = if going.is_empty() { named().collect() } else { going };
    time_without_name(table, &times).map_or(times, |time| vec![time])
}

/// What could be told of this very file: `t=0,theta=3`, for each of some candidates, and never a column that is wrong.
pub(super) fn example(table: &Table, role: &str, candidates: &[usize], wrong: Option<usize>) -> String {
    let names = table.names.as_deref().unwrap_or_default();
    let times = named_times(table);
    let time = times.first().copied().unwrap_or_else(|| unnamed_time(table));
    let rest = parted(table).map(|parted| parted.rest);
    // Several recordings side by side have times of their own.
    let own_time = |angle: usize| times.iter().copied().rfind(|time| *time < angle);
    // What rises evenly counts rows.
    let moves = |idx: usize| {
        let numbers = table.first_numbers(idx);
        numbers.windows(2).any(|pair| pair[0] != pair[1]) && !rises_evenly(&numbers)
    };
    let is_angle = |idx: usize| names.get(idx).is_some_and(|name| matches!(meaning(name), Meaning::Angle { .. }));
    // Counts of an accelerometer would be fitted as angles.
    let may_be_one = |idx: usize| moves(idx) && !table.says(idx, is_acceleration);
    // What moves it is not its angle, where anything else moves.
    let is_undriven = |idx: usize| may_be_one(idx) && !table.says(idx, is_of_drive);
    let told = |time: usize, candidates: &[usize]| {
        let may_be = |idx: &usize| ![Some(time), wrong, rest].contains(&Some(*idx)) && !candidates.contains(idx);
        let others = || (0..table.n_columns).filter(may_be);
        let first = |is_it: &dyn Fn(usize) -> bool| others().find(|idx| is_it(*idx));
        let angle =
            first(&|idx| is_angle(idx) && moves(idx)).or_else(|| first(&is_undriven)).or_else(|| first(&may_be_one));
        format!("t={time},theta={}", angle.map_or("COLUMN".to_owned(), |idx| idx.to_string()))
    };
    let each: Vec<String> = match role {
        "time" => candidates.iter().map(|time| told(*time, candidates)).collect(),
        _ if candidates.is_empty() => vec![told(time, &[])],
        _ => candidates.iter().map(|angle| format!("t={},theta={angle}", own_time(*angle).unwrap_or(time))).collect(),
    };
    each.into_iter().take(SHOWN).collect::<Vec<_>>().join(" or ")
}

pub(super) fn find(table: &Table, column: &ColumnRef) -> Result<usize, Fault> {
    let n_columns = table.names.as_ref().map_or(table.n_columns, |names| names.len().max(table.n_columns));
    let (found, wanted) = match column {
        ColumnRef::Index(idx) => ((*idx < n_columns).then_some(*idx), idx.to_string()),
        ColumnRef::Name(wanted) => (position_of_name(table, wanted), format!("\"{wanted}\"")),
    };
    found.ok_or_else(|| Fault::UnknownColumn {
        wanted,
        available: table.available(),
        example: example(table, "angle", &[], None),
    })
}

/// The whole name first, else the only name that begins so (`angle` for `angle (deg)`).
fn position_of_name(table: &Table, wanted: &str) -> Option<usize> {
    let wanted = wanted.to_lowercase();
    let names: Vec<String> = table.names.iter().flatten().map(|name| name.to_lowercase()).collect();
    let mut beginning = names.iter().enumerate().filter(|(_, name)| name.starts_with(&wanted)).map(|(idx, _)| idx);
    let only = beginning.next().filter(|_| beginning.next().is_none());
    names.iter().position(|name| *name == wanted).or(only)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Lines;

    fn notes_of(heading: &str, taken: usize) -> Vec<String> {
        let text = format!("{heading}\n0,1,2\n0.1,2,3\n0.2,3,4\n");
        let table = Table::new(Lines::of(text.as_bytes(), &mut Vec::new()).unwrap()).unwrap();
        let as_angle = |meaning| match meaning {
            Meaning::Angle { unit, strength } => Some((unit, strength)),
            _ => None,
        };
        let mut notes = Vec::new();
        note_rivals(&table, "angle", taken, as_angle, &mut notes);
        notes
    }

    fn told(heading: &str) -> String {
        let row = |idx: i32| format!("{},{},{}\n", 0.1 * f64::from(idx), (7 * idx) % 5, (3 * idx) % 4);
        let text = format!("{heading}\n{}", (0..20).map(row).collect::<String>());
        no_angle(&Table::new(Lines::of(text.as_bytes(), &mut Vec::new()).unwrap()).unwrap()).to_string()
    }

    #[test]
    fn a_potentiometer_beside_an_accelerometer_is_what_may_be_the_angle() {
        for heading in ["Time (s),Pot (V),Accel (V)", "Zeit (s),Drehgeber,Beschleunigung"] {
            assert!(told(heading).contains("theta=1:54.5deg"), "{}", told(heading));
        }
        assert!(told("Time (s),Accel (V),Encoder").contains("theta=2:54.5deg"));
        assert!(told("Time (s),Battery (V),Accel (m/s²)").contains("accelerations, which can't be fitted"));
    }

    #[test]
    fn the_voltage_of_a_motor_is_not_advised_where_something_else_moves() {
        let driven = told("t,alpha,voltage");
        assert!(driven.contains("2 (voltage) drives") && driven.contains("--columns t=0,theta=1"), "{driven}");
        assert!(told("t,temperature,voltage").contains("theta=2:54.5deg"));
        assert!(told("t,motor current,voltage").contains("theta=2:54.5deg"));
    }

    #[test]
    fn a_rival_is_told_where_a_name_decides_and_nowhere_else() {
        assert_eq!(notes_of("t,theta_noisy,theta_other", 1), [""; 0]);
        let told = notes_of("t,theta,theta_hat", 1);
        assert!(told.len() == 1 && told[0].contains("which was measured, and not 2 (theta_hat)"), "{told:?}");
        let told = notes_of("t,theta,theta_noisy", 1);
        assert!(
            told.len() == 1 && told[0].contains("whose name says nothing else, and not 2 (theta_noisy)"),
            "{told:?}"
        );
    }
}
