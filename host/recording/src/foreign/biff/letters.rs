//! Texts of BIFF8, of one or two bytes a letter, which may begin in one record and end in another.

use crate::foreign::little::{u16_at, u32_at};

/// Letters are of two bytes, not of one.
const WIDE: u8 = 1;
/// Something about Asian writing stands behind them.
const WITH_MORE: u8 = 4;
/// How parts of them look stands behind them.
const DRESSED: u8 = 8;

/// No name of a column is longer. Of a longer text that all cells share the table would be far larger than the file.
const MOST_LETTERS: usize = 255;

/// What is left of the records.
pub(super) struct Letters<'a> {
    now: &'a [u8],
    others: &'a [&'a [u8]],
}

impl<'a> Letters<'a> {
    pub(super) fn of(records: &'a [&'a [u8]]) -> Self {
        Self { now: &[], others: records }
    }

    /// A text whose length takes two bytes.
    pub(super) fn text(&mut self) -> Option<String> {
        let n_letters = self.u16()?;
        let how = self.byte()?;
        let n_dresses = if how & DRESSED == 0 { 0 } else { self.u16()? };
        let n_more = if how & WITH_MORE == 0 { 0 } else { self.u32()? };
        let text = self.letters(usize::from(n_letters), how & WIDE != 0)?;
        self.skip(4 * usize::from(n_dresses))?;
        self.skip(n_more as usize)?;
        Some(text)
    }

    /// A text whose length takes one byte.
    pub(super) fn short_text(&mut self) -> Option<String> {
        let n_letters = self.byte()?;
        let is_wide = self.byte()? & WIDE != 0;
        self.letters(usize::from(n_letters), is_wide)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        u32_at(&[self.byte()?, self.byte()?, self.byte()?, self.byte()?], 0)
    }

    pub(super) fn skip(&mut self, n_bytes: usize) -> Option<()> {
        let mut left = n_bytes;
        while left > 0 {
            self.begin_next_if_empty()?;
            let n = left.min(self.now.len());
            self.now = &self.now[n..];
            left -= n;
        }
        Some(())
    }

    fn u16(&mut self) -> Option<u16> {
        u16_at(&[self.byte()?, self.byte()?], 0)
    }

    fn byte(&mut self) -> Option<u8> {
        self.begin_next_if_empty()?;
        let (byte, rest) = self.now.split_first()?;
        self.now = rest;
        Some(*byte)
    }

    fn begin_next_if_empty(&mut self) -> Option<()> {
        while self.now.is_empty() {
            (self.now, self.others) = self.others.split_first().map(|(next, others)| (*next, others))?;
        }
        Some(())
    }

    /// Where letters go on in the next record, that says anew how wide they are.
    fn letters(&mut self, n_letters: usize, is_wide: bool) -> Option<String> {
        let (mut units, mut is_wide) = (Vec::new(), is_wide);
        while units.len() < n_letters {
            if self.now.len() <= usize::from(is_wide) {
                self.now = &[];
                is_wide = self.byte()? & WIDE != 0;
                continue;
            }
            let n_bytes = self.now.len().min((n_letters - units.len()) << u32::from(is_wide));
            let (letters, rest) = self.now.split_at(n_bytes - n_bytes % (1 + usize::from(is_wide)));
            match is_wide {
                true => units.extend(letters.chunks_exact(2).filter_map(|two| u16_at(two, 0))),
                false => units.extend(letters.iter().copied().map(u16::from)),
            }
            self.now = rest;
        }
        units.truncate(MOST_LETTERS);
        Some(String::from_utf16_lossy(&units))
    }
}
