//! What every board logs when it starts.

use super::identity::IDENTITY;
use shared::wire::Health;

/// Which firmware it is, how often it restarted, and where the last panic or fault was.
pub fn start(health: &Health) {
    // It stays in the image even if nothing is logged.
    defmt::info!("{=str}", core::hint::black_box(IDENTITY));
    defmt::info!("{} restarts since power-up", health.resets);
    if !health.last_fault.is_empty() {
        defmt::warn!("last fault: {}", health.last_fault.as_str());
    }
}
