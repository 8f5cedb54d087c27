//! The program's operations as a Python module. What can be said in Python is said there (`python/pendulum_rig`): this
//! part turns arrays, files and options into what the library takes, and hands its results out as the text of `--json`.

#![forbid(unsafe_code)]

mod commands;
mod connection;
mod errors;
mod recording;
mod rig;
mod wait;

use pyo3::prelude::*;

/// What `pendulum_rig` is made from; use that.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<recording::PyRecording>()?;
    module.add_class::<rig::PyRig>()?;
    module.add_class::<rig::PyModel>()?;
    module.add_class::<rig::PyState>()?;
    module.add_class::<commands::Curves>()?;
    module.add_class::<connection::Connection>()?;
    module.add_function(wrap_pyfunction!(commands::fit, module)?)?;
    module.add_function(wrap_pyfunction!(commands::compare, module)?)?;
    module.add_function(wrap_pyfunction!(commands::diagnose, module)?)?;
    module.add_function(wrap_pyfunction!(commands::improve, module)?)?;
    module.add_function(wrap_pyfunction!(commands::plan, module)?)?;
    module.add_function(wrap_pyfunction!(commands::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(commands::effects, module)?)?;
    Ok(())
}
