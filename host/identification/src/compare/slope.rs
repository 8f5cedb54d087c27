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
