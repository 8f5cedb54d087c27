//! What a simulation costs: `cargo bench -p host --bench step`. Look at the fastest column: on a busy machine the
//! median tells of the neighbours.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use host::lanes::{Lanes, pack};
use rayon::prelude::*;
use shared::effect::{Effect, Parameter};
use shared::model::Model;
use shared::parameters::Parameters;
use shared::real::Real;

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

/// The same swing with slightly different parameters in each lane; an item is a step of one lane.
#[divan::bench(consts = [2, 4, 8])]
fn one_step_in_lanes<const N: usize>(bencher: Bencher) {
    let model = Model::new(&pack(&neighbours::<N>().each_ref()).expect("the same effects in each lane"));
    bencher.counter(ItemsCount::new(N * N_STEPS)).bench_local(|| {
        let mut state = model.release(black_box(Lanes::of(1.509)), Lanes::of(0.0));
        for _ in 0..N_STEPS {
            model.step(&mut state, Lanes::of(DT_S));
        }
        state.angle_rad
    });
}

fn neighbours<const N: usize>() -> [Parameters<f64>; N] {
    std::array::from_fn(|lane| {
        let mut parameters = Parameters::paper();
        parameters.pendulum.inertia_kg_m2 *= 1.0 + 1e-6 * lane as f64;
        parameters
    })
}

/// What each effect adds, alone and in lanes; an item is a step of one lane.
#[divan::bench(args = EFFECTS)]
fn one_step_with(bencher: Bencher, name: &str) {
    let parameters = with_effect(name, 0);
    let model = Model::new(&parameters);
    bencher.counter(ItemsCount::new(N_STEPS)).bench_local(|| swing(&model));
}

/// The same with four lanes.
#[divan::bench(args = EFFECTS)]
fn one_step_in_lanes_with(bencher: Bencher, name: &str) {
    let sets: [_; 4] = std::array::from_fn(|lane| with_effect(name, lane));
    let model = Model::new(&pack(&sets.each_ref()).expect("the same effects in each lane"));
    bencher.counter(ItemsCount::new(4 * N_STEPS)).bench_local(|| swing(&model));
}

/// Representatives of each kind: a product, a bearing load, an exponential, a power, two sines, a memory.
const EFFECTS: [&str; 6] =
    ["quadratic-drag", "load-dependent-coulomb", "stribeck", "power-law-drag", "detent", "presliding"];

fn with_effect(name: &str, lane: usize) -> Parameters<f64> {
    let effect = Effect::<f64>::by_name(name).expect("a name from the list");
    let mut parameters = neighbours::<4>()[lane].clone();
    let usual = |p: &Parameter| if p.start == 0.0 { 1e-3 * p.high } else { p.start };
    let values: Vec<f64> = effect.parameters.iter().map(usual).collect();
    parameters.set(effect.id, &values).expect("one effect fits");
    parameters
}

fn swing<R: Real>(model: &Model<R>) -> R {
    let mut state = model.release(R::of(1.509), R::zero());
    for _ in 0..N_STEPS {
        model.step(&mut state, R::of(DT_S));
    }
    state.angle_rad
}

/// One of the paper's designs: 27 runs of 46.2 s on all processors.
#[divan::bench]
fn a_design_of_27_runs(bencher: Bencher) {
    bencher.bench_local(|| (0..27).into_par_iter().map(|run| one_run(&design_run(run))).sum::<f64>());
}

/// The same with four runs side by side.
#[divan::bench]
fn a_design_of_27_runs_in_lanes(bencher: Bencher) {
    let four_runs = |group: i32| {
        let sets: [_; 4] = std::array::from_fn(|lane| design_run((4 * group + lane as i32).min(26)));
        one_run(&pack(&sets.each_ref()).expect("the same effects in each lane")).0[0]
    };
    bencher.bench_local(|| (0..7).into_par_iter().map(four_runs).sum::<f64>());
}

/// Parameters spread like the third design's.
fn design_run(run: i32) -> Parameters<f64> {
    let level = |digit: i32| f64::from(run / digit % 3 - 1);
    let mut parameters = Parameters::paper();
    parameters.pendulum.inertia_kg_m2 = 2.7e-3 + 2e-5 * level(9);
    parameters.set_friction(5.4e-4 + 2e-5 * level(1), 7e-4 + 2e-5 * level(3), 1e-3, 0.05);
    parameters
}

fn one_run<R: Real>(parameters: &Parameters<R>) -> R {
    let model = Model::new(parameters);
    let mut state = model.release(R::of(1.509), R::zero());
    let mut sum = R::zero();
    for _ in 0..46_200 {
        model.step(&mut state, R::of(DT_S));
        sum = sum + state.angle_rad * state.angle_rad;
    }
    sum
}
