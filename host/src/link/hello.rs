//! The first words: who is at the other end, or what was heard instead.

use super::LinkError;
use shared::wire::{Hello, MAGIC, NEWEST_PROTOCOL, PROTOCOL};

/// What the program calls itself.
pub(super) const OWN_NAME: &str = "host";

/// Bytes of a stranger that are shown.
const SAMPLE_BYTES: usize = 16;

/// What came in while waiting for a greeting.
#[derive(Debug, Default)]
pub(super) struct Heard {
    n_bytes: u64,
    first: Vec<u8>,
    echo: bool,
}

impl Heard {
    pub(super) fn take(&mut self, bytes: &[u8]) {
        self.n_bytes += bytes.len() as u64;
        let room = SAMPLE_BYTES - self.first.len();
        self.first.extend(bytes.iter().take(room));
    }

    /// Judges a greeting: `None` for one that is none, so that waiting goes on.
    pub(super) fn judge(&mut self, port: &str, hello: &Hello) -> Option<Result<(), LinkError>> {
        if hello.magic != MAGIC {
            return None;
        }
        if hello.name == OWN_NAME {
            self.echo = true;
            return None;
        }
        if (PROTOCOL..=NEWEST_PROTOCOL).contains(&hello.protocol) {
            return Some(Ok(()));
        }
        Some(Err(LinkError::OtherProtocol {
            port: port.to_owned(),
            name: hello.name.to_string(),
            version: version(hello),
            theirs: hello.protocol,
        }))
    }

    /// Why there is no greeting after all that time.
    pub(super) fn verdict(&self, port: &str, seconds: u64) -> LinkError {
        let port = port.to_owned();
        match (self.echo, self.n_bytes) {
            (true, _) => LinkError::Echo { port },
            (false, 0) => LinkError::Silent { port, seconds },
            (false, n_bytes) => LinkError::Stranger { port, seconds, n_bytes, sample: self.sample() },
        }
    }

    /// Text as text, anything else in hexadecimal.
    fn sample(&self) -> String {
        let readable = self.first.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace());
        if readable {
            return format!("\"{}\"", self.first.escape_ascii());
        }
        self.first.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
    }
}

/// Does a rig greet, and not our own words that come back?
pub(super) fn is_of_rig(hello: &Hello) -> bool {
    hello.magic == MAGIC && hello.name != OWN_NAME
}

/// Version of the firmware as people write it.
pub(super) fn version(hello: &Hello) -> String {
    let [major, minor, patch] = hello.version;
    format!("{major}.{minor}.{patch}")
}
