//! Inputs for parsers under attack: something sensible, edited here and there as random bytes say.

use std::path::Path;

/// One edit takes so many of the random bytes.
const ORDER: usize = 5;

/// Edits of one input at most.
const MOST_EDITS: usize = 6;

/// No input grows longer.
const LONGEST: usize = 1 << 16;

/// What parsers have stumbled over before.
const WORDS: [&str; 48] = [
    "NaN",
    "inf",
    "-inf",
    "1e999",
    "-1e999",
    "1e-320",
    "-0",
    "0",
    "1",
    "-1",
    "0.5",
    "1e308",
    "2147483648",
    "18446744073709551616",
    "true",
    "null",
    "\"\"",
    "{}",
    "[]",
    "[",
    "]",
    "{",
    "}",
    "(",
    ")",
    ",",
    ";",
    ":",
    "=",
    "..",
    "^",
    "*",
    "/",
    "+",
    "-",
    "abs(",
    "sqrt(",
    "exp(",
    "theta",
    "omega",
    "t",
    "load",
    " in ",
    "\n",
    "\r\n",
    "\t",
    "\u{0}",
    "\u{feff}",
];

/// Beginnings, each sensible as it is.
pub struct Seeds(Vec<Vec<u8>>);

impl Seeds {
    /// The files of `tests/corpus/NAME`, in the order of their names.
    pub fn of_folder(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let mut paths: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
        paths.sort();
        Self(paths.iter().map(|path| std::fs::read(path).expect("a readable file")).collect())
    }

    /// These.
    pub fn new(seeds: Vec<Vec<u8>>) -> Self {
        Self(seeds)
    }

    /// As they are.
    pub fn all(&self) -> &[Vec<u8>] {
        &self.0
    }

    /// The first byte chooses a seed, or that what follows is taken as it is; then five bytes make an edit.
    pub fn edited(&self, orders: &[u8]) -> Vec<u8> {
        let [which, orders @ ..] = orders else { return Vec::new() };
        if *which == u8::MAX {
            return orders.to_vec();
        }
        let mut bytes = self.0[usize::from(*which) % self.0.len()].clone();
        for order in orders.chunks_exact(ORDER).take(MOST_EDITS) {
            self.edit(&mut bytes, [order[0], order[1], order[2], order[3], order[4]]);
        }
        bytes.truncate(LONGEST);
        bytes
    }

    fn edit(&self, bytes: &mut Vec<u8>, [what, high, low, length, which]: [u8; ORDER]) {
        let from = usize::from(u16::from_be_bytes([high, low])) % (bytes.len() + 1);
        let to = (from + usize::from(length) % 12).min(bytes.len());
        let word = WORDS[usize::from(which) % WORDS.len()].as_bytes();
        let replacement = match what % 8 {
            0 => Vec::new(),
            1 => vec![which],
            2 | 3 => word.to_vec(),
            4 => [&bytes[from..to], word].concat(),
            5 => bytes[from..to].repeat(2),
            // Deep nesting and long lines, now and then.
            6 if which > 250 => bytes[from..to].repeat(4096),
            6 => bytes[from..to].repeat(usize::from(which % 32)),
            _ => {
                let other = &self.0[usize::from(which) % self.0.len()];
                let start = from.min(other.len());
                other[start..(start + usize::from(length)).min(other.len())].to_vec()
            }
        };
        bytes.splice(from..to, replacement);
    }
}
