//! The simulated rig in the time of the wall clock, for somebody who watches it.

use super::port::Port;
use std::io;
use std::time::{Duration, Instant};

/// Behind the wall clock by more than this, the rig's clock has been standing still.
const LATE: Duration = Duration::from_millis(200);

/// A port whose own clock is held back to that of the wall, times a speed.
pub struct Paced {
    inner: Box<dyn Port>,
    began: Instant,
    speed: f64,
}

impl Paced {
    /// `speed` 1 is real time; it must be above zero.
    pub fn new(inner: Box<dyn Port>, speed: f64) -> Self {
        Self { inner, began: Instant::now(), speed }
    }
}

impl Port for Paced {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let n_bytes = self.inner.read(buffer, timeout)?;
        let due = self.inner.elapsed().div_f64(self.speed);
        let passed = self.began.elapsed();
        if passed > due + LATE {
            // Nobody read for a while: the pendulum waited, and does not catch up.
            self.began += passed - due;
        }
        std::thread::sleep(due.saturating_sub(passed));
        Ok(n_bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.inner.write(bytes)
    }

    fn elapsed(&self) -> Duration {
        self.inner.elapsed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link;

    #[test]
    fn a_second_of_the_rig_takes_its_share_of_a_second() {
        let mut port = Paced::new(link::open("sim").unwrap(), 10.0);
        let began = Instant::now();
        while port.elapsed() < Duration::from_secs(1) {
            port.read(&mut [0; 64], Duration::from_millis(20)).unwrap();
        }
        assert!(began.elapsed() > Duration::from_millis(95), "{:?}", began.elapsed());
    }
}
