//! Control charts of one quantity of a rig, swing after swing: is it still what it was?
//!
//! In: values in their order. Out: a score for each, the two cumulative sums, and alarms.
//!
//! Mean and spread are not known beforehand, so the charts start themselves: each value is compared with all before
//! it since the last change. With n values of mean x̄ and standard deviation s before it, `T = √(n/(n+1))·(x − x̄)/s`
//! has Student's distribution with n − 1 degrees of freedom; the standard normal number of equal probability is its
//! score, and the scores are independent (D. M. Hawkins, J. Quality Technology 19 (1987) 195). So the rate of false
//! alarms holds from the first swing on, however few there are.
//!
//! - A single value is off when its score is beyond a limit (W. A. Shewhart's chart for individuals, NIST/SEMATECH
//!   e-Handbook 6.3.2.2). It then joins no mean.
//! - The level drifts when a cumulative sum `S ← max(0, S ± score − k)` passes h (E. S. Page, Biometrika 41 (1954) 100;
//!   NIST/SEMATECH e-Handbook 6.3.2.3). The most likely step since the sum left zero dates the change; behind the
//!   alarm the charts start anew.
//!
//! h follows from the rate of false alarms by D. Siegmund's approximation of the mean run length between them,
//! `(exp(2kb) − 2kb − 1)/(2k²)` with `b = h + 1.166` (Sequential Analysis, Springer 1985, section 2.6). Rates of
//! independent rules add up.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// False alarms a swing of all charts of a rig together.
pub const FALSE_ALARMS: f64 = 1e-3;

/// Of the false alarms of a chart the sum that falls and the single swing have this share each.
const OTHER_SHARE: f64 = 0.05;

/// The sum that rises has the others, because wear raises friction and comes slowly. With half of it a drift of a tenth of the
/// spread a swing is found 0.7 swings later (8,000 simulated rigs, 100 quiet swings each).
const RISING_SHARE: f64 = 1.0 - 2.0 * OTHER_SHARE;

/// k, in standard deviations: what a sum forgets each swing. A drift of a tenth of the spread a swing is found after
/// 14.4 swings on average; with 0.35 and with 0.65 after 14.6; half is later by a swing, twice waits for a step of
/// two spreads.
const ALLOWANCE: f64 = 0.5;

/// Siegmund's correction for the overshoot of a sum of normal numbers.
const OVERSHOOT: f64 = 1.166;

/// Fewer values before it give no score.
const FEWEST_BEFORE: usize = 3;

/// A single value that is off counts as so many standard deviations in the sums: alone it must not carry one over its
/// limit, four in a row do. With half it would take twelve, with twice one in five is called a change.
const OFF_COUNTS: f64 = 2.0;

/// What passes no limit of any use; a score of a value that repeats its forerunners to the last digit, but for one.
const LARGEST_SCORE: f64 = 8.0;

/// The limits of a chart, in standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Of the sum that rises.
    pub rising: f64,
    /// Of the sum that falls.
    pub falling: f64,
    /// Of a single score.
    pub single: f64,
}

impl Limits {
    /// For so many false alarms a swing in the mean, such as 0.001; from 0 (never) to 0.1.
    pub fn of(false_alarms: f64) -> Self {
        Self {
            rising: sum_limit(RISING_SHARE * false_alarms),
            falling: sum_limit(OTHER_SHARE * false_alarms),
            single: -standard_normal().inverse_cdf(OTHER_SHARE * false_alarms / 2.0),
        }
    }
}

/// h for one sum, by bisection of Siegmund's formula.
fn sum_limit(false_alarms: f64) -> f64 {
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *(if run_length(middle) < false_alarms.recip() { &mut low } else { &mut high }) = middle;
    }
    high
}

/// Mean number of swings between false alarms of one sum with this limit.
fn run_length(limit: f64) -> f64 {
    let twice_kb = 2.0 * ALLOWANCE * (limit + OVERSHOOT);
    (twice_kb.exp() - twice_kb - 1.0) / (2.0 * ALLOWANCE * ALLOWANCE)
}

fn standard_normal() -> Normal {
    Normal::standard()
}

/// What an alarm says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The level has risen.
    Rise,
    /// The level has fallen.
    Fall,
    /// This one value is off.
    Single,
}

/// One alarm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Alarm {
    /// What it says.
    pub kind: Kind,
    /// Index of the value that raised it.
    pub at: usize,
    /// Index of the first value after which it began; `at` for a single value.
    pub since: usize,
    /// How much larger the values since then are than those before, as a share, with its standard deviation.
    pub change: Option<(f64, f64)>,
}

/// A value in its chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Point {
    /// Standard normal while nothing changes; 0 for the first ones.
    pub score: f64,
    /// The sum that rises.
    pub rising: f64,
    /// The sum that falls, as a positive number.
    pub falling: f64,
    /// A value outside of these would have been a single one that is off; `None` for the first ones.
    pub band: Option<(f64, f64)>,
}

/// All values of a quantity in their charts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chart {
    /// One a value.
    pub points: Vec<Point>,
    /// In the order of the values.
    pub alarms: Vec<Alarm>,
    /// The limits.
    pub limits: Limits,
    /// Since the last change: mean of the values that count, and their standard deviation.
    pub level: Option<(f64, f64)>,
}

/// Charts values, which must be finite.
pub fn chart(values: &[f64], limits: Limits) -> Chart {
    let mut running =
        Running { values, limits, begin: 0, off: Vec::new(), sums: Sums::default(), before: Moments::default() };
    let mut chart = Chart { points: Vec::new(), alarms: Vec::new(), limits, level: None };
    for at in 0..values.len() {
        let (point, alarm) = running.next(at);
        chart.points.push(point);
        chart.alarms.extend(alarm);
    }
    chart.level = (running.before.n > 0).then(|| (running.before.mean, running.before.std().unwrap_or(0.0)));
    chart
}

/// How much larger the later values are than those before, as a share, with its standard deviation. Later values may
/// scatter more, because the change goes on; then their own scatter counts.
pub fn change(before: &[f64], later: &[f64]) -> Option<(f64, f64)> {
    let moments = |values: &[f64]| {
        let mut moments = Moments::default();
        values.iter().for_each(|value| moments.add(*value));
        moments
    };
    let (before, later) = (moments(before), moments(later));
    let wider = later.std().unwrap_or(0.0) / before.std().unwrap_or(0.0);
    let (share, std) = before.change_to(&later)?;
    Some((share, if wider.is_finite() { std * wider.max(1.0) } else { std }))
}

/// A chart on its way.
struct Running<'a> {
    values: &'a [f64],
    limits: Limits,
    /// Where the present level began.
    begin: usize,
    /// Single values that were off.
    off: Vec<usize>,
    sums: Sums,
    before: Moments,
}

/// Both sums, and the last index at which each was zero.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    rising: f64,
    falling: f64,
    rising_since: usize,
    falling_since: usize,
}

impl Running<'_> {
    fn next(&mut self, at: usize) -> (Point, Option<Alarm>) {
        let score = self.before.score(self.values[at]);
        let is_off = score.abs() > self.limits.single;
        self.sums.add(if is_off { score.signum() * OFF_COUNTS } else { score }, at);
        let band = self.before.band(self.limits.single);
        let point = Point { score, rising: self.sums.rising, falling: self.sums.falling, band };
        let changed = match (self.sums.rising > self.limits.rising, self.sums.falling > self.limits.falling) {
            (true, _) => Some((Kind::Rise, self.sums.rising_since)),
            (_, true) => Some((Kind::Fall, self.sums.falling_since)),
            _ => None,
        };
        if let Some((kind, since)) = changed {
            return (point, Some(self.changed(kind, since, at)));
        }
        if is_off {
            self.off.push(at);
            return (point, Some(Alarm { kind: Kind::Single, at, since: at, change: None }));
        }
        self.before.add(self.values[at]);
        (point, None)
    }

    /// The level has changed: the charts begin anew with the next value, because those that raised the alarm were
    /// picked by it and would bias a mean.
    fn changed(&mut self, kind: Kind, last_zero: usize, at: usize) -> Alarm {
        let mut before = Moments::default();
        (self.begin..last_zero).filter(|idx| !self.off.contains(idx)).for_each(|idx| before.add(self.values[idx]));
        let since = self.most_likely_step(&before, last_zero, at);
        let mut after = Moments::default();
        (since..=at).for_each(|idx| after.add(self.values[idx]));
        let anew = Sums { rising_since: at + 1, falling_since: at + 1, ..Sums::default() };
        (self.begin, self.before, self.sums) = (at + 1, Moments::default(), anew);
        Alarm { kind, at, since, change: before.change_to(&after) }
    }

    /// Where a step away from the level before explains the values since the sum's last zero best: the largest
    /// `(Σ (x − x̄))² / n` over the values behind it (D. V. Hinkley, Biometrika 57 (1970) 1).
    fn most_likely_step(&self, before: &Moments, last_zero: usize, at: usize) -> usize {
        let (mut sum, mut best, mut since) = (0.0, 0.0, last_zero);
        for first in (last_zero..=at).rev() {
            sum += self.values[first] - before.mean;
            let gain = sum * sum / (at - first + 1) as f64;
            if gain > best {
                (best, since) = (gain, first);
            }
        }
        since
    }
}

impl Sums {
    fn add(&mut self, score: f64, at: usize) {
        self.rising = (self.rising + score - ALLOWANCE).max(0.0);
        self.falling = (self.falling - score - ALLOWANCE).max(0.0);
        if self.rising == 0.0 {
            self.rising_since = at + 1;
        }
        if self.falling == 0.0 {
            self.falling_since = at + 1;
        }
    }
}

/// Number, mean and sum of squares about it (B. P. Welford, Technometrics 4 (1962) 419).
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    n: usize,
    mean: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.n += 1;
        let off = value - self.mean;
        self.mean += off / self.n as f64;
        self.squares += off * (value - self.mean);
    }

    fn std(&self) -> Option<f64> {
        (self.n > 1).then(|| (self.squares / (self.n - 1) as f64).sqrt())
    }

    /// The score of a further value.
    fn score(&self, value: f64) -> f64 {
        let off = value - self.mean;
        let Some(std) = self.std().filter(|_| self.n >= FEWEST_BEFORE) else { return 0.0 };
        if off == 0.0 {
            return 0.0;
        }
        let n = self.n as f64;
        let t = (n / (n + 1.0)).sqrt() * off / std;
        normal_of(t, n - 1.0)
    }

    /// Between which values a score stays within a limit.
    fn band(&self, limit: f64) -> Option<(f64, f64)> {
        let std = self.std().filter(|_| self.n >= FEWEST_BEFORE)?;
        let n = self.n as f64;
        let student = StudentsT::new(0.0, 1.0, n - 1.0).ok()?;
        let t = -student.inverse_cdf(standard_normal().cdf(-limit));
        let width = t * std * ((n + 1.0) / n).sqrt();
        Some((self.mean - width, self.mean + width))
    }

    /// The difference to another level as a share of this one, with its standard deviation.
    fn change_to(&self, after: &Self) -> Option<(f64, f64)> {
        let std = self.std().filter(|_| after.n > 0 && self.mean != 0.0)?;
        let error = std * ((self.n as f64).recip() + (after.n as f64).recip()).sqrt();
        Some(((after.mean - self.mean) / self.mean, error / self.mean.abs()))
    }
}

/// The standard normal number that is as improbable as `t` of Student's distribution.
fn normal_of(t: f64, freedom: f64) -> f64 {
    let Ok(student) = StudentsT::new(0.0, 1.0, freedom) else { return 0.0 };
    let beyond = student.sf(t.abs());
    let size = if beyond > 0.0 { -standard_normal().inverse_cdf(beyond) } else { LARGEST_SCORE };
    t.signum() * size.min(LARGEST_SCORE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_the_tables() {
        // D. C. Montgomery's tables and the handbook: k = ½, h = 4.77 and 5.07 for 370 and 500 swings between alarms of
        // both sums, 740 and 1000 of one.
        assert!((sum_limit(1.0 / 740.0) - 4.77).abs() < 0.03, "{}", sum_limit(1.0 / 740.0));
        assert!((sum_limit(1.0 / 1000.0) - 5.07).abs() < 0.03, "{}", sum_limit(1.0 / 1000.0));
        // Three sigma to both sides: 0.0027.
        assert!((Limits::of(0.0027 / OTHER_SHARE).single - 3.0).abs() < 1e-3);
    }

    #[test]
    fn a_step_is_dated_and_measured_and_one_outlier_is_no_step() {
        let wiggle = |idx: usize| [0.0, 0.9, -1.1, 0.4, -0.2, 1.0, -0.8][idx % 7] * 0.005;
        let steady: Vec<f64> = (0..60).map(|idx| 1.0 + wiggle(idx)).collect();
        assert_eq!(chart(&steady, Limits::of(FALSE_ALARMS)).alarms, []);

        let mut one = steady.clone();
        one[30] = 1.1;
        let alarms = chart(&one, Limits::of(FALSE_ALARMS)).alarms;
        assert_eq!(alarms, [Alarm { kind: Kind::Single, at: 30, since: 30, change: None }]);

        let stepped: Vec<f64> = (0..60).map(|idx| steady[idx] * if idx < 40 { 1.0 } else { 1.02 }).collect();
        let alarms: Vec<Alarm> = chart(&stepped, Limits::of(FALSE_ALARMS)).alarms;
        let rise = alarms.iter().find(|alarm| alarm.kind == Kind::Rise).unwrap();
        assert!(rise.since.abs_diff(40) <= 2 && rise.at < 46, "{rise:?}");
        let (share, std) = rise.change.unwrap();
        assert!((share - 0.02).abs() < 3.0 * std && std < 0.01, "{share} ± {std}");
    }

    #[test]
    fn scores_are_symmetric_and_finite() {
        let values = [1.0, 1.0, 1.0, 1.0, 2.0, 1.0];
        let points = chart(&values, Limits::of(FALSE_ALARMS)).points;
        assert!(points.iter().all(|point| point.score.is_finite()), "{points:?}");
        // The one that differs from forerunners that are all alike is off, and joins no mean.
        assert_eq!((points[4].score, points[5].band), (LARGEST_SCORE, Some((1.0, 1.0))));
        let usual = chart(&[1.0, 1.1, 0.9, 1.05, 0.95], Limits::of(FALSE_ALARMS));
        assert!(usual.points[4].score.abs() < usual.limits.single, "{usual:?}");
        assert!((normal_of(2.5, 7.0) + normal_of(-2.5, 7.0)).abs() < 1e-12);
        // The 97.5 % point of Student's distribution with 10 degrees of freedom is 2.228.
        assert!((normal_of(2.228_138_852, 10.0) - 1.959_964).abs() < 1e-5);
    }

    #[test]
    fn a_change_is_as_uncertain_as_the_wider_of_both_scatters_makes_it() {
        let before = [0.9, 1.0, 1.1];
        let of_three = 0.1 * (2.0_f64 / 3.0).sqrt();
        let (share, std) = change(&before, &[2.0, 2.0, 2.0]).unwrap();
        assert!((share - 1.0).abs() < 1e-12 && (std - of_three).abs() < 1e-12, "{share} ± {std}");
        let (share, std) = change(&before, &[1.6, 2.0, 2.4]).unwrap();
        assert!((share - 1.0).abs() < 1e-12 && (std - 4.0 * of_three).abs() < 1e-12, "{share} ± {std}");
    }
}
