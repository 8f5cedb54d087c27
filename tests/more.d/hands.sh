# A hand on the pendulum while it is recorded, a hundred times: never named as an effect; some minutes.
cargo test --locked -p tests --test discover_hand -- --include-ignored --nocapture
