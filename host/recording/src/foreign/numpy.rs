//! Arrays of NumPy: what `numpy.save` writes (.npy), and in an archive what `numpy.savez` does (.npz), after the format's
//! versions 1 to 3. A vector is a column; of a matrix the shorter side counts the columns, as in MATLAB files.

use super::as_text::{refused, text_of};
use crate::error::Fault;

const MAGIC: &[u8] = b"\x93NUMPY";

/// A matrix with more columns, and more rows, is a picture, not a table.
const MOST_COLUMNS: usize = 64;

pub(super) fn begins(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// An array that stands alone is a table without names.
pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    Ok(text_of(&[], &columns(bytes)?))
}

/// Its columns.
pub(super) fn columns(bytes: &[u8]) -> Result<Vec<Vec<f64>>, Fault> {
    Ok(Array::of(bytes).ok_or_else(no_table)?.columns())
}

/// It holds something else than columns.
pub(super) fn no_table() -> Fault {
    let cure = "expected an array of one or two dimensions of plain numbers; save it as text: numpy.savetxt(\"swing.csv\", \
                numpy.c_[t, theta])";
    refused("NumPy array", cure)
}

struct Array {
    n_rows: usize,
    n_columns: usize,
    /// Column after column, where it was kept so, else row after row.
    is_by_columns: bool,
    values: Vec<f64>,
}

impl Array {
    /// `None` where it is damaged, or holds something else.
    fn of(bytes: &[u8]) -> Option<Self> {
        let (n_size, size) = match bytes.get(6)? {
            1 => (2, usize::from(u16::from_le_bytes(bytes.get(8..10)?.try_into().ok()?))),
            2 | 3 => (4, usize::try_from(u32::from_le_bytes(bytes.get(8..12)?.try_into().ok()?)).ok()?),
            _ => return None,
        };
        let (head, data) = bytes.get(8 + n_size..)?.split_at_checked(size)?;
        let head = std::str::from_utf8(head).ok()?;
        let behind = |key: &str| head.split_once(&format!("'{key}':")).map(|(_, rest)| rest.trim_start());
        let descr = behind("descr")?.strip_prefix('\'')?.split('\'').next()?;
        let shape = behind("shape")?.strip_prefix('(')?.split(')').next()?;
        let shape: Option<Vec<usize>> =
            shape.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect();
        let (n_rows, n_columns) = match shape?[..] {
            [] => (1, 1),
            [n] => (n, 1),
            [n_rows, n_columns] => (n_rows, n_columns),
            _ => return None,
        };
        let (read, width) = reader(descr)?;
        let n_bytes = n_rows.checked_mul(n_columns)?.checked_mul(width)?;
        let values = data.get(..n_bytes)?.chunks_exact(width).map(read).collect();
        let is_by_columns = behind("fortran_order")?.starts_with("True");
        (n_rows.min(n_columns) <= MOST_COLUMNS).then_some(Self { n_rows, n_columns, is_by_columns, values })
    }

    fn columns(&self) -> Vec<Vec<f64>> {
        let Self { n_rows, n_columns, is_by_columns, values } = self;
        let value = |row: usize, column: usize| match is_by_columns {
            true => values[column * n_rows + row],
            false => values[row * n_columns + column],
        };
        // Samples are more than quantities.
        match n_columns > n_rows {
            true => (0..*n_rows).map(|row| (0..*n_columns).map(|column| value(row, column)).collect()).collect(),
            false => (0..*n_columns).map(|column| (0..*n_rows).map(|row| value(row, column)).collect()).collect(),
        }
    }
}

/// What makes a number of so many bytes: `<f8`, `>i4`, `|b1`.
fn reader(descr: &str) -> Option<(impl Fn(&[u8]) -> f64, usize)> {
    let mut letters = descr.chars();
    let (order, kind, width) = (letters.next()?, letters.next()?, letters.as_str());
    let width: usize = width.parse().ok()?;
    let is_known = match kind {
        'f' => matches!(width, 4 | 8),
        'i' | 'u' => matches!(width, 1 | 2 | 4 | 8),
        'b' => width == 1,
        _ => false,
    };
    let read = move |bytes: &[u8]| {
        // Up to eight bytes in the order of a little-endian number.
        let mut all = [0; 8];
        for (place, byte) in bytes.iter().enumerate() {
            all[if order == '>' { width - 1 - place } else { place }] = *byte;
        }
        let bits = u64::from_le_bytes(all);
        match (kind, width) {
            ('f', 4) => f64::from(f32::from_bits(bits as u32)),
            ('f', _) => f64::from_bits(bits),
            // The sign fills what is not there.
            ('i', _) => ((bits << (64 - 8 * width)) as i64 >> (64 - 8 * width)) as f64,
            _ => bits as f64,
        }
    };
    is_known.then_some((read, width))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let head = format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        [MAGIC, &[1, 0], &(head.len() as u16).to_le_bytes(), head.as_bytes(), data].concat()
    }

    #[test]
    fn vectors_and_matrices_of_any_number_are_columns() {
        let doubles: Vec<u8> = [0.0, 0.5, 1.0, 0.25, 2.0, -1.5].into_iter().flat_map(f64::to_le_bytes).collect();
        let (times, angles) = (vec![0.0, 1.0, 2.0], vec![0.5, 0.25, -1.5]);
        assert_eq!(columns(&file("<f8", "False", "(3, 2)", &doubles)).unwrap(), [times.clone(), angles.clone()]);
        assert_eq!(columns(&file("<f8", "True", "(2, 3)", &doubles)).unwrap(), [times, angles]);
        assert_eq!(columns(&file("<f8", "False", "(6,)", &doubles)).unwrap()[0].len(), 6);
        assert_eq!(columns(&file(">i2", "False", "(2,)", &[0xff, 0xfe, 1, 0])).unwrap(), [[-2.0, 256.0]]);
        assert_eq!(columns(&file("<u2", "False", "(2,)", &[0xfe, 0xff, 1, 0])).unwrap(), [[65534.0, 1.0]]);
        assert_eq!(columns(&file("<f4", "False", "(1,)", &1.5_f32.to_le_bytes())).unwrap(), [[1.5]]);
    }

    #[test]
    fn what_is_damaged_or_of_another_kind_is_refused_with_the_cure() {
        let whole = file("<f8", "False", "(2,)", &[0; 16]);
        let cut = (0..whole.len()).map(|end| whole[..end].to_vec());
        let others = [("<c8", "(1,)"), ("|O", "()"), ("<f8", "(9, 9, 9)"), ("<f8", "(99999999999, 99999999999)")];
        let others = others.into_iter().map(|(descr, shape)| file(descr, "False", shape, &[0; 8]));
        for bytes in cut.chain(others) {
            assert!(columns(&bytes).unwrap_err().to_string().contains("numpy.savetxt"));
        }
    }
}
