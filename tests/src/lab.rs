//! A laboratory for a study: several rigs with many recordings each, from the independent plant.

use crate::chance::Chance;
use crate::hidden::Rig;
use crate::program::{Run, host};
use host::recording::{Existing, Header, Recording, save};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};

/// A folder with a folder a rig; it goes with the value.
pub struct Lab(tempfile::TempDir);

impl Default for Lab {
    fn default() -> Self {
        Self::new()
    }
}

/// A pendulum that is quick to simulate and to fit: one release, 100 samples a second.
pub fn pendulum(seed: u64) -> Rig {
    let rig = Rig::random(seed);
    Rig { rate_hz: 100.0, noise_rad: 1e-3, releases_rad: vec![1.2], coulomb_nm: 7e-4, stiction_nm: 9e-4, ..rig }
}

/// The same rig in its n-th swing (from 0): its dry friction varies by a share from swing to swing, and all that is
/// chance is other chance.
pub fn swing(rig: &Rig, n: u64, varies_by: f64) -> Rig {
    let seed = rig.seed.wrapping_mul(0x9e37_79b9) ^ n;
    let coulomb_nm = rig.coulomb_nm * (1.0 + varies_by * Chance::new(seed).normal());
    Rig { seed, coulomb_nm, ..rig.clone() }
}

/// A recording in which the pendulum was pushed once as it went through its lowest point: there it swings on with the
/// speed of one swing before.
pub fn pushed(recording: &Recording) -> Recording {
    let (angles_rad, n) = (recording.angles_rad(), recording.len());
    let quarter = n / 4;
    let upward = |idx: &usize| angles_rad[idx - 1] < 0.0 && angles_rad[*idx] >= 0.0;
    let first = (quarter..n).find(upward).expect("it swings");
    // Noise may cross twice, but not half a swing later.
    let later = first + (0.5 / recording.step_s()) as usize;
    let second = (later..n).find(upward).expect("it swings on");
    let angles_rad = [&angles_rad[..second], &angles_rad[first..]].concat();
    Recording::uniform(recording.rate_hz().round(), angles_rad).expect("a recording")
}

/// A recording of [`Lab::with`], simulated once for all laboratories of a program.
fn usual(rig: u64, n: u64) -> Recording {
    static KNOWN: Mutex<BTreeMap<(u64, u64), Arc<OnceLock<Recording>>>> = Mutex::new(BTreeMap::new());
    let place = KNOWN.lock().expect("nobody panics with it").entry((rig, n)).or_default().clone();
    place.get_or_init(|| swing(&pendulum(40 + rig), n, 0.005).recording(0)).clone()
}

impl Lab {
    /// Without any rig.
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for files"))
    }

    /// With rigs of so many recordings: `rig-1/swing-1.csv` and so on; dry friction varies by 0.5 %.
    pub fn with(n_rigs: u64, n_swings: u64) -> Self {
        let lab = Self::new();
        for number in 1..=n_rigs {
            let (name, rig) = (format!("rig-{number}"), pendulum(40 + number));
            lab.add_rig(&name, &rig);
            (1..=n_swings).for_each(|n| lab.save(&usual(number, n), &format!("{name}/swing-{n}.csv")));
        }
        lab
    }

    /// Where it lies.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// A path in it.
    pub fn at(&self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    /// Another rig without recordings, known by its geometry.
    pub fn add_rig(&self, name: &str, rig: &Rig) {
        std::fs::create_dir_all(self.at(name)).expect("a folder");
        let Rig { mass_kg, length_m, drawn_inertia_kg_m2, .. } = rig;
        let init = format!("init --mass {mass_kg} --length {length_m} --inertia {drawn_inertia_kg_m2}");
        host(self.folder(), &format!("{init} -o {name}/rig.toml")).succeeded();
    }

    /// One recording more.
    pub fn save(&self, recording: &Recording, name: &str) {
        save(recording, &self.at(name), Existing::Overwrite).expect("a place for a file");
    }

    /// One that says when it was taken.
    pub fn save_dated(&self, recording: &Recording, name: &str, started: &str) {
        let header = Header { started: Some(started.to_owned()), ..recording.header().clone() };
        let (times_s, angles_rad) = (recording.times_s().to_vec(), recording.angles_rad().to_vec());
        self.save(&Recording::new(header, times_s, angles_rad, None).expect("a recording"), name);
    }

    /// Runs `host study` on it.
    pub fn study(&self, arguments: &str) -> Run {
        host(self.folder(), &format!("study . {arguments}"))
    }

    /// The object that it prints.
    #[track_caller]
    pub fn json(&self, arguments: &str) -> Value {
        let run = self.study(&format!("{arguments} --json --quiet"));
        serde_json::from_str(run.succeeded()).expect("one object")
    }

    /// The table of all that a database knows.
    #[track_caller]
    pub fn table(&self, database: &str) -> String {
        self.study(&format!("--as-is --database {database} --csv table.csv --force --quiet")).succeeded();
        std::fs::read_to_string(self.at("table.csv")).expect("the table")
    }
}
