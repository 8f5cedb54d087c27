//! Adds defmt's linker script where a board logs through defmt.
fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var_os("CARGO_FEATURE_STM32").is_some() {
        println!("cargo::rustc-link-arg-bins=-Tdefmt.x");
    }
}
