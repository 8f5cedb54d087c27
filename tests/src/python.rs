//! A Python with packages from PyPI, for tests that need a tool or an independent calculation which Debian has not.

use crate::image::workspace;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// The interpreter, with these packages installed, each as `NAME==VERSION`; see `tests/python`.
#[track_caller]
pub fn python(packages: &[&str]) -> PathBuf {
    let output = Command::new(workspace().join("tests/python")).args(packages).stderr(Stdio::inherit()).output();
    let output = output.expect("tests/python runs");
    assert!(output.status.success(), "tests/python could not install {packages:?}");
    PathBuf::from(String::from_utf8(output.stdout).expect("a path").trim_end())
}
