//! A time in two columns, as robots and microcontrollers log it: whole seconds, or a clock that shows no more, and beside
//! them the rest in ns, µs or ms.

use super::super::chosen::Parted;
use super::super::clock::{self, Moment};
use super::super::limits::MIN_SAMPLES;
use super::super::median_step_s;
use super::super::table::Table;
use super::super::units::{TimeUnit, time_unit};
use super::super::words::{Meaning, meaning};
use super::standing::unnamed_time;

/// Units of a rest of a second.
const UNITS: [TimeUnit; 3] = [TimeUnit::Nanoseconds, TimeUnit::Microseconds, TimeUnit::Milliseconds];

/// How much longer or shorter than usual a step from one second to the next may be: a clock trembles by less, and in a wrong
/// unit such a step is as long as a whole second. Half of the fifth refuses what trembles more, twice of it the same.
const NEAR: f64 = 1.2;

/// The columns of a time that stands in two of them, side by side.
pub(super) fn parted(table: &Table) -> Option<Parted> {
    match &table.names {
        Some(names) => (1..names.len()).find_map(|rest| named(table, names, rest)),
        None if table.n_columns > 2 => unnamed(table, unnamed_time(table)),
        None => None,
    }
}

/// The rest of each second beside a clock that shows whole ones: `12:00:07` and 120 ms.
pub(super) fn beside_clock(table: &Table, clock: usize) -> Option<Parted> {
    let shown = table.first_cells(clock).map_while(clock::read).map(Moment::seconds);
    let seconds: Vec<f64> = shown.collect();
    let parted = |rest: usize| {
        let unit =
            table.names.as_ref().and_then(|names| unit_of(names.get(rest)?)).filter(|unit| UNITS.contains(unit))?;
        let parted = Parted { seconds: clock, rest, unit };
        let (is_one, _) = are_parts(&seconds, &table.first_numbers(rest), unit)?;
        is_one.then_some(parted)
    };
    (0..table.n_columns).filter(|idx| *idx != clock).find_map(parted)
}

/// The unit of a time that a name says.
fn unit_of(name: &str) -> Option<TimeUnit> {
    match meaning(name) {
        Meaning::Time { unit, .. } => unit,
        _ => time_unit(&name.to_lowercase()),
    }
}

/// Names say which they are, and nothing in the first rows speaks against it.
fn named(table: &Table, names: &[String], rest: usize) -> Option<Parted> {
    let seconds = rest - 1;
    let unit = unit_of(&names[rest]).filter(|unit| UNITS.contains(unit))?;
    let parted = Parted { seconds, rest, unit };
    let is_one = unit_of(&names[seconds]) == Some(TimeUnit::Seconds) && are_parts_of(table, parted)?.0;
    is_one.then_some(parted)
}

/// Without names the steps from one second to the next tell the unit: only in one they are as long as the others.
fn unnamed(table: &Table, seconds: usize) -> Option<Parted> {
    let of = |unit: TimeUnit| Parted { seconds, rest: seconds + 1, unit };
    let fits = |parted: &Parted| are_parts_of(table, *parted).is_some_and(|(is_one, goes_on)| is_one && goes_on);
    UNITS.into_iter().map(of).find(fits)
}

/// Do whole seconds and a rest below one second give a time that rises; and does it go on evenly from second to second?
fn are_parts_of(table: &Table, parted: Parted) -> Option<(bool, bool)> {
    are_parts(&table.first_numbers(parted.seconds), &table.first_numbers(parted.rest), parted.unit)
}

fn are_parts(seconds: &[f64], rests: &[f64], unit: TimeUnit) -> Option<(bool, bool)> {
    let n = seconds.len().min(rests.len());
    if n < MIN_SAMPLES {
        return None;
    }
    let scale = unit.seconds();
    let are_whole = seconds.iter().all(|second| second.fract() == 0.0);
    let are_rests = rests.iter().all(|rest| (0.0..1.0).contains(&(rest * scale)));
    let times: Vec<f64> = (0..n).map(|row| seconds[row] - seconds[0] + rests[row] * scale).collect();
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual = median_step_s(&times);
    let over: Vec<f64> = (1..n).filter(|row| seconds[*row] > seconds[row - 1]).map(|row| steps[row - 1]).collect();
    // A counter of frames rises with each row.
    let are_some = !over.is_empty() && 2 * over.len() < n;
    let goes_on = are_some && over.iter().all(|step| *step < NEAR * usual && usual < NEAR * step);
    Some((are_whole && are_rests && usual > 0.0 && steps.iter().all(|step| *step >= 0.0), goes_on))
}

#[cfg(test)]
mod tests {
    use super::super::super::source::Lines;
    use super::*;

    /// 50 samples a second, from 0.4 s before a whole one.
    fn found(heading: &str, a_second: f64, row: impl Fn(u64, u64) -> String) -> Option<Parted> {
        let rows = (0..60).map(|idx| {
            let time = 7.6 + f64::from(idx) / 50.0 + 1e-7;
            row(time as u64, (time.fract() * a_second) as u64) + "\n"
        });
        let text = format!("{heading}{}", rows.collect::<String>());
        parted(&Table::new(Lines::of(text.as_bytes(), &mut Vec::new()).unwrap()).unwrap())
    }

    #[test]
    fn seconds_and_the_rest_of_them_are_found_by_names_or_by_how_they_go_on() {
        let row = |second: u64, rest: u64| format!("{second},{rest},0.5");
        let of = |unit| Some(Parted { seconds: 0, rest: 1, unit });
        assert_eq!(found("secs,nsecs,angle\n", 1e9, row), of(TimeUnit::Nanoseconds));
        assert_eq!(found("header.stamp.sec,header.stamp.nanosec,angle\n", 1e9, row), of(TimeUnit::Nanoseconds));
        assert_eq!(found("sec,usec,angle\n", 1e6, row), of(TimeUnit::Microseconds));
        assert_eq!(found("", 1e9, row), of(TimeUnit::Nanoseconds));
        assert_eq!(found("", 1e6, row), of(TimeUnit::Microseconds));
        assert_eq!(found("", 1e3, row), of(TimeUnit::Milliseconds));
    }

    #[test]
    fn two_clocks_and_numbers_that_do_not_go_on_are_no_such_columns() {
        let clocks = |second: u64, rest: u64| format!("{second},{},0.5", 1000 * second + rest);
        assert_eq!(found("sec,ms,angle\n", 1e3, clocks), None);
        // A thousandth of what would be a second: from one second to the next it would stand for a second.
        assert_eq!(found("", 1e6, |second, rest| format!("{second},{},0.5", rest / 7)), None);
        assert_eq!(found("sec,usec,angle\n", 1e6, |second, rest| format!("{second}.5,{rest},0.5")), None);
        assert_eq!(found("sec,angle (deg),x\n", 1e9, |second, rest| format!("{second},{rest},0.5")), None);
        // Frames, beside them counts of an encoder.
        assert_eq!(found("", 50.0, |second, rest| format!("{},{},0.5", 50 * second + rest, 500 + rest)), None);
    }
}
