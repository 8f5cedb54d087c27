//! The elements of a MATLAB file of version 5 to 7, after MathWorks, "MAT-File Format" (2023), chapter 1.
//!
//! In: the bytes of a file. Out: its variables, as far as they are numbers, text or structures of these. The crates that
//! read such files read no structures (matfile), or not those that SciPy writes (matrw), and all of them panic on damaged
//! ones. Nothing panics here, and no more is unpacked than fits into memory.

use crate::limits::MOST_BYTES_WHOLE;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// Bytes before the first element.
const HEAD: usize = 128;

/// Bytes of an element's type and size.
const TAG: usize = 8;

/// Structures within structures, so deep.
const DEEPEST: usize = 8;

/// A table has no more columns with names.
const MOST_NAMES: usize = 64;

/// What a variable holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Variable {
    /// Of whatever precision, column after column; the imaginary part of complex ones is left alone.
    Numbers {
        n_rows: usize,
        n_columns: usize,
        values: Vec<f64>,
    },
    Text(String),
    /// Cells, each with a text: what columns are called.
    Names(Vec<String>),
    /// One list of values an entry, in the order of the fields.
    Structure {
        fields: Vec<String>,
        entries: Vec<Vec<Variable>>,
    },
    /// One of MATLAB's own objects, such as a `timeseries`, by its class; what it holds lies elsewhere in a secret form.
    Object(String),
    /// Other cells, tables, sparse matrices, arrays of more than two dimensions.
    Other,
}

/// Why a file can't be read.
#[derive(Debug, PartialEq)]
pub(super) enum Problem {
    /// It ends too early, or its parts do not fit.
    Damaged,
    /// Unpacked it is larger than what fits into memory.
    TooLarge,
}

/// Is it such a file, by its version and byte order? What stands before them is free text, which differs from program to
/// program.
pub(super) fn begins(file: &[u8]) -> bool {
    matches!(file.get(124..HEAD), Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I']))
}

/// The variables of a file, with their names.
pub(super) fn variables(file: &[u8]) -> Result<Vec<(String, Variable)>, Problem> {
    let is_big = file.get(126..128) == Some(b"MI");
    let mut elements = Elements { bytes: file.get(HEAD..without_objects(file, is_big)).unwrap_or_default(), is_big };
    let (mut found, mut n_unpacked) = (Vec::new(), 0);
    while let Some(element) = elements.next()? {
        match element.kind {
            kind::PACKED => {
                let unpacked = unpacked(element.data, MOST_BYTES_WHOLE - n_unpacked)?;
                n_unpacked += unpacked.len() as u64;
                let inner = Elements { bytes: &unpacked, is_big }.next()?.ok_or(Problem::Damaged)?;
                found.push(matrix(inner.data, is_big, DEEPEST)?);
            }
            kind::MATRIX => found.push(matrix(element.data, is_big, DEEPEST)?),
            _ => {}
        }
    }
    Ok(found)
}

/// The types of elements that are asked for.
pub(super) mod kind {
    pub(in super::super) const I8: u32 = 1;
    pub(in super::super) const U8: u32 = 2;
    pub(in super::super) const I16: u32 = 3;
    pub(in super::super) const U16: u32 = 4;
    pub(in super::super) const I32: u32 = 5;
    pub(in super::super) const U32: u32 = 6;
    pub(in super::super) const F32: u32 = 7;
    pub(in super::super) const F64: u32 = 9;
    pub(in super::super) const I64: u32 = 12;
    pub(in super::super) const U64: u32 = 13;
    pub(in super::super) const MATRIX: u32 = 14;
    pub(in super::super) const PACKED: u32 = 15;
    pub(in super::super) const UTF8: u32 = 16;
    pub(in super::super) const UTF16: u32 = 17;
}

/// The classes of matrices that are read.
mod class {
    pub(super) const CELLS: u32 = 1;
    pub(super) const STRUCTURE: u32 = 2;
    pub(super) const TEXT: u32 = 4;
    pub(super) const FIRST_OF_NUMBERS: u32 = 6;
    pub(super) const LAST_OF_NUMBERS: u32 = 15;
    pub(super) const OBJECT: u32 = 17;
}

/// Where MATLAB's own objects begin, whose form is secret; other programs fill the place with zeros or spaces.
fn without_objects(file: &[u8], is_big: bool) -> usize {
    let begin = file.get(116..124).and_then(|at| at.try_into().ok()).map_or(0, |at| match is_big {
        true => u64::from_be_bytes(at),
        false => u64::from_le_bytes(at),
    });
    usize::try_from(begin).ok().filter(|begin| (HEAD + TAG..file.len()).contains(begin)).unwrap_or(file.len())
}

/// Zeros pack a thousand times.
fn unpacked(packed: &[u8], at_most: u64) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    ZlibDecoder::new(packed).take(at_most + 1).read_to_end(&mut bytes).map_err(|_| Problem::Damaged)?;
    if bytes.len() as u64 > at_most { Err(Problem::TooLarge) } else { Ok(bytes) }
}

/// A part of a file: numbers of one kind, or further elements.
pub(super) struct Element<'a> {
    pub(super) kind: u32,
    pub(super) data: &'a [u8],
}

/// What is left of a list of elements.
struct Elements<'a> {
    bytes: &'a [u8],
    is_big: bool,
}

impl<'a> Elements<'a> {
    /// The next element; `None` behind the last.
    fn next(&mut self) -> Result<Option<Element<'a>>, Problem> {
        if self.bytes.len() < TAG {
            return Ok(None);
        }
        let (first, second) = (number(&self.bytes[..4], self.is_big), number(&self.bytes[4..8], self.is_big));
        // Up to four bytes stand where the size stands otherwise.
        let (kind, from, size) = match first >> 16 {
            0 => (first, TAG, second as usize),
            size => (first & 0xffff, 4, size as usize),
        };
        let data = self.bytes.get(from..from.saturating_add(size)).ok_or(Problem::Damaged)?;
        let whole = if kind == kind::PACKED { from + size } else { (from + size).next_multiple_of(TAG) };
        self.bytes = self.bytes.get(whole..).unwrap_or_default();
        Ok(Some(Element { kind, data }))
    }

    fn must(&mut self) -> Result<Element<'a>, Problem> {
        self.next()?.ok_or(Problem::Damaged)
    }
}

/// Four bytes as a number.
fn number(bytes: &[u8], is_big: bool) -> u32 {
    let bytes = bytes.try_into().unwrap_or_default();
    if is_big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

/// Name and content of a matrix.
fn matrix(bytes: &[u8], is_big: bool, deepest: usize) -> Result<(String, Variable), Problem> {
    let mut parts = Elements { bytes, is_big };
    // An empty matrix has no parts at all.
    let Some(flags) = parts.next()? else { return Ok((String::new(), Variable::Other)) };
    let class = number(flags.data.get(..4).ok_or(Problem::Damaged)?, is_big) & 0xff;
    if class == class::OBJECT {
        return object(&mut parts);
    }
    let size: Vec<usize> = numbers(&parts.must()?, is_big).iter().map(|length| *length as usize).collect();
    let name = String::from_utf8_lossy(parts.must()?.data).into_owned();
    let content = match (class, &size[..]) {
        (class::STRUCTURE, _) if deepest > 0 => {
            let n_entries = size.iter().fold(1_usize, |n, length| n.saturating_mul(*length));
            structure(&mut parts, n_entries, deepest - 1)?
        }
        (class::TEXT, _) => Variable::Text(text(&parts.must()?, is_big)),
        (class::CELLS, [n_rows, n_columns]) => {
            let n_cells = n_rows.saturating_mul(*n_columns);
            (1..=MOST_NAMES).contains(&n_cells).then(|| names(&mut parts, n_cells)).flatten().unwrap_or(Variable::Other)
        }
        (class::FIRST_OF_NUMBERS..=class::LAST_OF_NUMBERS, [n_rows, n_columns]) => {
            let values = parts.next()?.map(|element| numbers(&element, is_big)).unwrap_or_default();
            if n_rows.checked_mul(*n_columns) != Some(values.len()) {
                return Err(Problem::Damaged);
            }
            Variable::Numbers { n_rows: *n_rows, n_columns: *n_columns, values }
        }
        _ => Variable::Other,
    };
    Ok((name, content))
}

/// Name and class of an object, which has no size; `MCOS` stands between them.
fn object(parts: &mut Elements) -> Result<(String, Variable), Problem> {
    let mut word = || Ok(String::from_utf8_lossy(parts.must()?.data).into_owned());
    let (name, _system, class) = (word()?, word()?, word()?);
    Ok((name, Variable::Object(class)))
}

/// `None` where a cell has no text.
fn names(parts: &mut Elements, n_cells: usize) -> Option<Variable> {
    let mut name = || match matrix(parts.next().ok()??.data, parts.is_big, 0).ok()?.1 {
        Variable::Text(name) => Some(name),
        _ => None,
    };
    (0..n_cells).map(|_| name()).collect::<Option<_>>().map(Variable::Names)
}

fn structure(parts: &mut Elements, n_entries: usize, deepest: usize) -> Result<Variable, Problem> {
    let longest = numbers(&parts.must()?, parts.is_big).first().map_or(0, |longest| *longest as usize);
    let names = parts.must()?.data;
    let name =
        |name: &[u8]| String::from_utf8_lossy(name.split(|byte| *byte == 0).next().unwrap_or_default()).into_owned();
    let fields: Vec<String> = names.chunks_exact(longest.max(1)).map(name).collect();
    let mut entries = Vec::new();
    for _ in 0..if fields.is_empty() { 0 } else { n_entries } {
        let value = |_: &String| Ok(matrix(parts.must()?.data, parts.is_big, deepest)?.1);
        entries.push(fields.iter().map(value).collect::<Result<_, _>>()?);
    }
    Ok(Variable::Structure { fields, entries })
}

fn text(element: &Element, is_big: bool) -> String {
    let units = || numbers(element, is_big).into_iter().map(|unit| unit as u16).collect::<Vec<_>>();
    let text = match element.kind {
        kind::U16 | kind::UTF16 => String::from_utf16_lossy(&units()),
        _ => String::from_utf8_lossy(element.data).into_owned(),
    };
    text.trim().to_owned()
}

/// The numbers of an element; none of one that holds something else.
pub(super) fn numbers(element: &Element, is_big: bool) -> Vec<f64> {
    let of = |width: usize, read: &dyn Fn([u8; 8]) -> f64| -> Vec<f64> {
        let mut wide = [0; 8];
        element
            .data
            .chunks_exact(width)
            .map(|bytes| {
                wide[..width].copy_from_slice(bytes);
                if is_big {
                    wide[..width].reverse();
                }
                read(wide)
            })
            .collect()
    };
    let low = |wide: [u8; 8]| u64::from_le_bytes(wide);
    match element.kind {
        kind::I8 => of(1, &|wide| f64::from(low(wide) as i8)),
        kind::U8 | kind::UTF8 => of(1, &|wide| f64::from(low(wide) as u8)),
        kind::I16 => of(2, &|wide| f64::from(low(wide) as i16)),
        kind::U16 | kind::UTF16 => of(2, &|wide| f64::from(low(wide) as u16)),
        kind::I32 => of(4, &|wide| f64::from(low(wide) as i32)),
        kind::U32 => of(4, &|wide| f64::from(low(wide) as u32)),
        kind::F32 => of(4, &|wide| shortest(f32::from_bits(low(wide) as u32))),
        kind::F64 => of(8, &|wide| f64::from_bits(low(wide))),
        kind::I64 => of(8, &|wide| low(wide) as i64 as f64),
        kind::U64 => of(8, &|wide| low(wide) as f64),
        _ => Vec::new(),
    }
}

/// 0.1 and not 0.10000000149.
fn shortest(single: f32) -> f64 {
    single.to_string().parse().unwrap_or(f64::from(single))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::ZlibEncoder;
    use std::io::Write;

    fn head(endian: &[u8; 2]) -> Vec<u8> {
        let mut file = b"MATLAB 5.0 MAT-file".to_vec();
        file.resize(124, b' ');
        file.extend([0x00, 0x01]);
        file.extend(endian);
        file
    }

    /// A file with one packed element that is all zeros.
    fn zeros(n_bytes: u64) -> Vec<u8> {
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::best());
        std::io::copy(&mut std::io::repeat(0).take(n_bytes), &mut packer).unwrap();
        packer.flush().unwrap();
        let packed = packer.finish().unwrap();
        let mut file = head(b"IM");
        file.extend(kind::PACKED.to_le_bytes());
        file.extend((packed.len() as u32).to_le_bytes());
        file.extend(packed);
        file
    }

    #[test]
    fn what_would_fill_the_memory_is_refused() {
        let bomb = zeros(MOST_BYTES_WHOLE + (1 << 20));
        assert!(bomb.len() < 1 << 20);
        assert_eq!(variables(&bomb), Err(Problem::TooLarge));
        assert_eq!(variables(&zeros(1 << 10)), Ok(vec![(String::new(), Variable::Other)]));
    }

    #[test]
    fn big_ends_and_small_elements_are_read() {
        let mut file = head(b"MI");
        // Flags of class 6, a size of 1 × 2, the name "t" and two 16-bit numbers, both of them small elements.
        let parts: [u32; 14] =
            [6, 8, 6, 0, 5, 8, 1, 2, 0x0001_0001, u32::from_be_bytes(*b"t\0\0\0"), 0x0004_0003, 0x0007_fffe, 0, 0];
        file.extend([14, 48].iter().chain(&parts[..12]).flat_map(|word: &u32| word.to_be_bytes()));
        let numbers = Variable::Numbers { n_rows: 1, n_columns: 2, values: vec![7.0, -2.0] };
        assert_eq!(variables(&file), Ok(vec![("t".to_owned(), numbers)]));
    }

    #[test]
    fn an_object_is_known_by_its_name_and_class() {
        let mut file = head(b"IM");
        let word = |text: &[u8]| {
            let mut element = [kind::I8.to_le_bytes(), (text.len() as u32).to_le_bytes()].concat();
            element.extend(text);
            element.resize(element.len().next_multiple_of(TAG), 0);
            element
        };
        let flags: Vec<u8> = [kind::U32, 8, class::OBJECT, 0].iter().flat_map(|word| word.to_le_bytes()).collect();
        let parts = [flags, word(b"theta2"), word(b"MCOS"), word(b"timeseries")].concat();
        file.extend(kind::MATRIX.to_le_bytes());
        file.extend((parts.len() as u32).to_le_bytes());
        file.extend(parts);
        assert_eq!(variables(&file), Ok(vec![("theta2".to_owned(), Variable::Object("timeseries".to_owned()))]));
    }

    #[test]
    fn a_file_that_ends_early_is_damaged_wherever_it_ends() {
        let whole = include_bytes!("../../../../tests/corpus/foreign/simulink.mat");
        assert_eq!(variables(whole).unwrap().len(), 1);
        assert!((HEAD + TAG..whole.len()).step_by(97).all(|end| variables(&whole[..end]) == Err(Problem::Damaged)));
    }
}
