//! What every board logs when it starts.

use shared::wire::Health;

/// How often it restarted, and where the last panic or fault was.
pub fn start(health: &Health) {
    defmt::info!("{} restarts since power-up", health.resets);
    if !health.last_fault.is_empty() {
        defmt::warn!("last fault: {}", health.last_fault.as_str());
    }
}
