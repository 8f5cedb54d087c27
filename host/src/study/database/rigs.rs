//! What the database says of each rig.

use super::super::measure::PROGRAM;
use super::{Database, Result};
use rusqlite::{OptionalExtension, params};

/// What was said of a rig; see [`Database::put_rig`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigRow {
    /// Its folder within the study.
    pub rig: String,
    /// SHA-256 of its model file.
    pub model_hash: String,
    /// How many recordings it has.
    pub n_recordings: usize,
    /// How many of them have a fit.
    pub n_fitted: usize,
    /// Mean of Mc and its standard error, N·m.
    pub coulomb: Option<(f64, f64)>,
    /// Mean of Mw and its standard error, N·m·s/rad.
    pub viscous: Option<(f64, f64)>,
    /// What was found, a sentence each.
    pub findings: Vec<String>,
    /// The diagnosis, if there was reason for one.
    pub diagnosis: Option<Diagnosed>,
}

/// A diagnosis of a rig.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Diagnosed {
    /// Recordings and hashes it was made from.
    #[serde(skip)]
    pub from: String,
    /// Effects that are missing from the model.
    pub missing: Vec<String>,
    /// The same in a sentence.
    pub words: String,
}

impl Database {
    /// Writes what is said of a rig.
    pub fn put_rig(&mut self, row: &RigRow) -> Result<()> {
        let query = "INSERT OR REPLACE INTO rig VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)";
        let diagnosis = row.diagnosis.as_ref();
        let written = self.connection.execute(
            query,
            params![
                row.rig,
                row.model_hash,
                PROGRAM,
                row.n_recordings,
                row.n_fitted,
                row.coulomb.map(|(mean, _)| mean),
                row.coulomb.map(|(_, std)| std),
                row.viscous.map(|(mean, _)| mean),
                row.viscous.map(|(_, std)| std),
                row.findings.join("\n"),
                diagnosis.map(|diagnosis| &diagnosis.from),
                diagnosis.map(|diagnosis| diagnosis.missing.join(",")),
                diagnosis.map(|diagnosis| &diagnosis.words),
            ],
        );
        written.map(drop).map_err(|error| self.told(error))
    }

    /// The diagnosis of a rig, if there is one.
    pub fn diagnosis(&self, rig: &str) -> Result<Option<Diagnosed>> {
        let query = "SELECT diagnosed, missing, diagnosis FROM rig WHERE rig = ?1 AND diagnosed IS NOT NULL";
        let read = |row: &rusqlite::Row| {
            let missing: String = row.get(1)?;
            let missing = missing.split(',').filter(|name| !name.is_empty()).map(str::to_owned).collect();
            Ok(Diagnosed { from: row.get(0)?, missing, words: row.get(2)? })
        };
        self.connection.query_row(query, [rig], read).optional().map_err(|error| self.told(error))
    }
}
