//! The parts of a diagnosis on simulated swings with a drag that the rig does not have, and on models whose costs are
//! set by hand.

use super::budget::Budget;
use super::conclusion::not_claimed;
use super::extension::extensions;
use super::holds::{Holding, Standing};
use super::models::excess;
use super::replacement::Replacements;
use super::rests::Rests;
use super::search::{Found, search};
use super::summary::{Diagnosis, Summary};
use super::verdict::{INDISTINGUISHABLE, Judge};
use super::widening::{begun_from_special_cases, exchanged, narrowed, widened};
use super::{base_problem, candidates, diagnose, levels, zero};
use crate::fit::descent::Tolerance;
use crate::fit::fitted::{Fitted, Stiction};
use crate::fit::identify::problem_of;
use crate::fit::prediction::{Prediction, predictions};
use crate::fit::problem::{Point, Problem, Start};
use crate::fit::refine::Band;
use crate::fit::tally::Tally;
use crate::fit::tolerance::Tolerances;
use crate::improve::{Bench, Change, ChangeError};
use crate::random::Noise;
use crate::recording::Measured;
use crate::swing::{Swing, Window};
use crate::verdict::Left;
use shared::effect::{Effect, MAX_VALUES};
use shared::model::Model;
use shared::parameters::{Parameters, base};
use std::time::Instant;

pub(crate) const NOISE_RAD: f64 = 5e-4;

const RELEASE_RAD: f64 = 1.4;

/// Quadratic drag, N·m·s²/rad².
const DRAG: f64 = 2e-4;

pub(crate) fn effect(name: &str) -> &'static Effect<f64> {
    Effect::by_name(name).unwrap()
}

/// The paper's rig without stiction, with one more effect.
fn rig_with(name: &str, values: &[f64]) -> Parameters<f64> {
    let mut rig = rig();
    rig.set(effect(name).id, values).unwrap();
    rig
}

pub(crate) fn rig() -> Parameters<f64> {
    let mut rig = Parameters::paper();
    Stiction::NONE.put_into(&mut rig);
    rig
}

/// A simulated swing of a rig at 100 Hz, with white noise.
pub(crate) fn simulated(name: &str, truth: &Parameters<f64>, seconds: f64, seed: u64) -> Swing {
    let (model, mut noise) = (Model::new(truth), Noise::new(seed));
    let mut state = model.release(RELEASE_RAD, 0.0);
    let times_s: Vec<f64> = (0..(100.0 * seconds) as usize).map(|i| i as f64 / 100.0).collect();
    let mut angles_rad = Vec::new();
    for _ in &times_s {
        angles_rad.push(state.angle_rad + NOISE_RAD * noise.normal());
        (0..5).for_each(|_| model.step(&mut state, 2e-3));
    }
    Swing::new(name, &times_s, &angles_rad, NOISE_RAD)
}

pub(crate) fn with_drag() -> [Swing; 1] {
    [simulated("drag", &rig_with("quadratic-drag", &[DRAG]), 14.0, 1)]
}

/// A model fitted to the swings of a problem, from the numbers of a rig.
pub(crate) fn fitted(on: &Problem, from: &Parameters<f64>) -> Fitted {
    begun(on, from).refined(on, Band::Held, Tolerance::JUDGE)
}

fn begun(on: &Problem, from: &Parameters<f64>) -> Fitted {
    let of_rig = problem_of(on.swings, from, on.tally);
    let start = Start { angle_rad: RELEASE_RAD, velocity_rad_s: 0.0, offset_rad: 0.0 };
    Fitted::at(&of_rig, &Point { values: of_rig.template_values(), starts: vec![start; on.swings.len()] })
        .with_stiction(Stiction::NONE)
}

#[test]
fn what_needs_the_geometry_is_not_tried_without_it_and_that_is_said() {
    let swings = with_drag();
    let not_tried =
        |is_known: bool| candidates(&swings, is_known).1.into_iter().map(|it| it.effect).collect::<Vec<_>>();
    assert!(
        not_tried(false).contains(&"load-dependent-coulomb") && !not_tried(true).contains(&"load-dependent-coulomb")
    );
    assert_eq!(not_tried(false).len(), not_tried(true).len() + 1);
}

/// The sine of a rate is none of an angle, and play has a width in rad.
#[test]
fn errors_of_a_scale_of_angles_are_not_tried_of_a_sensor_of_rates() {
    let names = |measured: Measured| {
        let swings = [Swing::of("one", measured, &[0.0, 0.1, 0.2, 0.3], &[0.3, 0.1, -0.1, -0.2], 1e-4)];
        let (tried, not_tried) = candidates(&swings, true);
        let of_angles = |name: &&str| ["backlash", "eccentric-sensor", "misaligned-sensor"].contains(name);
        let tried: Vec<&str> = tried.into_iter().map(|effect| effect.name).filter(of_angles).collect();
        (tried, not_tried.into_iter().map(|not| not.effect).filter(of_angles).collect::<Vec<_>>())
    };
    let all = vec!["backlash", "eccentric-sensor", "misaligned-sensor"];
    assert_eq!(names(Measured::Angle), (all.clone(), Vec::new()));
    assert_eq!(names(Measured::Rate), (Vec::new(), all));
}

/// Everything that a judge needs, and asks him.
fn judged<T>(
    swings: &[Swing],
    levels: impl Fn(&Problem) -> (Fitted, Vec<Vec<Fitted>>),
    ask: impl Fn(&Judge) -> T,
) -> T {
    let count = Tally::default();
    let problem = base_problem(swings, (&rig()).into(), &count);
    let decimated = problem.decimated();
    let rough = problem.on(&decimated);
    let budget = Budget::new(&count);
    let (base, levels) = levels(&problem);
    let found = Found { base, levels };
    let candidates = [effect("quadratic-drag"), effect("power-law-drag"), effect("torsional-spring")];
    ask(&Judge {
        problem: &problem,
        rough: &rough,
        found: &found,
        candidates: &candidates,
        budget: &budget,
        rests: Rests::default(),
    })
}

/// A model with this reduced chi-square, as if it had been fitted.
fn with_excess(on: &Problem, from: &Parameters<f64>, reduced: f64) -> Fitted {
    let mut model = Fitted { cost: on.noise_rad().powi(2) * on.n_samples(Window::Whole) as f64, ..begun(on, from) };
    model.cost *= reduced / on.chi_square(model.cost).reduced;
    assert!((excess(on, &model) - (reduced - 1.0)).abs() < 1e-9);
    model
}

fn drag(on: &Problem, reduced: f64) -> Fitted {
    with_excess(on, &rig_with("quadratic-drag", &[DRAG]), reduced)
}

fn power_law(on: &Problem, reduced: f64) -> Fitted {
    with_excess(on, &rig_with("power-law-drag", &[DRAG, 2.0]), reduced)
}

#[test]
fn an_effect_is_worth_its_numbers_if_it_leaves_little_of_what_was_there() {
    let swings = with_drag();
    let is_worth_it = |before: f64, after: f64| {
        let levels = |on: &Problem| (with_excess(on, &rig(), before), vec![vec![drag(on, after)]]);
        judged(&swings, levels, |judge| judge.is_worth_it(&judge.found.base, &judge.found.levels[0][0]))
    };
    // Of an excess of 10 it leaves 3 or 5 where more than noise is left, 5.5 of it where not: at most 0.4 and 0.6.
    assert!(is_worth_it(11.0, 4.0) && !is_worth_it(11.0, 6.0));
    assert!(is_worth_it(1.35, 1.17) && !is_worth_it(1.25, 1.17));
    // Where noise alone is left, nothing is missing.
    assert!(!is_worth_it(1.0, 0.9));
}

#[test]
fn the_unit_of_a_criterion_is_the_noise_or_what_the_best_model_leaves() {
    let swings = with_drag();
    let unit = |lowest: f64| {
        let levels = |on: &Problem| (with_excess(on, &rig(), 20.0), vec![vec![drag(on, lowest)]]);
        judged(&swings, levels, |judge| judge.unit() / NOISE_RAD.powi(2))
    };
    assert!((unit(0.5) - 1.0).abs() < 1e-12);
    assert!((unit(4.0) - 4.0).abs() < 0.05, "{}", unit(4.0));
}

#[test]
fn a_special_case_is_preferred_where_no_sum_of_squares_speaks_for_its_wider_form() {
    let swings = with_drag();
    let preferred = |more: f64| {
        let levels = |on: &Problem| {
            let wide = power_law(on, 1.0);
            let unit = NOISE_RAD.powi(2);
            let special = Fitted { cost: wide.cost + more * unit, ..drag(on, 1.0) };
            (with_excess(on, &rig(), 20.0), vec![vec![wide, special]])
        };
        judged(&swings, levels, |judge| judge.preferred(&judge.found.levels[0]).name())
    };
    // One more number costs ln 1400 = 7.2; beyond that, and up to 25, the special case is taken all the same.
    assert_eq!([preferred(3.0), preferred(0.8 * INDISTINGUISHABLE)], ["quadratic-drag", "quadratic-drag"]);
    assert_eq!(preferred(1.2 * INDISTINGUISHABLE), "power-law-drag");
}

#[test]
fn a_single_claim_that_does_not_hold_leaves_the_base_model() {
    let swings = with_drag();
    let levels = |on: &Problem| (with_excess(on, &rig(), 20.0), vec![vec![drag(on, 1.0)]]);
    let left = judged(&swings, levels, |judge| {
        let claimed = &judge.found.levels[0][0];
        let base = judge.without_doubtful(claimed, "quadratic-drag");
        assert_eq!(base.cost, judge.found.base.cost);
        (base.name(), judge.without_doubtful(claimed, "stribeck").name())
    });
    assert_eq!(left, ("none".to_owned(), "quadratic-drag".to_owned()));
}

#[test]
fn a_wider_claim_that_does_not_hold_leaves_its_usual_form_if_that_is_worth_it() {
    let swings = with_drag();
    let left = |before: Option<f64>| {
        let levels = |on: &Problem| {
            let base = before.map_or_else(|| fitted(on, &rig()), |before| with_excess(on, &rig(), before));
            (base, vec![vec![fitted(on, &rig_with("power-law-drag", &[DRAG, 2.0]))]])
        };
        judged(&swings, levels, |judge| judge.without_doubtful(&judge.found.levels[0][0], "power-law-drag").name())
    };
    assert_eq!(left(None), "quadratic-drag");
    // Where noise alone is left without it, it is worth nothing.
    assert_eq!(left(Some(1.0)), "none");
}

#[test]
fn a_drag_that_was_fitted_is_told_from_its_wider_form_by_the_exponent() {
    let swings = with_drag();
    let levels = |on: &Problem| {
        let special = fitted(on, &rig_with("quadratic-drag", &[DRAG]));
        let wide = fitted(on, &rig_with("power-law-drag", &[DRAG, 2.0]));
        (fitted(on, &rig()), vec![vec![wide, special]])
    };
    judged(&swings, levels, |judge| {
        let [wide, special] = &judge.found.levels[0][..] else { panic!("two models") };
        // Fitted to what it is, the drag leaves noise.
        assert!(excess(judge.problem, special).abs() < 0.15, "{}", excess(judge.problem, special));
        let mut undecided = vec!["power-law-drag"];
        let cases = judge.special_cases(special, &[], &mut undecided);
        assert!(undecided.is_empty() && cases.len() == 1, "{cases:?}");
        assert!((cases[0].value - 2.0).abs() < 3.0 * cases[0].std && cases[0].special == "quadratic-drag", "{cases:?}");
        // With as much removed by fewer numbers, the simpler law is claimed.
        let (simpler, holds) = judge.simpler(wide, &[]).unwrap();
        assert_eq!(simpler.name(), "quadratic-drag");
        assert!(holds.iter().all(|holding: &Holding| holding.standing == Standing::Holds), "{holds:?}");
        assert!(judge.simpler(special, &[]).is_none());
    });
}

/// What is told of a claim, which may have the zero beside it.
fn told(judge: &Judge, claimed: &Fitted, offset_is_missing: bool, held_out: &[Swing]) -> Diagnosis {
    let Judge { problem, rough, found, candidates, budget, .. } = *judge;
    let summary = Summary {
        judge: Judge { problem, rough, found, candidates, budget, rests: Rests::default() },
        base: found.base.clone(),
        first_look: None,
        claimed: claimed.clone(),
        curve: None,
        of_state: None,
        undecided: Vec::new(),
        not_tried: Vec::new(),
        vetoed: Vec::new(),
        unproven: Vec::new(),
        holds_on: Vec::new(),
        carries: None,
        special_cases: Vec::new(),
        offset_is_missing,
        others: Vec::new(),
        held_out,
        began: Instant::now(),
        count: problem.tally,
    };
    summary.build(false)
}

#[test]
fn held_out_swings_are_predicted_before_and_after_and_the_zero_stands_behind_a_law() {
    let (swings, held_out) = (with_drag(), [simulated("other", &rig_with("quadratic-drag", &[DRAG]), 8.0, 2)]);
    let levels = |on: &Problem| (fitted(on, &rig()), vec![vec![fitted(on, &rig_with("quadratic-drag", &[DRAG]))]]);
    judged(&swings, levels, |judge| {
        let law = told(judge, &judge.found.levels[0][0], true, &held_out);
        let offset = zero::offset().unwrap().name;
        assert_eq!(
            (&law.verdict[..], &law.ranked[..2]),
            (&["quadratic-drag", offset][..], &["quadratic-drag", offset][..])
        );
        let [before, after] = [law.held_out_before, law.held_out_after].map(Option::unwrap);
        assert!(before > 3.0 * NOISE_RAD && (after / NOISE_RAD - 1.0).abs() < 0.1, "{before} {after}");
        let none = told(judge, &judge.found.base, false, &[]);
        assert_eq!((none.held_out_before, none.held_out_after), (None, None));
        // The zero is right, so that a fit of it changes nothing.
        assert!(none.verdict.is_empty() && !none.zero_is_doubtful, "{} {}", none.rmse_before, none.rmse_after);
    });
}

#[test]
fn an_exponent_of_another_law_makes_no_special_case() {
    let swings = [simulated("steep", &rig_with("power-law-drag", &[4.0 * DRAG, 1.5]), 14.0, 1)];
    let levels = |on: &Problem| {
        let special = fitted(on, &rig_with("quadratic-drag", &[DRAG]));
        let wide = fitted(on, &rig_with("power-law-drag", &[4.0 * DRAG, 1.5]));
        (fitted(on, &rig()), vec![vec![wide, special]])
    };
    judged(&swings, levels, |judge| {
        let mut undecided = vec!["power-law-drag"];
        let cases = judge.special_cases(&judge.found.levels[0][1], &[], &mut undecided);
        assert!(cases.is_empty() && undecided == ["power-law-drag"], "{cases:?}");
    });
}

#[test]
fn a_staircase_goes_down_from_the_base_to_the_claim_by_the_rms_of_each_model() {
    let swings = with_drag();
    let levels = |on: &Problem| (fitted(on, &rig()), vec![vec![fitted(on, &rig_with("quadratic-drag", &[DRAG]))]]);
    judged(&swings, levels, |judge| {
        let rms = |model: &Fitted| (model.cost / judge.problem.n_samples(Window::Whole) as f64).sqrt();
        let found = judge.found;
        let told = told(judge, &found.levels[0][0], false, &[]);
        assert!((told.rmse_after / NOISE_RAD - 1.0).abs() < 0.1, "{}", told.rmse_after);
        assert!(told.rmse_before > 5.0 * NOISE_RAD, "{}", told.rmse_before);
        let steps: Vec<(&str, f64)> = told.staircase.iter().map(|step| (step.added, step.rmse)).collect();
        assert_eq!(steps, [("base", told.rmse_before), ("quadratic-drag", rms(&found.levels[0][0]))]);
    });
}

#[test]
fn a_zero_that_a_fit_of_the_base_takes_off_is_a_step_of_its_own() {
    let mut swings = with_drag();
    swings[0].angles_rad.iter_mut().for_each(|angle| *angle += 0.2);
    let levels = |on: &Problem| (fitted(on, &rig()), vec![vec![fitted(on, &rig_with("quadratic-drag", &[DRAG]))]]);
    judged(&swings, levels, |judge| {
        let told = told(judge, &judge.found.levels[0][0], true, &[]);
        let steps: Vec<&str> = told.staircase.iter().map(|step| step.added).collect();
        assert_eq!(steps, ["base", "angle-offset", "quadratic-drag"]);
        let [before, zero, after] = [0, 1, 2].map(|k| told.staircase[k].rmse);
        assert!(before > 0.15 && zero < 0.1 && after < 1.1 * NOISE_RAD, "{before} {zero} {after}");
    });
}

#[test]
fn what_is_missing_promises_most_and_is_fitted_in_its_place() {
    let (swings, count) = (with_drag(), Tally::default());
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let base = fitted(&problem, &rig());
    let names = ["quadratic-drag", "power-law-drag", "eddy-brake", "load-dependent-coulomb", "drifting-friction"];
    let candidates = names.map(effect);
    let promised = predictions(&problem, &base, &[effect("torsional-spring"), effect("quadratic-drag")]);
    assert_eq!(promised[0].effect.name, "quadratic-drag");
    let decimated = problem.decimated();
    let rough = problem.on(&decimated);
    let budget = Budget::new(&count);
    let few = [effect("quadratic-drag"), effect("torsional-spring")];
    let level = extensions(&rough, &base.evaluated(&rough), &few, 0.0, &budget);
    assert_eq!(level[0].name(), "quadratic-drag");
    // A spring stands for the drag as badly as nothing at all.
    let spring = fitted(&problem, &rig_with("torsional-spring", &[0.0, 0.0]));
    let replacements = Replacements { problem: &problem, rough: &rough, candidates: &candidates, known: &[] };
    let found = |replacements: Replacements| replacements.of(&spring, |_| base.evaluated(&rough));
    let names = |found: &[Fitted]| found.iter().map(Fitted::name).collect::<Vec<_>>();
    let three = found(replacements);
    assert!(three[0].cost < 0.5 * base.cost);
    // Three are fitted. The brake would come next.
    assert_eq!(names(&three), ["quadratic-drag", "power-law-drag", "drifting-friction"]);
    // Dry friction that differs by more than there is drives the pendulum one way.
    let candidates = ["quadratic-drag", "asymmetric-coulomb"].map(effect);
    let sound = found(Replacements { problem: &problem, rough: &rough, candidates: &candidates, known: &[] });
    assert_eq!(names(&sound), ["quadratic-drag"]);
}

#[test]
fn a_zero_is_off_only_where_it_is() {
    let count = Tally::default();
    let decided = |zero_rad: f64| {
        let mut swing = simulated("zero", &rig(), 6.0, 3);
        swing.angles_rad.iter_mut().for_each(|angle| *angle += zero_rad);
        let swings = [swing];
        let problem = base_problem(&swings, (&rig()).into(), &count);
        let found = zero::decide(&problem, fitted(&problem, &rig()), 25.0 * NOISE_RAD.powi(2));
        (found.offset_is_missing, found.model.names())
    };
    assert_eq!(decided(0.0), (false, Vec::new()));
    assert!(decided(0.02).0 || !decided(0.02).1.is_empty());
}

#[test]
fn levels_are_worth_it_where_the_friction_of_two_releases_differs() {
    let count = Tally::default();
    let differs = |second: f64| {
        let mut slippery = rig();
        slippery.set_friction(5.4e-4, 7.1e-4, 0.0, 0.0);
        let mut other = rig();
        other.set_friction(second * 5.4e-4, second * 7.1e-4, 0.0, 0.0);
        let swings = [simulated("one", &slippery, 10.0, 4), simulated("two", &other, 10.0, 5)];
        let problem = base_problem(&swings, (&rig()).into(), &count);
        let before = fitted(&problem, &rig());
        let after = before.with_levels().refined(&problem, Band::Held, Tolerance::LONG);
        (levels::are_worth_it(&problem, &before, &after), levels::levels(&problem, &after).unwrap())
    };
    let (is_worth_it, found) = differs(1.2);
    assert!(is_worth_it);
    for part in &found.parts {
        // 1.1 ∓ 0.1 against the mean: a change of 0.2/1.1.
        let std = part.releases[0].std.unwrap();
        assert!((part.change - 0.2 / 1.1).abs() < 6.0 * std, "{part:?}");
        assert!((1e-4..0.1).contains(&std), "{part:?}");
    }
    assert!(!differs(1.0).0);
}

#[test]
fn what_is_left_without_an_effect_is_the_rest_of_the_model_and_no_other_one() {
    let swings = with_drag();
    let levels = |on: &Problem| (with_excess(on, &rig(), 20.0), vec![vec![drag(on, 1.0)]]);
    let left = judged(&swings, levels, |judge| {
        let both = judge.found.levels[0][0].with(effect("torsional-spring"), &[1e-4, 0.0, 0.0, 0.0]).unwrap();
        ["quadratic-drag", "torsional-spring"].map(|name| judge.without(&both, effect(name).id)[0].name())
    });
    assert_eq!(left, ["torsional-spring", "quadratic-drag"]);
}

#[test]
fn one_effect_less_is_what_the_search_preferred_if_that_is_better_than_the_rest() {
    let swings = with_drag();
    let levels = |on: &Problem| (with_excess(on, &rig(), 20.0), vec![vec![drag(on, 1.0)]]);
    let left = judged(&swings, levels, |judge| {
        let both = judge.found.levels[0][0].with(effect("torsional-spring"), &[1e-4, 0.0, 0.0, 0.0]).unwrap();
        judge.without_doubtful(&both, "quadratic-drag")
    });
    // A spring alone leaves the drag.
    assert_eq!(left.name(), "quadratic-drag");
}

/// What is slight in two swings with a drag and another effect, and beside what.
fn slight_beside_drag(name: &str, values: &[f64]) -> Option<String> {
    let mut truth = rig_with("quadratic-drag", &[DRAG]);
    truth.set(effect(name).id, values).unwrap();
    let swings = [simulated("first", &truth, 14.0, 1), simulated("second", &truth, 14.0, 2)];
    let levels = |on: &Problem| (fitted(on, &rig()), Vec::new());
    judged(&swings, levels, |judge| {
        let both = fitted(judge.problem, &truth);
        let slight = judge.slight(&both, &judge.holdings(&both));
        slight.map(|(holding, rest)| format!("{} beside {}: {:?}", holding.effect, rest.name(), holding.standing))
    })
}

#[test]
fn what_explains_less_than_a_tenth_beside_a_law_may_be_the_shape_of_that_law() {
    let weak = slight_beside_drag("torsional-spring", &[1e-3, 0.0]);
    assert_eq!(weak.as_deref(), Some("torsional-spring beside quadratic-drag: Slight"));
    assert_eq!(slight_beside_drag("torsional-spring", &[2e-2, 0.0]), None);
}

#[test]
fn what_pushes_to_one_side_is_no_shape_of_a_law_that_is_alike_on_both() {
    assert_eq!(slight_beside_drag("asymmetric-coulomb", &[2e-5]), None);
}

#[test]
fn a_law_with_fewer_numbers_is_taken_in_place_of_one_that_leaves_about_as_much_and_no_other() {
    let swings = [simulated("drag", &rig_with("quadratic-drag", &[DRAG]), 28.0, 1)];
    let taken = |reduced: f64| {
        let levels = |on: &Problem| (with_excess(on, &rig(), 400.0), vec![vec![power_law(on, 1.4), drag(on, reduced)]]);
        judged(&swings, levels, |judge| judge.simpler(&judge.found.levels[0][0], &[]).map(|(model, _)| model.name()))
    };
    assert_eq!(taken(1.5).as_deref(), Some("quadratic-drag"));
    assert_eq!(taken(3.0), None);
}

#[test]
fn a_law_that_is_wanted_stronger_than_it_can_be_is_not_claimed() {
    // A spring is half as strong again beside a pendulum of two thirds of the weight and inertia.
    let spring = |stiffness: f64, share: f64| {
        let mut rig = rig_with("torsional-spring", &[stiffness, 0.0]);
        rig.set_friction(1e-4, 1e-4, 0.0, 0.0);
        rig.pendulum.mass_kg *= share;
        rig.pendulum.inertia_kg_m2 *= share;
        rig
    };
    let standing = |stiffness: f64| {
        let swings = [simulated("light", &spring(stiffness, 1.0 / 1.5), 14.0, 1)];
        judged(
            &swings,
            |on| (begun(on, &rig()), Vec::new()),
            |judge| {
                // The period of small swings is right.
                let reached = (1.5 * stiffness).min(0.2);
                let gravity = rig().pendulum.gravity_torque_nm();
                let slower = (gravity + reached) / (gravity + 1.5 * stiffness);
                let mut near = spring(reached, 1.0);
                near.pendulum.inertia_kg_m2 -= (1.0 - slower) * near.pendulum.pivot_inertia_kg_m2();
                let model = fitted(judge.problem, &near);
                (judge.holdings(&model).remove(0).standing, judge.holding(model).0.name())
            },
        )
    };
    assert_eq!(standing(0.12), (Standing::Holds, "torsional-spring".to_owned()));
    assert_eq!(standing(0.14), (Standing::OutOfRange, "none".to_owned()));
}

#[test]
fn what_is_claimed_is_not_told_as_dropped_too() {
    let swings = with_drag();
    let levels = |on: &Problem| (begun(on, &rig()), Vec::new());
    let dropped = judged(&swings, levels, |judge| {
        let with_both = fitted(judge.problem, &rig_with("quadratic-drag", &[DRAG]));
        let with_both = with_both.with(effect("torsional-spring"), &[1e-3, 0.0]).unwrap().evaluated(judge.problem);
        let of_both = judge.holdings(&with_both);
        let names = |claimed: &Fitted| {
            let told = not_claimed(of_both.clone(), claimed);
            told.into_iter().map(|holding| (holding.effect, holding.beside)).collect::<Vec<_>>()
        };
        [names(&with_both.without(effect("torsional-spring").id)), names(&with_both), names(&judge.found.base)]
    });
    let (drag, spring) = ("quadratic-drag", "torsional-spring");
    // What was fitted beside something claimed stands there without a word, beside another that is not claimed with one.
    assert_eq!(dropped, [vec![(spring, vec![])], vec![], vec![(drag, vec![spring]), (spring, vec![drag])]]);
}

#[test]
fn a_zero_is_claimed_beside_what_is_claimed_only() {
    // Beside the drag the zero shows; but these swings are too short to prove a drag, and without one it changes nothing.
    let mut swing = simulated("short", &rig_with("quadratic-drag", &[2.0 * DRAG]), 5.0, 1);
    swing.angles_rad.iter_mut().for_each(|angle| *angle += 2e-3);
    let found = diagnose(&[swing], &[], &rig());
    assert_eq!(found.suspect, Some("quadratic-drag"), "{:?}", found.unproven);
    assert!(found.rmse_after > 0.95 * found.rmse_before, "{} of {}", found.rmse_after, found.rmse_before);
    assert!(found.verdict.is_empty(), "{:?}", found.verdict);
}

#[test]
fn the_zero_that_is_missing_has_a_value() {
    let mut swings = [simulated("one", &rig(), 14.0, 1), simulated("two", &rig(), 14.0, 2)];
    for swing in &mut swings {
        swing.angles_rad.iter_mut().for_each(|angle| *angle += 5e-3);
    }
    let found = diagnose(&swings, &[], &rig());
    assert_eq!(found.verdict, ["angle-offset"]);
    let zero = found.values.iter().find(|value| value.effect == "angle-offset").unwrap();
    assert!((zero.value - 5e-3).abs() < 4.0 * zero.std.unwrap() && zero.std.unwrap() < 1e-4, "{zero:?}");
    assert_eq!((zero.symbol, zero.unit, zero.upper), ("off", "rad", None));
    let bench = Bench { swings: &swings, held_out: &[], tolerances: Tolerances::default(), count: &Tally::default() };
    let added = bench.changed(&bench.fitted(&rig()).0, Change::Add(effect("angle-offset")));
    assert_eq!(added.unwrap_err(), ChangeError::Free { name: "angle-offset" });
}

/// The paper's rig without stiction, with more viscous friction (N·m·s/rad) that fades within six seconds.
fn with_fading(viscous: f64) -> Parameters<f64> {
    let mut truth = rig_with("drifting-friction", &[0.0, -viscous / 6.0, 6.0]);
    truth.effects.iter_mut().find(|effect| effect.id == base::VISCOUS).unwrap().values[0] += viscous;
    truth
}

#[test]
fn one_release_cant_tell_a_friction_that_fades_from_a_drag() {
    let truth = with_fading(6e-4);
    let one = [simulated("one", &truth, 20.0, 1)];
    let found = diagnose(&one, &[], &rig());
    let told = |name: &str| found.verdict.contains(&name) || found.undecided.contains(&name);
    assert!(!found.verdict.is_empty() && told("drifting-friction"), "{:?}, {:?}", found.verdict, found.undecided);
    assert!(found.not_tried.iter().all(|it| it.effect != "drifting-friction"));
}

#[test]
fn where_nothing_is_left_either_one_release_cant_tell_them_apart() {
    let truth = with_fading(2e-4);
    let one = [simulated("one", &truth, 12.0, 1)];
    let found = diagnose(&one, &[], &rig());
    assert_eq!(found.left, Left::Noise);
    assert!(!found.verdict.is_empty() && !found.verdict.contains(&"drifting-friction"), "{:?}", found.verdict);
    assert!(found.undecided.contains(&"drifting-friction"), "{:?}, {:?}", found.verdict, found.undecided);
}

#[test]
fn a_wider_law_is_tried_in_its_usual_form_too() {
    let swings = with_drag();
    let count = Tally::default();
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let wide = fitted(&problem, &rig_with("power-law-drag", &[DRAG, 2.0]));
    let names = |level: &[Fitted]| narrowed(&problem, level).iter().map(Fitted::name).collect::<Vec<_>>();
    assert_eq!(names(std::slice::from_ref(&wide)), ["quadratic-drag"]);
    assert_eq!(names(&[wide.clone(), drag(&problem, 1.0)]), [""; 0]);
    let spring = |model: &Fitted| model.with(effect("torsional-spring"), &[1e-3, 0.0]).unwrap();
    // The usual form alone is not the usual form beside a spring.
    let beside = Fitted { cost: wide.cost, ..spring(&wide) };
    assert_eq!(names(&[beside, drag(&problem, 1.0)]), ["torsional-spring+quadratic-drag"]);
    // What is far from the best is not tried, nor what has both forms already.
    assert_eq!(names(&[with_excess(&problem, &rig(), 1.0), Fitted { cost: 1e3 * wide.cost, ..wide.clone() }]), [""; 0]);
    let both = wide.with(effect("quadratic-drag"), &[DRAG]).unwrap();
    assert_eq!(names(&[Fitted { cost: wide.cost, ..both }]), [""; 0]);
}

#[test]
fn a_wider_law_that_lost_its_way_is_begun_from_its_special_case() {
    let (swings, count) = (with_drag(), Tally::default());
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let special = fitted(&problem, &rig_with("quadratic-drag", &[DRAG]));
    let lost = Fitted { cost: 20.0 * special.cost, ..begun(&problem, &rig_with("power-law-drag", &[DRAG, 0.5])) };
    let found = begun_from_special_cases(&problem, &[special.clone(), lost.clone()]);
    assert_eq!(found.iter().map(Fitted::name).collect::<Vec<_>>(), ["power-law-drag"]);
    assert!(found[0].cost <= special.cost, "{} {}", found[0].cost, special.cost);
    let n_begun = |level: &[Fitted]| begun_from_special_cases(&problem, level).len();
    // One that found its way, one alone, one whose special case stands beside another law.
    let wide = fitted(&problem, &rig_with("power-law-drag", &[DRAG, 2.0]));
    let worse = Fitted { cost: 2.0 * wide.cost, ..special.clone() };
    let beside = special.with(effect("torsional-spring"), &[1e-3, 0.0]).unwrap();
    assert_eq!([n_begun(&[worse, wide]), n_begun(std::slice::from_ref(&lost)), n_begun(&[beside, lost])], [0; 3]);
}

#[test]
fn a_usual_form_is_begun_from_the_numbers_of_the_wider_one() {
    let (swings, count) = (with_drag(), Tally::default());
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let wide = fitted(&problem, &rig_with("power-law-drag", &[DRAG, 2.0]));
    let usual = exchanged(&wide, effect("power-law-drag"), effect("quadratic-drag"), [0.0; MAX_VALUES]).unwrap();
    let values = |model: &Fitted, name: &str| model.parameters.values(effect(name).id).map(|values| values[0]);
    assert_eq!(values(&usual, "quadratic-drag"), values(&wide, "power-law-drag"));
    assert_eq!(values(&usual, "power-law-drag"), None);
}

#[test]
fn a_wider_law_that_is_claimed_gives_way_to_its_usual_form_where_that_is_as_good() {
    let told = |exponent: f64| {
        let swings = [simulated("power", &rig_with("power-law-drag", &[DRAG, exponent]), 14.0, 1)];
        let levels = |on: &Problem| (with_excess(on, &rig(), 400.0), Vec::new());
        judged(&swings, levels, |judge| {
            let wide = fitted(judge.problem, &rig_with("power-law-drag", &[DRAG, exponent]));
            let (claimed, wider) = judge.in_usual_forms(wide);
            (claimed.name(), wider.iter().map(Fitted::name).collect::<Vec<_>>())
        })
    };
    let [usual, wide] = ["quadratic-drag", "power-law-drag"].map(str::to_owned);
    assert_eq!(told(2.0), (usual, vec![wide.clone()]));
    assert_eq!(told(2.6), (wide, Vec::new()));
}

/// A spring of nothing is known to no digit.
#[test]
fn in_place_of_a_single_law_that_is_vague_stands_the_best_sure_one_that_is_worth_it() {
    let swings = with_drag();
    let named = |reduced: f64| {
        let levels = |on: &Problem| {
            let vague = with_excess(on, &rig_with("torsional-spring", &[1e-9, 0.0]), 1.4);
            (with_excess(on, &rig(), 400.0), vec![vec![vague, drag(on, reduced)]])
        };
        judged(&swings, levels, |judge| judge.beyond_their_errors(judge.found.levels[0][0].clone()).name())
    };
    assert_eq!([1.5, 9.0, 300.0].map(named), ["quadratic-drag", "quadratic-drag", "none"]);
}

/// How many notches there are is known where nobody knows whether there are any.
#[test]
fn an_effect_is_vague_whose_strengths_are_whatever_else_is_known_of_it() {
    let swings = [simulated("plain", &rig(), 14.0, 1)];
    let levels = |on: &Problem| {
        let with_detent = fitted(on, &rig_with("detent", &[1e-5, 0.0, 7.0, 0.0]));
        (with_excess(on, &rig(), 400.0), vec![vec![with_detent]])
    };
    let named = judged(&swings, levels, |judge| {
        let vague = &judge.found.levels[0][0];
        let sure = judge.beyond_their_errors(vague.clone());
        // It is not dropped without a word, unless nothing is missing without it.
        let told = |without: &Fitted| judge.vague_claims(vague, without);
        assert!(matches!(&told(&sure)[..], [claim] if claim.effect == "detent" && claim.standing == Standing::Vague));
        assert!(told(&with_excess(judge.problem, &rig(), 1.0)).is_empty() && told(vague).is_empty());
        sure.name()
    });
    assert_eq!(named, "none");
}

/// On the end of its range it has no error of its own.
#[test]
fn an_exponent_on_the_end_of_its_range_does_not_make_a_drag_sure_of_which_there_may_be_none() {
    let named = |strength: f64| {
        let truth = rig_with("power-law-drag", &[strength, 4.0]);
        let swings = [simulated("drag", &truth, 14.0, 1)];
        let levels = |on: &Problem| (with_excess(on, &rig(), 1.0), vec![vec![begun(on, &truth)]]);
        judged(&swings, levels, |judge| judge.beyond_their_errors(judge.found.levels[0][0].clone()).name())
    };
    assert_eq!([1e-9, DRAG].map(named), ["none", "power-law-drag"]);
}

/// A spring that hardens so much that the usual one is as stiff as it can be, beside another inertia.
#[test]
fn a_wider_law_is_begun_anew_where_its_usual_form_is_as_strong_as_it_can_be() {
    let swings = [simulated("hard", &rig_with("general-spring", &[0.01, 0.1, 10.0]), 14.0, 1)];
    let count = Tally::default();
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let mut usual = rig_with("torsional-spring", &[0.5, 0.29]);
    usual.pendulum.inertia_kg_m2 = 0.02;
    let found = widened(&problem, &[with_excess(&problem, &usual, 400.0)]);
    let best = found.iter().map(|model| model.cost).fold(f64::INFINITY, f64::min);
    assert!(best < 1.1 * problem.noise_cost(), "{best} {}", problem.noise_cost());
}

/// Its spring is far from as stiff as it can be; but without it nothing follows the swing.
#[test]
fn a_wider_law_is_begun_anew_where_the_model_without_it_has_lost_the_swings() {
    for truth in [[0.01, 0.1, 10.0], [0.1, 1.0, 3.0]] {
        let swings = [simulated("hard", &rig_with("general-spring", &truth), 14.0, 1)];
        let count = Tally::default();
        let problem = base_problem(&swings, (&rig()).into(), &count);
        let mut usual = rig_with("torsional-spring", &[0.1, 0.29]);
        usual.pendulum.inertia_kg_m2 = 0.02;
        let found = widened(&problem, &[with_excess(&problem, &usual, 400.0)]);
        let best = found.iter().map(|model| model.cost).fold(f64::INFINITY, f64::min);
        assert!(best < 1.1 * problem.noise_cost(), "{truth:?}: {best} {}", problem.noise_cost());
    }
}

#[test]
fn a_small_magnet_is_found_wherever_a_slow_pendulum_passes_it() {
    for (at_rad, width_rad) in [(0.2, 0.06), (0.0, 0.08), (-0.2, 0.08)] {
        let swings = [simulated("magnet", &rig_with("eddy-brake", &[8e-3, at_rad, width_rad]), 14.0, 1)];
        let count = Tally::default();
        let problem = base_problem(&swings, (&rig()).into(), &count);
        let best = predictions(&problem, &fitted(&problem, &rig()), &[effect("eddy-brake")]).remove(0).fitted(&problem);
        assert!(best.cost < 1.1 * problem.noise_cost(), "{at_rad}: {} {}", best.cost, problem.noise_cost());
    }
}

/// A linear step may be far too long, and lead into a side valley.
#[test]
fn a_fit_never_ends_above_where_its_effect_began() {
    let (swings, count) = (with_drag(), Tally::default());
    let problem = problem_of(&swings, &rig(), &count);
    let promise = predictions(&problem, &fitted(&problem, &rig()), &[effect("quadratic-drag")]).remove(0);
    let mut far = promise.model.clone();
    far.parameters.pendulum.inertia_kg_m2 *= 1.3;
    let led = far.refined(&problem, Band::Held, Tolerance::SCREEN);
    assert!(led.cost > promise.at_start.cost, "the step alone leads astray");
    let begun_again = Prediction { model: far, ..promise.clone() }.fitted(&problem);
    assert!(begun_again.cost < 0.5 * promise.at_start.cost, "{} {}", begun_again.cost, promise.at_start.cost);
}

/// Rest is at another turn with it than without, so that the level that suits the base leads its fit astray.
/// The level that stops the base where the swing does may hold the law two turns too early.
#[test]
fn a_law_that_decides_where_it_stops_is_fitted_before_that() {
    let mut truth = rig_with("asymmetric-coulomb", &[2e-3]);
    truth.set_friction(5e-4, 6e-3, 7e-3, 0.0);
    let swings = [simulated("one way", &truth, 20.0, 1)];
    let count = Tally::default();
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let decimated = problem.decimated();
    let rough = problem.on(&decimated);
    let mut near = rig();
    near.set_friction(5e-4, 6e-3, 0.0, 0.0);
    let early = fitted(&problem, &near).with_stiction(Stiction::level(0.025)).evaluated(&rough);
    let promise = predictions(&rough, &early, &[effect("asymmetric-coulomb")]).remove(0);
    let costs = [promise.fitted(&rough), promise.stopped_anew(&rough)].map(|model| model.cost / rough.noise_cost());
    assert!(costs[0] > 2.0 && costs[1] < 1.1, "{costs:?}");
}

#[test]
fn a_search_that_has_a_wider_law_only_finds_its_usual_form() {
    let (swings, count) = (with_drag(), Tally::default());
    let problem = base_problem(&swings, (&rig()).into(), &count);
    let decimated = problem.decimated();
    let base = fitted(&problem, &rig());
    let found = search(&problem, &problem.on(&decimated), &base, &[effect("power-law-drag")], &Budget::new(&count));
    let names: Vec<String> = found.levels[0].iter().map(Fitted::name).collect();
    assert!(names.contains(&"quadratic-drag".to_owned()), "{names:?}");
}

/// Where swings stay too large for a band to be seen in them, it still changes their period.
#[test]
fn a_band_beside_a_drag_is_no_second_effect() {
    let mut truth = rig_with("quadratic-drag", &[4e-5]);
    truth.set_friction(5.7e-4, 2e-4, 1.1e-3, 0.06);
    let swings = [simulated("large", &truth, 25.0, 3)];
    assert!(swings[0].last_amplitude_rad() > 0.15);
    let found = diagnose(&swings, &[], &rig());
    assert_eq!(found.verdict, ["quadratic-drag"], "{:?}", found.undecided);
    assert!(found.rmse_after < 1.05 * NOISE_RAD, "{}", found.rmse_after);
}

/// Friction that falls with the speed, on a swing that comes to rest.
fn with_stribeck() -> [Swing; 1] {
    [simulated("stribeck", &rig_with("stribeck", &STRIBECK), 14.0, 4)]
}

const STRIBECK: [f64; 2] = [4e-3, 1.5];

#[test]
fn a_law_that_a_friction_curve_resembles_is_fitted_from_the_curve() {
    let swings = with_stribeck();
    let law_beside = |reduced: f64| {
        let levels = |on: &Problem| {
            let base = fitted(on, &rig());
            let level = vec![with_excess(on, &rig_with("stribeck", &[0.0, 4.0]), reduced)];
            (base, vec![level])
        };
        judged(&swings, levels, |judge| {
            let curve = judge.friction_curve(&judge.found.base);
            curve.and_then(|curve| judge.law_of(&curve)).map(|law| (excess(judge.problem, &law), law))
        })
    };
    let (left, law) = law_beside(60.0).unwrap();
    let values = law.parameters.values(effect("stribeck").id).unwrap();
    assert!(law.names() == ["stribeck"] && left < 0.1, "{} {left}", law.name());
    assert!(values.iter().zip(STRIBECK).all(|(value, truth)| (value / truth - 1.0).abs() < 0.1), "{values:?}");
}
