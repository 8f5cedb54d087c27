# the boards' images in the emulator: 2,000 saves, 100 USB faults of each kind, 100,000 strange requests; an hour
export SAVES=2000 RECYCLES=10 POWER_CUTS=100 USB_FAULTS=100 USB_REQUESTS=100000 LINK_BYTES=100000 STREAM_S=7200
cargo test --locked -p tests --test board_store --test board_usb --test board_start -- --nocapture
cargo test --locked -p tests --test board_stream -- --nocapture --include-ignored
# The board itself names what its model lacks, told by `host watch`: 74 s.
cargo test --locked -p tests --test board_watch -- --nocapture --ignored
