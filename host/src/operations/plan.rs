//! Which experiment would tell the leading explanations apart.

use crate::diagnose::diagnose;
use crate::plan::{NOTHING, Prospect, plan};
use crate::rigfile::RigFile;
use crate::swing::Swing;
use crate::verdict::Left;
use serde::Serialize;

/// Experiments for a rig, as `--json` shows them.
#[derive(Clone, Debug, Serialize)]
pub struct Planned {
    /// What the leading explanations were found from.
    pub recordings: Vec<String>,
    /// The leading explanations, the best one first.
    pub models: Vec<String>,
    /// Effects that the recordings can't tell from what is named.
    pub undecided: Vec<&'static str>,
    /// The experiments, the best one first; none if nothing is to be separated.
    pub experiments: Vec<Prospect>,
    /// What the best explanation leaves, and how many times the noise that is.
    #[serde(skip)]
    pub left: (Left, f64),
}

impl Planned {
    /// From recordings of these names, and their swings.
    pub fn new(recordings: &[String], swings: &[Swing], rig: &RigFile) -> Self {
        let diagnosis = diagnose(swings, &[], rig.known());
        let leading = &diagnosis.leading;
        let experiments = if leading.len() < 2 { Vec::new() } else { plan(swings, leading, !rig.is_normalised()) };
        Self {
            recordings: recordings.to_vec(),
            models: leading.iter().map(|trial| named(&trial.names())).collect(),
            undecided: diagnosis.undecided,
            experiments,
            left: (diagnosis.left, diagnosis.rmse_after / diagnosis.noise.max(f64::MIN_POSITIVE)),
        }
    }
}

fn named(names: &[&str]) -> String {
    if names.is_empty() { NOTHING.to_owned() } else { names.join(" + ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::swing;
    use crate::rigfile::Source;
    use shared::parameters::Parameters;

    #[test]
    fn what_the_best_explanation_leaves_is_told_not_what_the_model_left_before() {
        let mut swing = swing();
        swing.angles_rad.iter_mut().for_each(|angle| *angle += 0.05);
        let rig = RigFile::of_rig(&Parameters::paper().map(|number| number as f32), &Source::read_from("rig")).unwrap();
        let planned = Planned::new(&[], &[swing], &rig);
        assert!((planned.left.1 - 1.0).abs() < 0.1, "{:?}", planned.left);
        assert_eq!((planned.models, planned.experiments.len()), (vec![NOTHING.to_owned()], 0));
    }

    #[test]
    fn a_pendulum_of_which_only_the_motion_is_known_is_not_changed() {
        let mut truth = Parameters::paper();
        truth.set(10, &[2e-4]).unwrap();
        let model = shared::model::Model::new(&truth);
        let mut state = model.release(1.2, 0.0);
        let times_s: Vec<f64> = (0..600).map(|i| f64::from(i) / 50.0).collect();
        let mut angles_rad = Vec::new();
        for k in 0..times_s.len() {
            angles_rad.push(state.angle_rad + 1e-3 * [1.0, -1.0, -1.0, 1.0][k % 4]);
            (0..10).for_each(|_| model.step(&mut state, 2e-3));
        }
        let swings = [Swing::new("drag.csv", &times_s, &angles_rad, 1e-3)];
        let changes = |rig: &RigFile| {
            let planned = Planned::new(&[], &swings, rig);
            let is_changed = |it: &Prospect| (it.experiment.mass_factor, it.experiment.length_factor) != (1.0, 1.0);
            assert!(planned.models.len() > 1 && !planned.experiments.is_empty(), "{:?}", planned.models);
            planned.experiments.iter().any(is_changed)
        };
        assert!(changes(&RigFile::new(Parameters::paper().pendulum).unwrap()));
        assert!(!changes(&RigFile::normalised(9.81).unwrap()));
    }

    #[test]
    fn effects_of_one_explanation_are_added() {
        assert_eq!(named(&["quadratic-drag", "eddy-brake"]), "quadratic-drag + eddy-brake");
        assert_eq!(named(&[]), NOTHING);
    }
}
