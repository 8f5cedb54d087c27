use super::*;
use shared::curve::Curve;
use shared::parameters::base;
use shared::sensor::{Encoder, Potentiometer};

fn paper() -> RigFile {
    RigFile::new(Parameters::paper().pendulum).unwrap()
}

fn reread(file: &RigFile) -> RigFile {
    RigFile::parse("again.toml", &file.to_string()).unwrap()
}

fn complaint(text: &str) -> String {
    RigFile::parse("rig.toml", text).unwrap_err().to_string()
}

const VISCOUS: Quantity = Quantity::Effect { id: base::VISCOUS, index: 0 };

#[test]
fn a_fresh_file_reads_back_the_same() {
    for file in [paper(), RigFile::normalised(9.81).unwrap()] {
        let again = reread(&file);
        assert_eq!(again.parameters(), file.parameters());
        assert_eq!(again.is_normalised(), file.is_normalised());
        assert_eq!(again.to_string(), file.to_string());
    }
}

#[test]
fn numbers_of_a_law_of_an_earlier_version_are_refused_and_not_misread() {
    for (name, first) in [("drifting-friction", "Mc1 = 5e-4"), ("general-drift", "Mcg = 5e-4")] {
        let told = complaint(&format!("{}[effect.{name}]\n{first}\ntau = 9.0\n", paper()));
        let expected = ["an earlier version", "added friction at the release", "Take", "fit the recordings anew"];
        assert!(expected.iter().all(|words| told.contains(words)) && told.contains(name), "{told}");
    }
}

#[test]
fn a_persons_comments_survive_an_update() {
    let text = "# my rig\nformat = 1\n[pendulum] # the brass one\nmass = 0.1 # weighed\nlength = 0.2\n\
                inertia = 0.001\ngravity = 9.81\n[effect.viscous]\n# greased in May\nMw = 1e-4 # guess\n";
    let mut file = RigFile::parse("rig.toml", text).unwrap();
    let source = Source::new("least squares", &["a.csv".into(), "b.csv".into()]);
    let knowledge = Knowledge { std: Some(1.234e-6), source: Some(source) };
    file.set(VISCOUS, 2.123_456_789e-4, knowledge.clone()).unwrap();
    file.set(Quantity::Mass, 0.11, Knowledge::default()).unwrap();
    let written = file.to_string();
    for kept in ["# my rig", "# the brass one", "mass = 0.11 # weighed", "# greased in May", "# guess"] {
        assert!(written.contains(kept), "{kept} is gone from\n{written}");
    }
    let again = reread(&file);
    assert_eq!(VISCOUS.get(again.parameters()), Some(2.123_46e-4));
    let known = again.knowledge(VISCOUS).unwrap();
    assert_eq!((known.std, &known.source), (Some(1.23e-6), &knowledge.source));
}

#[test]
fn an_added_effect_explains_itself_and_can_be_removed() {
    let mut file = paper();
    let before = file.parameters().clone();
    let drag = Quantity::by_name("Cq").unwrap();
    file.set(drag, 1e-4, Knowledge::default()).unwrap();
    assert!(file.to_string().contains("[effect.quadratic-drag]"));
    assert_eq!(drag.get(reread(&file).parameters()), Some(1e-4));
    file.remove_effect(10);
    assert_eq!(*reread(&file).parameters(), before);
}

#[test]
fn every_effect_can_stand_in_a_file() {
    for effect in shared::effect::Effect::<f64>::ALL {
        let mut file = paper();
        for (index, parameter) in effect.parameters.iter().enumerate() {
            let quantity = Quantity::Effect { id: effect.id, index };
            file.set(quantity, parameter.start, Knowledge::default()).unwrap();
        }
        assert_eq!(reread(&file).parameters(), file.parameters(), "{}", effect.name);
    }
}

#[test]
fn the_sensor_is_written_and_read() {
    let mut file = paper();
    let potentiometer = Potentiometer { zero_code: 2040.25, ..Potentiometer::nominal(4095) };
    file.set_sensor(potentiometer.into());
    file.set_sensor(potentiometer.into());
    assert_eq!(reread(&file).sensor(), Some(&potentiometer.into()));
}

#[test]
fn another_sensor_takes_the_place_of_the_one_before_and_its_numbers() {
    let mut file = paper();
    let potentiometer: Sensor = Potentiometer { zero_code: 2040.25, ..Potentiometer::nominal(4095) }.into();
    let encoder: Sensor = Encoder::new(-4000).into();
    for sensor in [encoder, potentiometer, encoder, encoder] {
        file.set_sensor(sensor);
        assert_eq!(reread(&file).sensor(), Some(&sensor), "{file}");
    }
    let text = file.to_string();
    let table = &text[text.find("[sensor]").unwrap()..];
    assert_eq!(table, "[sensor]\nkind = \"encoder\"\ncounts_per_turn = -4000\n");
}

#[test]
fn what_a_rig_reports_leaves_equal_values_alone() {
    let mut file = paper();
    let knowledge = Knowledge { std: Some(1e-7), source: None };
    file.set(VISCOUS, 5.4e-4, knowledge.clone()).unwrap();
    let mut reported = file.parameters().map(|value| value as f32);
    reported.set(base::COULOMB, &[3e-4]).unwrap();
    reported.remove(base::STICTION);
    file.take_over(&reported, &Source::read_from("sim")).unwrap();
    assert_eq!(file.knowledge(VISCOUS), Some(&knowledge));
    assert_eq!(reread(&file).parameters().values(base::COULOMB), Some([3e-4].as_slice()));
    assert_eq!(reread(&file).parameters().values(base::STICTION), None);
}

#[test]
fn a_value_out_of_range_is_refused_and_nothing_changes() {
    let mut file = paper();
    let before = file.to_string();
    assert!(file.set(VISCOUS, f64::NAN, Knowledge::default()).is_err());
    assert!(file.set(Quantity::Mass, -1.0, Knowledge::default()).is_err());
    assert_eq!(file.to_string(), before);
}

#[test]
fn mistakes_are_told_with_line_and_key() {
    let pendulum = "format = 1\n[pendulum]\nmass = 0.1\nlength = 0.2\ninertia = 1e-3\ngravity = 9.81\n";
    let cases = [
        ("".to_owned(), "format is missing"),
        ("format = 9\n".to_owned(), "has format 9; this program knows up to 1"),
        ("format = 1\n".to_owned(), "[pendulum] is missing"),
        ("format = 1\nmass = = 2\n".to_owned(), "rig.toml, line 2"),
        (pendulum.replace("mass = 0.1", "mass = -0.1"), "rig.toml, line 3: pendulum.mass: -0.1 cannot be used"),
        (pendulum.replace("mass = 0.1", "mass = nan"), "rig.toml, line 3: pendulum.mass: nan is not a finite number"),
        (pendulum.replace("mass = 0.1", "mas = 0.1"), "rig.toml, line 3: pendulum.mas: unknown; known are mass"),
        (pendulum.replace("gravity = 9.81\n", ""), "pendulum.gravity is missing; expected gravitational acceleration"),
        (format!("{pendulum}[effect.drag]\nCq = 1\n"), "rig.toml, line 7: effect.drag: there is no such effect"),
        (format!("{pendulum}[effect.coulomb]\nMc = \"x\"\n"), "rig.toml, line 8: effect.coulomb.Mc"),
        (format!("{pendulum}[effect.coulomb]\n"), "effect.coulomb.Mc is missing; expected torque while sliding in N·m"),
        (format!("{pendulum}[effect.coulomb]\nMc = -1e-4\n"), "line 8: effect.coulomb.Mc: -0.0001 cannot be used"),
        (format!("{pendulum}[sensor]\nzero_code = 1\n"), "sensor.radians_per_code is missing"),
        (
            format!("{pendulum}[sensor]\nkind = \"sundial\"\n"),
            "line 8: sensor.kind: expected \"potentiometer\" or \"encoder\"",
        ),
        (
            format!("{pendulum}[sensor]\nkind = \"encoder\"\n"),
            "sensor.counts_per_turn is missing; expected counts a turn",
        ),
        (
            format!("{pendulum}[sensor]\nzero_code = 1\nradians_per_code = 1e-3\nfull_scale = 70000\n"),
            "line 10: sensor.full_scale: 70000 cannot be; expected 1 to 65535",
        ),
        (format!("{pendulum}[sensor]\nkind = \"encoder\"\ncounts_per_turn = 3\n"), "expected counts_per_turn of 16 to"),
        (format!("{pendulum}[sensor]\nkind = \"encoder\"\ncounts_per_turn = 99.5\n"), "99.5 is not a whole number"),
        (
            format!("{pendulum}[sensor]\nkind = \"encoder\"\nzero_code = 3\n"),
            "line 9: sensor.zero_code: unknown; known are",
        ),
    ];
    for (text, expected) in cases {
        let complaint = complaint(&text);
        assert!(complaint.contains(expected), "{complaint}\nexpected {expected}");
    }
}

#[test]
fn many_recordings_are_counted_instead_of_named() {
    let paths: Vec<std::path::PathBuf> = (1..=9).map(|i| format!("a/folder/swing{i}.csv").into()).collect();
    assert_eq!(Source::new("least squares", &paths[..2]).recordings, ["swing1.csv", "swing2.csv"]);
    assert_eq!(Source::new("", &paths).recordings, ["swing1.csv", "swing2.csv", "swing3.csv", "and 6 more"]);
}

#[test]
fn a_formula_stands_in_a_file_and_can_be_changed_for_another() {
    let mut file = paper();
    let text = "-k*omega*abs(omega)^p; k in 0..1e-3 N·m; p in 0..3";
    for (symbol, value) in [("k", 2e-5), ("p", 1.5)] {
        let quantity = Quantity::by_formula_name(symbol, crate::formula::read(text).unwrap()).unwrap();
        file.set(quantity, value, Knowledge { std: Some(0.01 * value), source: None }).unwrap();
    }
    let again = RigFile::parse("rig.toml", &file.to_string()).unwrap();
    assert_eq!(again.parameters(), file.parameters());
    assert_eq!(again.parameters().formula.as_ref().unwrap().text(), text);

    let mut reported = file.parameters().map(|value| value as f32);
    let other = crate::formula::read("-c*theta; c in 0..1").unwrap();
    let shared::effect::Action::Formula(law) = other.action else { panic!() };
    reported.set_formula(law, &[0.25]).unwrap();
    file.take_over(&reported, &Source::default()).unwrap();
    let again = RigFile::parse("rig.toml", &file.to_string()).unwrap();
    assert_eq!(again.parameters().values(1000), Some(&[0.25][..]));
    assert_eq!(again.parameters().formula.as_ref(), Some(law));
    file.remove_effect(1000);
    assert!(!file.to_string().contains("custom") && file.parameters().formula.is_none());
}

fn curve_file() -> RigFile {
    let mut file = RigFile::new(Pendulum::paper()).unwrap();
    for symbol in ["Mw", "Mc"] {
        file.set(Quantity::by_name(symbol).unwrap(), 0.0, Knowledge::default()).unwrap();
    }
    file
}

#[test]
fn a_friction_curve_is_written_readably_and_read_back_the_same() {
    let mut file = curve_file();
    let curve = Curve::new(&[0.0, 0.7, 9.4], &[1.25e-3, 8e-4, 2e-3]).unwrap();
    let known = KnownCurve { curve: curve.clone(), stds: vec![Some(1e-5), None, Some(2e-5)] };
    let source = Source::new("least squares, friction curve", &["a/swing.csv".into()]);
    file.set_curve(&known, &source).unwrap();
    let text = file.to_string();
    for part in ["[effect.friction-curve]", "# rad/s", "speed = [0", "# N·m, the friction", "\"unknown\"", "swing.csv"]
    {
        assert!(text.contains(part), "{part} in {text}");
    }
    let mut again = RigFile::parse("rig.toml", &text).unwrap();
    assert_eq!(again.parameters().curve.as_ref(), Some(&curve));
    assert_eq!(again.parameters(), file.parameters());
    again
        .set_curve(&KnownCurve { curve: Curve::new(&[0.0, 2.0], &[0.0, 1e-3]).unwrap(), stds: Vec::new() }, &source)
        .unwrap();
    assert_eq!(again.to_string().matches("[effect.friction-curve]").count(), 1);
    again.remove_effect(shared::effect::CURVE_ID);
    assert!(!again.to_string().contains("friction-curve") && again.parameters().curve.is_none());
}

#[test]
fn a_bad_friction_curve_is_refused_with_its_line_and_key() {
    let refused = |table: &str, words: &str| {
        let text = format!("{}\n[effect.friction-curve]\n{table}", curve_file());
        let error = RigFile::parse("rig.toml", &text).unwrap_err().to_string();
        assert!(error.contains(words), "{error} for {table}");
    };
    refused("speed = [0, 1]\ntorque = [1e-3]", "effect.friction-curve.torque: 1 torques for 2 speeds");
    refused(
        "speed = [0, 2, 1]\ntorque = [0, 0, 0]",
        "effect.friction-curve.speed: expected 2 to 32 speeds that rise from 0",
    );
    refused(
        "speed = [0, 1]\ntorque = [0, \"much\"]",
        "effect.friction-curve.torque: expected a list of numbers in N·m",
    );
    refused("speed = [0, 1]\ntorque = [0, -1e-3]", "torque 2 of friction-curve is not a number from 0");
    refused("speed = [0, 1]\ntorque = [0, 1]\nknots = 2", "effect.friction-curve.knots");
    let beside = RigFile::new(Pendulum::paper()).unwrap().to_string()
        + "\n[effect.friction-curve]\nspeed = [0, 1]\ntorque = [0, 1]";
    let error = RigFile::parse("rig.toml", &beside).unwrap_err().to_string();
    assert!(error.contains("friction-curve stands in place of"), "{error}");
}

/// Of numbers that swings know together far better than each, whose own ± are larger than they are.
#[test]
fn a_number_keeps_six_digits_however_little_is_known_of_it_alone() {
    let written = |value: f64, std: f64| {
        let mut file = paper();
        let source = Some(Source::new("least squares", &[]));
        file.set(VISCOUS, value, Knowledge { std: Some(std), source }).unwrap();
        VISCOUS.get(reread(&file).parameters()).unwrap()
    };
    assert_eq!(written(1.843142345678e-3, 0.0143), 1.84314e-3);
    assert_eq!(written(1.843142345678e-3, 2e-9), 1.843142346e-3);
    assert_eq!(written(0.0, 0.1), 0.0);
}
