//! Readings from the numbers of the columns that were chosen.

use super::angle::angle_unit_of;
use super::names::bare_axes;
use super::rivals::undecided;
use super::standing::rises_evenly;
use crate::angle::Angles;
use crate::chosen::{ReadingSource, SetPoint, Sources};
use crate::circle::is_arc;
use crate::error::{Fault, NoAngle};
use crate::header::Header;
use crate::limits::MIN_SAMPLES;
use crate::median;
use crate::options::ReadOptions;
use crate::rate::Rates;
use crate::samples::Samples;
use crate::table::Table;
use crate::told::Told;
use crate::units::AngleUnit;
use crate::words;
use std::f64::consts::PI;

/// So near to its set point a controller holds it, rad (12°). Half and twice were not tried.
const HELD_RAD: f64 = 0.2;

/// What takes no more values than these throughout, and others in between, is what a motor is told, and no place of a point. Half and
/// twice were not tried.
const FEW_LEVELS: usize = 5;

/// What goes round is no point that swings, wherever it lies.
const NO_CIRCLE: Fault = Fault::NoCircle { off_percent: 100.0 };

/// What readings are made of.
struct Raw<'a> {
    table: &'a Table<'a>,
    samples: &'a Samples,
    times_s: &'a [f64],
    is_ours: bool,
    options: &'a ReadOptions,
}

impl Raw<'_> {
    fn angles<'b>(&'b self, told: Told, notes: &'b mut Vec<String>) -> Angles<'b> {
        Angles { times_s: self.times_s, is_ours: self.is_ours, options: self.options, told, notes }
    }

    /// x and y of a point.
    fn point(&self) -> [&[f64]; 2] {
        [&self.samples.readings[0], &self.samples.readings[1]]
    }
}

impl Sources {
    /// Angles (rad) or rates (rad/s) from the numbers that were read.
    pub(crate) fn readings(
        &self,
        table: &Table,
        samples: &Samples,
        times_s: &[f64],
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Vec<f64>, Fault> {
        let is_ours = header.version.is_some();
        let raw = Raw { table, samples, times_s, is_ours, options };
        match &self.reading {
            ReadingSource::Codes => {
                let calibration = header.calibration.ok_or(Fault::NoCalibration)?;
                Ok(samples.codes.iter().map(|code| calibration.angle_rad(*code)).collect())
            }
            ReadingSource::Angle { idx, unit } => self.of_angle(&raw, *idx, *unit, notes),
            ReadingSource::Point { x, y, is_guess: false } => self.of_point(&raw, [*x, *y], notes),
            ReadingSource::Point { x, y, is_guess: true } => self.of_guess(&raw, [*x, *y], notes),
            ReadingSource::Rivals { columns, example } => Err(undecided(table, columns, example)),
            ReadingSource::Rates { columns, unit } => {
                let names = columns.iter().map(|idx| table.column_name(*idx)).collect();
                let told = columns.iter().map(|idx| Told { reading: *idx, ..self.told() }).collect();
                Rates { times_s, is_ours, options, names, told, notes }.of_columns(&samples.readings, *unit)
            }
        }
    }

    fn of_angle(
        &self,
        raw: &Raw,
        idx: usize,
        unit: Option<AngleUnit>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<f64>, Fault> {
        let readings = &raw.samples.readings[0];
        let name = raw.table.says(idx, words::is_named_angle).then(|| raw.table.column_name(idx));
        raw.angles(self.told(), notes).of_column(name.as_deref(), readings, unit)
    }

    fn of_point(&self, raw: &Raw, columns: [usize; 2], notes: &mut Vec<String>) -> Result<Vec<f64>, Fault> {
        let is_told = raw.options.columns.as_ref().is_some_and(|columns| columns.x.is_some());
        let are_sine_and_cosine = columns.iter().all(|idx| raw.table.says(*idx, words::is_of_sine));
        let pivot = are_sine_and_cosine.then_some([0.0; 2]);
        let [x, y] = raw.point();
        raw.angles(self.told(), notes).of_point(x, y, pivot).map_err(|fault| {
            match bare_axes(raw.table).filter(|_| !is_told) {
                Some(axes) => NoAngle::ThreeAxes { example: self.rate_example(&axes) }.into(),
                None => fault,
            }
        })
    }

    /// Of two columns without names: of a point if they lie on a circle, else the first one is an angle.
    fn of_guess(&self, raw: &Raw, [x, y]: [usize; 2], notes: &mut Vec<String>) -> Result<Vec<f64>, Fault> {
        let [xs, ys] = raw.point();
        if has_few_levels(xs) {
            return Err(few_levels(raw.table, x, Told { reading: y, ..self.told() }.angle("", "")));
        }
        let mut of_point = vec![format!("columns {x} and {y} lie on a circle: read as x and y of a point")];
        let angles = raw.angles(self.told(), &mut of_point).of_point(xs, ys, None);
        // Angle and rate of a slow pendulum go round their circle.
        let goes_round = |angles: &Vec<f64>| angles.iter().any(|angle_rad| angle_rad.abs() > PI);
        match angles.and_then(|angles| if goes_round(&angles) { Err(NO_CIRCLE) } else { Ok(angles) }) {
            Err(fault @ (Fault::NoCircle { .. } | Fault::ShortArc { .. })) if is_arc(xs, ys) => {
                let told = Told { reading: x, ..self.told() };
                Err(Fault::SeemsPoint { x, y, fault: Box::new(fault), told })
            }
            Err(Fault::NoCircle { .. } | Fault::ShortArc { .. }) => {
                self.refuse_standing(raw.table, x, xs)?;
                let unit = raw.options.angle_unit.or(angle_unit_of(raw.table, x));
                raw.angles(self.told(), notes).of_column(None, xs, unit)
            }
            angles => {
                notes.extend(of_point);
                angles
            }
        }
    }

    /// What tells of one of these columns that it is an angular velocity.
    fn rate_example(&self, columns: &[usize]) -> String {
        let told = |idx: &usize| Told { reading: *idx, ..self.told() }.rate("");
        columns.iter().map(told).collect::<Vec<_>>().join(" or ")
    }

    /// What can be told of the numbers before it is known what their time counts.
    pub(crate) fn refuse_readings(&self, table: &Table, samples: &Samples, options: &ReadOptions) -> Result<(), Fault> {
        let ReadingSource::Angle { idx, unit } = self.reading else { return Ok(()) };
        let readings = &samples.readings[0];
        self.refuse_standing(table, idx, readings)?;
        let (is_time_told, is_angle_told) =
            options.columns.as_ref().map_or((false, false), |told| (told.time.is_some(), told.angle.is_some()));
        if table.names.is_none() && table.n_columns > 2 && !is_angle_told && has_few_levels(readings) {
            return Err(few_levels(table, idx, self.otherwise.clone()));
        }
        if !is_time_told {
            self.refuse_sorted(table, &samples.times, readings)?;
        }
        self.refuse_held(table, readings, unit)
    }

    /// Rows that somebody sorted by the angle: it rises then, and is read as the time.
    fn refuse_sorted(&self, table: &Table, times: &[f64], readings: &[f64]) -> Result<(), Fault> {
        let (Some(by), reading, None) = (self.time.column(), self.told().reading, &table.names) else { return Ok(()) };
        let mut sorted = readings.to_vec();
        sorted.sort_by(f64::total_cmp);
        match !rises_evenly(times) && !rises_evenly(readings) && rises_evenly(&sorted) {
            true => Err(Fault::SortedByReading { time: reading, by }),
            false => Ok(()),
        }
    }

    /// An angle about which a controller holds it: that it stands there tells no direction.
    fn refuse_held(&self, table: &Table, readings: &[f64], unit: Option<AngleUnit>) -> Result<(), Fault> {
        let Some(SetPoint { column, value }) = &self.set_point else { return Ok(()) };
        let radians = unit.unwrap_or(AngleUnit::Radians).radians();
        let from_half_turns_rad = value * radians - (value * radians / PI).round() * PI;
        let off_rad = (median(&mut readings.to_vec()) - value) * radians;
        match off_rad.abs() < HELD_RAD && from_half_turns_rad.abs() > HELD_RAD {
            true => {
                let (told, target) = (self.told(), column.clone());
                Err(Fault::Held { angle: table.column_name(told.reading), target, value: *value, told })
            }
            false => Ok(()),
        }
    }

    /// An angle that is the same throughout is another column's.
    fn refuse_standing(&self, table: &Table, idx: usize, readings: &[f64]) -> Result<(), Fault> {
        let first = readings.first().copied().unwrap_or_default();
        if readings.len() < MIN_SAMPLES || readings.iter().any(|reading| *reading != first) {
            return Ok(());
        }
        let (column, available) = (table.column_name(idx), table.available());
        let is_acceleration = |idx: usize| table.says(idx, words::is_acceleration);
        if self.otherwise.ends_with("COLUMN") && (0..table.n_columns).any(is_acceleration) {
            return Err(NoAngle::OnlyAccelerations { available }.into());
        }
        Err(Fault::NothingMoves { column, value: first, available, example: self.otherwise.clone() })
    }
}

fn few_levels(table: &Table, idx: usize, example: String) -> Fault {
    Fault::FewLevels { column: table.column_name(idx), n: FEW_LEVELS, example }
}

fn has_few_levels(numbers: &[f64]) -> bool {
    let mut levels: Vec<f64> = Vec::new();
    for number in numbers {
        if !levels.contains(number) {
            levels.push(*number);
        }
        if levels.len() > FEW_LEVELS {
            return false;
        }
    }
    levels.len() > 1 && numbers.len() >= MIN_SAMPLES
}

#[cfg(test)]
mod tests {
    use crate::{ReadOptions, read_bytes};

    /// Time (s), angle (rad) and a second number of a swing of 0.8 s, in rows of 25 ms.
    fn swing() -> impl Iterator<Item = (f64, f64, f64)> {
        (0..800).map(|idx| 0.025 * f64::from(idx)).map(|t| {
            let (fading, phase) = ((-0.05 * t).exp(), 7.85 * t);
            (t, 0.6 * fading * phase.cos(), 0.6 * fading * phase.sin())
        })
    }

    fn file(name: &str, head: &str, row: impl Fn((f64, f64, f64)) -> String) -> Result<Vec<String>, String> {
        let text = format!("{head}{}\n", swing().map(row).collect::<Vec<_>>().join("\n"));
        let recording = read_bytes(name, text.as_bytes(), &ReadOptions::default());
        recording.map(|recording| recording.notes().to_vec()).map_err(|error| error.to_string())
    }

    #[test]
    fn x_y_and_z_of_an_orientation_are_angles_and_of_files_of_angles_nobody_knows() {
        let three = |(t, a, b): (f64, f64, f64)| format!("{t:.3},{:.5},{a:.5},{:.5}", 0.1 * b, 0.01 * a);
        let labelled = |row: (f64, f64, f64)| format!("Euler,{}", three(row));
        for notes in [
            file("EulerAngles.csv", "t,x,y,z\n", three),
            file("imu-attitude.csv", "t,x,y,z\n", three),
            file("a.csv", "Attribute,t,x,y,z\n", labelled),
        ] {
            assert!(
                notes.clone().is_ok_and(|notes| notes.join("; ").contains("of 3 angles of the sensor")),
                "{notes:?}"
            );
        }
        let refused = file("angles.csv", "t,x,y,z\n", three).unwrap_err();
        assert!(refused.contains("t=0,theta=1 or t=0,x=1,y=2"), "{refused}");
        let turned = |row: (f64, f64, f64)| format!("{},0.9", three(row));
        let quaternion = file("orientation.csv", "t,x,y,z,w\n", turned);
        assert!(!format!("{quaternion:?}").contains("angles of the sensor"), "{quaternion:?}");
    }

    /// Of a place that was to be worked out from them and never was.
    #[test]
    fn no_advice_leads_from_an_angle_that_stands_to_counts_of_an_accelerometer() {
        let row = |(t, a, b): (f64, f64, f64)| format!("{:.0},{:.0},1008,0,{:.0}", 90.0 * a, 40.0 * b, 1e6 * t);
        let refused = file("a.csv", "xAccl,yAccl,zAccl,newPosition,time\n", row).unwrap_err();
        assert!(refused.contains("accelerations, which can't be fitted"), "{refused}");
        assert!(!refused.contains("theta=0") && !refused.contains("theta=3"), "{refused}");
    }

    #[test]
    fn whole_numbers_that_would_be_slow_seconds_count_rows() {
        let row = |(t, a, _): (f64, f64, f64)| format!("{:.0},{a:.5}", 40.0 * t);
        let refused = file("a.csv", "t,theta\n", row).unwrap_err();
        assert!(refused.contains("in seconds") && refused.contains("--rate 30"), "{refused}");
    }

    #[test]
    fn rows_that_are_sorted_by_the_angle_are_named_so() {
        let mut rows: Vec<(f64, f64, f64)> = swing().collect();
        rows.sort_by(|a, b| a.1.total_cmp(&b.1));
        let text: String = rows.iter().map(|(t, a, _)| format!("{t:.3},{:.9}\n", a - 4.0)).collect();
        let refused = read_bytes("a.csv", text.as_bytes(), &ReadOptions::default()).unwrap_err().to_string();
        assert!(refused.contains("sorted by column 1") && refused.contains("by column 0"), "{refused}");
    }

    #[test]
    fn what_a_controller_holds_is_no_angle_from_the_horizontal() {
        let beside =
            |target: f64| move |(t, a, _): (f64, f64, f64)| format!("{:.0},{:.2},{target}", 1e3 * t, 90.0 + 8.0 * a);
        let refused = file("a.csv", "Tempo_ms,Angulo_Real_graus,Alvo_graus\n", beside(90.0)).unwrap_err();
        assert!(refused.contains("2 (Alvo_graus)") && refused.contains("a controller holds it"), "{refused}");
        let notes = file("a.csv", "Tempo_ms,Angulo_Real_graus,Alvo_graus\n", beside(0.0)).unwrap();
        assert!(notes.join("; ").contains("measured from the horizontal"), "{notes:?}");
    }

    /// A voltage of three levels, and an angle that goes as its square.
    #[test]
    fn a_voltage_of_three_levels_is_no_coordinate() {
        let level = |t: f64| (1.4 * (1.7 * t).sin()).round();
        for share in [0.02, 1.0] {
            let row =
                |(t, a, b): (f64, f64, f64)| format!("{t:.3},{},{:.5},{b:.5}", level(t), level(t).powi(2) + share * a);
            let refused = file("a.csv", "", row).unwrap_err();
            assert!(
                refused.contains("column 1 has no more than 5 values") && refused.contains("t=0,theta=2"),
                "{refused}"
            );
        }
    }

    #[test]
    fn the_only_column_that_goes_on_evenly_is_the_time() {
        let refused = file("a.csv", "arm_data,td\n", |(t, a, _)| format!("{a:.5},{t:.3}")).unwrap_err();
        assert!(refused.contains("no angle column"), "{refused}");
        let refused =
            file("a.csv", "sample,angle\n", |(t, a, _)| format!("{:.0},{a:.5}", 40.0 * t + (5.0 * t).floor()));
        assert!(refused.clone().is_err_and(|refused| refused.contains("no time column")), "{refused:?}");
        let notes = file("a.csv", "theta,td\n", |(t, a, _)| format!("{a:.5},{t:.3}")).unwrap();
        assert!(notes.join("; ").contains("1 (td) is the only column that goes on evenly"), "{notes:?}");
    }

    #[test]
    fn a_distance_without_a_name_is_no_angle_in_degrees_alone() {
        let refused = file("a.csv", "", |(t, a, _)| format!("{t:.3},{:.2}", 36.0 + 8.0 * a)).unwrap_err();
        assert!(refused.contains("--degrees") && refused.contains("a distance (cm, mm)"), "{refused}");
    }
}
