# A day of samples at 1 kHz from the simulated rig, an hour of them through the firmware in QEMU; an hour.
env SOAK_S="${SOAK_S:-86400}" cargo test --locked -p tests --test trust_soak -- --nocapture
env SOAK_S="${QEMU_SOAK_S:-3600}" cargo test --locked -p tests --test qemu_soak -- --nocapture
