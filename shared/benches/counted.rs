//! Steps to be counted, not timed: `counted CASE N` takes N of them, and an instruction counter around the process says
//! what they cost (`tests/more speed`). CASE is `base` or an effect's name.

use shared::effect::Effect;
use shared::model::Model;
use shared::parameters::Parameters;
use std::hint::black_box;

/// As long as those of a fit.
const DT_S: f64 = 1e-2;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, n_steps] = arguments.as_slice() else { return };
    let n_steps: usize = n_steps.parse().expect("a number of steps");
    let model = Model::new(&parameters(case));
    let mut state = model.release(black_box(1.509), 0.0);
    for _ in 0..n_steps {
        model.step(&mut state, DT_S);
    }
    black_box(state.angle_rad);
}

/// The paper's pendulum with one more effect, at its usual size.
fn parameters(case: &str) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    if case != "base" {
        let effect = Effect::<f64>::by_name(case).expect("an effect of the list");
        let usual = |p: &shared::effect::Parameter| if p.start == 0.0 { 1e-3 * p.high } else { p.start };
        let values: Vec<f64> = effect.parameters.iter().map(usual).collect();
        parameters.set(effect.id, &values).expect("one effect fits");
    }
    parameters
}
