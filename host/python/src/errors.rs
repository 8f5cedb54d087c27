//! The program's failures as Python's exceptions.

use host::error::Failure;
use pyo3::prelude::*;

mod classes {
    pyo3::import_exception!(pendulum_rig.errors, Failed);
    pyo3::import_exception!(pendulum_rig.errors, WrongUse);
}

/// What happened and what to do next, in the program's words.
pub(crate) fn raised(failure: &Failure) -> PyErr {
    let words = (failure.what().to_owned(), failure.next_step().map(str::to_owned));
    match failure.exit_code() {
        2 => classes::WrongUse::new_err(words),
        _ => classes::Failed::new_err(words),
    }
}
