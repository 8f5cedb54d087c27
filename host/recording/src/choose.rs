//! Which column is what: by what the user said, the header, the names, and at last the place.

mod angle;
mod beside;
mod boxes;
mod names;
mod parted;
mod quaternion;
mod rates;
mod reading;
mod readings;
mod rivals;
mod standing;
mod tilt;
mod time;

use super::chosen::{Parted, ReadingSource, SetPoint, Sources, TimeSource};
use super::columns::Columns;
use super::error::{Fault, NoAngle};
use super::header::Header;
use super::options::ReadOptions;
use super::runs;
use super::samples::MOST_COLUMNS;
use super::table::Table;
use super::units::{AngleUnit, TimeUnit};
use super::words::{Meaning, is_target, meaning};
use angle::{angle_unit_of, as_angle, mute_column};
use beside::beside;
use boxes::Boxes;
use names::{all_best, example, find, is_of_periods, named_times, no_angle, note_rivals, note_unnamed};
use parted::{beside_clock, parted};
use reading::choose_reading;
use time::{as_time, choose_time, plotted_axes};

impl Sources {
    /// Chooses the columns of a table; what is assumed is noted.
    pub(super) fn choose(
        table: &Table,
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let asked = options.columns.clone().unwrap_or_default();
        let is_ours = header.version.is_some();
        let code = choose_code(table, header, &asked)?;
        let (time, reading) = match plotted_axes(table, &asked) {
            Some(axes) => plotted(table, header, options, axes, notes),
            None => time_and_reading(table, header, options, &asked, code, notes)?,
        };
        if asked.angle.is_none() {
            note_angle(table, is_ours, &reading, time.column(), notes)?;
        }
        if asked.x.is_none() {
            note_point(table, &reading, notes);
        }
        let (time, parted) = in_two_columns(table, time, notes);
        if asked.time.is_none() && parted.is_none() {
            note_time(table, &time, notes);
        }
        if time.column().is_some_and(|idx| reading.first_idx() == Some(idx)) {
            return Err(no_angle(table));
        }
        // Beside an angle they are of use to a rig of ours alone, and would have to be kept through every repair.
        let code = code.filter(|_| is_ours || matches!(reading, ReadingSource::Codes));
        log::debug!("columns: time from {time:?}, readings from {reading:?}, code from {code:?}");
        let otherwise = example(table, "angle", &[], reading.columns().first().copied());
        let needed = reading.columns().into_iter().chain(time.column()).chain(code);
        let needed: Vec<usize> = needed.chain(parted.map(|parted| parted.rest)).collect();
        let run = runs::column(table, |idx| !needed.contains(&idx)).filter(|_| !is_ours);
        let is_free = |idx: &usize| !needed.contains(idx) && run != Some(*idx) && !is_ours;
        let is_told = asked.angle.is_some() || asked.x.is_some();
        let others = beside(table, &reading, is_told).into_iter().filter(is_free).take(MOST_COLUMNS).collect();
        let set_point = set_point(table, &reading).filter(|_| !is_told);
        let passed_time = passed_time(table, &asked, &time, &reading);
        Ok(Self { time, reading, passed_time, parted, code, run, others, set_point, otherwise })
    }

    /// The same, where another run of the file shows that its angles are degrees and nothing else says so.
    pub(super) fn in_degrees(&self) -> Option<Self> {
        let ReadingSource::Angle { idx, unit: None } = self.reading else { return None };
        Some(Self { reading: ReadingSource::Angle { idx, unit: Some(AngleUnit::Degrees) }, ..self.clone() })
    }
}

/// The times that stand before the readings, where the user told others: of recordings side by side each has its own.
fn passed_time(table: &Table, asked: &Columns, time: &TimeSource, reading: &ReadingSource) -> Option<usize> {
    let told = time.column().filter(|_| asked.time.is_some())?;
    let times = named_times(table);
    let own = times.iter().copied().rfind(|own| reading.first_idx().is_some_and(|idx| *own < idx))?;
    (own != told && times.contains(&told)).then_some(own)
}

/// What a controller is told throughout the first rows, in the unit of the angle.
fn set_point(table: &Table, reading: &ReadingSource) -> Option<SetPoint> {
    let ReadingSource::Angle { idx: angle, .. } = *reading else { return None };
    let is_its = |idx: &usize| {
        let is_alike = angle_unit_of(table, *idx) == angle_unit_of(table, angle);
        *idx != angle && table.says(*idx, is_target) && is_alike && table.is_of_numbers(*idx) && !table.moves(*idx)
    };
    let idx = (0..table.n_columns).find(is_its)?;
    Some(SetPoint { column: table.column_name(idx), value: *table.first_numbers(idx).first()? })
}

/// Two columns without names, of which one goes on evenly.
fn plotted(
    table: &Table,
    header: &Header,
    options: &ReadOptions,
    (time, angle): (usize, usize),
    notes: &mut Vec<String>,
) -> (TimeSource, ReadingSource) {
    let (time_name, angle_name) = (table.column_name(time), table.column_name(angle));
    let unit = angle_unit_of(table, angle).or(options.angle_unit);
    let (source, read) = match options.rate_hz.or(header.rate_hz) {
        Some(rate_hz) => (TimeSource::Rate(rate_hz), "left out where the rate is told"),
        None => (TimeSource::Column { idx: time, unit: None }, "read as the time"),
    };
    notes.push(format!("{time_name} goes on evenly: {read}, and {angle_name} as the angle"));
    (source, ReadingSource::Angle { idx: angle, unit })
}

/// What is wrong with the time is said before what is wrong with the readings, but for a table of periods.
fn time_and_reading(
    table: &Table,
    header: &Header,
    options: &ReadOptions,
    asked: &Columns,
    code: Option<usize>,
    notes: &mut Vec<String>,
) -> Result<(TimeSource, ReadingSource), Fault> {
    let reading = choose_reading(table, header, options, asked, code);
    if let Err(fault @ Fault::NoAngle(NoAngle::OnlyDurations { .. })) = reading {
        return Err(fault);
    }
    let reading_idx = reading.as_ref().ok().and_then(ReadingSource::first_idx);
    let time = choose_time(table, header, options, asked, reading_idx, notes);
    // Of recordings side by side each angle has a time of its own, which its advice says.
    let reading = match (&time, reading) {
        (Err(Fault::AmbiguousColumn { .. }), Err(fault @ Fault::AmbiguousColumn { .. })) => return Err(fault),
        (_, reading) => reading,
    };
    let time = time?;
    if asked.time.is_none() && time.column().is_some_and(|idx| is_of_periods(table, idx)) {
        return Err(NoAngle::OnlyDurations { available: table.available() }.into());
    }
    Ok((time, reading?))
}

/// Says why this column was taken as the angle, where its name alone does not tell.
fn note_angle(
    table: &Table,
    is_ours: bool,
    reading: &ReadingSource,
    time: Option<usize>,
    notes: &mut Vec<String>,
) -> Result<(), Fault> {
    let ReadingSource::Angle { idx, .. } = *reading else { return Ok(()) };
    note_rivals(table, "angle", idx, as_angle, notes);
    if !is_ours {
        tilt::fault(table, idx, time).map_or(Ok(()), Err)?;
        note_unnamed(table, idx, time, notes);
    }
    if table.n_columns > 1 && mute_column(table) == Some(idx) {
        notes.push(format!("{} says nothing else and is read as the angle", table.column_name(idx)));
    }
    Ok(())
}

/// Says why x and y of a point are read.
fn note_point(table: &Table, reading: &ReadingSource, notes: &mut Vec<String>) {
    let ReadingSource::Point { is_guess: false, .. } = reading else { return };
    if let Some((idx, _)) = all_best(table, as_angle).first() {
        notes.push(format!("{} does not move: x and y of the point are read instead", table.column_name(*idx)));
    }
    notes.extend(Boxes::of(table).map(|boxes| boxes.note(table)));
}

/// Says which other times were passed over.
fn note_time(table: &Table, time: &TimeSource, notes: &mut Vec<String>) {
    if let TimeSource::Column { idx, .. } | TimeSource::Clock { idx } = time
        && all_best(table, as_time).len() == 1
    {
        note_rivals(table, "time", *idx, as_time, notes);
    }
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

#[cfg(test)]
mod tests {
    use crate::{ReadOptions, read_bytes};

    /// Two runs side by side, as PASCO's and Tracker's users export them, of which the second one lasts longer.
    fn side_by_side(n_first: usize, n_second: usize) -> String {
        let row = |idx: usize| {
            let time_s = 0.05 * idx as f64;
            let of = |n: usize, angle: f64| match idx < n {
                true => format!("{time_s:.2},{:.4}", angle * (5.0 * time_s).cos() * (-0.02 * time_s).exp()),
                false => ",".to_owned(),
            };
            format!("{},{}\n", of(n_first, 0.8), of(n_second, 0.5))
        };
        let names = "Time (s) Run #1,Angle (rad) Run #1,Time (s) Run #2,Angle (rad) Run #2\n";
        names.to_owned() + &(0..n_first.max(n_second)).map(row).collect::<String>()
    }

    fn read(text: &str, columns: Option<&str>) -> Result<usize, String> {
        let columns = columns.map(|columns| columns.parse().unwrap());
        let angle_unit = Some(crate::AngleUnit::Radians);
        let options = ReadOptions { columns, angle_unit, ..ReadOptions::default() };
        read_bytes("runs", text.as_bytes(), &options)
            .map(|recording| recording.len())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn the_advice_for_runs_side_by_side_gives_each_angle_its_own_time() {
        let refused = read(&side_by_side(200, 300), None).unwrap_err();
        assert!(refused.contains("t=0,theta=1 or t=2,theta=3"), "{refused}");
        assert!(!refused.contains("t=2,theta=1"), "{refused}");
    }

    #[test]
    fn the_time_of_another_run_is_refused_where_that_is_longer_or_shorter() {
        for (n_first, n_second) in [(200, 300), (300, 200)] {
            let text = side_by_side(n_first, n_second);
            for (told, cure) in [("t=2,theta=1", "--columns t=0,theta=1"), ("t=0,theta=3", "--columns t=2,theta=3")] {
                let refused = read(&text, Some(told)).unwrap_err();
                assert!(refused.contains(cure), "{refused}");
            }
            assert_eq!(read(&text, Some("t=0,theta=1")), Ok(n_first));
            assert_eq!(read(&text, Some("t=2,theta=3")), Ok(n_second));
        }
    }

    /// A second clock that lost some rows may be told all the same.
    #[test]
    fn another_time_that_lacks_some_rows_is_taken_as_told() {
        let row = |idx: usize| {
            let time_s = 0.05 * idx as f64;
            let second = if idx % 40 == 7 { String::new() } else { format!("{:.3}", 100.0 + time_s) };
            format!("{time_s:.2},{:.4},{second}\n", 0.8 * (5.0 * time_s).cos() * (-0.02 * time_s).exp())
        };
        let text = "time,angle (rad),time_mcu (s)\n".to_owned() + &(0..400).map(row).collect::<String>();
        assert_eq!(read(&text, Some("t=2,theta=1")), Ok(390));
    }

    /// As PlotJuggler writes two topics, each with rows of its own.
    #[test]
    fn what_a_motor_is_told_in_rows_of_its_own_holds_until_the_next_one() {
        let message = |idx: usize| {
            let time_s = 0.004 * idx as f64;
            let told = if idx < 500 { (3.0 * time_s).sin() } else { 0.0 };
            let angle = 0.4 * (5.0 * time_s).cos() * (-0.02 * time_s).exp();
            format!("{:.4},{told:.4},\n{time_s:.4},,{angle:.4}\n", time_s - 0.001)
        };
        let names = "__time,/effort_control/data.0,/joint_states/joint0/position\n";
        let text = names.to_owned() + &(1..2000).map(message).collect::<String>();
        let options = ReadOptions { angle_unit: Some(crate::AngleUnit::Radians), ..ReadOptions::default() };
        let recording = read_bytes("topics", text.as_bytes(), &options).unwrap();
        let [drive] = &recording.drives[..] else { panic!("{:?}", recording.drives) };
        assert!(drive.within(&(0..490)).is_some() && drive.within(&(510..1900)).is_none(), "{drive:?}");
    }

    /// Where rows are alike, who tells another time has a reason.
    #[test]
    fn another_time_of_the_same_rows_is_taken_as_told() {
        let text = side_by_side(200, 200);
        assert_eq!(read(&text, Some("t=0,theta=3")), Ok(200));
        assert_eq!(read(&text, Some("t=2,theta=1")), Ok(200));
    }
}
