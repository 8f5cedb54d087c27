//! What an identification costs: `cargo bench -p host --bench fit`. The fit keeps all processors busy; look at the
//! fastest column, on a busy machine the median tells of the neighbours.
//!
//! The program as a process, with its peak memory: `cargo build --release -p host`, `target/release/host init --mass
//! 0.1466084 --length 0.1562177 --inertia 0.00284252 -o rig.toml`, then `/usr/bin/time -v target/release/host fit
//! --rig rig.toml host/data/paper/reconstructed_recording_noisy.csv`: look at "Elapsed" and "Maximum resident".

use divan::Bencher;
use host::fit::identify::{Method, Options, fit};
use host::recording::segment::SegmentOptions;
use host::recording::{ReadOptions, read};
use host::swing::Swing;
use shared::parameters::Parameters;
use std::path::Path;

fn main() {
    divan::main();
}

/// The paper's swing of 46 s with noise, from the inertia of the drawing and no friction.
#[divan::bench(args = ["rsm", "least-squares", "both"], sample_count = 10)]
fn the_papers_swing(bencher: Bencher, method: &str) {
    let method = match method {
        "rsm" => Method::Rsm,
        "least-squares" => Method::LeastSquares,
        _ => Method::Both,
    };
    let swings = [swing()];
    let mut rig = Parameters::paper();
    rig.set_friction(0.0, 0.0, 0.0, 0.0);
    rig.pendulum.inertia_kg_m2 = 0.002_842_52;
    let options = Options { method, ranges: Vec::new() };
    bencher.bench_local(|| fit(&swings, &[], &rig, &options, &|_| {}).expect("the swing is good"));
}

/// From the file to the free swing, segments and noise included.
#[divan::bench]
fn reading_the_recording() -> Swing {
    swing()
}

fn swing() -> Swing {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/paper/reconstructed_recording_noisy.csv");
    let recording = read(&path, &ReadOptions::default()).expect("a file of the project");
    Swing::from_recording("noisy", &recording, &SegmentOptions::default()).expect("it has a swing").0
}
