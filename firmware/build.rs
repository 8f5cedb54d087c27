//! Adds defmt's linker script: every board logs through defmt.
fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var_os("CARGO_FEATURE_BOARD").is_some() {
        println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    }
}
