//! Opening the rig for a command.

use super::output;
use crate::error::Failure;
use crate::link::{self, Session};

/// Greets the rig and says who it is.
pub(super) fn connect(port: &str) -> Result<Session, Failure> {
    let session = link::connect(port)?;
    output::say(&format!("connected to {} on {port}", session.firmware()));
    if !session.knows_the_same_effects() {
        output::warn("the rig's firmware knows other effects than this program; update the older of the two");
    }
    Ok(session)
}
