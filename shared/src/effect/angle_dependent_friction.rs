//! Angle-dependent friction: a bent shaft or a worn track rubs more at some angles than at others.
//! Source: B. Armstrong, Friction: experimental determination, modeling and compensation, Proc. IEEE ICRA (1988) 1422.
//!
//! It adds to Coulomb friction, which must be the larger for friction to oppose the motion at every angle.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Pattern, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 16,
        name: "angle-dependent-friction",
        summary: "A bent shaft or a worn track: dry friction that changes along the way, the same in both directions.",
        formula: "torque = -(Ma*cos(n*theta) + Mb*sin(n*theta))*sgn(omega)",
        source: "B. Armstrong, Proc. IEEE Int. Conf. Robotics and Automation (1988) 1422",
        experiment: "Releases of many sizes: the energy lost per path length depends on which angles a swing passes.",
        parameters: &[
            Parameter {
                symbol: "Ma",
                unit: "N·m",
                low: -1e-2,
                high: 1e-2,
                start: 0.0,
                meaning: prose!("cosine part of the added friction"),
            },
            Parameter {
                symbol: "Mb",
                unit: "N·m",
                low: -1e-2,
                high: 1e-2,
                start: 0.0,
                meaning: prose!("sine part of the added friction"),
            },
            Parameter { symbol: "n", unit: "1", low: 0.5, high: 20.0, start: 2.0, meaning: prose!("periods a turn") },
        ],
        starts: &[
            [0.0, 0.0, 2.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 3.0, 0.0],
            [0.0, 0.0, 4.5, 0.0],
            [0.0, 0.0, 7.0, 0.0],
            [0.0, 0.0, 10.0, 0.0],
        ],
        family: Family::Angle,
        generalises: None,
        is_fine: false,
        rules: Rules { pattern: Some(Pattern::Periods(2)), ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let phase = values[2] * motion.angle_rad;
    -(values[0] * phase.cos() + values[1] * phase.sin()) * motion.direction
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_opposes_both_directions_alike() {
        let torque = |angle: f64, velocity: f64| torque_at(&super::effect(), angle, velocity, &[1e-3, 5e-4, 2.0]);
        assert!((torque(0.0, 1.0) + 1e-3).abs() < 1e-15);
        for angle in [-1.0, 0.2, 0.9] {
            assert_eq!(torque(angle, 1.0), -torque(angle, -3.0));
        }
    }
}
