//! The program `host`: understand the command line, do it, say how it went.

use host::cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::understand().and_then(cli::carry_out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => cli::explain(&failure),
    }
}
