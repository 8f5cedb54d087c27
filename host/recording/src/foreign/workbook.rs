//! Workbooks of spreadsheets (.xlsx), after ECMA-376, part 1, 18.3: the sheet that holds a table of numbers, with its text as
//! it stands there.
//!
//! phyphox exports a sheet of readings beside some of what the phone is. Nothing is calculated: a cell with a formula has
//! the value that the program left there.

use super::archive::unpacked;
use super::sheets::{self, Cell, MOST_COLUMNS, MOST_SHEETS, Row, Sheet};
use crate::error::Fault;
use std::io::Cursor;
use std::rc::Rc;
use zip::ZipArchive;

/// The table, and what its sheet is called.
pub(super) fn table(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    notes: &mut Vec<String>,
) -> Result<(Vec<u8>, String), Fault> {
    let shared = strings(&unpacked(archive, "xl/sharedStrings.xml").unwrap_or_default());
    let mut sheets = Vec::new();
    for (name, path) in sheets_of(archive)? {
        let rows = rows(&unpacked(archive, &path)?, &shared);
        sheets.push(Sheet { name, rows });
    }
    sheets::table(&sheets, notes)
}

/// The sheets by their names, in order, and where they lie.
fn sheets_of(archive: &mut ZipArchive<Cursor<&[u8]>>) -> Result<Vec<(String, String)>, Fault> {
    let relations = unpacked(archive, "xl/_rels/workbook.xml.rels").unwrap_or_default();
    let place = |id: &str| {
        let relation = tags(&relations).find(|tag| tag.name == "Relationship" && tag.attribute("Id") == Some(id))?;
        let target = relation.attribute("Target")?;
        Some(target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned))
    };
    let workbook = unpacked(archive, "xl/workbook.xml")?;
    let sheets = tags(&workbook).filter(|tag| tag.name == "sheet" && !tag.closes);
    let found = sheets.filter_map(|tag| Some((plain(tag.attribute("name")?), place(tag.attribute("r:id")?)?)));
    Ok(found.take(MOST_SHEETS).collect())
}

/// Texts that cells share.
fn strings(xml: &str) -> Vec<Rc<str>> {
    let mut strings: Vec<String> = Vec::new();
    for tag in tags(xml) {
        match (tag.name, tag.closes) {
            ("si", false) => strings.push(String::new()),
            ("t", false) => strings.last_mut().into_iter().for_each(|text| text.push_str(&plain(tag.behind))),
            _ => {}
        }
    }
    strings.into_iter().map(Rc::from).collect()
}

/// The rows that have something in them.
fn rows(xml: &str, shared: &[Rc<str>]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    // Of the cell that is open: its column, its type, and what stands in it.
    let (mut column, mut kind, mut value) = (0, "", String::new());
    for tag in tags(xml) {
        match (tag.name, tag.closes) {
            ("row", false) => {
                rows.push(Vec::new());
                column = 0;
            }
            ("c", false) => {
                column = tag.attribute("r").and_then(column_of).unwrap_or(column);
                kind = tag.attribute("t").unwrap_or("n");
                value.clear();
                column += usize::from(tag.is_empty);
            }
            ("v" | "t", false) => value.push_str(tag.behind),
            ("c", true) => {
                if let (Some(row), Some(cell), true) =
                    (rows.last_mut(), cell(kind, &value, shared), column < MOST_COLUMNS)
                {
                    row.push((column, cell));
                }
                column += 1;
            }
            _ => {}
        }
    }
    rows.retain(|row| !row.is_empty());
    rows
}

fn cell(kind: &str, value: &str, shared: &[Rc<str>]) -> Option<Cell> {
    let value = value.trim();
    match kind {
        _ if value.is_empty() => None,
        "s" => value.parse().ok().and_then(|idx: usize| shared.get(idx)).map(|text| Cell::Text(Rc::clone(text))),
        "n" => Some(Cell::Number(value.to_owned())),
        "b" | "e" => None,
        _ => Some(Cell::Text(plain(value).into())),
    }
}

/// `AB7` is column 27, counted from 0.
fn column_of(place: &str) -> Option<usize> {
    let letters = place.bytes().take_while(u8::is_ascii_uppercase).take(4);
    letters.fold(0_usize, |number, letter| 26 * number + usize::from(letter - b'A') + 1).checked_sub(1)
}

/// A tag of XML, and the text behind it.
struct Tag<'a> {
    /// Without what stands before a colon.
    name: &'a str,
    attributes: &'a str,
    /// `</name>`
    closes: bool,
    /// `<name/>`
    is_empty: bool,
    behind: &'a str,
}

impl<'a> Tag<'a> {
    fn attribute(&self, wanted: &str) -> Option<&'a str> {
        let mut rest = self.attributes;
        loop {
            let (name, behind) = rest.split_once('=')?;
            let quote = behind.trim_start().chars().next().filter(|letter| matches!(letter, '"' | '\''))?;
            let (value, behind) = behind.trim_start()[1..].split_once(quote)?;
            if name.trim() == wanted {
                return Some(value);
            }
            rest = behind;
        }
    }
}

/// The tags of a text, one after the other; comments and the like are tags of another name.
fn tags(xml: &str) -> impl Iterator<Item = Tag<'_>> {
    xml.split('<').skip(1).map(|part| {
        let (tag, behind) = part.split_once('>').unwrap_or((part, ""));
        let is_empty = tag.ends_with('/');
        let closes = tag.starts_with('/');
        let bare = tag.trim_matches('/');
        let (name, attributes) = bare.split_once(char::is_whitespace).unwrap_or((bare, ""));
        let name = name.split_once(':').map_or(name, |(_, name)| name);
        Tag { name, attributes, closes, is_empty, behind }
    })
}

/// With the signs that XML writes otherwise.
fn plain(text: &str) -> String {
    let signs = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&#10;", " "), ("&amp;", "&")];
    signs.iter().fold(text.to_owned(), |text, (written, sign)| text.replace(written, sign))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::foreign::zipped;
    use std::io::Write;

    const RELATIONS: &str = "<Relationships><Relationship Target=\"worksheets/sheet1.xml\" Id=\"rId1\"/>\
        <Relationship Id='rId2' Target='/xl/worksheets/sheet2.xml'/></Relationships>";
    const STRINGS: &str = "<sst><si><t>Time (s)</t></si><si><r><t>Angle</t></r><r><t> &lt;rad&gt;</t></r></si></sst>";

    /// A workbook of two sheets with these names.
    fn workbook(names: [&str; 2], sheets: [&str; 2]) -> Vec<u8> {
        let listed = names.iter().zip(["rId1", "rId2"]);
        let listed: String = listed.map(|(name, id)| format!("<sheet name=\"{name}\" r:id=\"{id}\"/>")).collect();
        let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in [
            (
                "xl/workbook.xml",
                format!("<?xml version=\"1.0\"?>\n<workbook><sheets>{listed}</sheets></workbook>").as_str(),
            ),
            ("xl/_rels/workbook.xml.rels", RELATIONS),
            ("xl/sharedStrings.xml", STRINGS),
            ("xl/worksheets/sheet1.xml", sheets[0]),
            ("xl/worksheets/sheet2.xml", sheets[1]),
        ] {
            writer.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            writer.write_all(text.as_bytes()).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    /// Names in shared texts, an empty column, and numbers, one of them by a formula.
    fn readings() -> String {
        let row = |idx: usize| {
            format!(
                "<row><c r=\"A{idx}\" s=\"1\"/><c r=\"B{idx}\"><v>{idx}.5</v></c><c><f>1+1</f><v>-2E-3</v></c></row>"
            )
        };
        let rows: String = (2..40).map(row).collect();
        let names = "<row r=\"1\"><c r=\"B1\" t=\"s\"><v>0</v></c><c r=\"C1\" t=\"s\"><v>1</v></c></row>";
        format!("<x:worksheet><x:sheetData>{names}{rows}</x:sheetData></x:worksheet>")
    }

    #[test]
    fn the_sheet_of_numbers_is_read_and_of_several_one_must_be_named() {
        let few = "<worksheet><row><c t=\"inlineStr\"><is><t>version</t></is></c><c t=\"str\"><v>1.1</v></c></row></worksheet>";
        let (text, name) =
            zipped::table(&workbook(["Raw Data", "Metadata"], [&readings(), few]), &mut Vec::new()).unwrap();
        assert_eq!(name, "Raw Data");
        let text = String::from_utf8(text).unwrap();
        assert!(text.starts_with("\"Time (s)\";\"Angle <rad>\"\n2.5;-2E-3\n3.5;-2E-3\n"), "{text}");
        let two = workbook(["Accelerometer", "Gyroscope"], [&readings(), &readings()]);
        assert_eq!(zipped::table(&two, &mut Vec::new()).unwrap().1, "Gyroscope");
        let two = workbook(["Run 1", "Run 2"], [&readings(), &readings()]);
        let refused = zipped::table(&two, &mut Vec::new()).unwrap_err().to_string();
        assert!(refused.contains("2 sheets of numbers (Run 1, Run 2), and none is called Raw Data"), "{refused}");
        let none = zipped::table(&workbook(["A", "B"], [few, few]), &mut Vec::new()).unwrap_err().to_string();
        assert!(none.contains("none of its sheets is a table of numbers"), "{none}");
    }

    #[test]
    fn damaged_sheets_are_read_as_far_as_they_go() {
        let whole = readings();
        for end in (0..whole.len()).step_by(7) {
            rows(&whole[..end], &[]);
        }
        let wild = "<c><v>7</v></c><row><c r=\"ZZZZZZ1\"><v>1</v></c><c r=\"1\"><v>2</v></c><c t=\"s\"><v>9</v></c></row><c r=";
        assert_eq!(rows(wild, &[]).len(), 0);
    }
}
