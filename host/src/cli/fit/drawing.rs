//! `--plot`: measured against model, as an SVG.

use crate::cli::output;
use crate::error::Failure;
use crate::fit::identify::Fit;
use crate::geometry::is_unknown;
use crate::operations::fit::modelled_by;
use crate::paper::data::Published;
use crate::paper::replay::Replay;
use crate::plot::overlay::{Overlay, Row};
use crate::recording::Measured;
use crate::shorten::shortened;
use crate::swing::Swing;
use std::path::Path;

/// A longer name would leave the drawing together with what stands behind it.
const LONGEST_NAME: usize = 70;

/// Draws all fitted swings.
pub(super) fn of_fit(path: &Path, fit: &Fit, swings: &[Swing], force: bool) -> Result<(), Failure> {
    let rows: Vec<Row> =
        swings.iter().enumerate().map(|(idx, swing)| row(swing, modelled_by(fit, idx, swing))).collect();
    let title = match swings {
        [_] => "Measured against model".to_owned(),
        _ => format!("Measured against model: {} swings", swings.len()),
    };
    let overlay = Overlay { title, subtitle: numbers(fit), rows };
    output::write(path, &overlay.svg(), force)
}

/// Draws the paper's simulation at its three optima over the rebuilt recording, as in its Figs 6, 7 and 9.
pub(super) fn of_paper(path: &Path, force: bool) -> Result<(), Failure> {
    let published = Published::embedded();
    let replay = Replay::new(&published);
    let simulation = replay.simulation();
    let row = |optimum: &crate::paper::data::PublishedOptimum| Row {
        title: format!(
            "optimum of Table {}: mseA {:.3e} rad²",
            optimum.table,
            replay.responses(&optimum.values).mse_angle
        ),
        times_s: (0..published.recording_rad.len()).map(|i| i as f64 * published.interval_s).collect(),
        measured_rad: published.recording_rad.clone(),
        model_rad: replay.angles_rad(&optimum.values),
        noise_rad: simulation.floor_angle.sqrt(),
        measured: Measured::Angle,
    };
    let overlay = Overlay {
        title: "The paper's simulation at its three optima over the rebuilt recording".to_owned(),
        subtitle: format!(
            "start {} rad, {:.1} s, 1 ms steps; noise as in the paper's own recording",
            simulation.start_rad, simulation.duration_s
        ),
        rows: published.optima.iter().map(row).collect(),
    };
    output::write(path, &overlay.svg(), force)
}

fn row(swing: &Swing, model_rad: Vec<f64>) -> Row {
    let squares: f64 = swing.angles_rad.iter().zip(&model_rad).map(|(m, s)| (m - s).powi(2)).sum();
    let rmse_mrad = 1e3 * (squares / swing.len() as f64).sqrt();
    let name = Path::new(&swing.name).file_name().map_or(swing.name.as_str().into(), |name| name.to_string_lossy());
    let unit = swing.measured.milli_unit();
    let name = shortened(&name, LONGEST_NAME);
    let title = format!("{name}: error {rmse_mrad:.3} {unit} rms, noise {:.3} {unit} rms", 1e3 * swing.noise_rad);
    Row {
        title,
        times_s: swing.times_s.to_vec(),
        measured_rad: swing.angles_rad.clone(),
        model_rad,
        noise_rad: swing.noise_rad,
        measured: swing.measured,
    }
}

/// The parameters in one line.
fn numbers(fit: &Fit) -> String {
    let number = |found: &crate::fit::identify::Identified| {
        format!("{} = {} {}", found.symbol, crate::number::significant(found.value, 4), found.unit)
    };
    let numbers = fit.identified.iter().map(number).collect::<Vec<_>>().join(", ");
    if is_unknown(&fit.parameters.pendulum) { format!("{numbers} (per m·g·l)") } else { numbers }
}
