//! Pivot compliance: the bearing's support gives way sideways like a spring, and the pendulum shakes it.
//! Source: R. A. Nelson, M. G. Olsson, Am. J. Phys. 54 (1986) 112: corrections for the motion of the support.
//!
//! Derivation, to first order in the compliance c. The bob pulls the support sideways by x = −c·m·l·d²(sin θ)/dt², and
//! the moving pivot turns the pendulum with −m·l·cos θ·d²x/dt². With dω/dt = −ω₀²·sin θ, ω₀² = m·g·l/(m·l² + I), the
//! chain rule gives
//! d⁴(sin θ)/dt⁴ = sin θ·(ω₀⁴·(1 − 4·sin²θ) + 11·ω₀²·ω²·cos θ + ω⁴).
//! The support is taken as stiff and light: its own resonance lies far above the swing.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 20,
        name: "pivot-compliance",
        summary: "The stand bends a little with every swing: the pivot follows the bob and slows the pendulum.",
        formula: "torque = ck*(m*l)^2*cos(theta)*sin(theta)*(w0^4*(1 - 4*sin(theta)^2) + 11*w0^2*omega^2*cos(theta) + omega^4)",
        source: "R. A. Nelson, M. G. Olsson, Am. J. Phys. 54 (1986) 112",
        experiment: "Period against amplitude up to large angles; and a finger on the stand.",
        parameters: &[Parameter {
            symbol: "ck",
            unit: "m/N",
            low: 0.0,
            high: 5e-3,
            start: 0.0,
            meaning: prose!("how far the support gives way per newton"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Give,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Drive(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let pendulum = &motion.pendulum;
    let moment = pendulum.mass_kg * pendulum.length_m;
    let natural = pendulum.gravity_torque_nm() / pendulum.pivot_inertia_kg_m2();
    let speed = motion.velocity_rad_s * motion.velocity_rad_s;
    let (sine, cosine) = (motion.angle_rad.sin(), motion.angle_rad.cos());
    let shape = natural * natural * (R::one() - R::of(4.0) * sine * sine)
        + R::of(11.0) * natural * speed * cosine
        + speed * speed;
    values[0] * moment * moment * cosine * sine * shape
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::{angles_of_two_bodies, angles_with, apart, torque_at};
    use crate::motion::Pendulum;

    const M: f64 = 0.15;
    const L: f64 = 0.16;
    const I: f64 = 2.7e-3;
    const G: f64 = 9.81;
    const COMPLIANCE: f64 = 2e-6;

    /// Position and velocity of support and pendulum; the support has next to no mass and is damped so that only its
    /// slow motion remains.
    fn two_degrees_of_freedom(compliance: f64, start: f64, times: &[f64]) -> std::vec::Vec<f64> {
        // m·l·(dω/dt·cos θ − ω²·sin θ) + m·x'' = −x/c − d·x', J·dω/dt + m·l·cos θ·x'' = −m·g·l·sin θ
        let damping = 2.0 * libm::sqrt(M / compliance) * 0.3;
        let slope = |y: [f64; 4]| {
            let [x, u, angle, omega] = y;
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let inertia = M * L * L + I;
            let force = -x / compliance - damping * u + M * L * omega * omega * sine;
            let torque = -M * G * L * sine;
            let determinant = M * inertia - (M * L * cosine) * (M * L * cosine);
            let push = (force * inertia - M * L * cosine * torque) / determinant;
            let turn = (M * torque - M * L * cosine * force) / determinant;
            [u, push, omega, turn]
        };
        let x0 = compliance * M * L * libm::cos(start) * libm::sin(start) * M * G * L / (M * L * L + I);
        angles_of_two_bodies(slope, [x0, 0.0, start, 0.0], 2e-5, times)
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn it_agrees_with_a_support_of_its_own_degree_of_freedom() {
        let times: std::vec::Vec<f64> = (1..=40).map(|i| 0.05 * f64::from(i)).collect();
        let pendulum = Pendulum { mass_kg: M, length_m: L, inertia_kg_m2: I, gravity_m_s2: G };
        for start in [0.3, 0.8, 1.4] {
            let with = |compliance: f64| angles_with(&super::effect(), &[compliance], pendulum, start, &times);
            let (rigid, ours) = (with(0.0), with(COMPLIANCE));
            let theirs = two_degrees_of_freedom(COMPLIANCE, start, &times);
            let (effect, error) = (apart(&rigid, &theirs), apart(&ours, &theirs));
            // What is left is the support ringing after the release, as the square root of the compliance.
            assert!(error < 0.02 * effect, "from {start}: effect {effect:e}, error {error:e}");
        }
    }

    #[test]
    fn it_weakens_gravity_for_small_swings() {
        let torque = |angle: f64| torque_at(&super::effect(), angle, 0.0, &[1e-4]);
        assert!(torque(0.1) > 0.0 && torque(-0.1) < 0.0);
    }
}
