//! Pictures for the browser, zoomable, by plotly.

use crate::plot::decimate::decimated;
use crate::plot::{Axis, Content, Curve, Heat, Picture, Style, colour, diverging};
use crate::shorten::shortened;
use plotly::common::{
    ColorBar, ColorScale, ColorScaleElement, DashType, ErrorData, ErrorType, Font, Line, Marker, Mode, Title,
};
use plotly::layout::{Axis as WebAxis, AxisType, Margin};
use plotly::{HeatMap, Layout, Plot, Scatter, Trace};

/// Points of a line at most; more than any screen shows at once.
const MOST_POINTS: usize = 4000;

/// Digits of coordinates; more would only fill the file.
const DIGITS: i32 = 6;

/// A longer name in the legend would leave no room for the curves.
const LONGEST_NAME: usize = 32;

/// Height of a picture, pixels.
const HEIGHT: usize = 440;

/// The script that draws; once a page.
pub fn script() -> String {
    // The library brings a typesetter for formulas along, which is not used here: its script comes second.
    let both = Plot::offline_js_sources();
    both.split_inclusive("</script>").next().unwrap_or_default().to_owned()
}

/// The same without the element around it, to be served as a file.
pub fn script_text() -> String {
    let element = script();
    let inner = element.split_once('>').map_or("", |(_, rest)| rest);
    inner.strip_suffix("</script>").unwrap_or(inner).to_owned()
}

/// The element of a picture.
pub fn html(picture: &Picture) -> String {
    let mut plot = Plot::new();
    plot.set_configuration(plotly::Configuration::new().responsive(true).display_logo(false));
    let mut layout = Layout::new()
        .height(HEIGHT)
        .margin(Margin::new().left(80).right(20).top(20).bottom(60))
        .font(Font::new().size(13))
        .plot_background_color("#ffffff")
        .x_axis(axis(&picture.x))
        .y_axis(axis(&picture.y));
    match &picture.content {
        Content::Curves(curves) => curves.iter().for_each(|curve| plot.add_trace(scatter(curve))),
        Content::Heat(heat) => plot.add_trace(heat_map(heat)),
    }
    if matches!(&picture.content, Content::Heat(heat) if heat.names.is_some()) {
        layout = layout.x_axis(WebAxis::new()).y_axis(WebAxis::new());
    }
    plot.set_layout(layout);
    plot.to_inline_html(Some(&picture.key))
}

fn axis(axis: &Axis) -> WebAxis {
    let kind = if axis.is_logarithmic { AxisType::Log } else { AxisType::Linear };
    let whole = if axis.is_count { WebAxis::new().dtick(1.0) } else { WebAxis::new() };
    let places = (0..axis.names.len()).map(|k| k as f64).collect();
    let named = if axis.names.is_empty() {
        whole
    } else {
        whole
            .tick_values(places)
            .tick_text(axis.names.iter().map(|name| shortened(name, LONGEST_NAME)).collect::<Vec<_>>())
    };
    named
        .title(Title::with_text(&axis.label))
        .type_(kind)
        .show_grid(true)
        .grid_color("#e1e1e1")
        .zero_line_color("#b0b0b0")
        .auto_margin(true)
}

fn rounded(values: &[f64]) -> Vec<f64> {
    let round = |value: &f64| {
        if *value == 0.0 || !value.is_finite() {
            return 0.0;
        }
        let factor = 10f64.powi(DIGITS - 1 - value.abs().log10().floor() as i32);
        (value * factor).round() / factor
    };
    values.iter().map(round).collect()
}

fn scatter(curve: &Curve) -> Box<dyn Trace> {
    let (x, y) = match curve.style {
        Style::Line | Style::Dashed => decimated(&curve.x, &curve.y, MOST_POINTS),
        Style::Dots | Style::Cloud => (curve.x.clone(), curve.y.clone()),
    };
    let (red, green, blue) = colour(curve.colour);
    let paint = format!("rgb({red},{green},{blue})");
    let trace = Scatter::new(rounded(&x), rounded(&y))
        .name(shortened(&curve.name, LONGEST_NAME))
        .show_legend(!curve.name.is_empty());
    let line = Line::new().color(paint.clone()).width(1.5);
    let trace = match curve.style {
        Style::Line => trace.mode(Mode::Lines).line(line),
        Style::Dashed => trace.mode(Mode::Lines).line(line.dash(DashType::Dash)),
        Style::Dots => trace.mode(Mode::Markers).marker(Marker::new().size(7).color(paint)),
        Style::Cloud => trace.mode(Mode::Markers).marker(Marker::new().size(3).opacity(0.4).color(paint)),
    };
    match &curve.bars {
        Some(bars) => trace.error_y(ErrorData::new(ErrorType::Data).array(rounded(bars))),
        None => trace,
    }
}

fn heat_map(heat: &Heat) -> Box<dyn Trace> {
    let stop = |k: i32| {
        let share = f64::from(k) / 10.0;
        let (red, green, blue) = diverging(2.0 * share - 1.0);
        ColorScaleElement(share, format!("rgb({red},{green},{blue})"))
    };
    let scale = ColorScale::Vector((0..=10).map(stop).collect());
    let bar = ColorBar::new().title(heat.label.as_str());
    match &heat.names {
        Some(names) => HeatMap::new(names.clone(), names.clone(), heat.values.clone())
            .zmin(-heat.limit)
            .zmax(heat.limit)
            .color_scale(scale)
            .color_bar(bar)
            .text_matrix(heat.notes.clone()),
        None => {
            let trace: Box<dyn Trace> = HeatMap::new(rounded(&heat.x), rounded(&heat.y), heat.values.clone())
                .zmin(-heat.limit)
                .zmax(heat.limit)
                .color_scale(scale)
                .color_bar(bar)
                .text_matrix(heat.notes.clone());
            trace
        }
    }
}
