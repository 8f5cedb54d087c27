//! `host fit --paper`: the paper's tables beside ours, without any recording.

use serde_json::Value;
use std::sync::OnceLock;
use tests::program::{Run, host};

fn paper(arguments: &str) -> Run {
    host(tempfile::tempdir().unwrap().path(), &format!("fit --paper {arguments}"))
}

/// Stdout must be exactly one object; calculated once for all tests.
fn object() -> &'static Value {
    static OBJECT: OnceLock<Value> = OnceLock::new();
    OBJECT.get_or_init(|| serde_json::from_str(paper("--json").succeeded()).unwrap())
}

#[track_caller]
fn close(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} within {tolerance}");
}

#[test]
fn every_count_and_error_of_tables_3_and_8_comes_out() {
    let result = object();
    for (design_idx, table, most) in [(0, 3, 0.013), (2, 8, 0.035)] {
        let design = &result["designs"][design_idx];
        assert_eq!(design["runs_table"], table);
        assert_eq!(design["runs"].as_array().unwrap().len(), 27);
        let agreement = &design["agreement"];
        assert_eq!((&agreement["n_wrong_counts"], &agreement["n_counts"]), (&0.into(), &81.into()));
        assert!(agreement["rms_log_error"].as_f64().unwrap() <= most, "{agreement}");
    }
    // The second design's responses were never published; its 27 runs are replayed all the same.
    let second = &result["designs"][1];
    assert!(second["agreement"].is_null() && second["runs"][0]["published"].is_null());
    assert_eq!(second["runs"].as_array().unwrap().len(), 27);
}

#[test]
fn r_squared_is_the_printed_one_and_the_predicted_one_tells_more() {
    let result = object();
    // Half a unit of the last digit of the printed values, and of the recalculated predicted ones.
    let predicted = [96.5, 96.6, -59.8, -98.8, 79.1];
    for (row, expected) in result["designs"][2]["r_squared"].as_array().unwrap().iter().zip(predicted) {
        close(&row["percent"], row["printed_percent"].as_f64().unwrap(), 0.005);
        close(&row["predicted_percent"], expected, 0.05);
    }
    assert!(result["designs"][0]["r_squared"][0]["printed_percent"].is_null());
    close(&result["designs"][0]["r_squared"][0]["percent"], 98.974_183, 1e-5);
}

#[test]
fn exactly_the_four_misprints_are_flagged() {
    let result = object();
    let flagged: Vec<(u64, String)> = result["equations"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|equation| equation["terms"].as_array().unwrap().iter().map(move |term| (equation, term)))
        .filter(|(_, term)| term["is_misprint"] == true)
        .map(|(equation, term)| (equation["number"].as_u64().unwrap(), term["term"].as_str().unwrap().to_owned()))
        .collect();
    let expected = [(19, "I^2"), (20, "DV^2"), (20, "Mc*DV"), (21, "Mw")];
    assert_eq!(flagged, expected.map(|(number, term)| (number, term.to_owned())));
}

#[test]
fn the_optimum_of_table_9_comes_out_and_those_of_4_and_6_say_why_not() {
    let result = object();
    let [first, second, third] = [0, 1, 2].map(|k| &result["optima"][k]);
    assert!(third["coded_distance"].as_f64().unwrap() < 0.035 && third["why_not"].is_null());
    close(&third["ours"]["desirability"], 0.785_81, 1e-4);
    close(&third["desirability_at_published"], 0.784_93, 1e-4);
    close(&third["predicted"]["mseA"], 1.165_269e-4, 1.2e-10);
    assert!(first["why_not"].as_str().unwrap().contains("better in all five"));
    for name in ["mseA", "mseV", "ePM", "eNM", "eZC"] {
        let size = |responses: &Value| responses[name].as_f64().unwrap().abs();
        assert!(size(&first["better_in_all"]["predicted"]) < size(&first["predicted"]), "{name}");
    }
    assert!(second["why_not"].as_str().unwrap().contains("never published"));
    // The authors simulated at Tables 4 and 6: counts exactly, mean squares to a few per cent.
    for optimum in [first, second] {
        let (ours, printed) = (&optimum["simulated"], &optimum["published_responses"]);
        assert!(["ePM", "eNM", "eZC"].iter().all(|name| ours[name] == printed[name]), "{optimum}");
        let printed = printed["mseA"].as_f64().unwrap();
        close(&ours["mseA"], printed, 0.06 * printed);
    }
}

#[test]
fn the_sequence_does_not_converge_by_itself() {
    let sequence = &object()["sequence"];
    let own = |k: usize| sequence["own_boxes"][k]["simulated"].as_f64().unwrap();
    assert!((0..3).all(|k| own(k) > 3e-3), "{sequence}");
    close(&sequence["printed_optima"][2], 1.70e-4, 0.01e-4);
}

#[test]
fn a_person_reads_tables_in_80_columns_and_a_conclusion() {
    let run = paper("");
    let text = run.succeeded();
    for words in ["Table 3", "Table 4", "Table 6", "Table 8", "Table 9", "Eq 22", "168 of 168", "4 misprints"] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
    let last = text.split("Not reproduced").last().unwrap();
    assert!(last.contains("negative") && last.contains("does not converge by itself"), "{last}");
    let longest = text.lines().map(|line| line.chars().count()).max().unwrap();
    assert!(longest <= 80, "{longest} columns");
    assert!(run.stderr.contains("replaying"));
    assert!(!text.contains('\u{1b}'));
}

#[test]
fn what_makes_no_sense_beside_it_is_refused() {
    for other in ["swing.csv", "--port sim", "-o rig.toml", "--range Mw=0..1"] {
        assert_eq!(paper(other).code, 2, "{other}");
    }
}
