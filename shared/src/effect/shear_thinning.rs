//! Shear thinning: grease that resists in proportion to speed at first, and less and less beyond.
//! Source: P. J. Carreau, Trans. Soc. Rheol. 16 (1972) 99: viscosity η₀·(1 + (λ·γ̇)²)^((n − 1)/2), here with n = 0, whose
//! torque approaches a constant.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 28,
        name: "shear-thinning",
        summary: "Grease or a wiper whose friction grows with speed only at first: beyond some speed it stays what it is.",
        formula: "torque = -Mt*(omega/wt)/sqrt(1 + (omega/wt)^2)",
        source: "P. J. Carreau, Trans. Soc. Rheol. 16 (1972) 99, with n = 0",
        experiment: "A wide release watched until rest: small swings lose a share of their amplitude, wide ones the same angle.",
        parameters: &[
            Parameter {
                symbol: "Mt",
                unit: "N·m",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("torque that it approaches at high speed"),
            },
            Parameter {
                symbol: "wt",
                unit: "rad/s",
                low: 0.05,
                high: 10.0,
                start: 1.0,
                meaning: prose!("speed at which it has reached 71 %"),
            },
        ],
        starts: &[[0.0, 1.0, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0]],
        family: Family::Speed,
        generalises: None,
        is_fine: false,
        rules: Rules { is_left_to_diagnosis: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let ratio = motion.velocity_rad_s / values[1];
    -values[0] * ratio / (R::of(1.0) + ratio * ratio).sqrt()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn slow_motion_meets_a_viscous_torque_and_fast_motion_a_constant_one() {
        let torque = |velocity: f64| torque_at(&super::effect(), 0.3, velocity, &[1e-3, 0.5]);
        assert!((torque(1e-4) + 2e-7).abs() < 1e-13 && torque(0.0) == 0.0);
        assert!((torque(0.5) + 1e-3 / libm::sqrt(2.0)).abs() < 1e-15);
        assert!((torque(500.0) + 1e-3).abs() < 1e-9 && (torque(-500.0) - 1e-3).abs() < 1e-9);
    }
}
