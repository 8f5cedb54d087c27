//! `host study`: many recordings of many rigs, one row each, and what they say together.

mod result;
mod screen;

use super::columns::Reading;
use super::{interrupt, output};
use crate::error::Failure;
use crate::study::database::{Database, DatabaseError};
use crate::study::measure;
use crate::study::page::page;
use crate::study::table::table;
use crate::study::{Done, Plan, Shard, Study, bring_up_to_date};
use clap::Args;
use screen::Screen;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Fit every recording of many rigs once: which bearing wears, which rig differs?
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// A folder with a rig.toml a rig, and each rig's recordings beside or below it
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Where results are kept; FOLDER/study.sqlite if it is not said
    #[arg(long, value_name = "FILE.sqlite")]
    database: Option<PathBuf>,
    /// Take over what other databases of this study hold (may be repeated)
    #[arg(long, value_name = "FILE.sqlite")]
    join: Vec<PathBuf>,
    /// Write a page for the browser: friction over time, control limits, what was found
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Write every recording with its numbers as one table
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Replace a page and a table that exist there
    #[arg(long)]
    force: bool,
    /// Look at no recording: tell what the database knows
    #[arg(long, conflicts_with_all = ["join", "shard", "again", "jobs"])]
    as_is: bool,
    /// Do also what is done already
    #[arg(long)]
    again: bool,
    /// Do not ask what is missing from models that leave more than the noise
    #[arg(long)]
    no_diagnosis: bool,
    /// Only the K-th of N parts, which are joined later; without diagnosis
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<Shard>,
    /// So many recordings at a time; as many as there are cores if it is not said
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

const EXAMPLE: &str = "\
Example:
  host study lab --report lab.html             lab/rig-1/rig.toml, lab/rig-1/monday.csv …
  host study lab --report lab.html --force     a day later: only what is new is fitted
  host study lab --shard 1/8 --database 1.sqlite
  host study lab --join 1.sqlite --join 2.sqlite --csv lab.csv

Killed or interrupted, the same command goes on where it was.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    options.reading.check()?;
    let path = options.database.clone().unwrap_or_else(|| options.folder.join("study.sqlite"));
    check(options, &path)?;
    let is_new = !path.exists();
    let (database, done) = if options.as_is {
        (Database::look_at(&path).map_err(told)?, None)
    } else {
        let (database, done) = update(options, &path)?;
        (database, Some(done))
    };
    let study = Study::of(&database).map_err(told)?.named_after(&options.folder);
    let is_kept = !is_new || !study.rigs.is_empty() || options.shard.is_some() || !options.join.is_empty();
    if !is_kept {
        database.remove().map_err(told)?;
    }
    result::show(options.json, is_kept.then_some(&*path), &study, done.as_ref());
    if let Some(path) = &options.csv {
        output::write(path, &table(&study.rigs), options.force)?;
    }
    if let Some(path) = &options.report {
        output::write(path, &page(&study), options.force)?;
    }
    Ok(())
}

fn check(options: &Options, database: &Path) -> Result<(), Failure> {
    if !options.folder.is_dir() {
        return Err(Failure::wrong_use(format!("{} is no folder", options.folder.display()))
            .next("name the folder that holds a folder with a rig.toml for each rig"));
    }
    let writes: Vec<&Path> = options.report.iter().chain(&options.csv).map(PathBuf::as_path).collect();
    let reads: Vec<&Path> = options.join.iter().map(PathBuf::as_path).chain([database]).collect();
    output::check(&writes, &reads, options.force)
}

/// Joins, studies what is missing, and shows how far it is; ends the program if it is interrupted.
fn update(options: &Options, path: &Path) -> Result<(Database, Done), Failure> {
    let mut database = Database::open(path).map_err(told)?;
    for other in &options.join {
        let n_taken = database.join(&Database::look_at(other).map_err(told)?).map_err(told)?;
        output::say(&format!("{n_taken} recordings taken over from {}", other.display()));
    }
    let plan = plan(options);
    let database = Mutex::new(database);
    let screen = Screen::new();
    let done = interrupt::orderly(|stop| bring_up_to_date(&plan, &database, &|step| screen.show(&step), stop));
    drop(screen);
    let done = done.map_err(told)?;
    let database = database.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    if done.is_stopped {
        drop(database);
        output::say(&format!("stopped: {} recordings are kept; the same command goes on from there", done.n_studied));
        interrupt::end();
    }
    if done.n_found == 0 && done.problems.is_empty() && options.shard.is_none() {
        let folder = options.folder.display();
        output::warn(&format!(
            "{folder} holds no recording beside a rig.toml: each rig needs a folder with its rig.toml and its recordings"
        ));
    }
    Ok((database, done))
}

fn plan(options: &Options) -> Plan<'_> {
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    Plan {
        folder: &options.folder,
        reading: measure::Reading { read: options.reading.options(), segment: options.reading.segment() },
        n_jobs: options.jobs.map_or_else(cores, NonZeroUsize::get),
        shard: options.shard,
        again: options.again,
        diagnose: !options.no_diagnosis,
    }
}

fn told(error: DatabaseError) -> Failure {
    let failure = match error {
        DatabaseError::Refused { .. } => Failure::failed(&error),
        _ => Failure::wrong_use(&error),
    };
    failure.next(error.next_step())
}

/// `2/8`: the second of eight parts.
fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
    match parts {
        Some((number, of)) if (1..=of).contains(&number) => Ok(Shard { number, of }),
        _ => Err("expected K/N with K from 1 to N, such as 2/8".to_owned()),
    }
}
