# Ten thousand recordings that are killed and ten thousand links that fail; an hour.
env TRUST_RUNS="${TRUST_RUNS:-10000}" cargo test --locked -p tests --test trust_link --test trust_files -- --nocapture
