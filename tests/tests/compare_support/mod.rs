//! What the tests of the comparison share: simulated swings and the recordings of real and hidden rigs.

#![allow(dead_code, unreachable_pub, reason = "each test program uses its part")]

use host::compare::Comparison;
use host::compare::measurement::Measurement;
use host::compare::pictures::pictures;
use host::noise;
use host::plot::svg::svg;
use host::random::Noise;
use host::recording::segment::SegmentOptions;
use host::recording::{ReadOptions, Recording, read, turning};
use host::report::report;
use host::swing::Swing;
use serde_json::Value;
use shared::model::Model;
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::path::{Path, PathBuf};

/// One step of 12 bits over 340°.
pub const LSB_RAD: f64 = 340.0 * std::f64::consts::PI / 180.0 / 4096.0;

pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings").join(name)
}

pub fn load(name: &str) -> Recording {
    read(&data(name), &ReadOptions::default()).unwrap()
}

pub fn measurement(name: &str, from_s: Option<f64>) -> Measurement {
    Measurement::from_recording(name, &load(name), &SegmentOptions { from_s, to_s: None }).unwrap()
}

/// A pendulum with m·g·l = 1 N·m whose small swings last as long as the recording's: friction then counts in its share
/// of m·g·l.
pub fn normalised(measurement: &Measurement) -> Parameters<f64> {
    let swing = &measurement.swing;
    let half_swing_s = turning::half_swing_s(&swing.times_s, &swing.angles_rad, swing.noise_rad).unwrap();
    let pivot = (half_swing_s / std::f64::consts::PI).powi(2);
    let (length_m, gravity_m_s2) = (0.01, 9.81);
    let mass_kg = 1.0 / (gravity_m_s2 * length_m);
    let inertia_kg_m2 = pivot - mass_kg * length_m * length_m;
    Parameters::frictionless(Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2 })
}

/// A rig of the hidden set with its releases, straight from its data sheet.
pub fn hidden(case: usize) -> (Parameters<f64>, Vec<Measurement>) {
    let text = std::fs::read_to_string(data(&format!("hidden/p{case:02}/meta.json"))).unwrap();
    let meta: Value = serde_json::from_str(&text).unwrap();
    let number = |key: &str| meta[key].as_f64().unwrap();
    let pendulum = Pendulum {
        mass_kg: number("m"),
        length_m: number("l"),
        inertia_kg_m2: number("I_cad"),
        gravity_m_s2: number("g"),
    };
    let releases = meta["releases"].as_array().unwrap();
    let name = |release: &Value| format!("hidden/p{case:02}/{}", release.as_str().unwrap());
    (Parameters::frictionless(pendulum), releases.iter().map(|release| measurement(&name(release), None)).collect())
}

/// A rig with no effect beyond the base ones.
pub fn rig() -> Parameters<f64> {
    let mut rig = Parameters::paper();
    rig.set_friction(5e-4, 8e-4, 1e-3, 0.0);
    rig
}

/// How a swing is simulated.
#[derive(Clone, Copy, Debug)]
pub struct Release {
    pub angle_rad: f64,
    pub seconds: f64,
    pub rate_hz: f64,
    /// White noise, rad.
    pub noise_rad: f64,
    /// Step of the converter, rad; 0 for none.
    pub lsb_rad: f64,
    pub seed: u64,
}

impl Release {
    pub fn of(angle_rad: f64, seed: u64) -> Self {
        Self { angle_rad, seconds: 30.0, rate_hz: 200.0, noise_rad: 1e-3, lsb_rad: LSB_RAD, seed }
    }
}

/// Readings of a released pendulum, noise and steps included, in steps of 0.5 ms.
pub fn readings(parameters: &Parameters<f64>, release: &Release) -> (Vec<f64>, Vec<f64>) {
    let model = Model::new(parameters);
    let mut state = model.release(release.angle_rad, 0.0);
    let mut noise = Noise::new(release.seed);
    let n_samples = (release.seconds * release.rate_hz) as usize;
    let n_steps = (2000.0 / release.rate_hz).ceil() as usize;
    let mut angles_rad = Vec::with_capacity(n_samples);
    for sample_idx in 0..n_samples {
        if sample_idx > 0 {
            (0..n_steps).for_each(|_| model.step(&mut state, 1.0 / (release.rate_hz * n_steps as f64)));
        }
        let angle_rad = state.angle_rad + release.noise_rad * noise.normal();
        let step = release.lsb_rad;
        angles_rad.push(if step > 0.0 { (angle_rad / step).round() * step } else { angle_rad });
    }
    ((0..n_samples).map(|i| i as f64 / release.rate_hz).collect(), angles_rad)
}

/// A simulated swing with the noise found in it.
pub fn simulated(parameters: &Parameters<f64>, release: &Release) -> Measurement {
    let (times_s, angles_rad) = readings(parameters, release);
    let found = noise::of_samples(&times_s, &angles_rad, None);
    Measurement::of_swing(Swing::new("simulated", &times_s, &angles_rad, found.total_rms))
}

/// Writes all pictures and the report of a comparison to a folder named by `COMPARE_PICTURES`, to be looked at.
pub fn keep_pictures(name: &str, comparison: &Comparison) {
    let Ok(folder) = std::env::var("COMPARE_PICTURES") else { return };
    let folder = Path::new(&folder).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    for picture in pictures(comparison) {
        std::fs::write(folder.join(format!("{}.svg", picture.key)), svg(&picture)).unwrap();
    }
    std::fs::write(folder.join("report.html"), report(comparison)).unwrap();
}
