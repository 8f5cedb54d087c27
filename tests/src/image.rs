//! Images for the microcontroller, built when a test asks for them.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The processor of every board.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The profile in the workspace that is made for small flash.
pub const PROFILE: &str = "firmware";

/// A board of the firmware, by its feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Board {
    /// Adafruit Feather STM32F405.
    FeatherF405,
    /// ST Nucleo-F446RE.
    NucleoF446,
    /// QEMU's netduinoplus2.
    Qemu,
}

impl Board {
    /// The feature that chooses it.
    pub fn feature(self) -> &'static str {
        match self {
            Self::FeatherF405 => "board-feather-f405",
            Self::NucleoF446 => "board-nucleo-f446",
            Self::Qemu => "board-qemu",
        }
    }
}

/// The workspace.
pub fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("this package lies in the workspace")
}

/// Builds the firmware for a board, optimised for size, and gives the image.
pub fn firmware(board: Board) -> Result<PathBuf, String> {
    build(&["-p", "firmware", "--no-default-features", "--features", board.feature()], board.feature(), "firmware")
}

/// Builds a program of the on-target tests, optimised for size, and gives the image.
pub fn target_program(name: &str) -> Result<PathBuf, String> {
    build(&["-p", "target-tests", "--features", "target", "--bin", name], name, name)
}

/// Images that differ only in their features overwrite each other, so each is kept under its own name, and only one
/// test builds at a time.
fn build(arguments: &[&str], keep_as: &str, program: &str) -> Result<PathBuf, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
    let target_dir = workspace().join("target");
    let _alone = alone(&target_dir).map_err(|error| format!("could not lock {}: {error}", target_dir.display()))?;
    let output = Command::new(cargo)
        .current_dir(workspace())
        .args(["build", "--profile", PROFILE, "--target", TARGET, "--target-dir"])
        .arg(&target_dir)
        .args(arguments)
        .output()
        .map_err(|error| format!("could not start cargo: {error}"))?;
    if !output.status.success() {
        let reason = String::from_utf8_lossy(&output.stderr);
        return Err(format!("could not build {keep_as} for {TARGET} (rustup target add {TARGET}?):\n{reason}"));
    }
    let built = target_dir.join(TARGET).join(PROFILE).join(program);
    let kept = target_dir.join(TARGET).join(format!("{keep_as}.elf"));
    // Moved into its place whole: another test may be reading the one that is there.
    let fresh = kept.with_extension("fresh");
    let moved = std::fs::copy(&built, &fresh).and_then(|_| std::fs::rename(&fresh, &kept));
    moved.map_err(|error| format!("could not copy {}: {error}", built.display()))?;
    Ok(kept)
}

/// Locked until it is dropped.
fn alone(target_dir: &Path) -> std::io::Result<std::fs::File> {
    std::fs::create_dir_all(target_dir)?;
    let lock = std::fs::File::create(target_dir.join("images.lock"))?;
    lock.lock()?;
    Ok(lock)
}
