//! What the simulated bench is like: one entry a scenario. The truth is not what the rig believes.

use crate::rigfile::Quantity;
use shared::effect::Effect;
use shared::parameters::Parameters;
use shared::sensor::{Encoder, Sensor};

/// A bench to practise on.
#[derive(Clone, Copy, Debug)]
pub struct Scenario {
    /// As in `--port sim:NAME`.
    pub name: &'static str,
    /// For the list.
    pub summary: &'static str,
    /// Numbers in which the truth differs from the paper's optimum (Table 9), by name.
    pub truth: &'static [(&'static str, f64)],
    /// Release angles in rad, one a recording, over and over.
    pub releases_rad: &'static [f64],
    /// Standard deviation of the converter's noise before rounding, codes.
    pub noise_codes: f64,
    /// Beside the potentiometer there is this sensor, without noise, and the rig reads that one.
    pub sensor: Option<Sensor>,
    /// The wiper loses contact so many seconds after the set-up.
    pub breaks_after_s: Option<f64>,
    /// Does the rig itself look for what its model lacks?
    pub looks: bool,
}

/// Both directions, small and large.
const RELEASES_RAD: &[f64] = &[1.5, -1.2, 0.8, -1.8];

/// Of a 12-bit converter on a wire-wound potentiometer.
const NOISE_CODES: f64 = 0.7;

const PLAIN: Scenario = Scenario {
    name: Scenario::PLAIN,
    summary: "the paper's rig: viscous, Coulomb and static friction",
    truth: &[],
    releases_rad: RELEASES_RAD,
    noise_codes: NOISE_CODES,
    sensor: None,
    breaks_after_s: None,
    looks: true,
};

/// A rig whose hidden effect is to be found; `host simulate NAME --reveal` tells it.
const fn mystery(name: &'static str, truth: &'static [(&'static str, f64)]) -> Scenario {
    Scenario { name, summary: "a rig with something hidden, or nothing: find out", truth, ..PLAIN }
}

impl Scenario {
    /// The scenario of `--port sim`.
    pub const PLAIN: &'static str = "plain";

    /// Every scenario there is.
    pub const ALL: &'static [Self] = &[
        PLAIN,
        Self {
            name: "drag",
            summary: "with air drag that grows with the square of speed",
            truth: &[("Cq", 1e-4)],
            ..PLAIN
        },
        mystery("mystery-1", &[("quadratic-drag.Cq", 8e-5)]),
        mystery("mystery-2", &[("torsional-spring.ks", 6e-3)]),
        mystery("mystery-3", &[("backlash.b", 0.012)]),
        mystery("mystery-4", &[]),
        mystery("mystery-5", &[("detent.Mds", 6e-4), ("detent.Mdc", 4e-4), ("detent.n", 9.0)]),
        mystery(
            "mystery-6",
            &[("coulomb.Mc", 1.2124e-3), ("drifting-friction.rc", -5.56e-5), ("drifting-friction.tau", 9.0)],
        ),
        mystery("mystery-7", &[("asymmetric-coulomb.dM", 2.5e-4)]),
        mystery("mystery-8", &[("eddy-brake.Cb", 9e-4), ("eddy-brake.thb", 0.35), ("eddy-brake.w", 0.15)]),
        mystery(
            "mystery-9",
            &[("quadratic-drag.Cq", 1e-4), ("sensor-nonlinearity.q2", 0.03), ("sensor-nonlinearity.q3", 0.015)],
        ),
        Self {
            name: "encoder",
            summary: "an incremental encoder of 1024 lines instead of the potentiometer",
            sensor: Some(Sensor::Encoder(Encoder::new(4096))),
            ..PLAIN
        },
        Self {
            name: "old-firmware",
            summary: "the paper's rig with firmware that does not look for what is missing",
            looks: false,
            ..PLAIN
        },
        Self { name: "broken-wire", summary: "the potentiometer's wire is broken", breaks_after_s: Some(0.0), ..PLAIN },
        Self {
            name: "loose-wire",
            summary: "the potentiometer's wire comes off in the middle of the first swings",
            breaks_after_s: Some(12.0),
            ..PLAIN
        },
    ];

    /// The scenario of this name.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|scenario| scenario.name == name)
    }

    /// Names of the effects that the base model lacks.
    pub fn hidden_effects(&self) -> Vec<&'static str> {
        let parameters = self.true_parameters();
        let added = parameters.effects.iter().filter_map(|present| Effect::<f64>::by_id(present.id));
        added.filter(|effect| !effect.is_base()).map(|effect| effect.name).collect()
    }

    /// The parameters the simulated pendulum really has.
    pub fn true_parameters(&self) -> Parameters<f64> {
        let mut parameters = Parameters::paper();
        for (name, value) in self.truth {
            let quantity = Quantity::by_name(name).expect("a test looks every name up");
            quantity.add_effect(&mut parameters).expect("a test builds every scenario");
            quantity.set(&mut parameters, *value);
        }
        parameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scenario_has_a_truth_that_a_model_can_have() {
        for scenario in Scenario::ALL {
            assert_eq!(scenario.true_parameters().check(), Ok(()), "{}", scenario.name);
            assert!(scenario.releases_rad.iter().all(|angle| angle.abs() < 2.9), "{}", scenario.name);
        }
    }

    #[test]
    fn names_are_unique() {
        for (position, scenario) in Scenario::ALL.iter().enumerate() {
            assert!(Scenario::ALL[..position].iter().all(|earlier| earlier.name != scenario.name));
        }
    }
}
