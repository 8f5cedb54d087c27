//! What the recordings of one rig say together: its friction, swing after swing, and which swings don't belong.
//!
//! In: the rows of a rig. Out: a [`RigView`], which follows from the rows alone, in whatever order they were made.

use super::chart::{self, Alarm, Chart, FALSE_ALARMS, Kind, Limits};
use super::order::in_order;
use super::outlier::{Side, outliers};
use super::percent::percent;
use super::row::{Outcome, Row};
use serde::Serialize;
use shared::effect::Effect;

/// What is charted: dry friction and viscous friction. Wear changes one of them.
///
/// Each has a share of the false alarms of a rig. Dry friction shows wear first and has most; what is left is for
/// swings pushed by hand, which leave several times the noise and need no sharp limit. With half of its share a drift of
/// Mc is found 0.6 swings later (8,000 simulated rigs).
pub const CHARTED: [Charted; 2] = [
    Charted { symbol: "Mc", name: "dry friction", false_alarms: 0.6 * FALSE_ALARMS },
    Charted { symbol: "Mw", name: "viscous friction", false_alarms: 0.3 * FALSE_ALARMS },
];
const PUSH_SHARE: f64 = 0.1;

/// A quantity that is charted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charted {
    /// The literature's symbol.
    pub symbol: &'static str,
    /// What it is.
    pub name: &'static str,
    /// False alarms a swing that its chart may raise.
    pub false_alarms: f64,
}

/// Swings whose period differs by more than this from the rig's median are of another pendulum. Of simulated rigs it is
/// found within 0.05 %; half would accuse a rig whose screws were tightened, twice overlook a bob moved by 12 %.
const OTHER_PERIOD: f64 = 0.03;

/// So many swings at the end of a change tell how far it has come.
const LATEST: usize = 5;

/// A rig and what is found of it.
#[derive(Clone, Debug)]
pub struct RigView {
    /// Its folder within the study.
    pub name: String,
    /// Its recordings, the oldest first.
    pub rows: Vec<Row>,
    /// What orders them, in words.
    pub order: &'static str,
    /// Each quantity of [`CHARTED`] that was fitted.
    pub friction: Vec<Friction>,
    /// What is found, the most important first.
    pub findings: Vec<Finding>,
    /// Recordings that count for nothing, and why: of another pendulum, or the same twice.
    pub left_out: Vec<(usize, String)>,
    /// Recordings in which a hand moved the pendulum, as far as the fit tells.
    pub pushed: Vec<usize>,
}

/// One quantity of a rig over its swings.
#[derive(Clone, Debug)]
pub struct Friction {
    /// The literature's symbol.
    pub symbol: &'static str,
    /// What it is.
    pub name: &'static str,
    /// SI unit.
    pub unit: String,
    /// Which recordings count: indices of the rows.
    pub of: Vec<usize>,
    /// Their values.
    pub values: Vec<f64>,
    /// Standard deviations as the fits have them.
    pub stds: Vec<Option<f64>>,
    /// All of them in charts.
    pub chart: Chart,
    /// Mean and what is known of it.
    pub mean: Mean,
}

/// A mean over swings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// Of so many swings.
    pub n: usize,
    /// The mean.
    pub value: f64,
    /// Its standard error, from how the swings scatter and how surely mass and length are known, which all of them share;
    /// of a single swing that of its fit.
    pub std_error: Option<f64>,
    /// Standard deviation from swing to swing.
    pub spread: Option<f64>,
}

/// Something a person should know of a rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What kind of thing.
    pub kind: FindingKind,
    /// A sentence.
    pub words: String,
    /// The recording it begins with.
    pub recording: Option<String>,
}

/// What is found, the most important first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingKind {
    /// Friction has risen.
    Wears,
    /// Friction has fallen.
    Eases,
    /// A hand moved the pendulum.
    Pushed,
    /// One swing's friction is off.
    Single,
    /// Not of this pendulum.
    OtherRig,
    /// The same recording again.
    Twice,
    /// The sensor's zero is off.
    Zero,
}

impl RigView {
    /// Judges the rows of a rig, in whatever order they come.
    pub fn new(name: &str, rows: Vec<Row>) -> Self {
        let (rows, order) = in_order(rows);
        let left_out = left_out(&rows);
        let counts = |idx: &usize| rows[*idx].found().is_some() && !left_out.iter().any(|(out, _)| out == idx);
        let candidates: Vec<usize> = (0..rows.len()).filter(counts).collect();
        let pushed = pushed(&rows, &candidates);
        let steady: Vec<usize> = candidates.into_iter().filter(|idx| !pushed.contains(idx)).collect();
        let friction: Vec<Friction> = CHARTED.iter().filter_map(|charted| friction(&rows, &steady, charted)).collect();
        let mut view = Self { name: name.to_owned(), rows, order, friction, findings: Vec::new(), left_out, pushed };
        view.findings = view.found();
        view
    }

    /// A quantity by its symbol.
    pub fn friction_of(&self, symbol: &str) -> Option<&Friction> {
        self.friction.iter().find(|friction| friction.symbol == symbol)
    }

    /// Recordings with a fit.
    pub fn n_fitted(&self) -> usize {
        self.rows.iter().filter(|row| row.found().is_some()).count()
    }

    /// The newest recordings that count, the newest last.
    pub fn newest(&self, n: usize) -> Vec<&Row> {
        let counts = |(idx, row): &(usize, &Row)| {
            row.found().is_some() && !self.pushed.contains(idx) && !self.left_out.iter().any(|(out, _)| out == idx)
        };
        let all: Vec<&Row> = self.rows.iter().enumerate().filter(counts).map(|(_, row)| row).collect();
        all[all.len().saturating_sub(n)..].to_vec()
    }

    fn found(&self) -> Vec<Finding> {
        let recording = |idx: usize| self.rows[idx].key.recording.clone();
        let mut findings: Vec<Finding> =
            self.friction.iter().flat_map(|friction| friction.findings(&self.rows)).collect();
        findings.extend(self.pushed.iter().map(|idx| Finding {
            kind: FindingKind::Pushed,
            words: pushed_in_words(&self.rows[*idx]),
            recording: Some(recording(*idx)),
        }));
        findings.extend(self.left_out.iter().map(|(idx, why)| Finding {
            kind: if why.contains("period") { FindingKind::OtherRig } else { FindingKind::Twice },
            words: format!("{} is left out: {why}", recording(*idx)),
            recording: Some(recording(*idx)),
        }));
        findings.extend(zero(&self.rows));
        findings.sort_by_key(|finding| finding.kind);
        findings
    }
}

/// A zero that is off spoils no fit, but whatever runs on the rig.
fn zero(rows: &[Row]) -> Option<Finding> {
    let fitted: Vec<&Outcome> = rows.iter().filter_map(Row::found).collect();
    let zeros: Vec<f64> = fitted.iter().filter_map(|found| Some(found.number(zero_symbol()?)?.value)).collect();
    let [first, ..] = zeros[..] else { return None };
    let (low, high) = zeros.iter().fold((first, first), |(low, high), zero| (low.min(*zero), high.max(*zero)));
    let told = |off_rad: f64| format!("{off_rad:.3} rad ({:.1}°)", off_rad.to_degrees());
    let range = if told(low) == told(high) { told(low) } else { format!("{} to {}", told(low), told(high)) };
    let words = format!(
        "the zero of the sensor is off by {range} in {} of {} recordings: fits take it off, but a rig's observer is wrong by it \
         until host calibrate puts it right",
        zeros.len(),
        fitted.len()
    );
    Some(Finding { kind: FindingKind::Zero, words, recording: None })
}

fn zero_symbol() -> Option<&'static str> {
    let effect = Effect::<f64>::with(|rules| rules.is_free_offset).next()?;
    Some(effect.parameters.first()?.symbol)
}

fn pushed_in_words(row: &Row) -> String {
    let times = row.found().map_or(f64::NAN, |found| found.error_rad / found.noise_rad);
    format!(
        "{} was disturbed: the model leaves {times:.1} times the noise, far more than in this rig's other swings; \
         a push by hand looks like this",
        row.key.recording
    )
}

/// Recordings of another pendulum, and those that are there twice.
fn left_out(rows: &[Row]) -> Vec<(usize, String)> {
    let mut out = Vec::new();
    for (idx, row) in rows.iter().enumerate().filter(|(_, row)| row.found().is_some()) {
        let first = rows[..idx].iter().find(|other| other.origin.file_hash == row.origin.file_hash);
        out.extend(first.map(|first| {
            (idx, format!("it holds the same bytes as {}, which would count twice", first.key.recording))
        }));
    }
    let period = |row: &Row| row.found().and_then(|found| found.period_s);
    let mut periods: Vec<f64> = rows.iter().filter_map(period).collect();
    let usual_s = crate::recording::median(&mut periods);
    for (idx, row) in rows.iter().enumerate() {
        let Some(period_s) = period(row).filter(|period_s| (period_s / usual_s - 1.0).abs() > OTHER_PERIOD) else {
            continue;
        };
        let why = format!(
            "its period of small swings is {period_s:.3} s, that of the rig's others {usual_s:.3} s; it may be of \
             another rig: move it there"
        );
        out.push((idx, why));
    }
    out
}

/// Swings that leave far more than the others do, and clearly more than noise.
fn pushed(rows: &[Row], candidates: &[usize]) -> Vec<usize> {
    let found = |idx: &usize| rows[*idx].found();
    let ratios: Vec<f64> =
        candidates.iter().filter_map(found).map(|found| (found.error_rad / found.noise_rad).ln()).collect();
    let stands_out = outliers(&ratios, Side::Above, PUSH_SHARE * FALSE_ALARMS);
    let candidates = stands_out.into_iter().map(|place| candidates[place]);
    candidates.filter(|idx| found(idx).is_some_and(|found| found.left == "missing")).collect()
}

fn friction(rows: &[Row], steady: &[usize], charted: &Charted) -> Option<Friction> {
    let Charted { symbol, name, false_alarms } = *charted;
    let number = |idx: &usize| rows[*idx].found().and_then(|found| found.number(symbol));
    let is_known = |idx: &&usize| number(idx).is_some_and(|number| number.status == "identified");
    let of: Vec<usize> = steady.iter().filter(is_known).copied().collect();
    let unit = number(of.first()?)?.unit.clone();
    let values: Vec<f64> = of.iter().filter_map(number).map(|number| number.value).collect();
    let stds: Vec<Option<f64>> = of.iter().filter_map(number).map(|number| number.std).collect();
    let chart = chart::chart(&values, Limits::of(false_alarms));
    let weight_share = of.last().and_then(|idx| rows[*idx].found()).map_or(0.0, weight_share);
    let mean = Mean::of(&values, &stds, weight_share);
    Some(Friction { symbol, name, unit, of, values, stds, chart, mean })
}

/// How surely the rig's m·l is known, as a share: every torque of a swing is a share of m·g·l, and no number of swings tells
/// that better. What a tolerance of the inertia lets mass and length have in common is left out.
fn weight_share(found: &Outcome) -> f64 {
    let share = |symbol: &str| found.number(symbol).and_then(|number| Some(number.std? / number.value));
    share("m").unwrap_or(0.0).hypot(share("l").unwrap_or(0.0))
}

impl Mean {
    fn of(values: &[f64], stds: &[Option<f64>], weight_share: f64) -> Self {
        let n = values.len();
        let value = values.iter().sum::<f64>() / n as f64;
        let squares: f64 = values.iter().map(|each| (each - value).powi(2)).sum();
        let spread = (n > 1).then(|| (squares / (n - 1) as f64).sqrt());
        let of_scatter = spread.map(|spread| (spread / (n as f64).sqrt()).hypot(weight_share * value));
        let std_error = of_scatter.or(stds.first().copied().flatten());
        Self { n, value, std_error, spread }
    }
}

impl Friction {
    fn findings(&self, rows: &[Row]) -> Vec<Finding> {
        let (singles, changes): (Vec<&Alarm>, Vec<&Alarm>) =
            self.chart.alarms.iter().partition(|alarm| alarm.kind == Kind::Single);
        // Alarms of one direction one after the other are one change that goes on.
        let changes: Vec<&[&Alarm]> = changes.chunk_by(|one, next| one.kind == next.kind).collect();
        let changed = changes.iter().enumerate().map(|(place, change)| {
            let begin = place.checked_sub(1).and_then(|before| changes[before].last()).map_or(0, |last| last.at + 1);
            let end = changes.get(place + 1).map_or(self.values.len(), |next| next[0].since);
            self.changed(change[0], begin, end, rows)
        });
        changed.chain(singles.iter().map(|alarm| self.single(alarm, rows))).collect()
    }

    /// A change that begins with an alarm, between the begin of the level before it and the begin of the next change.
    fn changed(&self, first: &Alarm, begin: usize, end: usize, rows: &[Row]) -> Finding {
        let Self { symbol, name, .. } = self;
        let [since, seen] = [first.since, first.at].map(|place| self.recording(place, rows));
        let (kind, has) = match first.kind {
            Kind::Fall => (FindingKind::Eases, "fallen"),
            _ => (FindingKind::Wears, "risen"),
        };
        let latest = self.usual(first.since, end);
        let latest = &latest[latest.len().saturating_sub(LATEST)..];
        let size = chart::change(&self.usual(begin, first.since), latest);
        let when = match latest.len() {
            _ if end < self.values.len() => format!("up to {}", self.recording(end.max(1) - 1, rows)),
            1 => "in the last swing".to_owned(),
            n => format!("in the last {n} swings"),
        };
        let by = size.map_or(String::new(), |(share, std)| format!(", {when} by {}", percent(share, Some(std))));
        let words = format!("{name} {symbol} has {has} since {since} (sure with {seen}){by}");
        Finding { kind, words, recording: Some(since) }
    }

    fn single(&self, alarm: &Alarm, rows: &[Row]) -> Finding {
        let Self { symbol, name, .. } = self;
        let (recording, score) = (self.recording(alarm.at, rows), self.chart.points[alarm.at].score);
        let words = format!("{name} {symbol} of {recording} is off by {score:+.1} standard deviations");
        Finding { kind: FindingKind::Single, words, recording: Some(recording) }
    }

    fn recording(&self, place: usize, rows: &[Row]) -> String {
        rows[self.of[place]].key.recording.clone()
    }

    /// Values of a stretch without single ones that are off.
    fn usual(&self, begin: usize, end: usize) -> Vec<f64> {
        let is_off =
            |place: usize| self.chart.alarms.iter().any(|alarm| alarm.kind == Kind::Single && alarm.at == place);
        (begin..end).filter(|place| !is_off(*place)).map(|place| self.values[place]).collect()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::row::{Key, Number, Origin};
    use super::*;

    /// A recording in which the dry friction is `value` ± `std`.
    pub(crate) fn row(recording: &str, value: f64, std: f64) -> Row {
        let text = str::to_owned;
        let number = |symbol: &str, value: f64| Number {
            symbol: text(symbol),
            effect: text("coulomb"),
            unit: text("N·m"),
            value,
            std: Some(std),
            upper: Some(9.0),
            status: text("identified"),
        };
        let outcome = Outcome {
            n_samples: 100,
            duration_s: 20.0,
            amplitude_rad: 1.0,
            period_s: Some(1.0),
            noise_rad: 1e-3,
            error_rad: 2e-3,
            left: text("noise"),
            notes: Vec::new(),
            numbers: vec![number("Mc", value), number("Mw", 0.1 * value)],
        };
        Row {
            key: Key { rig: text("rig"), recording: text(recording) },
            origin: Origin { file_hash: text(recording), model_hash: text("m"), options: String::new() },
            program: text("0"),
            studied: text("2026-01-01"),
            recorded: None,
            outcome: Ok(outcome),
        }
    }

    /// What the rows say of their rig, the one that is changed at its place.
    fn changed(n: usize, at: usize, change: impl Fn(&mut Row)) -> RigView {
        let value = |k: usize| 1.0 + 0.01 * [0.0, 1.0, -1.0, 0.5, -0.5][k % 5];
        let mut rows: Vec<Row> = (0..n).map(|k| row(&format!("swing-{k:02}.csv"), value(k), 0.01)).collect();
        change(&mut rows[at]);
        RigView::new("rig", rows)
    }

    #[test]
    fn a_mean_is_as_uncertain_as_its_swings_scatter_and_as_the_weight_is_known() {
        let found = Mean::of(&[1.0, 2.0, 3.0], &[Some(0.1); 3], 0.0);
        assert_eq!((found.n, found.value, found.spread), (3, 2.0, Some(1.0)));
        assert!((found.std_error.unwrap() - 1.0 / 3f64.sqrt()).abs() < 1e-12);
        let weighed = Mean::of(&[1.0, 2.0, 3.0], &[Some(0.1); 3], 0.5);
        assert!((weighed.std_error.unwrap() - (1.0_f64 / 3.0 + 1.0).sqrt()).abs() < 1e-12);
        assert_eq!(Mean::of(&[1.0], &[Some(0.1)], 0.5).std_error, Some(0.1));
    }

    #[test]
    fn a_zero_that_is_off_is_named_with_its_range_and_how_often() {
        let off = |row: &mut Row, zero_rad: f64| {
            let numbers = &mut row.outcome.as_mut().unwrap().numbers;
            numbers.push(Number { symbol: "off".to_owned(), value: zero_rad, ..numbers[0].clone() });
        };
        let mut rows: Vec<Row> = (0..4).map(|k| row(&format!("swing-{k}.csv"), 1.0, 0.01)).collect();
        assert!(RigView::new("rig", rows.clone()).findings.is_empty());
        off(&mut rows[0], -0.013);
        let words = |rows: &[Row]| RigView::new("rig", rows.to_vec()).findings.pop().unwrap().words;
        assert!(words(&rows).contains("is off by -0.013 rad (-0.7°) in 1 of 4 recordings"), "{}", words(&rows));
        off(&mut rows[2], 0.02);
        assert!(words(&rows).contains("-0.013 rad (-0.7°) to 0.020 rad (1.1°) in 2 of 4"), "{}", words(&rows));
    }

    #[test]
    fn the_same_bytes_and_another_period_are_left_out_for_what_they_are() {
        let twice = changed(8, 3, |row| row.origin.file_hash = "swing-01.csv".to_owned());
        let finding = &twice.findings[0];
        assert_eq!((finding.kind, finding.recording.as_deref()), (FindingKind::Twice, Some("swing-03.csv")));
        assert!(finding.words.contains("the same bytes as swing-01.csv"), "{finding:?}");
        let other = changed(8, 3, |row| row.outcome.as_mut().unwrap().period_s = Some(1.2));
        let finding = &other.findings[0];
        assert_eq!((finding.kind, finding.recording.as_deref()), (FindingKind::OtherRig, Some("swing-03.csv")));
        assert!(finding.words.contains("is 1.200 s, that of the rig's others 1.000 s"), "{finding:?}");
    }

    #[test]
    fn an_alarm_names_its_recording_whatever_is_left_out_before_it() {
        let value = |k: usize| 1.0 + 0.01 * [0.0, 1.0, -1.0, 0.5, -0.5][k % 5];
        let mut rows: Vec<Row> = (0..30).map(|k| row(&format!("swing-{k:02}.csv"), value(k), 0.01)).collect();
        rows[2].outcome = Err("broken".to_owned());
        for row in &mut rows[20..] {
            row.outcome.as_mut().unwrap().numbers[0].value += 0.2;
        }
        let view = RigView::new("rig", rows);
        let wears = view.findings.iter().find(|finding| finding.kind == FindingKind::Wears).unwrap();
        assert_eq!(wears.recording.as_deref(), Some("swing-20.csv"), "{wears:?}");
        // From 1.000 on the mean to 1.200: a fifth, give or take what the first swings scatter.
        let told =
            "dry friction Mc has risen since swing-20.csv (sure with swing-23.csv), in the last 5 swings by 19.9";
        assert!(wears.words.starts_with(told), "{wears:?}");
    }

    /// Swings of a rig with these values of Mc, one a day.
    pub(in super::super) fn rig(values: &[f64], stds: &[f64]) -> RigView {
        let rows = values.iter().zip(stds).enumerate().map(|(idx, (value, std))| day(idx, *value, *std));
        RigView::new("rig", rows.collect())
    }

    fn day(idx: usize, value: f64, std: f64) -> Row {
        let day = idx + 1;
        let number = Number {
            symbol: "Mc".to_owned(),
            effect: "coulomb".to_owned(),
            unit: "N·m".to_owned(),
            value,
            std: Some(std),
            upper: None,
            status: "identified".to_owned(),
        };
        let outcome = Outcome {
            n_samples: 1000,
            duration_s: 20.0,
            amplitude_rad: 0.5,
            period_s: Some(1.0),
            noise_rad: 1e-4,
            error_rad: 1e-4,
            left: "noise".to_owned(),
            notes: Vec::new(),
            numbers: vec![number],
        };
        Row {
            key: Key { rig: "rig".to_owned(), recording: format!("day-{day:02}.csv") },
            origin: Origin { file_hash: format!("{day}"), model_hash: String::new(), options: String::new() },
            program: String::new(),
            studied: String::new(),
            recorded: Some(format!("2026-01-{day:02}T12:00:00Z")),
            outcome: Ok(outcome),
        }
    }

    /// Ten days as they were, then a fifth of a percent more each day.
    pub(in super::super) fn wearing() -> Vec<f64> {
        let wiggle = |idx: usize| [0.0, 0.9, -1.1, 0.4, -0.2, 1.0, -0.8][idx % 7] * 1e-3;
        (0..40).map(|idx| 7e-4 * (1.0 + wiggle(idx) + 0.002 * idx.saturating_sub(9) as f64)).collect()
    }

    #[test]
    fn wear_is_told_as_it_is_at_the_end_and_once() {
        let view = rig(&wearing(), &[1e-7; 40]);
        let words: Vec<&str> = view.findings.iter().map(|finding| finding.words.as_str()).collect();
        assert!(view.friction[0].chart.alarms.len() > 1 && words.len() == 1, "{words:?}");
        assert!(words[0].starts_with("dry friction Mc has risen since day-1"), "{words:?}");
        // The last five are 5.2, 5.4, … 6.0 % more.
        assert!(words[0].contains("in the last 5 swings by 5.") && words[0].contains(" ± "), "{words:?}");
    }

    #[test]
    fn a_change_that_was_undone_is_told_up_to_its_end() {
        let wiggle = |idx: usize| [0.0, 0.9, -1.1, 0.4, -0.2, 1.0, -0.8][idx % 7] * 1e-3;
        let level = |idx: usize| if (10..20).contains(&idx) { 1.1 } else { 1.0 };
        let values: Vec<f64> = (0..30).map(|idx| 7e-4 * (level(idx) + wiggle(idx))).collect();
        let view = rig(&values, &[1e-7; 30]);
        let words: Vec<&str> = view.findings.iter().map(|finding| finding.words.as_str()).collect();
        assert!(
            words[0].contains("has risen since day-11.csv") && words[0].contains("up to day-20.csv by "),
            "{words:?}"
        );
        // From 1.1 back to 1: by a eleventh of what it was.
        let back = words[1].split_once("in the last 5 swings by 9.").map(|(begin, _)| begin);
        assert!(back.is_some_and(|begin| begin.contains("has fallen since day-21.csv")), "{words:?}");
    }

    #[test]
    fn one_swing_that_is_off_does_not_tell_how_far_a_change_has_come() {
        let wiggle = |idx: usize| [0.0, 0.9, -1.1, 0.4, -0.2, 1.0, -0.8][idx % 7] * 1e-3;
        let level = |idx: usize| if idx < 10 { 1.0 } else { 1.1 };
        let mut values: Vec<f64> = (0..30).map(|idx| 7e-4 * (level(idx) + wiggle(idx))).collect();
        values[27] *= 1.5;
        let view = rig(&values, &[1e-7; 30]);
        let rise = view.findings.iter().find(|finding| finding.kind == FindingKind::Wears).unwrap();
        let by = rise.words.split_once("in the last 5 swings by ").unwrap().1;
        assert!(by.starts_with("9.9") || by.starts_with("10.0"), "{rise:?}");
    }
}
