# Many rigs with one and two hidden effects each: how often the right ones are named; half an hour.
cargo test --locked -p tests --test discover_many -- --include-ignored --nocapture
