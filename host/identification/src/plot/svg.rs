//! Pictures as SVG.

use super::{Axis, Content, Curve, Heat, Picture, Style, colour, diverging};
use crate::shorten::shortened;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use std::ops::Range;

/// Size in pixels.
const SIZE: (u32, u32) = (860, 480);

/// A drawing that failed: cannot happen on a string, but the library says it may.
type Failed = Box<dyn std::error::Error>;

const FONT: &str = "sans-serif";

/// A longer name would cover the curves.
const LONGEST_NAME: usize = 40;

/// Draws a picture; an empty one stays empty.
pub fn svg(picture: &Picture) -> String {
    let mut text = String::new();
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        // Drawing on a string has no way to fail.
        let _ = draw(&area, picture).and_then(|()| area.present().map_err(Failed::from));
    }
    text
}

fn draw(area: &DrawingArea<SVGBackend, Shift>, picture: &Picture) -> Result<(), Failed> {
    area.fill(&WHITE)?;
    let area = area.titled(&picture.title, (FONT, 20).into_font())?;
    match &picture.content {
        Content::Curves(curves) => draw_curves(&area, picture, curves),
        Content::Heat(heat) => draw_heat(&area, picture, heat),
    }
}

/// The range of all values with some room, in the axis' own measure.
fn range<'a>(axis: &Axis, values: impl Iterator<Item = &'a f64>) -> Range<f64> {
    let measured = values.map(|value| measure(axis, *value)).filter(|value| value.is_finite());
    let (low, high) = measured.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return 0.0..1.0;
    }
    let room = (0.05 * (high - low)).max(1e-9 * high.abs()).max(1e-12);
    low - room..high + room
}

/// Logarithmic axes are drawn as linear ones of the logarithm.
fn measure(axis: &Axis, value: f64) -> f64 {
    if axis.is_logarithmic { value.max(1e-300).log10() } else { value }
}

fn draw_curves<'a>(
    area: &DrawingArea<SVGBackend<'a>, Shift>,
    picture: &Picture,
    curves: &[Curve],
) -> Result<(), Failed> {
    let x_range = range(&picture.x, curves.iter().flat_map(|curve| &curve.x));
    let ends: Vec<f64> = curves.iter().flat_map(with_usual_bars).collect();
    let y_range = range(&picture.y, ends.iter());
    let legend = Legend::of(curves);
    let (corner, y_range) = legend.placed(picture, curves, &x_range, y_range);
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(74)
        .build_cartesian_2d(ticked(&picture.x, &x_range), ticked(&picture.y, &y_range))?;
    let (x_size, y_size) = (x_range.end - x_range.start, y_range.end - y_range.start);
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(&picture.x.label)
        .y_desc(&picture.y.label)
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .x_label_formatter(&|value| label(&picture.x, *value, x_size))
        .y_label_formatter(&|value| label(&picture.y, *value, y_size))
        .draw()?;
    for curve in curves {
        let (red, green, blue) = colour(curve.colour);
        let paint = RGBColor(red, green, blue);
        let point = |(x, y): (&f64, &f64)| (measure(&picture.x, *x), measure(&picture.y, *y));
        let points: Vec<(f64, f64)> = curve.x.iter().zip(&curve.y).map(point).collect();
        let annotated = match curve.style {
            Style::Line => chart.draw_series(LineSeries::new(points, paint.stroke_width(2)))?,
            Style::Dashed => chart.draw_series(DashedLineSeries::new(points, 6, 4, paint.stroke_width(1)))?,
            Style::Dots => chart.draw_series(points.into_iter().map(|point| Circle::new(point, 3, paint.filled())))?,
            Style::Cloud => {
                chart.draw_series(points.into_iter().map(|point| Circle::new(point, 1, paint.mix(0.35).filled())))?
            }
        };
        if !curve.name.is_empty() {
            let style = curve.style;
            annotated.label(shortened(&curve.name, LONGEST_NAME)).legend(move |(x, y)| legend_mark(x, y, paint, style));
        }
        if let Some(bars) = &curve.bars {
            let bar = |((x, y), bar): ((&f64, &f64), &f64)| {
                let clip = |value: f64| measure(&picture.y, value).clamp(y_range.start, y_range.end);
                let x = measure(&picture.x, *x);
                PathElement::new(vec![(x, clip(y - bar)), (x, clip(y + bar))], paint.stroke_width(1))
            };
            chart.draw_series(curve.x.iter().zip(&curve.y).zip(bars).map(bar))?;
        }
    }
    if curves.iter().any(|curve| !curve.name.is_empty()) {
        chart
            .configure_series_labels()
            .position(corner)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font((FONT, 13))
            .draw()?;
    }
    Ok(())
}

/// A curve's values with error bars of middle length to either side; much longer ones may leave the picture.
fn with_usual_bars(curve: &Curve) -> Vec<f64> {
    let mut bars = curve.bars.clone().unwrap_or_default();
    bars.sort_by(f64::total_cmp);
    let bar = bars.get(bars.len() / 2).copied().unwrap_or(0.0);
    curve.y.iter().flat_map(|y| [y - bar, y + bar]).collect()
}

/// What a curve is drawn with, beside its name.
fn legend_mark<'a>(x: i32, y: i32, paint: RGBColor, style: Style) -> DynElement<'static, SVGBackend<'a>, (i32, i32)> {
    let ends = [(x, y), (x + 18, y)];
    match style {
        Style::Dots | Style::Cloud => Circle::new((x + 9, y), 3, paint.filled()).into_dyn(),
        Style::Line => PathElement::new(ends, paint.stroke_width(2)).into_dyn(),
        Style::Dashed => DashedPathElement::new(ends, 6, 4, paint.stroke_width(1)).into_dyn(),
    }
}

/// Beside an axis stand at most so many numbers.
const MOST_TICKS: usize = 11;

/// A range with the places of its numbers: round ones on a logarithmic axis, too.
struct Ticked {
    inner: RangedCoordf64,
    ticks: Vec<f64>,
}

fn ticked(axis: &Axis, range: &Range<f64>) -> Ticked {
    let inner = RangedCoordf64::from(range.clone());
    let ticks = if axis.is_logarithmic { round_logarithms(range) } else { inner.key_points(MOST_TICKS) };
    Ticked { inner, ticks }
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.inner.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.inner.range()
    }
}

/// Logarithms of 1, 2, 5, 10 …; over many decades of every power of ten, or of some.
fn round_logarithms(range: &Range<f64>) -> Vec<f64> {
    let decades = range.start.floor() as i32..=range.end.ceil() as i32;
    let of = |digits: &'static [f64], step: usize| {
        let first = decades.start() - decades.start().rem_euclid(step as i32);
        let powers = (first..=*decades.end()).step_by(step);
        let all = powers.flat_map(|power| digits.iter().map(move |digit| f64::from(power) + digit.log10()));
        all.filter(|value| range.contains(value)).collect::<Vec<f64>>()
    };
    let all = [of(&[1.0, 2.0, 5.0], 1), of(&[1.0], 1), of(&[1.0], 2), of(&[1.0], 5), of(&[1.0], 50)];
    let fit = all.into_iter().find(|ticks| ticks.len() <= MOST_TICKS).unwrap_or_default();
    if fit.len() > 1 {
        return fit;
    }
    // In less than an octave there may be none of these: then other round numbers do.
    let values = 10f64.powf(range.start)..10f64.powf(range.end);
    RangedCoordf64::from(values).key_points(MOST_TICKS).into_iter().map(f64::log10).collect()
}

/// A number beside an axis, with as many digits as its range needs.
fn label(axis: &Axis, value: f64, size: f64) -> String {
    if !axis.names.is_empty() {
        let is_whole = (value - value.round()).abs() < 1e-6 && value > -0.5;
        let name = axis.names.get(value.round() as usize).filter(|_| is_whole);
        return name.map_or(String::new(), |name| shortened(name, LONGEST_NAME));
    }
    if axis.is_logarithmic {
        return logarithmic_label(10f64.powf(value), size);
    }
    if axis.is_count {
        return if value.fract().abs() < 1e-6 { format!("{value:.0}") } else { String::new() };
    }
    let digits = (1.3 - size.max(1e-12).log10()).ceil().clamp(0.0, 9.0) as usize;
    let value = if value.abs() < 1e-9 * size { 0.0 } else { value };
    if size < 1e-4 { format!("{value:.1e}") } else { format!("{value:.digits$}") }
}

/// Two digits are enough beside a logarithmic axis, unless it spans next to nothing.
fn logarithmic_label(value: f64, decades: f64) -> String {
    let more = if decades < 0.3 { 2 } else { 0 };
    let digits = (1 + more - value.log10().floor() as i32).max(0) as usize;
    if !(0.01..10_000.0).contains(&value) {
        return format!("{value:.0e}");
    }
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// How much of the chart the legend takes, as shares.
struct Legend {
    width: f64,
    height: f64,
}

/// A letter of a name, a line of the legend and what stands around them, pixels; about.
const LETTER: f64 = 7.0;
const LINE: f64 = 18.0;
const AROUND: (f64, f64) = (60.0, 24.0);

/// What axes and title leave of the picture, pixels.
const CHART: (f64, f64) = (760.0, 380.0);

/// A line hides under the legend between its points too: so many places of each piece are looked at.
const PLACES: usize = 20;

impl Legend {
    fn of(curves: &[Curve]) -> Self {
        let names = || curves.iter().filter(|curve| !curve.name.is_empty());
        let n_letters = names().map(|curve| curve.name.chars().count().min(LONGEST_NAME)).max().unwrap_or(0);
        let width = (LETTER * n_letters as f64 + AROUND.0) / CHART.0;
        let height = (LINE * names().count() as f64 + AROUND.1) / CHART.1;
        Self { width, height: height.min(0.5) }
    }

    /// The corner in which it hides least; where it would hide a line in each, room for it is made above all of them.
    fn placed(
        &self,
        picture: &Picture,
        curves: &[Curve],
        x: &Range<f64>,
        y: Range<f64>,
    ) -> (SeriesLabelPosition, Range<f64>) {
        let (lines, clouds): (Vec<&Curve>, Vec<&Curve>) = curves.iter().partition(|curve| curve.style != Style::Cloud);
        let [lines, clouds] = [lines, clouds].map(|curves| self.hidden(picture, &curves, x, &y));
        let best = (0..4).min_by_key(|corner| (lines[*corner], clouds[*corner])).unwrap_or(0);
        if lines[best] > 0 {
            let end = y.start + (y.end - y.start) / (1.0 - self.height);
            return (SeriesLabelPosition::UpperRight, y.start..end);
        }
        let corners = [
            SeriesLabelPosition::UpperRight,
            SeriesLabelPosition::UpperLeft,
            SeriesLabelPosition::LowerLeft,
            SeriesLabelPosition::LowerRight,
        ];
        (corners.into_iter().nth(best).unwrap_or(SeriesLabelPosition::UpperRight), y)
    }

    /// Places of curves that it would hide in each corner: right above, left above, left below, right below.
    fn hidden(&self, picture: &Picture, curves: &[&Curve], x: &Range<f64>, y: &Range<f64>) -> [usize; 4] {
        let share = |value: f64, range: &Range<f64>| (value - range.start) / (range.end - range.start);
        let mut counts = [0; 4];
        for (px, py) in curves.iter().flat_map(|curve| places(picture, curve)) {
            let (right, up) = (share(px, x), share(py, y));
            let (is_left, is_right) = (right < self.width, right > 1.0 - self.width);
            let (is_low, is_high) = (up < self.height, up > 1.0 - self.height);
            let under = [is_right && is_high, is_left && is_high, is_left && is_low, is_right && is_low];
            counts.iter_mut().zip(under).for_each(|(count, under)| *count += usize::from(under));
        }
        counts
    }
}

/// The points of a curve, and of a line those between them.
fn places(picture: &Picture, curve: &Curve) -> Vec<(f64, f64)> {
    let point = |(x, y): (&f64, &f64)| (measure(&picture.x, *x), measure(&picture.y, *y));
    let points: Vec<(f64, f64)> = curve.x.iter().zip(&curve.y).map(point).collect();
    if !matches!(curve.style, Style::Line | Style::Dashed) || points.len() > 50 * PLACES {
        return points;
    }
    let between = |pair: &[(f64, f64)]| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        (0..=PLACES)
            .map(move |k| k as f64 / PLACES as f64)
            .map(move |share| (x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
    };
    points.windows(2).flat_map(between).collect()
}

fn draw_heat(area: &DrawingArea<SVGBackend, Shift>, picture: &Picture, heat: &Heat) -> Result<(), Failed> {
    let (area, scale) = area.split_horizontally(SIZE.0 - 120);
    let edges = |middles: &[f64]| {
        let half = if middles.len() > 1 { 0.5 * (middles[1] - middles[0]) } else { 0.5 };
        (middles.first().map_or(0.0, |first| first - half), middles.last().map_or(1.0, |last| last + half), half)
    };
    let ((x0, x1, x_half), (y0, y1, y_half)) = (edges(&heat.x), edges(&heat.y));
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .x_label_area_size(46)
        .y_label_area_size(74)
        .build_cartesian_2d(x0..x1, y0..y1)?;
    let name = |value: &f64, size: f64| match &heat.names {
        Some(names) => {
            names.get(value.round() as usize).filter(|_| value.fract().abs() < 1e-6).cloned().unwrap_or_default()
        }
        None => label(&picture.x, *value, size),
    };
    let (x_size, y_size) = (x1 - x0, y1 - y0);
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(&picture.x.label)
        .y_desc(&picture.y.label)
        .axis_desc_style((FONT, 15))
        .label_style((FONT, 13))
        .x_label_formatter(&|value| name(value, x_size))
        .y_label_formatter(&|value| name(value, y_size))
        .draw()?;
    let cells = heat.values.iter().zip(&heat.y).flat_map(|(row, y)| {
        row.iter().zip(&heat.x).filter_map(move |(value, x)| {
            let (red, green, blue) = diverging((*value)? / heat.limit);
            let corners = [(x - x_half, y - y_half), (x + x_half, y + y_half)];
            Some(Rectangle::new(corners, RGBColor(red, green, blue).filled()))
        })
    });
    chart.draw_series(cells)?;
    draw_scale(&scale, heat)
}

/// The bar that tells which colour means what.
fn draw_scale(area: &DrawingArea<SVGBackend, Shift>, heat: &Heat) -> Result<(), Failed> {
    let mut chart = ChartBuilder::on(area)
        .margin_top(12)
        .margin_bottom(58)
        .margin_right(10)
        .y_label_area_size(66)
        .build_cartesian_2d(0.0..1.0, -heat.limit..heat.limit)?;
    let size = 2.0 * heat.limit;
    chart
        .configure_mesh()
        .disable_mesh()
        .disable_x_axis()
        .y_desc(&heat.label)
        .axis_desc_style((FONT, 13))
        .label_style((FONT, 12))
        .y_label_formatter(&|value| label(&Axis::linear(""), *value, size))
        .draw()?;
    const STEPS: usize = 64;
    let step = |k: usize| {
        let from = heat.limit * (2.0 * k as f64 / STEPS as f64 - 1.0);
        let to = from + 2.0 * heat.limit / STEPS as f64;
        let (red, green, blue) = diverging(0.5 * (from + to) / heat.limit);
        Rectangle::new([(0.0, from), (1.0, to)], RGBColor(red, green, blue).filled())
    };
    chart.draw_series((0..STEPS).map(step))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(curves: Vec<Curve>) -> Picture {
        Picture {
            key: "test".to_owned(),
            title: "Test".to_owned(),
            explanation: String::new(),
            x: Axis::linear("x"),
            y: Axis::linear("energy lost per path in mJ/rad = mN·m"),
            content: Content::Curves(curves),
        }
    }

    /// Points at both ends, and a line through the corner between them.
    #[test]
    fn the_legend_hides_no_line() {
        let square = |low: f64, high: f64| [(0.0, low), (0.0, high), (1.0, high), (1.0, low), (0.0, low)];
        let frame = vec![Curve::new("noise of the measurement", Style::Line, 0, square(0.0, 1.0))];
        let legend = Legend::of(&frame);
        let (_, y) = legend.placed(&picture(frame.clone()), &frame, &(0.0..1.0), 0.0..1.0);
        assert!(y.end * (1.0 - legend.height) > 0.999, "{y:?}");
        let falling = vec![Curve::new("noise of the measurement", Style::Line, 0, [(0.0, 1.0), (1.0, 0.0)])];
        let (corner, y) = legend.placed(&picture(falling.clone()), &falling, &(0.0..1.0), 0.0..1.0);
        assert!(matches!(corner, SeriesLabelPosition::UpperRight) && y == (0.0..1.0), "{corner:?} {y:?}");
    }

    #[test]
    fn a_logarithmic_axis_has_round_numbers() {
        let told = |from: f64, to: f64| {
            let range = from.log10()..to.log10();
            round_logarithms(&range).iter().map(|tick| logarithmic_label(10f64.powf(*tick), 3.0)).collect::<Vec<_>>()
        };
        assert_eq!(told(0.9, 110.0), ["1", "2", "5", "10", "20", "50", "100"]);
        assert_eq!(told(0.05, 5e4), ["0.1", "1", "10", "100", "1000", "1e4"]);
        assert_eq!(told(1e-12, 1.0e8).len(), 10);
        let narrow = round_logarithms(&(1.001_f64.log10()..1.033_f64.log10()));
        let narrow: Vec<String> = narrow.iter().map(|tick| logarithmic_label(10f64.powf(*tick), 0.01)).collect();
        assert!(narrow.contains(&"1.01".to_owned()) && narrow.contains(&"1.02".to_owned()), "{narrow:?}");
    }

    #[test]
    fn a_broken_line_is_broken_in_the_legend_too() {
        let ends = [(0.0, 1.0), (1.0, 2.0)];
        let marks = |style: Style| {
            let drawn = svg(&picture(vec![Curve::new("a", style, 0, ends)]));
            drawn.matches("stroke=\"#0072B2\"").count()
        };
        let unnamed = svg(&picture(vec![Curve::new("", Style::Dashed, 0, ends)])).matches("stroke=\"#0072B2\"").count();
        assert_eq!(marks(Style::Line), 2);
        assert_eq!(marks(Style::Dashed), unnamed + 2);
    }

    #[test]
    fn torques_of_an_unknown_geometry_have_no_newtons() {
        let drawn = svg(&picture(vec![Curve::new("a", Style::Line, 0, [(0.0, 1.0), (1.0, 2.0)])]).per_gravity());
        assert!(drawn.contains("energy lost per path in 10⁻³ m·g·l") && !drawn.contains("mN·m"), "{drawn}");
    }
}
