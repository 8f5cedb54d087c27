# The firmware in QEMU behind twenty bad links; a quarter of an hour.
env QEMU_RUNS="${QEMU_RUNS:-20}" cargo test --locked -p tests --test qemu_link -- --nocapture
