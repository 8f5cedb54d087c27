//! The table with one row a swing, and the classes of amplitude in which a model may fail.

use super::halves::Halves;
use super::restart::Cuts;
use super::rms;
use crate::number::angle;
use crate::swing::Swing;
use serde::Serialize;

/// One swing there and back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Begin, s since the swing's first sample.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Largest angle within, rad.
    pub amplitude_rad: f64,
    /// Duration, s; absent for the first and last, which may be no whole swings.
    pub period_s: Option<f64>,
    /// Energy lost by its half swings, J.
    pub lost_j: Option<f64>,
    /// Free-run residual, rms, rad.
    pub residual_rad: f64,
}

/// One row a swing; the motion after the last cut is the last row.
pub fn rows(swing: &Swing, offset_rad: f64, residuals_rad: &[f64], cuts: &Cuts, measured: &Halves) -> Vec<Row> {
    let mut ends = cuts.at.clone();
    ends.push(swing.len() - 1);
    let row = |pair: (usize, &[usize])| {
        let (k, range) = pair;
        let (from, to) = (range[0], range[1]);
        let (from_s, to_s) = (swing.times_s[from], swing.times_s[to]);
        let angles = swing.angles_rad[from..to].iter();
        let amplitude_rad = angles.fold(0.0_f64, |peak, angle| peak.max(swing.size_rad(angle - offset_rad).abs()));
        let within = measured.halves.iter().filter(|half| (from_s..to_s).contains(&half.from_s));
        let lost: Vec<f64> = within.map(|half| half.lost_j).collect();
        let is_whole = k > 0 && k + 2 < ends.len();
        Row {
            from_s,
            to_s,
            amplitude_rad,
            period_s: is_whole.then_some(to_s - from_s),
            lost_j: (lost.len() == 2).then(|| lost.iter().sum()),
            residual_rad: rms(&residuals_rad[from..to]),
        }
    };
    ends.windows(2).enumerate().filter(|(_, range)| range[1] > range[0] + 1).map(row).collect()
}

/// A part of the motion and how far the model is off there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// In words.
    pub words: String,
    /// Root mean square residual, rad.
    pub residual_rad: f64,
    /// The same over that of all swings.
    pub ratio: f64,
}

/// Classes of amplitude.
const N_CLASSES: usize = 3;

/// So many swings before rest are looked at by themselves.
const N_LAST: usize = 3;

/// A place counts when its residual is this many times that of everything.
const WORSE: f64 = 1.2;

/// Where the residual is larger than elsewhere, worst first; `tables` holds one table a recording and whether the
/// recording goes down to rest.
pub fn places(tables: &[(&[Row], bool)]) -> Vec<Place> {
    let all: Vec<&Row> = tables.iter().flat_map(|(rows, _)| rows.iter()).collect();
    let overall = joint(&all);
    let largest = all.iter().fold(0.0_f64, |largest, row| largest.max(row.amplitude_rad));
    let edge = |k: usize| largest * k as f64 / N_CLASSES as f64;
    let place = |words: String, rows: &[&Row]| {
        let residual_rad = joint(rows);
        Place { words, residual_rad, ratio: residual_rad / overall.max(1e-300) }
    };
    let class = |k: usize| {
        let rows: Vec<&Row> =
            all.iter().copied().filter(|row| (edge(k)..=edge(k + 1)).contains(&row.amplitude_rad)).collect();
        let words = match k {
            0 => format!("at small amplitude (< {} rad)", angle(edge(1))),
            k if k + 1 == N_CLASSES => format!("at large amplitude (> {} rad)", angle(edge(k))),
            k => format!("at amplitudes of {} to {} rad", angle(edge(k)), angle(edge(k + 1))),
        };
        place(words, &rows)
    };
    let last: Vec<&Row> = tables
        .iter()
        .filter(|(rows, rests)| *rests && rows.len() > 2 * N_LAST)
        .flat_map(|(rows, _)| &rows[rows.len() - N_LAST..])
        .collect();
    let mut places: Vec<Place> = (0..N_CLASSES).map(class).collect();
    places.push(place(format!("in the last {N_LAST} swings before rest"), &last));
    places.retain(|place| place.ratio > WORSE);
    places.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    places
}

/// Root mean square of the residuals of several rows, weighted by their durations.
fn joint(rows: &[&Row]) -> f64 {
    let seconds: f64 = rows.iter().map(|row| row.to_s - row.from_s).sum();
    let squares: f64 = rows.iter().map(|row| row.residual_rad.powi(2) * (row.to_s - row.from_s)).sum();
    if seconds > 0.0 { (squares / seconds).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_fails_at_large_amplitude_is_told_so() {
        let row = |k: usize| {
            let amplitude_rad = 1.5 - 0.14 * k as f64;
            let residual_rad = if amplitude_rad > 1.0 { 5e-3 } else { 1e-3 };
            Row { from_s: k as f64, to_s: k as f64 + 1.0, amplitude_rad, period_s: None, lost_j: None, residual_rad }
        };
        let rows: Vec<Row> = (0..10).map(row).collect();
        let places = places(&[(&rows, true)]);
        assert_eq!(places.len(), 1, "{places:?}");
        assert!(places[0].words.starts_with("at large amplitude (> 1.00 rad)"), "{places:?}");
    }

    #[test]
    fn residuals_of_rows_join_by_their_durations() {
        let row = |seconds: f64, residual_rad: f64| Row {
            from_s: 2.0,
            to_s: 2.0 + seconds,
            amplitude_rad: 1.0,
            period_s: None,
            lost_j: None,
            residual_rad,
        };
        assert!((joint(&[&row(3.0, 1e-3), &row(1.0, 5e-3)]) - 7f64.sqrt() * 1e-3).abs() < 1e-12);
        assert_eq!(joint(&[]), 0.0);
    }

    #[test]
    fn the_last_swings_are_told_of_a_recording_that_comes_to_rest_only() {
        let row = |k: usize| Row {
            from_s: k as f64,
            to_s: k as f64 + 1.0,
            amplitude_rad: 1.0,
            period_s: None,
            lost_j: None,
            residual_rad: if k < 17 { 1e-3 } else { 4e-3 },
        };
        let rows: Vec<Row> = (0..20).map(row).collect();
        let said = |rests: bool| places(&[(&rows, rests)]).into_iter().map(|place| place.words).collect::<Vec<_>>();
        assert_eq!(said(true), ["in the last 3 swings before rest"]);
        assert_eq!(said(false), [] as [String; 0]);
    }
}
