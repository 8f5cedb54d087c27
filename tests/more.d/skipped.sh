# What tests/run skips where cargo-deny and Miri are missing, after installing both; ten minutes.
command -v cargo-deny > /dev/null || cargo install --locked cargo-deny
rustup toolchain install "$(sed -n 's/^MIRI_TOOLCHAIN=//p' tests/run)" --profile minimal -c miri,rust-src
tests/run advisories miri
