//! Files of other programs that are no plain tables of text: each becomes one, with its names and units.
//!
//! A format is one file here and one line in [`Kind`]. What is not understood is refused with what to do in the other
//! program.

mod archive;
mod as_text;
mod biff;
mod cassy;
mod cassy1;
mod compound;
mod json;
mod kind;
mod labview;
mod lists;
mod little;
mod mat4;
mod mat5;
mod matlab;
mod matlab_runs;
mod numpy;
mod rate_beside;
mod sheets;
mod workbook;
mod zipped;

pub(super) use kind::Kind;

use super::error::Fault;
use as_text::refused;
use kind::UNREAD;

impl Kind {
    /// The file as a table of text; that of an archive has a name of its own.
    pub(super) fn table(self, bytes: &[u8], notes: &mut Vec<String>) -> Result<(Vec<u8>, Option<String>), Fault> {
        let text = match self {
            Self::Zip => return zipped::table(bytes, notes).map(|(text, name)| (text, Some(name))),
            Self::Numpy => numpy::table(bytes),
            Self::Matlab => matlab::table(bytes, notes),
            Self::Hdf5 => Err(refused(
                "HDF5 file",
                "in MATLAB save it in an older form: save('swing.mat', 't', 'theta', '-v7'); in Python with \
                 numpy.savetxt(\"swing.csv\", numpy.c_[t, theta]); or export it as CSV",
            )),
            Self::OldWorkbook => return biff::table(bytes, notes).map(|(text, name)| (text, Some(name))),
            Self::LabView => labview::table(bytes),
            Self::Json => json::table(bytes, notes),
            Self::Cassy1 => cassy1::table(bytes),
            Self::Lists => lists::table(bytes, notes),
            Self::Markup => markup(bytes, notes),
            Self::Unread(place) => {
                let (_, format, cure) = UNREAD.get(place).copied().unwrap_or((b"", "file", "export it as CSV"));
                Err(refused(format, cure))
            }
        };
        text.map(|text| (text, None))
    }
}

/// CASSY Lab 2 saves its projects unpacked too.
fn markup(bytes: &[u8], notes: &mut Vec<String>) -> Result<Vec<u8>, Fault> {
    let text = String::from_utf8_lossy(bytes);
    match cassy::is_project(&text) {
        true => cassy::table(&text, notes),
        false => Err(project("file of XML or HTML")),
    }
}

/// What a program keeps for itself, and where the table is to be had.
fn project(format: &'static str) -> Fault {
    refused(
        format,
        "Tracker (.trk), Logger Pro (.cmbl) and phyphox (.phyphox) keep their projects so; open it there, and export the table \
         with time and angle as text or CSV",
    )
}
