//! Hashes of the files as they were last looked at, beside the recordings' rows: a study that is run again reads only
//! files that look otherwise. Nothing but time is lost with this table; it takes no part when databases are joined.

use super::{Database, Result};
use crate::study::look::Look;
use crate::study::row::Key;
use rusqlite::{Connection, OptionalExtension};

/// Databases from before it have it added; programs from before it pass it over.
pub(super) const SCHEMA: &str = "CREATE TABLE IF NOT EXISTS file (
    rig       TEXT NOT NULL,
    recording TEXT NOT NULL,
    look      TEXT NOT NULL,   -- size, bytes; times of change, ns
    file_hash TEXT NOT NULL,   -- SHA-256
    PRIMARY KEY (rig, recording)
) STRICT, WITHOUT ROWID";

impl Database {
    /// The hash of a file that looks as it did when it was hashed.
    ///
    /// # Errors
    /// SQLite refuses; so with all below.
    pub fn hash_of(&self, key: &Key, look: &Look) -> Result<Option<String>> {
        let query = "SELECT file_hash FROM file WHERE rig = ?1 AND recording = ?2 AND look = ?3";
        let found = self
            .connection
            .prepare_cached(query)
            .and_then(|mut query| query.query_row([&key.rig, &key.recording, &look.0], |row| row.get(0)).optional());
        found.map_err(|error| self.told(error))
    }

    /// Notes the hash of a file.
    pub fn remember(&self, key: &Key, look: &Look, file_hash: &str) -> Result<()> {
        remember(&self.connection, key, look, file_hash).map_err(|error| self.told(error))
    }
}

pub(super) fn remember(on: &Connection, key: &Key, look: &Look, file_hash: &str) -> rusqlite::Result<()> {
    let query = "INSERT OR REPLACE INTO file VALUES (?1, ?2, ?3, ?4)";
    on.prepare_cached(query)?.execute([&key.rig, &key.recording, &look.0, file_hash]).map(drop)
}
