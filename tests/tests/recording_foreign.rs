//! Files of phones, cameras, encoders, spreadsheets and other programs: each is read rightly, or refused with the cure.
//!
//! `corpus/foreign` holds one swing in the dress of many; `make.py` there integrates and writes it.

use host::recording::{Measured, ReadOptions, Recording, read, read_bytes};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/foreign")
}

fn open(name: &str, options: &ReadOptions) -> Result<Recording, String> {
    read(&folder().join(name), options).map_err(|error| error.to_string())
}

fn columns(text: &str) -> ReadOptions {
    ReadOptions { columns: Some(text.parse().unwrap()), ..ReadOptions::default() }
}

fn zero(zero: f64) -> ReadOptions {
    ReadOptions { zero: Some(zero), ..ReadOptions::default() }
}

/// What a file must give: the swing of truth.csv within so many rad, and a note with these words if any.
struct Read {
    name: &'static str,
    options: ReadOptions,
    within_rad: f64,
    /// Of the 600 samples so many are gaps.
    n_missing: usize,
    note: &'static str,
}

fn good(name: &'static str, within_rad: f64, note: &'static str) -> Read {
    Read { name, options: ReadOptions::default(), within_rad, n_missing: 0, note }
}

/// The digits that are printed: half of the last one, and as much again.
const FIVE_OF_DEGREES: f64 = 2e-7;
const SEVEN: f64 = 1e-7;

fn read_rightly() -> Vec<Read> {
    let with = |name, options| Read { options, ..good(name, SEVEN, "") };
    vec![
        good("truth.csv", 1e-9, ""),
        good("phyphox_tilt.csv", 1e-8, ""),
        good("phyphox_semicolon.csv", 1e-8, ""),
        good("phyphox_tilt.zip", 1e-8, "Raw Data.csv read from the archive"),
        good("tracker_xy.txt", 2e-4, "angles from x and y, y counting up"),
        good("xy_bare.txt", 2e-4, "columns 1 and 2 lie on a circle"),
        good("tracker_theta.txt", 1e-6, "from the horizontal"),
        good("tracker_multi.txt", 1e-6, ""),
        good("pixels.csv", 2e-3, "y counting down: pivot at (3"),
        Read { options: columns("t=time,x=x_px,y=2"), ..good("pixels.csv", 2e-3, "y counting down") },
        Read {
            options: ReadOptions { pivot: Some([320.0, 60.0]), ..ReadOptions::default() },
            ..good("pixels.csv", 1e-4, "pivot at (320.0000, 60.0000)")
        },
        good("labview_one.lvm", 1e-7, ""),
        good("labview_no_x.lvm", 1e-7, ""),
        good("matlab_v6.mat", 1e-9, ""),
        good("matlab_v7.mat", 1e-9, ""),
        good("simulink.mat", 1e-9, ""),
        good("matlab_to_file.mat", 1e-9, "column 0 read as time"),
        good("matlab_matrix.mat", 1e-9, "column 0 read as time"),
        good(
            "matlab_names.mat",
            1e-9,
            "3 (angle) taken as the angle, whose name says nothing else, and not 1 (baseAngle)",
        ),
        good("matlab_cells.mat", 1e-9, ""),
        good("matlab_v4.mat", 1e-9, ""),
        good("matlab_v4_big.mat", 1e-9, "column 0 read as time"),
        good("lines.jsonl", 2e-8, ""),
        good("arrays.json", SEVEN, ""),
        good("workbook_tilt.xlsx", 1e-8, "sheet Raw Data read from the workbook"),
        good("workbook_97.xls", 1e-9, "sheet Raw Data read from the workbook, and not Autocorrelation, Resonance"),
        good("matrix.npy", 1e-9, "column 0 read as time"),
        good("named.npz", 1e-9, ""),
        good("iso.csv", SEVEN, ""),
        good("iso_space.txt", SEVEN, ""),
        good("german_dates.csv", FIVE_OF_DEGREES, ""),
        good("midnight.csv", SEVEN, "midnight"),
        good("epoch_ms.csv", SEVEN, "from 1970"),
        good("epoch_s.csv", SEVEN, "from 1970"),
        good("quoted_commas.csv", SEVEN, ""),
        good("grad.csv", FIVE_OF_DEGREES, ""),
        good("french.csv", FIVE_OF_DEGREES, ""),
        good("spanish.csv", FIVE_OF_DEGREES, ""),
        good("italian.csv", FIVE_OF_DEGREES, ""),
        good("thousands.csv", SEVEN, ""),
        good("thousands_german.csv", SEVEN, ""),
        good("thousands_swiss.csv", SEVEN, ""),
        Read { n_missing: 7, ..good("empty_cells.csv", SEVEN, "7 rows without a value are gaps, the first at line 7") },
        Read { n_missing: 7, ..good("nan_cells.csv", SEVEN, "column 1 (theta): \"NaN\"") },
        good("two_time_bases.csv", SEVEN, "0 (Time A (s)) taken"),
        good("two_rates_merged.csv", SEVEN, "600 rows without a value"),
        good("from_horizontal.csv", 2e-7, "from the horizontal"),
        good("from_upright.csv", 2e-7, "from upright"),
        good("wrapped_180.csv", 2e-7, "wraps around"),
        good("wrapped_360.csv", 2e-7, "wraps around"),
        with("odd_zero.csv", zero(0.7)),
        with("minutes_unsaid.csv", columns("t=0:min,theta=1")),
        with("milliseconds_unsaid.csv", columns("t=0:ms,theta=1")),
        good("milliseconds_unsaid.csv", SEVEN, "in milliseconds it swings"),
        Read {
            options: ReadOptions { angle_unit: Some(host::recording::AngleUnit::Radians), ..ReadOptions::default() },
            ..good("radians_named_degrees.csv", SEVEN, "")
        },
    ]
}

/// Files that are refused, each with words of the reason and of the cure.
const REFUSED: [(&str, &[&str]); 12] = [
    ("bare_gyroscope.csv", &["angular", "--columns t=0,rate=1:rad/s", "--radians"]),
    ("phi_punkt.csv", &["no angle column", "--columns theta="]),
    (
        "position_in_metres.csv",
        &["1 (Position (m)) is one coordinate of a point and no angle", "--columns t=0,theta=1:"],
    ),
    ("small_degrees.csv", &["--degrees", "period"]),
    ("radians_named_degrees.csv", &["--radians", "times as large"]),
    ("bare_commas.csv", &["twice as many fields", "semicolons"]),
    ("pixels_slanting.csv", &["off a circle", "square to the plane"]),
    ("pixels_short_arc.csv", &["--pivot", "short an arc"]),
    ("matlab_v73.mat", &["HDF5", "-v7"]),
    ("two_tables.zip", &["2 tables", "unpack it"]),
    ("workbook.xlsx", &["workbook", "save the sheet as CSV"]),
    ("minutes_unsaid.csv", &["unit of the time", "--columns t=0:ms"]),
];

/// Files that are read with a word of doubt.
const DOUBTED: [(&str, &str); 2] = [("odd_zero.csv", "--zero"), ("small_radians.csv", "--degrees")];

#[test]
fn each_file_is_the_swing_that_it_shows() {
    let truth = open("truth.csv", &ReadOptions::default()).unwrap();
    for Read { name, options, within_rad, n_missing, note } in read_rightly() {
        let recording = open(name, &options).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(recording.len(), truth.len() - n_missing, "{name}: {:?}", recording.notes());
        let begin_s = recording.times_s()[0];
        for (time_s, angle_rad) in recording.times_s().iter().zip(recording.angles_rad()) {
            let since_s = if name == "pixels.csv" { *time_s } else { time_s - begin_s };
            let idx = (since_s * 50.0).round() as usize;
            assert!((since_s - truth.times_s()[idx]).abs() < 2e-6, "{name}: {since_s} s");
            let off_rad = angle_rad - truth.angles_rad()[idx];
            assert!(off_rad.abs() <= within_rad, "{name} at {since_s} s: {angle_rad} rad, {off_rad:e} off");
        }
        let notes = recording.notes().join("; ");
        assert!(notes.contains(note), "{name}: {notes}");
        assert!(!note.is_empty() || notes.is_empty() || !options.eq_default(), "{name}: {notes}");
    }
}

trait EqDefault {
    fn eq_default(&self) -> bool;
}

impl EqDefault for ReadOptions {
    fn eq_default(&self) -> bool {
        format!("{self:?}") == format!("{:?}", Self::default())
    }
}

/// How far the rates, added up from the release, are from the angles of truth.csv at most, rad.
fn off_when_added_up(recording: &Recording) -> f64 {
    let truth = open("truth.csv", &ReadOptions::default()).unwrap();
    assert_eq!((recording.measured(), recording.len()), (Measured::Rate, truth.len()), "{:?}", recording.notes());
    let (times_s, rates) = (recording.times_s(), recording.angles_rad());
    let mut angle_rad = truth.angles_rad()[0];
    let mut off_rad = 0.0_f64;
    for idx in 1..recording.len() {
        angle_rad += (rates[idx] + rates[idx - 1]) / 2.0 * (times_s[idx] - times_s[idx - 1]);
        off_rad = off_rad.max((angle_rad - truth.angles_rad()[idx]).abs());
    }
    off_rad
}

/// The trapezoid's share of a cosine at 50 Hz is 1 − (ω·Δt)²/12 = 0.9987; the noise adds up to 1e-3 rad.
const ADDED_UP_RAD: f64 = 4e-3;

#[test]
fn a_gyroscopes_rates_stay_rates_by_name_by_header_and_as_told() {
    let phone = open("phyphox_gyroscope.csv", &ReadOptions::default()).unwrap();
    assert!(off_when_added_up(&phone) < ADDED_UP_RAD, "{}", off_when_added_up(&phone));
    let notes = phone.notes().join("; ");
    assert!(notes.contains("of 3 axes 1 (Gyroscope x (rad/s)) moves most"), "{notes}");
    let archive = open("phyphox_gyroscope.zip", &ReadOptions::default()).unwrap();
    assert_eq!(archive.measured(), Measured::Rate);
    assert_eq!((archive.times_s(), archive.angles_rad()), (phone.times_s(), phone.angles_rad()));
    let packed = archive.notes().join("; ");
    assert!(packed.contains("Raw Data.csv read from the archive") && packed.contains("moves most"), "{packed}");
    let told = open("bare_gyroscope.csv", &columns("t=0,rate=1:rad/s")).unwrap();
    assert!(off_when_added_up(&told) < ADDED_UP_RAD && told.notes().len() == 1, "{:?}", told.notes());
    let bare = std::fs::read_to_string(folder().join("bare_gyroscope.csv")).unwrap();
    for header in ["# measured: rate\n", "# measured = \"rate\"\n", "# measured=rate\nt,theta\n"] {
        let text = format!("{header}{bare}");
        let recording = read_bytes("bare.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
        assert!(off_when_added_up(&recording) < ADDED_UP_RAD, "{header}");
    }
}

#[test]
fn rates_in_degrees_are_told_from_rates_in_radians_by_the_fastest_fall() {
    let in_degrees = |name: &str| {
        let text = std::fs::read_to_string(folder().join("phyphox_gyroscope.csv")).unwrap();
        let rows = text.lines().skip(1).map(|row| {
            let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
            format!("{},{}", cells[0], cells[1].to_degrees())
        });
        format!("Time (s),{name}\n{}\n", rows.collect::<Vec<_>>().join("\n"))
    };
    let read = |name: &str, options: &ReadOptions| read_bytes("phone.csv", in_degrees(name).as_bytes(), options);
    let refused = read("gyro", &ReadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("lowest point") && refused.contains("rate=1:deg/s"), "{refused}");
    for (name, options) in [("gyro (deg/s)", ReadOptions::default()), ("gyro", columns("t=0,rate=1:deg/s"))] {
        let recording = read(name, &options).unwrap();
        assert!(off_when_added_up(&recording) < ADDED_UP_RAD, "{name}");
    }
    // And radians a second that are named degrees: the period grows as it does for rates 57 times as large.
    let text = std::fs::read_to_string(folder().join("phyphox_gyroscope.csv")).unwrap().replace("rad/s", "deg/s");
    let refused = read_bytes("phone.csv", text.as_bytes(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("radians a second") && refused.contains("rate=1:rad/s"), "{refused}");
}

/// `A exp(−t/40 s) cos ωt`: a wheel on a spiral spring, whose period never changes.
#[test]
fn a_torsion_pendulum_is_refused_by_its_rates_as_by_its_angles() {
    const AMPLITUDE_RAD: f64 = 2.4;
    const ANGULAR_HZ: f64 = 3.33;
    let times_s = || (0..900).map(|idx| f64::from(idx) * 0.1);
    let size = |time_s: f64| AMPLITUDE_RAD * (-time_s / 40.0).exp();
    let in_file = |name: &str, reading: &dyn Fn(f64) -> f64| {
        let rows: Vec<String> = times_s().map(|time_s| format!("{time_s:.1},{:.2}", reading(time_s))).collect();
        format!("t (s),{name}\n{}\n", rows.join("\n"))
    };
    let rate =
        |time_s: f64| -size(time_s) * ((ANGULAR_HZ * time_s).sin() * ANGULAR_HZ + (ANGULAR_HZ * time_s).cos() / 40.0);
    let in_radians = in_file("omega (rad/s)", &rate);
    let files = [
        in_file("theta (rad)", &|time_s| size(time_s) * (ANGULAR_HZ * time_s).cos()),
        in_radians.clone(),
        in_file("omega (deg/s)", &|time_s| rate(time_s).to_degrees()),
        in_file("omega", &rate),
    ];
    for text in files {
        let read = read_bytes("wheel.csv", text.as_bytes(), &ReadOptions::default());
        let refused = read.map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains("or a spring swings it and no gravity, as in a torsion pendulum"), "{refused}");
    }
    let told = read_bytes("wheel.csv", in_radians.as_bytes(), &columns("t=0,rate=1:rad/s")).unwrap();
    assert!(told.notes().iter().any(|note| note.starts_with("doubtful: ")), "{:?}", told.notes());
}

#[test]
fn what_would_be_read_wrongly_is_refused_with_the_cure() {
    for (name, words) in REFUSED {
        let message = open(name, &ReadOptions::default()).expect_err(name);
        assert!(message.contains(name), "{message}");
        for word in words {
            assert!(message.contains(word), "{name}: {word:?} is not in\n{message}");
        }
    }
}

#[test]
fn what_may_be_read_wrongly_is_said() {
    for (name, word) in DOUBTED {
        let recording = open(name, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let notes = recording.notes().join("; ");
        assert!(notes.contains(word), "{name}: {notes}");
    }
}

#[test]
fn every_file_of_the_folder_has_its_say() {
    let known: BTreeSet<String> = read_rightly()
        .iter()
        .map(|read| read.name)
        .chain(REFUSED.iter().map(|(name, _)| *name))
        .chain(DOUBTED.iter().map(|(name, _)| *name))
        .chain(["phyphox_gyroscope.csv", "phyphox_gyroscope.zip"])
        .map(str::to_owned)
        .collect();
    let there = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let there: BTreeSet<String> = there.filter(|name| name != "make.py").collect();
    assert_eq!(there, known);
    assert!(known.len() >= 40);
}

#[test]
fn an_endless_file_ends_at_a_named_limit() {
    let zeros = read(Path::new("/dev/zero"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(zeros.contains("/dev/zero") && zeros.contains("not text"), "{zeros}");
    let line = [b"t,theta\n0,".as_slice(), &vec![b'1'; 3 << 20]].concat();
    let message = read_bytes("line.csv", &line, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("too large") && message.contains("1 MB"), "{message}");
}
