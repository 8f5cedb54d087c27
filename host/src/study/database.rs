//! The study's database: one SQLite file that several programs may write at once, and that a kill at any moment leaves
//! whole.
//!
//! A recording is one transaction: its row and its numbers are there together or not at all, and are on the disk when
//! the transaction ends (write-ahead log, synchronous). Who finds the file locked waits. `application_id` and
//! `user_version` say whose file it is and which tables it has.

mod error;
mod files;
mod recordings;
mod rigs;

use super::look::Look;
use super::row::{Key, Origin, Row};
pub use error::DatabaseError;
use error::refused;
use recordings::{put, rows};
pub use rigs::{Diagnosed, RigRow};
use rusqlite::{Connection, OpenFlags, TransactionBehavior, params};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Version of the tables.
pub const VERSION: i32 = 1;

/// Marks a file as a study: `pend` in ASCII.
const APPLICATION: i32 = 0x7065_6e64;

const SCHEMA: &str = include_str!("schema.sql");

/// Others write a recording in milliseconds; only what hangs locks the file so long.
const BUSY: Duration = Duration::from_secs(120);

/// An open database.
#[derive(Debug)]
pub struct Database {
    connection: Connection,
    path: PathBuf,
}

/// The file as an address that says that nobody writes to it. Source: "Uniform Resource Identifiers", sqlite.org/uri.html.
fn unchanging(path: &Path) -> String {
    let escapes = [('%', "%25"), ('?', "%3f"), ('#', "%23")];
    let name = escapes.iter().fold(path.display().to_string(), |name, (sign, escape)| name.replace(*sign, escape));
    format!("file:{name}?immutable=1")
}

type Result<T> = std::result::Result<T, DatabaseError>;

impl Database {
    /// Opens a database, or begins one.
    ///
    /// # Errors
    /// It is not a study's, of another version, or the system refuses.
    pub fn open(path: &Path) -> Result<Self> {
        let connection = Connection::open(path).map_err(|source| refused(path, source))?;
        let mut database = Self { connection, path: path.to_owned() };
        database.prepare().map_err(|error| database.told(error))?;
        database.check()?;
        Ok(database)
    }

    /// Closes it and takes it away: a study of nothing leaves nothing.
    ///
    /// # Errors
    /// The system refuses.
    pub fn remove(self) -> Result<()> {
        let Self { connection, path } = self;
        // Whoever closes it last takes away what lies beside it.
        connection.close().map_err(|(_, source)| refused(&path, source))?;
        std::fs::remove_file(&path)
            .map_err(|error| refused(&path, rusqlite::Error::ToSqlConversionFailure(error.into())))
    }

    /// Opens one to be looked at, also where nothing may be written.
    ///
    /// # Errors
    /// As [`Database::open`], and there is none.
    pub fn look_at(path: &Path) -> Result<Self> {
        if !path.is_file() {
            return Err(DatabaseError::Missing { path: path.to_owned() });
        }
        let connection = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY)
            .map_err(|source| refused(path, source))?;
        let database = Self { connection, path: path.to_owned() };
        database.connection.busy_timeout(BUSY).map_err(|error| database.told(error))?;
        if database.check().is_ok() {
            return Ok(database);
        }
        // Beside a file in a read-only folder SQLite can't keep its log; nobody can write there either.
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
        let connection =
            Connection::open_with_flags(unchanging(path), flags).map_err(|source| refused(path, source))?;
        let database = Self { connection, path: path.to_owned() };
        database.check()?;
        Ok(database)
    }

    fn prepare(&mut self) -> rusqlite::Result<()> {
        self.connection.busy_timeout(BUSY)?;
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let n_tables: i64 = transaction.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))?;
        let version: i32 = transaction.pragma_query_value(None, "user_version", |row| row.get(0))?;
        if n_tables == 0 && version == 0 {
            transaction.execute_batch(SCHEMA)?;
            transaction.pragma_update(None, "application_id", APPLICATION)?;
            transaction.pragma_update(None, "user_version", VERSION)?;
        }
        let application: i32 = transaction.pragma_query_value(None, "application_id", |row| row.get(0))?;
        if application == APPLICATION {
            transaction.execute_batch(files::SCHEMA)?;
        }
        transaction.commit()?;
        // Where another program is just doing the same, it is done; both kinds of journal are safe.
        let _ = self.connection.pragma_update(None, "journal_mode", "wal");
        self.connection.pragma_update(None, "synchronous", "full")
    }

    fn check(&self) -> Result<()> {
        let pragma = |name: &str| self.connection.pragma_query_value(None, name, |row| row.get::<_, i32>(0));
        let (application, found) = pragma("application_id")
            .and_then(|application| Ok((application, pragma("user_version")?)))
            .map_err(|error| self.told(error))?;
        match (application, found) {
            (APPLICATION, VERSION) => Ok(()),
            (APPLICATION, found) => Err(DatabaseError::Version { path: self.path.clone(), found }),
            _ => Err(DatabaseError::Foreign { path: self.path.clone() }),
        }
    }

    fn told(&self, error: rusqlite::Error) -> DatabaseError {
        refused(&self.path, error)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Was this recording studied from just this origin?
    ///
    /// # Errors
    /// SQLite refuses; so with all below.
    pub fn has(&self, key: &Key, origin: &Origin) -> Result<bool> {
        let query = "SELECT 1 FROM recording WHERE rig = ?1 AND recording = ?2 AND file_hash = ?3 AND model_hash = ?4 \
                     AND options = ?5";
        let Origin { file_hash, model_hash, options } = origin;
        let found = self
            .connection
            .prepare_cached(query)
            .and_then(|mut query| query.exists(params![key.rig, key.recording, file_hash, model_hash, options]));
        found.map_err(|error| self.told(error))
    }

    /// Writes a recording's row in place of any earlier one, and how its file looked, in one transaction.
    pub fn put(&mut self, row: &Row, look: Option<&Look>) -> Result<()> {
        let written =
            self.connection.transaction_with_behavior(TransactionBehavior::Immediate).and_then(|transaction| {
                put(&transaction, row)?;
                if let Some(look) = look {
                    files::remember(&transaction, &row.key, look, &row.origin.file_hash)?;
                }
                transaction.commit()
            });
        written.map_err(|error| self.told(error))
    }

    /// Takes over what another database knows better: recordings that this one lacks or that were studied later there.
    /// The order in which several are joined makes no difference. Gives how many were taken over.
    pub fn join(&mut self, other: &Self) -> Result<usize> {
        let mut n_taken = 0;
        for rig in other.rigs()? {
            let (theirs, ours) = (other.rows(&rig)?, self.rows(&rig)?);
            let better = |row: &&Row| {
                let mine = ours.binary_search_by(|mine| mine.key.cmp(&row.key)).map(|idx| &ours[idx]);
                mine.is_ok_and(|mine| rank(row) > rank(mine)) || mine.is_err()
            };
            let better: Vec<&Row> = theirs.iter().filter(better).collect();
            n_taken += better.len();
            let written =
                self.connection.transaction_with_behavior(TransactionBehavior::Immediate).and_then(|transaction| {
                    better.iter().try_for_each(|row| put(&transaction, row))?;
                    transaction.commit()
                });
            written.map_err(|error| self.told(error))?;
        }
        Ok(n_taken)
    }

    /// Every rig that has a recording, by name.
    pub fn rigs(&self) -> Result<Vec<String>> {
        let query = "SELECT DISTINCT rig FROM recording ORDER BY rig";
        let found =
            self.connection.prepare(query).and_then(|mut query| query.query_map([], |row| row.get(0))?.collect());
        found.map_err(|error| self.told(error))
    }

    /// Every recording of a rig, by name.
    pub fn rows(&self, rig: &str) -> Result<Vec<Row>> {
        rows(&self.connection, rig).map_err(|error| self.told(error))
    }
}

/// The later of two rows counts; of two at once any, but always the same.
fn rank(row: &Row) -> (&str, &str, &str, &str) {
    (&row.studied, &row.origin.file_hash, &row.origin.model_hash, &row.origin.options)
}

#[cfg(test)]
mod tests {
    use super::super::row::{Number, Outcome};
    use super::*;

    fn row(recording: &str, studied: &str, value: f64) -> Row {
        let text = str::to_owned;
        let number = Number {
            symbol: text("Mc"),
            effect: text("coulomb"),
            unit: text("N·m"),
            value,
            std: Some(0.1 * value),
            upper: None,
            status: text("identified"),
        };
        let outcome = Outcome {
            n_samples: 46_000,
            duration_s: 46.0,
            amplitude_rad: 1.5,
            period_s: None,
            noise_rad: 1e-3,
            error_rad: 1.1e-3,
            left: text("noise"),
            notes: vec![text("cut 0.5 s"), text("one more")],
            numbers: vec![number],
        };
        Row {
            key: Key { rig: text("a"), recording: text(recording) },
            origin: Origin { file_hash: text("f"), model_hash: text("m"), options: String::new() },
            program: text("0"),
            studied: text(studied),
            recorded: None,
            outcome: Ok(outcome),
        }
    }

    fn opened(folder: &tempfile::TempDir, name: &str) -> Database {
        Database::open(&folder.path().join(name)).unwrap()
    }

    #[test]
    fn what_is_put_comes_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let mut database = opened(&folder, "a.sqlite");
        let broken = Row { outcome: Err("it is empty".to_owned()), ..row("z.csv", "1", 0.0) };
        let written = vec![row("a.csv", "1", 0.1 + 0.2), row("b.csv", "1", std::f64::consts::PI), broken];
        written.iter().for_each(|row| database.put(row, None).unwrap());
        drop(database);
        let database = opened(&folder, "a.sqlite");
        assert_eq!(database.rows("a").unwrap(), written);
        assert!(database.has(&written[0].key, &written[0].origin).unwrap());
        let changed = Origin { file_hash: "other".to_owned(), ..written[0].origin.clone() };
        assert!(!database.has(&written[0].key, &changed).unwrap());
    }

    #[cfg(unix)]
    #[test]
    fn in_a_folder_of_any_name_one_is_looked_at_without_writing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("100% #1?");
        let mut database = Database::open(&path).unwrap();
        database.put(&row("a.csv", "1", 1.0), None).unwrap();
        drop(database);
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
        let connection = Connection::open_with_flags(unchanging(&path), flags).unwrap();
        assert_eq!(Database { connection, path }.rows("a").unwrap().len(), 1);
    }

    #[test]
    fn the_later_row_counts_whatever_the_order_of_joining() {
        let folder = tempfile::tempdir().unwrap();
        let mut parts = Vec::new();
        for (name, rows) in [("1", [("a.csv", "1"), ("b.csv", "3")]), ("2", [("a.csv", "2"), ("c.csv", "1")])] {
            let mut part = opened(&folder, name);
            let value = name.parse().unwrap();
            rows.iter().for_each(|(recording, studied)| part.put(&row(recording, studied, value), None).unwrap());
            parts.push(part);
        }
        let joined = |order: [usize; 2], name: &str| {
            let mut all = opened(&folder, name);
            order.iter().for_each(|idx| {
                all.join(&parts[*idx]).unwrap();
            });
            all.rows("a").unwrap()
        };
        let both = joined([0, 1], "both");
        assert_eq!(both, joined([1, 0], "reversed"));
        assert_eq!(both, [row("a.csv", "2", 2.0), row("b.csv", "3", 1.0), row("c.csv", "1", 2.0)]);
    }

    #[test]
    fn files_of_others_and_of_other_versions_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.sqlite");
        opened(&folder, "a.sqlite").connection.pragma_update(None, "user_version", 7).unwrap();
        assert!(matches!(Database::open(&path), Err(DatabaseError::Version { found: 7, .. })));
        assert!(matches!(Database::look_at(&path), Err(DatabaseError::Version { found: 7, .. })));
        opened(&folder, "b.sqlite").connection.pragma_update(None, "application_id", 1).unwrap();
        assert!(matches!(Database::open(&folder.path().join("b.sqlite")), Err(DatabaseError::Foreign { .. })));
        std::fs::write(&path, "a text, longer than the header of a database has to be, which is 100 bytes. ".repeat(9))
            .unwrap();
        assert!(matches!(Database::open(&path), Err(DatabaseError::Foreign { .. })));
        assert!(matches!(Database::look_at(&folder.path().join("no")), Err(DatabaseError::Missing { .. })));
    }
}
