//! Measured swings with the model's laid over them, and what is left between the two beneath, against the noise.
//!
//! In: series in SI units. Out: the text of an SVG of a few hundred kilobytes at most: a long series is thinned to a few
//! points a pixel, always with the extremes, so that no peak is lost.

use crate::recording::Measured;
use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use std::ops::Range;

/// A swing with its model.
#[derive(Clone, Debug)]
pub struct Row {
    /// What stands above it.
    pub title: String,
    /// Rising times, s.
    pub times_s: Vec<f64>,
    /// Measured angle, rad.
    pub measured_rad: Vec<f64>,
    /// The model's angle at the same times, rad.
    pub model_rad: Vec<f64>,
    /// Rms noise of the measurement, rad; the band shows twice as much to either side.
    pub noise_rad: f64,
    /// What was measured.
    pub measured: Measured,
}

/// The whole drawing.
#[derive(Clone, Debug)]
pub struct Overlay {
    /// One line over everything.
    pub title: String,
    /// The numbers, one line below.
    pub subtitle: String,
    /// One row a swing, at least one.
    pub rows: Vec<Row>,
}

/// The SVG back end rounds to whole units, so it draws larger than it says.
const FINE: i32 = 4;

const WIDTH: i32 = 1000;
const HEAD: i32 = 78;
const ROW_HEIGHT: i32 = 490;
/// Part of a row that the angles have.
const ANGLE_HEIGHT: i32 = 270;
/// A row's own title.
const ROW_HEAD: i32 = 24;
/// Room for axis labels, left.
const LEFT: i32 = 62;
/// Between a row and the next.
const GAP: i32 = 22;

/// Labels on an axis, about.
const X_LABELS: usize = 10;
const Y_LABELS: usize = 5;

/// Thinned series have at most two points in each of so many intervals.
const MOST_INTERVALS: usize = 1000;
/// All series of a drawing together; three a row.
const ALL_INTERVALS: usize = 15_000;

const MEASURED: RGBColor = RGBColor(143, 184, 222);
const MODEL: RGBColor = RGBColor(196, 78, 0);
const RESIDUAL: RGBColor = RGBColor(60, 60, 70);
const BAND: RGBColor = RGBColor(226, 226, 230);
const GRID: RGBColor = RGBColor(232, 232, 236);
const INK: RGBColor = RGBColor(40, 40, 46);

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

impl Overlay {
    /// The drawing as the text of an SVG file.
    pub fn svg(&self) -> String {
        let (width, height) = (WIDTH, HEAD + ROW_HEIGHT * self.rows.len() as i32);
        let mut text = String::new();
        {
            let size = ((width * FINE) as u32, (height * FINE) as u32);
            let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
            self.draw(&root).expect("drawing into memory cannot fail");
        }
        let drawn = format!("width=\"{}\" height=\"{}\" viewBox", width * FINE, height * FINE);
        text.replacen(&drawn, &format!("width=\"{width}\" height=\"{height}\" viewBox"), 1)
    }

    fn draw(&self, root: &Area) -> Drawn {
        root.fill(&WHITE)?;
        write(root, &self.title, 18, (16, 10))?;
        write(root, &self.subtitle, 13, (16, 34))?;
        legend(root)?;
        let (_, body) = root.split_vertically(HEAD * FINE);
        let n_intervals = MOST_INTERVALS.min(ALL_INTERVALS / (3 * self.rows.len().max(1)));
        for (row, area) in self.rows.iter().zip(body.split_evenly((self.rows.len(), 1))) {
            row.draw(&area, n_intervals)?;
        }
        root.present()
    }
}

impl Row {
    fn draw(&self, area: &Area, n_intervals: usize) -> Drawn {
        write(area, &self.title, 14, (16, 4))?;
        let (_, charts) = area.split_vertically(ROW_HEAD * FINE);
        let (angles, residuals) = charts.margin(0, GAP * FINE, 0, 0).split_vertically(ANGLE_HEIGHT * FINE);
        self.draw_angles(&angles, n_intervals)?;
        self.draw_residuals(&residuals, n_intervals)
    }

    fn draw_angles(&self, area: &Area, n_intervals: usize) -> Drawn {
        let reach = largest(self.measured_rad.iter().chain(&self.model_rad)) * 1.08;
        let mut chart = chart(area, self.times(), reach, 12)?;
        axes(&mut chart, &format!("{} ({})", self.measured.name(), self.measured.unit()), "")?;
        for (angles_rad, colour, width) in [(&self.measured_rad, MEASURED, 3), (&self.model_rad, MODEL, 1)] {
            let points = thinned(&self.times_s, angles_rad, n_intervals);
            chart.draw_series(LineSeries::new(points, colour.stroke_width((width * FINE) as u32)))?;
        }
        Ok(())
    }

    fn draw_residuals(&self, area: &Area, n_intervals: usize) -> Drawn {
        let left_mrad: Vec<f64> = self.measured_rad.iter().zip(&self.model_rad).map(|(m, s)| 1e3 * (m - s)).collect();
        let band_mrad = 2e3 * self.noise_rad;
        let reach = (largest(&left_mrad) * 1.08).max(1.3 * band_mrad);
        let times = self.times();
        let mut chart = chart(area, times.clone(), reach, 40)?;
        let corners = [(times.start, -band_mrad), (times.end, band_mrad)];
        chart.draw_series([Rectangle::new(corners, BAND.filled())])?;
        axes(&mut chart, &format!("left over ({})", self.measured.milli_unit()), "time (s)")?;
        let points = thinned(&self.times_s, &left_mrad, n_intervals);
        chart.draw_series(LineSeries::new(points, RESIDUAL.stroke_width(FINE as u32 / 2)))?;
        Ok(())
    }

    fn times(&self) -> Range<f64> {
        let first = self.times_s.first().copied().unwrap_or(0.0);
        first..self.times_s.last().copied().unwrap_or(0.0).max(first + 1e-3)
    }
}

/// An axis from 0 up or around 0.
type Axes = Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>;

fn chart<'a, 'b>(
    area: &'a Area<'b>,
    times: Range<f64>,
    reach: f64,
    bottom: i32,
) -> Result<ChartContext<'a, SVGBackend<'b>, Axes>, DrawingAreaErrorKind<std::io::Error>> {
    let reach = if reach > 0.0 && reach.is_finite() { reach } else { 1.0 };
    ChartBuilder::on(area)
        .margin_left(16 * FINE)
        .margin_right(22 * FINE)
        .margin_top(6 * FINE)
        .set_label_area_size(LabelAreaPosition::Left, LEFT * FINE)
        .set_label_area_size(LabelAreaPosition::Bottom, bottom * FINE)
        .build_cartesian_2d(times, -reach..reach)
}

fn axes(chart: &mut ChartContext<SVGBackend, Axes>, y: &str, x: &str) -> Drawn {
    let font = ("sans-serif", 12 * FINE).into_font().color(&INK);
    let y_digits = digits_of(chart.as_coord_spec().y_spec(), Y_LABELS);
    let x_digits = digits_of(chart.as_coord_spec().x_spec(), X_LABELS);
    let y_number = |value: &f64| labelled(*value, y_digits);
    let x_number = |value: &f64| labelled(*value, x_digits);
    let no_number = |_: &f64| String::new();
    let mut mesh = chart.configure_mesh();
    mesh.bold_line_style(GRID.stroke_width(FINE as u32 / 2))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(FINE as u32 / 2))
        .set_all_tick_mark_size(4 * FINE)
        .label_style(font.clone())
        .axis_desc_style(font)
        .x_labels(X_LABELS)
        .y_labels(Y_LABELS)
        .y_label_formatter(&y_number)
        .x_label_formatter(if x.is_empty() { &no_number } else { &x_number })
        .y_desc(y)
        .x_desc(x);
    mesh.draw()
}

/// Decimals that tell neighbouring labels apart.
fn digits_of(axis: &impl Ranged<ValueType = f64>, n_labels: usize) -> usize {
    let points = axis.key_points(n_labels);
    let step = points.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    if step.is_finite() && step > 0.0 { (-(step * (1.0 + 1e-9)).log10().floor()).clamp(0.0, 6.0) as usize } else { 1 }
}

/// A number of an axis; adding zero takes the sign from a zero.
fn labelled(value: f64, digits: usize) -> String {
    format!("{:.digits$}", value + 0.0)
}

fn write(area: &Area, text: &str, size: i32, (x, y): (i32, i32)) -> Drawn {
    let style = ("sans-serif", size * FINE).into_font().color(&INK);
    area.draw_text(text, &style, (x * FINE, y * FINE))
}

fn legend(root: &Area) -> Drawn {
    let y = 62;
    for (x, colour, width, text) in
        [(16, MEASURED, 3, "measured"), (122, MODEL, 1, "model"), (210, RESIDUAL, 1, "left over: measured − model")]
    {
        let line = vec![(x * FINE, y * FINE), ((x + 24) * FINE, y * FINE)];
        root.draw(&PathElement::new(line, colour.stroke_width((width * FINE) as u32)))?;
        write(root, text, 12, (x + 30, y - 8))?;
    }
    let (x, half) = (430, 5);
    let corners = [(x * FINE, (y - half) * FINE), ((x + 24) * FINE, (y + half) * FINE)];
    root.draw(&Rectangle::new(corners, BAND.filled()))?;
    write(root, "noise, ±2 rms", 12, (x + 30, y - 8))
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().map(|value| value.abs()).filter(|value| value.is_finite()).fold(0.0, f64::max)
}

/// At most two points an interval, its lowest and its highest, in the order in which they come.
fn thinned(times_s: &[f64], values: &[f64], n_intervals: usize) -> Vec<(f64, f64)> {
    let n_points = times_s.len().min(values.len());
    let every = n_points.div_ceil(n_intervals.max(1)).max(1);
    let point = |i: usize| (times_s[i], values[i]);
    if every <= 2 {
        return (0..n_points).map(point).collect();
    }
    let extremes = |from: usize| {
        let interval = from..(from + every).min(n_points);
        let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        let lowest = interval.clone().min_by(by_value).unwrap_or(from);
        let highest = interval.max_by(by_value).unwrap_or(from);
        let pair = [lowest.min(highest), lowest.max(highest)];
        pair.into_iter().take(if lowest == highest { 1 } else { 2 })
    };
    (0..n_points).step_by(every).flat_map(extremes).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overlay(n_rows: usize, n_samples: usize) -> Overlay {
        let times_s: Vec<f64> = (0..n_samples).map(|i| i as f64 * 1e-3).collect();
        let model_rad: Vec<f64> = times_s.iter().map(|t| (7.6 * t).cos() * (-0.05 * t).exp()).collect();
        let measured_rad = model_rad.iter().enumerate().map(|(i, x)| x + 1e-3 * (1.7 * i as f64).sin()).collect();
        let row = Row {
            title: "a & <b>".into(),
            times_s,
            measured_rad,
            model_rad,
            noise_rad: 7e-4,
            measured: Measured::Angle,
        };
        Overlay { title: "t".into(), subtitle: "s".into(), rows: vec![row; n_rows] }
    }

    #[test]
    fn long_recordings_make_small_files() {
        for n_rows in [1, 3, 12] {
            let svg = overlay(n_rows, 50_000).svg();
            assert!(svg.len() < 500_000, "{n_rows} rows: {} bytes", svg.len());
            assert!(svg.contains("width=\"1000\"") && svg.trim_end().ends_with("</svg>"));
            assert!(svg.contains("a &amp; &lt;b&gt;"));
        }
    }

    #[test]
    fn thinning_keeps_the_extremes_and_the_order() {
        let times_s: Vec<f64> = (0..10_000).map(f64::from).collect();
        let mut values = vec![0.0; 10_000];
        (values[4321], values[8765]) = (5.0, -3.0);
        let points = thinned(&times_s, &values, 100);
        assert!(points.len() <= 200 && points.contains(&(4321.0, 5.0)) && points.contains(&(8765.0, -3.0)));
        assert!(points.windows(2).all(|pair| pair[0].0 < pair[1].0));
        assert_eq!(thinned(&times_s[..5], &values[..5], 100).len(), 5);
    }

    #[test]
    fn swings_without_motion_or_noise_can_be_drawn() {
        let still = Row {
            title: String::new(),
            times_s: vec![0.0],
            measured_rad: vec![0.0],
            model_rad: vec![0.0],
            noise_rad: 0.0,
            measured: Measured::Angle,
        };
        let svg = Overlay { title: String::new(), subtitle: String::new(), rows: vec![still] }.svg();
        assert!(!svg.contains("NaN"));
    }
}
