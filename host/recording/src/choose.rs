//! Which column is what: by what the user said, the header, the names, and at last the place.

mod boxes;
mod names;
mod parted;
mod rivals;
mod standing;
mod tilt;
mod time;

use super::angle::Angles;
use super::carrier::Carrier;
use super::cell::{Cell, Numerals};
use super::chosen::{Parted, ReadingSource, Sources, TimeSource};
use super::circle::{Circle, is_arc};
use super::clock;
use super::columns::Columns;
use super::drive::Drive;
use super::error::Fault;
use super::header::Header;
use super::limits::MIN_SAMPLES;
use super::options::ReadOptions;
use super::rate::Rates;
use super::runs;
use super::samples::{MOST_COLUMNS, Samples};
use super::table::Table;
use super::told::Told;
use super::units::{AngleUnit, RateUnit, TimeUnit};
use super::words::{self, Meaning, is_of_carrier, is_of_sine, is_size, meaning};
use boxes::Boxes;
use names::{
    all_best, ambiguous, bare_axes, example, find, is_of_periods, named_times, no_angle, note_rivals, note_unnamed,
    the_one,
};
use parted::{beside_clock, parted};
use rivals::{movement, undecided};
use shared::measured::Measured;
use standing::{counts, unnamed_time};
use std::f64::consts::{FRAC_PI_2, PI};
use time::{as_time, choose_time, plotted_axes, unit_in_cell};

/// What goes round is no point that swings, wherever it lies.
const NO_CIRCLE: Fault = Fault::NoCircle { off_percent: 100.0 };

/// What a voltage and the angle that was made of it have not in common: a hundredth of the motion is this share of its
/// square. With half of it a rounded angle would miss its voltage; with twice of it a motor that holds back would pass.
const MOST_APART: f64 = 1e-4;

/// What turns with the pendulum goes as far, and behind gears further. With twice of it rounding would make two of one, with
/// half of it a loose arm would be the same shaft.
const SAME_SHAFT: f64 = 0.9;

impl Sources {
    /// Chooses the columns of a table; what is assumed is noted.
    pub(super) fn choose(
        table: &Table,
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let asked = options.columns.clone().unwrap_or_default();
        let code = choose_code(table, header, &asked)?;
        let axes = plotted_axes(table, &asked);
        let (time, reading) = match axes {
            Some((time, angle)) => {
                let (time_name, angle_name) = (table.column_name(time), table.column_name(angle));
                let unit = angle_unit_of(table, angle).or(options.angle_unit);
                let (source, read) = match options.rate_hz.or(header.rate_hz) {
                    Some(rate_hz) => (TimeSource::Rate(rate_hz), "left out where the rate is told"),
                    None => (TimeSource::Column { idx: time, unit: None }, "read as the time"),
                };
                notes.push(format!("{time_name} goes on evenly: {read}, and {angle_name} as the angle"));
                (source, ReadingSource::Angle { idx: angle, unit })
            }
            None => {
                let reading = choose_reading(table, header, options, &asked, code);
                if let Err(fault @ Fault::OnlyDurations { .. }) = reading {
                    return Err(fault);
                }
                let reading_idx = reading.as_ref().ok().and_then(ReadingSource::first_idx);
                let time = choose_time(table, header, options, &asked, reading_idx, notes)?;
                if asked.time.is_none() && time.column().is_some_and(|idx| is_of_periods(table, idx)) {
                    return Err(Fault::OnlyDurations { available: table.available() });
                }
                (time, reading?)
            }
        };
        if let (ReadingSource::Angle { idx, .. }, None) = (&reading, &asked.angle) {
            note_rivals(table, "angle", *idx, as_angle, notes);
            if header.version.is_none() {
                tilt::fault(table, *idx, time.column()).map_or(Ok(()), Err)?;
                note_unnamed(table, *idx, time.column(), notes);
            }
            if table.n_columns > 1 && mute_column(table) == Some(*idx) {
                notes.push(format!("{} says nothing else and is read as the angle", table.column_name(*idx)));
            }
        }
        if let (ReadingSource::Point { is_guess: false, .. }, None) = (&reading, &asked.x)
            && let Some((idx, _)) = all_best(table, as_angle).first()
        {
            notes.push(format!("{} does not move: x and y of the point are read instead", table.column_name(*idx)));
        }
        if let (ReadingSource::Point { is_guess: false, .. }, None) = (&reading, &asked.x) {
            notes.extend(Boxes::of(table).map(|boxes| boxes.note(table)));
        }
        let (time, parted) = in_two_columns(table, time, notes);
        let is_named = asked.time.is_none() && parted.is_none() && all_best(table, as_time).len() == 1;
        if let (TimeSource::Column { idx, .. } | TimeSource::Clock { idx }, true) = (&time, is_named) {
            note_rivals(table, "time", *idx, as_time, notes);
        }
        if time.column().is_some_and(|idx| reading.first_idx() == Some(idx)) {
            return Err(no_angle(table));
        }
        // Beside an angle they are of use to a rig of ours alone, and would have to be kept through every repair.
        let code = code.filter(|_| header.version.is_some() || matches!(reading, ReadingSource::Codes));
        log::debug!("columns: time from {time:?}, readings from {reading:?}, code from {code:?}");
        let otherwise = example(table, "angle", &[], reading.columns().first().copied());
        let needed = reading.columns().into_iter().chain(time.column()).chain(code);
        let needed: Vec<usize> = needed.chain(parted.map(|parted| parted.rest)).collect();
        let run = runs::column(table, |idx| !needed.contains(&idx)).filter(|_| header.version.is_none());
        let is_free = |idx: &usize| !needed.contains(idx) && run != Some(*idx) && header.version.is_none();
        let is_told = asked.angle.is_some() || asked.x.is_some();
        let others: Vec<usize> = match (&table.names, &reading) {
            (None, ReadingSource::Angle { .. }) if !is_told => {
                (0..table.n_columns).filter(|idx| table.is_of_numbers(*idx)).collect()
            }
            _ => drives_and_carriers(table, &reading).collect(),
        };
        let others = others.into_iter().filter(is_free).take(MOST_COLUMNS).collect();
        Ok(Self { time, reading, parted, code, run, others, otherwise })
    }

    /// The same, where another run of the file shows that its angles are degrees and nothing else says so.
    pub(super) fn in_degrees(&self) -> Option<Self> {
        let ReadingSource::Angle { idx, unit: None } = self.reading else { return None };
        Some(Self { reading: ReadingSource::Angle { idx, unit: Some(AngleUnit::Degrees) }, ..self.clone() })
    }

    /// Angles (rad) or rates (rad/s) from the numbers that were read.
    pub(super) fn readings(
        &self,
        table: &Table,
        samples: &Samples,
        times_s: &[f64],
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Vec<f64>, Fault> {
        let is_ours = header.version.is_some();
        match &self.reading {
            ReadingSource::Codes => {
                let calibration = header.calibration.ok_or(Fault::NoCalibration)?;
                Ok(samples.codes.iter().map(|code| calibration.angle_rad(*code)).collect())
            }
            ReadingSource::Angle { idx, unit } => {
                let readings = &samples.readings[0];
                if !is_ours {
                    self.refuse_standing(table, *idx, readings)?;
                }
                let name = table.says(*idx, words::is_named_angle).then(|| table.column_name(*idx));
                let angles = Angles { times_s, is_ours, options, told: self.told(), notes };
                angles.of_column(name.as_deref(), readings, *unit)
            }
            ReadingSource::Point { x, y, is_guess: false } => {
                let angles = Angles { times_s, is_ours, options, told: self.told(), notes };
                let is_told = options.columns.as_ref().is_some_and(|columns| columns.x.is_some());
                let names = table.names.as_deref().unwrap_or_default();
                let are_sine_and_cosine =
                    [x, y].iter().all(|idx| names.get(**idx).is_some_and(|name| is_of_sine(name)));
                let pivot = are_sine_and_cosine.then_some([0.0; 2]);
                angles.of_point(&samples.readings[0], &samples.readings[1], pivot).map_err(|fault| {
                    match bare_axes(table).filter(|_| !is_told) {
                        Some(axes) => Fault::ThreeAxes { example: self.rate_example(&axes) },
                        None => fault,
                    }
                })
            }
            ReadingSource::Point { x, y, is_guess: true } => {
                let mut of_point = vec![format!("columns {x} and {y} lie on a circle: read as x and y of a point")];
                let point = Angles { times_s, is_ours, options, told: self.told(), notes: &mut of_point };
                let angles = point.of_point(&samples.readings[0], &samples.readings[1], None);
                // Angle and rate of a slow pendulum go round their circle.
                let goes_round = |angles: &Vec<f64>| angles.iter().any(|angle_rad| angle_rad.abs() > PI);
                match angles.and_then(|angles| if goes_round(&angles) { Err(NO_CIRCLE) } else { Ok(angles) }) {
                    Err(fault @ (Fault::NoCircle { .. } | Fault::ShortArc { .. }))
                        if is_arc(&samples.readings[0], &samples.readings[1]) =>
                    {
                        let told = Told { reading: *x, ..self.told() };
                        Err(Fault::SeemsPoint { x: *x, y: *y, fault: Box::new(fault), told })
                    }
                    Err(Fault::NoCircle { .. } | Fault::ShortArc { .. }) => {
                        self.refuse_standing(table, *x, &samples.readings[0])?;
                        let unit = angle_unit_of(table, *x);
                        Angles { times_s, is_ours, options, told: self.told(), notes }.of_column(
                            None,
                            &samples.readings[0],
                            unit,
                        )
                    }
                    angles => {
                        notes.extend(of_point);
                        angles
                    }
                }
            }
            ReadingSource::Rivals { columns, example } => Err(undecided(table, columns, example)),
            ReadingSource::Rates { columns, unit } => {
                let names = columns.iter().map(|idx| table.column_name(*idx)).collect();
                let told = columns.iter().map(|idx| Told { reading: *idx, ..self.told() }).collect();
                Rates { times_s, is_ours, options, names, told, notes }.of_columns(&samples.readings, *unit)
            }
        }
    }

    /// What drives or carries the pendulum, from the numbers that were read. A voltage that goes with the angle is its
    /// sensor's, and an angle that does is that of the same shaft.
    pub(super) fn others(&self, table: &Table, samples: &Samples, readings: &[f64]) -> (Vec<Drive>, Vec<Carrier>) {
        let (mut drives, mut carriers) = (Vec::new(), Vec::new());
        if table.names.is_none() {
            return (drives, carriers);
        }
        let raw = samples.readings.first().map_or(f64::NAN, |raw| movement(raw));
        for (idx, values) in self.others.iter().copied().zip(&samples.others) {
            let (name, values) = (table.column_name(idx), values.clone());
            let is_drive = table.says(idx, words::is_of_drive);
            let is_sensors = || table.says(idx, words::is_of_volts) && go_together(&values, readings);
            // An arm that is loose goes less far than the pendulum.
            let is_same_shaft = || movement(&values) > SAME_SHAFT * raw && go_together(&values, readings);
            match is_drive {
                true if !is_sensors() => drives.extend(Drive::of(name, values)),
                false if !is_same_shaft() => carriers.push(Carrier::new(name, values, raw / movement(readings))),
                _ => {}
            }
        }
        (drives, carriers)
    }

    /// What tells of one of these columns that it is an angular velocity.
    fn rate_example(&self, columns: &[usize]) -> String {
        let told = |idx: &usize| Told { reading: *idx, ..self.told() }.rate("");
        columns.iter().map(told).collect::<Vec<_>>().join(" or ")
    }

    /// An angle that is the same throughout is another column's.
    fn refuse_standing(&self, table: &Table, idx: usize, readings: &[f64]) -> Result<(), Fault> {
        let first = readings.first().copied().unwrap_or_default();
        if readings.len() < MIN_SAMPLES || readings.iter().any(|reading| *reading != first) {
            return Ok(());
        }
        let (column, available) = (table.column_name(idx), table.available());
        Err(Fault::NothingMoves { column, value: first, available, example: self.otherwise.clone() })
    }
}

/// Are these two the same but for zero, scale and sign? Then their correlation leaves no more than noise.
fn go_together(a: &[f64], b: &[f64]) -> bool {
    let n = a.len().min(b.len()) as f64;
    let mean = |list: &[f64]| list.iter().take(n as usize).sum::<f64>() / n;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sums = a.iter().zip(b).map(|(a, b)| (a - mean_a, b - mean_b));
    let (aa, ab, bb) = sums.fold((0.0, 0.0, 0.0), |(aa, ab, bb), (a, b)| (aa + a * a, ab + a * b, bb + b * b));
    ab * ab > (1.0 - MOST_APART) * aa * bb
}

/// The rest of each second, where the column that was chosen holds whole ones and that stands beside it.
fn in_two_columns(table: &Table, time: TimeSource, notes: &mut Vec<String>) -> (TimeSource, Option<Parted>) {
    if let TimeSource::Clock { idx } = time {
        let parted = beside_clock(table, idx);
        notes.extend(parted.map(|parted| {
            let rest = table.column_name(parted.rest);
            format!("the clock shows whole seconds, and {rest} holds the rest of each: added")
        }));
        return (time, parted);
    }
    let TimeSource::Column { idx, unit } = time else { return (time, None) };
    let is_its = |parted: &Parted| idx == parted.seconds && unit.is_none_or(|unit| unit == TimeUnit::Seconds);
    let Some(parted) = parted(table).filter(is_its) else { return (time, None) };
    let (seconds, rest) = (table.column_name(parted.seconds), table.column_name(parted.rest));
    notes.push(format!("{seconds} holds the whole seconds of the time, and {rest} the rest of them: added"));
    (TimeSource::Column { idx: parted.seconds, unit: Some(TimeUnit::Seconds) }, Some(parted))
}

/// Codes of which nothing tells what one is worth are counts like any other column's.
fn choose_code(table: &Table, header: &Header, asked: &Columns) -> Result<Option<usize>, Fault> {
    let are_calibrated = header.calibration.is_some() || header.version.is_some();
    match &asked.code {
        Some(column) => find(table, column).map(Some),
        None if !are_calibrated => Ok(None),
        None => Ok(table.names.iter().flatten().position(|name| meaning(name) == Meaning::Code)),
    }
}

/// Rates where the user, the header or the names say so, else angles.
fn choose_reading(
    table: &Table,
    header: &Header,
    options: &ReadOptions,
    asked: &Columns,
    code_idx: Option<usize>,
) -> Result<ReadingSource, Fault> {
    if let Some((column, unit)) = &asked.rate {
        let idx = find(table, column)?;
        return Ok(rates(table, options, vec![idx], *unit));
    }
    let is_told = asked.angle.is_some() || asked.x.is_some();
    if let (false, true, Some(axes)) = (is_told, table.is_of_gyroscope, bare_axes(table)) {
        return Ok(rates(table, options, axes, None));
    }
    let measured =
        (!is_told).then(|| header.measured.or(options.measured.filter(|_| header.version.is_none()))).flatten();
    let has_rate = options.rate_hz.or(header.rate_hz).is_some();
    let angle = choose_angle(table, asked, code_idx, has_rate);
    match (measured, angle) {
        (Some(Measured::Rate), angle) => match (rate_columns(table), angle) {
            (columns, _) if !columns.is_empty() => Ok(rates(table, options, columns, None)),
            // The header says what a column without a word, or one that is named after the angle, holds.
            (_, Ok(ReadingSource::Angle { idx, unit })) => {
                Ok(rates(table, options, vec![idx], unit.map(RateUnit::per_second)))
            }
            _ => Err(no_angle(table)),
        },
        (
            None,
            Err(
                fault @ (Fault::NoAngleColumn { .. }
                | Fault::OnlyAccelerations { .. }
                | Fault::OnlyDurations { .. }
                | Fault::OnlyRaw { .. }
                | Fault::OnlyX { .. }
                | Fault::OnlyQuaternions { .. }),
            ),
        ) => match rate_columns(table) {
            columns if columns.is_empty() => Err(three_axes(table).unwrap_or(fault)),
            columns => Ok(rates(table, options, columns, None)),
        },
        (_, Ok(ReadingSource::Angle { idx, unit })) => {
            Ok(ReadingSource::Angle { idx, unit: options.angle_unit.or(unit) })
        }
        (_, angle) => angle,
    }
}

/// Columns of rates with the unit that was told, or that their names have.
fn rates(table: &Table, options: &ReadOptions, columns: Vec<usize>, told: Option<RateUnit>) -> ReadingSource {
    let in_name = |idx: &usize| match meaning(table.names.as_ref()?.get(*idx)?) {
        Meaning::Rate { unit } => unit,
        _ => None,
    };
    let unit = options.angle_unit.map(RateUnit::per_second).or(told).or(columns.first().and_then(in_name));
    ReadingSource::Rates { columns, unit }
}

/// Columns that are named as angular velocities, without the size of all axes together, which has no sign; gx, gy and gz
/// are such where ax, ay and az stand beside them, and wx, wy and wz together.
fn rate_columns(table: &Table) -> Vec<usize> {
    let has = |wanted: &str| table.names.iter().flatten().any(|name| name.eq_ignore_ascii_case(wanted));
    let has_six_axes = ["ax", "ay", "az", "gx", "gy", "gz"].into_iter().all(has);
    let has_omega = ["wx", "wy", "wz"].into_iter().all(has);
    let is_one_of = |axes: [&str; 3], name: &str| axes.iter().any(|axis| name.eq_ignore_ascii_case(axis));
    let is_rate = |name: &String| {
        (matches!(meaning(name), Meaning::Rate { .. }) && !is_size(name))
            || (has_six_axes && is_one_of(["gx", "gy", "gz"], name))
            || (has_omega && is_one_of(["wx", "wy", "wz"], name))
    };
    table
        .names
        .iter()
        .flatten()
        .enumerate()
        .filter(|(_, name)| is_rate(name))
        .map(|(idx, _)| idx)
        .take(MOST_COLUMNS)
        .collect()
}

/// Columns of numbers that are named after a motor, and angles in the same unit of what carries the pendulum.
fn drives_and_carriers(table: &Table, reading: &ReadingSource) -> impl Iterator<Item = usize> {
    let angle_idx = match reading {
        ReadingSource::Angle { idx, .. } => Some(*idx),
        _ => None,
    };
    let is_angle = |name: &str| matches!(meaning(name), Meaning::Angle { .. });
    let is_like =
        move |idx: usize| angle_idx.is_some_and(|angle| angle_unit_of(table, angle) == angle_unit_of(table, idx));
    let carries = move |idx: usize| table.says(idx, |name| is_of_carrier(name) && is_angle(name)) && is_like(idx);
    let is_one = move |idx: &usize| table.says(*idx, words::is_of_drive) || carries(*idx);
    // A run that comes first may not have it.
    (0..table.n_columns).filter(is_one).filter(|idx| table.is_of_numbers(*idx) || table.is_empty_at_first(*idx))
}

/// gx, gy and gz alone are those of a gyroscope or of gravity.
fn three_axes(table: &Table) -> Option<Fault> {
    let place = |wanted: &str| table.names.as_ref()?.iter().position(|name| name.eq_ignore_ascii_case(wanted));
    let axes: Vec<usize> = ["gx", "gy", "gz"].into_iter().map(place).collect::<Option<_>>()?;
    Some(Fault::ThreeAxes { example: example(table, "angle", &axes, None).replace("theta=", "rate=") })
}

/// A named angle column, or x and y of a point; without names the first one that is not taken, and the next one with it
/// where both lie on a circle; none at all is fine when there are codes.
fn choose_angle(
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
    if named.len() > 1 {
        let columns: Vec<usize> = named.iter().map(|(idx, _)| *idx).collect();
        return if columns.len() > MOST_COLUMNS {
            Err(ambiguous(table, "angle", &columns))
        } else {
            Ok(ReadingSource::Rivals { example: example(table, "angle", &columns, None), columns })
        };
    }
    let time_idx = asked.time.as_ref().and_then(|(column, _)| find(table, column).ok());
    let fields = table.first_fields();
    let is_clock = |idx: &usize| fields.get(*idx).is_some_and(|field| clock::read(field).is_some());
    let first = (table.n_columns > 1 && !has_rate).then(|| unnamed_time(table));
    let time_idx = time_idx.or((0..table.n_columns).find(is_clock)).or(first);
    let rest_idx = first.and_then(|_| parted(table)).map(|parted| parted.rest);
    let is_free =
        |idx: &usize| ![time_idx, code_idx, rest_idx].contains(&Some(*idx)) && !counts(&table.first_numbers(*idx));
    let is_number = |idx: &usize| fields.get(*idx).is_some_and(|field| Numerals::new().read(field) != Cell::Text);
    let mut unnamed = (0..table.n_columns).filter(|idx| is_free(idx) && is_number(idx) && table.is_of_numbers(*idx));
    let (unnamed, next) = (unnamed.next(), unnamed.next());
    let moves = |idx: usize| table.first_numbers(idx).windows(2).any(|pair| pair[0] != pair[1]);
    let stands = |idx: usize| table.first_numbers(idx).len() >= MIN_SAMPLES && !moves(idx);
    let (x, y) = match Boxes::of(table) {
        Some(boxes) => (Some(boxes.x), Some(boxes.y)),
        None => (the_one(table, Meaning::X), the_one(table, Meaning::Y)),
    };
    match (named.first(), x, y, unnamed) {
        // A program that was to work it out from the point, and did not.
        (Some(&(idx, _)), Some(x), Some(y), _) if stands(idx) && moves(x) && moves(y) => {
            Ok(ReadingSource::Point { x, y, is_guess: false })
        }
        (Some(&(idx, _)), ..) => Ok(ReadingSource::Angle { idx, unit: angle_unit_of(table, idx) }),
        (None, Some(x), Some(y), _) => Ok(ReadingSource::Point { x, y, is_guess: false }),
        (None, ..) if code_idx.is_some() => Ok(ReadingSource::Codes),
        // An oscilloscope's settings beside the columns say so.
        (None, _, _, Some(idx)) if table.names.is_none() && table.says_volts() => {
            Err(Fault::OnlyRaw { available: table.available(), example: example(table, "angle", &[idx], None) })
        }
        (None, _, _, Some(idx)) if table.names.is_none() || table.n_columns == 1 => {
            let y = next.filter(|y| table.names.is_none() && lie_on_circle(table, idx, *y));
            let unit = angle_unit_of(table, idx);
            Ok(y.map_or(ReadingSource::Angle { idx, unit }, |y| ReadingSource::Point { x: idx, y, is_guess: true }))
        }
        _ => match mute_column(table) {
            Some(idx) => Ok(ReadingSource::Angle { idx, unit: angle_unit_of(table, idx) }),
            None => Err(no_angle(table)),
        },
    }
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
    if table.names.iter().flatten().any(|name| words::is_quaternion(name)) {
        named.retain(|(idx, _)| !table.says(*idx, words::is_orientation));
    }
    named
}

/// The only column of numbers whose name says nothing (`data`, `value`; `y` beside a `u`, as whoever identifies systems calls
/// output and input), where nothing else was measured than what drives.
fn mute_column(table: &Table) -> Option<usize> {
    let names = table.names.as_ref().filter(|_| rate_columns(table).is_empty())?;
    let has_input = names.iter().any(|name| name.eq_ignore_ascii_case("u"));
    let says_nothing = |name: &String| words::says_nothing(name) || (has_input && name.eq_ignore_ascii_case("y"));
    let is_mute = |(idx, name): &(usize, &String)| says_nothing(name) && table.is_of_numbers(*idx);
    let mut mute = names.iter().enumerate().filter(is_mute);
    let (idx, _) = mute.next().filter(|_| mute.next().is_none())?;
    let times = named_times(table);
    let is_other = |other: usize| {
        let is_time = times.contains(&other) || matches!(meaning(&names[other]), Meaning::Time { .. });
        let moves = table.first_numbers(other).windows(2).any(|pair| pair[0] != pair[1]);
        other != idx && !is_time && moves && table.is_of_numbers(other) && !words::is_of_drive(&names[other])
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

fn as_angle(meaning: Meaning) -> Option<(Option<AngleUnit>, u8)> {
    match meaning {
        Meaning::Angle { unit, strength } => Some((unit, strength)),
        _ => None,
    }
}

/// From the name of the column, else from its first cell.
fn angle_unit_of(table: &Table, idx: usize) -> Option<AngleUnit> {
    let in_name = match table.names.as_ref().and_then(|names| names.get(idx)).map(|name| meaning(name)) {
        Some(Meaning::Angle { unit, .. }) => unit,
        _ => None,
    };
    in_name.or_else(|| unit_in_cell(table, idx, words::angle_unit))
}
