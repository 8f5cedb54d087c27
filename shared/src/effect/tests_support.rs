//! Calls an effect's function at one instant, for the tests of the effects.

use super::{Action, Effect, MAX_VALUES};
use crate::motion::{Motion, Pendulum};
use crate::real::Real;

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
