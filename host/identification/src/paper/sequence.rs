//! Would the sequence of three designs have arrived by itself? Two ways to follow it, each stage going to the optimum
//! of its own surfaces: in the paper's three boxes, and in boxes of the paper's widths centred on one's own last
//! optimum. The true error at each stage is simulated.

use super::data::{Published, Values};
use super::designs::{DesignComparison, surfaces};
use super::optima::{OurOptimum, best, natural_bounds};
use super::replay::Replay;
use crate::cores::on_all_cores;
use crate::rsm::{Design, Factor, Surface};
use serde::Serialize;

/// Where the sequence leads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SequenceComparison {
    /// Simulated mseA at the three printed optima, rad².
    pub printed_optima: [f64; 3],
    /// The optima of the replayed responses in the paper's three boxes.
    pub paper_boxes: Vec<Stage>,
    /// The optima when each box is centred on the last own optimum.
    pub own_boxes: Vec<Stage>,
}

/// One stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stage {
    /// Mw, Mc, Ms, DV, I at its optimum.
    pub values: Values,
    /// mseA that its surface predicts there, rad².
    pub predicted: f64,
    /// mseA that the simulation gives there, rad².
    pub simulated: f64,
}

impl From<OurOptimum> for Stage {
    fn from(optimum: OurOptimum) -> Self {
        Self { values: optimum.values, predicted: optimum.predicted.mse_angle, simulated: optimum.simulated.mse_angle }
    }
}

/// Follows the sequence both ways.
pub fn compare(published: &Published, replay: &Replay, designs: &[DesignComparison]) -> SequenceComparison {
    let replayed = |design: &DesignComparison| {
        let composite = designs_surfaces(design);
        let responses: Vec<_> = design.runs.iter().map(|run| run.ours).collect();
        optimum_of(&surfaces(&composite, &responses), replay)
    };
    let paper_boxes: Vec<Stage> = on_all_cores(designs, replayed);
    let mut own_boxes = vec![paper_boxes[0].clone()];
    for design in &published.designs[1..] {
        let centre = own_boxes.last().map_or(paper_boxes[0].values, |stage| stage.values);
        own_boxes.push(stage_around(&centre, &design.factors, replay));
    }
    let printed = on_all_cores(&published.optima, |optimum| replay.responses(&optimum.values).mse_angle);
    SequenceComparison { printed_optima: std::array::from_fn(|k| printed[k]), paper_boxes, own_boxes }
}

fn designs_surfaces(design: &DesignComparison) -> Design {
    design.surfaces[0].design().clone()
}

/// Runs a design of the given widths around a point; no factor below zero.
fn stage_around(centre: &Values, widths: &[Factor], replay: &Replay) -> Stage {
    let around = |(centre, width): (&f64, &Factor)| {
        let half = width.half_range();
        let centre = centre.max(half);
        Factor::new(width.name(), centre - half, centre + half).expect("a width above zero")
    };
    let factors = centre.iter().zip(widths).map(around).collect();
    let design = Design::face_centred(factors, 1).expect("five factors have a design");
    let settings: Vec<Values> = design.natural_runs().iter().map(|run| std::array::from_fn(|j| run[j])).collect();
    optimum_of(&surfaces(&design, &replay.all(&settings)), replay)
}

fn optimum_of(surfaces: &[Surface], replay: &Replay) -> Stage {
    best(surfaces, natural_bounds(surfaces), replay).into()
}
