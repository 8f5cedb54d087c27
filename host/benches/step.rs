//! What a simulation costs: `cargo bench -p host --bench step`. Look at the fastest column: on a busy machine the
//! median tells of the neighbours.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use shared::model::Model;
use shared::parameters::Parameters;

fn main() {
    divan::main();
}

const DT_S: f64 = 1e-3;
const N_STEPS: usize = 10_000;

/// One swing of ten seconds; an item is a step.
#[divan::bench]
fn one_step_f64(bencher: Bencher) {
    let model = Model::new(&Parameters::paper());
    bencher.counter(ItemsCount::new(N_STEPS)).bench_local(|| {
        let mut state = model.release(black_box(1.509), 0.0);
        for _ in 0..N_STEPS {
            model.step(&mut state, DT_S);
        }
        state.angle_rad
    });
}
