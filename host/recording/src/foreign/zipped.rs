//! An archive with one table in it, as phyphox exports it: `Raw Data.csv` beside `meta/device.csv` and `meta/time.csv`. Of
//! a table for each sensor of a phone that of the gyroscope is read, because no other one can be fitted. Workbooks are
//! archives, and so are several arrays of NumPy in one file.

use super::archive::{bytes_of, only_one, stem, unpacked, unreadable};
use super::as_text::{refused, text_of};
use super::kind::Kind;
use super::{cassy, numpy, project, workbook};
use crate::error::Fault;
use std::io::Cursor;
use zip::ZipArchive;

/// The table, and what it is called in the archive.
pub(super) fn table(bytes: &[u8], notes: &mut Vec<String>) -> Result<(Vec<u8>, String), Fault> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(unreadable)?;
    let names: Vec<String> = archive.file_names().filter_map(|name| Some(name.ok()?.into_owned())).collect();
    if names.iter().any(|name| name == "content.xml") {
        return Err(refused("workbook of a spreadsheet", "save the sheet as CSV in that program"));
    }
    if names.iter().any(|name| name.starts_with("xl/")) {
        return workbook::table(&mut archive, notes);
    }
    if !names.is_empty() && names.iter().all(|name| name.ends_with(".npy")) {
        return arrays(&mut archive, &names, notes);
    }
    let is_table = |name: &&String| {
        let lower = name.to_lowercase();
        [".csv", ".txt", ".tsv"].iter().any(|end| lower.ends_with(end))
            && !lower.contains("meta/")
            && !lower.contains("__macosx")
    };
    if !names.is_empty() && names.iter().all(|name| name.to_lowercase().ends_with(".xml")) {
        return of_project(&mut archive, &names, notes);
    }
    let tables: Vec<&String> = names.iter().filter(is_table).collect();
    let Some(name) = only_one(&tables) else {
        let listed = if tables.is_empty() {
            names.join(", ")
        } else {
            tables.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", ")
        };
        return Err(refused(
            "zip archive",
            &format!("it has {} tables (of {listed}): unpack it and name one of them", tables.len()),
        ));
    };
    let text = bytes_of(&mut archive, name)?;
    if Kind::of(&text).is_some() {
        return Err(refused("zip archive", &format!("{name} in it is no table: unpack it and name the file")));
    }
    notes.push(format!("{name} read from the archive"));
    Ok((text, stem(name).to_owned()))
}

/// The only file of XML, if it is a project that is read.
fn of_project(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    names: &[String],
    notes: &mut Vec<String>,
) -> Result<(Vec<u8>, String), Fault> {
    let [name] = names else { return Err(project("zip archive of XML")) };
    let xml = unpacked(archive, name)?;
    if !cassy::is_project(&xml) {
        return Err(project("zip archive of XML"));
    }
    Ok((cassy::table(&xml, notes)?, String::new()))
}

/// Arrays by their names; the columns of a matrix are numbered.
fn arrays(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    files: &[String],
    notes: &mut Vec<String>,
) -> Result<(Vec<u8>, String), Fault> {
    let (mut names, mut columns, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for file in files {
        // Words, and arrays of several dimensions, are none of the table, and neither are scalars, which are settings.
        let Ok(of_array) = numpy::columns(&bytes_of(archive, file)?) else {
            left.push(stem(file));
            continue;
        };
        let of_array = if of_array.iter().any(|column| column.len() > 1) { of_array } else { Vec::new() };
        let n = of_array.len();
        names.extend((1..=n).map(|idx| if n > 1 { format!("{} {idx}", stem(file)) } else { stem(file).to_owned() }));
        columns.extend(of_array);
    }
    if columns.is_empty() {
        return Err(numpy::no_table());
    }
    if !left.is_empty() {
        notes.push(format!("{} left out of the archive: no columns of numbers", left.join(", ")));
    }
    let is_lone = files.len() == 1 && columns.len() > 1;
    Ok((text_of(if is_lone { &[] } else { &names }, &columns), String::new()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn archive(files: &[(&str, &str)]) -> Vec<u8> {
        let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, text) in files {
            writer.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
            writer.write_all(text.as_bytes()).unwrap();
        }
        writer.finish().unwrap().into_inner()
    }

    /// An array of NumPy, version 1.
    fn array(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let head = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        [b"\x93NUMPY\x01\x00", &(head.len() as u16).to_le_bytes()[..], head.as_bytes(), data].concat()
    }

    #[test]
    fn words_beside_the_arrays_of_an_archive_are_left_out() {
        let numbers = |all: [f64; 2]| array("<f8", "(2,)", &all.map(f64::to_le_bytes).concat());
        let (words, blocks) = (array("<U2", "(1,)", &[0; 8]), array("<f8", "(1, 1, 1)", &[0; 8]));
        let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let files = [
            ("t.npy", numbers([0.0, 0.5])),
            ("meta.npy", words),
            ("theta.npy", numbers([1.0, 2.0])),
            ("map.npy", blocks),
        ];
        for (name, bytes) in &files {
            writer.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
            writer.write_all(bytes).unwrap();
        }
        let mut notes = Vec::new();
        let (text, _) = table(&writer.finish().unwrap().into_inner(), &mut notes).unwrap();
        assert!(text.starts_with(b"\"t\";\"theta\"\n"), "{}", String::from_utf8_lossy(&text));
        assert_eq!(notes, ["meta, map left out of the archive: no columns of numbers"]);
        let only = archive(&[("a.npy", "no array")]);
        assert!(table(&only, &mut Vec::new()).unwrap_err().to_string().contains("numpy.savetxt"));
    }

    #[test]
    fn the_one_table_of_an_archive_is_read_and_of_several_one_must_be_named() {
        let read = |files: &[(&str, &str)]| table(&archive(files), &mut Vec::new()).map_err(|fault| fault.to_string());
        let one = read(&[("Raw Data.csv", "t,theta"), ("meta/device.csv", "x,y")]).unwrap();
        assert_eq!(one, (b"t,theta".to_vec(), "Raw Data".to_owned()));
        let phone = [("Accelerometer.csv", "a"), ("run/Gyroscope.csv", "g"), ("GyroscopeUncalibrated.csv", "u")];
        assert_eq!(read(&phone).unwrap(), (b"g".to_vec(), "Gyroscope".to_owned()));
        assert!(read(&[("data.xml", "<project/>")]).unwrap_err().contains("Logger Pro (.cmbl)"));
        assert!(read(&[("data.xml", "<cassylab/>")]).unwrap_err().contains("no run in it"));
        assert!(read(&[("a.csv", "1"), ("b.csv", "2")]).unwrap_err().contains("2 tables (of a.csv, b.csv)"));
        assert!(read(&[("xl/workbook.xml", "")]).unwrap_err().contains("save the sheet as CSV"));
        assert!(read(&[("content.xml", "")]).unwrap_err().contains("save the sheet as CSV"));
        assert!(table(b"PK\x03\x04rubbish", &mut Vec::new()).unwrap_err().to_string().contains("can't be unpacked"));
    }
}
