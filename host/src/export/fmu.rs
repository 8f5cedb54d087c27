//! The model as a functional mock-up unit: an archive (`.fmu`) that Simulink, OpenModelica and others simulate.
//!
//! FMI 3.0.1 (fmi-standard.org), co-simulation: the C header (`c.rs`) behind the standard's functions
//! (`fmu/interface.c`), its description, its sources, and the library for this computer if a C compiler is there.

mod binary;
mod description;

use super::{ExportError, c, culprit, laws, numbers, trace::Trace};
use crate::rigfile::RigFile;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;

/// What the standard's functions belong to: the name of the library, and of the model in other programs.
const IDENTIFIER: &str = "pendulum_rig";

const INTERFACE: &str = include_str!("fmu/interface.c");
const TYPES: &str = include_str!("fmu/fmi.h");

/// An archive, not yet written.
#[derive(Clone, Debug)]
pub struct Fmu {
    /// Its bytes.
    pub archive: Vec<u8>,
    /// The files in it.
    pub files: Vec<String>,
    /// Why it holds no library for this computer, if so: other programs then compile the sources.
    pub not_compiled: Option<String>,
}

/// The unit of a model.
///
/// # Errors
/// As [`super::export`], or an archive that can't be made.
pub fn fmu(file: &RigFile) -> Result<Fmu, ExportError> {
    let parameters = file.parameters();
    let trace = Trace::of(parameters).ok_or_else(|| culprit(parameters))?;
    let numbers = numbers(file);
    let model = c::header(&numbers, &trace, &laws(parameters), c::Numbers::Given);
    let token = token(&model);
    let model = model.replacen("#include <math.h>", &format!("#include <math.h>\n\n#define RIG_TOKEN \"{token}\""), 1);

    let sources = [("interface.c", INTERFACE), ("fmi.h", TYPES), ("rig.h", model.as_str())];
    let (library, not_compiled) = match binary::compiled(IDENTIFIER, &sources) {
        Ok(library) => (Some(library), None),
        Err(why) => (None, Some(why)),
    };
    let mut entries = vec![
        ("modelDescription.xml".to_owned(), description::model(IDENTIFIER, &token, &numbers).into_bytes()),
        ("sources/buildDescription.xml".to_owned(), description::build(IDENTIFIER).into_bytes()),
    ];
    entries.extend(sources.map(|(name, text)| (format!("sources/{name}"), text.as_bytes().to_vec())));
    entries.extend(library);
    let archive = packed(&entries).map_err(|error| ExportError::Archive { why: error.to_string() })?;
    Ok(Fmu { archive, files: entries.into_iter().map(|(name, _)| name).collect(), not_compiled })
}

/// Ties description and library together: equal models have equal ones.
fn token(model: &str) -> String {
    let mut hasher = DefaultHasher::new();
    (model, INTERFACE).hash(&mut hasher);
    format!("{{{IDENTIFIER}-{:016x}}}", hasher.finish())
}

/// Equal entries give equal bytes: none carries the time.
fn packed(entries: &[(String, Vec<u8>)]) -> Result<Vec<u8>, ZipError> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        archive.start_file(name, SimpleFileOptions::default().last_modified_time(zip::DateTime::default()))?;
        archive.write_all(bytes)?;
    }
    Ok(archive.finish()?.into_inner())
}
