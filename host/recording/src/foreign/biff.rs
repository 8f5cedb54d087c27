//! Workbooks of older spreadsheets (.xls, Excel 97 to 2003), after [MS-XLS]: records one behind the other, BIFF8, in a stream
//! of OLE2. phyphox on Android exports them as "Excel".
//!
//! Nothing is calculated: a cell with a formula has the number that the program left there. Damaged ones are read as far
//! as they go, and each byte once: what is kept is a multiple of the file at most.

mod letters;

use super::as_text::refused;
use super::compound;
use super::little::{u16_at, u32_at};
use super::sheets::{self, Cell, MOST_COLUMNS, MOST_SHEETS, Row, Sheet, WHAT};
use crate::error::Fault;
use letters::Letters;
use std::rc::Rc;

const BEGIN: u16 = 0x0809;
const END: u16 = 0x000a;
const PASSWORD: u16 = 0x002f;
const SHEET: u16 = 0x0085;
const SHARED_TEXTS: u16 = 0x00fc;
const CONTINUED: u16 = 0x003c;

/// The version in the first record, of Excel 97 and all that came behind it.
const BIFF8: u16 = 0x0600;

struct Record<'a> {
    kind: u16,
    data: &'a [u8],
}

/// A cell that holds something: its row and column too.
type Placed = (u16, u16, Cell);

/// The table, and what its sheet is called.
pub(super) fn table(bytes: &[u8], notes: &mut Vec<String>) -> Result<(Vec<u8>, String), Fault> {
    let unreadable = |problem: &str| refused(WHAT, &format!("{problem}: save the sheet as CSV in that program"));
    let stream = compound::stream(bytes, &["Workbook", "Book"]).unwrap_or_default();
    let globals: Vec<Record> = of_one(&stream).collect();
    match globals.first().map(|begin| u16_at(begin.data, 0)) {
        None => {
            let cure = "no workbook can be read from it; if it is one, save the sheet as CSV in that program";
            return Err(refused("document of an office program", cure));
        }
        Some(Some(BIFF8)) => {}
        Some(_) => return Err(unreadable("it is older than Excel 97")),
    }
    if globals.iter().any(|record| record.kind == PASSWORD) {
        return Err(unreadable("a password locks it"));
    }
    sheets::table(&sheets_of(&stream, &globals), notes)
}

/// All records that are whole.
fn records(stream: &[u8]) -> impl Iterator<Item = Record<'_>> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let (kind, len) = (u16_at(rest, 0)?, u16_at(rest, 2)?);
        let (data, behind) = rest[4..].split_at_checked(usize::from(len))?;
        rest = behind;
        Some(Record { kind, data })
    })
}

/// The records of a part from its begin to its end, without those of charts that lie within it.
fn of_one(stream: &[u8]) -> impl Iterator<Item = Record<'_>> {
    let mut depth = 0_usize;
    let inside = records(stream).map_while(move |record| {
        match record.kind {
            BEGIN => depth += 1,
            END => depth = depth.saturating_sub(1),
            _ => {}
        }
        (depth > 0).then_some((depth, record))
    });
    inside.filter(|(depth, record)| *depth == 1 && record.kind != END).map(|(_, record)| record)
}

/// The sheets in the order in which they lie there. Each ends where the next one begins, so that none is read twice.
fn sheets_of(stream: &[u8], globals: &[Record]) -> Vec<Sheet> {
    let shared = shared_texts(globals);
    let mut places: Vec<(usize, String)> = globals.iter().filter_map(sheet_at).take(MOST_SHEETS).collect();
    places.sort_by_key(|(begin, _)| *begin);
    places.dedup_by_key(|(begin, _)| *begin);
    let ends = places.iter().skip(1).map(|(begin, _)| *begin).chain([stream.len()]);
    let parts = places.iter().zip(ends).filter_map(|((begin, name), end)| Some((name, stream.get(*begin..end)?)));
    parts.map(|(name, part)| Sheet { name: name.clone(), rows: rows(part, &shared) }).collect()
}

/// Where a sheet of cells begins, and its name; charts and macros are none.
fn sheet_at(record: &Record) -> Option<(usize, String)> {
    if record.kind != SHEET || record.data.get(5) != Some(&0) {
        return None;
    }
    let name = Letters::of(&[record.data.get(6..)?]).short_text()?;
    Some((u32_at(record.data, 0)? as usize, name))
}

/// Texts that cells share. The record ends at 8 KB and goes on in others.
fn shared_texts(globals: &[Record]) -> Vec<Rc<str>> {
    let Some(first) = globals.iter().position(|record| record.kind == SHARED_TEXTS) else { return Vec::new() };
    let more = globals[first + 1..].iter().take_while(|record| record.kind == CONTINUED);
    let parts: Vec<&[u8]> = [&globals[first]].into_iter().chain(more).map(|record| record.data).collect();
    let mut letters = Letters::of(&parts);
    let Some(()) = letters.skip(4) else { return Vec::new() };
    let n_texts = letters.u32().unwrap_or(0) as usize;
    std::iter::from_fn(|| letters.text()).take(n_texts).map(Rc::from).collect()
}

/// The rows that have something in them.
fn rows(part: &[u8], shared: &[Rc<str>]) -> Vec<Row> {
    let mut cells: Vec<Placed> = of_one(part).filter_map(|record| cells(&record, shared)).flatten().collect();
    cells.retain(|(_, column, _)| usize::from(*column) < MOST_COLUMNS);
    cells.sort_by_key(|(row, column, _)| (*row, *column));
    let (mut rows, mut last) = (Vec::<Row>::new(), None);
    for (row, column, cell) in cells {
        if last.replace(row) != Some(row) {
            rows.push(Row::new());
        }
        if let Some(cells) = rows.last_mut() {
            cells.push((usize::from(column), cell));
        }
    }
    rows
}

/// The cells of a record.
fn cells(record: &Record, shared: &[Rc<str>]) -> Option<Vec<Placed>> {
    let Record { kind, data } = record;
    let (row, column) = (u16_at(data, 0)?, u16_at(data, 2)?);
    let float = || data.get(6..)?.first_chunk().copied().map(f64::from_le_bytes);
    let cell = match kind {
        // A text in the cell itself; the other kind of it has letters of several kinds.
        0x0204 | 0x00d6 => Cell::Text(Letters::of(&[data.get(6..)?]).text()?.into()),
        0x00fd => Cell::Text(Rc::clone(shared.get(u32_at(data, 6)? as usize)?)),
        0x0203 => number(float()?)?,
        // Of a formula's value the last two bytes say that it is none.
        0x0006 if data.get(12..14)? != [0xff, 0xff] => number(float()?)?,
        0x027e => number(short_number(u32_at(data, 6)?))?,
        0x00bd => return Some(several(data.get(4..)?, row, column)),
        _ => return None,
    };
    Some(vec![(row, column, cell)])
}

/// Numbers side by side, each behind two bytes of how it looks.
fn several(data: &[u8], row: u16, first: u16) -> Vec<Placed> {
    let numbers = data.chunks_exact(6).zip(first..=u16::MAX);
    let placed = |(bytes, column): (&[u8], u16)| Some((row, column, number(short_number(u32_at(bytes, 2)?))?));
    numbers.filter_map(placed).collect()
}

/// The shortest digits that give this very number again; damaged ones may be none.
fn number(number: f64) -> Option<Cell> {
    let digits = format!("{number:?}");
    number.is_finite().then(|| Cell::Number(digits.strip_suffix(".0").unwrap_or(&digits).to_owned()))
}

/// A number in 30 bits, whole or the upper ones of a float, perhaps in hundredths.
fn short_number(bits: u32) -> f64 {
    let is_whole = bits & 2 != 0;
    let number = if is_whole { f64::from(bits as i32 >> 2) } else { f64::from_bits(u64::from(bits & !3) << 32) };
    if bits & 1 == 0 { number } else { number / 100.0 }
}

#[cfg(test)]
mod tests;
