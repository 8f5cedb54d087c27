//! An orientation as a quaternion: by the names of its parts, or by four letters and their length together.

use crate::table::Table;
use crate::words::{is_quaternion, w_x_y_z};

/// The four parts of a turn are 1 long together. Rounded to two digits each is off by up to 0.005, and so all of them by up to
/// 0.01; this is twice as much.
const LENGTH_OFF: f64 = 0.02;

/// A part of a quaternion in the table, if there is one.
pub(super) fn quaternion(table: &Table) -> Option<usize> {
    let names = table.names.as_deref()?;
    let named = || names.iter().position(|name| is_quaternion(name));
    named().or_else(|| w_x_y_z(names).filter(|parts| are_one_long(table, parts)).map(|[w, ..]| w))
}

/// Is this column such a part?
pub(super) fn is_part(table: &Table, idx: usize) -> bool {
    let names = table.names.as_deref().unwrap_or_default();
    let is_one_of = |parts: [usize; 4]| parts.contains(&idx) && are_one_long(table, &parts);
    table.says(idx, is_quaternion) || w_x_y_z(names).is_some_and(is_one_of)
}

/// In most rows: before a sensor has begun it may give zeros.
fn are_one_long(table: &Table, parts: &[usize; 4]) -> bool {
    let parts = parts.map(|idx| table.first_numbers(idx));
    let n_rows = parts.iter().map(Vec::len).min().unwrap_or(0);
    let length = |row: usize| parts.iter().map(|part| part[row].powi(2)).sum::<f64>().sqrt();
    2 * (0..n_rows).filter(|row| (length(*row) - 1.0).abs() < LENGTH_OFF).count() > n_rows
}

#[cfg(test)]
mod tests {
    use crate::{ReadOptions, read_bytes};

    /// A swing of 0.8 s in rows of 25 ms, as the parts of a turn about an axis between x and y, or as a point with a velocity.
    fn refused(names: &str, row: impl Fn(f64) -> [f64; 4]) -> String {
        let angle = |t: f64| 0.6 * (-0.05 * t).exp() * (7.85 * t).cos();
        let rows = (0..400).map(|idx| 0.025 * f64::from(idx)).map(|t| {
            let cells = row(angle(t)).map(|number| format!("{number:.3}")).join(",");
            format!("{t:.3},{cells}\n")
        });
        let text = format!("elapsed (s),{names}\n{}", rows.collect::<String>());
        read_bytes("a.csv", text.as_bytes(), &ReadOptions::default())
            .map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn four_parts_that_are_one_long_are_a_quaternion_and_no_point() {
        let turn = |angle: f64| [(angle / 2.0).cos(), 0.6 * (angle / 2.0).sin(), 0.8 * (angle / 2.0).sin(), 0.0];
        for names in [
            "w (number),x (number),y (number),z (number)",
            "w,x,y,z",
            "quaternion_w,quaternion_x,quaternion_y,quaternion_z",
        ] {
            let told = refused(names, turn);
            assert!(told.contains("an orientation as a quaternion"), "{names}: {told}");
        }
        let point = |angle: f64| [3.0 * angle, 0.5 * angle.sin(), -0.5 * angle.cos(), 0.0];
        assert!(!refused("w,x,y,z", point).contains("quaternion"));
    }

    #[test]
    fn three_axes_in_g_are_accelerations() {
        let told = refused("x-axis (g),y-axis (g),z-axis (g),battery (V)", |angle| {
            [0.1 * angle, 1.0 - angle * angle, 0.0, 4.0]
        });
        assert!(told.contains("among them are accelerations"), "{told}");
    }
}
