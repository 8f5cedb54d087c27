//! Simulated rigs with a hidden effect, for the diagnosis to find: random pendulums of the usual size, released several
//! times, recorded until rest by a noisy 12-bit converter.
//!
//! Plant and sensor are independent of the product: own integrator, own laws, own measuring chain. Only an effect that
//! has no law of its own there yet acts by the list's (`listed`).

mod gyroscope;
mod listed;
mod plant;
mod sensor;
mod shapes;

pub use gyroscope::Gyroscope;
pub use shapes::SHAPES;

use host::fit::identify::{Method, Options, fit};
use host::recording::Recording;
use host::swing::Swing;
use plant::Plant;
use sensor::Sensor;
use shapes::Shapes;
use shared::parameters::Parameters;

/// One step of 12 bits over 340°, rad.
pub const LSB_RAD: f64 = 340.0 * std::f64::consts::PI / 180.0 / 4096.0;

/// A hundred samples a second are enough to see how much a base model leaves.
const RATIO_RATE_HZ: f64 = 100.0;

/// At 15 rad/s the plant's steps of 0.2 ms follow no bristle that is shorter.
const STIFFEST_BRISTLE_RAD: f64 = 1.5e-3;

/// Recorded after the pendulum came to rest, s.
const REST_S: f64 = 1.0;

/// Between two losses of a clock lie so many seconds.
const BETWEEN_JUMPS_S: [f64; 2] = [1.0, 6.0];

/// No recording of a usual rig is longer, s.
const LONGEST_S: f64 = 70.0;

/// Uniform and normal numbers from a seed (SplitMix64, polar Gauss).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Equal seeds give equal numbers.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    /// Between two limits.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between two positive limits, every decade alike.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// One of several.
    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.between(0.0, of.len() as f64) as usize % of.len()]
    }

    /// +1 or −1.
    pub fn sign(&mut self) -> f64 {
        self.pick(&[-1.0, 1.0])
    }

    /// Mean 0, standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        loop {
            let (x, y) = (self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                return x * (-2.0 * square.ln() / square).sqrt();
            }
        }
    }
}

/// An effect that a rig has and its model does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hidden {
    /// As in the product's list; or a law that is not in it: one of [`SHAPES`], `outside`, a brake on either side of the
    /// path, or `bump`, friction that is higher about a certain speed.
    pub name: &'static str,
    /// How strong, in the unit of its first parameter.
    pub size: f64,
    /// Where, how wide, how steep: see [`Hidden::random`].
    pub shape: [f64; 2],
    /// A larger size would not be physical.
    pub largest: f64,
    /// Does it act by the list's law, because the independent plant has none?
    pub is_listed: bool,
}

/// A pendulum, its sensor, and how it was released.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// m, kg.
    pub mass_kg: f64,
    /// l, m.
    pub length_m: f64,
    /// I about the centre of mass, kg·m².
    pub inertia_kg_m2: f64,
    /// What the drawing says of it, kg·m².
    pub drawn_inertia_kg_m2: f64,
    /// g, with the air's lift taken off, m/s².
    pub gravity_m_s2: f64,
    /// Mw, N·m·s/rad.
    pub viscous: f64,
    /// Mc, N·m.
    pub coulomb_nm: f64,
    /// Ms, N·m.
    pub stiction_nm: f64,
    /// DV, rad/s; 0 for dry friction as a set.
    pub velocity_band: f64,
    /// Zero error of the sensor, rad.
    pub offset_rad: f64,
    /// Seconds of the recorder per second.
    pub clock: f64,
    /// What is hidden.
    pub hidden: Vec<Hidden>,
    /// White noise, rad.
    pub noise_rad: f64,
    /// Readings are taken so much too early or too late by chance, s.
    pub jitter_s: f64,
    /// The recorder's clock loses so much at random moments, some seconds apart, s.
    pub clock_jump_s: f64,
    /// Friction of every second release is larger by this share.
    pub friction_change: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// No recording is longer, s.
    pub longest_s: f64,
    /// Release angles, rad.
    pub releases_rad: Vec<f64>,
    /// For noise and the moments of release.
    pub seed: u64,
}

impl Hidden {
    /// An effect of the list with random shape and usual size on a rig with this dry friction (N·m); the rig's friction
    /// must stay positive, which bounds the size.
    pub fn random(name: &'static str, coulomb_nm: f64, random: &mut Random) -> Self {
        let sign = random.sign();
        let side = random.between(-0.8, 0.8);
        let phase = random.between(0.0, std::f64::consts::TAU);
        let own = match name {
            "quadratic-drag" => (6e-5, [0.0; 2], 1e-3),
            "power-law-drag" => (3e-5, [random.pick(&[1.6, 2.5, 3.0]), 0.0], 1e-3),
            "shear-thinning" => (6e-4, [random.log_between(0.3, 3.0), 0.0], 5e-3),
            "stribeck" => (4e-4, [random.log_between(0.15, 1.0), 0.0], 5e-3),
            "load-dependent-coulomb" => (8e-4, [0.0; 2], 3e-3),
            "gear-load" => (0.01, [0.0; 2], 0.3),
            "asymmetric-coulomb" => (sign * 2e-4, [0.0; 2], 0.7 * coulomb_nm),
            // No rig has less viscous friction than 3e-4.
            "asymmetric-viscous" => (sign * 1e-4, [0.0; 2], 2.5e-4),
            "angle-dependent-friction" => (2e-4, [random.pick(&[1.0, 2.0, 3.0, 4.0]), phase], 0.8 * coulomb_nm),
            "eddy-brake" => (5e-4, [side, random.log_between(0.08, 0.3)], 2e-2),
            "drifting-friction" => (
                sign * 0.3,
                [random.log_between(4.0, 30.0), random.pick(&[0.0, 1.0])],
                if sign < 0.0 { 0.7 } else { 3.0 },
            ),
            "torsional-spring" => (4e-3, [random.between(-0.1, 0.1), 0.0], 0.1),
            "detent" => (2e-4, [random.pick(&[4.0, 5.0, 6.0, 8.0, 12.0]), phase], 2e-3),
            // The resonance of a softer stand comes too near to the swing to be called a stand.
            "pivot-compliance" => (1e-3, [0.0; 2], 1.2e-3),
            // Its frequency in those of the swing.
            "resonant-support" => (0.02, [random.log_between(2.5, 10.0), 0.0], 0.8),
            "presliding" => (5e-3, [0.0; 2], 0.06),
            "backlash" => (6e-3, [random.between(-1.0, 1.0), 0.0], 0.05),
            "sensor-nonlinearity" => (sign * 0.4, [0.08 * random.sign(), 0.05 * random.sign()], 2.0),
            "sensor-gain" => (sign * 0.03, [0.0; 2], 0.15),
            "angle-offset" => (sign * 5e-3, [0.0; 2], 0.05),
            "sensor-lag" => (5e-3, [0.0; 2], 0.1),
            "eccentric-sensor" | "misaligned-sensor" => (0.02, [phase, 0.0], 0.15),
            "rolling-shutter" => (sign * 3e-3, [0.0; 2], 0.01),
            "zero-drift" => (sign * 2e-3, [0.0; 2], 0.02),
            _ => match shapes::form(name, random) {
                Some(form) => form,
                None => return Self::by_the_list(name, random),
            },
        };
        Self::of(name, own, false)
    }

    /// An effect for which the independent plant has no law.
    fn by_the_list(name: &'static str, random: &mut Random) -> Self {
        Self::of(name, listed::form(name, random), true)
    }

    fn of(name: &'static str, (size, shape, largest): (f64, [f64; 2], f64), is_listed: bool) -> Self {
        Self { name, size: size.clamp(-largest, largest), shape, largest, is_listed }
    }

    fn scaled(&self, factor: f64) -> Self {
        let size = (self.size * factor).clamp(-self.largest, self.largest);
        Self {
            size: if matches!(self.name, "presliding" | "hard-bristle") {
                size.max(STIFFEST_BRISTLE_RAD)
            } else {
                size
            },
            ..*self
        }
    }
}

impl Rig {
    /// A random rig with nothing hidden.
    pub fn random(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let (mass_kg, length_m) = (random.between(0.12, 0.18), random.between(0.14, 0.17));
        let inertia_kg_m2 = random.between(0.6, 0.95) * mass_kg * length_m * length_m;
        let coulomb_nm = random.log_between(2e-4, 1.2e-3);
        let n_releases = random.pick(&[2, 3, 3, 4]);
        let largest = random.between(1.1, 1.5);
        let other = |k: usize, random: &mut Random| {
            let size = if k == 0 { largest } else { random.between(0.3, 1.5) };
            if k.is_multiple_of(2) { size } else { -size }
        };
        let side = random.sign();
        Self {
            mass_kg,
            length_m,
            inertia_kg_m2,
            drawn_inertia_kg_m2: inertia_kg_m2 * random.between(0.94, 1.06),
            gravity_m_s2: 9.81,
            viscous: random.between(3e-4, 8e-4),
            coulomb_nm,
            stiction_nm: coulomb_nm * random.between(1.05, 1.6),
            velocity_band: 0.0,
            offset_rad: 2e-4 * random.normal().clamp(-2.0, 2.0),
            clock: 1.0,
            hidden: Vec::new(),
            noise_rad: LSB_RAD * random.log_between(0.5, 2.0),
            jitter_s: 0.0,
            clock_jump_s: 0.0,
            friction_change: 0.0,
            rate_hz: random.pick(&[200.0, 250.0, 400.0, 500.0, 1000.0]),
            longest_s: LONGEST_S,
            releases_rad: (0..n_releases).map(|k| side * other(k, &mut random)).collect(),
            seed,
        }
    }

    /// A random rig with a light bearing, as ball bearings have, and nothing hidden: it swings for a minute and more. Let
    /// go once or twice, and watched for a while at a lower rate; often it still swings in the end.
    pub fn light(seed: u64) -> Self {
        let (rig, mut random) = (Self::random(seed), Random::new(seed ^ 0x11947));
        let coulomb_nm = random.log_between(3e-5, 4e-4);
        let mut releases_rad = rig.releases_rad;
        releases_rad.truncate(random.pick(&[1, 1, 2]));
        releases_rad[0] *= random.between(0.7, 1.8);
        Self {
            coulomb_nm,
            stiction_nm: coulomb_nm * random.between(1.05, 1.6),
            viscous: random.log_between(1e-5, 2e-4),
            velocity_band: random.pick(&[0.0, 0.02, 0.06]),
            rate_hz: random.pick(&[50.0, 100.0, 200.0]),
            longest_s: random.pick(&[60.0, 120.0, 240.0]),
            releases_rad,
            ..rig
        }
    }

    /// The same rig with an effect added.
    pub fn with(mut self, name: &'static str) -> Self {
        let mut random = Random::new(self.seed ^ 0xabcd);
        if name == "load-dependent-coulomb" {
            // The load takes the place of most of the plain dry friction.
            self.coulomb_nm *= 0.3;
            self.stiction_nm *= 0.3;
        }
        if matches!(name, "presliding" | "hard-bristle") {
            self.coulomb_nm = self.coulomb_nm.max(5e-4);
            self.stiction_nm = self.coulomb_nm;
        }
        if matches!(name, "asymmetric-coulomb" | "angle-dependent-friction") {
            self.coulomb_nm = self.coulomb_nm.max(8e-4);
            self.stiction_nm = self.stiction_nm.max(1.1 * self.coulomb_nm);
        }
        let hidden = Hidden::random(name, self.coulomb_nm, &mut random);
        self.hidden.push(hidden);
        self
    }

    /// The same rig with everything hidden made smaller or larger.
    pub fn scaled(&self, factor: f64) -> Self {
        Self { hidden: self.hidden.iter().map(|hidden| hidden.scaled(factor)).collect(), ..self.clone() }
    }

    /// What is hidden under a name and acts by the plant's own law.
    pub fn hidden(&self, name: &str) -> Option<&Hidden> {
        self.hidden.iter().find(|hidden| hidden.name == name && !hidden.is_listed)
    }

    /// What an experimenter knows: geometry and drawing, no friction.
    pub fn known(&self) -> Parameters<f64> {
        let mut parameters = Parameters::paper();
        parameters.pendulum.mass_kg = self.mass_kg;
        parameters.pendulum.length_m = self.length_m;
        parameters.pendulum.inertia_kg_m2 = self.drawn_inertia_kg_m2;
        parameters.set_friction(0.0, 0.0, 0.0, 0.0);
        parameters
    }

    /// Noise and steps together, rad.
    pub fn total_noise_rad(&self) -> f64 {
        (self.noise_rad.powi(2) + LSB_RAD * LSB_RAD / 12.0).sqrt()
    }

    /// Its swings, as the product cuts them out of the recordings; those that stop too soon for it are left out.
    pub fn swings(&self) -> Vec<Swing> {
        (0..self.releases_rad.len())
            .filter_map(|release_idx| {
                let name = format!("release {}", release_idx + 1);
                Swing::from_recording(&name, &self.recording(release_idx), &Default::default()).ok()
            })
            .map(|(swing, _)| swing)
            .collect()
    }

    /// One recording, from before the release until rest.
    pub fn recording(&self, release_idx: usize) -> Recording {
        self.recording_in_steps(release_idx, LSB_RAD)
    }

    /// The same by another converter.
    pub fn recording_in_steps(&self, release_idx: usize, step_rad: f64) -> Recording {
        let mut random = Random::new(self.seed ^ (0x1111 * (release_idx as u64 + 1)));
        let release_s = random.between(0.2, 1.0);
        let angle_rad = self.releases_rad[release_idx];
        let rig = self.at_release(release_idx);
        let (mut plant, mut sensor) = (Plant::release(&rig, angle_rad), Sensor::held(&rig, angle_rad));
        let mut clock = Clock::new(self.clock_jump_s, self.seed ^ release_idx as u64);
        let mut angles_rad = Vec::new();
        let (mut time_s, mut rest_s) = (-release_s, 0.0);
        while rest_s < REST_S && time_s < self.longest_s {
            let noise_rad = self.noise_rad.hypot(self.jitter_s * plant.motion().0[1]);
            angles_rad.push(sensor.read(time_s, step_rad, noise_rad, &mut random));
            let next_s = clock.true_s(angles_rad.len() as f64 / self.rate_hz / self.clock) - release_s;
            follow(&mut plant, &mut sensor, time_s.max(0.0), next_s);
            rest_s = if time_s > 0.0 && plant.rests() { rest_s + next_s - time_s } else { 0.0 };
            time_s = next_s;
        }
        Recording::uniform(self.rate_hz, angles_rad).expect("a simulated recording is sound")
    }

    /// The rig as it was at one release.
    fn at_release(&self, release_idx: usize) -> Self {
        let factor = if release_idx.is_multiple_of(2) { 1.0 } else { 1.0 + self.friction_change };
        let [viscous, coulomb_nm, stiction_nm] =
            [self.viscous, self.coulomb_nm, self.stiction_nm].map(|friction| factor * friction);
        Self { viscous, coulomb_nm, stiction_nm, ..self.clone() }
    }

    /// The same rig with its hidden effects scaled until the base model leaves so many times the noise, or until that
    /// would not be physical; and what it then leaves. A shifted zero alone is left as it is, because the base model's
    /// free offset takes it up.
    pub fn scaled_to(&self, ratio: f64) -> (Self, f64) {
        let (mut rig, mut left) = (self.clone(), self.base_ratio());
        let is_fitted_anyway = self.hidden.iter().all(|hidden| hidden.name == "angle-offset");
        for _ in 0..if is_fitted_anyway { 0 } else { 3 } {
            if (left / ratio - 1.0).abs() < 0.08 {
                break;
            }
            let factor = ((ratio * ratio - 1.0) / (left * left - 1.0).max(0.01)).sqrt().clamp(0.1, 5.0);
            rig = rig.scaled(factor);
            left = rig.base_ratio();
        }
        (rig, left)
    }

    /// The base model's error, in noises.
    pub fn base_ratio(&self) -> f64 {
        let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
        let swings: Vec<Swing> = self.swings().iter().map(|swing| swing.thinned(RATIO_RATE_HZ)).collect();
        match fit(&swings, &[], &self.known(), &options, &|_| ()) {
            Ok(fit) => fit.rmse_rad / self.total_noise_rad(),
            Err(_) => f64::INFINITY,
        }
    }
}

/// A recorder's clock that now and then loses some time.
struct Clock {
    jump_s: f64,
    lost_s: f64,
    next_s: f64,
    random: Random,
}

impl Clock {
    fn new(jump_s: f64, seed: u64) -> Self {
        Self { jump_s, lost_s: 0.0, next_s: 0.0, random: Random::new(seed ^ 0x3333) }
    }

    /// The true time when the clock says this; times must rise.
    fn true_s(&mut self, time_s: f64) -> f64 {
        while time_s > self.next_s {
            let [shortest_s, longest_s] = BETWEEN_JUMPS_S;
            self.next_s += self.random.between(shortest_s, longest_s);
            self.lost_s += self.jump_s;
        }
        time_s + self.lost_s
    }
}

/// Lets the shaft and its sensor go on from one time after the release to another.
fn follow(plant: &mut Plant, sensor: &mut Sensor, from_s: f64, to_s: f64) {
    let n_steps = plant.n_steps(to_s - from_s);
    for _ in 0..n_steps {
        let step_s = (to_s - from_s) / n_steps as f64;
        plant.advance(step_s);
        sensor.follow(plant.motion(), step_s);
    }
}
