//! Mass, length and inertia that are known to tolerances: what a fit, a diagnosis, a comparison and a study make of them,
//! on swings of the independent plant.

use host::compare::measurement::Measurement;
use host::compare::verdict::Answer;
use host::compare::{self, Comparison, compare};
use host::diagnose::diagnose;
use host::fit::identify::{Identified, Method, Options, fit};
use host::fit::tolerance::{Known, KnownRig, Tolerances};
use host::rigfile::RigFile;
use host::swing::Swing;
use host::verdict::Left;
use shared::parameters::Parameters;
use tests::hidden::Rig;
use tests::program::host;
use tests::workbench::{Workbench, number, texts};

/// The file's length is so much too long.
const TOO_LONG: f64 = 1.006;

/// A bob on a thread, so that no inertia about the centre can make up for a wrong length; sampled no more than needed.
fn bob() -> Rig {
    let rig = Rig::random(3);
    let thread = 1e-4 * rig.mass_kg * rig.length_m * rig.length_m;
    let friction = Rig { coulomb_nm: 3e-4, stiction_nm: 4e-4, noise_rad: 5e-4, ..rig };
    Rig {
        inertia_kg_m2: thread,
        drawn_inertia_kg_m2: thread,
        rate_hz: 100.0,
        releases_rad: vec![1.2, -0.7],
        ..friction
    }
}

/// What somebody knows of it whose ruler is off.
fn measured(rig: &Rig) -> Parameters<f64> {
    let mut known = rig.known();
    known.pendulum.length_m = TOO_LONG * rig.length_m;
    known
}

fn tolerances(known: &Parameters<f64>, mass: f64, length: f64) -> Tolerances {
    let share = |value: f64, share: f64| Some(Known { value, std: share * value });
    let pendulum = &known.pendulum;
    Tolerances { mass: share(pendulum.mass_kg, mass), length: share(pendulum.length_m, length), inertia: None }
}

fn of<'a>(found: &'a [Identified], symbol: &str) -> &'a Identified {
    found.iter().find(|number| number.symbol == symbol).unwrap()
}

#[test]
fn a_length_that_is_off_by_its_tolerance_is_no_spring() {
    let rig = bob();
    let (swings, known) = (rig.swings(), measured(&rig));
    let exact = diagnose(&swings, &[], &known);
    // A spring would explain it, though no claim of one holds: the period alone tells of it.
    let suspected = exact.suspect().map_or("", |suspect| suspect.effect);
    assert!(suspected.ends_with("spring") && exact.unexplained, "{:?} {:?}", exact.verdict, exact.unproven);
    let rigs = KnownRig { parameters: &known, tolerances: tolerances(&known, 5e-3, 6e-3) };
    let found = diagnose(&swings, &[], rigs);
    assert!(found.verdict.is_empty() && found.left == Left::Noise, "{:?} {:?}", found.verdict, found.left);
    assert!(found.unproven.is_empty(), "{:?}", found.unproven);
    assert_eq!(found.parameters.check(), Ok(()));

    let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
    let fit = fit(&swings, &[], rigs, &options, &|_| ()).unwrap();
    // A thread has a ten-thousandth of m·l², which the length takes over.
    assert!((fit.parameters.pendulum.length_m / rig.length_m - 1.0).abs() < 3e-4, "{:?}", fit.parameters.pendulum);
    assert_eq!((fit.parameters.check(), fit.left), (Ok(()), Left::Noise));
    for (symbol, truth) in [("Mc", rig.coulomb_nm), ("Mw", rig.viscous), ("m", rig.mass_kg), ("l", rig.length_m)] {
        let Identified { value, std, .. } = *of(&fit.identified, symbol);
        let std = std.unwrap();
        println!("{symbol}: {value} ± {std}, {truth}");
        assert!((value - truth).abs() < 2.5 * std, "{symbol}: {value} ± {std}, {truth}");
    }
    // The settled model swings as the fitted one does.
    assert!(
        host::fit::identify::held_out_rmse(&swings, &fit.parameters, &Default::default()).unwrap()
            < 1.01 * fit.rmse_rad
    );
}

#[test]
fn friction_is_no_surer_than_the_weight_that_it_is_measured_with() {
    let rig = Rig { rate_hz: 100.0, releases_rad: vec![1.2], ..Rig::random(3) };
    let (swings, known) = (rig.swings(), rig.known());
    let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
    let by = |mass, length| {
        let rig = KnownRig { parameters: &known, tolerances: tolerances(&known, mass, length) };
        fit(&swings, &[], rig, &options, &|_| ()).unwrap()
    };
    let exact = fit(&swings, &[], &known, &options, &|_| ()).unwrap();
    let rough = by(0.03, 0.04);
    // The geometry moves nothing where any inertia may be found; 3 and 4 % of the weight are 5 % of every torque.
    let Identified { value, std, .. } = *of(&exact.identified, "Mc");
    let wide = of(&rough.identified, "Mc");
    assert!((wide.value / value - 1.0).abs() < 1e-9, "{} {value}", wide.value);
    let expected = (std.unwrap().powi(2) + (0.05 * value).powi(2)).sqrt();
    assert!((wide.std.unwrap() / expected - 1.0).abs() < 1e-3, "{:?} {expected}", wide.std);
    let place = |symbol: &str| rough.identified.iter().position(|number| number.symbol == symbol).unwrap();
    let correlation = rough.correlations[place("Mc")][place("m")].unwrap();
    assert!((correlation / (0.03 * value / expected) - 1.0).abs() < 1e-3, "{correlation}");
}

#[test]
fn a_spring_that_no_tolerance_explains_is_still_named() {
    let rig = bob().with("torsional-spring");
    let weight_nm = rig.mass_kg * rig.gravity_m_s2 * rig.length_m;
    let mut rig = rig;
    rig.hidden[0].size = 0.08 * weight_nm;
    let known = rig.known();
    let found =
        diagnose(&rig.swings(), &[], KnownRig { parameters: &known, tolerances: tolerances(&known, 5e-3, 6e-3) });
    assert!(found.verdict.contains(&"torsional-spring"), "{:?}", found.verdict);
}

#[test]
fn an_inertia_that_was_drawn_well_corrects_the_length() {
    let rig = Rig { rate_hz: 100.0, releases_rad: vec![1.2], ..Rig::random(5) };
    let mut known = measured(&rig);
    known.pendulum.inertia_kg_m2 = rig.inertia_kg_m2;
    let drawn = Some(Known { value: rig.inertia_kg_m2, std: 1e-3 * rig.inertia_kg_m2 });
    let tolerances = Tolerances { inertia: drawn, ..tolerances(&known, 1e-3, 6e-3) };
    let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
    let fit = fit(&rig.swings(), &[], KnownRig { parameters: &known, tolerances }, &options, &|_| ()).unwrap();
    for (symbol, truth) in [("l", rig.length_m), ("I", rig.inertia_kg_m2), ("Mc", rig.coulomb_nm)] {
        let Identified { value, std, .. } = *of(&fit.identified, symbol);
        println!("{symbol}: {value} ± {std:?}, {truth}");
        assert!((value - truth).abs() < 3.0 * std.unwrap(), "{symbol}: {value} ± {std:?}, {truth}");
    }
    // Near l² = I/m the period hardly depends on the length; a ruler's 0.6 % still become less.
    assert!(of(&fit.identified, "l").std.unwrap() < 6e-3 * rig.length_m);
}

#[test]
fn the_file_keeps_what_was_measured_and_the_next_fit_counts_no_swing_twice() {
    let rig = bob();
    let bench = Workbench::new(&rig);
    bench.save(&rig, 0, "swing.csv");
    let too_long_m = TOO_LONG * rig.length_m;
    let (mass_kg, inertia) = (rig.mass_kg, rig.drawn_inertia_kg_m2);
    let init = format!(
        "init --mass {mass_kg} --mass-std 5e-4 --length {too_long_m} --length-std 1e-3 --inertia {inertia} --force"
    );
    host(bench.folder(), &init).succeeded();
    let path = bench.folder().join("rig.toml");
    let text = std::fs::read_to_string(&path).unwrap().replace("# m, from", "# m, by a ruler, from");
    std::fs::write(&path, text).unwrap();
    let once = bench.json("fit swing.csv --method least-squares -o rig.toml --force");
    let written = std::fs::read_to_string(&path).unwrap();
    assert!(written.contains("std = 0.0005 } # kg") && written.contains("# m, by a ruler, from"), "{written}");
    let prior = format!("prior = {{ value = {too_long_m:?}, std = 0.001 }}");
    assert!(written.contains(&prior), "{written}");
    let twice = bench.json("fit swing.csv --method least-squares -o again.toml");
    assert_eq!(texts(&once, "warnings"), texts(&twice, "warnings"));
    for index in 0..once["parameters"].as_array().unwrap().len() {
        let [first, second] = [&once, &twice].map(|fit| fit["parameters"][index].clone());
        if let (Some(std), Some(again)) = (first["std"].as_f64(), second["std"].as_f64()) {
            assert!((number(&first, "value") - number(&second, "value")).abs() < 0.05 * std, "{first} {second}");
            assert!((again / std - 1.0).abs() < 0.05, "{first} {second}");
        }
    }
    let model = RigFile::load(&path).unwrap();
    assert_eq!(model.parameters().pendulum.inertia_kg_m2, 0.0);
}

fn compared(rig: KnownRig, swings: &[Swing], fit_first: bool) -> Comparison {
    let measurements: Vec<Measurement> = swings.iter().cloned().map(Measurement::of_swing).collect();
    compare(rig, &measurements, &[], &compare::Options { fit_first, question_numbers: true }).unwrap()
}

#[test]
fn a_comparison_fits_as_a_fit_does() {
    let rig = bob();
    let (swings, known) = (rig.swings(), measured(&rig));
    let rigs = KnownRig { parameters: &known, tolerances: tolerances(&known, 5e-3, 6e-3) };
    assert_ne!(compared((&known).into(), &swings, true).answer, Answer::NothingMissing);
    let fresh = compared(rigs, &swings, true);
    assert_eq!(fresh.answer, Answer::NothingMissing, "{:?}", fresh.verdict);
    let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
    let fit = fit(&swings, &[], rigs, &options, &|_| ()).unwrap();
    assert_eq!(fresh.parameters, fit.parameters);
    let seen = &fresh.knowledge.as_ref().unwrap().parameters;
    assert_eq!(seen.len(), fit.identified.len() - 2, "all but Ms and DV");
    for found in seen {
        let Identified { value, std, .. } = *of(&fit.identified, found.symbol);
        println!("{}: {:?} in {}, {value} ± {std:?}", found.symbol, found.chosen, found.given);
        let scale = std.unwrap();
        assert!((found.chosen.value - value).abs() < 0.05 * scale && (found.given - value).abs() < 0.05 * scale);
        assert!((found.chosen.std.unwrap() / scale - 1.0).abs() < 0.05, "{:?} {std:?}", found.chosen);
    }
    // Asked whether its numbers or physics are to blame, it gives the geometry the same freedom.
    let [exact, tolerant] = [(&known).into(), rigs].map(|rig| compared(rig, &swings, false).refit.unwrap().left);
    assert!(exact != Left::Noise && tolerant == Left::Noise, "{exact:?} {tolerant:?}");
}

#[test]
fn no_tolerance_excuses_recordings_that_do_not_agree() {
    let rig = Rig { rate_hz: 100.0, releases_rad: vec![1.2, -0.7], friction_change: 0.1, ..Rig::random(5) };
    let (swings, known) = (rig.swings(), rig.known());
    let rigs = KnownRig { parameters: &known, tolerances: tolerances(&known, 0.2, 6e-3) };
    let [exact, tolerant] =
        [(&known).into(), rigs].map(|rig| compared(rig, &swings, true).knowledge.unwrap().parameters);
    for (exact, tolerant) in exact.iter().zip(&tolerant).filter(|(exact, _)| exact.unit.starts_with("N·m")) {
        println!("{}: {:?}, {:?} {:?}", exact.symbol, exact.alone, exact.chosen, tolerant.chosen);
        assert!((exact.agreement.unwrap() - tolerant.agreement.unwrap()).abs() < 1e-3);
        let expected = exact.chosen.std.unwrap().hypot(0.2_f64.hypot(6e-3) * exact.chosen.value);
        assert!((tolerant.chosen.std.unwrap() / expected - 1.0).abs() < 1e-3, "{:?} {expected}", tolerant.chosen);
    }
}

/// The columns of a study's table by name, a text a recording.
fn studied(bench: &Workbench, column: &str) -> Vec<String> {
    let text = std::fs::read_to_string(bench.folder().join("table.csv")).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let place = rows.next().unwrap().iter().position(|name| name == column).unwrap_or_else(|| panic!("{column}"));
    rows.map(|row| row[place].clone()).collect()
}

#[test]
fn a_study_takes_the_tolerances_of_its_rigs() {
    let rig = bob();
    let (bench, names) = Workbench::with_recordings(&rig);
    let Rig { mass_kg, drawn_inertia_kg_m2, .. } = rig;
    let (length_m, [of_mass, of_length]) = (TOO_LONG * rig.length_m, [5e-3, 6e-3]);
    let study = |stds: &str| {
        let init = format!("init --mass {mass_kg} --length {length_m} --inertia {drawn_inertia_kg_m2} {stds} --force");
        host(bench.folder(), &init).succeeded();
        bench.json("study . --no-diagnosis --csv table.csv --force")
    };
    study("");
    let left = studied(&bench, "left_over");
    assert!(left.len() == names.split(' ').count() && left.iter().all(|left| left != "noise"), "{left:?}");
    let said = study(&format!("--mass-std {} --length-std {}", of_mass * mass_kg, of_length * length_m));
    let left = studied(&bench, "left_over");
    assert!(left.iter().all(|left| left == "noise"), "{left:?}");
    for length in studied(&bench, "l") {
        assert!((length.parse::<f64>().unwrap() / rig.length_m - 1.0).abs() < 1e-3, "{length}");
    }
    // Two swings scatter by less than the weight is uncertain that both have.
    let dry = said["rigs"][0]["friction"].as_array().unwrap().iter().find(|it| it["symbol"] == "Mc").unwrap();
    let (value, std) = (number(dry, "value"), number(dry, "std_error"));
    assert!(std > 0.99 * of_mass.hypot(of_length) * value && std < 0.05 * value, "{value} ± {std}");
    assert!((value - rig.coulomb_nm).abs() < 3.0 * std, "{value} ± {std}");
}

#[test]
fn a_tolerance_that_is_none_is_refused_with_its_line() {
    let file = |length: &str| {
        format!("format = 1\n[pendulum]\nmass = 0.15\nlength = {length}\ninertia = 1e-4\ngravity = 9.81\n")
    };
    for (std, words) in [
        ("-0.001", "above 0"),
        ("0", "above 0"),
        ("0.2", "no larger than the value"),
        ("nan", "not a finite number"),
        ("inf", "not a finite number"),
    ] {
        let error =
            RigFile::parse("rig.toml", &file(&format!("{{ value = 0.16, std = {std} }}"))).unwrap_err().to_string();
        assert!(error.contains("line 4: pendulum.length.std") && error.contains(words), "{error}");
    }
    assert!(RigFile::parse("rig.toml", &file("{ value = 0.16, std = 0.3, method = \"guess\" }")).is_ok());
}
