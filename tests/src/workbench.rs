//! A folder with a hidden rig's recordings and the model file of somebody who knows its geometry and its drawing: what a
//! person at the bench has before the first fit.

use crate::hidden::Rig;
use crate::program::host;
use host::recording::{Existing, save};
use host::rigfile::RigFile;
use serde_json::Value;
use shared::parameters::Parameters;
use std::path::Path;

/// The folder; it goes with the value.
pub struct Workbench(tempfile::TempDir);

impl Workbench {
    /// With `rig.toml` and no recording yet.
    pub fn new(rig: &Rig) -> Self {
        let bench = Self(tempfile::tempdir().expect("a folder for files"));
        let Rig { mass_kg, length_m, drawn_inertia_kg_m2, .. } = rig;
        let init = format!("init --mass {mass_kg} --length {length_m} --inertia {drawn_inertia_kg_m2}");
        host(bench.folder(), &init).succeeded();
        bench
    }

    /// With all recordings of the rig too: `swing1.csv` and so on; and their names.
    pub fn with_recordings(rig: &Rig) -> (Self, String) {
        let bench = Self::new(rig);
        let names: Vec<String> = (1..=rig.releases_rad.len()).map(|number| format!("swing{number}.csv")).collect();
        for (release_idx, name) in names.iter().enumerate() {
            bench.save(rig, release_idx, name);
        }
        (bench, names.join(" "))
    }

    /// Where it lies.
    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    /// One more recording.
    pub fn save(&self, rig: &Rig, release_idx: usize, name: &str) {
        save(&rig.recording(release_idx), &self.folder().join(name), Existing::Overwrite).expect("a place for a file");
    }

    /// The object that a command prints; `--json` is added.
    #[track_caller]
    pub fn json(&self, arguments: &str) -> Value {
        let run = host(self.folder(), &format!("{arguments} --json --quiet"));
        serde_json::from_str(run.succeeded()).expect("one object")
    }

    /// The parameters of a model file.
    pub fn model(&self, name: &str) -> Parameters<f64> {
        RigFile::load(&self.folder().join(name)).expect("a model file").parameters().clone()
    }
}

/// A number of an object.
#[track_caller]
pub fn number(object: &Value, key: &str) -> f64 {
    object[key].as_f64().unwrap_or_else(|| panic!("no number {key} in {object}"))
}

/// Texts of a list in an object.
#[track_caller]
pub fn texts<'a>(object: &'a Value, key: &str) -> Vec<&'a str> {
    let list = object[key].as_array().unwrap_or_else(|| panic!("no list {key} in {object}"));
    list.iter().map(|text| text.as_str().unwrap_or_else(|| panic!("{text} in {key} is no text"))).collect()
}
