//! Power-law drag: resistance that grows with a power of speed between and beyond linear and quadratic.
//! Source: R. A. Nelson, M. G. Olsson, Am. J. Phys. 54 (1986) 112: the drag of bob and rod lies between the two.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 11,
        name: "power-law-drag",
        summary: "Air resistance with an exponent of its own: thin rods at low speed lie between linear and quadratic.",
        formula: "torque = -Cp*|omega|^p*sgn(omega)",
        source: "R. A. Nelson, M. G. Olsson, Am. J. Phys. 54 (1986) 112",
        experiment: "Releases from 0.3 to 1.5 rad: the slope of energy loss against amplitude, both logarithmic, is p + 1.",
        parameters: &[
            Parameter {
                symbol: "Cp",
                unit: "N·m·(s/rad)^p",
                low: 0.0,
                high: 1e-2,
                start: 0.0,
                meaning: prose!("drag torque at 1 rad/s"),
            },
            Parameter {
                symbol: "p",
                unit: "1",
                low: 0.25,
                high: 4.0,
                start: 2.5,
                meaning: prose!("exponent of the speed"),
            },
        ],
        starts: &[[0.0, 2.5, 0.0, 0.0], [0.0, 1.5, 0.0, 0.0], [0.0, 3.2, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0]],
        family: Family::Speed,
        generalises: Some("quadratic-drag"),
        is_fine: false,
        rules: Rules { special_case_at: Some((1, 2.0)), ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * motion.velocity_rad_s.abs().powf(values[1]) * motion.velocity_rad_s.sign()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn with_exponent_two_it_is_quadratic_drag() {
        let quadratic = crate::effect::quadratic_drag::effect::<f64>();
        for velocity in [-3.0, -0.1, 0.0, 0.7, 12.0] {
            let ours = torque_at(&super::effect(), 0.3, velocity, &[1e-4, 2.0]);
            assert!((ours - torque_at(&quadratic, 0.3, velocity, &[1e-4])).abs() < 1e-17);
        }
    }
}
