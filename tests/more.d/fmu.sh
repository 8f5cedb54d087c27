# The exported FMU: validated and simulated by fmpy, its sources held against the standard's headers; two minutes.
cargo test --locked --test export_fmu -- --include-ignored
