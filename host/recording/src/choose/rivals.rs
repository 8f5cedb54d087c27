//! Of several columns that could be the angle, the one that their readings tell: the only one that moves, or the liveliest
//! of the three angles of an orientation. Names can't tell that, and the first rows may be those of a pendulum at rest.

use super::super::chosen::{ReadingSource, Sources};
use super::super::error::Fault;
use super::super::limits::{HARDLY, LARGEST_UNSTATED_RAD};
use super::super::median;
use super::super::options::ReadOptions;
use super::super::samples::Samples;
use super::super::table::Table;
use super::super::told::Told;
use super::super::units::AngleUnit;
use super::super::words::is_turn_of_body;
use super::angle::angle_unit_of;
use super::names::{SHOWN, bare_axes, listed, unnamed};
use super::reading::is_of_turns;

/// No pendulum turns farther.
const TURN_DEG: f64 = 360.0;

/// A step of more than this share of all that a column covers is an angle that wraps around: by a whole turn, and it
/// covers no more than that. A pendulum moves so far in half a period, which has more samples than two.
const WRAP: f64 = 0.5;

/// A column without a name is a lesser one where another one goes so many times as far. Of 76 files without names two rotary
/// pendulums were read by their arms, which go an eighth as far. Half of it: one more of them, driven; twice: the same two.
const FARTHER: f64 = 3.0;

/// It swings if it passes its middle so often, those two nine times; …
const PASSES: usize = 6;

/// … by this share of its range. With half of it noise passes more often; with twice of it what dies away does less often.
const PASSED_BY: f64 = 0.1;

/// … and its steps are small beside it: squares of them, as shares of its variance, are 2 of noise, and 0.4 of a swing
/// with ten readings a period. Of those files half and twice tell the same.
const SMOOTH: f64 = 0.5;

/// What follows from the angle (its rate, its acceleration, the same in another unit) has less than this share of its
/// variance for itself: rates that boards worked out have 0.003 to 0.081, the two pendulums 0.67. With half of it one of
/// these rates would be a rival; with twice of it none of the two is lost.
const OWN_SHARE: f64 = 0.1;

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
        let are_axes = is_of_turns(table) && bare_axes(table).as_ref() == Some(columns);
        let are_turns = are_axes || columns.iter().all(|idx| names.get(*idx).is_some_and(|name| is_turn_of_body(name)));
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

    /// Without names the first column that may be the angle is taken; but not where another one swings that goes much farther
    /// and does not follow from it: of an arm and its pendulum, say. Where only the other one swings it is the angle.
    pub(crate) fn swinging(
        self,
        table: &Table,
        samples: &mut Samples,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let (ReadingSource::Angle { idx, .. }, None) = (&self.reading, &table.names) else { return Ok(self) };
        let (idx, taken) = (*idx, samples.readings.first().map_or(&[][..], Vec::as_slice));
        let swings = Swinging::of(taken).is_some();
        let is_turns = |values: &[f64]| values.iter().any(|value| value.abs() > LARGEST_UNSTATED_RAD);
        let may_be_degrees = |values: &[f64]| values.iter().all(|value| value.abs() <= TURN_DEG);
        // In the same unit, which nothing tells, where both swing; counts are no rival of what moves.
        let is_rival = |values: &[f64]| {
            let is_alike = is_turns(values) == is_turns(taken) || !swings && may_be_degrees(values);
            (range(taken) == 0.0 || is_alike)
                && Swinging::of(values).is_some_and(|swinging| range(taken) == 0.0 || swinging.is_own(taken))
        };
        let mut places: Vec<usize> = (0..self.others.len()).filter(|place| is_rival(&samples.others[*place])).collect();
        if let (Some(first), false) = (places.first().copied(), swings) {
            let is_own = |values: &[f64]| Swinging::of(values).is_some_and(|own| own.is_own(&samples.others[first]));
            places.retain(|place| *place == first || is_own(&samples.others[*place]));
        }
        if !places.iter().any(|place| range(&samples.others[*place]) > FARTHER * range(taken)) {
            return Ok(self);
        }
        if let ([place], false) = (&places[..], swings) {
            let reading = self.others[*place];
            notes.retain(|note| Some(note) != unnamed(table, idx).as_ref());
            notes.push(format!("column {reading} read as the angle, the only one that swings"));
            samples.readings = vec![samples.others[*place].clone()];
            let unit = options.angle_unit.or(angle_unit_of(table, reading));
            let reading = ReadingSource::Angle { idx: reading, unit };
            return Ok(Self { reading, ..self });
        }
        let rivals = places.iter().map(|place| self.others[*place]);
        let columns: Vec<usize> = swings.then_some(idx).into_iter().chain(rivals).collect();
        let told = columns.iter().map(|reading| Told { reading: *reading, ..self.told() }.angle("", ""));
        Err(undecided(table, &columns, &told.take(SHOWN).collect::<Vec<_>>().join(" or ")))
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

/// A column that goes to and fro.
struct Swinging<'a> {
    values: &'a [f64],
    /// From one passage of the middle to the next, in rows.
    n_between: usize,
}

impl<'a> Swinging<'a> {
    /// `None` where it does not, or not smoothly.
    fn of(values: &'a [f64]) -> Option<Self> {
        let (middle, margin) = (median(&mut values.to_vec()), PASSED_BY * range(values));
        let far = values.iter().enumerate().filter(|(_, value)| (*value - middle).abs() > margin);
        let sides: Vec<(usize, bool)> = far.map(|(row, value)| (row, *value > middle)).collect();
        let passed: Vec<usize> = sides.windows(2).filter(|pair| pair[0].1 != pair[1].1).map(|pair| pair[1].0).collect();
        let mut between: Vec<f64> = passed.windows(2).map(|pair| (pair[1] - pair[0]) as f64).collect();
        let steps: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
        let variance: f64 = values.iter().map(|value| (value - middle).powi(2)).sum();
        let swings = passed.len() >= PASSES && steps < SMOOTH * variance;
        swings.then(|| Self { values, n_between: median(&mut between) as usize })
    }

    /// Is more of it its own than what an angle, and how it changes, leave of it?
    fn is_own(&self, angles: &[f64]) -> bool {
        let n = self.values.len().min(angles.len());
        // Between neighbours a coarse sensor changes by chance.
        let n_apart = (self.n_between / 4).max(1);
        let change = |k: usize| angles[(k + n_apart).min(n - 1)] - angles[k.saturating_sub(n_apart)];
        let changes: Vec<f64> = (0..n).map(change).collect();
        let columns = [&angles[..n], &changes[..], &self.values[..n]].map(centred);
        let product = |a: usize, b: usize| columns[a].iter().zip(&columns[b]).map(|(a, b)| a * b).sum::<f64>();
        let share = |of: usize, on: usize| if product(on, on) > 0.0 { product(of, on) / product(on, on) } else { 0.0 };
        // What the change has beyond the angle, and of that what the column has.
        let change_alone = product(1, 1) - share(1, 0) * product(1, 0);
        let both = product(2, 1) - share(1, 0) * product(2, 0);
        let of_change = if change_alone > 0.0 { both * both / change_alone } else { 0.0 };
        product(2, 2) - share(2, 0) * product(2, 0) - of_change > OWN_SHARE * product(2, 2)
    }
}

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| value - mean).collect()
}

/// From the smallest to the largest of its numbers; 0 where there are none.
fn range(readings: &[f64]) -> f64 {
    let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    (high - low).max(0.0)
}
