//! Slopes of smooth series at uneven times.

/// Central differences, one-sided at the ends; unit of the values per second. At least two values.
pub(super) fn slopes(times_s: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let slope = |i: usize| {
        let (from, to) = (i.saturating_sub(1), (i + 1).min(last));
        (values[to] - values[from]) / (times_s[to] - times_s[from])
    };
    (0..values.len()).map(slope).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_its_slope_everywhere_however_uneven_the_times() {
        let times_s = [0.0, 0.1, 0.5, 0.6, 1.6];
        let line = times_s.map(|time_s| 3.0 - 2.0 * time_s);
        assert!(slopes(&times_s, &line).iter().all(|slope| (slope + 2.0).abs() < 1e-12));
    }
}
