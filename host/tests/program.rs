//! The built program starts. This test is also why `cargo test` builds it, for the tests that run it as a process.

use std::process::Command;

#[test]
fn it_tells_its_version() {
    let output = Command::new(env!("CARGO_BIN_EXE_host")).arg("--version").output().unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), format!("host {}\n", env!("CARGO_PKG_VERSION")));
}
