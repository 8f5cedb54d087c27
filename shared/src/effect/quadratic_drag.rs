//! Quadratic drag: the air's resistance on rod and bob; torque grows with the square of speed.
//! Source: P. T. Squire, Am. J. Phys. 54 (1986) 984.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 10,
        name: "quadratic-drag",
        summary: "Air pushed aside by rod and bob: twice the speed, four times the torque.",
        formula: "torque = -Cq*omega*|omega|",
        source: "P. T. Squire, Am. J. Phys. 54 (1986) 984",
        experiment: "Large release angles: the energy lost per path length grows as a parabola of amplitude.",
        parameters: &[Parameter {
            symbol: "Cq",
            unit: "N·m·s²/rad²",
            low: 0.0,
            high: 1e-2,
            start: 0.0,
            meaning: prose!("drag torque at 1 rad/s"),
        }],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Speed,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * motion.velocity_rad_s * motion.velocity_rad_s.abs()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_opposes_the_motion_with_the_square_of_speed() {
        let effect = super::effect::<f64>();
        assert_eq!(torque_at(&effect, 0.3, 2.0, &[1e-4]), -4e-4);
        assert_eq!(torque_at(&effect, 0.3, -2.0, &[1e-4]), 4e-4);
        assert_eq!(torque_at(&effect, 0.3, 0.0, &[1e-4]), 0.0);
    }
}
