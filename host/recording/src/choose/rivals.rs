//! Of several columns that could be the angle, the one that their readings tell: the only one that moves, or the liveliest
//! of the three angles of an orientation. Names can't tell that, and the first rows may be those of a pendulum at rest.

use super::super::chosen::{ReadingSource, Sources};
use super::super::error::Fault;
use super::super::limits::HARDLY;
use super::super::options::ReadOptions;
use super::super::samples::Samples;
use super::super::table::Table;
use super::super::units::AngleUnit;
use super::super::words::is_turn_of_body;
use super::angle_unit_of;
use super::names::listed;

/// A step of more than this share of all that a column covers is an angle that wraps around: by a whole turn, and it
/// covers no more than that. A pendulum moves so far in half a period, which has more samples than two.
const WRAP: f64 = 0.5;

impl Sources {
    /// Decides between rivals by all of their rows, and leaves the readings of the one that is the angle.
    pub(crate) fn settled(
        self,
        table: &Table,
        samples: &mut Samples,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let ReadingSource::Rivals { columns, example } = &self.reading else { return Ok(self) };
        let movements: Vec<f64> = samples.readings.iter().map(|readings| movement(readings)).collect();
        let ranges: Vec<f64> = samples.readings.iter().map(|readings| range(readings)).collect();
        let widest = ranges.iter().fold(0.0_f64, |widest, range| widest.max(*range));
        let units: Vec<_> = columns.iter().map(|idx| angle_unit_of(table, *idx)).collect();
        let are_alike = units.windows(2).all(|pair| pair[0] == pair[1]);
        let is_still = |place: &usize| ranges[*place] == 0.0 || (are_alike && ranges[*place] < HARDLY * widest);
        let places: Vec<usize> = (0..columns.len()).filter(is_still).collect();
        let still: Vec<usize> = places.iter().map(|place| columns[*place]).collect();
        let liveliest = (0..columns.len()).max_by(|a, b| movements[*a].total_cmp(&movements[*b])).unwrap_or(0);
        let idx = columns[liveliest];
        let names = table.names.as_deref().unwrap_or_default();
        let are_turns = columns.iter().all(|idx| names.get(*idx).is_some_and(|name| is_turn_of_body(name)));
        let taken = table.column_name(idx);
        if let Some(place) = the_same(&samples.readings, &units).filter(|_| options.angle_unit.is_none()) {
            let others: Vec<usize> = columns.iter().copied().filter(|idx| *idx != columns[place]).collect();
            let (is, taken) = (if others.len() == 1 { "is" } else { "are" }, table.column_name(columns[place]));
            notes.push(format!("{taken} taken as the angle: {} {is} the same in another unit", listed(table, &others)));
            let reading = ReadingSource::Angle { idx: columns[place], unit: units[place] };
            samples.readings = vec![samples.readings.swap_remove(place)];
            return Ok(Self { reading, ..self });
        }
        if still.len() + 1 == columns.len() {
            let never = if places.iter().all(|place| ranges[*place] == 0.0) { "never" } else { "hardly" };
            let moves = if still.len() == 1 { "moves" } else { "move" };
            notes.push(format!("{taken} taken as the angle, because {} {never} {moves}", listed(table, &still)));
        } else if are_turns {
            notes.push(format!("of {} angles of the sensor {taken} moves most and is taken", columns.len()));
        } else {
            return Err(undecided(table, columns, example));
        }
        samples.readings = vec![samples.readings.swap_remove(liveliest)];
        let reading = ReadingSource::Angle { idx, unit: options.angle_unit.or(angle_unit_of(table, idx)) };
        Ok(Self { reading, ..self })
    }

    /// Is the angle still one of several columns?
    pub(crate) fn undecided(&self, table: &Table) -> Option<Fault> {
        match &self.reading {
            ReadingSource::Rivals { columns, example } => Some(undecided(table, columns, example)),
            _ => None,
        }
    }
}

/// Of columns that are the same but for their units, the one with the largest; an unstated unit is the radian.
fn the_same(readings: &[Vec<f64>], units: &[Option<AngleUnit>]) -> Option<usize> {
    let scale = |place: usize| units[place].unwrap_or(AngleUnit::Radians).radians();
    let limit_rad = HARDLY * range(&readings[0]) * scale(0);
    let in_rad = |place: usize| readings[place].iter().map(move |reading| reading * scale(place));
    let is_same = |place: usize| in_rad(place).zip(in_rad(0)).all(|(a, b)| (a - b).abs() < limit_rad);
    let places = 0..readings.len();
    // What is the same in one unit was copied, or is a recording of its own.
    let is_repeated = |place: usize| units[..place].contains(&units[place]);
    if places.clone().any(is_repeated) {
        return None;
    }
    places.clone().all(is_same).then(|| places.max_by(|a, b| scale(*a).total_cmp(&scale(*b))))?
}

/// Nothing tells which of these columns is the angle.
pub(super) fn undecided(table: &Table, columns: &[usize], example: &str) -> Fault {
    Fault::AmbiguousColumn { role: "angle", candidates: listed(table, columns), example: example.to_owned() }
}

/// How far a column goes in all, up and down; one that drifts goes far, but only once.
pub(super) fn movement(readings: &[f64]) -> f64 {
    let widest = WRAP * range(readings);
    readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step <= widest).sum()
}

/// From the smallest to the largest of its numbers; 0 where there are none.
fn range(readings: &[f64]) -> f64 {
    let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    (high - low).max(0.0)
}
