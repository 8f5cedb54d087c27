//! The simulated bench: a pendulum, a hand that lifts it and lets go, a potentiometer with its converter, an encoder.

use super::Scenario;
use crate::random::Noise;
use shared::model::{Model, SensorState, State};
use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};
use shared::sensor::Sensor;
use shared::units::Code;

/// The pendulum hangs still for so long after the set-up.
const HANGS_S: f64 = 1.0;

/// Then a hand lifts it within this time.
const LIFTS_S: f64 = 1.5;

/// And holds it so long before it lets go.
const HOLDS_S: f64 = 1.0;

/// What happens to one pendulum.
pub(super) struct Bench {
    model: Model<f64>,
    state: State<f64>,
    sensor: SensorState<f64>,
    potentiometer: Potentiometer,
    noise: Noise,
    scenario: Scenario,
    n_set_ups: usize,
    since_set_up_s: f64,
    is_free: bool,
}

impl Bench {
    pub(super) fn new(scenario: &Scenario, seed: u64) -> Self {
        let model = Model::new(&scenario.true_parameters());
        let state = model.release(0.0, 0.0);
        let sensor = model.sensor_at_rest(&state);
        Self {
            model,
            state,
            sensor,
            potentiometer: Potentiometer::nominal(FULL_SCALE_12_BIT),
            noise: Noise::new(seed),
            scenario: *scenario,
            n_set_ups: 0,
            since_set_up_s: 0.0,
            is_free: false,
        }
    }

    /// Stops the pendulum; the next release angle is up.
    pub(super) fn set_up_next_swing(&mut self) {
        self.n_set_ups += 1;
        self.since_set_up_s = 0.0;
        self.is_free = false;
        self.state = self.model.release(0.0, 0.0);
        self.sensor = self.model.sensor_at_rest(&self.state);
    }

    /// Lets `dt_s` pass and gives what the sensor in use reads.
    pub(super) fn sample(&mut self, in_use: &Sensor, dt_s: f64) -> Code {
        self.advance(dt_s);
        let reading_rad = self.model.read(&self.state, &mut self.sensor);
        match in_use {
            Sensor::Potentiometer(_) => self.convert(reading_rad),
            other => self.step(other, reading_rad),
        }
    }

    /// The last of a sensor's steps that was passed; where the bench has no such sensor, none ever is.
    fn step(&self, in_use: &Sensor, reading_rad: f64) -> Code {
        let built_in = self.scenario.sensor.filter(|sensor| sensor.is_like(in_use));
        let line = built_in.unwrap_or(*in_use).at_power_up().line();
        let seen_rad = if built_in.is_some() { reading_rad } else { 0.0 };
        let passed = (seen_rad / f64::from(line.radian_per_code) + f64::from(line.zero_code)).floor();
        let span = in_use.span().map_or(f64::INFINITY, f64::from);
        Code(passed.rem_euclid(span) as u16)
    }

    fn convert(&mut self, reading_rad: f64) -> Code {
        let noise = self.scenario.noise_codes * self.noise.normal();
        if self.scenario.breaks_after_s.is_some_and(|breaks_s| self.since_set_up_s > breaks_s) {
            return Code(0);
        }
        let exact = reading_rad / f64::from(self.potentiometer.radian_per_code);
        let code = (exact + f64::from(self.potentiometer.zero_code) + noise).round();
        Code(code.clamp(0.0, f64::from(FULL_SCALE_12_BIT)) as u16)
    }

    fn advance(&mut self, dt_s: f64) {
        self.since_set_up_s += dt_s;
        if self.is_free {
            return self.model.step(&mut self.state, dt_s);
        }
        let lifted = ((self.since_set_up_s - HANGS_S) / LIFTS_S).clamp(0.0, 1.0);
        let angle_rad = self.release_rad() * smooth(lifted);
        self.state = self.model.release(angle_rad, 0.0);
        self.is_free = self.n_set_ups > 0 && self.since_set_up_s >= HANGS_S + LIFTS_S + HOLDS_S;
    }

    /// Before the first set-up nobody touches it.
    fn release_rad(&self) -> f64 {
        let releases = self.scenario.releases_rad;
        self.n_set_ups.checked_sub(1).map_or(0.0, |n_before| releases[n_before % releases.len()])
    }
}

/// From 0 to 1 with the least jerk, as a hand moves (Flash, Hogan, J. Neurosci. 5 (1985) 1688).
fn smooth(share: f64) -> f64 {
    share * share * share * (10.0 - 15.0 * share + 6.0 * share * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angles(scenario: &str, seconds: f64) -> Vec<f64> {
        let mut bench = Bench::new(Scenario::by_name(scenario).unwrap(), 1);
        bench.set_up_next_swing();
        (0..(seconds * 1000.0) as usize)
            .map(|_| {
                let code = bench.sample(&bench.potentiometer.into(), 1e-3);
                f64::from(bench.potentiometer.angle(code).0)
            })
            .collect()
    }

    #[test]
    fn the_pendulum_hangs_is_lifted_held_and_swings_to_rest() {
        let angles = angles("plain", 60.0);
        let near = |from: usize, to: usize, angle: f64| angles[from..to].iter().all(|a| (a - angle).abs() < 8e-3);
        assert!(near(0, 1000, 0.0) && near(2500, 3499, 1.5));
        let lowest = angles.iter().copied().fold(0.0, f64::min);
        assert!((-1.5..-1.3).contains(&lowest), "{lowest}");
        let end = angles[59_000];
        assert!(near(59_000, 60_000, end) && end.abs() < 0.02);
    }

    #[test]
    fn a_broken_wire_reads_zero() {
        let mut bench = Bench::new(Scenario::by_name("broken-wire").unwrap(), 1);
        assert_eq!(bench.sample(&bench.potentiometer.into(), 1e-3), Code(0));
    }
}
