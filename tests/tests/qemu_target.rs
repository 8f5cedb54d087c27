//! The shared crate on the microcontroller, in QEMU: checks hold there, and every `f32` result has the PC's bits.

use shared::model::Model;
use shared::parameters::Parameters;
use target_tests::traces::{self, RELEASE_RAD, SWING_STEPS};
use target_tests::{checks, traces::Trace};
use tests::image::target_program;
use tests::qemu::run;

#[test]
fn checks_hold_on_the_microcontroller_and_results_have_the_same_bits() {
    let image = target_program("checks").unwrap();
    let said = run(&image, &std::env::temp_dir(), None).unwrap();
    let lines: Vec<&str> = said.lines().collect();
    assert!(!checks::ALL.is_empty() && !traces::ALL.is_empty());
    for check in checks::ALL {
        let expected = format!("check {} ok", check.name);
        assert!(lines.contains(&expected.as_str()), "no line {expected:?} in\n{said}");
    }
    for trace in traces::ALL {
        let expected = line_of(trace);
        assert!(lines.contains(&expected.as_str()), "no line {expected:?} in\n{said}");
    }
}

fn line_of(trace: &Trace) -> String {
    let (n_results, hash) = traces::fingerprint(trace);
    assert!(n_results > 0, "{} computes nothing", trace.name);
    format!("trace {} {n_results} {hash:08x}", trace.name)
}

#[test]
fn a_panic_restarts_the_program_and_says_where_it_was() {
    let said = run(&target_program("panics").unwrap(), &std::env::temp_dir(), None).unwrap();
    let source = include_str!("../target/src/bin/panics.rs");
    let line = 1 + source.lines().position(|line| line.contains("panic!(")).unwrap();
    assert!(said.contains("cause Some(Panic), resets 1, at "), "{said}");
    assert!(said.trim_end().ends_with(&format!("panics.rs:{line}")), "{said}");
}

/// With the test above, what holds for the PC's `f32` holds for the microcontroller's.
#[test]
fn an_uncorrected_swing_in_f32_stays_within_1e_4_rad_of_f64() {
    let exact = Model::new(&Parameters::paper());
    let mut state = exact.release(f64::from(RELEASE_RAD), 0.0);
    let (mut worst_rad, mut n_steps) = (0.0_f64, 0);
    traces::swing(&mut |angle_rad| {
        exact.step(&mut state, 1e-3);
        worst_rad = worst_rad.max((f64::from(angle_rad) - state.angle_rad).abs());
        n_steps += 1;
    });
    println!("f32 against f64 over 45 s: {worst_rad:.2e} rad");
    assert_eq!(n_steps, SWING_STEPS);
    assert!(worst_rad <= 1e-4, "{worst_rad:e} rad");
}

#[test]
fn checks_hold_on_the_pc_too() {
    for check in checks::ALL {
        (check.run)();
    }
}
