//! The drawings of the page: across in percent, so that they fit any screen while words and dots keep their size.

use super::super::between::{Between, Place};
use super::super::chart::{Alarm, Kind};
use super::super::rig::{Friction, RigView};
use super::MOST_SWINGS;
use super::words::{anchor, number, raised};
use maud::{Markup, html};
use std::ops::Range;

/// Heights in pixels.
const CONTROL: f64 = 190.0;
const SUMS: f64 = 110.0;

/// The values set the scale of a chart; a ± or a band may widen it by so much of their range to either side, because a
/// single swing of which little is known would make a flat line of all others.
const AROUND: f64 = 0.5;

/// Room above and below, as a share of the range.
const ROOM: f64 = 0.08;

/// A range of values over a height.
struct Scale {
    low: f64,
    high: f64,
    height: f64,
}

impl Scale {
    fn of(values: impl Iterator<Item = f64>, height: f64) -> Self {
        let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let room = (ROOM * (high - low)).max(1e-3 * high.abs()).max(f64::MIN_POSITIVE);
        Self { low: low - room, high: high + room, height }
    }

    /// Pixels from the top; what is beyond the range stays on its edge.
    fn y(&self, value: f64) -> f64 {
        let share = ((self.high - value) / (self.high - self.low)).clamp(0.0, 1.0);
        (10.0 * self.height * share).round() / 10.0
    }
}

/// Places across, in percent.
struct Places {
    from: usize,
    n: usize,
}

impl Places {
    fn of(n_all: usize) -> Self {
        let from = n_all.saturating_sub(MOST_SWINGS);
        Self { from, n: (n_all - from).max(1) }
    }

    fn percent(&self, idx: usize) -> f64 {
        100.0 * ((idx - self.from) as f64 + 0.5) / self.n as f64
    }

    fn x(&self, idx: usize) -> String {
        format!("{:.3}%", self.percent(idx))
    }
}

/// Each swing with its ±, and the band in which it should lie.
pub(super) fn control(rig: &RigView, friction: &Friction) -> Markup {
    let places = Places::of(friction.values.len());
    let shown = places.from..friction.values.len();
    let std = |idx: usize| friction.stds[idx].unwrap_or(0.0);
    let scale = Scale::of(extent(friction, shown.clone()).into_iter(), CONTROL);
    let name = |idx: usize| &rig.rows[friction.of[idx]].key.recording;
    let alarm = |idx: usize| friction.chart.alarms.iter().find(|alarm| alarm.at == idx);
    let exponent = friction.mean.value.abs().log10().floor() as i32;
    let unit = 10f64.powi(exponent);
    let (ticks, digits) = round_ticks(scale.low / unit, scale.high / unit);
    let label = format!("10{} {}", raised(exponent), friction.unit);
    plot(
        &label,
        &ticks.iter().map(|tick| (scale.y(tick * unit), format!("{tick:.digits$}"))).collect::<Vec<_>>(),
        CONTROL,
        html! {
            (band(friction, &places, &scale))
            @for idx in shown.clone() {
                @let (value, x) = (friction.values[idx], places.x(idx));
                line.bar x1=(x) x2=(x) y1=(scale.y(value - std(idx))) y2=(scale.y(value + std(idx))) {}
                circle.(class(alarm(idx))) cx=(x) cy=(scale.y(value)) r=(if alarm(idx).is_some() { 5 } else { 3 }) {
                    title { (idx + 1) ". " (name(idx)) ": " (number(value, friction.stds[idx])) " " (friction.unit) }
                }
            }
        },
        &ends_of(&places, shown.end),
    )
}

/// Three to eight round numbers within a range, and how many digits they have behind the point.
fn round_ticks(low: f64, high: f64) -> (Vec<f64>, usize) {
    let rough = (high - low) / 3.0;
    let power = rough.log10().floor();
    let step = [1.0, 2.0, 5.0].iter().rev().map(|digit| digit * 10f64.powf(power)).find(|step| *step <= rough);
    let step = step.unwrap_or(rough);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    ((first..=last).map(|k| k as f64 * step).collect(), (-power).clamp(0.0, 9.0) as usize)
}

/// From where to where the chart goes.
fn extent(friction: &Friction, shown: Range<usize>) -> [f64; 2] {
    let values = friction.values[shown.clone()].iter();
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
    let mut stds: Vec<f64> = shown.clone().filter_map(|idx| friction.stds[idx]).collect();
    let room = (AROUND * (high - low)).max(crate::recording::median(&mut stds));
    let band = friction.chart.points.last().and_then(|point| point.band);
    let ends = shown.flat_map(|idx| {
        let std = friction.stds[idx].unwrap_or(0.0);
        [friction.values[idx] - std, friction.values[idx] + std]
    });
    let ends = ends.chain(band.into_iter().flat_map(|(low, high)| [low, high]));
    ends.fold([low, high], |[from, to], end| [from.min(end).max(low - room), to.max(end).min(high + room)])
}

fn class(alarm: Option<&Alarm>) -> &'static str {
    match alarm.map(|alarm| alarm.kind) {
        None => "dot",
        Some(Kind::Single) => "dot off",
        Some(Kind::Rise | Kind::Fall) => "dot changed",
    }
}

/// The band as an area: along its upper edge there, along its lower one back; a new one after each change.
fn band(friction: &Friction, places: &Places, scale: &Scale) -> Markup {
    let mut areas = Vec::new();
    let mut begin = None;
    for idx in places.from..=friction.values.len() {
        let has_band = friction.chart.points.get(idx).is_some_and(|point| point.band.is_some());
        let is_new = friction.chart.alarms.iter().any(|alarm| alarm.at + 1 == idx && alarm.kind != Kind::Single);
        if let Some(from) = begin.take_if(|_| !has_band || is_new) {
            areas.push(from..idx);
        }
        if has_band {
            begin.get_or_insert(idx);
        }
    }
    let edge = |idx: usize, is_upper: bool| {
        let (low, high) = friction.chart.points[idx].band.unwrap_or_default();
        format!("{:.3},{}", places.percent(idx), scale.y(if is_upper { high } else { low }))
    };
    let outline = |area: &Range<usize>| {
        let there = area.clone().map(|idx| edge(idx, true));
        there.chain(area.clone().rev().map(|idx| edge(idx, false))).collect::<Vec<_>>().join(" ")
    };
    stretched(CONTROL, html! { @for area in &areas { polygon.band points=(outline(area)) {} } })
}

/// Both sums with their limits.
pub(super) fn sums(friction: &Friction) -> Markup {
    let chart = &friction.chart;
    let places = Places::of(chart.points.len());
    let shown = places.from..chart.points.len();
    let limits = [chart.limits.rising, -chart.limits.falling];
    let values = chart.points[shown.clone()].iter().flat_map(|point| [point.rising, -point.falling]);
    let scale = Scale::of(values.chain(limits), SUMS);
    let line = |of: &dyn Fn(usize) -> f64| {
        let point = |idx: usize| format!("{:.3},{}", places.percent(idx), scale.y(of(idx)));
        shown.clone().map(point).collect::<Vec<_>>().join(" ")
    };
    let ticks = [limits[0], 0.0, limits[1]].map(|value| (scale.y(value), format!("{value:+.1}")));
    plot(
        "cumulative sums, standard deviations",
        &ticks,
        SUMS,
        html! {
            line.zero x1="0" x2="100%" y1=(scale.y(0.0)) y2=(scale.y(0.0)) {}
            @for limit in limits { line.limit x1="0" x2="100%" y1=(scale.y(limit)) y2=(scale.y(limit)) {} }
            (stretched(SUMS, html! {
                polyline.sum points=(line(&|idx| chart.points[idx].rising)) {}
                polyline.sum points=(line(&|idx| -chart.points[idx].falling)) {}
            }))
            @for alarm in chart.alarms.iter().filter(|alarm| alarm.kind != Kind::Single && alarm.at >= places.from) {
                @let point = chart.points[alarm.at];
                @let height = if alarm.kind == Kind::Rise { point.rising } else { -point.falling };
                circle.dot.changed cx=(places.x(alarm.at)) cy=(scale.y(height)) r="5" {}
            }
        },
        &ends_of(&places, shown.end),
    )
}

/// The rigs' means, one line a rig.
pub(super) fn side_by_side(between: &Between) -> Markup {
    let std = |place: &Place| place.std_error.unwrap_or(0.0);
    let ends = between.rigs.iter().flat_map(|place| [place.mean - std(place), place.mean + std(place)]);
    // Percent from the right end.
    let scale = Scale::of(ends, 100.0);
    let x = |value: f64| format!("{:.2}%", 100.0 - scale.y(value));
    html! {
        div.rigs {
            @for place in &between.rigs {
                a href={ "#" (anchor(&place.rig)) } { (place.rig) }
                svg height="26" role="img" aria-label=(number(place.mean, place.std_error)) {
                    line.limit x1=(x(between.mean)) x2=(x(between.mean)) y1="0" y2="26" {}
                    line.bar x1=(x(place.mean - std(place))) x2=(x(place.mean + std(place))) y1="13" y2="13" {}
                    circle.(if place.stands_out { "dot changed" } else { "dot" }) cx=(x(place.mean)) cy="13" r="5" {}
                }
                span.value {
                    (number(place.mean, place.std_error)) " " (between.unit)
                    @if place.stands_out { strong.bad { " differs" } }
                }
            }
        }
    }
}

/// A drawing with its unit above, its numbers beside it and the swings below.
fn plot(label: &str, ticks: &[(f64, String)], height: f64, drawn: Markup, ends: &(usize, usize)) -> Markup {
    html! {
        div.plot {
            span.unit { (label) }
            div.ticks style={ "height:" (height) "px" } {
                @for (y, text) in ticks { span style={ "top:" (y) "px" } { (text) } }
            }
            svg height=(height) { (drawn) }
            span.from { "swing " (ends.0) }
            span.to { (ends.1) }
        }
    }
}

fn ends_of(places: &Places, end: usize) -> (usize, usize) {
    (places.from + 1, end)
}

/// What is stretched across while its lines keep their width.
fn stretched(height: f64, drawn: Markup) -> Markup {
    let view_box = format!("0 0 100 {height}");
    html! { svg.stretched viewBox=(view_box) height=(height) width="100%" preserveAspectRatio="none" { (drawn) } }
}

#[cfg(test)]
mod tests {
    use super::super::super::rig::tests::{rig, wearing};
    use super::*;

    /// After an alarm the band begins anew, with three swings and as wide as Student's distribution has it.
    #[test]
    fn neither_a_wide_band_nor_a_doubtful_swing_makes_the_others_a_flat_line() {
        let values = wearing();
        let mut stds = [1e-7; 40];
        stds[4] = 5e-3;
        let view = rig(&values, &stds);
        let [low, high] = extent(&view.friction[0], 0..40);
        let size = values[39] - values[2];
        assert!(low <= values[2] && high >= values[39] && high - low < 2.1 * size, "{low} … {high}");
    }

    #[test]
    fn beside_a_chart_stand_round_numbers() {
        let told = |low, high| {
            let (ticks, digits) = round_ticks(low, high);
            ticks.iter().map(|tick| format!("{tick:.digits$}")).collect::<Vec<_>>()
        };
        assert_eq!(told(4.3, 7.1), ["4.5", "5.0", "5.5", "6.0", "6.5", "7.0"]);
        assert_eq!(told(0.9979, 1.0041), ["0.998", "1.000", "1.002", "1.004"]);
        assert_eq!(told(-0.2, 12.0), ["0", "2", "4", "6", "8", "10", "12"]);
    }

    #[test]
    fn values_that_are_all_alike_are_drawn_with_their_usual_error_around_them() {
        let values = [7e-4; 6];
        let mut stds = [1e-6; 6];
        stds[3] = 1e-4;
        let [low, high] = extent(&rig(&values, &stds).friction[0], 0..6);
        assert!((low - 6.99e-4).abs() < 1e-9 && (high - 7.01e-4).abs() < 1e-9, "{low} … {high}");
    }
}
