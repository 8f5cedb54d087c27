//! `host init`: writes a model file.

use super::output;
use super::values::{not_negative, positive};
use crate::error::Failure;
use crate::number::significant;
use crate::operations::model::{Value, values};
use crate::rigfile::{RigFile, RigFileError};
use clap::Args;
use serde::Serialize;
use shared::motion::{GRAVITY_M_S2, Pendulum};
use std::path::PathBuf;

/// Write a model file for a rig of known (or unknown) geometry.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Mass of the pendulum, kg
    #[arg(long, value_name = "KG", value_parser = positive, allow_negative_numbers = true)]
    #[arg(required_unless_present = "unknown_geometry", conflicts_with = "unknown_geometry")]
    mass: Option<f64>,
    /// Distance from the pivot to the centre of mass, m
    #[arg(long, value_name = "M", value_parser = positive, allow_negative_numbers = true)]
    #[arg(required_unless_present = "unknown_geometry", conflicts_with = "unknown_geometry")]
    length: Option<f64>,
    /// Moment of inertia about the centre of mass (not the pivot), kg·m²
    #[arg(long, value_name = "KG·M²", value_parser = not_negative, allow_negative_numbers = true)]
    #[arg(required_unless_present = "unknown_geometry", conflicts_with = "unknown_geometry")]
    inertia: Option<f64>,
    /// How surely the mass is known: its standard deviation, kg
    #[arg(long, value_name = "KG", value_parser = positive, allow_negative_numbers = true, requires = "mass")]
    mass_std: Option<f64>,
    /// The same of the length, m
    #[arg(long, value_name = "M", value_parser = positive, allow_negative_numbers = true, requires = "length")]
    length_std: Option<f64>,
    /// The same of the moment of inertia, kg·m²; without it any inertia may be found
    #[arg(long, value_name = "KG·M²", value_parser = positive, allow_negative_numbers = true, requires = "inertia")]
    inertia_std: Option<f64>,
    /// Gravitational acceleration, m/s²
    #[arg(long, value_name = "M/S²", value_parser = positive, allow_negative_numbers = true, default_value_t = GRAVITY_M_S2)]
    gravity: f64,
    /// Only the motion is known: every torque comes per m·g·l
    #[arg(long)]
    unknown_geometry: bool,
    /// The file to write
    #[arg(short, long, value_name = "FILE", default_value = "rig.toml")]
    output: PathBuf,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 -o rig.toml
  host init --mass 0.147 --mass-std 1e-4 --length 0.156 --length-std 1e-3 --inertia 0.00284
  host init --unknown-geometry -o rig.toml

Friction starts as a guess from the pendulum's size. Next: `host record`, then `host fit`.";

#[derive(Serialize)]
struct Written {
    #[serde(serialize_with = "output::lossy")]
    file: PathBuf,
    normalised: bool,
    gravity_torque_nm: f64,
    pivot_inertia_kg_m2: f64,
    period_s: f64,
    parameters: Vec<Value>,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    output::check(&[&options.output], &[], options.force)?;
    // The numbers were typed just now.
    let file =
        model(options).map_err(|error| Failure::wrong_use(error).next("give a value within the range, in SI units"))?;
    let typed = (!file.is_normalised()).then_some(&file.parameters().pendulum);
    typed.into_iter().flat_map(implausible).for_each(|doubt| output::warn(&doubt));
    file.save(&options.output)?;
    let pendulum = &file.parameters().pendulum;
    let (gravity_torque_nm, pivot_inertia_kg_m2) = (pendulum.gravity_torque_nm(), pendulum.pivot_inertia_kg_m2());
    let written = Written {
        file: options.output.clone(),
        normalised: file.is_normalised(),
        gravity_torque_nm,
        pivot_inertia_kg_m2,
        period_s: 2.0 * std::f64::consts::PI * (pivot_inertia_kg_m2 / gravity_torque_nm).sqrt(),
        parameters: values(&file),
    };
    if options.json {
        output::json("init", &written)
    } else {
        output::result(&in_words(&written))
    }
    Ok(())
}

/// No pendulum on a bench has a mass beyond this, kg …
const HEAVIEST_KG: f64 = 100.0;

/// … its centre of mass farther from the pivot, m …
const LONGEST_M: f64 = 20.0;

/// … or spreads its mass so much farther than to the pivot: a balanced wheel, I over m·l².
const WIDEST: f64 = 100.0;

/// What can't well be meant, because it looks like another unit, with the cure.
fn implausible(pendulum: &Pendulum<f64>) -> Vec<String> {
    let Pendulum { mass_kg, length_m, inertia_kg_m2, .. } = *pendulum;
    let ratio = inertia_kg_m2 / (mass_kg * length_m.powi(2));
    let doubts = [
        (mass_kg > HEAVIEST_KG).then(|| {
            format!("a mass of {mass_kg} kg is much for a pendulum; of {mass_kg} g it is --mass {}", mass_kg / 1e3)
        }),
        (length_m > LONGEST_M).then(|| {
            format!(
                "{length_m} m to the centre of mass is much for a pendulum; of {length_m} mm it is --length {}",
                length_m / 1e3
            )
        }),
        (ratio > WIDEST).then(|| {
            format!(
                "an inertia of {inertia_kg_m2} kg·m² is {} times m·l²; 1 kg·m² is 10⁷ g·cm² or 10⁹ g·mm²",
                significant(ratio, 2)
            )
        }),
    ];
    let doubts = doubts.into_iter().flatten();
    doubts.map(|doubt| format!("{doubt}: give all in kg, m and kg·m², and --force to write the file anew")).collect()
}

fn model(options: &Options) -> Result<RigFile, RigFileError> {
    let stds = [options.mass_std, options.length_std, options.inertia_std];
    without_tolerances(options)?.measured_to(stds)
}

fn without_tolerances(options: &Options) -> Result<RigFile, RigFileError> {
    match (options.mass, options.length, options.inertia) {
        (Some(mass_kg), Some(length_m), Some(inertia_kg_m2)) => {
            RigFile::new(Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2: options.gravity })
        }
        _ => RigFile::normalised(options.gravity),
    }
}

fn in_words(written: &Written) -> String {
    let file = written.file.display();
    let geometry = if written.normalised {
        "The geometry is unknown: m·g·l counts as 1, so every torque and inertia in the file is per m·g·l.".to_owned()
    } else {
        format!(
            "A pendulum with m·g·l = {} N·m, m·l² + I = {} kg·m² and a period of {} s for small swings.",
            significant(written.gravity_torque_nm, 4),
            significant(written.pivot_inertia_kg_m2, 4),
            significant(written.period_s, 4)
        )
    };
    // Without geometry there is nothing to send to a rig.
    let or_port = if written.normalised { "" } else { " (or --port PORT in place of the recording)" };
    format!(
        "wrote {file}\n{geometry}\nFriction is a guess until a fit: host fit swing.csv --rig {file} -o {file}{or_port}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_in_grams_and_millimetres_are_doubted_with_the_cure() {
        let doubts = |mass_kg, length_m, inertia_kg_m2| {
            implausible(&Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2: GRAVITY_M_S2 })
        };
        let all = doubts(146.0, 156.0, 2842.0);
        assert!(all[0].contains("of 146 g it is --mass 0.146") && all[1].contains("--length 0.156"), "{all:?}");
        assert!(doubts(0.146, 0.156, 2842.0)[0].contains("10⁹ g·mm²"));
        assert!(doubts(0.1466084, 0.1562177, 0.00284252).is_empty() && doubts(47.0, 67.0 / 4.0, 0.5).is_empty());
    }
}
