//! Files of other programs that are no plain tables of text: each becomes one, with its names and units.
//!
//! A format is one file here and one line in [`Kind`]. What is not understood is refused with what to do in the other
//! program.

mod json;
mod labview;
mod mat4;
mod mat5;
mod matlab;
mod zipped;

use super::error::Fault;

/// What a file is, by its first bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// phyphox exports an archive of CSV files; workbooks are archives too.
    Zip,
    /// MATLAB, versions 4 to 7.
    Matlab,
    /// HDF5, which MATLAB 7.3 writes.
    Hdf5,
    /// Workbooks of old spreadsheets.
    OldWorkbook,
    /// LabVIEW measurement file, text.
    LabView,
    /// JSON: an object a line, or one array or object.
    Json,
    /// XML or HTML: projects of Tracker and others.
    Markup,
}

impl Kind {
    /// `None` for a table of text, or for what nobody knows.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        let begins = |text: &str| head.starts_with(text.as_bytes());
        let first = head.iter().find(|byte| !byte.is_ascii_whitespace());
        let is_json = first == Some(&b'{') || (first == Some(&b'[') && head.iter().any(|byte| b"{\"".contains(byte)));
        match () {
            () if begins("PK\x03\x04") => Some(Self::Zip),
            () if head.starts_with(b"\xd0\xcf\x11\xe0") => Some(Self::OldWorkbook),
            () if begins("MATLAB 7.3") || head.starts_with(b"\x89HDF") => Some(Self::Hdf5),
            () if begins("MATLAB 5.0") || mat5::begins(head) || mat4::begins(head) => Some(Self::Matlab),
            () if begins("LabVIEW Measurement") => Some(Self::LabView),
            () if is_json => Some(Self::Json),
            () if is_markup(head) => Some(Self::Markup),
            () => None,
        }
    }

    /// The file as a table of text; that of an archive has a name of its own.
    pub(super) fn table(self, bytes: &[u8], notes: &mut Vec<String>) -> Result<(Vec<u8>, Option<String>), Fault> {
        let text = match self {
            Self::Zip => return zipped::table(bytes, notes).map(|(text, name)| (text, Some(name))),
            Self::Matlab => matlab::table(bytes),
            Self::Hdf5 => Err(refused(
                "HDF5 file",
                "in MATLAB save it in an older form: save('swing.mat', 't', 'theta', '-v7'); or export it as CSV",
            )),
            Self::OldWorkbook => Err(refused("workbook of a spreadsheet", "save the sheet as CSV in that program")),
            Self::LabView => labview::table(bytes),
            Self::Json => json::table(bytes),
            Self::Markup => Err(refused(
                "file of XML or HTML",
                "Tracker (.trk), Logger Pro (.cmbl) and CASSY Lab (.labx) keep their projects so; open it there, and \
                 export the table with time and angle as text or CSV",
            )),
        };
        text.map(|text| (text, None))
    }
}

/// Does it begin with a tag?
fn is_markup(head: &[u8]) -> bool {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    text.first() == Some(&b'<') && text.get(1).is_some_and(|next| next.is_ascii_alphabetic() || b"?!".contains(next))
}

/// A format that is known, in a form that is not read.
fn refused(format: &'static str, problem: &str) -> Fault {
    Fault::Foreign { format, problem: problem.to_owned() }
}

/// A table of numbers as text, with a line of names if there are some; shorter columns end in empty cells.
fn text_of(names: &[String], columns: &[Vec<f64>]) -> Vec<u8> {
    let quoted = |name: &String| format!("\"{}\"", name.replace(['"', '\n', '\r'], " "));
    let mut text = names.iter().map(quoted).collect::<Vec<_>>().join(";");
    if !names.is_empty() {
        text.push('\n');
    }
    let n_rows = columns.iter().map(Vec::len).max().unwrap_or(0);
    for row in 0..n_rows {
        for (idx, column) in columns.iter().enumerate() {
            if idx > 0 {
                text.push(';');
            }
            if let Some(number) = column.get(row) {
                text.push_str(&number.to_string());
            }
        }
        text.push('\n');
    }
    text.into_bytes()
}
