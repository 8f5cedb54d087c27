//! Fewer points for long lines, extremes kept: of every stretch its first, lowest, highest and last point remain, so
//! that the line looks the same at this width and no peak is lost.

/// Thins a line to about `n_wanted` points.
pub fn decimated(x: &[f64], y: &[f64], n_wanted: usize) -> (Vec<f64>, Vec<f64>) {
    if x.len() <= n_wanted {
        return (x.to_vec(), y.to_vec());
    }
    let stretch = (4 * x.len()).div_ceil(n_wanted.max(4));
    let mut kept: Vec<usize> = Vec::with_capacity(n_wanted + 4);
    for from in (0..x.len()).step_by(stretch) {
        let range = from..(from + stretch).min(x.len());
        let lowest = range.clone().min_by(|i, j| y[*i].total_cmp(&y[*j])).unwrap_or(from);
        let highest = range.clone().max_by(|i, j| y[*i].total_cmp(&y[*j])).unwrap_or(from);
        let mut four = [from, lowest, highest, range.end - 1];
        four.sort_unstable();
        kept.extend(four);
    }
    kept.dedup();
    kept.iter().map(|i| (x[*i], y[*i])).unzip()
}

/// Thins a cloud evenly.
pub fn every(x: &[f64], y: &[f64], n_wanted: usize) -> Vec<(f64, f64)> {
    let stride = x.len().div_ceil(n_wanted.max(1)).max(1);
    x.iter().copied().zip(y.iter().copied()).step_by(stride).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_survive() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y = vec![0.0; 100_000];
        (y[33_333], y[77_777]) = (5.0, -7.0);
        let (thin_x, thin_y) = decimated(&x, &y, 2000);
        assert!(thin_x.len() <= 2004, "{}", thin_x.len());
        assert!(thin_y.contains(&5.0) && thin_y.contains(&-7.0));
        assert!(thin_x.is_sorted());
    }
}
