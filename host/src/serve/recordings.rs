//! Recordings that come in: from the command line, from the browser, from the rig.

use super::settings::Settings;
use crate::compare::measurement::Measurement;
use crate::error::Failure;
use crate::recording::read_bytes;
use std::path::Path;
use std::sync::Arc;

/// A file that is uploaded may have so many bytes: an hour at 1 kHz.
pub(super) const MOST_BYTES: usize = 64 << 20;

/// More recordings than this nobody looks at.
const MOST_RECORDINGS: usize = 64;

/// All recordings together may have so many samples of free swing.
const MOST_SAMPLES: usize = 6_000_000;

/// Names in the list are cut to so many characters.
const LONGEST_NAME: usize = 80;

/// A recording with its free swing.
pub(super) struct Loaded {
    pub(super) id: u32,
    /// What people call it; never a path.
    pub(super) name: String,
    pub(super) held_out: bool,
    /// The file as it came.
    pub(super) bytes: Arc<[u8]>,
    pub(super) measurement: Measurement,
}

impl Loaded {
    /// The same recording, taking part or not.
    pub(super) fn with_held_out(&self, held_out: bool) -> Self {
        let Self { id, name, bytes, measurement, .. } = self;
        Self { id: *id, name: name.clone(), held_out, bytes: bytes.clone(), measurement: measurement.clone() }
    }
}

/// Reads a file of this computer.
pub(super) fn of_file(path: &Path, settings: &Settings) -> Result<Loaded, Failure> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path)
        .map_err(|error| Failure::failed(format!("could not read {name}: {error}")).next("check the name"))?;
    of_bytes(&name, &bytes, settings)
}

/// Reads what somebody sent; `name` is what messages call it.
pub(super) fn of_bytes(name: &str, bytes: &[u8], settings: &Settings) -> Result<Loaded, Failure> {
    let name = short_name(name);
    let hint = "choose a recording: lines of time and angle, separated by commas";
    let recording = read_bytes(&name, bytes, &settings.reading).map_err(|error| Failure::failed(error).next(hint))?;
    let measurement = Measurement::from_recording(&name, &recording, &settings.segment).map_err(|error| {
        Failure::failed(format!("{name}: {error}")).next("record again and let the pendulum swing freely")
    })?;
    Ok(Loaded { id: 0, name, held_out: false, bytes: bytes.into(), measurement })
}

/// The last part of a path, printable and not too long.
fn short_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let printable: String = last.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    if printable.trim().is_empty() { "recording".to_owned() } else { printable }
}

/// A second recording of the same name gets a number.
pub(super) fn unused_name(others: &[Arc<Loaded>], name: &str) -> String {
    let is_free = |name: &str| others.iter().all(|other| other.name != name);
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| is_free(name)).unwrap_or_default()
}

/// Refuses what would fill the memory.
pub(super) fn check_room(others: &[Arc<Loaded>], loaded: &Loaded) -> Result<(), Failure> {
    let n_samples: usize = others.iter().map(|other| other.measurement.swing.len()).sum();
    let too_many = others.len() >= MOST_RECORDINGS || n_samples + loaded.measurement.swing.len() > MOST_SAMPLES;
    if too_many {
        let what = format!("there is no room for {} beside {} recordings", loaded.name, others.len());
        return Err(Failure::wrong_use(what).next("take a recording out of the list first"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_never_a_path() {
        assert_eq!(short_name("../../etc/passwd"), "passwd");
        assert_eq!(short_name("C:\\data\\swing 1.csv"), "swing 1.csv");
        assert_eq!(short_name("a\nb\u{7}"), "ab");
        assert_eq!(short_name("/"), "recording");
        assert_eq!(short_name(&"x".repeat(500)).len(), LONGEST_NAME);
    }
}
