# Many rigs with one and two hidden effects each, and with laws of other shapes: how often the right ones are named; 30 min.
env ROUNDS="${ROUNDS:-8}" cargo test --locked -p tests --test discover_many -- --include-ignored --nocapture
env ROUNDS="${ROUNDS:-8}" cargo test --locked -p tests --test discover_shapes -- --include-ignored --nocapture
