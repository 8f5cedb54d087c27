//! Moves the firmware's sample counter on, to see it pass 32 bits without waiting for two months.

use super::{Qemu, ask_debugger, connect, debugger};
use std::collections::BTreeMap;
use std::os::unix::net::UnixStream;
use std::time::Duration;

/// The processor's memory.
const RAM: std::ops::Range<u64> = 0x2000_0000..0x2002_0000;

/// Read in pieces that fit the debugger's packets.
const PIECE: u64 = 0x400;

/// The counter has moved on by less than this since it was asked for.
const MOST_AHEAD: u64 = 20_000;

/// It may stand still just when one place is ahead of the other.
const N_TRIES: u32 = 20;

/// Its two places lie in the same structure.
const MOST_APART: u64 = 0x400;

impl Qemu {
    /// Sets the sample counter, which was `last` a moment ago, to `new`, while the processor stands still. The counter
    /// is known by standing in memory twice, as number of the next sample and in the statistics. Gives what it was.
    pub fn move_counter(&self, last: u64, new: u64) -> Result<u64, String> {
        let mut outcome = Err(String::new());
        for _ in 0..N_TRIES {
            let mut line = connect(&debugger(&self.directory))?;
            outcome = replace(&mut line, last, new);
            ask(&mut line, "D")?;
            if outcome.is_ok() {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        outcome
    }
}

fn replace(line: &mut UnixStream, last: u64, new: u64) -> Result<u64, String> {
    let mut places: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
    for start in RAM.step_by(PIECE as usize) {
        for (k, word) in read(line, start)?.into_iter().enumerate() {
            if word > last && word < last + MOST_AHEAD {
                places.entry(word).or_default().push(start + 8 * k as u64);
            }
        }
    }
    places.retain(|_, places| places.len() == 2 && places[1] - places[0] < MOST_APART);
    let (was, found) = places.first_key_value().ok_or("the sample counter was not found in the memory")?;
    if places.len() > 1 {
        return Err(format!("the sample counter could be any of {places:x?}"));
    }
    let bytes: String = new.to_le_bytes().iter().map(|byte| format!("{byte:02x}")).collect();
    found.iter().try_for_each(|place| ask(line, &format!("M{place:x},8:{bytes}")).map(|_| ()))?;
    Ok(*was)
}

/// Numbers of 64 bits from `start` on.
fn read(line: &mut UnixStream, start: u64) -> Result<Vec<u64>, String> {
    let reply = ask(line, &format!("m{start:x},{PIECE:x}"))?;
    let hex = reply.split(['$', '#']).find(|part| part.len() == 2 * PIECE as usize);
    let hex = hex.ok_or_else(|| format!("the debugger answered {reply} for {start:x}"))?;
    let byte = |k: usize| hex.get(2 * k..2 * k + 2).and_then(|two| u8::from_str_radix(two, 16).ok());
    let bytes: Option<Vec<u8>> = (0..PIECE as usize).map(byte).collect();
    let bytes = bytes.ok_or("the debugger gave no memory")?;
    Ok(bytes.as_chunks().0.iter().map(|eight| u64::from_le_bytes(*eight)).collect())
}

fn ask(line: &mut UnixStream, request: &str) -> Result<String, String> {
    ask_debugger(line, request).map_err(|error| format!("{request}: {error}"))
}
