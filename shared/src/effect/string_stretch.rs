//! String stretch: what the bob hangs on is pulled longer where it swings fast, and is shorter where it turns.
//! Source: M. G. Olsson, Am. J. Phys. 44 (1976) 1211: the swinging spring; here with a spring so stiff that it does not swing itself.
//!
//! Derivation, to first order in the strain s = m·g/(k·l) of the string at rest. It is longer than at rest by
//! l·s·(cos θ − 1 + ω²/ω₀²), ω₀² = g/l, and the angle follows r·dω/dt = −g·sin θ − 2·ω·dr/dt. With dω/dt = −ω₀²·sin θ in
//! what is small, dr/dt = −3·l·s·ω·sin θ, so that
//! dω/dt = −ω₀²·sin θ·(1 − s·(cos θ − 1 + 7·ω²/ω₀²)).
//! For a body that is no point the seven is larger, eight for a rod, and all of it smaller: so the geometry is not asked for.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 41,
        name: "string-stretch",
        summary: "A string gives way to the pull of the bob, which is largest where it is fastest.",
        formula: "torque = st*m*g*l*sin(theta)*(cos(theta) - 1 + 7*(omega/w0)^2)",
        source: "M. G. Olsson, Am. J. Phys. 44 (1976) 1211",
        experiment: "Period against amplitude; and the length of the string with the bob on it and without.",
        parameters: &[Parameter {
            symbol: "st",
            unit: "1",
            low: 0.0,
            high: 0.1,
            start: 0.0,
            meaning: prose!("by what share of its length it is stretched at rest"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Give,
        generalises: None,
        is_fine: false,
        rules: Rules { is_left_to_diagnosis: true, ..Rules::NONE },
        action: Action::Drive(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let (gravity, inertia) = (motion.pendulum.gravity_torque_nm(), motion.pendulum.pivot_inertia_kg_m2());
    let share = motion.velocity_rad_s * motion.velocity_rad_s * inertia / gravity;
    let longer = motion.angle_rad.cos() - R::one() + R::of(7.0) * share;
    values[0] * gravity * motion.angle_rad.sin() * longer
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::{angles_of_two_bodies, angles_with, apart, torque_at};
    use crate::motion::Pendulum;
    use std::vec::Vec;

    const L: f64 = 0.8;
    const G: f64 = 9.81;
    const STRAIN: f64 = 2e-4;

    /// The angle at some times of a bob on a spring along the string, damped a little.
    fn on_a_spring(strain: f64, start: f64, times: &[f64]) -> Vec<f64> {
        // r'' = r·ω² + g·cos θ − K·(r − l) − g − d·r', r·dω/dt = −g·sin θ − 2·r'·ω, with K = k/m = g/(strain·l)
        let stiffness = G / (strain * L);
        let damping = 0.1 * libm::sqrt(stiffness);
        let slope = |[way, speed, angle, omega]: [f64; 4]| {
            let r = L + way;
            let push = r * omega * omega + G * (libm::cos(angle) - 1.0) - stiffness * way - damping * speed;
            [speed, push, omega, (-G * libm::sin(angle) - 2.0 * speed * omega) / r]
        };
        angles_of_two_bodies(slope, [strain * L * (libm::cos(start) - 1.0), 0.0, start, 0.0], 1e-4, times)
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn it_agrees_with_a_spring_that_carries_the_bob() {
        let times: Vec<f64> = (1..=60).map(|i| 0.1 * f64::from(i)).collect();
        let pendulum = Pendulum { mass_kg: 0.1, length_m: L, inertia_kg_m2: 0.0, gravity_m_s2: G };
        for start in [0.3, 0.8, 1.2] {
            let with = |strain: f64| angles_with(&super::effect(), &[strain], pendulum, start, &times);
            let (rigid, ours, theirs) = (with(0.0), with(STRAIN), on_a_spring(STRAIN, start, &times));
            let (effect, error) = (apart(&rigid, &theirs), apart(&ours, &theirs));
            assert!(error < 0.02 * effect, "from {start}: effect {effect:e}, error {error:e}");
        }
    }

    #[test]
    fn it_weakens_gravity_where_it_is_fast_and_strengthens_it_where_it_turns() {
        let torque = |angle: f64, velocity: f64| torque_at(&super::effect(), angle, velocity, &[1e-2]);
        assert!(torque(0.5, 0.0) < 0.0 && torque(-0.5, 0.0) > 0.0);
        assert!(torque(0.1, 8.0) > 0.0 && torque(-0.1, -8.0) < 0.0);
    }
}
