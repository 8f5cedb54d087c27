//! An effect of the list for which the independent plant has no law of its own: the list's law is hidden instead, at one
//! of its own starts. So a new effect is looked for on the day it is added; a law of one's own, written from the source
//! again, is the better test and takes its place by a line in [`super::Hidden::random`] and in the plant.

use super::{Hidden, Random, Rig};
use shared::effect::{Action, Effect, MAX_VALUES, MEMORY, SENSOR_MEMORY};
use shared::motion::{Motion, Pendulum};

/// The strength to begin with, as a share of its range; what is wanted of it is found by scaling.
const SHARE_OF_RANGE: f64 = 0.02;

/// The form of an effect that is only known from the list.
pub(super) fn form(name: &str, random: &mut Random) -> (f64, [f64; 2], f64) {
    let effect = Effect::<f64>::by_name(name).unwrap_or_else(|| panic!("{name} is no effect of the list"));
    let strength = &effect.parameters[0];
    let sign = if strength.low < 0.0 { random.sign() } else { 1.0 };
    let start = effect.starts[random.between(0.0, effect.starts.len() as f64) as usize % effect.starts.len()];
    let largest = if sign < 0.0 { -strength.low } else { strength.high };
    (sign * SHARE_OF_RANGE * (strength.high - strength.low), [start[1], start[2]], largest)
}

/// The effects of a rig that act by the list's laws.
pub(super) struct Listed {
    laws: Vec<Law>,
    pendulum: Pendulum<f64>,
}

struct Law {
    action: Action<f64>,
    values: [f64; MAX_VALUES],
    memory: [f64; MEMORY],
    sensor: [f64; SENSOR_MEMORY],
}

impl Listed {
    /// On a pendulum that is held still at an angle.
    pub(super) fn held(rig: &Rig, angle_rad: f64) -> Self {
        let pendulum = Pendulum {
            mass_kg: rig.mass_kg,
            length_m: rig.length_m,
            inertia_kg_m2: rig.inertia_kg_m2,
            gravity_m_s2: rig.gravity_m_s2,
        };
        let mut listed = Self { laws: Vec::new(), pendulum };
        let still = listed.motion([angle_rad, 0.0], 0.0, 0.0);
        let law = |hidden: &Hidden| {
            let effect = Effect::<f64>::by_name(hidden.name)?;
            let [second, third] = hidden.shape;
            let values = [hidden.size, second, third, effect.starts[0][3]];
            let (mut memory, mut sensor) = ([0.0; MEMORY], [0.0; SENSOR_MEMORY]);
            match effect.action {
                Action::State(law) => memory = (law.start)(&still, &values),
                Action::Sensor(law) => sensor = (law.start)(angle_rad, &still, &values),
                _ => {}
            }
            Some(Law { action: effect.action, values, memory, sensor })
        };
        let laws: Vec<Law> = rig.hidden.iter().filter(|hidden| hidden.is_listed).filter_map(law).collect();
        listed.laws = laws;
        listed
    }

    fn motion(&self, [angle_rad, velocity_rad_s]: [f64; 2], direction: f64, time_s: f64) -> Motion<f64> {
        Motion { angle_rad, velocity_rad_s, direction, time_s, pendulum: self.pendulum }
    }

    /// What acts at rest too, N·m.
    pub(super) fn drive_nm(&self, at: [f64; 2], time_s: f64) -> f64 {
        if self.laws.is_empty() {
            return 0.0;
        }
        let motion = self.motion(at, 0.0, time_s);
        let torque = |law: &Law| match law.action {
            Action::Drive(torque) => torque(&motion, &law.values),
            Action::State(state) => (state.torque)(&motion, &law.memory, &law.values),
            _ => 0.0,
        };
        self.laws.iter().map(torque).sum()
    }

    /// What acts while sliding, N·m.
    pub(super) fn friction_nm(&self, at: [f64; 2], direction: f64, time_s: f64) -> f64 {
        if self.laws.is_empty() {
            return 0.0;
        }
        let motion = self.motion(at, direction, time_s);
        let torque = |law: &Law| match law.action {
            Action::Friction(torque) => torque(&motion, &law.values),
            _ => 0.0,
        };
        self.laws.iter().map(torque).sum()
    }

    /// Torques with a memory go on from one instant to another.
    pub(super) fn advance(&mut self, from: ([f64; 2], f64), to: ([f64; 2], f64), direction: f64) {
        if self.laws.is_empty() {
            return;
        }
        let (before, after) = (self.motion(from.0, direction, from.1), self.motion(to.0, direction, to.1));
        for law in &mut self.laws {
            if let Action::State(state) = law.action {
                law.memory = (state.advance)(&before, &after, &law.memory, &law.values);
            }
        }
    }

    /// What the sensor makes of a reading, rad.
    pub(super) fn read(&mut self, reading_rad: f64, at: [f64; 2], time_s: f64) -> f64 {
        if self.laws.is_empty() {
            return reading_rad;
        }
        let motion = self.motion(at, if at[1] == 0.0 { 0.0 } else { at[1].signum() }, time_s);
        self.laws.iter_mut().fold(reading_rad, |reading, law| match law.action {
            Action::Sensor(sensor) => (sensor.read)(reading, &motion, &mut law.sensor, &law.values),
            _ => reading,
        })
    }
}
