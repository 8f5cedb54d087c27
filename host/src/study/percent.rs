//! Shares as people read them.

/// `1.9 ± 0.3 %` of a share, without its sign; so many digits that the spread is seen.
pub(super) fn percent(share: f64, std: Option<f64>) -> String {
    let [share, std] = [share.abs(), std.unwrap_or(0.0)].map(|share| 100.0 * share);
    let digits = if std > 0.0 { (1.0 - std.log10().floor()).clamp(0.0, 6.0) as usize } else { 1 };
    if std > 0.0 { format!("{share:.digits$} ± {std:.digits$} %") } else { format!("{share:.digits$} %") }
}
