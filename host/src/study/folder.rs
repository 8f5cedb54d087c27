//! The folder of a study: every folder in it that has a `rig.toml` is a rig, and the files in and below it, down to the
//! next `rig.toml`, are recordings of it.
//!
//! Out: rigs with their recordings, sorted by name, and what can't belong to any rig, each with the reason. Names that
//! begin with a dot, databases and their journals, and what the study itself wrote are passed over.

use super::hash;
use super::row::{Key, ROOT};
use crate::rigfile::{RigFile, USUAL_NAME};
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of files that a study writes, and of what lies beside a database while it is open.
const NO_RECORDINGS: [&str; 5] = ["sqlite", "sqlite-wal", "sqlite-shm", "sqlite-journal", "html"];

/// What begins the file that `host study --csv` writes.
pub const TABLE_BEGINS: &str = "rig,recording,";

/// A rig with its recordings.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Its folder within the study.
    pub name: String,
    /// Its model.
    pub model: RigFile,
    /// SHA-256 of the model file.
    pub model_hash: String,
    /// Names of the recordings within the folder, sorted.
    pub recordings: Vec<String>,
}

/// Something that is left out, and why.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Problem {
    /// A recording, a file or a folder, within the study.
    pub what: String,
    /// Why it is left out, and what to do.
    pub why: String,
}

/// All that a folder holds.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Rigs by name.
    pub rigs: Vec<Rig>,
    /// What belongs to no rig.
    pub problems: Vec<Problem>,
}

impl Rig {
    /// A recording's name in the study.
    pub fn key(&self, recording: &str) -> Key {
        Key { rig: self.name.clone(), recording: recording.to_owned() }
    }
}

/// Where a recording lies.
pub fn path_of(folder: &Path, key: &Key) -> PathBuf {
    let rig = if key.rig == ROOT { folder.to_owned() } else { folder.join(&key.rig) };
    rig.join(&key.recording)
}

/// Looks through a folder and all folders in it; links to folders are not followed, or there might be no end.
pub fn search(folder: &Path) -> Found {
    let mut search = Search { root: folder, found: Found::default() };
    search.visit(folder, None);
    let mut found = search.found;
    found.rigs.iter_mut().for_each(|rig| rig.recordings.sort());
    found.rigs.sort_by(|a, b| a.name.cmp(&b.name));
    found.problems.sort();
    found
}

struct Search<'a> {
    root: &'a Path,
    found: Found,
}

/// Whose recordings the files of a folder are.
#[derive(Clone, Copy)]
enum Owner {
    Rig(usize),
    /// Its model can't be used; that is told once.
    Unusable,
}

impl Search<'_> {
    fn visit(&mut self, folder: &Path, above: Option<Owner>) {
        let entries = match fs::read_dir(folder) {
            Ok(entries) => entries.flatten(),
            Err(error) => return self.problem(folder, format!("could not look into this folder: {error}")),
        };
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| !is_hidden(path)).collect();
        paths.sort();
        let owner = self.owner(folder, &paths).or(above);
        for path in paths {
            if path.is_dir() {
                if !path.is_symlink() {
                    self.visit(&path, owner);
                }
            } else if !is_passed_over(&path) {
                self.file(&path, owner);
            }
        }
    }

    /// The rig that a folder begins.
    fn owner(&mut self, folder: &Path, paths: &[PathBuf]) -> Option<Owner> {
        let models: Vec<&PathBuf> = paths.iter().filter(|path| is_model(path)).collect();
        let usual = folder.join(USUAL_NAME);
        if !usual.is_file() {
            return None;
        }
        if models.len() > 1 {
            let names: Vec<String> = models.iter().map(|path| name_of(path)).collect();
            let why = format!(
                "{} are models of several rigs, and its recordings could be of any; give each rig a folder of its own",
                names.join(", ")
            );
            self.problem(folder, why);
            return Some(Owner::Unusable);
        }
        let hash = hash::of_file(&usual).unwrap_or_default();
        match (RigFile::load(&usual), self.relative(folder)) {
            (Ok(model), Some(name)) => {
                self.found.rigs.push(Rig { name, model, model_hash: hash, recordings: Vec::new() });
                Some(Owner::Rig(self.found.rigs.len() - 1))
            }
            (Err(error), _) => {
                let next = error.next_step();
                self.problem(folder, format!("its model can't be used: {error}; {next}"));
                Some(Owner::Unusable)
            }
            (_, None) => Some(Owner::Unusable),
        }
    }

    fn file(&mut self, path: &Path, owner: Option<Owner>) {
        match owner {
            _ if is_model(path) && name_of(path) != USUAL_NAME => {
                self.problem(path, format!("a model that is not called {USUAL_NAME} is not used; rename or move it"));
            }
            Some(Owner::Rig(idx)) => {
                let folder =
                    path_of(self.root, &Key { rig: self.found.rigs[idx].name.clone(), recording: String::new() });
                match path.strip_prefix(&folder).ok().and_then(in_slashes) {
                    Some(name) => self.found.rigs[idx].recordings.push(name),
                    None => self.problem(path, "its name is not UTF-8; rename it".to_owned()),
                }
            }
            Some(Owner::Unusable) => {}
            None => {
                let why = format!("it lies in no rig's folder; put a {USUAL_NAME} beside it, or move it into a rig's");
                self.problem(path, why);
            }
        }
    }

    fn problem(&mut self, path: &Path, why: String) {
        let what = path.strip_prefix(self.root).unwrap_or(path).display().to_string();
        let what = if what.is_empty() { ".".to_owned() } else { what };
        self.found.problems.push(Problem { what, why });
    }

    fn relative(&mut self, folder: &Path) -> Option<String> {
        let inside = folder.strip_prefix(self.root).unwrap_or(folder);
        if inside.as_os_str().is_empty() {
            return Some(ROOT.to_owned());
        }
        let name = in_slashes(inside);
        if name.is_none() {
            self.problem(folder, "its name is not UTF-8; rename it".to_owned());
        }
        name
    }
}

/// The same name on every system; `None` if it is not UTF-8.
fn in_slashes(path: &Path) -> Option<String> {
    let parts: Option<Vec<&str>> = path.iter().map(|part| part.to_str()).collect();
    parts.map(|parts| parts.join("/"))
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn is_hidden(path: &Path) -> bool {
    name_of(path).starts_with('.')
}

/// A model file by its ending and its table.
fn is_model(path: &Path) -> bool {
    let is_toml = path.extension().is_some_and(|ending| ending == "toml");
    is_toml && (name_of(path) == USUAL_NAME || fs::read_to_string(path).is_ok_and(|text| text.contains("[pendulum]")))
}

fn is_passed_over(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    name_of(path) == USUAL_NAME || NO_RECORDINGS.contains(&ending.as_str()) || is_table(path)
}

/// A table that a study wrote.
fn is_table(path: &Path) -> bool {
    use std::io::Read;
    let mut begin = [0; TABLE_BEGINS.len()];
    let is_csv = path.extension().is_some_and(|ending| ending == "csv");
    is_csv
        && fs::File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok()
        && begin == TABLE_BEGINS.as_bytes()
}
