//! MATLAB files of versions 5 to 7: every vector is a column of its name, every matrix has its columns numbered.

use super::{refused, text_of};
use crate::recording::error::Fault;
use crate::recording::source::MOST_BYTES_WHOLE;
use flate2::read::ZlibDecoder;
use matfile::{Array, MatFile, NumericData};
use std::io::Read;

/// A matrix with more columns is a picture, not a table.
const MOST_COLUMNS: usize = 64;

pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let what = "MATLAB file";
    check_unpacked_size(bytes)?;
    // The parser panics on some damaged files.
    let parsed = std::panic::catch_unwind(|| MatFile::parse(bytes));
    let parsed =
        parsed.map_err(|_| refused(what, "it is damaged; save it anew: save('swing.mat', 't', 'theta', '-v7')"))?;
    let file = parsed.map_err(|error| {
        refused(what, &format!("it can't be read ({error}); save it anew: save('swing.mat', 't', 'theta', '-v7')"))
    })?;
    let (mut names, mut columns) = (Vec::new(), Vec::new());
    for array in file.arrays().iter().filter(|array| is_table(array)) {
        let numbers = numbers(array.data());
        let n_rows = array.size().iter().copied().max().filter(|_| is_vector(array)).unwrap_or(array.size()[0]).max(1);
        let parts: Vec<&[f64]> = numbers.chunks(n_rows).collect();
        for (idx, part) in parts.iter().enumerate() {
            let number = if parts.len() > 1 { format!(" {}", idx + 1) } else { String::new() };
            names.push(format!("{}{number}", array.name()));
            columns.push(part.to_vec());
        }
    }
    if columns.is_empty() {
        return Err(refused(
            what,
            "it holds no vectors or matrices of numbers; structures, tables and timeseries are not read: save the \
             vectors themselves, save('swing.mat', 't', 'theta', '-v7')",
        ));
    }
    Ok(text_of(&names, &columns))
}

/// Bytes before the first element, and of an element's type and size.
const HEAD: usize = 128;
const TAG: usize = 8;

/// The type of an element that is packed.
const PACKED: u32 = 15;

/// Zeros pack a thousand times: what is unpacked must fit into memory before the parser unpacks it.
fn check_unpacked_size(bytes: &[u8]) -> Result<(), Fault> {
    let number = if bytes.get(126..128) == Some(b"MI") { u32::from_be_bytes } else { u32::from_le_bytes };
    let number_at = |at: usize| Some(number(bytes.get(at..at + 4)?.try_into().ok()?));
    let (mut at, mut unpacked) = (HEAD, 0);
    while let (Some(kind), Some(size)) = (number_at(at), number_at(at + 4)) {
        let begin = at + TAG;
        let end = begin.saturating_add(size as usize).min(bytes.len());
        if kind == PACKED {
            let unpacker = ZlibDecoder::new(&bytes[begin..end]);
            // A damaged element ends early; the parser says so.
            let mut limited = unpacker.take(MOST_BYTES_WHOLE - unpacked + 1);
            unpacked += count(&mut limited);
            if unpacked > MOST_BYTES_WHOLE {
                return Err(Fault::TooLarge);
            }
        }
        at = if kind == PACKED { end } else { begin + (end - begin).next_multiple_of(TAG) };
    }
    Ok(())
}

/// Bytes that can be read, none of which is kept.
fn count(reader: &mut impl Read) -> u64 {
    let mut buffer = vec![0; 1 << 16];
    let mut n_read = 0;
    while let Ok(n @ 1..) = reader.read(&mut buffer) {
        n_read += n as u64;
    }
    n_read
}

fn is_vector(array: &Array) -> bool {
    array.size().len() == 2 && array.size().contains(&1)
}

/// Scalars are settings, not measurements.
fn is_table(array: &Array) -> bool {
    let size = array.size();
    size.len() == 2 && size.iter().product::<usize>() > 1 && (is_vector(array) || size[1] <= MOST_COLUMNS)
}

/// Numbers of whatever precision; the imaginary part of complex ones is left alone.
fn numbers(data: &NumericData) -> Vec<f64> {
    match data {
        NumericData::Double { real, .. } => real.clone(),
        NumericData::Single { real, .. } => {
            real.iter().map(|x| x.to_string().parse().unwrap_or(f64::from(*x))).collect()
        }
        NumericData::Int8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
        NumericData::UInt64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::ZlibEncoder;
    use std::io::Write;

    /// A file with one packed element that is all zeros.
    fn zeros(n_bytes: u64) -> Vec<u8> {
        let mut packer = ZlibEncoder::new(Vec::new(), Compression::best());
        std::io::copy(&mut std::io::repeat(0).take(n_bytes), &mut packer).unwrap();
        packer.flush().unwrap();
        let packed = packer.finish().unwrap();
        let mut file = b"MATLAB 5.0 MAT-file".to_vec();
        file.resize(124, b' ');
        file.extend([0x00, 0x01, b'I', b'M']);
        file.extend(PACKED.to_le_bytes());
        file.extend((packed.len() as u32).to_le_bytes());
        file.extend(packed);
        file
    }

    #[test]
    fn what_would_fill_the_memory_is_refused_before_it_is_unpacked() {
        let bomb = zeros(MOST_BYTES_WHOLE + (1 << 20));
        assert!(bomb.len() < 1 << 20);
        assert!(matches!(table(&bomb), Err(Fault::TooLarge)));
        assert!(matches!(table(&zeros(1 << 20)), Err(Fault::Foreign { .. })));
    }
}
