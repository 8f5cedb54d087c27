# Many rigs with one and two hidden effects each: how often the right ones are named; half an hour.
env ROUNDS="${ROUNDS:-8}" cargo test --locked -p tests --test discover_many -- --include-ignored --nocapture
