//! Stribeck effect with an exponent of its own: contacts differ in how the extra friction fades with speed.
//! Source: L. C. Bo, D. Pavelescu, Wear 82 (1982) 277: δ from 0.5 to 1; 1 is A. Tustin's law, 2 the usual one.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 21,
        name: "general-stribeck",
        summary: "Extra friction at low speed that fades more slowly, or more suddenly, than the usual Stribeck law has it.",
        formula: "torque = -dMg*exp(-(abs(omega)/wsg)^delta)*sgn(omega)",
        source: "L. C. Bo, D. Pavelescu, Wear 82 (1982) 277",
        experiment: "Small swings, and the last ones of every release: the amplitude falls faster the smaller it is.",
        parameters: &[
            Parameter {
                symbol: "dMg",
                unit: "N·m",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("extra friction at very low speed"),
            },
            Parameter {
                symbol: "wsg",
                unit: "rad/s",
                low: 0.02,
                high: 10.0,
                start: 0.5,
                meaning: prose!("speed at which it has fallen to 37 %"),
            },
            Parameter {
                symbol: "delta",
                unit: "1",
                low: 0.25,
                high: 4.0,
                start: 2.0,
                meaning: prose!("exponent of the speed"),
            },
        ],
        starts: &[[0.0, 0.5, 2.0, 0.0], [0.0, 0.5, 0.7, 0.0]],
        family: Family::Dry,
        generalises: Some("stribeck"),
        is_fine: true,
        rules: Rules { special_case_at: Some((2, 2.0)), follows_special_case: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let ratio = motion.velocity_rad_s.abs() / values[1];
    -values[0] * (-ratio.powf(values[2])).exp() * motion.direction
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn with_exponent_two_it_is_the_usual_law_and_with_one_it_fades_exponentially() {
        let usual = crate::effect::stribeck::effect::<f64>();
        for velocity in [-3.0, -0.1, 1e-9, 0.7, 2.0] {
            let ours = |delta: f64| torque_at(&super::effect(), 0.3, velocity, &[1e-3, 0.5, delta]);
            assert!((ours(2.0) - torque_at(&usual, 0.3, velocity, &[1e-3, 0.5])).abs() < 1e-15);
            let exponential = -1e-3 * libm::exp(-2.0 * velocity.abs()) * velocity.signum();
            assert!((ours(1.0) - exponential).abs() < 1e-15);
        }
    }
}
