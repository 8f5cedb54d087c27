//! Workbooks as [MS-XLS] and [MS-CFB] have them, written here.

use super::*;
use crate::{ReadOptions, read_bytes};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

const SECTOR: usize = 512;
const ENDS: u32 = 0xffff_fffe;
const IS_TABLE: u32 = 0xffff_fffd;

fn record(kind: u16, data: &[u8]) -> Vec<u8> {
    [&kind.to_le_bytes(), &(data.len() as u16).to_le_bytes(), data].concat()
}

fn begin(version: u16) -> Vec<u8> {
    record(BEGIN, &[&version.to_le_bytes()[..], &[0; 14]].concat())
}

fn cell(kind: u16, row: u16, column: u16, value: &[u8]) -> Vec<u8> {
    record(kind, &[&row.to_le_bytes()[..], &column.to_le_bytes(), &[15, 0], value].concat())
}

fn float(row: u16, column: u16, number: f64) -> Vec<u8> {
    cell(0x0203, row, column, &number.to_le_bytes())
}

fn label(row: u16, column: u16, text: &str) -> Vec<u8> {
    cell(0x0204, row, column, &[&[text.len() as u8, 0, 0], text.as_bytes()].concat())
}

/// The stream of a workbook; the sheets hold these records.
fn workbook(more: &[u8], sheets: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let parts: Vec<Vec<u8>> =
        sheets.iter().map(|(_, cells)| [begin(BIFF8), cells.clone(), record(END, &[])].concat()).collect();
    let named = |begins: &[usize]| -> Vec<u8> {
        let names = sheets.iter().zip(begins).flat_map(|((name, _), begin)| {
            let head = [&(*begin as u32).to_le_bytes()[..], &[0, 0, name.len() as u8, 0], name.as_bytes()].concat();
            record(SHEET, &head)
        });
        [begin(BIFF8), names.collect(), more.to_vec(), record(END, &[])].concat()
    };
    let mut begins = vec![named(&vec![0; sheets.len()]).len()];
    parts.iter().for_each(|part| begins.push(begins[begins.len() - 1] + part.len()));
    [named(&begins), parts.concat()].concat()
}

fn entry(name: &str, kind: u8, first: u32, len: usize) -> Vec<u8> {
    let mut entry: Vec<u8> = name.encode_utf16().flat_map(u16::to_le_bytes).collect();
    entry.resize(128, 0);
    entry[64] = 2 * name.len() as u8 + 2;
    entry[66] = kind;
    entry[116..120].copy_from_slice(&first.to_le_bytes());
    entry[120..124].copy_from_slice(&(len as u32).to_le_bytes());
    entry
}

/// A chain over so many sectors, from this one on.
fn chained(first: usize, n: usize) -> Vec<u32> {
    (1..=n).map(|idx| if idx == n { ENDS } else { (first + idx) as u32 }).collect()
}

fn bytes_of(numbers: &[u32], len: usize, filled: u8) -> Vec<u8> {
    let mut bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    bytes.resize(len, filled);
    bytes
}

/// A file of OLE2 with a stream of this name: its sectors, the directory, what follows what among small sectors, the tables,
/// and where those are of which the header does not tell.
fn compound(name: &str, stream: &[u8]) -> Vec<u8> {
    let n_stream = stream.len().div_ceil(SECTOR);
    let mut n_tables = 1;
    while n_stream + 2 + n_tables + n_tables.saturating_sub(109).div_ceil(127) > 128 * n_tables {
        n_tables += 1;
    }
    let n_more = n_tables.saturating_sub(109).div_ceil(127);
    let first_table = n_stream + 2;
    let mut next = [chained(0, n_stream), vec![ENDS, ENDS], vec![IS_TABLE; n_tables + n_more]].concat();
    next.resize(128 * n_tables, u32::MAX);
    let is_small = stream.len() < 4096;
    let places: Vec<u32> = (first_table..first_table + n_tables).map(|place| place as u32).collect();
    let (in_header, others) = places.split_at(n_tables.min(109));
    let mut file = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".to_vec();
    file.resize(SECTOR, 0xff);
    file[24..34].copy_from_slice(&[0x3e, 0, 3, 0, 0xfe, 0xff, 9, 0, 6, 0]);
    file[48..52].copy_from_slice(&(n_stream as u32).to_le_bytes());
    file[60..64].copy_from_slice(&(n_stream as u32 + 1).to_le_bytes());
    file[68..72].copy_from_slice(&((first_table + n_tables) as u32).to_le_bytes());
    file[76..76 + 4 * in_header.len()].copy_from_slice(&bytes_of(in_header, 4 * in_header.len(), 0));
    file.extend(stream);
    file.resize(SECTOR * (n_stream + 1), 0);
    let root = entry("Root Entry", 5, if is_small { 0 } else { ENDS }, n_stream * SECTOR);
    file.extend([root, entry(name, 2, 0, stream.len()), vec![0; 256]].concat());
    file.extend(bytes_of(&chained(0, stream.len().div_ceil(64).min(128)), SECTOR, 0xff));
    file.extend(bytes_of(&next, SECTOR * n_tables, 0));
    for (idx, named) in others.chunks(127).enumerate() {
        let next = (first_table + n_tables + idx + 1) as u32;
        file.extend([bytes_of(named, SECTOR - 4, 0xff), next.to_le_bytes().to_vec()].concat());
    }
    file
}

/// A pendulum of 40 /s², let go at 1 rad, at hundredths of a second.
fn swing() -> Vec<(f64, f64)> {
    const N_STEPS: u32 = 40;
    let (mut angle, mut rate) = (1.0_f64, 0.0);
    let mut step = |time_s: f64| {
        let now = angle;
        for _ in 0..N_STEPS {
            let dt_s = 0.02 / f64::from(N_STEPS);
            rate -= dt_s * (40.0 * angle.sin() + 0.1 * rate);
            angle += dt_s * rate;
        }
        (time_s, now)
    };
    (0..400).map(|idx| step(f64::from(2 * idx) / 100.0)).collect()
}

/// Hundredths as a short number.
fn hundredths(number: f64) -> [u8; 4] {
    ((((number * 100.0).round() as i32) << 2) | 3).to_le_bytes()
}

/// Each number in another of the ways in which one may be stored: time, a column in which only formulas without a number
/// stand, the angle, and the bits of a float.
fn readings() -> Vec<u8> {
    let row = |(idx, (time_s, angle_rad)): (usize, (f64, f64))| {
        let row = idx as u16 + 1;
        let no_number = cell(0x0006, row, 1, &[&[0, 0, 0, 0, 0, 0, 0xff, 0xff], &[0_u8; 8][..]].concat());
        let half = (0.5_f64.to_bits() >> 32) as u32;
        let time = match idx % 3 {
            0 => float(row, 0, time_s),
            1 => cell(0x027e, row, 0, &hundredths(time_s)),
            _ => record(0x00bd, &[&row.to_le_bytes()[..], &[0, 0, 15, 0], &hundredths(time_s), &[0, 0]].concat()),
        };
        let angle = match idx % 2 {
            0 => float(row, 2, angle_rad),
            _ => cell(0x0006, row, 2, &[&angle_rad.to_le_bytes()[..], &[0; 8]].concat()),
        };
        let more = record(
            0x00bd,
            &[&row.to_le_bytes()[..], &[3, 0, 15, 0], &half.to_le_bytes(), &[15, 0, 7, 0, 0, 0, 4, 0]].concat(),
        );
        [time, no_number, angle, more].concat()
    };
    [label(0, 0, "t (s)"), cell(0x00fd, 0, 2, &[0, 0, 0, 0])]
        .concat()
        .into_iter()
        .chain(swing().into_iter().enumerate().flat_map(row))
        .collect()
}

/// "Angle (rad)", cut where a record ends; behind it the letters take two bytes.
fn shared() -> Vec<u8> {
    let first = [&[1, 0, 0, 0, 1, 0, 0, 0, 11, 0, DRESSED_AND_MORE, 1, 0, 3, 0, 0, 0], &b"Angle"[..]].concat();
    let wide: Vec<u8> = " (rad)".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let second = [&[1], &wide[..], &[0; 7]].concat();
    [record(SHARED_TEXTS, &first), record(CONTINUED, &second)].concat()
}

const DRESSED_AND_MORE: u8 = 12;

fn file() -> Vec<u8> {
    let few = [label(0, 0, "version"), float(0, 1, 1.1)].concat();
    compound("Workbook", &workbook(&shared(), &[("Raw Data", readings()), ("Metadata", few)]))
}

fn refusal(bytes: &[u8]) -> String {
    table(bytes, &mut Vec::new()).unwrap_err().to_string()
}

#[test]
fn a_workbook_gives_the_readings_of_the_csv_beside_it() {
    let csv: String = swing().iter().map(|(time_s, angle_rad)| format!("{time_s},{angle_rad},0.5,0.01\n")).collect();
    let csv = format!("t (s),Angle (rad),,\n{csv}");
    let mut notes = Vec::new();
    let (text, name) = table(&file(), &mut notes).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.starts_with("\"t (s)\";\"Angle (rad)\";;\n0;1;0.5;0.01\n0.02;0.99"), "{text}");
    assert_eq!((name.as_str(), notes), ("Raw Data", vec!["sheet Raw Data read from the workbook".to_owned()]));
    let read = |name, bytes: &[u8]| read_bytes(name, bytes, &ReadOptions::default()).unwrap();
    let (book, table) = (read("swing.xls", &file()), read("swing.csv", csv.as_bytes()));
    assert_eq!((book.times_s(), book.angles_rad()), (table.times_s(), table.angles_rad()));
    assert_eq!(book.len(), 400);
}

#[test]
fn streams_short_and_long_come_out_whole() {
    // In small sectors, in a few large ones, and with more tables than the header names, 7.1 MB and on.
    for len in [1, 64, 4095, 4096, 70_000, 109 * 128 * SECTOR, (109 + 128) * 128 * SECTOR] {
        let stream: Vec<u8> = (0..len).map(|idx| (idx / 7) as u8).collect();
        assert!(compound::stream(&compound("WORKBOOK", &stream), &["Book", "Workbook"]) == Some(stream), "{len}");
    }
    assert_eq!(compound::stream(&compound("WordDocument", &[0; 5000]), &["Workbook"]), None);
}

#[test]
fn a_chain_without_end_ends_with_the_file() {
    let stream = vec![7; 60_000];
    let mut circle = compound("Workbook", &stream);
    let table = SECTOR + SECTOR * (stream.len().div_ceil(SECTOR) + 2);
    circle[table + 4 * 117..table + 4 * 118].copy_from_slice(&[0; 4]);
    let len = SECTOR * (stream.len().div_ceil(SECTOR) + 1);
    circle[len + 128 + 120..len + 128 + 124].copy_from_slice(&[0xff; 4]);
    let read = compound::stream(&circle, &["Workbook"]).unwrap();
    assert!(read.len() > stream.len() && read.len() < circle.len(), "{}", read.len());
}

#[test]
fn a_chart_in_a_sheet_is_no_cell_of_it() {
    let chart = [begin(BIFF8), float(0, 0, 7.0), record(END, &[])].concat();
    let part =
        [begin(BIFF8), chart, float(3, 1, -0.0), float(3, 0, 1e-20), float(4, 0, f64::NAN), record(END, &[])].concat();
    let number = |text: &str| Cell::Number(text.to_owned());
    assert_eq!(rows(&[part, float(9, 9, 9.0)].concat(), &[]), [vec![(0, number("1e-20")), (1, number("-0"))]]);
}

#[test]
fn a_long_text_that_many_cells_share_is_cut() {
    let long = [&[1, 0, 0, 0, 1, 0, 0, 0, 0x40, 0x1f, 0], &[b'x'; 8000][..]].concat();
    let rows = (0..100).flat_map(|row| [float(row, 0, 1.0), cell(0x00fd, row, 1, &[0; 4])].concat()).collect();
    let file = compound("Workbook", &workbook(&record(SHARED_TEXTS, &long), &[("A", rows)]));
    let (text, _) = table(&file, &mut Vec::new()).unwrap();
    assert!(text.len() < 3 * file.len(), "{} of {}", text.len(), file.len());
}

#[test]
fn a_sheet_that_is_named_many_times_is_read_once() {
    let stream = workbook(&[], &[("A", readings())]);
    let globals: Vec<Record> = of_one(&stream).collect();
    let again: Vec<Record> = (0..60).flat_map(|_| globals.iter().map(|record| Record { ..*record })).collect();
    assert_eq!(sheets_of(&stream, &again).len(), 1);
}

#[test]
fn what_can_not_be_read_is_refused_with_the_reason_and_the_cure() {
    let locked = compound("Workbook", &workbook(&record(PASSWORD, &[0; 6]), &[("A", readings())]));
    let older = compound("Book", &[begin(0x0500), vec![0; 5000]].concat());
    let other = compound("WordDocument", &[0; 5000]);
    for (bytes, reason) in [(locked, "a password locks it"), (older, "older than Excel 97"), (other, "no workbook")] {
        let refused = refusal(&bytes);
        assert!(refused.contains(reason) && refused.contains("save the sheet as CSV"), "{refused}");
    }
}

/// Spoils some bytes, or a word of four, or cuts the file off.
fn spoilt(whole: &[u8], chance: &mut SplitMix64) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let mut below = |n: usize| (chance.next_u64() % n as u64) as usize;
    match below(4) {
        0 => bytes.truncate(below(whole.len())),
        1 => (0..=below(8)).for_each(|_| bytes[below(whole.len())] = below(256) as u8),
        // Where the header, what the workbook says of its sheets, and the last sectors lie.
        2 => (0..=below(8))
            .for_each(|_| bytes[[below(1024), whole.len() - 1 - below(3000)][below(2)]] = below(256) as u8),
        _ => {
            let at = 4 * below(whole.len() / 4);
            let word = [0_u32, 1, 7, 0x10000, 0x7fff_ffff, ENDS, u32::MAX][below(7)];
            bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn spoilt_workbooks_are_refused_or_read_as_far_as_they_go() {
    let mut chance = SplitMix64::seed_from_u64(11);
    let small = compound("Workbook", &workbook(&shared(), &[("A", readings()[..3000].to_vec())]));
    assert!(table(&small, &mut Vec::new()).is_ok());
    let (mut n_read, mut n_refused) = (0, 0);
    for whole in [file(), small] {
        for _ in 0..2000 {
            let bytes = spoilt(&whole, &mut chance);
            match table(&bytes, &mut Vec::new()) {
                // A cell of 6 bytes has at most 24 digits; a row's end is one more.
                Ok((text, _)) => n_read += u32::from(text.len() < 8 * whole.len()),
                Err(error) => n_refused += u32::from(error.to_string().contains("save the sheet as CSV")),
            }
        }
    }
    assert_eq!(n_read + n_refused, 4000);
    assert!(n_read > 400 && n_refused > 400, "{n_read} read, {n_refused} refused");
}
