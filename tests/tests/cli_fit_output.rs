//! What `host fit` leaves: a screen for a person, one object for programs, a drawing.

use serde_json::Value;
use std::fs;
use std::path::Path;
use tests::program::host;

/// A folder with a model and two simulated swings.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.0027").succeeded();
    let friction = "--with Mw=5.4e-4 --with Mc=7e-4 --with Ms=2e-3 --rate 200";
    host(folder.path(), &format!("simulate {friction} --start 1.5 -o a.csv")).succeeded();
    host(folder.path(), &format!("simulate {friction} --start=-1.1 --seed 2 -o b.csv")).succeeded();
    folder
}

fn json(folder: &Path, arguments: &str) -> Value {
    serde_json::from_str(host(folder, arguments).succeeded()).unwrap()
}

#[test]
fn the_object_holds_what_programs_need() {
    let folder = folder();
    let result = json(folder.path(), "fit a.csv --hold-out b.csv --json");
    assert_eq!((result["command"].as_str(), result["format"].as_u64()), (Some("fit"), Some(1)));
    for parameter in result["parameters"].as_array().unwrap() {
        for key in ["symbol", "name", "unit"] {
            assert!(parameter[key].is_string(), "{key} in {parameter}");
        }
        assert!(parameter["value"].is_number() && (parameter["std"].is_number() || parameter["std"].is_null()));
    }
    let symbols = result["parameters"].as_array().unwrap().iter().map(|p| p["symbol"].as_str().unwrap());
    assert_eq!(symbols.collect::<Vec<_>>(), ["Mw", "Mc", "Ms", "DV", "I"]);
    for key in ["rmse", "noise", "held_out_rmse", "simulations", "seconds"] {
        assert!(result[key].is_number(), "{key} in {result}");
    }
    for name in ["mseA", "mseV", "ePM", "eNM", "eZC"] {
        assert!(result["responses"][name].is_number(), "{name}");
    }
    assert!(!result["stages"].as_array().unwrap().is_empty());
    let lowered: Vec<f64> = result["lowered"]
        .as_array()
        .unwrap()
        .iter()
        .map(|after| after["responses"]["mseA"].as_f64().unwrap())
        .collect();
    assert_eq!(lowered.len(), 3);
    assert!(lowered[1] < 0.1 * lowered[0] && lowered[2] <= 1.001 * lowered[1], "{lowered:?}");
}

#[test]
fn whoever_asks_for_more_hears_what_is_noticed_in_a_recording() {
    let folder = folder();
    let said = &host(folder.path(), "fit a.csv -vv").stderr;
    assert!(said.contains("recording::segment: noise"), "{said}");
}

#[test]
fn without_a_held_out_swing_its_error_is_null() {
    let folder = folder();
    let result = json(folder.path(), "fit a.csv --method least-squares --json --quiet");
    assert!(result["held_out_rmse"].is_null() && result.get("held_out_rmse").is_some());
    assert_eq!(result["lowered"].as_array().unwrap().len(), 2);
}

#[test]
fn a_person_sees_values_with_spread_stages_and_what_to_do_next() {
    let folder = folder();
    let run = host(folder.path(), "fit a.csv --hold-out b.csv -o fitted.toml");
    let text = run.succeeded();
    for words in [
        "±",
        "e-4",
        "N·m·s/rad",
        "viscous",
        "identified",
        "first guess",
        "response surfaces",
        "least squares",
        "mrad rms",
        "held out",
        "fitted.toml",
        "host push --rig fitted.toml --port PORT",
    ] {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(!text.contains('\u{1b}'));
    assert!(run.stderr.contains("least squares …"), "{}", run.stderr);
}

#[test]
fn quiet_leaves_only_notes_on_stderr() {
    let folder = folder();
    let run = host(folder.path(), "fit a.csv --method least-squares --quiet");
    assert!(run.succeeded().contains("Mw"));
    assert!(run.stderr.lines().all(|line| line.starts_with("note:")), "{}", run.stderr);
    host(folder.path(), "--quiet fit missing.csv").failed(1, &["missing.csv"]);
}

#[test]
fn the_port_tells_what_was_recorded_and_gained() {
    let folder = tempfile::tempdir().unwrap();
    let text = host(folder.path(), "fit --port sim --method least-squares").succeeded().to_owned();
    for words in
        ["recorded   swing-", "-check.csv", "times smaller", "in its flash too", "host fit --port sim -o rig.toml"]
    {
        assert!(text.contains(words), "{words:?} is not in\n{text}");
    }
    assert!(!text.contains("--force") && !text.contains("host pull"), "{text}");
}

/// Elements opened and closed in the right order; gives the names of all.
fn elements(svg: &str) -> Vec<String> {
    let (mut open, mut all) = (Vec::new(), Vec::new());
    for tag in svg.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').expect("every tag ends");
        let name: String = tag.trim_start_matches('/').chars().take_while(|c| c.is_alphanumeric()).collect();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "{tag}");
            continue;
        }
        if !tag.ends_with('/') {
            open.push(name.clone());
        }
        all.push(name);
    }
    assert!(open.is_empty(), "{open:?}");
    all
}

#[test]
fn the_drawing_is_a_small_svg_with_a_row_for_each_swing() {
    let folder = folder();
    host(folder.path(), "fit a.csv b.csv --method least-squares --plot fit.svg").succeeded();
    let svg = fs::read_to_string(folder.path().join("fit.svg")).unwrap();
    assert!(svg.len() < 500_000, "{} bytes", svg.len());
    let n_lines = elements(&svg).iter().filter(|name| *name == "polyline").count();
    assert!(n_lines >= 6, "{n_lines} lines: measured, model and residual of two swings are six");
    for words in ["a.csv", "b.csv", "angle (rad)", "left over (mrad)", "time (s)", "sans-serif", "Mw = "] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(!svg.contains("NaN"));
}

#[test]
fn a_drawing_that_cannot_be_written_is_a_clear_failure() {
    let folder = folder();
    host(folder.path(), "fit a.csv --method least-squares --quiet --plot no/such/fit.svg")
        .failed(1, &["no/such/fit.svg", "could not write", "folder that exists"]);
}

#[test]
fn the_paper_can_be_drawn_too() {
    let folder = tempfile::tempdir().unwrap();
    let object = json(folder.path(), "fit --paper --json --plot paper.svg");
    assert!(object["verdict"]["reproduced"].is_array());
    let svg = fs::read_to_string(folder.path().join("paper.svg")).unwrap();
    assert!(svg.len() < 500_000 && svg.contains("Table 9"));
    elements(&svg);
}

/// The surfaces leave Ms and DV out where they do nothing yet; the other numbers must not take their places.
#[test]
fn with_an_added_effect_every_stage_has_its_error() {
    let folder = folder();
    let model = fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    fs::write(folder.path().join("rig.toml"), model + "\n[effect.torsional-spring]\nks = 1e-3\nths = 0.0\n").unwrap();
    host(folder.path(), "simulate --rate 200 --with Mc=7e-4 --with ks=6e-3 --with Ms=2e-3 -o spring.csv").succeeded();
    let result = json(folder.path(), "fit spring.csv --json");
    let lowered = result["lowered"].as_array().unwrap();
    let errors: Vec<f64> = lowered.iter().filter_map(|after| after["responses"]["mseA"].as_f64()).collect();
    assert_eq!(errors.len(), 3, "{lowered:?}");
    assert!(errors[1] < 0.1 * errors[0] && errors[2] <= 1.001 * errors[1], "{errors:?}");
}

/// The same swing as a file of others, with a motor that holds it back.
fn with_motor(ours: &str) -> String {
    let rows = ours.lines().filter(|line| line.starts_with(|letter: char| letter.is_ascii_digit()));
    let driven = rows.filter_map(|row| {
        let angle: f64 = row.split(',').nth(1)?.parse().ok()?;
        Some(format!("{row},{:.3}\n", -0.1 * angle))
    });
    format!("t,theta,raw,torque\n{}", driven.collect::<String>())
}

#[test]
fn what_speaks_against_a_recording_is_in_the_object() {
    let folder = folder();
    let swing = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    fs::write(folder.path().join("driven.csv"), with_motor(&swing)).unwrap();
    for command in ["fit --method least-squares", "diagnose"] {
        let free = json(folder.path(), &format!("{command} a.csv --json"));
        assert_eq!(free["doubts"].as_array().map(Vec::len), Some(0), "{command}");
        let driven = json(folder.path(), &format!("{command} driven.csv --json"));
        assert_eq!(driven["doubts"][0]["recording"], "driven.csv", "{command}");
        assert!(driven["doubts"][0]["words"].as_str().unwrap().starts_with("3 (torque) goes from -0."), "{command}");
    }
}

/// A swing of this period whose size falls so fast, as a file.
fn swing(folder: &Path, name: &str, period_s: f64, decay_per_s: f64) {
    let row = |k: u32| {
        let t = f64::from(k) * 5e-3;
        let noise = 1e-5 * (f64::from(k * 7919 % 13) - 6.0);
        let theta = 0.1 * (-decay_per_s * t).exp() * (std::f64::consts::TAU * t / period_s).cos();
        format!("{t:.3},{:.6}\n", theta + noise)
    };
    let rows: String = (0..4000).map(row).collect();
    fs::write(folder.join(name), format!("t,theta\n{rows}")).unwrap();
}

#[test]
fn recordings_of_two_pendulums_are_told_apart() {
    let folder = folder();
    let path = folder.path();
    swing(path, "one.csv", 1.047, 0.03);
    swing(path, "same.csv", 1.048, 0.03);
    swing(path, "other.csv", 1.080, 0.03);
    let fit = "fit one.csv --method least-squares --json --quiet";
    assert_eq!(json(path, &format!("{fit} same.csv"))["doubts"], serde_json::json!([]));
    let run = host(path, &format!("{fit} other.csv"));
    let result: Value = serde_json::from_str(run.succeeded()).unwrap();
    let words = result["doubts"][0]["words"].as_str().unwrap_or_default();
    assert!(words.contains("another pendulum") && words.contains("1.0"), "{result:#}");
    assert!(run.stderr.contains("another pendulum"), "{}", run.stderr);
}

#[test]
fn a_held_out_recording_of_another_pendulum_is_doubted() {
    let folder = folder();
    let path = folder.path();
    swing(path, "one.csv", 1.047, 0.03);
    swing(path, "same.csv", 1.048, 0.03);
    swing(path, "other.csv", 1.080, 0.03);
    for command in ["fit one.csv --method least-squares", "compare one.csv", "diagnose one.csv"] {
        let stderr = |held_out: &str| {
            let run = host(path, &format!("{command} --quiet --hold-out {held_out}"));
            run.succeeded();
            run.stderr
        };
        assert!(!stderr("same.csv").contains("another pendulum"), "{command}");
        let told = stderr("other.csv");
        assert!(told.contains("other.csv: its period") && told.contains("of another pendulum"), "{command}: {told}");
    }
}

#[test]
fn where_physics_is_missing_the_next_step_of_a_fit_from_a_rig_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let text = host(folder.path(), "fit --port sim:drag").succeeded().to_owned();
    assert!(text.contains("next       host fit --port sim:drag --discover -o rig.toml"), "{text}");
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("not identifiable while physics is missing") && !words.contains("add a release"), "{text}");
}

#[test]
fn what_is_driven_is_to_be_recorded_anew_and_not_diagnosed() {
    let folder = folder();
    swing(folder.path(), "motor.csv", 1.047, 0.0);
    let text = host(folder.path(), "fit motor.csv --method least-squares").succeeded().to_owned();
    assert!(text.contains("host record --port PORT -o free.csv") && !text.contains("host diagnose"), "{text}");
}

#[test]
fn without_a_geometry_every_table_and_drawing_says_what_its_units_mean() {
    let folder = folder();
    let path = folder.path();
    host(path, "init --unknown-geometry -o unknown.toml").succeeded();
    let text = host(path, "fit a.csv --rig unknown.toml -o unknown.toml --plot fit.svg").succeeded().to_owned();
    assert!(text.contains("per m·g·l") && text.contains(" m·g·l·s² ") && !text.contains("N·m·s"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(fs::read_to_string(path.join("fit.svg")).unwrap().contains("(per m·g·l)"));
    let text =
        host(path, "compare a.csv --rig unknown.toml --report report.html --plot pictures").succeeded().to_owned();
    assert!(text.contains("per m·g·l"), "{text}");
    let report = fs::read_to_string(path.join("report.html")).unwrap();
    assert!(report.contains("every torque and inertia is per m·g·l") && !report.contains("in mN·m"));
    assert!(report.contains("<td>m·g·l·s/rad</td>") && !report.contains("<td>N·m"), "{report}");
}

#[test]
fn a_long_name_leaves_room_for_what_stands_beside_it() {
    let folder = folder();
    let path = folder.path();
    let name = format!("{}-07.csv", "a-swing-of-the-second-rig".repeat(5));
    fs::copy(path.join("a.csv"), path.join(&name)).unwrap();
    host(path, &format!("fit {name} --method least-squares -o rig.toml --plot fit.svg")).succeeded();
    assert!(fs::read_to_string(path.join("fit.svg")).unwrap().contains("…"));
    let text = host(path, &format!("compare {name} --report report.html")).succeeded().to_owned();
    let table: Vec<&str> = text.lines().filter(|line| line.contains("-07.csv")).collect();
    assert!(table.iter().any(|line| line.contains('…') && line.chars().count() <= 100), "{text}");
    let report = fs::read_to_string(path.join("report.html")).unwrap();
    assert!(report.contains("…") && !report.contains(&format!(">{name}")));
}
