# Ten million random inputs for each parser; an hour.
env BOLERO_RANDOM_ITERATIONS="${BOLERO_RANDOM_ITERATIONS:-10000000}" \
    cargo test --locked -p tests --test trust_parsers -- --nocapture
