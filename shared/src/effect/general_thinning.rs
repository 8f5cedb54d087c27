//! Shear thinning with an exponent of its own: grease that goes on resisting more, or a disc in a magnet's field, which
//! resists less beyond its critical speed.
//! Source: P. J. Carreau, Trans. Soc. Rheol. 16 (1972) 99, whose n is 1 − 2·q; with q = 1 it is the eddy-current brake of
//! J. H. Wouterse, IEE Proc. B 138 (1991) 153, whose torque is largest, Mtg/2, at its critical speed wtg.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 29,
        name: "general-thinning",
        summary: "Friction that goes on growing slowly with speed, as most greases have it, or falls again, as a disc brake's.",
        formula: "torque = -Mtg*(omega/wtg)*(1 + (omega/wtg)^2)^(-q)",
        source: "P. J. Carreau, Trans. Soc. Rheol. 16 (1972) 99: n = 1 - 2*q; J. H. Wouterse, IEE Proc. B 138 (1991) 153: q = 1",
        experiment: "A wide release watched until rest, and one that is wider still: the torque of the fastest part tells q.",
        parameters: &[
            Parameter {
                symbol: "Mtg",
                unit: "N·m",
                low: 0.0,
                high: 4e-2,
                start: 0.0,
                meaning: prose!("what its torque would be at the speed wtg without thinning"),
            },
            Parameter {
                symbol: "wtg",
                unit: "rad/s",
                low: 0.05,
                high: 10.0,
                start: 1.0,
                meaning: prose!("speed from which on it thins; of a disc brake, the critical one"),
            },
            Parameter {
                symbol: "q",
                unit: "1",
                low: 0.1,
                high: 1.5,
                start: 0.5,
                meaning: prose!("how much it thins: 0.5 to a constant torque, 1 a disc brake"),
            },
        ],
        starts: &[[0.0, 1.0, 0.5, 0.0], [0.0, 3.0, 1.0, 0.0]],
        family: Family::Speed,
        generalises: Some("shear-thinning"),
        is_fine: false,
        rules: Rules { special_case_at: Some((2, 0.5)), follows_special_case: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let ratio = motion.velocity_rad_s / values[1];
    -values[0] * ratio * (R::of(1.0) + ratio * ratio).powf(-values[2])
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn with_half_it_approaches_a_constant_and_with_one_it_is_a_disc_brake() {
        let usual = crate::effect::shear_thinning::effect::<f64>();
        for velocity in [-7.0, -0.1, 0.0, 0.7, 2.0] {
            let ours = |q: f64| torque_at(&super::effect(), 0.3, velocity, &[2e-3, 0.7, q]);
            assert!((ours(0.5) - torque_at(&usual, 0.3, velocity, &[2e-3, 0.7])).abs() < 1e-15);
            let disc = -2e-3 * 0.7 * velocity / (0.49 + velocity * velocity);
            assert!((ours(1.0) - disc).abs() < 1e-15);
        }
    }
}
