//! Frames on the wire: a message and its check sum, stuffed so that a zero byte only ends them.

use super::frame::{ForRig, Frame};
use heapless::Vec;
use serde::Deserialize;

/// The longest frame on the wire, delimiter included.
pub const MAX_FRAME: usize = 512;

/// CRC-32/ISCSI: Hamming distance 6 up to 5 kB.
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI);

/// Bytes that stuffing adds in front at most: one, and one for each 254 bytes without a zero.
const STUFFING: usize = 1 + MAX_FRAME / 254;

/// Bytes of the check sum.
const CHECK: usize = 4;

/// Encodes a frame for the wire, delimiter included.
///
/// Message, check sum and stuffing are three passes over the buffer: in one pass, byte by byte, they take the board
/// three times as long.
pub fn encode<'b>(frame: &Frame, buffer: &'b mut [u8; MAX_FRAME]) -> Result<&'b [u8], postcard::Error> {
    let message = postcard::to_slice(frame, &mut buffer[STUFFING..MAX_FRAME - CHECK - 1])?;
    let (n_bytes, check) = (message.len(), CRC.checksum(message));
    let end = STUFFING + n_bytes + CHECK;
    buffer[end - CHECK..end].copy_from_slice(&check.to_le_bytes());
    let length = stuff(buffer, STUFFING, end);
    buffer[length] = 0;
    Ok(&buffer[..=length])
}

/// Consistent Overhead Byte Stuffing (Cheshire, Baker 1999) of the bytes from `start` to `end`, moved to the buffer's
/// beginning; gives the new length. `start` leaves room for what is added, so nothing is overwritten unread.
fn stuff(buffer: &mut [u8; MAX_FRAME], start: usize, end: usize) -> usize {
    let (mut run_at, mut to) = (0, 1);
    for from in start..end {
        let byte = buffer[from];
        if byte != 0 {
            buffer[to] = byte;
            to += 1;
        }
        if byte == 0 || to - run_at == 0xff {
            buffer[run_at] = (to - run_at) as u8;
            run_at = to;
            to += 1;
        }
    }
    buffer[run_at] = (to - run_at) as u8;
    to
}

/// Why received bytes are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireError {
    /// Longer than any frame: bytes are skipped to the next delimiter.
    TooLong,
    /// Not COBS, a wrong check sum, or a message unknown to this version.
    Damaged,
}

/// Finds frames in a stream of bytes.
#[derive(Clone, Debug)]
pub struct Deframer {
    bytes: Vec<u8, MAX_FRAME>,
    too_long: bool,
}

impl Default for Deframer {
    fn default() -> Self {
        Self::new()
    }
}

impl Deframer {
    /// Waiting for the first byte.
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), too_long: false }
    }

    /// Takes one byte; says something at the end of each frame. Empty frames (a lone delimiter, with which every
    /// session starts) are passed over.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame, WireError>> {
        self.push_and(decode, byte)
    }

    /// The same for the rig, which needs no code for frames that only a PC receives: to it they are damaged.
    pub fn push_at_rig(&mut self, byte: u8) -> Option<Result<Frame, WireError>> {
        self.push_and(|bytes| decode_as::<ForRig>(bytes).map(Frame::from), byte)
    }

    fn push_and(
        &mut self,
        decode: impl Fn(&mut [u8]) -> Result<Frame, WireError>,
        byte: u8,
    ) -> Option<Result<Frame, WireError>> {
        if byte != 0 {
            self.too_long |= self.bytes.push(byte).is_err();
            return None;
        }
        let outcome = match (self.too_long, self.bytes.is_empty()) {
            (true, _) => Some(Err(WireError::TooLong)),
            (false, true) => None,
            (false, false) => Some(decode(&mut self.bytes)),
        };
        self.bytes.clear();
        self.too_long = false;
        outcome
    }
}

/// Decodes the bytes between two delimiters; the buffer is used as scratch space.
pub fn decode(bytes: &mut [u8]) -> Result<Frame, WireError> {
    decode_as(bytes)
}

fn decode_as<F: for<'de> Deserialize<'de>>(bytes: &mut [u8]) -> Result<F, WireError> {
    let length = uncobs(bytes).ok_or(WireError::Damaged)?;
    match postcard::take_from_bytes_crc32(&bytes[..length], CRC.digest()) {
        Ok((frame, [])) => Ok(frame),
        _ => Err(WireError::Damaged),
    }
}

/// Consistent Overhead Byte Stuffing (Cheshire, Baker 1999), undone in place; gives the new length.
fn uncobs(bytes: &mut [u8]) -> Option<usize> {
    let (mut from, mut to) = (0, 0);
    while from < bytes.len() {
        let run = usize::from(bytes[from]);
        let end = from.checked_add(run).filter(|end| run > 0 && *end <= bytes.len())?;
        bytes.copy_within(from + 1..end, to);
        to += run - 1;
        from = end;
        if run < 0xff && from < bytes.len() {
            bytes[to] = 0;
            to += 1;
        }
    }
    Some(to)
}
