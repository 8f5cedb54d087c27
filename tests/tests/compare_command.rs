//! `host compare` on the command line.

use serde_json::Value;
use tests::hidden::Rig;
use tests::program::host;
use tests::workbench::Workbench;

const INIT: &str = "init --mass 0.1466084 --length 0.1562177 --inertia 0.00270676";

#[test]
fn a_fresh_rig_is_fitted_first_and_a_fitted_one_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    host(path, INIT).succeeded();
    host(path, "simulate --seconds 25 --rate 200 -o swing.csv").succeeded();
    host(path, "simulate --seconds 25 --rate 200 --start 1.0 --seed 2 -o other.csv").succeeded();
    let text = in_one_line(host(path, "compare swing.csv --hold-out other.csv").succeeded());
    assert!(text.contains("fitted to these recordings first") && text.contains("Nothing is missing"), "{text}");
    assert!(text.contains("(held out)") && text.contains("the model carries over to them"));
    host(path, "simulate --seconds 25 --rate 200 --with Cq=1e-4 --seed 3 -o strange.csv").succeeded();
    let strange = in_one_line(host(path, "compare swing.csv --hold-out strange.csv").succeeded());
    assert!(strange.contains("does not carry over"), "{strange}");
    let lacking = in_one_line(host(path, "compare strange.csv --hold-out strange.csv").succeeded());
    assert!(lacking.contains("the model carries over, and lacks the same"), "{lacking}");

    host(path, "fit swing.csv --method least-squares -o rig.toml").succeeded();
    let stdout = host(path, "compare swing.csv --json --report report.html --plot pictures");
    let result: Value = serde_json::from_str(stdout.succeeded()).unwrap();
    assert_eq!(result["command"], "compare");
    assert_eq!(result["fitted_first"], false);
    assert_eq!(result["answer"], "nothing-missing");
    let page = std::fs::read_to_string(path.join("report.html")).unwrap();
    assert!(page.len() < 8_000_000 && page.contains("Plotly.newPlot"));
    let outside_script = page.split("</script>").filter(|part| part.len() < 1_000_000);
    assert!(outside_script.into_iter().all(|part| !part.contains("https://") && !part.contains("MathJax")));
    let n_pictures = std::fs::read_dir(path.join("pictures")).unwrap().count();
    assert!(n_pictures >= 15, "{n_pictures}");
}

#[test]
fn numbers_of_another_pendulum_are_not_called_missing_physics() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    host(path, "pull --port sim:mystery-4").succeeded();
    host(path, "simulate mystery-4 --rate 200 --start 1.5 -o wide.csv").succeeded();
    let result: Value = serde_json::from_str(host(path, "compare wide.csv --json").succeeded()).unwrap();
    assert_eq!(result["answer"], "numbers-do-not-fit");
    assert!(result["totals"]["ratio"].as_f64().unwrap() > 20.0);
    assert!(result["refit"]["ratio"].as_f64().unwrap() < 1.05, "{}", result["refit"]);
    // The model's first reading is where the pendulum was let go, whatever that costs it later.
    let start = |key: &str| result["recordings"][0]["start"][key].as_f64().unwrap();
    let began_rad = start("angle_rad") + start("offset_rad");
    assert!((began_rad - 1.5).abs() < 0.02, "it begins at {began_rad} rad");
    let text = in_one_line(host(path, "compare wide.csv").succeeded());
    assert!(text.contains("These numbers do not fit these recordings: fit first, or physics is missing."), "{text}");
    assert!(!text.contains("so physics is missing"), "{text}");
    host(path, "fit wide.csv --method least-squares -o fitted.toml").succeeded();
    let fitted = in_one_line(host(path, "compare wide.csv --rig fitted.toml").succeeded());
    assert!(fitted.contains("Nothing is missing at this noise level"), "{fitted}");
}

#[test]
fn what_a_person_should_know_beside_the_result_goes_to_stderr() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    host(path, INIT).succeeded();
    host(path, "simulate --seconds 8 --rate 200 -o swing.csv").succeeded();
    let run = host(path, "compare swing.csv");
    assert!(!run.succeeded().contains("note:"), "{}", run.stdout);
    assert!(run.stderr.contains("note: cut") && run.stderr.contains("note: No recording comes to rest"), "{run:?}");
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    host(path, INIT).succeeded();
    host(path, "simulate --seconds 10 --rate 200 -o swing.csv").succeeded();
    host(path, "compare swing.csv --report nowhere/report.html").failed(1, &["nowhere/report.html"]);
}

/// Rows of the independent plant's recordings: their own clocks and readings, the model laid over them, and noise between.
#[test]
fn the_series_holds_every_sample_beside_its_modelled_value() {
    let rig = Rig { releases_rad: vec![1.2, -0.8], rate_hz: 100.0, ..Rig::random(14) };
    let (bench, _) = Workbench::with_recordings(&rig);
    let path = bench.folder();
    std::fs::rename(path.join("swing2.csv"), path.join("second,_held_out.csv")).unwrap();
    host(path, "fit swing1.csv --method least-squares -o rig.toml").succeeded();
    host(path, "compare swing1.csv --hold-out second,_held_out.csv --csv series.csv").succeeded();
    let text = std::fs::read_to_string(path.join("series.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("recording,t_s,measured_rad,modelled_rad,residual_rad"));
    for (release_idx, name) in ["swing1.csv", "second,_held_out.csv"].into_iter().enumerate() {
        let recording = rig.recording(release_idx);
        let rows = lines.clone().filter_map(|line| line.strip_prefix(&format!("\"{name}\",")));
        let rows: Vec<Vec<f64>> = rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        assert!(rows.len() > recording.len() / 2, "{name}: {} rows of {} samples", rows.len(), recording.len());
        let mut squares = 0.0;
        for row in &rows {
            let [time_s, measured, modelled, residual] = row[..] else { panic!("{row:?}") };
            let idx = (time_s * rig.rate_hz).round() as usize;
            assert!((recording.times_s()[idx] - time_s).abs() < 1e-6, "{name}: {row:?}");
            assert!((recording.angles_rad()[idx] - measured).abs() < 1e-6, "{name}: {row:?}");
            assert!((measured - modelled - residual).abs() < 1e-6, "{name}: {row:?}");
            squares += residual * residual;
        }
        let noises = (squares / rows.len() as f64).sqrt() / rig.total_noise_rad();
        assert!((0.9..1.1).contains(&noises), "{name}: {noises} noises between measured and modelled");
    }
    // An earlier one is not replaced.
    host(path, "compare swing1.csv --csv series.csv").failed(2, &["series.csv", "--force"]);
}

/// Text for a terminal without its line breaks.
fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
