//! Every column of the bank against dual numbers, which carry the derivatives through the whole model.

use shared::bank::column::{Column, Columns, N_BASE, N_STARTS};
use shared::bank::follow::{Follower, Track};
use shared::bank::sums::Block;
use shared::dual::Dual;
use shared::effect::Effect;
use shared::model::Model;
use shared::parameters::{Parameters, base};
use shared::real::Real;

/// As on a board that looks at every fourth sample, and finer.
const STEPS_S: [f64; 2] = [4e-3, 8e-4];

/// Swings on so long, s: the pendulums with the stronger friction rest before.
const LENGTH_S: f64 = 10.0;

/// The dual numbers take so many steps for each.
const FINER: usize = 8;

const ANGLE_RAD: f64 = 0.02;
const VELOCITY_RAD_S: f64 = 9.0;

/// Starts and base columns, whatever the step.
const EXACT: f64 = 1e-6;

/// A look takes at least 40 steps a period: over 10 s the columns are then off by 1.2e-4, most of it by Runge and Kutta's
/// rule.
const LOOK_STEP_S: f64 = 24e-3;
const BY_LOOK: f64 = 2e-4;

/// Candidates, at the finer step.
const TOLERANCE: f64 = 1e-4;

/// At the coarser step the speed changes by three widths of the narrowest law within one step about a reversal.
const COARSE_TOLERANCE: f64 = 7e-3;

fn rig(viscous: f64, coulomb: f64, stiction: f64, band: f64) -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.set_friction(viscous, coulomb, stiction, band);
    parameters
}

/// A pendulum that swings on, one that soon rests, and both with a band.
fn rigs() -> [Parameters<f64>; 4] {
    [
        rig(5.4e-4, 7.1e-4, 0.0, 0.0),
        rig(5.4e-4, 1.1e-2, 1.2e-2, 0.0),
        rig(5.4e-4, 1.0e-2, 1.3e-2, 0.08),
        rig(5.4e-4, 1.0e-2, 5e-3, 0.08),
    ]
}

/// The derivatives of all readings of a model that starts like a window.
fn by_dual(parameters: &Parameters<Dual<f64, 1>>, start: [Dual<f64, 1>; 2], step_s: f64) -> Vec<f64> {
    let model = Model::new(parameters);
    let mut state = model.release(start[0], start[1]);
    let mut sensor = model.sensor_at_rest(&state);
    let mut read = |i: usize| {
        for _ in 0..if i > 0 { FINER } else { 0 } {
            model.step(&mut state, Dual::constant(step_s / FINER as f64));
        }
        model.read(&state, &mut sensor).slopes[0]
    };
    (0..=n_steps(step_s)).map(&mut read).collect()
}

/// All columns along the same swing, the candidates' behind the known ones.
fn by_bank(parameters: &Parameters<f64>, columns: &Columns<f64>, step_s: f64) -> Vec<Vec<f64>> {
    let mut track = Track::empty(0.0);
    let mut follower = Follower::new(&mut track, parameters, columns, true);
    follower.start(ANGLE_RAD, VELOCITY_RAD_S, 0.0);
    let ((n_known, n_added), mut block) = (follower.n_columns(), Block::empty(0.0));
    let mut rows = Vec::new();
    for i in 0..=n_steps(step_s) {
        if i > 0 {
            follower.advance(step_s);
        }
        follower.read(&mut block);
        rows.push((0..n_known + n_added).map(|column| block.written(column)).collect());
    }
    rows
}

fn columns_of<R: Real<Mask = bool>>(parameters: &Parameters<R>) -> Columns<R> {
    let mut columns = Columns::empty();
    columns.fill(parameters, false);
    columns
}

fn n_steps(step_s: f64) -> usize {
    (LENGTH_S / step_s).round() as usize
}

fn disagreement(rows: &[Vec<f64>], column: usize, expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    assert!(largest > 0.0);
    let apart = rows.iter().zip(expected).map(|(row, expected)| (row[column] - expected).abs());
    // No number is as far apart as can be; the larger of two would pass it over.
    apart.fold(0.0, |worst: f64, apart: f64| if apart.is_nan() { f64::INFINITY } else { worst.max(apart) }) / largest
}

fn dual_start() -> [Dual<f64, 1>; 2] {
    [ANGLE_RAD, VELOCITY_RAD_S].map(Dual::constant)
}

fn base_columns_agree(case: usize, parameters: &Parameters<f64>, step_s: f64, tolerance: f64) {
    let columns = columns_of(parameters);
    let rows = by_bank(parameters, &columns, step_s);
    let constant = parameters.map(Dual::<f64, 1>::constant);
    let variable = |value: f64| Dual::variable(value, 0);
    let by = |dual: &Parameters<Dual<f64, 1>>| by_dual(dual, dual_start(), step_s);
    let with = |id: u16, index: usize| {
        let mut dual = constant.clone();
        let effect = dual.effects.iter_mut().find(|effect| effect.id == id).unwrap();
        effect.values[index] = variable(effect.values[index].value);
        by(&dual)
    };
    let from = |i: usize| {
        let mut start = dual_start();
        start[i] = variable(start[i].value);
        by_dual(&constant, start, step_s)
    };
    let mut heavier = constant.clone();
    heavier.pendulum.inertia_kg_m2 = variable(heavier.pendulum.inertia_kg_m2.value);
    let mut expected = vec![from(0), from(1), with(base::VISCOUS, 0), with(base::COULOMB, 0), by(&heavier)];
    let mut places = vec![0, 1, 3, 4, 5];
    if parameters.values(base::STICTION).unwrap()[1] > 0.0 {
        expected.push(with(base::STICTION, 1));
        places.push(rows[0].len() - 1);
    }
    for (column, expected) in places.into_iter().zip(expected) {
        let apart = disagreement(&rows, column, &expected);
        assert!(apart < tolerance, "rig {case}, column {column}, {step_s} s: {apart:e}");
    }
}

#[test]
fn starts_friction_inertia_and_band_are_the_derivatives_until_rest() {
    for (case, parameters) in rigs().iter().enumerate() {
        STEPS_S.iter().for_each(|step_s| base_columns_agree(case, parameters, *step_s, EXACT));
    }
    base_columns_agree(0, &rigs()[0], LOOK_STEP_S, BY_LOOK);
}

/// How far the columns of all candidates are from the derivatives of a model with the effect at no strength.
fn candidates_apart(case: usize, parameters: &Parameters<f64>, step_s: f64) -> Vec<(f64, String)> {
    let columns = columns_of(parameters);
    let rows = by_bank(parameters, &columns, step_s);
    let mut apart = Vec::new();
    for candidate in columns.candidates.iter().filter(|candidate| !candidate.effect.is_base()) {
        for (place, index) in candidate.strengths.iter().enumerate() {
            let column = usize::from(candidate.first) + place;
            if matches!(columns.added[column], Column::Law { units, .. } if units != 1.0) {
                continue;
            }
            let mut dual = parameters.map(Dual::<f64, 1>::constant);
            let mut values = candidate.start().map(Dual::constant);
            values[usize::from(*index)] = Dual::variable(0.0, 0);
            dual.set(candidate.effect.id, &values[..candidate.effect.parameters.len()]).unwrap();
            let expected = by_dual(&dual, dual_start(), step_s);
            let name = format!("rig {case}, {} {:?}, number {index}", candidate.effect.name, candidate.start());
            apart.push((disagreement(&rows, N_STARTS + N_BASE + column, &expected), name));
        }
    }
    apart
}

#[test]
fn every_candidate_is_the_derivative_by_its_strength_until_rest() {
    for (step_s, tolerance) in STEPS_S.into_iter().zip([COARSE_TOLERANCE, TOLERANCE]) {
        let rigs = rigs();
        let all = rigs.iter().enumerate().flat_map(|(case, rig)| candidates_apart(case, rig, step_s));
        let all: Vec<(f64, String)> = all.collect();
        let worst = all.iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        println!("{step_s} s: {worst:?} of {}", all.len());
        assert!(all.len() > 3 * Effect::<f64>::ALL.len());
        assert!(worst.0 < tolerance, "{step_s} s: {worst:?}");
    }
}

/// What has no room would never be suspected.
#[test]
fn there_is_room_for_every_start_of_every_effect() {
    let columns = columns_of(&Parameters::paper().map(|value| value as f32));
    println!("{} columns of {} candidates", columns.added.len(), columns.candidates.len());
    assert!(!columns.added.is_full() && !columns.candidates.is_full());
}
