//! Recordings as files: our own format, those of others, broken ones, and arbitrary bytes.

use std::fs;
use std::path::{Path, PathBuf};

use host::recording::check::problems;
use host::recording::{
    AngleUnit, Calibration, Existing, Fault, Header, ReadOptions, Recording, WriteError, Writer, read, read_bytes, save,
};
use proptest::prelude::*;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data").join(name)
}

fn parse(text: &str) -> Result<Recording, String> {
    parse_with(text, &ReadOptions::default())
}

fn parse_with(text: &str, options: &ReadOptions) -> Result<Recording, String> {
    read_bytes("swing.csv", text.as_bytes(), options).map_err(|error| error.to_string())
}

fn columns(text: &str) -> ReadOptions {
    ReadOptions { columns: Some(text.parse().unwrap()), ..ReadOptions::default() }
}

/// Forty rows of a swing at 100 Hz made by `row(time in s, angle in rad)`, under `head`.
fn table(head: &str, row: impl Fn(f64, f64) -> String) -> String {
    let rows = (0..40).map(|idx| f64::from(idx) / 100.0).map(|t| row(t, (8.0 * t).cos()) + "\n");
    format!("{head}{}", rows.collect::<String>())
}

fn plain() -> String {
    table("t,theta\n", |t, angle| format!("{t},{angle}"))
}

/// Whatever the dress, the same swing comes out.
fn check_same(text: &str, options: &ReadOptions) {
    let recording = parse_with(text, options).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let expected = parse(&plain()).unwrap();
    assert_eq!(recording.len(), expected.len(), "{text}");
    for idx in 0..expected.len() {
        assert!((recording.times_s()[idx] - expected.times_s()[idx]).abs() < 1e-9, "{text}");
        assert!((recording.angles_rad()[idx] - expected.angles_rad()[idx]).abs() < 1e-9, "{text}");
    }
}

#[test]
fn files_of_many_labs_are_the_same_swing() {
    let found = ReadOptions::default();
    let comma = |number: f64| number.to_string().replace('.', ",");
    check_same(&plain().replace('\n', "\r\n"), &found);
    check_same(&format!("\u{feff}{}", plain()), &found);
    check_same(&table("Time [s];Angle [deg]\n", |t, a| format!("{};{}", comma(t), comma(a.to_degrees()))), &found);
    check_same(&table("time_ms\tomega\tPosition (rad)\n", |t, a| format!("{}\t9\t{a}", t * 1e3)), &found);
    check_same(&table("Logger v2\nserial;7\n\nt;phi\ns;rad\n", |t, a| format!("{t};{a}")), &found);
    check_same(&table("# made by numpy\n# t theta\n", |t, a| format!("{t:.18e} {a:.18e}")), &found);
    check_same(&table("", |t, a| format!("{t}  {a}")), &found);
    check_same(&table("\"seconds\",\"degrees\"\n", |t, a| format!("\"{t}\",\"{}\"", a.to_degrees())), &found);
    check_same(&table("run,theta,t\n", |t, a| format!("A,{a},{t}")), &found);
    check_same(&table("a,b,c\n", |t, a| format!("1,{},{}", t * 1e3, a.to_degrees())), &columns("t=1:ms,theta=2:deg"));
    check_same(&table("x,clock,y\n", |t, a| format!("1,{t},{a}")), &columns("t=clock,theta=Y"));
    let degrees = ReadOptions { angle_unit: Some(AngleUnit::Degrees), ..found.clone() };
    check_same(&table("t,theta\n", |t, a| format!("{t},{}", a.to_degrees())), &degrees);
    let rate = ReadOptions { rate_hz: Some(100.0), ..found };
    check_same(&table("theta\n", |_, a| a.to_string()), &rate);
    check_same(&table("", |_, a| a.to_string()), &rate);
}

/// The message of a broken file contains all of these.
fn check_refused(text: &str, expected: &[&str]) {
    let message = parse(text).expect_err(text);
    for part in ["swing.csv"].iter().chain(expected) {
        assert!(message.contains(part), "{message}\nlacks {part}");
    }
}

fn with_row(row: &str) -> String {
    plain().replacen("0.1,", &format!("{row}\n0.1,"), 1)
}

#[test]
fn a_broken_file_is_refused_with_place_value_and_advice() {
    check_refused("", &["empty", "expected rows"]);
    check_refused("\n \n", &["empty"]);
    check_refused("hello\nworld\n", &["no row of numbers in 2 lines"]);
    check_refused("t,theta\n0,1\n1,2\n", &["only 2 samples", "two swings"]);
    check_refused("\x7fELF\x01\x02\x03", &["not text", "0x01"]);
    check_refused(&with_row("0.095,inf"), &["line 12", "theta", "inf", "delete that row"]);
    check_refused(&with_row("0.095,broken"), &["line 12", "theta", "broken", "delete that row"]);
    check_refused(&with_row("0.095"), &["line 12 has 1 field"]);
    check_refused(&with_row("0.095,1e999"), &["line 12", "1e999"]);
    let set_back = table("t,theta\n", |t, a| format!("{:.2},{a}", if t < 0.095 { t } else { t - 0.05 }));
    check_refused(&set_back, &["line 12", "from 0.09 s to 0.05 s", "split the file"]);
    check_refused(&with_row("0.09,0.1"), &["line 12", "0.09 s stands there twice", "--rate"]);
    check_refused(&table("t,theta\n", |t, a| format!("{t},{}", a * 60.0)), &["reach 60", "--degrees", "--radians"]);
    check_refused(&table("t,theta\n", |t, a| format!("{},{a}", t * 1e3)), &["step is 10 s", "t=0:ms"]);
    check_refused(&table("theta\n", |_, a| a.to_string()), &["no time column", "--rate"]);
    check_refused(&table("t,volts\n", |t, a| format!("{t},{a}")), &["no angle column", "t, volts", "--columns"]);
    check_refused(&table("t,theta1,theta2\n", |t, a| format!("{t},{a},{a}")), &["several", "theta1", "theta2"]);
    check_refused(&table("t,code\n", |t, a| format!("{t},{}", (900.0 * a) as i32)), &["counts a turn", "--zero"]);
}

#[test]
fn a_row_without_a_value_is_a_gap_that_is_told_with_its_place() {
    for (row, value) in [("0.095,nan", "nan"), ("0.095,", ""), ("0.095,NA", "NA"), ("nan,0.5", "nan")] {
        let recording = parse(&with_row(row)).unwrap();
        assert_eq!(recording.angles_rad(), parse(&plain()).unwrap().angles_rad(), "{row}");
        let column = if row.starts_with("nan") { "0 (t)" } else { "1 (theta)" };
        let told = format!("1 rows without a value are gaps, the first at line 12, column {column}: \"{value}\"");
        assert!(recording.notes().contains(&told), "{:?}", recording.notes());
    }
    let holes = table("t,theta\n", |t, a| if (0.1..0.145).contains(&t) { format!("{t},") } else { format!("{t},{a}") });
    let recording = parse(&holes).unwrap();
    assert_eq!((recording.len(), recording.gaps().len(), recording.gaps()[0].n_missing), (35, 1, Some(5)));
    // Between spaces an empty cell can't be seen.
    assert_eq!(parse(&holes.replace(',', " ")).unwrap().gaps(), recording.gaps());
    let rate = ReadOptions { rate_hz: Some(100.0), ..ReadOptions::default() };
    let recording = parse_with(&holes.replace("t,theta", "n,theta"), &rate).unwrap();
    assert_eq!((recording.len(), recording.gaps()[0].n_missing), (35, Some(5)));
}

#[test]
fn a_row_out_of_the_order_of_time_is_left_out_where_the_clock_goes_on() {
    let swing = parse(&plain()).unwrap();
    for (row, note) in [("0.05,0.1", "0.05 after 0.09"), ("7.5,0.1", "7.5 after 0.09")] {
        let recording = parse(&with_row(row)).unwrap();
        assert_eq!((recording.times_s(), recording.angles_rad()), (swing.times_s(), swing.angles_rad()), "{row}");
        let notes = recording.notes().join("; ");
        assert!(notes.contains("1 row is out of the order of time") && notes.contains(note), "{notes}");
    }
    // In the place of another one: a gap stays.
    let late =
        table(
            "t,theta\n",
            |t, a| if t == 0.1 { format!("0.08,{}", (8.0_f64 * 0.07).cos()) } else { format!("{t},{a}") },
        );
    let recording = parse(&late).unwrap();
    assert_eq!((recording.len(), recording.gaps()[0].n_missing), (39, Some(1)));
    // Joined recordings are two runs; a clock in milliseconds that was set back by two samples and a half is neither.
    let joined = format!("{}{}", plain(), plain().replace("t,theta\n", ""));
    check_refused(&joined, &["holds 2 runs", "--run 2"]);
    let set = |t: f64| if t < 0.2 { 5000.0 + 1e3 * t } else { 4975.0 + 1e3 * t };
    check_refused(&table("t,theta\n", |t, a| format!("{},{a}", set(t))), &["from 5190 to 5175,", "split the file"]);
}

#[test]
fn a_column_that_is_not_there_is_refused_with_those_there_are() {
    let message = parse_with(&plain(), &columns("t=0,theta=2")).unwrap_err();
    assert!(message.contains("no column 2") && message.contains("t, theta"), "{message}");
    let message = parse_with(&plain(), &columns("theta=phi")).unwrap_err();
    assert!(message.contains("no column \"phi\""), "{message}");
}

#[test]
fn what_a_board_without_its_crystal_recorded_is_doubted() {
    let doubts = |clock: &str| {
        let recording = parse(&format!("# format: pendulum-recording 1\n{clock}{}", plain())).unwrap();
        recording.notes().iter().filter(|note| note.starts_with("doubtful: recorded by a board")).count()
    };
    assert_eq!((doubts("# clock: internal\n"), doubts("")), (1, 0));
}

#[test]
fn missing_files_and_directories_are_named() {
    let missing = read(Path::new("no/such/swing.csv"), &ReadOptions::default()).unwrap_err();
    assert!(matches!(missing.fault, Fault::Missing), "{missing}");
    assert!(missing.to_string().contains("no/such/swing.csv"));
    let folder = tempfile::tempdir().unwrap();
    let directory = read(folder.path(), &ReadOptions::default()).unwrap_err();
    assert!(matches!(directory.fault, Fault::Directory), "{directory}");
}

#[test]
fn a_row_cut_off_while_it_was_written_is_left_out_with_a_note() {
    let text = plain();
    for n_lost in 1..=3 {
        let cut = format!("{}0.4,", &text);
        let recording = parse(&cut[..cut.len() - (n_lost - 1)]).unwrap();
        assert!((40..=41).contains(&recording.len()));
    }
    let recording = parse(&format!("{text}0.4,")).unwrap();
    assert_eq!(recording.len(), 40);
    assert!(recording.notes()[0].contains("line 42: cut off"), "{:?}", recording.notes());
}

#[test]
fn the_beginning_of_a_last_number_is_not_taken_for_the_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let angles_rad = (0..40).map(|i| (0.3 * f64::from(i)).cos()).collect();
    save(&Recording::uniform(100.0, angles_rad).unwrap(), &path, Existing::Keep).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for n_lost in 1..=6 {
        std::fs::write(&path, &whole[..whole.len() - n_lost]).unwrap();
        let read = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(read.len(), 39, "{n_lost} bytes lost");
        assert!(read.notes()[0].contains("cut off"));
    }
}

#[test]
fn a_doubled_row_is_left_out_with_a_note() {
    let text = plain();
    let third = text.lines().nth(3).unwrap();
    let recording = parse(&text.replacen(third, &format!("{third}\n{third}"), 1)).unwrap();
    assert_eq!(recording.len(), 40);
    assert!(recording.notes()[0].contains("stood there twice"), "{:?}", recording.notes());
}

#[test]
fn angles_of_more_than_half_a_turn_leave_a_note_about_degrees() {
    let recording = parse(&table("t,theta\n", |t, a| format!("{t},{}", 5.0 * a))).unwrap();
    assert!(recording.notes()[0].contains("--degrees"), "{:?}", recording.notes());
}

fn our_header() -> Header {
    Header {
        rate_hz: Some(200.0),
        firmware: Some("0.1.0".to_owned()),
        calibration: Some(Calibration { zero_code: 2048.0, radians_per_code: 0.001_448_74 }),
        cutoff_hz: Some(10.0),
        started: Some("2025-03-01T12:00:00Z".to_owned()),
        comment: Some("brass bush".to_owned()),
        ..Header::default()
    }
}

fn write_some(writer: &mut Writer, n_samples: u16) {
    for idx in 0..n_samples {
        let angle_rad = (f64::from(idx) * 0.04).cos();
        let code = (2048.0 + angle_rad / 0.001_448_74) as u16;
        writer.write(f64::from(idx) * 0.005, angle_rad, Some(code)).unwrap();
    }
}

#[test]
fn what_was_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (folder.path().join("a.csv"), folder.path().join("b.csv"));
    let mut writer = Writer::create(&first, &our_header(), Existing::Keep).unwrap();
    write_some(&mut writer, 500);
    writer.finish().unwrap();
    let recording = read(&first, &ReadOptions::default()).unwrap();
    assert_eq!(recording.header(), &Header { version: Some(1), ..our_header() });
    assert_eq!((recording.len(), recording.codes().unwrap().len()), (500, 500));
    assert!((recording.rate_hz() - 200.0).abs() < 1e-6);
    save(&recording, &second, Existing::Keep).unwrap();
    assert_eq!(fs::read(&first).unwrap(), fs::read(&second).unwrap());
}

#[test]
fn a_program_killed_while_writing_leaves_all_but_the_last_second() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("killed.csv");
    let mut writer = Writer::create(&path, &our_header(), Existing::Keep).unwrap();
    write_some(&mut writer, 1000);
    // Nothing is flushed on the way out of a killed program.
    std::mem::forget(writer);
    let recording = read(&path, &ReadOptions::default()).unwrap();
    assert!(recording.duration_s() >= 4.995 - 1.0, "{}", recording.duration_s());
    assert!(recording.gaps().is_empty());
}

#[test]
fn a_file_cut_anywhere_reads_back_or_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("whole.csv");
    let mut writer = Writer::create(&path, &our_header(), Existing::Keep).unwrap();
    write_some(&mut writer, 60);
    writer.finish().unwrap();
    let bytes = fs::read(&path).unwrap();
    for end in 0..bytes.len() {
        if let Ok(recording) = read_bytes("cut.csv", &bytes[..end], &ReadOptions::default()) {
            let last = recording.len() - 1;
            let expected = (last as f64 * 0.04).cos();
            assert!((recording.angles_rad()[last] - expected).abs() < 1e-6, "{end}");
        }
    }
}

#[test]
fn an_existing_file_is_only_replaced_when_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    fs::write(&path, "precious").unwrap();
    let refused = Writer::create(&path, &our_header(), Existing::Keep).unwrap_err();
    assert!(matches!(refused, WriteError::Exists { .. }));
    assert!(refused.to_string().contains("--force"), "{refused}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
    Writer::create(&path, &our_header(), Existing::Overwrite).unwrap().finish().unwrap();
    assert!(fs::read_to_string(&path).unwrap().starts_with("# format: pendulum-recording 1\n"));
}

#[test]
fn a_sample_that_could_not_be_read_back_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = Writer::create(&folder.path().join("x.csv"), &our_header(), Existing::Keep).unwrap();
    writer.write(0.0, 1.0, Some(1)).unwrap();
    assert!(writer.write(0.0, 1.0, Some(1)).is_err());
    assert!(writer.write(0.1, f64::NAN, Some(1)).is_err());
    assert!(writer.write(0.1, 1.0, None).is_err());
    assert_eq!(writer.n_samples(), 1);
}

#[test]
fn every_recording_that_comes_with_the_project_reads_and_is_healthy() {
    let folders = ["paper", "recordings/real", "recordings/hidden/p01", "recordings/hidden/p08"];
    let mut n_read = 0;
    for entry in folders.iter().flat_map(|folder| fs::read_dir(data(folder)).unwrap()) {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let is_recording =
            !path.components().any(|part| part.as_os_str() == "paper") || name.starts_with("reconstructed");
        if path.extension().is_some_and(|extension| extension == "csv") && is_recording {
            let recording = read(&path, &ReadOptions::default()).unwrap();
            assert_eq!(problems(&recording), [], "{name}");
            assert!(recording.notes().is_empty() && recording.gaps().is_empty(), "{name}");
            n_read += 1;
        }
    }
    assert_eq!(n_read, 2 + 4 + 3 + 3);
}

/// Whatever a stranger calls it, and whichever way it is told what a count is worth.
#[test]
fn a_reading_that_a_converter_lost_is_left_out_whatever_its_column_is_called() {
    let counts = |head: &str| {
        let count = |t: f64| (2048.0 + 900.0 * (-t / 10.0).exp() * (6.0 * t).cos()).round();
        let row = |idx: i32| format!("{},{}\n", 10 * idx, if idx == 333 { 0.0 } else { count(f64::from(idx) / 100.0) });
        format!("{head}{}", (0..1000).map(row).collect::<String>())
    };
    let told = ReadOptions { zero: Some(2048.0), ..columns("t=0:ms,theta=1:4096/turn") };
    let heads = ["adc", "code", "ADC_value", "pot", "counts"].map(|name| (format!("millis,{name}\n"), &told));
    let calibrated = "# zero_code: 2048\n# radians_per_code: 0.00153398\nmillis,adc\n".to_owned();
    for (head, options) in heads.into_iter().chain([(calibrated, &columns("t=0:ms"))]) {
        let recording = parse_with(&counts(&head), options).unwrap_or_else(|error| panic!("{head}: {error}"));
        assert_eq!(recording.len(), 999, "{head} {:?}", recording.notes());
        assert!(recording.angles_rad().iter().all(|angle| angle.abs() < 1.4), "{head}");
    }
}

#[test]
fn codes_of_the_simulated_rigs_become_angles() {
    let recording = read(&data("recordings/hidden/p01/release_1.csv"), &ReadOptions::default()).unwrap();
    // −0.41724 rad in the original, printed to five decimals: code 2048 − 288 at 340°/4096 a step.
    assert!((recording.angles_rad()[0] + 0.41724).abs() < 5e-6);
    assert_eq!(recording.codes().unwrap()[0], 1760);
    assert!((recording.rate_hz() - 200.0).abs() < 1e-6);
}

/// Bytes that come near a table: digits, separators, line ends and words, with anything in between.
fn near_tables() -> impl Strategy<Value = Vec<u8>> {
    let pieces = prop_oneof![
        4 => "[0-9]{1,3}(\\.[0-9]{1,4})?".prop_map(String::into_bytes),
        4 => "[,;\t \n\r\"#:=]".prop_map(String::into_bytes),
        1 => "(t|theta|code|nan|inf|-|1e999|# rate_hz: |# format: pendulum-recording )".prop_map(String::into_bytes),
        1 => proptest::collection::vec(any::<u8>(), 0..3),
    ];
    proptest::collection::vec(pieces, 0..400).prop_map(|pieces| pieces.concat())
}

fn check_never_panics(bytes: &[u8]) {
    let choices = [
        ReadOptions::default(),
        ReadOptions { rate_hz: Some(100.0), ..ReadOptions::default() },
        columns("t=0:ms,theta=1:deg"),
    ];
    for options in choices {
        match read_bytes("any.csv", bytes, &options) {
            Err(error) => assert!(!error.to_string().is_empty()),
            Ok(recording) => {
                let _ = problems(&recording);
                let _ = host::noise::estimate(&recording);
                let _ = host::recording::segment::segment(&recording, &Default::default());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(400) })]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        check_never_panics(&bytes);
    }

    #[test]
    fn bytes_near_a_table_never_panic(bytes in near_tables()) {
        check_never_panics(&bytes);
    }

    #[test]
    fn tables_of_arbitrary_numbers_never_panic(
        rows in proptest::collection::vec((1e-9_f64..1e3, proptest::num::f64::NORMAL | proptest::num::f64::ZERO), 16..80),
    ) {
        let mut time_s = 0.0;
        let text: String = rows.iter().map(|(step_s, angle)| { time_s += step_s; format!("{time_s},{angle}\n") }).collect();
        check_never_panics(format!("time (ms),angle (rad)\n{text}").as_bytes());
    }
}
