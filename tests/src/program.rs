//! Runs the built program `host` as a person would.

use crate::HANG;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Variable and value with which the program waits for a rig as long as a busy computer makes it wait; without it, it
/// gives up after seconds.
pub const PATIENT: (&str, &str) = ("RIG_PATIENCE", "100");

/// The program: that of the variable `HOST_PROGRAM`, or built once per test run with the profile of the tests.
pub fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        if let Some(built) = std::env::var_os("HOST_PROGRAM") {
            return built.into();
        }
        let test = std::env::current_exe().expect("a test knows its own path");
        let folder = test.ancestors().nth(2).expect("tests lie in target/PROFILE/deps");
        let profile = folder.file_name().and_then(|name| name.to_str()).unwrap_or("debug");
        let profile = if profile == "debug" { "dev" } else { profile };
        let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
        let built = Command::new(cargo).args(["build", "--quiet", "--package", "host", "--profile", profile]).status();
        assert!(built.is_ok_and(|status| status.success()), "the program does not build");
        folder.join(format!("host{}", std::env::consts::EXE_SUFFIX))
    })
}

/// What a run left.
#[derive(Debug)]
pub struct Run {
    /// Exit code; −1 if it was killed.
    pub code: i32,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

/// Runs the program in a folder with arguments separated by spaces.
pub fn host(folder: &Path, arguments: &str) -> Run {
    host_with(folder, &arguments.split_whitespace().collect::<Vec<&str>>())
}

/// What the program keeps of its rigs: beside the program, not among what the person at this computer did with theirs.
pub(crate) fn state_of(folder: &Path) -> PathBuf {
    let beside = path().parent().expect("a program lies in a folder").join("test-state");
    beside.join(folder.file_name().unwrap_or_default())
}

/// Runs the program in a folder with arguments that may contain spaces.
pub fn host_with(folder: &Path, arguments: &[&str]) -> Run {
    run(program_in(folder).args(arguments).env(PATIENT.0, PATIENT.1))
}

/// The same as [`host()`], but it gives up on a rig as soon as it does for a user.
pub fn impatient_host(folder: &Path, arguments: &str) -> Run {
    run(program_in(folder).args(arguments.split_whitespace()))
}

fn program_in(folder: &Path) -> assert_cmd::Command {
    let mut command = assert_cmd::Command::new(path());
    command.current_dir(folder).env("XDG_STATE_HOME", state_of(folder));
    command
}

fn run(command: &mut assert_cmd::Command) -> Run {
    let output = command.timeout(HANG).output().expect("the program starts");
    Run {
        code: output.status.code().unwrap_or(-1),
        stdout: String::from_utf8(output.stdout).expect("text"),
        stderr: String::from_utf8(output.stderr).expect("text"),
    }
}

impl Run {
    /// A failure as it should be: this exit code, all these words on stderr, nothing on stdout, one screen at most.
    #[track_caller]
    pub fn failed(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, code, "{self:#?}");
        for word in words {
            assert!(self.stderr.contains(word), "{word:?} is not in\n{}", self.stderr);
        }
        assert!(self.stdout.is_empty(), "{}", self.stdout);
        assert!(self.stderr.lines().count() <= 24, "{}", self.stderr);
    }

    /// A success; gives what was on stdout.
    #[track_caller]
    pub fn succeeded(&self) -> &str {
        assert_eq!(self.code, 0, "{self:#?}");
        &self.stdout
    }
}
