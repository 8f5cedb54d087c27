//! For the tests of the effects: an effect's function at one instant, a pendulum with it, and two bodies to compare that with.

use super::{Action, Effect, MAX_VALUES};
use crate::model::Model;
use crate::motion::{Motion, Pendulum};
use crate::parameters::Parameters;
use crate::real::Real;
use std::vec::Vec;

pub(crate) fn motion_at(angle_rad: f64, velocity_rad_s: f64, time_s: f64) -> Motion<f64> {
    let pendulum = Pendulum { mass_kg: 0.15, length_m: 0.16, inertia_kg_m2: 2.7e-3, gravity_m_s2: 9.81 };
    Motion { angle_rad, velocity_rad_s, direction: velocity_rad_s.sign(), time_s, pendulum }
}

fn padded(values: &[f64]) -> [f64; MAX_VALUES] {
    core::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0))
}

pub(crate) fn torque_at(effect: &Effect<f64>, angle_rad: f64, velocity_rad_s: f64, values: &[f64]) -> f64 {
    torque_at_time(effect, angle_rad, velocity_rad_s, 0.0, values)
}

pub(crate) fn torque_at_time(
    effect: &Effect<f64>,
    angle_rad: f64,
    velocity_rad_s: f64,
    time_s: f64,
    values: &[f64],
) -> f64 {
    let motion = motion_at(angle_rad, velocity_rad_s, time_s);
    match effect.action {
        Action::Drive(torque) | Action::Friction(torque) => torque(&motion, &padded(values)),
        _ => panic!("{} has no torque of this instant alone", effect.name),
    }
}

pub(crate) fn reading_at(effect: &Effect<f64>, angle_rad: f64, velocity_rad_s: f64, values: &[f64]) -> f64 {
    let (motion, values) = (motion_at(angle_rad, velocity_rad_s, 0.0), padded(values));
    match effect.action {
        Action::Sensor(sensor) => {
            (sensor.read)(angle_rad, &motion, &mut (sensor.start)(angle_rad, &motion, &values), &values)
        }
        _ => panic!("{} is not a sensor effect", effect.name),
    }
}

/// Place and speed of what carries the pendulum, its angle and angular velocity; or how fast they change.
pub(crate) type TwoBodies = [f64; 4];

/// One Runge–Kutta step of so many seconds.
pub(crate) fn stepped(slope: impl Fn(TwoBodies) -> TwoBodies, y: TwoBodies, dt: f64) -> TwoBodies {
    let moved = |k: TwoBodies, h: f64| -> TwoBodies { core::array::from_fn(|i| y[i] + h * k[i]) };
    let k1 = slope(y);
    let k2 = slope(moved(k1, 0.5 * dt));
    let k3 = slope(moved(k2, 0.5 * dt));
    let k4 = slope(moved(k3, dt));
    core::array::from_fn(|i| y[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

/// The pendulum's angle (rad) at some times (s), in steps of so many seconds.
pub(crate) fn angles_of_two_bodies(
    slope: impl Fn(TwoBodies) -> TwoBodies,
    mut y: TwoBodies,
    dt: f64,
    times: &[f64],
) -> Vec<f64> {
    let mut time = 0.0;
    let until = |target: &f64| {
        while time < *target - 0.5 * dt {
            y = stepped(&slope, y, dt);
            time += dt;
        }
        y[2]
    };
    times.iter().map(until).collect()
}

/// The same of a pendulum without friction that has an effect, let go from an angle.
pub(crate) fn angles_with(
    effect: &Effect<f64>,
    values: &[f64],
    pendulum: Pendulum<f64>,
    start_rad: f64,
    times: &[f64],
) -> Vec<f64> {
    let mut parameters = Parameters::frictionless(pendulum);
    parameters.set(effect.id, values).unwrap();
    let model = Model::new(&parameters);
    let mut state = model.release(start_rad, 0.0);
    let until = |target: &f64| {
        while state.time_s < *target - 5e-4 {
            model.step(&mut state, 1e-3);
        }
        state.angle_rad
    };
    times.iter().map(until).collect()
}

/// The largest difference.
pub(crate) fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |worst, (a, b)| worst.max((a - b).abs()))
}
