//! Zero drift: the sensor's zero moves evenly as time goes by; an integrated gyroscope, a track that warms up, a hub that
//! slips.
//! Source: JCGM 200:2012 (vocabulary of metrology), 4.21: instrumental drift.
//!
//! Time counts from the release, so that the zero there is the offset of that swing: nobody knows when a rig that streams
//! for hours was at its zero, and an observer's time begins anew wherever the pendulum hangs or is held. A gyroscope's own
//! bias drifts alike: of rates the drift is in rad/s each second.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 35,
        name: "zero-drift",
        summary: "The sensor's zero wanders: an integrated gyroscope, a potentiometer that warms up, a hub that slips.",
        formula: "reading = theta + dz*t",
        source: "JCGM 200:2012 (vocabulary of metrology), 4.21: instrumental drift",
        experiment: "The hanging pendulum, before the release and a minute after it has come to rest.",
        parameters: &[Parameter {
            symbol: "dz",
            unit: "rad/s",
            low: -0.1,
            high: 0.1,
            start: 0.0,
            meaning: prose!("change of the zero in a second"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Reading,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Sensor(Sensor { start, read }),
    }
}

fn start<R: Real>(_: R, _: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [R::zero(); SENSOR_MEMORY]
}

fn read<R: Real>(reading_rad: R, motion: &Motion<R>, _: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    reading_rad + values[0] * motion.time_s
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::motion_at;

    #[test]
    fn the_zero_moves_evenly_from_the_release_on() {
        let read = |angle: f64, time: f64| {
            let values = [0.5, 0.0, 0.0, 0.0];
            super::read(angle, &motion_at(angle, 1.0, time), &mut [0.0; 3], &values)
        };
        assert_eq!([read(0.25, 0.0), read(0.25, 2.0), read(-0.25, 4.0)], [0.25, 1.25, 1.75]);
    }
}
