//! A file of whatever dress as lines of text, one after the other, so that a large one is never in memory as a whole.
//!
//! Text is passed on line by line: UTF-8 with or without a mark, UTF-16 by its mark, and where a line is no UTF-8 Latin-1,
//! or Windows-1251 where that makes Cyrillic words of it, or GBK where it makes the words of a Chinese heading. Lines end
//! with a line feed, or all of them with a carriage return. Files of other programs that are no tables of text become one first
//! (`foreign.rs`).

use super::error::Fault;
use super::foreign;
use super::limits::MOST_BYTES_WHOLE;
use encoding_rs::mem::decode_latin1;
use encoding_rs::{GBK, WINDOWS_1251};
use std::borrow::Cow;
use std::io::{self, BufRead, Cursor, Read};

/// So much of a file is looked at to tell what it is.
const N_LOOKED_AT: usize = 4096;

/// A line of a table is shorter.
const LONGEST_LINE: u64 = 1 << 20;

/// A text file is read up to here: ten hours at 1 kHz have 1 GB.
const MOST_BYTES: u64 = 4 << 30;

/// Lines of a file.
pub(super) struct Lines<'a> {
    reader: Box<dyn BufRead + 'a>,
    bytes: Vec<u8>,
    n_read: u64,
    /// What ends a line.
    end: u8,
    /// What the file is called in its archive.
    pub(super) name: Option<String>,
}

impl<'a> Lines<'a> {
    /// Recognises the file and begins with its first line; notes go to `notes`.
    pub(super) fn of(mut reader: impl BufRead + 'a, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let mut head = Vec::new();
        reader.by_ref().take(N_LOOKED_AT as u64).read_to_end(&mut head)?;
        let mut name = None;
        let kind = foreign::Kind::of(&head);
        let end = if kind.is_some() { b'\n' } else { line_end(&head) };
        let whole = |head: Vec<u8>, reader| all_of(Cursor::new(head).chain(reader));
        let reader: Box<dyn BufRead + 'a> = match (&head[..], kind) {
            ([0xff, 0xfe, ..], _) => Box::new(Cursor::new(utf16(&whole(head, reader)?[2..], u16::from_le_bytes))),
            ([0xfe, 0xff, ..], _) => Box::new(Cursor::new(utf16(&whole(head, reader)?[2..], u16::from_be_bytes))),
            (_, Some(kind)) => {
                let (text, its_name) = kind.table(&whole(head, reader)?, notes)?;
                name = its_name;
                Box::new(Cursor::new(text))
            }
            ([0xef, 0xbb, 0xbf, rest @ ..], _) => Box::new(Cursor::new(rest.to_vec()).chain(reader)),
            _ => Box::new(Cursor::new(head).chain(reader)),
        };
        Ok(Self { reader, bytes: Vec::new(), n_read: 0, end, name })
    }

    /// The next line without its end, and whether it has one; `None` behind the last.
    pub(super) fn next_into(&mut self, line: &mut String) -> Result<Option<bool>, Fault> {
        self.bytes.clear();
        let n = self.reader.by_ref().take(LONGEST_LINE).read_until(self.end, &mut self.bytes)?;
        if n == 0 {
            return Ok(None);
        }
        let begin = self.n_read;
        self.n_read += n as u64;
        let is_complete = self.bytes.ends_with(&[self.end]);
        if let Some(at) = self.bytes.iter().position(|byte| is_foreign(*byte)) {
            let fault = Fault::NotText { byte: self.bytes[at], position: (begin as usize) + at };
            // A power cut can leave zero bytes behind the last block written.
            if self.bytes[at] != 0 || !self.only_zeros_follow(at)? {
                return Err(fault);
            }
            self.bytes.truncate(at);
            if self.bytes.is_empty() {
                return Ok(None);
            }
        } else if self.n_read > MOST_BYTES || n as u64 == LONGEST_LINE {
            return Err(Fault::TooLarge);
        }
        line.clear();
        let kept = self.bytes.strip_suffix(b"\n").unwrap_or(&self.bytes);
        let kept = kept.strip_suffix(b"\r").unwrap_or(kept);
        match std::str::from_utf8(kept) {
            Ok(text) => line.push_str(text),
            Err(_) => line.push_str(&of_some_alphabet(kept)),
        }
        Ok(Some(is_complete && self.bytes.ends_with(&[self.end])))
    }

    fn only_zeros_follow(&mut self, at: usize) -> Result<bool, Fault> {
        /// Blocks of a disk are smaller.
        const MOST_ZEROS: u64 = 16 << 20;
        let mut rest = Vec::new();
        self.reader.by_ref().take(MOST_ZEROS).read_to_end(&mut rest)?;
        let is_all = (rest.len() as u64) < MOST_ZEROS;
        Ok(is_all && self.bytes[at..].iter().chain(&rest).all(|byte| *byte == 0))
    }
}

/// Old Macs, and spreadsheets that write for them, end lines with a carriage return alone.
fn line_end(head: &[u8]) -> u8 {
    if head.contains(&b'\n') || !head.contains(&b'\r') { b'\n' } else { b'\r' }
}

/// A line that is no UTF-8.
fn of_some_alphabet(bytes: &[u8]) -> Cow<'_, str> {
    let european = || match has_cyrillic_words(bytes) {
        true => WINDOWS_1251.decode_without_bom_handling(bytes).0,
        false => decode_latin1(bytes),
    };
    of_gbk(bytes).unwrap_or_else(european)
}

/// Letters beyond ASCII stand alone or in twos in the words of Latin-1, and make up those of Windows-1251.
fn has_cyrillic_words(bytes: &[u8]) -> bool {
    const SHORTEST_WORD: usize = 4;
    bytes.split(|byte| *byte < 0xc0).any(|word| word.len() >= SHORTEST_WORD)
}

/// Text in GBK, in which spreadsheets in China save their tables, if a word of a heading stands in it.
fn of_gbk(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let text = GBK.decode_without_bom_handling_and_without_replacement(bytes)?;
    HEADING_IN_CHINESE.iter().any(|word| text.contains(word)).then_some(text)
}

/// Words for time, angle, turn, second, period, place, speed and length.
const HEADING_IN_CHINESE: [&str; 9] = ["时间", "角度", "摆角", "角位移", "弧度", "毫秒", "周期", "位置", "速度"];

/// Text has no control characters except tab, line ends and form feed.
fn is_foreign(byte: u8) -> bool {
    byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c)
}

/// Everything, up to a limit.
fn all_of(reader: impl Read) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    let n = reader.take(MOST_BYTES_WHOLE).read_to_end(&mut bytes)?;
    if n as u64 == MOST_BYTES_WHOLE { Err(Fault::TooLarge) } else { Ok(bytes) }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16_lossy(&units).into_bytes()
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Unreadable(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_in_gbk_is_told_from_latin_and_cyrillic_words() {
        let heading = b"\xca\xb1\xbc\xe4(s),\xb0\xda\xbd\xc7(\xb6\xc8),\xb1\xb8\xd7\xa2";
        assert_eq!(of_some_alphabet(heading), "时间(s),摆角(度),备注");
        assert_eq!(of_some_alphabet(b"t;Winkel (\xb0)"), "t;Winkel (°)");
        assert_eq!(of_some_alphabet(b"\xc2\xf0\xe5\xec\xff, \xf1"), "Время, с");
        assert_eq!(of_some_alphabet(b"\xca\xb1\xbc\xe4,\xb0"), "Ê±¼ä,°");
    }
}
