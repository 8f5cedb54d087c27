//! Pre-sliding with an exponent of its own (Dahl): how suddenly the contact gives way once it slips.
//! Source: P. R. Dahl, AIAA J. 14 (1976) 1675: brittle contacts have exponents below 1, ductile ones above.
//!
//! dz/dt = ω·(1 − (z/zc)·sgn ω)^i, torque = −(Fd/zc)·z. Between two reversals what is left to the limit, y = 1 − s·z/zc,
//! depends on the angle alone, in closed form: y = y₀·(1 + (i − 1)·y₀^(i−1)·|θ − θ₀|/zc)₊^(−1/(i − 1)).

use super::presliding::start;
use super::{Action, Effect, Family, MAX_VALUES, MEMORY, Memory, Parameter, Rules, q_exponential};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 51,
        name: "general-presliding",
        summary: "The contact bends before it slips, and gives way more suddenly, or more slowly, than the usual law has it.",
        formula: "torque = -Fdg*z/zcg, dz/dt = omega*(1 - z/zcg*sgn(omega))^iD",
        source: "P. R. Dahl, AIAA J. 14 (1976) 1675",
        experiment: "The last swings before rest, and pushing the resting pendulum by less than a degree.",
        parameters: &[
            Parameter {
                symbol: "Fdg",
                unit: "N·m",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("friction torque once it slides"),
            },
            Parameter {
                symbol: "zcg",
                unit: "rad",
                low: 1e-5,
                high: 0.2,
                start: 5e-3,
                meaning: prose!("angle over which friction builds up"),
            },
            Parameter {
                symbol: "iD",
                unit: "1",
                low: 0.25,
                high: 3.0,
                start: 1.0,
                meaning: prose!("below 1 the contact is brittle, above it ductile"),
            },
        ],
        starts: &[[0.0, 5e-3, 1.0, 0.0], [0.0, 5e-3, 0.5, 0.0], [0.0, 5e-3, 2.0, 0.0]],
        family: Family::Give,
        generalises: Some("presliding"),
        is_fine: false,
        rules: Rules { special_case_at: Some((2, 1.0)), follows_special_case: true, ..Rules::NONE },
        action: Action::State(Memory { start, torque, advance }),
    }
}

fn deflection<R: Real>(angle_rad: R, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> R {
    let [z_before, angle_before] = *memory;
    let path = angle_rad - angle_before;
    let side = R::select(path.lt(R::zero()), -R::one(), R::one());
    let left = (R::one() - side * z_before / values[1]).max(R::of(NEARLY_SLIDING));
    let exponent = values[2] - R::one();
    let way = left.powf(exponent) * path.abs() / values[1];
    side * values[1] * (R::one() - left * q_exponential(way, exponent))
}

/// A contact that slides already bends no further; as a share of its limit.
const NEARLY_SLIDING: f64 = 1e-9;

fn torque<R: Real>(motion: &Motion<R>, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> R {
    -values[0] / values[1] * deflection(motion.angle_rad, memory, values)
}

fn advance<R: Real>(_: &Motion<R>, after: &Motion<R>, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> [R; MEMORY] {
    [deflection(after.angle_rad, memory, values), after.angle_rad]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_exponent_one_it_is_the_usual_law() {
        let usual = crate::effect::presliding::effect::<f64>();
        let (Action::State(usual), Action::State(ours)) = (usual.action, effect::<f64>().action) else { panic!() };
        let motion = |angle: f64| crate::effect::tests_support::motion_at(angle, 1.0, 0.0);
        for (z, angle) in [(0.0, 1e-3), (-1e-3, 4e-3), (1.5e-3, -2e-4), (2e-3, 0.0)] {
            let both = [usual, ours].map(|law| (law.torque)(&motion(angle), &[z, 0.0], &[1e-3, 2e-3, 1.0, 0.0]));
            assert!((both[0] - both[1]).abs() < 1e-12, "{z} {angle} {both:?}");
        }
    }

    /// Of the differential equation, by small steps.
    #[test]
    fn brittle_and_ductile_contacts_follow_their_equation() {
        for exponent in [0.5, 2.0] {
            let values = [1e-3, 2e-3, exponent, 0.0];
            for (z_before, way) in [(0.0, 1e-3), (-1.8e-3, 3e-3), (1e-3, -5e-3)] {
                let (n_steps, side) = (200_000, libm::copysign(1.0, way));
                let step = way / f64::from(n_steps);
                let mut z: f64 = z_before;
                for _ in 0..n_steps {
                    let slope = |z: f64| libm::pow((1.0 - side * z / 2e-3).max(0.0), exponent);
                    z += step * slope(z + 0.5 * step * slope(z));
                }
                let ours = deflection(way, &[z_before, 0.0], &values);
                assert!((ours - z).abs() < 1e-8, "{exponent} {z_before} {way}: {ours} {z}");
            }
        }
    }

    #[test]
    fn the_exact_update_does_not_depend_on_how_the_path_is_cut() {
        for exponent in [0.25, 0.5, 1.0, 2.0, 3.0] {
            let values = [1e-3, 2e-3, exponent, 0.0];
            let whole = deflection(0.01, &[-1e-3, 0.0], &values);
            let half = deflection(0.005, &[-1e-3, 0.0], &values);
            assert!((deflection(0.01, &[half, 0.005], &values) - whole).abs() < 1e-11, "{exponent}");
        }
    }
}
