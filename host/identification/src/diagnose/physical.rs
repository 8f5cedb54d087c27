//! Models that fit but mean nothing are refused.
//!
//! Friction takes energy out of the swing: it must not drive the pendulum anywhere on its way. And a spring relaxes
//! somewhere on that way, or where is known from how it changes along it: else it is a constant torque, which is what
//! asymmetric friction does.
//!
//! Effects that are added to Coulomb and viscous friction may be negative (less friction here than there), and each is
//! within its own range; only their sum tells whether the bearing still brakes.

use crate::fit::covariance::covariance;
use crate::fit::fitted::Fitted;
use crate::fit::problem::{Problem, Quantity, Unknown};
use crate::formula::effect_of;
use crate::verdict::NO_CHANCE_STDS;
use shared::effect::{Action, Effect, MAX_VALUES, Memory};
use shared::formula::Program;
use shared::motion::Motion;
use shared::parameters::{Parameters, base};
use std::f64::consts::TAU;

/// Friction may be negative by this share of its largest value: the numbers have uncertainties.
const TOLERANCE: f64 = 0.05;

/// Angles looked at on either side, and speeds at each.
const N_GRID: i32 = 6;

/// Does friction brake everywhere on the way, and does a spring relax somewhere?
pub fn is_sound(problem: &Problem, model: &Fitted) -> bool {
    let amplitude_rad = problem.largest_rad();
    relaxes(problem, model, amplitude_rad) && brakes_everywhere(problem, model, amplitude_rad)
}

fn relaxes(problem: &Problem, model: &Fitted, amplitude_rad: f64) -> bool {
    let is_known = |effect: &Effect<f64>| {
        let Some(index) = effect.rules.relaxes_at.map(usize::from) else { return true };
        let angle_rad = model.parameters.values(effect.id).and_then(|values| values.get(index).copied());
        angle_rad.is_none_or(|angle| angle.abs() < amplitude_rad || is_sure(problem, model, effect.id, index))
    };
    model.effects.iter().all(|effect| is_known(effect))
}

/// Is a number of an effect far from zero by its own uncertainty, and within its bounds?
fn is_sure(problem: &Problem, model: &Fitted, id: u16, index: usize) -> bool {
    let is_it = |unknown: &Unknown| unknown.quantity == Quantity::Effect { id, index };
    let Some(column) = model.unknowns.iter().position(is_it) else { return false };
    let (unknown, value) = (&model.unknowns[column], model.unknowns[column].get(&model.parameters));
    let std = covariance(&model.linearised(problem)).and_then(|known| known.std(column));
    !unknown.is_at_end(&model.parameters) && std.is_some_and(|std| value.abs() > NO_CHANCE_STDS * std)
}

/// Does friction brake everywhere on the way? Dry friction, which is all there is at low speed, must not hide behind
/// the drag of high speeds.
fn brakes_everywhere(problem: &Problem, model: &Fitted, amplitude_rad: f64) -> bool {
    let (longest_s, slow) = (problem.longest_s(), [-0.02, 0.02]);
    let begins = [0.0, 0.3 * longest_s];
    let brakes = |times_s: &[f64], shares: &[f64]| brakes_at(model, amplitude_rad, times_s, shares);
    // In the end the swings are small, and slow.
    brakes(&begins, &[-1.0, -0.5, 0.5, 1.0]) && brakes(&begins, &slow) && brakes(&[0.0, longest_s], &slow)
}

/// The same at these times, and at these shares of the speed that the pendulum may have at each place.
fn brakes_at(model: &Fitted, amplitude_rad: f64, times_s: &[f64], shares: &[f64]) -> bool {
    let pendulum = model.parameters.pendulum;
    let natural = (pendulum.gravity_torque_nm() / pendulum.pivot_inertia_kg_m2()).sqrt();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for &time_s in times_s {
        for place in -N_GRID..=N_GRID {
            let angle_rad = 0.9 * amplitude_rad * f64::from(place) / f64::from(N_GRID);
            let fastest = natural * (amplitude_rad.powi(2) - angle_rad.powi(2)).sqrt();
            for share in shares {
                let velocity_rad_s = share * fastest;
                let motion = Motion { angle_rad, velocity_rad_s, direction: share.signum(), time_s, pendulum };
                let braking = -friction_nm(&model.parameters, &motion) * share.signum();
                least = least.min(braking);
                most = most.max(braking);
            }
        }
    }
    least >= -TOLERANCE * most
}

fn friction_nm(parameters: &Parameters<f64>, motion: &Motion<f64>) -> f64 {
    let base_value = |id| parameters.values(id).map_or(0.0, |values| values[0]);
    let base_nm = base_value(base::VISCOUS) * motion.velocity_rad_s + base_value(base::COULOMB) * motion.direction;
    let added = parameters.effects.iter().filter_map(|present| {
        let values: [f64; MAX_VALUES] = std::array::from_fn(|i| present.values.get(i).copied().unwrap_or(0.0));
        match effect_of(parameters, present.id)?.action {
            Action::Friction(torque) => Some(torque(motion, &values)),
            Action::State(memory) => Some(sliding_nm(&memory, motion, &values)),
            Action::Formula(formula) => Some(typed_friction_nm(&Program::new(formula), motion, &values)),
            _ => None,
        }
    });
    added.sum::<f64>() - base_nm
}

/// What a typed torque takes on the way there and back at one place. What is the same in both directions, as the pull of what
/// turns with the pendulum is, gives back on the one way what it takes on the other, and is no friction.
fn typed_friction_nm(program: &Program<f64>, motion: &Motion<f64>, values: &[f64; MAX_VALUES]) -> f64 {
    let back = Motion { velocity_rad_s: -motion.velocity_rad_s, direction: -motion.direction, ..*motion };
    0.5 * (program.friction_nm(motion, values) - program.friction_nm(&back, values))
}

/// The friction of a contact that has slid for a turn.
fn sliding_nm(memory: &Memory<f64>, motion: &Motion<f64>, values: &[f64; MAX_VALUES]) -> f64 {
    let before = Motion { angle_rad: motion.angle_rad - motion.direction * TAU, ..*motion };
    let built_up = (memory.advance)(&before, motion, &(memory.start)(&before, values), values);
    (memory.torque)(motion, &built_up, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::start;
    use crate::fit::tally::Tally;
    use crate::formula;
    use crate::swing::Swing;

    /// The frictionless rig with a drag on a swing of 1 rad.
    fn with_drag(strength: f64, ask: impl Fn(&Problem, &Fitted) -> bool) -> bool {
        let count = Tally::default();
        let times_s: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        let swings = [Swing::new("one", &times_s, &times_s.iter().map(|t| (6.0 * t).cos()).collect::<Vec<_>>(), 1e-4)];
        let mut rig = Parameters::frictionless(Parameters::paper().pendulum);
        rig.set_friction(0.0, 0.0, 0.0, 0.0);
        rig.set(Effect::<f64>::by_name("quadratic-drag").unwrap().id, &[strength]).unwrap();
        let problem = problem_of(&swings, &rig, &count);
        let point = Point { values: problem.template_values(), starts: start::starts(&swings) };
        ask(&problem, &Fitted { parameters: rig.clone(), ..Fitted::at(&problem, &point) })
    }

    /// A spring of the paper's rig that relaxes beyond its swing of 1.4 rad, as what is left of it is known.
    #[test]
    fn a_spring_that_relaxes_beyond_the_swing_is_one_if_that_angle_is_known() {
        let spring = effect("torsional-spring");
        let is_sound_with = |stiffness: f64, relaxed_rad: f64| {
            let (mut truth, count) = (rig(), Tally::default());
            truth.set(spring.id, &[stiffness, relaxed_rad]).unwrap();
            let swings = [simulated("spring", &truth, 12.0, 3)];
            let model = fitted(&problem_of(&swings, &truth, &count), &truth);
            is_sound(&problem_of(&swings, &truth, &count), &Fitted { effects: vec![spring], ..model })
        };
        assert!(is_sound_with(0.02, 1.8));
        // So weak that it is a constant torque, if it is anything.
        assert!(!is_sound_with(2e-5, 1.8) && is_sound_with(2e-5, 1.0));
    }

    /// Without any friction beside it.
    #[test]
    fn bristles_may_carry_all_friction() {
        assert!(with_drag(0.0, |problem, model| {
            let mut model = model.clone();
            let bristles = Effect::<f64>::by_name("presliding").unwrap();
            model.parameters.set(bristles.id, &[1e-3, 2e-3]).unwrap();
            let motion = |velocity_rad_s: f64| Motion {
                angle_rad: 0.3,
                velocity_rad_s,
                direction: velocity_rad_s.signum(),
                time_s: 0.0,
                pendulum: model.parameters.pendulum,
            };
            let slides = |velocity: f64| (friction_nm(&model.parameters, &motion(velocity)).abs() - 1e-3).abs() < 1e-12;
            slides(2.0) && slides(-0.01) && is_sound(problem, &model)
        }));
    }

    #[test]
    fn a_drag_brakes_with_its_square_and_one_that_drives_is_refused() {
        let is_square = |_: &Problem, model: &Fitted| {
            let pendulum = model.parameters.pendulum;
            let motion = |velocity_rad_s: f64| Motion {
                angle_rad: 0.3,
                velocity_rad_s,
                direction: velocity_rad_s.signum(),
                time_s: 0.0,
                pendulum,
            };
            let torque = |velocity: f64| friction_nm(&model.parameters, &motion(velocity));
            (torque(3.0) + 9.0 * 2e-4).abs() < 1e-12 && (torque(-3.0) - 9.0 * 2e-4).abs() < 1e-12
        };
        assert!(with_drag(2e-4, is_square));
        // Without any dry friction the slowest have next to none, which is no driving.
        assert!(with_drag(2e-4, is_sound));
        let reversed = |problem: &Problem, model: &Fitted| {
            let mut model = model.clone();
            let drag = Effect::<f64>::by_name("quadratic-drag").unwrap();
            model.parameters.effects.iter_mut().filter(|present| present.id == drag.id).for_each(|present| {
                present.values[0] = -present.values[0];
            });
            is_sound(problem, &model)
        };
        assert!(!with_drag(2e-4, reversed));
    }

    #[test]
    fn a_typed_torque_that_is_the_same_there_and_back_drives_nothing() {
        let is_sound_with = |text: &str| {
            with_drag(0.0, |problem, model| {
                let mut model = model.clone();
                formula::add(&mut model.parameters, formula::read(text).unwrap(), &[1e-3]).unwrap();
                is_sound(problem, &model)
            })
        };
        // A string that stretches; air; and a motor.
        assert!(is_sound_with("torque = k*sin(theta)*(9.81*(cos(theta) - 1) + 7*omega^2); k in 0..0.1"));
        assert!(is_sound_with("torque = -k*omega*abs(omega); k in 0..0.1"));
        assert!(!is_sound_with("torque = k*omega; k in 0..0.1"));
    }

    #[test]
    fn friction_that_would_drive_the_pendulum_before_the_swing_ends_is_none() {
        let fading_by = |rate_nm_s: f64| {
            with_drag(0.0, |problem, model| {
                let mut model = model.clone();
                model.parameters.set_friction(0.0, 1e-3, 0.0, 0.0);
                let drift = Effect::<f64>::by_name("drifting-friction").unwrap();
                model.parameters.set(drift.id, &[-rate_nm_s, 0.0, 300.0]).unwrap();
                is_sound(problem, &model)
            })
        };
        // 1 mN·m, of which half and twice are gone after the two seconds of the swing.
        assert_eq!([fading_by(2.5e-4), fading_by(1e-3)], [true, false]);
    }
}
