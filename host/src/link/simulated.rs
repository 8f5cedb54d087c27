//! The simulated rig in this process.

use super::error::LinkError;
use super::port::Port;
use crate::sim::{Scenario, SimulatedRig};
use std::io;
use std::time::Duration;

/// Every run of the program sees the same noise.
const SEED: u64 = 1;

/// Opens `sim` or `sim:SCENARIO`; `name` is what messages call it.
pub(super) fn open(name: &str, scenario: &str) -> Result<Box<dyn Port>, LinkError> {
    let wanted = if scenario.is_empty() { Scenario::PLAIN } else { scenario };
    let found = Scenario::by_name(wanted).ok_or_else(|| LinkError::NoSuchScenario {
        name: wanted.to_owned(),
        known: Scenario::ALL.iter().map(|scenario| scenario.name.to_owned()).collect(),
    })?;
    Ok(Box::new(SimulatedPort { name: name.to_owned(), rig: SimulatedRig::new(found, SEED) }))
}

/// The simulated rig as a port; its clock is the simulated one.
struct SimulatedPort {
    name: String,
    rig: SimulatedRig,
}

impl Port for SimulatedPort {
    fn name(&self) -> &str {
        &self.name
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        Ok(self.rig.read(buffer, timeout))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.rig.receive(bytes);
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.rig.elapsed_s())
    }
}
