//! The program `host`: understand the command line, do it, say how it went.

#![forbid(unsafe_code)]

use host::cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = cli::understand();
    match cli::carry_out(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => cli::explain(&failure),
    }
}
