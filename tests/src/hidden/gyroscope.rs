//! A phone on the pendulum: what its gyroscope writes, in the dress of phyphox.

use super::{LONGEST_S, Plant, REST_S, Random, Rig};

/// A gyroscope about the shaft.
#[derive(Clone, Copy, Debug)]
pub struct Gyroscope {
    /// Reading per true rate.
    pub scale: f64,
    /// Reading at rest, rad/s.
    pub bias_rad_s: f64,
    /// White noise, rad/s.
    pub noise_rad_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
}

impl Gyroscope {
    /// The file of one release, from before it until rest; `per_rad` and `unit` of the rates. The bias wanders where the
    /// rig hides a drift of its zero, by so many rad/s a second.
    pub fn file(&self, rig: &Rig, release_idx: usize, unit: &str, per_rad: f64) -> String {
        let mut random = Random::new(rig.seed ^ (0x2222 * (release_idx as u64 + 1)));
        let release_s = random.between(0.5, 1.0);
        let mut plant = Plant::release(rig, rig.releases_rad[release_idx]);
        let mut text = format!(
            "\"Time (s)\",\"Gyroscope x ({unit})\",\"Gyroscope y ({unit})\",\"Gyroscope z ({unit})\",\"Absolute ({unit})\"\n"
        );
        let drift = rig.hidden("zero-drift").map_or(0.0, |hidden| hidden.size);
        let (mut time_s, mut rest_s, mut n_samples) = (-release_s, 0.0, 0_u32);
        while rest_s < REST_S && time_s < LONGEST_S {
            let rate = if time_s < 0.0 { 0.0 } else { plant.motion().0[1] };
            let bias_rad_s = self.bias_rad_s + drift * time_s;
            let mut read = |rate: f64| (self.scale * rate + bias_rad_s + self.noise_rad_s * random.normal()) * per_rad;
            let axes = [read(0.0), read(0.0), read(rate)];
            let size = axes.iter().map(|axis| axis * axis).sum::<f64>().sqrt();
            let [x, y, z] = axes;
            text += &format!("{:.9E},{x:.9E},{y:.9E},{z:.9E},{size:.9E}\n", f64::from(n_samples) / self.rate_hz);
            n_samples += 1;
            let next_s = f64::from(n_samples) / self.rate_hz - release_s;
            advance(&mut plant, next_s - time_s.max(0.0));
            rest_s = if time_s > 0.0 && plant.rests() { rest_s + next_s - time_s } else { 0.0 };
            time_s = next_s;
        }
        text
    }
}

fn advance(plant: &mut Plant, seconds: f64) {
    let n_steps = plant.n_steps(seconds);
    (0..n_steps).for_each(|_| plant.advance(seconds / n_steps as f64));
}
