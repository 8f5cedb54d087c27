//! Stops the processor in the middle of what it writes: after a certain write, not after a certain time.

use super::{Qemu, ask, connect, debugger, jump, must};
use crate::HANG;
use std::io::{ErrorKind, Read, Write};
use std::ops::Range;
use std::os::unix::net::UnixStream;
use std::time::Instant;

/// The processor stops after every write to this memory.
pub struct Writes {
    line: UnixStream,
    watched: String,
}

impl Qemu {
    /// Watches this memory; the processor runs on until it is written.
    pub fn watch_writes(&self, memory: &Range<u64>) -> Result<Writes, String> {
        let mut line = connect(&debugger(&self.directory))?;
        let watched = format!("2,{:x},{:x}", memory.start, memory.end - memory.start);
        // Asked first whether it has stopped: news of that must not be taken for a write.
        ask(&mut line, "qSupported")?;
        must(&mut line, &format!("Z{watched}"))?;
        go_on(&mut line)?;
        Ok(Writes { line, watched })
    }
}

impl Writes {
    /// Lets so many writes happen, or fewer if nothing is written any more and `is_over` says so; then makes the
    /// processor go on at another address. Gives how many there were.
    pub fn jump_after(mut self, n_writes: u32, address: u32, mut is_over: impl FnMut() -> bool) -> Result<u32, String> {
        let mut n_seen = 0;
        loop {
            if wait_for_stop(&mut self.line, &mut is_over)? {
                n_seen += 1;
            } else {
                // Any byte stops it.
                self.line.write_all(&[3]).map_err(|error| error.to_string())?;
                wait_for_stop(&mut self.line, || false)?;
                break;
            }
            if n_seen == n_writes {
                break;
            }
            self.step_over()?;
            go_on(&mut self.line)?;
        }
        must(&mut self.line, &format!("z{}", self.watched))?;
        jump(&mut self.line, address)?;
        ask(&mut self.line, "D")?;
        Ok(n_seen)
    }

    /// Watched, the instruction that writes would only stop the processor again.
    fn step_over(&mut self) -> Result<(), String> {
        must(&mut self.line, &format!("z{}", self.watched))?;
        self.line.write_all(b"$s#73").map_err(|error| error.to_string())?;
        wait_for_stop(&mut self.line, || false)?;
        must(&mut self.line, &format!("Z{}", self.watched))
    }
}

/// There is no answer before the processor stops.
fn go_on(line: &mut UnixStream) -> Result<(), String> {
    line.write_all(b"$c#63").map_err(|error| error.to_string())
}

/// Has it stopped? False if it has not when `is_over`.
fn wait_for_stop(line: &mut UnixStream, mut is_over: impl FnMut() -> bool) -> Result<bool, String> {
    let (began, mut heard) = (Instant::now(), String::new());
    while began.elapsed() < HANG {
        let mut bytes = [0; 256];
        match line.read(&mut bytes) {
            Ok(0) => return Err("the debugger is gone".into()),
            Ok(n_bytes) => heard += &String::from_utf8_lossy(&bytes[..n_bytes]),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                if is_over() {
                    return Ok(false);
                }
            }
            Err(error) => return Err(error.to_string()),
        }
        if heard.split('$').skip(1).any(|packet| packet.starts_with('T') && packet.contains('#')) {
            line.write_all(b"+").map_err(|error| error.to_string())?;
            return Ok(true);
        }
    }
    Err("the processor neither stopped nor was it done".into())
}
