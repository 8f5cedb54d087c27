//! Several runs in one file, below each other, in turn or side by side.

use super::{RATE_HZ, Row, check, check_refused, check_swing, open, plain, swing, swing_from, table, told};
use host::recording::{ReadOptions, Run, read_runs_of_bytes};

fn runs(text: &str, wanted: &[&str]) -> Result<Vec<Run>, String> {
    let wanted = wanted.iter().map(|run| (*run).to_owned()).collect();
    let options = ReadOptions { runs: wanted, ..ReadOptions::default() };
    read_runs_of_bytes("swing.csv", text.as_bytes(), &options).map_err(|error| error.to_string())
}

/// Three swings, each of them a line of text a row, and what stands between them.
fn three(head: &str, between: &str, row: impl Fn(usize, Row) -> String) -> String {
    let text_of = |(run, start_rad)| swing_from(start_rad).into_iter().map(|values| row(run, values) + "\n").collect();
    let texts: Vec<String> = [1.0, -0.8, 0.6].into_iter().enumerate().map(text_of).collect();
    head.to_owned() + &texts.join(between)
}

#[track_caller]
fn check_runs(text: &str, names: [&str; 3], note: &str) {
    let found = runs(text, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.iter().map(|run| run.name_in("swing.csv")).collect::<Vec<_>>(), names);
    for (run, (start_rad, note)) in found.iter().zip([(1.0, note), (-0.8, ""), (0.6, "")]) {
        check_swing(&run.recording, &swing_from(start_rad), 2e-6, note);
    }
}

#[test]
fn several_runs_in_one_file_are_recordings_of_their_own() {
    let numbered = ["swing.csv, run 1", "swing.csv, run 2", "swing.csv, run 3"];
    let bare = |_, row| plain(row);
    for between in ["", "\n", "t,theta\n", "# another\n"] {
        check_runs(&three("t,theta\n", between, bare), numbered, "3 runs (the time begins anew with each: 1, 2, 3)");
    }
    check_runs(&three("", "", bare), numbered, "--run 2 reads one");
    check_runs(
        &three("run,t,theta\n", "", |run, row| format!("{},{}", run + 1, plain(row))),
        numbered,
        "3 runs (column 0 (run): 1, 2, 3)",
    );
    let named = |run, row| format!("{};{}", plain(row).replace(',', ";"), ["left", "right", "far"][run]);
    check_runs(
        &three("t;theta;Trial name\n", "", named),
        ["swing.csv, run left", "swing.csv, run right", "swing.csv, run far"],
        "--run right reads one",
    );
    // Cells that were joined in a spreadsheet, and a clock that goes on.
    let joined = |run: usize, (time, angle, _): Row| {
        let name = if time == 0.0 { format!("Versuch {}", run + 1) } else { String::new() };
        format!("{name},{:.2},{angle:.6}", time + 30.0 * run as f64)
    };
    check_runs(
        &three("Versuch,t,theta\n", "", joined),
        ["swing.csv, Versuch 1", "swing.csv, Versuch 2", "swing.csv, Versuch 3"],
        "--run 2 reads one",
    );
    // The same where some rows end with their last number.
    let short = |run: usize, row: Row| {
        let idx = (row.0 * RATE_HZ as f64).round() as usize;
        let has_name = idx == 0 || !idx.is_multiple_of(5);
        plain(row) + &if has_name { format!(",Versuch {}", run + 1) } else { String::new() }
    };
    check_runs(
        &three("t,theta,Versuch\n", "", short),
        ["swing.csv, Versuch 1", "swing.csv, Versuch 2", "swing.csv, Versuch 3"],
        "3 runs (column 2 (Versuch): Versuch 1, Versuch 2, Versuch 3)",
    );
}

#[test]
fn names_that_stand_there_again_part_runs_whose_samples_are_counted() {
    let text = three("theta\n", "theta\n", |_, (_, angle, _)| format!("{angle:.6}"));
    let options = ReadOptions { rate_hz: Some(RATE_HZ as f64), ..ReadOptions::default() };
    let found = read_runs_of_bytes("swing.csv", text.as_bytes(), &options).unwrap();
    for (run, start_rad) in found.iter().zip([1.0, -0.8, 0.6]) {
        check_swing(&run.recording, &swing_from(start_rad), 2e-6, "");
    }
    assert_eq!(found.len(), 3);
}

#[test]
fn a_run_is_chosen_by_its_name_or_its_number() {
    let text = three("trial,t,theta\n", "", |run, row| format!("{},{}", ["B", "2", "c d"][run], plain(row)));
    for (wanted, starts_rad) in
        [(&["B"][..], &[1.0][..]), (&["1"], &[1.0]), (&["2"], &[-0.8]), (&["C D", "b"], &[0.6, 1.0]), (&["3"], &[0.6])]
    {
        let found = runs(&text, wanted).unwrap();
        assert_eq!(found.len(), starts_rad.len(), "{wanted:?}");
        for (run, start_rad) in found.iter().zip(starts_rad) {
            check_swing(&run.recording, &swing_from(*start_rad), 2e-6, "");
        }
    }
    let refused = runs(&text, &["4"]).unwrap_err();
    assert!(refused.contains("no run 4: the file holds 3 runs (column 0 (trial): B, 2, c d)"), "{refused}");
    let refused = runs(&table("t,theta\n", plain), &["2"]).unwrap_err();
    assert!(refused.contains("no run 2: the file holds one run"), "{refused}");
    assert_eq!(runs(&table("t,theta\n", plain), &["1"]).unwrap().len(), 1);
    // Where only one can be taken.
    check_refused(&text, &ReadOptions::default(), "holds 3 runs (B of 20.0 s, 2 of 20.0 s, c d of 20.0 s)");
    check_refused(&text, &ReadOptions::default(), "--run 2");
}

#[test]
fn what_is_wrong_with_one_run_is_said_of_that_run() {
    let text = three("run,t,theta\n", "", |run, row| format!("{},{}", run + 1, plain(row)));
    let stuck = text.replace("2,15.", "2,3.");
    let refused = runs(&stuck, &[]).unwrap_err();
    assert!(refused.contains("swing.csv, run 2: row 1501 of the run: time goes back from 14.99 to 3"), "{refused}");
    assert_eq!(runs(&stuck, &["1", "3"]).unwrap().len(), 2);
}

#[test]
fn rows_of_several_runs_in_turn_may_be_several_sensors_and_one_is_asked_for() {
    let (a, b) = (swing_from(1.0), swing_from(-0.8));
    let rows = a.iter().zip(&b).map(|(a, b)| format!("1,{}\n2,{}\n", plain(*a), plain(*b)));
    let text = "id,t,theta\n".to_owned() + &rows.collect::<String>();
    let refused = runs(&text, &[]).unwrap_err();
    assert!(refused.contains("in turn (column 0 (id): 1, 2)") && refused.contains("--run 1"), "{refused}");
    check_swing(&runs(&text, &["2"]).unwrap()[0].recording, &b, 2e-6, "");
}

#[test]
fn a_flag_a_count_of_rows_and_a_clock_that_was_set_back_are_no_runs() {
    let rows = |head: &str, label: fn(f64) -> String| table(head, |row| format!("{},{}", label(row.0), plain(row)));
    check(rows("run,t,theta\n", |time| u8::from(time > 2.0).to_string()).as_bytes(), 1e-6, "");
    check(rows("test,t,theta\n", |time| u8::from((2.0..3.0).contains(&time)).to_string()).as_bytes(), 1e-6, "");
    check(rows("id,t,theta\n", |time| format!("{:.0}", 100.0 * time)).as_bytes(), 1e-6, "");
    let back =
        table("t,theta\n", |(time, angle, _)| format!("{:.2},{angle:.6}", if time < 12.0 { time } else { time - 8.0 }));
    check_refused(&back, &ReadOptions::default(), "time goes back from 11.99 s to 4 s");
}

#[test]
fn small_swings_have_the_unit_of_the_wide_ones_beside_them() {
    let stacked = |starts: &[f64]| {
        let degrees = |(time, angle, _): Row| format!("{time:.2},{:.6}\n", angle.to_degrees());
        let rows = starts.iter().flat_map(|start_rad| swing_from(*start_rad)).map(degrees);
        "t,theta\n".to_owned() + &rows.collect::<String>()
    };
    let found = runs(&stacked(&[0.11, 1.0]), &[]).unwrap();
    check_swing(&found[0].recording, &swing_from(0.11), 1e-6, "read as degrees, which the wider swings");
    check_swing(&found[1].recording, &swing_from(1.0), 1e-6, "read as degrees");
}

#[test]
fn runs_side_by_side_are_asked_for_with_the_option_that_takes_one() {
    let wide = |(time, angle, _): Row| format!("{time:.2},{angle:.6},{:.6}", 0.5 * angle);
    for (head, columns) in [
        ("t,theta_1,theta_2\n", "1 (theta_1), 2 (theta_2)"),
        ("Time (s),Run 1,Run 2\n", "1 (Run 1), 2 (Run 2)"),
        ("Zeit (s),Versuch_1,Versuch_2\n", "1 (Versuch_1), 2 (Versuch_2)"),
    ] {
        let text = table(head, wide);
        check_refused(&text, &ReadOptions::default(), columns);
        check_refused(&text, &ReadOptions::default(), "--columns, e.g. t=0,theta=1 or t=0,theta=2");
        check_swing(&open(text.as_bytes(), &told("t=0,theta=1")).unwrap(), &swing(), 1e-6, "");
    }
    let twice = table("time1,angle1,time2,angle2\n", |row| format!("{},{}", plain(row), plain(row)));
    check_refused(&twice, &ReadOptions::default(), "t=0,theta=1 or t=2,theta=3");
}

#[test]
fn two_files_of_ours_in_one_are_told_where_to_part() {
    let ours = table("# format: pendulum-recording 1\nt,theta\n", plain);
    check_refused(&(ours.clone() + &ours), &ReadOptions::default(), "line 2004: the names of the columns stand there");
}
