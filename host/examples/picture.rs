//! Draws the README's picture: `cargo run --release -p host --example picture` writes docs/picture.svg.
//!
//! Left: the paper's swing and the identified model. Right: how the error falls from design to design, each judged over
//! the whole swing. Everything is computed anew from the recording.

use host::fit::identify::{Fit, Method, Options, fit, problem_of};
use host::fit::problem::Point;
use host::recording::segment::SegmentOptions;
use host::recording::{ReadOptions, read};
use host::swing::{Swing, Window};
use plotters::prelude::*;
use shared::parameters::Parameters;
use std::error::Error;
use std::path::Path;
use std::sync::atomic::AtomicUsize;

const SIZE_PX: (u32, u32) = (900, 330);
const LEFT_PX: u32 = 540;
const FONT: (&str, u32) = ("sans-serif", 14);
const TITLE: (&str, u32) = ("sans-serif", 16);

/// Pale enough to lie behind the model.
const MEASURED: RGBColor = RGBColor(250, 176, 90);
const MODEL: RGBColor = RGBColor(24, 78, 140);

/// Every so many samples are drawn; more can't be seen.
const EVERY: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let swing = swing(&folder.join("data/paper/reconstructed_recording_noisy.csv"))?;
    let rig = drawing();
    let options = Options { method: Method::Both, ranges: Vec::new() };
    let found = fit(std::slice::from_ref(&swing), &[], &rig, &options, &|_| {})?;
    draw(&folder.join("../docs/picture.svg"), &swing, &rig, &found)
}

fn swing(path: &Path) -> Result<Swing, Box<dyn Error>> {
    let recording = read(path, &ReadOptions::default())?;
    Ok(Swing::from_recording("paper", &recording, &SegmentOptions::default())?.0)
}

/// Geometry and inertia of the paper's drawing (Table 1), no friction.
fn drawing() -> Parameters<f64> {
    let mut rig = Parameters::paper();
    rig.set_friction(0.0, 0.0, 0.0, 0.0);
    rig.pendulum.inertia_kg_m2 = 0.002_842_52;
    rig
}

fn draw(path: &Path, swing: &Swing, rig: &Parameters<f64>, found: &Fit) -> Result<(), Box<dyn Error>> {
    let area = SVGBackend::new(path, SIZE_PX).into_drawing_area();
    area.fill(&WHITE)?;
    let (left, right) = area.split_horizontally(LEFT_PX);
    draw_swing(&left, swing, found)?;
    draw_errors(&right, found, &errors_mrad(swing, rig, found))?;
    area.present()?;
    Ok(())
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw_swing(area: &Area, swing: &Swing, found: &Fit) -> Result<(), Box<dyn Error>> {
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .caption("one free swing: angle in rad", TITLE)
        .x_label_area_size(36)
        .y_label_area_size(40)
        .build_cartesian_2d(0.0..swing.duration_s(), -1.6..1.6)?;
    chart.configure_mesh().light_line_style(TRANSPARENT).label_style(FONT).x_desc("seconds").draw()?;
    let line = |angles: &[f64]| -> Vec<(f64, f64)> {
        swing.times_s.iter().copied().zip(angles.iter().copied()).step_by(EVERY).collect()
    };
    chart
        .draw_series(LineSeries::new(line(&swing.angles_rad), MEASURED.stroke_width(3)))?
        .label("measured")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], MEASURED.stroke_width(3)));
    chart
        .draw_series(LineSeries::new(line(&model_angles_rad(swing, found)), MODEL.stroke_width(1)))?
        .label("identified model")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], MODEL.stroke_width(1)));
    chart.configure_series_labels().label_font(FONT).border_style(TRANSPARENT).background_style(WHITE).draw()?;
    Ok(())
}

fn model_angles_rad(swing: &Swing, found: &Fit) -> Vec<f64> {
    let count = AtomicUsize::new(0);
    let problem = problem_of(std::slice::from_ref(swing), &found.parameters, &count);
    let values = problem.template_values();
    let mut columns = problem.predict(0, swing.len(), &[(&values, found.starts[0])]);
    columns.remove(0).iter().map(|angle_rad| angle_rad + found.starts[0].offset_rad).collect()
}

/// The error over the whole swing before any fit, after each design, and at the end.
fn errors_mrad(swing: &Swing, rig: &Parameters<f64>, found: &Fit) -> Vec<f64> {
    let count = AtomicUsize::new(0);
    let problem = problem_of(std::slice::from_ref(swing), rig, &count);
    let values = std::iter::once(problem.template_values()).chain(found.stages.iter().map(|stage| stage.values.clone()));
    let points: Vec<Point> = values.map(|values| Point { values, starts: found.starts.clone() }).collect();
    let rmse_mrad = |cost: &f64| 1e3 * (cost / swing.len() as f64).sqrt();
    let costs = problem.costs(Window::Whole, &points);
    costs.iter().map(rmse_mrad).chain([1e3 * found.rmse_rad]).collect()
}

fn draw_errors(area: &Area, found: &Fit, errors_mrad: &[f64]) -> Result<(), Box<dyn Error>> {
    let last = errors_mrad.len() - 1;
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .caption("error of the model in mrad", TITLE)
        .x_label_area_size(36)
        .y_label_area_size(48)
        .build_cartesian_2d(-0.5..last as f64 + 0.5, (0.5..2000.0).log_scale())?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .label_style(FONT)
        .x_labels(last + 1)
        .x_desc("response surface designs, then least squares")
        .y_label_formatter(&|mrad| format!("{mrad}"))
        .draw()?;
    let noise_mrad = 1e3 * found.noise_rad;
    chart.draw_series(DashedLineSeries::new(
        [(-0.5, noise_mrad), (last as f64 + 0.5, noise_mrad)],
        6,
        4,
        BLACK.stroke_width(1),
    ))?;
    chart.draw_series([Text::new("noise of the sensor", (-0.3, 0.9 * noise_mrad), FONT)])?;
    let points = || errors_mrad.iter().enumerate().map(|(stage_idx, mrad)| (stage_idx as f64, *mrad));
    chart.draw_series(LineSeries::new(points(), MODEL.stroke_width(2)))?;
    chart.draw_series(points().map(|point| Circle::new(point, 4, MODEL.filled())))?;
    Ok(())
}
