//! From the shaft's angle to a code: play, a centre beside the axis, an uneven characteristic, gain, zero, lag, drift,
//! noise, steps.

use super::listed::Listed;
use super::{Random, Rig, Shapes};
use std::collections::VecDeque;

/// The measuring chain of one recording.
pub(super) struct Sensor {
    play_rad: f64,
    gain: f64,
    bend: [f64; 2],
    /// Size and phase of the error once and twice a turn, rad.
    harmonics: [[f64; 2]; 2],
    offset_rad: f64,
    lag_s: f64,
    drift_rad_s: f64,
    wiper_rad: f64,
    before_rad: f64,
    lagging_rad: f64,
    shutter: Shutter,
    shapes: Shapes,
    listed: Listed,
    reading_rad: f64,
}

impl Sensor {
    /// On a pendulum that is held still at an angle.
    pub(super) fn held(rig: &Rig, angle_rad: f64) -> Self {
        let size = |name: &str| rig.hidden(name).map_or(0.0, |hidden| hidden.size);
        let uneven = rig.hidden("sensor-nonlinearity").map_or([0.0; 3], |h| [h.size, h.shape[0], h.shape[1]]);
        let place = rig.hidden("backlash").map_or(0.0, |hidden| hidden.shape[0]);
        let play_rad = size("backlash");
        let mut sensor = Self {
            play_rad,
            gain: 1.0 + size("sensor-gain") + uneven[0] * GAIN_OF_UNEVENNESS,
            bend: [uneven[0] * uneven[1], uneven[0] * uneven[2]],
            harmonics: ["eccentric-sensor", "misaligned-sensor"]
                .map(|name| rig.hidden(name).map_or([0.0; 2], |hidden| [hidden.size, hidden.shape[0]])),
            offset_rad: rig.offset_rad + size("angle-offset"),
            lag_s: size("sensor-lag"),
            drift_rad_s: size("zero-drift"),
            wiper_rad: angle_rad + 0.5 * play_rad * place,
            before_rad: 0.0,
            lagging_rad: 0.0,
            shutter: Shutter::new(size("rolling-shutter"), angle_rad),
            shapes: Shapes::of(rig),
            listed: Listed::held(rig, angle_rad),
            reading_rad: 0.0,
        };
        sensor.before_rad = sensor.undelayed(angle_rad);
        sensor.lagging_rad = sensor.before_rad;
        sensor.reading_rad = sensor.listed.read(sensor.lagging_rad, [angle_rad, 0.0], 0.0);
        sensor
    }

    fn undelayed(&mut self, angle_rad: f64) -> f64 {
        let half = 0.5 * self.play_rad;
        self.wiper_rad = self.wiper_rad.clamp(angle_rad - half, angle_rad + half);
        let x = self.wiper_rad + self.off_centre_rad(self.wiper_rad);
        x * self.gain + self.bend[0] * x * x + self.bend[1] * x * x * x + self.shapes.read_rad(x) + self.offset_rad
    }

    /// What a scale off its centre adds to an angle, rad.
    fn off_centre_rad(&self, angle: f64) -> f64 {
        let of_order = |order: f64, [size, phase]: [f64; 2]| match size {
            0.0 => 0.0,
            _ => size * ((order * angle - phase).sin() + phase.sin()),
        };
        of_order(1.0, self.harmonics[0]) + of_order(2.0, self.harmonics[1])
    }

    /// Follows the shaft for a short while.
    pub(super) fn follow(&mut self, (at, time_s): ([f64; 2], f64), seconds: f64) {
        let seen_rad = self.shutter.seen_rad(at[0], time_s);
        let now = self.undelayed(seen_rad);
        let middle = 0.5 * (now + self.before_rad);
        self.lagging_rad = match self.lag_s {
            0.0 => now,
            lag_s => middle + (self.lagging_rad - middle) * (-seconds / lag_s).exp(),
        };
        self.before_rad = now;
        self.reading_rad = self.listed.read(self.lagging_rad, at, time_s);
    }

    /// The reading in rad so long after the release, with noise and in steps of a converter. A zero that drifts did so
    /// before the release too.
    pub(super) fn read(&self, time_s: f64, step_rad: f64, noise_rad: f64, random: &mut Random) -> f64 {
        let reading_rad = self.reading_rad + self.drift_rad_s * time_s;
        ((reading_rad + noise_rad * random.normal()) / step_rad).round() * step_rad
    }
}

/// A camera that reads its picture line by line: where the bob is decides how long ago it was seen.
struct Shutter {
    /// Seconds a radian.
    delay: f64,
    /// Angles of the last tenths of a second, rad, and their times.
    past: VecDeque<(f64, f64)>,
}

impl Shutter {
    fn new(delay: f64, angle_rad: f64) -> Self {
        Self { delay, past: VecDeque::from([(f64::NEG_INFINITY, angle_rad)]) }
    }

    /// The angle at the instant at which its line was read. The first line is read when a picture begins.
    fn seen_rad(&mut self, angle_rad: f64, time_s: f64) -> f64 {
        if self.delay == 0.0 {
            return angle_rad;
        }
        self.past.push_back((time_s, angle_rad));
        let longest_s = 2.0 * self.delay.abs() * WIDEST_RAD;
        while self.past.len() > 2 && self.past[1].0 < time_s - longest_s {
            self.past.pop_front();
        }
        let is_seen = |(then_s, angle): &&(f64, f64)| time_s - then_s >= self.delay * angle + 0.5 * longest_s;
        self.past.iter().rev().find(is_seen).map_or(angle_rad, |(_, angle)| *angle)
    }
}

/// The picture ends at this angle on either side, rad.
const WIDEST_RAD: f64 = 2.0;

/// An uneven characteristic of size 1 has this much gain with it.
const GAIN_OF_UNEVENNESS: f64 = 0.05;
