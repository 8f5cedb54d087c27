//! Recordings that come in: from the command line, from the browser, from the rig.

use super::settings::Settings;
use crate::compare::measurement::Measurement;
use crate::error::Failure;
use crate::operations::given::{double, is_same};
use crate::recording::{self, Columns, Fault, ReadError, ReadOptions, Run};
use crate::shorten::shortened;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::NamedTempFile;

/// A file that is uploaded may have so many bytes: hours at 1 kHz. It goes to the disk as it comes.
pub(super) const MOST_BYTES: usize = 256 << 20;

/// More recordings than this nobody looks at.
const MOST_RECORDINGS: usize = 64;

/// All recordings together may have so many samples of free swing.
const MOST_SAMPLES: usize = 6_000_000;

/// Names in the list are cut to so many characters.
const LONGEST_NAME: usize = 80;

/// What a release is called that the live view has listened to.
const RELEASE: &str = "live.csv";

/// Where the file lies: what was sent goes with the list, what is this computer's stays where it is.
pub(super) enum Kept {
    Uploaded(NamedTempFile),
    Here(PathBuf),
}

impl Kept {
    /// Where to read it.
    pub(super) fn path(&self) -> &Path {
        match self {
            Self::Uploaded(file) => file.path(),
            Self::Here(path) => path,
        }
    }
}

/// A recording with its free swing.
pub(super) struct Loaded {
    pub(super) id: u32,
    /// What people call it; never a path.
    pub(super) name: String,
    /// What they call its file, which may hold other runs too.
    pub(super) file: String,
    pub(super) held_out: bool,
    /// The rig's, where this page listened to it.
    pub(super) port: Option<String>,
    /// The file as it came.
    pub(super) kept: Arc<Kept>,
    pub(super) measurement: Measurement,
}

impl Loaded {
    /// The same recording, taking part or not.
    pub(super) fn with_held_out(&self, held_out: bool) -> Self {
        let Self { id, name, file, port, kept, measurement, .. } = self;
        let (name, file, port) = (name.clone(), file.clone(), port.clone());
        Self { id: *id, name, file, held_out, port, kept: kept.clone(), measurement: measurement.clone() }
    }
}

/// Reads a file of this computer: one recording, or one for each run.
pub(super) fn of_file(path: &Path, settings: &Settings) -> Result<Vec<Loaded>, Failure> {
    let name = path.display().to_string();
    loaded(&LoadingWish::named(&name), Kept::Here(path.to_owned()), settings)
}

/// What somebody says of a file beside sending it.
#[derive(Debug, Default, Deserialize)]
pub(super) struct LoadingWish {
    /// What messages call it.
    pub(super) name: String,
    /// As `--columns`.
    columns: Option<String>,
    /// As `--zero`.
    zero: Option<f64>,
    /// As `--mirror`.
    #[serde(default)]
    mirrored: bool,
    /// The recording of the list that this one is to replace.
    pub(super) replaced: Option<u32>,
}

impl LoadingWish {
    fn named(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// How the file is to be read: as wished, else as all are.
    pub(super) fn options(&self, settings: &Settings) -> Result<ReadOptions, Failure> {
        let mut options = settings.reading.clone();
        if let Some(columns) = self.columns.as_deref().filter(|columns| !columns.is_empty()) {
            let next = "choose other columns or units";
            options.columns = Some(columns.parse::<Columns>().map_err(|error| Failure::wrong_use(error).next(next))?);
        }
        options.zero = self.zero.or(options.zero);
        options.mirrored |= self.mirrored;
        Ok(options)
    }
}

/// Reads what somebody sent, likewise.
pub(super) fn of_upload(wish: &LoadingWish, file: NamedTempFile, settings: &Settings) -> Result<Vec<Loaded>, Failure> {
    loaded(wish, Kept::Uploaded(file), settings)
}

/// Reads a release that the live view has listened to.
pub(super) fn of_release(file: NamedTempFile, settings: &Settings) -> Result<Vec<Loaded>, Failure> {
    loaded(&LoadingWish::named(RELEASE), Kept::Uploaded(file), settings)
}

/// The same, of the rig at this port.
pub(super) fn of_port(loaded: Vec<Loaded>, port: Option<&str>) -> Vec<Loaded> {
    loaded.into_iter().map(|loaded| Loaded { port: port.map(str::to_owned), ..loaded }).collect()
}

/// Reads a file as it was wished; `name` is what messages call it.
pub(super) fn read_as(wish: &LoadingWish, path: &Path, settings: &Settings) -> Result<Vec<Run>, Failure> {
    let options = wish.options(settings)?;
    recording::read_runs(path, &options).map_err(|error| not_read(wish, error))
}

/// With what to do next; where there is nothing in the file nobody is asked what its columns are.
fn not_read(wish: &LoadingWish, error: ReadError) -> Failure {
    let hint = match error.fault {
        Fault::Missing | Fault::Empty | Fault::Directory | Fault::Unreadable(_) => "choose another file",
        _ => "say what its columns are, or choose a recording: lines of time and angle, separated by commas",
    };
    Failure::failed(ReadError { file: short_name(&wish.name), ..error }).next(hint)
}

fn loaded(wish: &LoadingWish, kept: Kept, settings: &Settings) -> Result<Vec<Loaded>, Failure> {
    let runs = read_as(wish, kept.path(), settings)?;
    let kept = Arc::new(kept);
    let mut loaded = Vec::new();
    for run in &runs {
        loaded.extend(of_run(run, &wish.name, &kept, settings)?);
    }
    Ok(loaded)
}

fn of_run(run: &Run, file: &str, kept: &Arc<Kept>, settings: &Settings) -> Result<Vec<Loaded>, Failure> {
    let file = short_name(file);
    let name = run.name_in(&file);
    let measurements = Measurement::each_of(&name, &run.recording, &settings.segment).map_err(|error| {
        Failure::failed(format!("{name}: {error}")).next("record again and let the pendulum swing freely")
    })?;
    let loaded = |measurement: Measurement| {
        let (name, file, kept) = (measurement.swing.name.clone(), file.clone(), kept.clone());
        Loaded { id: 0, name, file, held_out: false, port: None, kept, measurement }
    };
    Ok(measurements.into_iter().map(loaded).collect())
}

/// The last part of a path, printable and not too long.
fn short_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let printable: String = last.chars().filter(|c| !c.is_control()).collect();
    if printable.trim().is_empty() { "recording".to_owned() } else { shortened(&printable, LONGEST_NAME) }
}

/// A second recording of the same name gets a number.
pub(super) fn unused_name(others: &[Arc<Loaded>], name: &str) -> String {
    let is_free = |name: &str| others.iter().all(|other| other.name != name);
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| is_free(name)).unwrap_or_default()
}

/// Refuses what would count twice.
pub(super) fn refuse_doubles(others: &[Arc<Loaded>], new: &[Loaded]) -> Result<(), Failure> {
    for loaded in new {
        let is_double = |other: &&Arc<Loaded>| is_same(&loaded.measurement.swing, &other.measurement.swing);
        if let Some(other) = others.iter().find(is_double) {
            return Err(double(&loaded.name, &other.name));
        }
    }
    Ok(())
}

/// Refuses what would fill the memory.
pub(super) fn check_room(others: &[Arc<Loaded>], new: &[Loaded]) -> Result<(), Failure> {
    let all = others.iter().map(Arc::as_ref).chain(new);
    let n_samples: usize = all.map(|recording| recording.measurement.swing.len()).sum();
    let too_many = others.len() + new.len() > MOST_RECORDINGS || n_samples > MOST_SAMPLES;
    if let (Some(first), true) = (new.first(), too_many) {
        let what = format!("there is no room for {} beside {} recordings", first.name, others.len());
        return Err(Failure::wrong_use(what).next("take a recording out of the list first"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_file_without_content_nobody_asks_what_its_columns_are() {
        let wish = LoadingWish::named("swing.csv");
        let advice = |fault| {
            let failure = not_read(&wish, ReadError { file: "upload".to_owned(), fault });
            assert!(failure.what().starts_with("could not read recording swing.csv: "), "{failure}");
            failure.next_step().unwrap_or_default().to_owned()
        };
        assert_eq!([Fault::Missing, Fault::Empty, Fault::Directory].map(advice), ["choose another file"; 3]);
        assert!(advice(Fault::NoNumbers { n_lines: 3 }).contains("say what its columns are"));
    }

    #[test]
    fn a_name_is_never_a_path() {
        assert_eq!(short_name("../../etc/passwd"), "passwd");
        assert_eq!(short_name("C:\\data\\swing 1.csv"), "swing 1.csv");
        assert_eq!(short_name("a\nb\u{7}"), "ab");
        assert_eq!(short_name("/"), "recording");
        assert_eq!(short_name(&"x".repeat(500)).chars().count(), LONGEST_NAME);
        assert!(short_name(&format!("{}-07.csv", "x".repeat(500))).ends_with("x-07.csv"));
    }
}
