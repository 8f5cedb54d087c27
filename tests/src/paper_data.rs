//! The paper's files that come with the project.

use serde_json::Value;
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::path::{Path, PathBuf};

/// Where a file of the paper lies.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/paper").join(name)
}

/// A JSON file of the paper.
pub fn json(name: &str) -> Value {
    serde_json::from_str(&text(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A text file of the paper.
pub fn text(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Lowest and highest level of each factor in one of the three designs, in the order of the table.
pub fn levels(design: &str) -> Vec<(String, f64, f64)> {
    let rows = text("levels.csv");
    let cells = rows.lines().map(|row| row.split(',').collect::<Vec<_>>()).filter(|cells| cells[0] == design);
    let number = |cell: &str| cell.parse().expect("levels are numbers");
    cells.map(|cells| (cells[2].to_owned(), number(cells[3]), number(cells[5]))).collect()
}

/// What the authors knew before the first swing: geometry and inertia of the drawing (Table 1), nothing about friction.
pub fn drawing() -> Parameters<f64> {
    let constants = json("constants.json");
    let number = |key: &str| constants["table1"][key].as_f64().expect("a number of Table 1");
    Parameters::frictionless(Pendulum {
        mass_kg: number("m"),
        length_m: number("l"),
        inertia_kg_m2: number("I_cad"),
        gravity_m_s2: number("g"),
    })
}
