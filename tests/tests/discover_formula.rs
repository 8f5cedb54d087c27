//! A law that is in no list: the diagnosis says so, the search through small formulas offers the right form, and with
//! it the error falls to the noise.

use host::diagnose::{Wishes, diagnose_with};
use host::improve::{Change, change};
use tests::hidden::{Hidden, Rig};

/// Two brakes beside the path, one on either side: −k·ω·exp(−((|θ| − c)/b)²).
const STRENGTH: f64 = 6e-3;
const PLACE_RAD: f64 = 0.55;
const WIDTH_RAD: f64 = 0.12;

#[test]
fn a_law_outside_the_list_is_offered_as_a_formula() {
    let rig = Rig {
        hidden: vec![Hidden {
            name: "outside",
            size: STRENGTH,
            shape: [PLACE_RAD, WIDTH_RAD],
            largest: STRENGTH,
            is_listed: false,
        }],
        releases_rad: vec![1.4, -1.0, 0.6],
        rate_hz: 100.0,
        ..Rig::random(5)
    };
    let (swings, held_out) = (rig.swings(), Rig { releases_rad: vec![-1.2], seed: 77, ..rig.clone() }.swings());
    let wishes = Wishes { formulas: true, ..Wishes::default() };
    let diagnosis = diagnose_with(&swings, &held_out, &rig.known(), wishes);
    assert!(diagnosis.unexplained, "{:?} leaves {}", diagnosis.verdict, diagnosis.rmse_after / diagnosis.noise);

    let best = diagnosis.formulas.first().expect("a formula");
    let told = || format!("{:?} after {:?}", diagnosis.formulas, diagnosis.verdict);
    assert!(best.words.contains("·ω·exp(-((|θ|-0.5"), "{}", told());
    assert!(best.rmse < 1.05 * diagnosis.noise && best.rmse < 0.9 * diagnosis.rmse_after, "{}", told());
    assert!(best.held_out.unwrap() < 1.1 * diagnosis.noise, "{}", told());
    let value = |symbol: &str| best.parameters.iter().find(|value| value.symbol == symbol).unwrap();
    for (symbol, truth, tolerance) in [("k", STRENGTH, 0.1), ("c", PLACE_RAD, 0.02), ("b", WIDTH_RAD, 0.1)] {
        let found = value(symbol).value;
        assert!((found / truth - 1.0).abs() < tolerance, "{symbol} is {found} instead of {truth}: {}", told());
    }

    // What is offered can be taken.
    let effect = host::formula::read(&best.formula).unwrap();
    let steps = change(&swings, &held_out, &rig.known(), &[Change::Add(effect)]).unwrap();
    assert!(steps[1].rmse < 1.05 * diagnosis.noise && steps[0].rmse > 2.0 * diagnosis.noise, "{steps:?}");
}
