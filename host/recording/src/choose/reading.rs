//! What was measured, and which columns hold it.

use super::angle::choose_angle;
use super::names::{bare_axes, example, find, listed, no_angle};
use super::quaternion::quaternion;
use super::rates::{rate_columns, rates};
use crate::chosen::ReadingSource;
use crate::columns::Columns;
use crate::error::{Fault, NoAngle};
use crate::header::Header;
use crate::options::ReadOptions;
use crate::table::Table;
use crate::units::RateUnit;
use crate::words::{says_angles, says_turns};
use shared::measured::Measured;

/// Rates where the user, the header or the names say so, else angles.
pub(super) fn choose_reading(
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
    if let (false, Some(columns)) = (is_told, bare_axes(table)) {
        if is_of_turns(table) {
            return Ok(ReadingSource::Rivals { example: example(table, "angle", &columns, None), columns });
        }
        if table.is_called(says_angles) {
            return Err(angles_or_point(table, &columns));
        }
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
        (None, Err(fault @ Fault::NoAngle(_))) => match rate_columns(table) {
            columns if columns.is_empty() => Err(three_axes(table).unwrap_or(fault)),
            columns => Ok(rates(table, options, columns, None)),
        },
        (_, Ok(ReadingSource::Angle { idx, unit })) => {
            Ok(ReadingSource::Angle { idx, unit: options.angle_unit.or(unit) })
        }
        (_, angle) => angle,
    }
}

/// Are its x, y and z the angles of an orientation, and no parts of a quaternion?
pub(super) fn is_of_turns(table: &Table) -> bool {
    let is_w = |name: &String| name.trim().eq_ignore_ascii_case("w");
    let has_w = table.names.iter().flatten().any(is_w) || quaternion(table).is_some();
    table.is_called(says_turns) && !has_w
}

/// Angles may be those of an orientation, or of the releases of a point.
fn angles_or_point(table: &Table, axes: &[usize]) -> Fault {
    let angle = example(table, "angle", &axes[..1], None);
    let point = angle.replace("theta=", "x=");
    Fault::AmbiguousColumn {
        role: "angle, or x and y of a point",
        candidates: listed(table, axes),
        example: format!("{angle} or {point},y={}", axes[1]),
    }
}

/// gx, gy and gz alone are those of a gyroscope or of gravity.
fn three_axes(table: &Table) -> Option<Fault> {
    let place = |wanted: &str| table.names.as_ref()?.iter().position(|name| name.eq_ignore_ascii_case(wanted));
    let axes: Vec<usize> = ["gx", "gy", "gz"].into_iter().map(place).collect::<Option<_>>()?;
    Some(NoAngle::ThreeAxes { example: example(table, "angle", &axes, None).replace("theta=", "rate=") }.into())
}
