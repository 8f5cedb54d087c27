//! Pre-sliding (Dahl): before it slides, the contact bends like a spring; friction builds up over a small angle.
//! Source: P. R. Dahl, A solid friction model, Aerospace Corp. TOR-0158 (1968).
//!
//! dz/dt = ω·(1 − (z/zc)·sgn ω), torque = −(Fd/zc)·z. Between two reversals z depends on the angle alone:
//! z = s·zc + (z₀ − s·zc)·exp(−|θ − θ₀|/zc). That exact form is used at every Runge–Kutta stage, so that a bristle of
//! any stiffness stays bounded by Fd, and as the update after the step.

use super::{Action, Effect, Family, MAX_VALUES, MEMORY, Memory, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 50,
        name: "presliding",
        summary: "The contact bends before it slips: after each reversal friction builds up over a small angle.",
        formula: "torque = -Fd*z/zc, dz/dt = omega*(1 - z/zc*sgn(omega))",
        source: "P. R. Dahl, A solid friction model, Aerospace Corp. TOR-0158 (1968)",
        experiment: "The last swings before rest, and pushing the resting pendulum by less than a degree.",
        parameters: &[
            Parameter {
                symbol: "Fd",
                unit: "N·m",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("friction torque once it slides"),
            },
            Parameter {
                symbol: "zc",
                unit: "rad",
                low: 1e-5,
                high: 0.2,
                start: 5e-3,
                meaning: prose!("angle over which friction builds up"),
            },
        ],
        starts: &[[0.0, 5e-3, 0.0, 0.0], [0.0, 5e-4, 0.0, 0.0], [0.0, 3e-2, 0.0, 0.0]],
        family: Family::Give,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::State(Memory { start, torque, advance }),
    }
}

/// Memory: the bristle's deflection z and the angle at which it had it, both in rad.
pub(super) fn start<R: Real>(motion: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; MEMORY] {
    [R::zero(), motion.angle_rad]
}

fn deflection<R: Real>(angle_rad: R, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> R {
    let [z_before, angle_before] = *memory;
    let path = angle_rad - angle_before;
    let limit = path.sign() * values[1];
    limit + (z_before - limit) * (-path.abs() / values[1]).exp()
}

fn torque<R: Real>(motion: &Motion<R>, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> R {
    -values[0] / values[1] * deflection(motion.angle_rad, memory, values)
}

fn advance<R: Real>(_: &Motion<R>, after: &Motion<R>, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> [R; MEMORY] {
    [deflection(after.angle_rad, memory, values), after.angle_rad]
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [f64; MAX_VALUES] = [1e-3, 2e-3, 0.0, 0.0];

    #[test]
    fn the_exact_update_does_not_depend_on_how_the_path_is_cut() {
        let whole = deflection(0.01, &[-1e-3, 0.0], &VALUES);
        let half = deflection(0.005, &[-1e-3, 0.0], &VALUES);
        assert!((deflection(0.01, &[half, 0.005], &VALUES) - whole).abs() < 1e-17);
    }

    #[test]
    fn friction_never_exceeds_its_limit_however_stiff() {
        let stiff = [1e-3, 1e-5, 0.0, 0.0];
        let z = deflection(1.0, &[0.0, 0.0], &stiff);
        assert!((z - 1e-5).abs() < 1e-18);
    }

    #[test]
    fn a_closed_loop_of_small_deflection_loses_no_energy_to_first_order() {
        let there = deflection(1e-6, &[0.0, 0.0], &VALUES);
        let back = deflection(0.0, &[there, 1e-6], &VALUES);
        assert!(back.abs() < 1e-9);
    }
}
