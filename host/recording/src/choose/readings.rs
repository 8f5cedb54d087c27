//! Readings from the numbers of the columns that were chosen.

use super::angle::angle_unit_of;
use super::names::bare_axes;
use super::rivals::undecided;
use crate::angle::Angles;
use crate::chosen::{ReadingSource, Sources};
use crate::circle::is_arc;
use crate::error::{Fault, NoAngle};
use crate::header::Header;
use crate::limits::MIN_SAMPLES;
use crate::options::ReadOptions;
use crate::rate::Rates;
use crate::samples::Samples;
use crate::table::Table;
use crate::told::Told;
use crate::units::AngleUnit;
use crate::words;
use std::f64::consts::PI;

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
        if !raw.is_ours {
            self.refuse_standing(raw.table, idx, readings)?;
        }
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
        let mut of_point = vec![format!("columns {x} and {y} lie on a circle: read as x and y of a point")];
        let [xs, ys] = raw.point();
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
                raw.angles(self.told(), notes).of_column(None, xs, angle_unit_of(raw.table, x))
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
