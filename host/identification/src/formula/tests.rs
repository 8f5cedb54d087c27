use super::read;
use shared::effect::{Action, MAX_VALUES};
use shared::formula::{MAX_TEXT, Program};
use shared::motion::{Motion, Pendulum};

fn motion(angle_rad: f64, velocity_rad_s: f64, time_s: f64) -> Motion<f64> {
    let direction = if velocity_rad_s == 0.0 { 0.0 } else { velocity_rad_s.signum() };
    Motion { angle_rad, velocity_rad_s, direction, time_s, pendulum: Pendulum::paper() }
}

/// The torque of a formula in both number types, which must agree.
fn torque(text: &str, angle: f64, velocity: f64, values: &[f64]) -> f64 {
    let effect = read(text).unwrap_or_else(|error| panic!("{error}"));
    let Action::Formula(formula) = effect.action else { panic!("no formula") };
    let values: [f64; MAX_VALUES] = std::array::from_fn(|i| values.get(i).copied().unwrap_or(0.0));
    let at = motion(angle, velocity, 2.5);
    let exact = Program::<f64>::new(formula).torque_nm(&at, &values);
    let p = at.pendulum;
    let on_board = Motion {
        angle_rad: angle as f32,
        velocity_rad_s: velocity as f32,
        direction: at.direction as f32,
        time_s: 2.5,
        pendulum: Pendulum {
            mass_kg: p.mass_kg as f32,
            length_m: p.length_m as f32,
            inertia_kg_m2: p.inertia_kg_m2 as f32,
            gravity_m_s2: p.gravity_m_s2 as f32,
        },
    };
    let rounded = f64::from(Program::<f32>::new(formula).torque_nm(&on_board, &values.map(|value| value as f32)));
    let limit = 1e-5 * exact.abs().max(1e-6);
    assert!((rounded - exact).abs() < limit, "{text}: {exact} in f64, {rounded} in f32");
    exact
}

fn close(got: f64, expected: f64) {
    assert!((got - expected).abs() <= 1e-7 * expected.abs() + 1e-15, "{got} instead of {expected}");
}

#[test]
fn formulas_mean_what_they_say() {
    let cases: [(&str, f64); 17] = [
        ("torque = 1 + 2 * 3", 7.0),
        ("-2^2", -4.0),
        ("-theta^2", -0.25),
        ("(-theta)^2", 0.25),
        ("2^3^2 * 0.01", 5.12),
        ("2^-1", 0.5),
        ("theta^-2", 4.0),
        ("6 / 2 / 3", 1.0),
        ("8 - 3 - 2", 3.0),
        ("-omega * abs(omega)", 4.0),
        ("sgn(omega) * 0.5", -0.5),
        ("sign(omega) × 0.5", -0.5),
        ("sqrt(abs(omega)) * sin(pi * theta)", 2.0_f64.sqrt()),
        ("tanh(omega) + 2 − cos(θ·2)", (-2.0_f64).tanh() + 2.0 - 1.0_f64.cos()),
        ("exp(-(omega/1.5)^2)", (-(2.0_f64 / 1.5).powi(2)).exp()),
        ("t * 2", 5.0),
        ("load", Pendulum::<f64>::paper().bearing_load_n(0.5, -2.0)),
    ];
    for (text, expected) in cases {
        // theta^-2 has no value at zero, so it is refused whole; its arithmetic is looked at in the others.
        if text == "theta^-2" {
            assert!(read(text).unwrap_err().problem.contains("theta = 0.000"), "{text}");
        } else {
            close(torque(text, 0.5, -2.0, &[]), expected);
        }
    }
}

#[test]
fn the_example_of_the_handbook_is_read() {
    let text = "torque = -k * omega * abs(omega)^p; k in 0..1e-3 N·m; p in 0..3";
    close(torque(text, 0.1, 3.0, &[1e-4, 1.3]), -1e-4 * 3.0 * 3.0_f64.powf(1.3));
    let effect = read(text).unwrap();
    let told: Vec<_> = effect.parameters.iter().map(|p| (p.symbol, p.low, p.high, p.unit)).collect();
    assert_eq!(told, [("k", 0.0, 1e-3, "N·m"), ("p", 0.0, 3.0, "1")]);
    assert!(effect.starts.iter().all(|start| start[0] == 0.0), "the strength starts at zero");
    assert_eq!(
        effect.starts.iter().map(|start| start[1]).collect::<Vec<_>>(),
        [1.5, 0.6000000000000001, 2.4000000000000004]
    );
}

#[test]
fn two_factors_do_not_both_start_at_zero() {
    let product = read("-a * b * omega; a in 0..1; b in 0..1").unwrap();
    assert_eq!((product.starts[0][0], product.starts[0][1]), (0.0, 0.5));
    let sum = read("-a * omega - b * theta; a in 0..1; b in -1..1").unwrap();
    assert_eq!((sum.starts.len(), sum.starts[0][0], sum.starts[0][1]), (1, 0.0, 0.0));
}

/// The complaint, and what its carets stand under.
fn complaint(text: &str) -> (String, String) {
    let error = read(text).unwrap_err();
    let marked = error.place.clone().map(|place| error.text.chars().skip(place.start).take(place.len()).collect());
    (error.problem, marked.unwrap_or_default())
}

#[test]
fn errors_say_what_and_mark_where() {
    let cases = [
        ("-k * omga; k in 0..1", "omga is unknown", "omga"),
        ("-k * omega", "k is unknown", "k"),
        ("-k * (omega; k in 0..1", "never closed", "("),
        ("omega)", "never opened", ")"),
        ("omega *", "ends here", ""),
        ("", "ends here", ""),
        ("2 omega", "expected an operator", "omega"),
        ("abs omega", "abs is a function", "omega"),
        ("omega ^ ^ 2", "not '^'", "^"),
        ("omega $ 2", "'$' means nothing", "$"),
        ("force = omega", "write torque = …", "force "),
        ("k*omega; k in 2..1", "range of k is empty", "k in 2..1"),
        ("k*omega; k in 1..1", "range of k is empty", "k in 1..1"),
        ("k*omega; k in 0..x", "expected a number", "x"),
        ("k*omega; k from 0..1", "expected NAME in", "from 0..1"),
        ("k*omega; k in 0 1", "expected NAME in", "1"),
        ("k*omega; k in 0..1e99", "not a number that the rig can hold", "1e99"),
        ("k*omega; k in 0..1; k in 0..2", "has a range already", "k"),
        ("t*omega; t in 0..1", "meaning of its own", "t"),
        ("omega; k in 0..1", "not in the formula", "k"),
        ("a*b*c*d*e; a in 0..1; b in 0..1; c in 0..1; d in 0..1; e in 0..1", "at most 4", "e"),
        ("ω·Ω", "Ω is unknown", "Ω"),
    ];
    for (text, problem, marked) in cases {
        let (said, under) = complaint(text);
        assert!(said.contains(problem), "{text}: {said}");
        assert_eq!(under.trim(), marked.trim(), "{text}: {said}");
    }
    let ends = complaint("k*omega; k in 2..1").0;
    assert!(ends.contains("its low end 2 is not below its high end 1"), "{ends}");
    let known = complaint("-k * omga; k in 0..1").0;
    assert!(known.contains("there are theta, omega, load, t, k and the functions"), "{known}");
    let shown = read("-k * omga; k in 0..1").unwrap_err().to_string();
    let lines: Vec<&str> = shown.lines().collect();
    assert_eq!((lines[1], lines[2]), ("  -k * omga; k in 0..1", "       ^^^^"));
}

#[test]
fn formulas_without_a_number_somewhere_are_refused_with_the_place() {
    for (text, place) in [
        ("omega / theta", "theta = 0.000"),
        ("-k*omega^p; k in 0..1; p in 0.5..3", "omega = -25"),
        ("-k*abs(omega)^p; k in 0..1; p in -1..3", "omega = 0"),
        ("exp(k * omega^4); k in 0..1", "omega = -25"),
        ("1/0", "theta"),
    ] {
        let (said, _) = complaint(text);
        assert!(said.contains("no finite value at") && said.contains(place), "{text}: {said}");
    }
    let told = |text: &str| complaint(text).0;
    // The first instant at which it has none, with the parameter as it was there.
    let divided = told("k / theta; k in 1..2");
    assert!(divided.contains("t = 0, k = 1; a division by zero or an overflow"), "{divided}");
    let broken = told("-k*omega^p; k in 0..1; p in 0.5..3");
    assert!(broken.contains("0/0, or a broken power") && broken.contains("abs(omega)^p"), "{broken}");
}

#[test]
fn what_does_not_fit_the_rig_is_refused() {
    assert!(complaint(&format!("omega{}", " + omega".repeat(20))).0.contains("room for 120"));
    assert!(complaint(&format!("t{}", "+t".repeat(30))).0.contains("room for 48"));
    assert!(complaint("t+1*t+2*t+3*t+4*t+5*t+6*t+7*t+8*t+9*t").0.contains("room for 8"));
    assert!(complaint("t+(t+(t+(t+(t+(t+(t+(t+(t+t))))))))").0.contains("wait for their operator"));
    assert!(complaint(&"(".repeat(100)).0.contains("inside each other"));
    assert!(complaint(&"-".repeat(100)).0.contains("inside each other"));
}

proptest::proptest! {
    #[test]
    fn any_text_is_refused_or_read(text: String) {
        let _ = read(&text);
    }

    #[test]
    fn any_text_of_the_right_letters_is_refused_or_read(
        text in "([-+*/^()., ;=·0-9]|e|k|p|in|\\.\\.|omega|theta|load|t|abs|exp|sqrt|sgn|N·m|torque){0,40}"
    ) {
        let _ = read(&text);
    }

    #[test]
    fn any_formula_gives_a_bounded_number(
        text in "(-|abs|exp|sin|tanh|sqrt)?\\(?(omega|theta|load|t)\\)?[-+*/^](omega|k|2|0.5)(\\^|\\*)(k|3|theta)(; k in -1\\.\\.2)?",
        angle in -4.0..4.0,
        velocity in -1e6..1e6,
    ) {
        if let Ok(effect) = read(&text) {
            let Action::Formula(formula) = effect.action else { panic!("no formula") };
            let torque = Program::<f64>::new(formula).torque_nm(&motion(angle, velocity, 1.0), &[0.7, 0.0, 0.0, 0.0]);
            proptest::prop_assert!(torque.is_finite());
        }
    }
}

#[test]
fn a_strength_that_can_not_be_zero_begins_within_its_range() {
    let product = read("-a * omega; a in 1..3").unwrap();
    assert_eq!(product.starts.iter().map(|start| start[0]).collect::<Vec<_>>(), [2.0, 1.4, 2.6]);
}

#[test]
fn a_formula_as_long_as_the_rig_has_room_for_is_read() {
    let long = |n_bytes: usize| format!("omega + {}", "0".repeat(n_bytes - 8));
    assert!(read(&long(MAX_TEXT)).is_ok());
    let problem = complaint(&long(MAX_TEXT + 1)).0;
    assert!(problem.contains(&format!("{} bytes, and the rig has room for {MAX_TEXT}", MAX_TEXT + 1)), "{problem}");
}
