//! MATLAB files of version 4 (`save -v4`): matrices one after the other, each behind a head of five numbers, after
//! MathWorks, "MAT-File Format" (2023), chapter 2.

use super::mat5::{Element, Problem, Variable, kind, numbers};

/// Bytes of a head.
const HEAD: usize = 20;

/// Names are shorter.
const LONGEST_NAME: usize = 256;

/// What stands before a matrix.
struct Head {
    is_big: bool,
    /// Place in [`PRECISIONS`].
    precision: usize,
    is_plain: bool,
    n_rows: usize,
    n_columns: usize,
    /// 2 where an imaginary part follows.
    n_parts: usize,
    /// With the zero behind it.
    name_length: usize,
}

/// Kinds of numbers and their bytes.
const PRECISIONS: [(u32, usize); 6] =
    [(kind::F64, 8), (kind::F32, 4), (kind::I32, 4), (kind::I16, 2), (kind::U16, 2), (kind::U8, 1)];

impl Head {
    /// `None` where the bytes are no head.
    fn of(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; HEAD] = bytes.get(..HEAD)?.try_into().ok()?;
        Self::in_order(bytes, false).or_else(|| Self::in_order(bytes, true))
    }

    fn in_order(bytes: &[u8; HEAD], is_big: bool) -> Option<Self> {
        let mut words = bytes.chunks_exact(4).map(|word| {
            let word = word.try_into().unwrap_or_default();
            let word = if is_big { u32::from_be_bytes(word) } else { u32::from_le_bytes(word) };
            usize::try_from(word).unwrap_or(usize::MAX)
        });
        let (what, n_rows, n_columns) = (words.next()?, words.next()?, words.next()?);
        let (n_imaginary, name_length) = (words.next()?, words.next()?);
        let (precision, form) = (what / 10 % 100, what % 10);
        let is_head = what / 1000 == usize::from(is_big) && precision < PRECISIONS.len() && form <= 2;
        (is_head && n_imaginary <= 1 && (1..=LONGEST_NAME).contains(&name_length)).then_some(Self {
            is_big,
            precision,
            is_plain: form == 0,
            n_rows,
            n_columns,
            n_parts: 1 + n_imaginary,
            name_length,
        })
    }
}

/// Do the first bytes of a file begin such a matrix?
pub(super) fn begins(bytes: &[u8]) -> bool {
    let name = |head: Head| bytes.get(HEAD..HEAD + head.name_length).and_then(<[u8]>::split_last);
    let is_name =
        |letters: &[u8]| !letters.is_empty() && letters.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_');
    Head::of(bytes).and_then(name).is_some_and(|(end, letters)| *end == 0 && is_name(letters))
}

/// The variables of a file, with their names; of complex ones the real part.
pub(super) fn variables(file: &[u8]) -> Result<Vec<(String, Variable)>, Problem> {
    let (mut found, mut rest) = (Vec::new(), file);
    while !rest.is_empty() {
        let head = Head::of(rest).ok_or(Problem::Damaged)?;
        let (kind, width) = PRECISIONS[head.precision];
        let n_bytes = head.n_rows.checked_mul(head.n_columns).and_then(|n| n.checked_mul(width));
        let (from, n_bytes) = (HEAD + head.name_length, n_bytes.ok_or(Problem::Damaged)?);
        let end = n_bytes.checked_mul(head.n_parts).and_then(|n| n.checked_add(from)).ok_or(Problem::Damaged)?;
        let (whole, behind) = rest.split_at_checked(end).ok_or(Problem::Damaged)?;
        let name = whole[HEAD..from].split(|byte| *byte == 0).next().unwrap_or_default();
        let values = || numbers(&Element { kind, data: &whole[from..from + n_bytes] }, head.is_big);
        let variable = match head.is_plain {
            true => Variable::Numbers { n_rows: head.n_rows, n_columns: head.n_columns, values: values() },
            false => Variable::Other,
        };
        found.push((String::from_utf8_lossy(name).into_owned(), variable));
        rest = behind;
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix of 16-bit numbers, a text, and a complex number.
    fn file(is_big: bool) -> Vec<u8> {
        let word = |word: u32| if is_big { word.to_be_bytes() } else { word.to_le_bytes() };
        let half = |half: i16| if is_big { half.to_be_bytes() } else { half.to_le_bytes() };
        let double = |double: f64| if is_big { double.to_be_bytes() } else { double.to_le_bytes() };
        let order = if is_big { 1000 } else { 0 };
        let head = |what: u32, n_rows: u32, n_columns: u32, is_complex: u32, name: &str| {
            let words = [order + what, n_rows, n_columns, is_complex, name.len() as u32 + 1];
            [words.into_iter().flat_map(word).collect(), name.as_bytes().to_vec(), vec![0]].concat()
        };
        let matrix: Vec<u8> = [1, -2, 3, -4].into_iter().flat_map(half).collect();
        let complex: Vec<u8> = [0.5, 9.0].into_iter().flat_map(double).collect();
        let text: Vec<u8> = [104.0, 105.0].into_iter().flat_map(double).collect();
        [head(30, 2, 2, 0, "data"), matrix, head(1, 1, 2, 0, "text"), text, head(0, 1, 1, 1, "z"), complex].concat()
    }

    #[test]
    fn matrices_of_either_byte_order_are_read_and_text_is_passed_over() {
        for is_big in [false, true] {
            assert!(begins(&file(is_big)));
            let found = variables(&file(is_big)).unwrap();
            let numbers = |n_rows, n_columns, values| Variable::Numbers { n_rows, n_columns, values };
            assert_eq!(found[0], ("data".to_owned(), numbers(2, 2, vec![1.0, -2.0, 3.0, -4.0])));
            assert_eq!(found[1], ("text".to_owned(), Variable::Other));
            assert_eq!(found[2], ("z".to_owned(), numbers(1, 1, vec![0.5])));
        }
    }

    #[test]
    fn a_file_that_ends_early_is_damaged_and_zeros_are_none() {
        let whole = file(false);
        let matrices_end = [33, 74, 106];
        for end in (1..whole.len()).filter(|end| !matrices_end.contains(end)) {
            assert_eq!(variables(&whole[..end]), Err(Problem::Damaged), "{end}");
        }
        assert!(!begins(&[0; 64]) && !begins(b"t,theta\n0,1\n0.1,2\n0.2,3\n"));
        let huge = [[0xff; 4], [0xff; 4]].concat();
        let head = [&[0; 4], &huge[..], &[0; 4], &[2, 0, 0, 0], b"t\0"].concat();
        assert_eq!(variables(&head), Err(Problem::Damaged));
    }
}
