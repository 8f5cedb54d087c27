//! Moves the firmware's sample counter on, to see it pass 32 bits without waiting for two months.

use super::{Qemu, WINDOW, ask, connect, debugger};
use crate::HANG;
use std::collections::BTreeMap;
use std::os::unix::net::UnixStream;
use std::time::Instant;

/// The processor's memory.
const RAM: std::ops::Range<u64> = 0x2000_0000..0x2002_0000;

/// Read in pieces that fit the debugger's packets.
const PIECE: u64 = 0x400;

/// The counter has moved on by less than this since it was asked for: what was on its way when the pendulum was held,
/// and one batch more.
const MOST_AHEAD: u64 = WINDOW + 32;

/// Its two places lie in the same structure.
const MOST_APART: u64 = 0x400;

impl Qemu {
    /// Sets the sample counter, which was `last` after the pendulum was held, to `new`. The counter is known by
    /// standing in memory twice, as number of the next sample and in the statistics. Gives what it was.
    pub fn move_counter(&self, last: u64, new: u64) -> Result<u64, String> {
        let began = Instant::now();
        loop {
            let mut line = connect(&debugger(&self.directory))?;
            let outcome = replace(&mut line, last, new);
            ask(&mut line, "D")?;
            // The processor may have been stopped just when one place was ahead of the other.
            if outcome.is_ok() || began.elapsed() > HANG {
                return outcome;
            }
        }
    }
}

fn replace(line: &mut UnixStream, last: u64, new: u64) -> Result<u64, String> {
    let mut places: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
    for start in RAM.step_by(PIECE as usize) {
        for (k, word) in read(line, start)?.into_iter().enumerate() {
            if word >= last && word < last + MOST_AHEAD {
                places.entry(word).or_default().push(start + 8 * k as u64);
            }
        }
    }
    // A copy of it may be left further away, in a batch that was read.
    let pairs = places.iter().flat_map(|(word, places)| places.windows(2).map(|pair| (*word, [pair[0], pair[1]])));
    let near: Vec<(u64, [u64; 2])> = pairs.filter(|(_, pair)| pair[1] - pair[0] < MOST_APART).collect();
    let [(was, found)] = near[..] else {
        return Err(format!("the sample counter was not found once in the memory, but {near:x?}"));
    };
    let bytes: String = new.to_le_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
    found.iter().try_for_each(|place| ask(line, &format!("M{place:x},8:{bytes}")).map(|_| ()))?;
    Ok(was)
}

/// Numbers of 64 bits from `start` on; none from the stack's guard, which nobody may read.
fn read(line: &mut UnixStream, start: u64) -> Result<Vec<u64>, String> {
    let reply = ask(line, &format!("m{start:x},{PIECE:x}"))?;
    if reply.contains("$E") {
        return Ok(Vec::new());
    }
    let hex = reply.split(['$', '#']).find(|part| part.len() == 2 * PIECE as usize);
    let hex = hex.ok_or_else(|| format!("the debugger answered {reply} for {start:x}"))?;
    let byte = |k: usize| hex.get(2 * k..2 * k + 2).and_then(|two| u8::from_str_radix(two, 16).ok());
    let bytes: Option<Vec<u8>> = (0..PIECE as usize).map(byte).collect();
    let bytes = bytes.ok_or("the debugger gave no memory")?;
    Ok(bytes.as_chunks().0.iter().map(|eight| u64::from_le_bytes(*eight)).collect())
}
