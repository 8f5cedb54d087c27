//! Torsional spring that hardens or softens: a cable that grows stiffer the further it is wound up.
//! Source: G. Duffing, Erzwungene Schwingungen bei veränderlicher Eigenfrequenz (Vieweg, 1918).

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 24,
        name: "general-spring",
        summary: "A cable that twists along and grows stiffer, or softer, the further it is wound up.",
        formula: "torque = -ksg*((theta - thsg) + h*(theta - thsg)^3)",
        source: "G. Duffing, Erzwungene Schwingungen bei veränderlicher Eigenfrequenz (Vieweg, 1918)",
        experiment: "Small and large releases on both sides: a spring shortens the period of small swings more.",
        parameters: &[
            Parameter {
                symbol: "ksg", unit: "N·m/rad", low: 0.0, high: 0.2, start: 0.0, meaning: prose!("stiffness")
            },
            Parameter {
                symbol: "thsg",
                unit: "rad",
                low: -3.2,
                high: 3.2,
                start: 0.0,
                meaning: prose!("angle at which it is relaxed"),
            },
            Parameter {
                symbol: "h",
                unit: "1/rad²",
                low: -0.3,
                high: 50.0,
                start: 0.0,
                meaning: prose!("by what share it is stiffer at 1 rad"),
            },
        ],
        starts: &[[0.0, 0.0, 0.0, 0.0], [0.0, 0.3, 3.0, 0.0]],
        family: Family::Spring,
        generalises: Some("torsional-spring"),
        is_fine: true,
        rules: Rules {
            relaxes_at: Some(1),
            special_case_at: Some((2, 0.0)),
            share_of: Some((2, 0)),
            follows_special_case: true,
            ..Rules::NONE
        },
        action: Action::Drive(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let twist = motion.angle_rad - values[1];
    -values[0] * twist * (R::one() + values[2] * twist * twist)
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_pulls_harder_the_further_it_is_wound() {
        let torque = |angle: f64| torque_at(&super::effect(), angle, 0.0, &[0.01, 0.2, 3.0]);
        assert!((torque(0.7) + 0.005 * 1.75).abs() < 1e-15 && (torque(-0.8) - 0.04).abs() < 1e-15);
    }
}
