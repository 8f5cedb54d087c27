//! Resonant support: what holds the bearing moves sideways with a mass, a spring and a damping of its own, and the
//! pendulum shakes it.
//! Source: P. Hagedorn, D. Hochlenert, Technische Schwingungslehre (Harri Deutsch, 2012): the pendulum on an oscillator.
//!
//! M is all the mass that moves sideways, the pendulum's among it, x the support's way, J = m·l² + I:
//!
//! M·x″ + m·l·(sin θ)″ = −k·x − c·x′ and J·θ″ + m·l·cos θ·x″ = τ.
//!
//! In u = m·l·x/J + cs·sin θ with cs = (m·l)²/(M·J), k = M·ws² and c = 2·zs·ws·M no acceleration is left, and neither mass
//! nor length:
//!
//! u″ = −ws²·(u − cs·sin θ) − 2·zs·ws·(u′ − cs·ω·cos θ),
//!
//! θ″ = [τ/J − cos θ·(u″ + cs·ω²·sin θ)] / (1 − cs·cos² θ).
//!
//! While the bearing sticks, the support rings on, and the bearing has to hold against J·cos θ·u″. Far above the swing it
//! is [`super::pivot_compliance`] with ck = cs·J/(m·l·ws)².

use super::{Action, Effect, Family, MAX_VALUES, MEMORY, Parameter, Rules, Shake, Support};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 25,
        name: "resonant-support",
        summary: "The stand swings too: it has a mass and a frequency of its own, rings after each push and takes energy.",
        formula: "torque = -J*cos(theta)*y'', y'' + 2*zs*ws*y' + ws^2*y = -cs*(sin(theta))'', ws = rs*w0",
        source: "P. Hagedorn, D. Hochlenert, Technische Schwingungslehre (Harri Deutsch, 2012)",
        experiment: "A finger on the stand; a knock on it, and a phone's accelerometer there: it shows the frequency.",
        parameters: &[
            Parameter {
                symbol: "cs",
                unit: "1",
                low: 0.0,
                high: 0.95,
                start: 0.0,
                meaning: prose!("how strongly it is shaken: (m·l)²/(J·M), M all mass that moves sideways"),
            },
            Parameter {
                symbol: "rs",
                unit: "1",
                low: 1.5,
                high: 12.0,
                start: 2.8,
                meaning: prose!("frequency of the support, in those of small swings"),
            },
            Parameter {
                symbol: "zs",
                unit: "1",
                low: 0.0,
                high: 1.0,
                start: 0.05,
                meaning: prose!("damping ratio of the support"),
            },
            Parameter {
                symbol: "bs",
                unit: "1",
                low: -1.0,
                high: 2.0,
                start: 1.0,
                meaning: prose!("how much of the bend that the swing gives it the support has at the start"),
            },
        ],
        // Near three, where the swing's third harmonic shakes it, a resonance is seen from close by only.
        starts: &[
            [0.0, 2.8, 0.05, 1.0],
            [0.0, 2.5, 0.05, 1.0],
            [0.0, 3.2, 0.05, 1.0],
            [0.0, 4.5, 0.05, 1.0],
            [0.0, 7.0, 0.05, 1.0],
        ],
        family: Family::Give,
        generalises: Some("pivot-compliance"),
        is_fine: true,
        rules: Rules { is_left_to_diagnosis: true, ..Rules::NONE },
        action: Action::Support(Support { start, shake }),
    }
}

/// Memory: u and u′ in 1/s. The support bends as the swing pulls it, or by a part of that, and does not ring yet. What is not
/// bent was still until a release just before: the pendulum's pull has pushed it back since, so that no u′ is left of that part.
fn start<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> [R; MEMORY] {
    let (sine, cosine, omega) = (motion.angle_rad.sin(), motion.angle_rad.cos(), motion.velocity_rad_s);
    let natural = motion.pendulum.gravity_torque_nm() / motion.pendulum.pivot_inertia_kg_m2();
    let [coupling, times, _, share] = *values;
    // y = −(cs/ws²)·(sin θ)″ with θ″ = −ω₀²·sin θ.
    let gives = share * coupling / (times * times * natural);
    let bent = gives * sine * (natural * cosine + omega * omega);
    let twice = R::of(4.0) * cosine * cosine - R::of(3.0);
    let moves = gives * omega * (natural * twice + omega * omega * cosine);
    [bent + coupling * sine, moves + share * coupling * cosine * omega]
}

fn shake<R: Real>(motion: &Motion<R>, memory: &[R; MEMORY], values: &[R; MAX_VALUES]) -> Shake<R> {
    let (sine, cosine, omega) = (motion.angle_rad.sin(), motion.angle_rad.cos(), motion.velocity_rad_s);
    let inertia = motion.pendulum.pivot_inertia_kg_m2();
    let [coupling, times, damping, _] = *values;
    let frequency = times * (motion.pendulum.gravity_torque_nm() / inertia).sqrt();

    let [u, speed] = *memory;
    let bent = u - coupling * sine;
    let moves = speed - coupling * cosine * omega;
    let push = -frequency * (frequency * bent + (damping + damping) * moves);
    Shake {
        torque_nm: -inertia * cosine * (push + coupling * omega * omega * sine),
        share_held: R::one() - coupling * cosine * cosine,
        rate: [speed, push],
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support;
    use crate::model::Model;
    use crate::motion::Pendulum;
    use crate::parameters::Parameters;
    use std::vec::Vec;

    const PENDULUM: Pendulum<f64> =
        Pendulum { mass_kg: 0.15, length_m: 0.16, inertia_kg_m2: 2.7e-3, gravity_m_s2: 9.81 };
    const SHARE: f64 = 0.3;
    const TIMES: f64 = 3.3;
    const DAMPING: f64 = 0.05;

    /// How fast support and pendulum change: both bodies' equations, solved for their accelerations; the bearing rubs
    /// with a torque, or holds.
    fn slope([x, u, angle, omega]: [f64; 4], rubs_nm: Option<f64>) -> [f64; 4] {
        let Pendulum { mass_kg, length_m, .. } = PENDULUM;
        let (sine, cosine, moment) = (libm::sin(angle), libm::cos(angle), mass_kg * length_m);
        let natural = libm::sqrt(PENDULUM.gravity_torque_nm() / PENDULUM.pivot_inertia_kg_m2());
        let (all, frequency) = (mass_kg / SHARE, TIMES * natural);
        let force = moment * omega * omega * sine - all * frequency * (frequency * x + 2.0 * DAMPING * u);
        let Some(rubs_nm) = rubs_nm else { return [u, force / all, 0.0, 0.0] };
        let torque = rubs_nm - PENDULUM.gravity_torque_nm() * sine;
        let inertia = PENDULUM.pivot_inertia_kg_m2();
        let determinant = all * inertia - (moment * cosine) * (moment * cosine);
        let push = (force * inertia - moment * cosine * torque) / determinant;
        [u, push, omega, (all * torque - moment * cosine * force) / determinant]
    }

    const DT: f64 = 5e-5;

    fn stepped(y: [f64; 4], rubs_nm: Option<f64>, dt: f64) -> [f64; 4] {
        tests_support::stepped(|y| slope(y, rubs_nm), y, dt)
    }

    /// Angles every 5 ms of two bodies with dry friction: it slides until it turns, and slides on if what the bearing
    /// would have to hold is more than the friction.
    fn two_bodies(friction_nm: f64, mut y: [f64; 4], n: usize) -> Vec<f64> {
        let held_nm = |y: [f64; 4]| {
            let shaken = slope(y, None)[1];
            let moment = PENDULUM.mass_kg * PENDULUM.length_m;
            -PENDULUM.gravity_torque_nm() * libm::sin(y[2]) - moment * libm::cos(y[2]) * shaken
        };
        let mut direction = 0.0_f64;
        let mut next = || {
            let mut left_s = 5e-3;
            while left_s > 1e-9 {
                if direction == 0.0 && held_nm(y).abs() > friction_nm {
                    direction = held_nm(y).signum();
                }
                let rubs_nm = (direction != 0.0).then_some(-friction_nm * direction);
                let (before, mut step_s) = (y, DT.min(left_s));
                y = stepped(before, rubs_nm, step_s);
                if direction * y[3] < 0.0 && direction * before[3] > 0.0 {
                    // It turns where a straight line passes zero.
                    step_s *= before[3] / (before[3] - y[3]);
                    y = stepped(before, rubs_nm, step_s);
                    (direction, y[3]) = (0.0, 0.0);
                }
                left_s -= step_s;
            }
            y[2]
        };
        (0..n).map(|_| next()).collect()
    }

    fn ours(friction_nm: f64, start: f64, n: usize, steps: usize) -> (Vec<f64>, [f64; 4]) {
        let mut parameters = Parameters::frictionless(PENDULUM);
        parameters.set_friction(0.0, friction_nm, friction_nm, 0.0);
        let of_moment = PENDULUM.length_m * PENDULUM.length_m * PENDULUM.mass_kg / PENDULUM.pivot_inertia_kg_m2();
        parameters.set(25, &[SHARE * of_moment, TIMES, DAMPING, 0.3]).unwrap();
        let model = Model::new(&parameters);
        let mut state = model.release(start, 0.0);
        let way = |u: f64| u * PENDULUM.pivot_inertia_kg_m2() / (PENDULUM.mass_kg * PENDULUM.length_m);
        let [u, speed] = state.memories()[0].map(way);
        let begins = [u - SHARE * PENDULUM.length_m * libm::sin(start), speed, start, 0.0];
        let mut next = || {
            (0..steps).for_each(|_| model.step(&mut state, 5e-3 / steps as f64));
            state.angle_rad
        };
        ((0..n).map(|_| next()).collect(), begins)
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()))
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn it_moves_as_two_bodies_do_and_rings_on_while_the_bearing_sticks() {
        for friction_nm in [0.0, 2e-3, 2e-2] {
            let (angles, begins) = ours(friction_nm, 1.2, 2000, 5);
            let error = apart(&angles, &two_bodies(friction_nm, begins, 2000));
            // The two bodies turn to 0.05 ms, at 0.02 rad/s by then.
            assert!(error < 2e-6, "with {friction_nm} N·m: {error:e} rad");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn a_swing_that_is_seen_from_20_ms_after_its_release_on_rings_as_it_does() {
        // Support and pendulum are still until then.
        let mut y = [0.0, 0.0, 1.2, 0.0];
        (0..400).for_each(|_| y = stepped(y, Some(0.0), DT));
        let mut parameters = Parameters::frictionless(PENDULUM);
        let of_moment = PENDULUM.length_m * PENDULUM.length_m * PENDULUM.mass_kg / PENDULUM.pivot_inertia_kg_m2();
        let coupling = SHARE * of_moment;
        parameters.set(25, &[coupling, TIMES, DAMPING, 0.0]).unwrap();
        let model = Model::new(&parameters);
        let [u, speed] = model.release(y[2], y[3]).memories()[0];
        let seen = [y[0], y[1]].map(|way| way * PENDULUM.mass_kg * PENDULUM.length_m / PENDULUM.pivot_inertia_kg_m2());
        let (sine, cosine) = (libm::sin(y[2]), libm::cos(y[2]));
        let (bent, moves) = (u - coupling * sine, speed - coupling * cosine * y[3]);
        // Until the stand's own spring pulls, nothing pushes sideways, and its push is that of the pendulum to a few percent.
        assert!((moves - seen[1]).abs() < 0.05 * seen[1].abs(), "{moves} {seen:?}");
        let frequency = TIMES * libm::sqrt(PENDULUM.gravity_torque_nm() / PENDULUM.pivot_inertia_kg_m2());
        assert!((bent - seen[0]).abs() * frequency < 0.3 * seen[1].abs(), "{bent} {seen:?}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn steps_of_5_ms_follow_it() {
        let error = apart(&ours(2e-3, 1.2, 2000, 1).0, &ours(2e-3, 1.2, 2000, 50).0);
        assert!(error < 5e-5, "{error:e} rad");
    }
}
