# Real pendulums: what is said of every recording that comes with the project; writes docs/real.md; some minutes.
cargo test --locked -p tests --test real_pendulums -- --include-ignored --nocapture
