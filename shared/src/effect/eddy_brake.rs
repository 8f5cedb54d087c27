//! Eddy-current brake: a magnet beside the path brakes a passing conductor in proportion to its speed.
//! Source: H. D. Wiederick, N. Gauthier, D. A. Campbell, P. Rochon, Am. J. Phys. 55 (1987) 500.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Pattern, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 18,
        name: "eddy-brake",
        summary: "A magnet beside the path: while the bob passes it, it is braked in proportion to its speed.",
        formula: "torque = -Cb*omega*exp(-((theta - thb)/w)^2)",
        source: "H. D. Wiederick, N. Gauthier, D. A. Campbell, P. Rochon, Am. J. Phys. 55 (1987) 500",
        experiment: "Releases of many sizes, some too small to reach the magnet: only those that pass it lose the extra energy.",
        parameters: &[
            Parameter {
                symbol: "Cb",
                unit: "N·m·s/rad",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("braking torque at 1 rad/s in front of the magnet"),
            },
            Parameter {
                symbol: "thb",
                unit: "rad",
                low: -3.2,
                high: 3.2,
                start: 0.0,
                meaning: prose!("angle of the magnet"),
            },
            Parameter {
                symbol: "w",
                unit: "rad",
                low: 0.02,
                high: 2.0,
                start: 0.2,
                meaning: prose!("half width of its field"),
            },
        ],
        starts: &[
            [0.0, 0.0, 0.2, 0.0],
            [0.0, 0.3, 0.2, 0.0],
            [0.0, -0.3, 0.2, 0.0],
            [0.0, 0.7, 0.2, 0.0],
            [0.0, -0.7, 0.2, 0.0],
            [0.0, 0.0, 0.6, 0.0],
            // A small magnet is narrow: from the others, its promise is none.
            [0.0, 0.0, 0.08, 0.0],
            [0.0, 0.15, 0.08, 0.0],
            [0.0, -0.15, 0.08, 0.0],
        ],
        family: Family::Angle,
        generalises: None,
        is_fine: false,
        rules: Rules { n_starts_left_to_diagnosis: 3, pattern: Some(Pattern::Place(1, 2)), ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let away = (motion.angle_rad - values[1]) / values[2];
    -values[0] * motion.velocity_rad_s * (-away * away).exp()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_brakes_only_near_the_magnet() {
        let torque = |angle: f64, velocity: f64| torque_at(&super::effect(), angle, velocity, &[1e-3, 0.5, 0.1]);
        assert!((torque(0.5, 2.0) + 2e-3).abs() < 1e-15 && (torque(0.5, -2.0) - 2e-3).abs() < 1e-15);
        assert!(torque(-0.5, 2.0).abs() < 1e-15);
    }
}
