//! What the paper printed, and the rebuilt recording; embedded, so that no file need be there.
//!
//! The files are fixed parts of the program and read by its tests, so reading them cannot fail at run time.

use crate::fit::quality::Responses;
use crate::rsm::{Factor, PrintedEquation, read_equations};
use serde::Deserialize;
use std::collections::BTreeMap;

const RECORDING: &str = include_str!("../../../data/paper/reconstructed_recording.csv");
const RECONSTRUCTION: &str = include_str!("../../../data/paper/reconstruction.json");
const CONSTANTS: &str = include_str!("../../../data/paper/constants.json");
const LEVELS: &str = include_str!("../../../data/paper/levels.csv");
const TABLE_3: &str = include_str!("../../../data/paper/table3.csv");
const TABLE_8: &str = include_str!("../../../data/paper/table8.csv");
const EQUATIONS: &str = include_str!("../../../data/paper/equations_18_22.csv");

/// The paper's factors, in its order.
pub const SYMBOLS: [&str; 5] = ["Mw", "Mc", "Ms", "DV", "I"];

/// Values of the five factors, SI units.
pub type Values = [f64; 5];

/// Upper bounds of the desirabilities with which the optimum of Table 9 comes out, in the order of
/// [`Responses::NAMES`]; the paper does not state its own.
pub const BOUNDS_OF_TABLE_9: [f64; 5] = [2e-4, 0.3, 3.0, 3.0, 3.0];

/// Everything printed that we compare with.
#[derive(Clone, Debug)]
pub struct Published {
    /// The rebuilt recording, rad.
    pub recording_rad: Vec<f64>,
    /// Time between its samples, s.
    pub interval_s: f64,
    /// Where the simulations start at rest, rad.
    pub start_rad: f64,
    /// Part of the published mean squares that no simulation of the rebuilt recording explains: angle, rad².
    pub floor_angle: f64,
    /// The same for velocity, rad²/s².
    pub floor_velocity: f64,
    /// Tables 2, 5, 7 with 3 and 8.
    pub designs: Vec<PublishedDesign>,
    /// Tables 4, 6, 9.
    pub optima: Vec<PublishedOptimum>,
    /// R² printed for design 3, per cent, in the order of [`Responses::NAMES`].
    pub r_squared_percent: [f64; 5],
    /// Eqs 18–22.
    pub equations: Vec<PrintedEquation>,
}

/// A design as printed.
#[derive(Clone, Debug)]
pub struct PublishedDesign {
    /// 1 to 3.
    pub number: usize,
    /// The table of its ranges.
    pub levels_table: usize,
    /// The table of its runs; absent for design 2.
    pub runs_table: Option<usize>,
    /// Its ranges.
    pub factors: Vec<Factor>,
    /// Its runs; empty for design 2.
    pub runs: Vec<PublishedRun>,
}

/// A run as printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedRun {
    /// Settings.
    pub values: Values,
    /// What the authors' simulation gave.
    pub responses: Responses,
}

/// An optimum as printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PublishedOptimum {
    /// 4, 6 or 9.
    pub table: usize,
    /// Settings.
    pub values: Values,
    /// The responses stated with it: simulated for Tables 4 and 6, predicted by Eqs 18–22 for Table 9.
    pub responses: Responses,
}

impl Published {
    /// The embedded data.
    pub fn embedded() -> Self {
        let reconstruction: Reconstruction = serde_json::from_str(RECONSTRUCTION).expect("embedded and tested");
        let constants: Constants = serde_json::from_str(CONSTANTS).expect("embedded and tested");
        let recording = rows(RECORDING);
        Self {
            interval_s: recording[1][0] - recording[0][0],
            recording_rad: recording.iter().map(|row| row[1]).collect(),
            start_rad: reconstruction.sim.theta0,
            floor_angle: reconstruction.additive_floor.angle,
            floor_velocity: reconstruction.additive_floor.velocity,
            designs: vec![design(1, 2, Some((3, TABLE_3))), design(2, 5, None), design(3, 7, Some((8, TABLE_8)))],
            optima: [4, 6, 9].map(|table| constants.optimum(table)).to_vec(),
            r_squared_percent: Responses::NAMES.map(|name| constants.r_squared_percent[name]),
            equations: read_equations(EQUATIONS.as_bytes()).expect("embedded and tested"),
        }
    }
}

impl PublishedDesign {
    /// Coded −1/0/+1 settings as signs: `--0+-`.
    pub fn signs(&self, values: &Values) -> String {
        let sign = |(factor, value): (&Factor, &f64)| match factor.coded(*value) {
            coded if coded < -0.5 => '−',
            coded if coded > 0.5 => '+',
            _ => '0',
        };
        self.factors.iter().zip(values).map(sign).collect()
    }
}

#[derive(Deserialize)]
struct Reconstruction {
    sim: Sim,
    additive_floor: Floor,
}

#[derive(Deserialize)]
struct Sim {
    theta0: f64,
}

#[derive(Deserialize)]
struct Floor {
    #[serde(rename = "mseA")]
    angle: f64,
    #[serde(rename = "mseV")]
    velocity: f64,
}

#[derive(Deserialize)]
struct Constants {
    optima: BTreeMap<String, serde_json::Value>,
    #[serde(rename = "R2_percent_published")]
    r_squared_percent: BTreeMap<String, f64>,
}

impl Constants {
    fn optimum(&self, table: usize) -> PublishedOptimum {
        let optimum = &self.optima[&format!("table{table}")];
        let responses = optimum.get("responses_simulated").unwrap_or(&optimum["responses_predicted_by_eqs_18_22"]);
        let number = |value: &serde_json::Value| value.as_f64().expect("embedded and tested");
        PublishedOptimum {
            table,
            values: SYMBOLS.map(|symbol| number(&optimum[symbol])),
            responses: of_values(Responses::NAMES.map(|name| number(&responses[name]))),
        }
    }
}

/// Five numbers in the order of [`Responses::NAMES`].
pub fn of_values([mse_angle, mse_velocity, positive_peaks, negative_peaks, zero_crossings]: [f64; 5]) -> Responses {
    Responses { mse_angle, mse_velocity, positive_peaks, negative_peaks, zero_crossings }
}

fn design(number: usize, levels_table: usize, runs: Option<(usize, &str)>) -> PublishedDesign {
    let run = |row: &Vec<f64>| PublishedRun {
        values: std::array::from_fn(|j| row[1 + j]),
        responses: of_values(std::array::from_fn(|j| row[1 + SYMBOLS.len() + j])),
    };
    PublishedDesign {
        number,
        levels_table,
        runs_table: runs.map(|(table, _)| table),
        factors: factors(number),
        runs: runs.map_or(Vec::new(), |(_, text)| rows(text).iter().map(run).collect()),
    }
}

fn factors(design_number: usize) -> Vec<Factor> {
    let cells = LEVELS.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let own = cells.filter(|row| row[0].parse() == Ok(design_number));
    own.map(|row| Factor::new(row[2], number(row[3]), number(row[5])).expect("embedded and tested")).collect()
}

/// Rows of numbers behind the header.
fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(number).collect()).collect()
}

fn number(text: &str) -> f64 {
    text.trim().parse().expect("embedded and tested")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_printed_is_there() {
        let published = Published::embedded();
        assert_eq!(published.recording_rad.len(), 4621);
        assert!((published.interval_s - 0.01).abs() < 1e-12 && published.start_rad == 1.509);
        assert_eq!(published.designs.iter().map(|design| design.runs.len()).collect::<Vec<_>>(), [27, 0, 27]);
        assert!(published.designs.iter().all(|design| design.factors.len() == 5));
        assert_eq!(published.optima.iter().map(|optimum| optimum.table).collect::<Vec<_>>(), [4, 6, 9]);
        assert_eq!((published.equations.len(), published.equations[0].coefficients.len()), (5, 21));
        assert_eq!(published.designs[2].signs(&published.designs[2].runs[0].values), "−−−−+");
    }

    #[test]
    fn in_every_printed_run_the_crossings_are_the_peaks() {
        for run in Published::embedded().designs.iter().flat_map(|design| &design.runs) {
            let Responses { positive_peaks, negative_peaks, zero_crossings, .. } = run.responses;
            assert_eq!(positive_peaks + negative_peaks, zero_crossings);
        }
    }
}
