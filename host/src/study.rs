//! Many recordings of many rigs: each is fitted once, kept in a database, and compared with all others.
//!
//! In: a folder with a `rig.toml` a rig and its recordings beside it ([`folder`]). Out: a row a recording and a row a
//! rig ([`database`]), control charts over the swings of each rig ([`chart`], [`mod@rig`]), the rigs among each other
//! ([`between`]), a table ([`table`]) and a page ([`page`]).
//!
//! What is done is done: a recording is studied anew only if its file, its model or the options have changed.
//! Recordings are taken by several workers, in an order that differs from one run to the next, so that two programs
//! at one database seldom take the same one; should they, both write the same row. Nothing that is told depends on
//! the order.

pub mod between;
pub mod chart;
pub mod database;
mod diagnosis;
pub mod folder;
pub mod hash;
pub mod look;
pub mod measure;
mod order;
pub mod outlier;
pub mod page;
mod percent;
pub mod rig;
pub mod row;
pub mod table;
mod workers;

use database::{Database, DatabaseError, RigRow};
use folder::{Found, Problem, Rig};
use look::Look;
use measure::Reading;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rig::RigView;
use row::{Key, Origin, ROOT};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use workers::each;

/// What to study, and how.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// How recordings are read.
    pub reading: Reading,
    /// So many recordings at a time.
    pub n_jobs: usize,
    /// Only a part of the recordings.
    pub shard: Option<Shard>,
    /// Also what is done already.
    pub again: bool,
    /// Ask what is missing from the models that leave more than noise.
    pub diagnose: bool,
}

/// One of several parts of a study that are equally large, about; which recordings it has depends on their names alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub number: u64,
    /// How many parts there are.
    pub of: u64,
}

impl Shard {
    /// Is this recording in it?
    pub fn has(&self, key: &Key) -> bool {
        let digest = Sha256::digest(format!("{}\n{}", key.rig, key.recording));
        let number = digest.iter().take(8).fold(0, |number, byte| (number << 8) | u64::from(*byte));
        number % self.of == self.number - 1
    }
}

/// What happens, for a progress display.
#[derive(Clone, Debug)]
pub enum Progress<'a> {
    /// So many recordings are looked at.
    Begins(usize),
    /// This one was done already.
    Known,
    /// This one is in the database now.
    Kept(&'a Key),
    /// What is missing from the model of this rig?
    Diagnoses(&'a str),
}

/// How a run went.
#[derive(Clone, Debug, Default)]
pub struct Done {
    /// Recordings that were found.
    pub n_found: usize,
    /// Those that were studied now.
    pub n_studied: usize,
    /// It was stopped before all was done.
    pub is_stopped: bool,
    /// What belongs to no rig.
    pub problems: Vec<Problem>,
}

/// Studies what is missing from the database.
///
/// # Errors
/// The database fails; what is wrong with a recording stands in its row.
pub fn bring_up_to_date(
    plan: &Plan,
    database: &Mutex<Database>,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Done, DatabaseError> {
    let found = folder::search(plan.folder);
    let all = recordings(plan, &found);
    progress(Progress::Begins(all.len()));
    let n_studied = AtomicUsize::new(0);
    each(&all, plan.n_jobs, stop, |(rig, key)| {
        if study(plan, rig, key, database)? {
            n_studied.fetch_add(1, Ordering::Relaxed);
            progress(Progress::Kept(key));
        } else {
            progress(Progress::Known);
        }
        Ok(())
    })?;
    if plan.diagnose && plan.shard.is_none() {
        diagnose(plan, &found, database, progress, stop)?;
    }
    Ok(Done {
        n_found: all.len(),
        n_studied: n_studied.into_inner(),
        is_stopped: stop.load(Ordering::SeqCst),
        problems: found.problems,
    })
}

/// All recordings of the plan, in the order of this run.
fn recordings<'a>(plan: &Plan, found: &'a Found) -> Vec<(&'a Rig, Key)> {
    let of_rig = |rig: &'a Rig| rig.recordings.iter().map(move |recording| (rig, rig.key(recording)));
    let mut all: Vec<_> = found.rigs.iter().flat_map(of_rig).collect();
    all.retain(|(_, key)| plan.shard.is_none_or(|shard| shard.has(key)));
    let mut random = SplitMix64::seed_from_u64(u64::from(std::process::id()));
    for last in (1..all.len()).rev() {
        all.swap(last, (random.next_u64() % (last as u64 + 1)) as usize);
    }
    all
}

/// Studies a recording unless that is done; gives whether it was.
fn study(plan: &Plan, rig: &Rig, key: &Key, database: &Mutex<Database>) -> Result<bool, DatabaseError> {
    let path = folder::path_of(plan.folder, key);
    // Looked at before it is read: what changes meanwhile looks otherwise next time.
    let look = Look::at(&path);
    let known = known_hash(plan, key, look.as_ref(), database)?;
    let is_known = known.is_some();
    let origin = Origin {
        // A file that can't be read has no hash; reading it says why.
        file_hash: known.or_else(|| read_hash(key, &path)).unwrap_or_default(),
        model_hash: rig.model_hash.clone(),
        options: plan.reading.in_words(),
    };
    let look = look.filter(|_| !origin.file_hash.is_empty());
    if !plan.again && !origin.file_hash.is_empty() && lock(database).has(key, &origin)? {
        if let Some(look) = look.filter(|_| !is_known) {
            lock(database).remember(key, &look, &origin.file_hash)?;
        }
        return Ok(false);
    }
    log::debug!("studying {key}");
    let row = measure::measure(plan.folder, rig, key, origin, &plan.reading);
    lock(database).put(&row, look.as_ref())?;
    log::debug!("kept {key}");
    Ok(true)
}

/// The hash of a file that looks as it did last time.
fn known_hash(
    plan: &Plan,
    key: &Key,
    look: Option<&Look>,
    database: &Mutex<Database>,
) -> Result<Option<String>, DatabaseError> {
    match look {
        Some(look) if !plan.again => lock(database).hash_of(key, look),
        _ => Ok(None),
    }
}

fn read_hash(key: &Key, path: &Path) -> Option<String> {
    log::debug!("hashing {key}");
    hash::of_file(path).ok()
}

fn diagnose(
    plan: &Plan,
    found: &Found,
    database: &Mutex<Database>,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<(), DatabaseError> {
    each(&found.rigs, plan.n_jobs, stop, |rig| {
        let (view, earlier) = {
            let database = lock(database);
            (RigView::new(&rig.name, database.rows(&rig.name)?), database.diagnosis(&rig.name)?)
        };
        let mut row = summary(&view);
        row.diagnosis = diagnosis::reason(&view).and_then(|swings| {
            let from = diagnosis::origin(&swings);
            if let Some(known) = earlier.filter(|known| known.from == from && !plan.again) {
                return Some(known);
            }
            progress(Progress::Diagnoses(&rig.name));
            diagnosis::diagnosed(plan.folder, rig, &swings, &plan.reading)
        });
        lock(database).put_rig(&row)
    })
}

/// A rig's row, without a diagnosis.
fn summary(view: &RigView) -> RigRow {
    let mean = |symbol: &str| {
        let mean = view.friction_of(symbol)?.mean;
        Some((mean.value, mean.std_error?))
    };
    RigRow {
        rig: view.name.clone(),
        model_hash: view.rows.last().map_or(String::new(), |row| row.origin.model_hash.clone()),
        n_recordings: view.rows.len(),
        n_fitted: view.n_fitted(),
        coulomb: mean("Mc"),
        viscous: mean("Mw"),
        findings: view.findings.iter().map(|finding| finding.words.clone()).collect(),
        diagnosis: None,
    }
}

/// All that a database knows, rig by rig.
#[derive(Clone, Debug)]
pub struct Study {
    /// Every rig, by name.
    pub rigs: Vec<RigView>,
    /// Their diagnoses, by name.
    pub diagnoses: BTreeMap<String, database::Diagnosed>,
    /// The rigs among each other.
    pub between: Vec<between::Between>,
}

impl Study {
    /// Reads a database.
    ///
    /// # Errors
    /// It fails.
    pub fn of(database: &Database) -> Result<Self, DatabaseError> {
        let (mut rigs, mut diagnoses) = (Vec::new(), BTreeMap::new());
        for name in database.rigs()? {
            rigs.push(RigView::new(&name, database.rows(&name)?));
            diagnoses.extend(database.diagnosis(&name)?.map(|diagnosis| (name, diagnosis)));
        }
        Ok(Self { between: between::between(&rigs), rigs, diagnoses })
    }

    /// The rig of the study's own folder by the name of that, where no other rig has it.
    pub fn named_after(mut self, folder: &Path) -> Self {
        let name = folder.canonicalize().ok().and_then(|path| Some(path.file_name()?.to_str()?.to_owned()));
        let Some(name) = name.filter(|name| self.rigs.iter().all(|rig| rig.name != *name)) else { return self };
        let places = self.between.iter_mut().flat_map(|between| &mut between.rigs).map(|place| &mut place.rig);
        let names = self.rigs.iter_mut().map(|rig| &mut rig.name).chain(places);
        names.filter(|it| *it == ROOT).for_each(|it| it.clone_from(&name));
        if let Some(diagnosis) = self.diagnoses.remove(ROOT) {
            self.diagnoses.insert(name, diagnosis);
        }
        self
    }

    /// Rigs that stand out from the others, each with a sentence; what is said of a model that lacks something is
    /// doubtful.
    pub fn standing_out(&self) -> Vec<(&str, String)> {
        let words = |between: &between::Between, place: &between::Place| {
            let lacks = self.diagnoses.get(&place.rig).filter(|diagnosis| !diagnosis.missing.is_empty());
            let doubt = lacks.map_or(String::new(), |diagnosis| {
                format!(
                    "; but its model lacks {}, so that this may be no friction at all",
                    diagnosis.missing.join(", ")
                )
            });
            between.in_words(place) + &doubt
        };
        let of = |between| {
            let between: &between::Between = between;
            let out = between.rigs.iter().filter(|place| place.stands_out);
            out.map(move |place| (place.rig.as_str(), words(between, place)))
        };
        self.between.iter().flat_map(of).collect()
    }

    /// Recordings without a fit, or that count for nothing, and why.
    pub fn problems(&self) -> Vec<Problem> {
        let told = |view: &RigView| {
            let failed = view.rows.iter().filter_map(|row| {
                let why = row.outcome.as_ref().err()?.clone();
                Some(Problem { what: row.key.to_string(), why })
            });
            let left_out = view
                .left_out
                .iter()
                .map(|(idx, why)| Problem { what: view.rows[*idx].key.to_string(), why: why.clone() });
            failed.chain(left_out).collect::<Vec<_>>()
        };
        self.rigs.iter().flat_map(told).collect()
    }
}

/// A worker that panicked left the database whole: a transaction that is not finished is taken back.
fn lock(database: &Mutex<Database>) -> std::sync::MutexGuard<'_, Database> {
    database.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_is_in_one_shard_and_shards_are_alike() {
        let key = |idx: usize| Key { rig: format!("rig-{}", idx % 7), recording: format!("swing-{idx}.csv") };
        let mut sizes = [0; 4];
        for idx in 0..4000 {
            let of: Vec<usize> =
                (0..4).filter(|number| Shard { number: *number as u64 + 1, of: 4 }.has(&key(idx))).collect();
            assert_eq!(of.len(), 1);
            sizes[of[0]] += 1;
        }
        assert!(sizes.iter().all(|size| (900..1100).contains(size)), "{sizes:?}");
    }

    #[test]
    fn a_rig_in_the_folder_itself_is_called_as_that() {
        let folder = tempfile::tempdir().unwrap();
        let lab = folder.path().join("lab-3");
        std::fs::create_dir(&lab).unwrap();
        let view = |name: &str| RigView::new(name, vec![rig::tests::row("1.csv", 1.0, 0.1)]);
        let diagnosis = database::Diagnosed { from: String::new(), missing: Vec::new(), words: "drag".to_owned() };
        let named = |names: &[&str]| {
            let rigs: Vec<RigView> = names.iter().map(|name| view(name)).collect();
            let diagnoses = BTreeMap::from([(ROOT.to_owned(), diagnosis.clone())]);
            let study = Study { between: between::between(&rigs), rigs, diagnoses }.named_after(&lab);
            let names = study.rigs.iter().map(|rig| rig.name.clone()).collect::<Vec<_>>();
            (names, study.diagnoses.into_keys().collect::<Vec<_>>())
        };
        assert_eq!(named(&[".", "other"]), (vec!["lab-3".to_owned(), "other".to_owned()], vec!["lab-3".to_owned()]));
        assert_eq!(named(&[".", "lab-3"]).0, [".", "lab-3"]);
    }

    #[test]
    fn a_rig_is_kept_with_the_means_of_its_friction_and_their_standard_errors() {
        let rows =
            [("1.csv", 1.0), ("2.csv", 2.0), ("3.csv", 3.0)].map(|(name, value)| rig::tests::row(name, value, 0.1));
        let found = summary(&RigView::new("rig", rows.to_vec()));
        assert_eq!((found.n_recordings, found.n_fitted), (3, 3));
        let (value, std_error) = found.coulomb.unwrap();
        assert!((value - 2.0).abs() < 1e-12 && (std_error - 1.0 / 3f64.sqrt()).abs() < 1e-12, "{value} ± {std_error}");
        assert!((found.viscous.unwrap().0 - 0.2).abs() < 1e-12);
    }
}
