//! Who speaks.

use crate::effect::Effect;
use crate::protocol::PROTOCOL;
use heapless::String;
use serde::{Deserialize, Serialize};

/// First bytes of every [`Hello`].
pub const MAGIC: [u8; 4] = *b"PNDL";

/// Who speaks; frozen. Sent by the PC to open a session and by the rig in answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// [`MAGIC`].
    pub magic: [u8; 4],
    /// [`PROTOCOL`] of the speaker.
    pub protocol: u16,
    /// [`catalogue_hash`] of the speaker: equal if both know the same effects.
    pub catalogue: u32,
    /// Version of the firmware or program: major, minor, patch.
    pub version: [u8; 3],
    /// The board, or `host`.
    pub name: String<24>,
}

impl Hello {
    /// The speaker of this build.
    pub fn new(name: &str) -> Self {
        let mut short = String::new();
        for c in name.chars() {
            if short.push(c).is_err() {
                break;
            }
        }
        Self { magic: MAGIC, protocol: PROTOCOL, catalogue: catalogue_hash(), version: version(), name: short }
    }
}

/// This package's version.
fn version() -> [u8; 3] {
    let number = |text: &str| text.parse().unwrap_or(0);
    [
        number(env!("CARGO_PKG_VERSION_MAJOR")),
        number(env!("CARGO_PKG_VERSION_MINOR")),
        number(env!("CARGO_PKG_VERSION_PATCH")),
    ]
}

/// A fingerprint (FNV-1a) of the effects this build knows: ids and numbers of parameters.
pub fn catalogue_hash() -> u32 {
    let feed = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    Effect::<f32>::ALL.iter().fold(0x811c_9dc5, |hash, effect| {
        let [low, high] = effect.id.to_le_bytes();
        [low, high, effect.parameters.len() as u8].into_iter().fold(hash, feed)
    })
}
