//! One swing as microcontrollers, monitors, spreadsheets and plotting programs write it down: read rightly, or refused.
//!
//! The swing is integrated here: `θ̈ = −40 sin θ − 0.06 ω − 0.05 sgn ω`, let go at 1 rad, 100 samples a second.

use host::recording::segment::{SegmentOptions, Segments, segment};
use host::recording::{Measured, ReadOptions, Recording, read_bytes};

const RATE_HZ: usize = 100;

/// Time (s), angle (rad), angular velocity (rad/s).
type Row = (f64, f64, f64);

fn swing(rate_hz: usize, seconds: usize) -> Vec<Row> {
    swing_from(1.0, rate_hz, seconds)
}

/// Twenty steps of the classical fixed-step method a sample.
fn swing_from(start_rad: f64, rate_hz: usize, seconds: usize) -> Vec<Row> {
    let acceleration = |angle: f64, velocity: f64| {
        -40.0 * angle.sin() - 0.06 * velocity - 0.05 * if velocity == 0.0 { 0.0 } else { velocity.signum() }
    };
    let dt = 1.0 / (20 * rate_hz) as f64;
    let (mut angle, mut velocity) = (start_rad, 0.0_f64);
    let mut rows = Vec::new();
    for idx in 0..rate_hz * seconds {
        rows.push((idx as f64 / rate_hz as f64, angle, velocity));
        for _ in 0..20 {
            let (v1, a1) = (velocity, acceleration(angle, velocity));
            let (v2, a2) = (velocity + dt / 2.0 * a1, acceleration(angle + dt / 2.0 * v1, velocity + dt / 2.0 * a1));
            let (v3, a3) = (velocity + dt / 2.0 * a2, acceleration(angle + dt / 2.0 * v2, velocity + dt / 2.0 * a2));
            let (v4, a4) = (velocity + dt * a3, acceleration(angle + dt * v3, velocity + dt * a3));
            angle += dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            velocity += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
    }
    rows
}

fn table(head: &str, row: impl Fn(Row) -> String) -> String {
    format!("{head}{}", swing(RATE_HZ, 20).into_iter().map(|values| row(values) + "\n").collect::<String>())
}

fn open(text: &[u8], options: &ReadOptions) -> Result<Recording, String> {
    read_bytes("swing.csv", text, options).map_err(|error| error.to_string())
}

fn told(columns: &str) -> ReadOptions {
    ReadOptions { columns: Some(columns.parse().unwrap()), ..ReadOptions::default() }
}

/// Half a digit of the angle, and what the angle moves (6.3 rad/s at most) in half a digit of the time.
#[track_caller]
fn check(text: &str, options: &ReadOptions, within_rad: f64, note: &str) -> Recording {
    let recording = open(text.as_bytes(), options).unwrap_or_else(|error| panic!("{error}"));
    let truth = swing(RATE_HZ, 20);
    assert_eq!(recording.len(), truth.len(), "{:?}", recording.notes());
    let begin_s = recording.times_s()[0];
    for (idx, (time_s, angle_rad, _)) in truth.iter().enumerate() {
        let off_s = recording.times_s()[idx] - begin_s - time_s;
        let off_rad = recording.angles_rad()[idx] - angle_rad;
        assert!(
            off_s.abs() < 1e-3 && off_rad.abs() < within_rad,
            "{idx}: {off_s} s {off_rad} rad {:?}",
            recording.notes()
        );
    }
    let notes = recording.notes().join("; ");
    assert!(notes.contains(note), "{notes}");
    recording
}

#[track_caller]
fn check_found(text: &str, within_rad: f64, note: &str) -> Recording {
    check(text, &ReadOptions::default(), within_rad, note)
}

/// Half a hundredth of a degree.
const CENTIDEGREES: f64 = 1e-4;

#[test]
fn lines_of_serial_monitors_and_plotters_are_rows() {
    let ms = |t: f64| (1e3 * t).round();
    let (t_ms, deg) = ("in milliseconds", "read as degrees");
    let plotter = |(t, a, v): Row| format!("t:{} angle:{:.2} speed:{v:.1}", ms(t), a.to_degrees());
    check_found(&table("", plotter), CENTIDEGREES, t_ms);
    let words = |(t, a, _): Row| format!("Time: {} ms, Angle = {:.2} deg", ms(t), a.to_degrees());
    check_found(&table("Sensor ready\nlet it go!\n", words), CENTIDEGREES, "");
    let own_time = |(t, a, _): Row| format!("12:34:{:06.3} -> {},{:.2}", 5.0 + t * 1.001, ms(t), a.to_degrees());
    check_found(&table("", own_time), CENTIDEGREES, deg);
    let monitors_time = |(t, a, _): Row| format!("12:34:{:06.3} -> {:.2}", 5.0 + t, a.to_degrees());
    check_found(&table("", monitors_time), CENTIDEGREES, deg);
    check_found(&table("", |(t, a, _)| format!("({t:.2}, {a:.5})")), 1e-5, "column 0 read as time");
    let nested = |(t, a, _): Row| format!("{{\"ts\": {}, \"imu\": {{\"angle\": {a:.5}}}}}", 1.7e12 + ms(t));
    check_found(&table("", nested), 1e-5, "1970");
}

#[test]
fn words_between_the_rows_and_units_in_the_cells_are_no_numbers() {
    let plain = table("time,angle\n", |(t, a, _)| format!("{t:.2},{a:.5}"));
    check_found(&format!("{plain}Done. 2000 samples\nbye\n"), 1e-5, "2 lines without any number left out");
    check_found(&table("time,angle\n", |(t, a, _)| format!("{t:.2} s,{:.2} deg", a.to_degrees())), CENTIDEGREES, "");
    // Small swings in degrees, which nothing but the sign in the cells tells.
    let small = swing_from(0.05, RATE_HZ, 5).into_iter().map(|(t, a, _)| format!("{t:.2},{:.3}°\n", a.to_degrees()));
    let small = format!("time,angle\n{}", small.collect::<String>());
    let recording = open(small.as_bytes(), &ReadOptions::default()).unwrap();
    assert!((recording.angles_rad()[0] - 0.05).abs() < 1e-5, "{:?}", recording.notes());
}

#[test]
fn the_unit_of_the_time_is_the_one_in_which_a_pendulum_swings_so() {
    for (factor, name) in [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds")] {
        let text = table("", |(t, a, _)| format!("{},{a:.5}", (7.0 + factor * t).round()));
        check_found(&text, 1e-5, name);
    }
    let days = |(t, a, _): Row| format!("{};{}", 46_082.5 + t / 86_400.0, a.to_degrees()).replace('.', ",");
    check_found(&table("Datum;Winkel (°)\n", days), 1e-9, "in days");
    // A pendulum of 17 s, a sample a second: in no other unit would that be one.
    let slow = swing(RATE_HZ, 20).into_iter().step_by(6).enumerate().map(|(idx, (_, a, _))| format!("{idx},{a:.5}\n"));
    let slow = open(slow.collect::<String>().as_bytes(), &ReadOptions::default()).unwrap();
    assert!(slow.notes().join("; ").contains("in seconds") && slow.step_s() == 1.0, "{:?}", slow.notes());
    // Time since the start-up of a microcontroller is no year, however many microseconds have gone by.
    let long_on = table("", |(t, a, _)| format!("{},{a:.5}", (9e8 + 1e6 * t).round()));
    check_found(&long_on, 1e-5, "microseconds");
}

#[test]
fn counters_that_begin_anew_go_on() {
    let wrapped = |bits: u32| {
        move |(t, a, _): Row| {
            let range = 1_i64 << bits;
            format!("{},{a:.5}", (range - 4000 + (1e3 * t).round() as i64) % range)
        }
    };
    check_found(&table("ms,rad\n", wrapped(16)), 1e-5, "counts of 16 bits that begin anew 1 times");
    check_found(&table("ms,rad\n", wrapped(32)), 1e-5, "counts of 32 bits");
    let signed =
        |(t, a, _): Row| format!("{},{a:.5}", ((28_000 + (1e3 * t).round() as i64 + 32_768) % 65_536) - 32_768);
    check_found(&table("ms,rad\n", signed), 1e-5, "16 bits");
    // An encoder about the zero of its counter, and one of 12 bits about its own zero.
    let counts = |range: i64| {
        move |(t, a, _): Row| format!("{t},{}", ((a * 8192.0 / std::f64::consts::TAU).round() as i64).rem_euclid(range))
    };
    let half_a_count = 4e-4;
    check(&table("t,counts\n", counts(65_536)), &told("theta=counts:8192/turn"), half_a_count, "begin anew");
    check(&table("t,counts\n", counts(8192)), &told("theta=counts:8192/turn"), half_a_count, "wraps around");
}

#[test]
fn a_clock_coarser_than_the_samples_is_spread_and_a_stopped_one_refused() {
    let seconds = table("time,angle\n", |(t, a, _)| format!("12:00:{:02},{a:.5}", t as u32));
    check_found(&seconds, 1e-5, "coarser than the samples");
    let fast: Vec<Row> = swing(3000, 8);
    let text: String = fast.iter().map(|(t, a, _)| format!("{},{a:.5}\n", (1e3 * t) as u64)).collect();
    let recording = open(format!("ms,rad\n{text}").as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(recording.len(), fast.len());
    let off_s = recording.times_s().iter().zip(&fast).map(|(time_s, row)| (time_s - row.0).abs()).fold(0.0, f64::max);
    assert!(off_s < 4e-4, "{off_s}");
    // Two decimals are too few for 200 samples a second.
    let fast: Vec<Row> = swing(200, 20);
    let text: String = fast.iter().map(|(t, a, _)| format!("{t:.2},{:.5}\n", a.to_degrees())).collect();
    let recording = open(format!("t,deg\n{text}").as_bytes(), &ReadOptions::default()).unwrap();
    let begin_s = recording.times_s()[0];
    let off_s = recording.times_s().iter().zip(&fast).map(|(time_s, row)| (time_s - begin_s - row.0).abs());
    assert!(recording.len() == fast.len() && off_s.fold(0.0, f64::max) < 2e-4, "{:?}", recording.notes());
    let stopped = table("t,theta\n", |(t, a, _)| format!("{:.2},{a:.5}", t.min(15.0)));
    let refused = open(stopped.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("15 s stands there 500 times in a row") && refused.contains("--rate"), "{refused}");
}

/// As a spreadsheet writes them, `1.87E+01`: a tenth of a second from 10 s on, and a second from 100 s on.
#[test]
fn times_of_three_digits_are_even_again_with_names_and_without() {
    let rows = swing(RATE_HZ, 130);
    for head in ["", "x y dx dy\n", "t theta e1 e2\n"] {
        let text: String = rows.iter().map(|(t, a, _)| format!("{:.2e}\t{a:.5}\t0.02\t0.05\n", 11.3 + t)).collect();
        let recording = open(format!("{head}{text}").as_bytes(), &ReadOptions::default()).unwrap();
        let begin_s = recording.times_s()[0];
        let off_s = recording.times_s().iter().zip(&rows).map(|(time_s, row)| (time_s - begin_s - row.0).abs());
        // Which way a five is rounded, of the ten rows of a tick, is worth half a row.
        assert!(recording.len() == rows.len() && off_s.fold(0.0, f64::max) < 1e-2, "{:?}", recording.notes());
        assert!(recording.notes().iter().any(|note| note.contains("rounded to 3 digits")), "{:?}", recording.notes());
    }
}

#[test]
fn a_quantity_a_line_is_turned_and_a_table_of_thousands_of_columns_refused() {
    let rows = swing(RATE_HZ, 20);
    let line = |of: fn(&Row) -> f64| rows.iter().map(|row| format!("{:.5}", of(row))).collect::<Vec<_>>().join(",");
    let (times, angles) = (line(|row| row.0), line(|row| row.1));
    check_found(&format!("{times}\n{angles}\n"), 1e-5, "a quantity a line");
    check_found(&format!("time,{times}\nspeed,{}\nangle,{angles}", line(|row| row.2)), 1e-5, "a quantity a line");
    let wide: String = (0..20).map(|_| format!("{times}\n")).collect();
    let refused = open(wide.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("2000 columns"), "{refused}");
}

#[test]
fn a_project_of_another_program_is_named_with_what_to_export() {
    for head in ["<?xml version=\"1.0\"?>\n<object class=\"TrackerPanel\">\n", "\u{feff}<!DOCTYPE html>\n<html>\n"] {
        let text = table(head, |(t, a, _)| format!("<point>{t:.2}, {a:.5}</point>"));
        let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("XML") && refused.contains("Tracker"), "{refused}");
    }
}

#[test]
fn of_several_angles_the_one_that_names_the_pendulum_is_taken() {
    let cart = |(t, a, _): Row| format!("{t:.2},{:.5},{a:.5}", 0.3 - 0.01 * a);
    for head in ["Time,CartPos,PendPos\n", "t,arm_angle,pendulum_angle\n", "time,angle,Pendelwinkel\n"] {
        check_found(&table(head, cart), 1e-5, "by its name");
    }
    check_found(&table("t,motor_angle,link_angle\n", cart), 1e-5, "by its name");
    let refused = open(table("t,angle_a,angle_b\n", cart).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("several columns could be the angle"), "{refused}");
}

#[test]
fn of_names_alike_the_column_that_moves_is_the_angle() {
    let arm = table("t,theta_1,theta_2\n", |(t, a, _)| format!("{t:.2},0.0,{a:.5}"));
    check_found(&arm, 1e-5, "2 (theta_2) taken as the angle, because 1 (theta_1) never moves");
    // At rest for longer than the lines that are looked at first, beside one that drifts.
    let late = |(t, a, _): Row| (t, if t < 3.0 { 1.0 } else { a });
    let late = |row: Row| format!("{:.2},{:.5},{:.5},{:.5}", late(row).0, 0.2 * late(row).0, late(row).1, 0.01 * row.1);
    let body = open(table("t,yaw,pitch,roll\n", late).as_bytes(), &ReadOptions::default()).unwrap();
    assert!(body.notes().join("; ").contains("of 3 angles of the sensor 2 (pitch) moves most"), "{:?}", body.notes());
    assert!((body.angles_rad()[0] - 1.0).abs() < 1e-5);
    let both = table("t,theta_1,theta_2\n", |(t, a, _)| format!("{t:.2},{:.5},{a:.5}", 0.1 * a));
    let refused = open(both.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("several columns could be the angle: 1 (theta_1), 2 (theta_2)"), "{refused}");
}

#[test]
fn an_arm_that_is_held_and_a_run_that_was_never_made_are_no_rivals() {
    let held = table("t,joint0_position,joint1_position\n", |(t, a, _)| format!("{t:.2},{:.5},{a:.5}", 0.3 + 2e-3 * a));
    check_found(&held, 1e-5, "2 (joint1_position) taken as the angle, because 1 (joint0_position) hardly moves");
    let other_unit = table("t,theta1 (rad),theta2 (deg)\n", |(t, a, _)| format!("{t:.2},{a:.5},{:.4}", 115.0 * a));
    let refused = open(other_unit.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("several columns could be the angle"), "{refused}");
    let empty = table("Run 1:Time(s),Run 1:Angle(rad),Run 2:Time(s),Run 2:Angle(rad)\n", |(t, a, _)| {
        format!("{t:.2},{a:.5},,")
    });
    check_found(&empty, 1e-5, "");
}

#[test]
fn x_and_y_are_read_where_the_angle_was_never_worked_out() {
    let point = |(t, a, _): Row| format!("{t:.2},{:.4},{:.4},0.0", 640.0 + 300.0 * a.sin(), 100.0 + 300.0 * a.cos());
    check_found(
        &table("time,x,y,theta\n", point),
        1e-4,
        "3 (theta) does not move: x and y of the point are read instead",
    );
}

#[test]
fn settings_beside_the_columns_are_no_angle() {
    let settings = ["Record Length,2000,,", "Sample Interval,0.01,,", "Source,CH1,,"];
    let beside = |settings: &[&str]| -> String {
        let rows = swing(RATE_HZ, 20).into_iter().enumerate();
        rows.map(|(idx, (t, a, _))| format!("{}{t:.2},{a:.5},\n", settings.get(idx).unwrap_or(&",,,"))).collect()
    };
    check_found(&beside(&settings), 1e-5, "column 3 read as time");
    let in_volts = beside(&[&settings[..], &["Vertical Units,V,,"]].concat());
    let refused = open(in_volts.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("--columns t=3,theta=4:54.5deg") && refused.contains("--zero"), "{refused}");
    check(&in_volts, &told("t=3,theta=4:57.29578deg"), 2e-5, "");
}

#[test]
fn volts_counts_and_quaternions_are_refused_with_what_to_tell() {
    let two = |(t, a, _): Row| format!("{t:.2},{:.4}", 1.65 + a);
    for head in
        ["Time(s),CH1(V)\n", "x-axis,1\nsecond,Volt\n", "Time,Channel A\n(s),(V)\n\n", "Source,CH1\nSecond,Volt\n"]
    {
        let refused = open(table(head, two).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("t=0,theta=1:54.5deg") && refused.contains("--zero"), "{refused}");
    }
    let counts = table("micros,counts\n", |(t, a, _)| format!("{},{}", (1e6 * t).round(), (650.0 * a).round()));
    let refused = open(counts.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("--columns t=0,theta=1:4096/turn"), "{refused}");
    check(&counts, &told("t=0,theta=1:4084.07/turn"), 1e-3, "");
    let turned = |(t, a, _): Row| format!("{t:.2},{:.5},{:.5},0,0", (a / 2.0).cos(), (a / 2.0).sin());
    let refused = open(table("timestamp,qw,qx,qy,qz\n", turned).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("quaternion") && refused.contains("roll, pitch, yaw"), "{refused}");
}

#[test]
fn a_name_that_says_nothing_is_the_angles_where_nothing_else_was_measured() {
    let epoch = |t: f64| 1_700_000_000_000_000_000_u64 + (1e9 * t).round() as u64;
    let topic = table("%time,field.data\n", |(t, a, _)| format!("{},{a:.5}", epoch(t)));
    check_found(&topic, 1e-5, "1 (field.data) says nothing else and is read as the angle");
    let database = |(t, a, _): Row| {
        let day = "2026-03-01T";
        format!(",,0,{day}09:00:00Z,{day}11:00:00Z,{day}10:00:{t:06.3}Z,{a:.5},angle,rig")
    };
    let head = ",result,table,_start,_stop,_time,_value,_field,_measurement\n";
    check_found(&table(head, database), 1e-5, "6 (_value) says nothing else");
    check_found(&table("tout,simout\n", |(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, "1 (simout) says nothing else");
    let three = |(t, a, v): Row| format!("{t:.2},{a:.5},{v:.5}");
    for head in ["t,data,value\n", "t,data,temperature\n"] {
        let refused = open(table(head, three).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("no angle column"), "{refused}");
    }
}

#[test]
fn omega_about_three_axes_is_a_gyroscopes() {
    let text = table("time,wx,wy,wz\n", |(t, _, v)| format!("{t:.2},{:.5},{v:.5},0.001", 0.01 * v));
    let phone = open(text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(phone.measured(), Measured::Rate);
    assert!((phone.angles_rad()[25] - swing(RATE_HZ, 1)[25].2).abs() < 1e-5, "{:?}", phone.notes());
}

#[test]
fn when_it_was_measured_is_the_time_and_not_when_it_arrived() {
    let late = |t: f64| 3e-3 * (1.0 + (77.0 * t).sin());
    let row = |(t, a, _): Row| format!("{:.6},{:.9},{a:.5}", 1.7e9 + t + late(t), 1.7e9 + t);
    let text = table("__time,/joint_states/header/stamp,/joint_states/pendulum/position\n", row);
    check_found(
        &text,
        1e-5,
        "1 (/joint_states/header/stamp) taken as the time, when it was measured, and not 0 (__time)",
    );
    // Nobody filled it in.
    let unset = table("%time,field.header.stamp,field.position\n", |(t, a, _)| format!("{:.6},0,{a:.5}", 1.7e9 + t));
    check_found(&unset, 1e-5, "from 1970");
}

#[test]
fn quotes_around_names_are_no_derivatives_and_brackets_around_clocks_fall_off() {
    check_found(&table("/'Swing'/'Time',/'Swing'/'Angle'\n", |(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, "");
    check_found(&table("", |(t, a, _)| format!("[2026-03-01 12:00:{t:06.3}] {a:.5}")), 1e-5, "");
}

#[test]
fn rows_and_columns_of_json_are_found_however_they_lie() {
    let rows = swing(RATE_HZ, 20);
    let list = |row: &dyn Fn(&Row) -> String| rows.iter().map(row).collect::<Vec<_>>().join(", ");
    let pairs = list(&|(t, a, _)| format!("[{t:.2}, {a:.5}]"));
    let objects = list(&|(t, a, _)| format!("{{\"t\": {t:.2}, \"theta\": {a:.5}}}"));
    let axes = list(&|(t, a, v)| format!("{{\"t\": {t:.2}, \"theta\": {a:.5}, \"acc\": [{v:.3}, 0.1, 9.8]}}"));
    let (times, angles) = (list(&|row| format!("{:.2}", row.0)), list(&|row| format!("{:.5}", row.1)));
    for (text, note) in [
        (format!("[{pairs}]"), "column 0 read as time"),
        (format!("[[\"t\", \"theta\"], {pairs}]"), ""),
        (format!("[[{times}], [{angles}]]"), "column 0 read as time"),
        (format!("{{\"rig\": \"a\", \"samples\": [{objects}]}}"), ""),
        (format!("{{\"run\": {{\"time\": [{times}], \"angle\": [{angles}]}}, \"mass\": 0.1}}"), ""),
        (format!("[{axes}]"), ""),
        (axes.replace("}, {", "}\n{"), ""),
    ] {
        check_found(&text, 1e-5, note);
    }
}

#[test]
fn what_is_known_and_not_read_is_named_with_the_cure() {
    let cases: [(&[u8], &str, &str); 6] = [
        (b"\x80\x04\x95\x10", "pickle", "numpy.savetxt"),
        (b"PAR1\x15\x04", "Parquet", "to_csv"),
        (b"#ROSBAG V2.0\n\x00", "bag of ROS", "rostopic echo -p"),
        (b"\x1f\x8b\x08\x00", "gzip", "unpack it first"),
        (b"\x00\x00\x00\x20ftypisom", "video", "Tracker"),
        (b"TDSm\x0e\x00", "TDMS", ".lvm"),
    ];
    for (bytes, what, cure) in cases {
        let refused = open(&[bytes, &[0; 600]].concat(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains(what) && refused.contains(cure), "{refused}");
    }
}

#[test]
fn a_rate_that_is_told_stands_for_the_x_of_a_plot() {
    let options = ReadOptions { rate_hz: Some(100.0), ..ReadOptions::default() };
    let text = table("x y dx dy\n", |(t, a, _)| format!("{t:.2}\t{a:.5}\t0.02\t0.01"));
    check(&text, &options, 1e-5, "0 (x) goes on evenly: left out where the rate is told, and 1 (y) as the angle");
}

/// A spreadsheet keeps three digits from 9.03 s on: some rows are finer than the first lines that are looked at, others
/// coarser.
#[test]
fn times_whose_digits_become_coarser_among_the_first_rows_are_those_of_a_plot() {
    let rows = swing(RATE_HZ, 40);
    let text: String = rows.iter().map(|(t, a, _)| format!("{:.2e}\t{a:.5}\t0.02\t0.05\n", 9.03 + t)).collect();
    let recording = open(format!("x y dx dy\n{text}").as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(recording.len(), rows.len());
    let begin_s = recording.times_s()[0];
    let off_s = recording.times_s().iter().zip(&rows).map(|(time_s, row)| (time_s - begin_s - row.0).abs());
    assert!(off_s.fold(0.0, f64::max) < 1e-2, "{:?}", recording.notes());
}

#[test]
fn bare_axes_are_rates_where_the_file_is_a_gyroscopes_and_no_point_where_it_is_not() {
    let epoch = |t: f64| 1_700_000_000_000_000_000_u64 + (1e9 * t).round() as u64;
    let row = |(t, _, v): Row| format!("{},{t:.2},{v:.5},{:.5},{:.5}", epoch(t), 0.01 * v, -0.02 * v);
    let text = table("time,seconds_elapsed,z,y,x\n", row);
    let phone = read_bytes("Gyroscope.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(phone.measured(), Measured::Rate);
    let truth = swing(RATE_HZ, 20);
    let off = |idx: usize| phone.angles_rad()[idx] - truth[idx].2;
    assert!((0..truth.len()).all(|idx| off(idx).abs() < 1e-5), "{:?}", phone.notes());
    let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("the axes of a gyroscope") && refused.contains("t=1,rate=2"), "{refused}");
}

#[test]
fn settings_above_the_rows_are_none_of_them() {
    let lone = table("trigger_deg, sample_rate, duration\n90, 100, 20\n", |(_, a, _)| format!("{a:.5}"));
    check_found(&lone, 1e-5, "\"90, 100, 20\" above the table are settings, no row, with 100 samples a second");
    let named = table("rate,seconds\n100,20\nt,theta\n", |(t, a, _)| format!("{t:.2},{a:.5}"));
    check_found(&named, 1e-5, "\"100,20\" above the table are settings, no row");
}

#[test]
fn times_since_the_row_before_are_added_up() {
    // Milliseconds that scatter by one as rounded steps do; the sum is off by half a one at most.
    let ms = |t: f64| (1000.0 * t + 3.0 * (7.0 * t).sin()).round();
    let steps = table("angle,elapsed\n", |(t, a, _)| format!("{a:.5},{}", ms(t + 0.01) - ms(t)));
    let recording = open(steps.as_bytes(), &ReadOptions::default()).unwrap();
    let notes = recording.notes().join("; ");
    assert!(notes.contains("the time since the row before: added up") && notes.contains("in milliseconds"), "{notes}");
    let (first_s, last_s) = (recording.times_s()[0], recording.times_s()[1999]);
    assert!((last_s - first_s - 19.99).abs() < 0.01, "{first_s} {last_s}");
}

#[test]
fn periods_of_a_light_gate_are_named_as_such() {
    let text: String = (1..40).map(|idx| format!("{:.6}\t2.133149\t0.031032\n", f64::from(idx) * 1.0665)).collect();
    let text = format!("#Time\tPeriod\tTransit time\n#[s]\t[s]\t[s]\n{text}");
    let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("light gate") && refused.contains("record the angle"), "{refused}");
}

#[test]
fn counts_and_volts_are_told_by_what_one_is_worth() {
    let counts = table("time_ms,encoder\n", |(t, a, _)| {
        format!("{},{}", (1e3 * t).round(), (a * 2400.0 / std::f64::consts::TAU).round())
    });
    let refused = open(counts.as_bytes(), &told("theta=encoder")).unwrap_err();
    assert!(refused.contains("4096/turn"), "{refused}");
    check(&counts, &told("theta=encoder:2400/turn"), 1.4e-3, "");
    check(&counts, &told("theta=encoder:0.15deg"), 1.4e-3, "");
    let volts = table("t,pot (V)\n", |(t, a, _)| format!("{t},{:.5}", 1.65 + a.to_degrees() / 54.5));
    let options = ReadOptions { zero: Some(1.65), ..told("t=0,theta=1:54.5deg") };
    check(&volts, &options, 1e-5, "");
}

#[test]
fn the_right_columns_are_taken_whatever_stands_beside_them() {
    check_found(&table("", |(t, a, _)| format!("{a:.5},{t:.2}")), 1e-5, "column 1 read as time");
    let cart = |(t, a, v): Row| format!("{t:.2},{:.5},{:.5},{a:.5},{v:.5},0", 0.01 * a, 0.01 * v);
    check_found(&table("time,cart_pos,cart_vel,pole_angle,pole_vel,force\n", cart), 1e-5, "");
    let greek = |(t, a, _): Row| format!("{t:.2}\t{:.2}", a.to_degrees()).replace('.', ",");
    check_found(&table("t / s\tα / °\n", greek), CENTIDEGREES, "");
    // Names between spaces above columns between tabs; x and y of the bob stand before the angle.
    let tabs = |(t, a, _): Row| format!("{t:.2}\t{:.5}\t{:.5}\t{a:.5}", 0.25 * a.sin(), -0.25 * a.cos());
    let recording = check_found(&table("time x y theta\n", tabs), 1e-5, "");
    assert!(recording.notes().is_empty(), "{:?}", recording.notes());
    for head in ["x y dx dy\n", "x\ty\tdx\tdy\n"] {
        let plotted = |(t, a, _): Row| format!("{t:.2}\t{a:.5}\t0.02\t0.01");
        check_found(&table(head, plotted), 1e-5, "0 (x) goes on evenly: read as the time");
    }
    let six = |(t, a, v): Row| format!("{t:.2},{:.3},{:.3},0.02,0.1,-0.2,{v:.5}", 9.81 * a.sin(), 9.81 * a.cos());
    let imu = open(table("time,ax,ay,az,gx,gy,gz\n", six).as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(imu.measured(), Measured::Rate);
    assert!((imu.angles_rad()[25] - swing(RATE_HZ, 1)[25].2).abs() < 1e-5, "{:?}", imu.notes());
    for (head, unit) in [("Tempo (s);Ângulo (graus)\n", 1.0), ("Tijd;Hoek [graden]\n", 1.0), ("时间(s);角度(°)\n", 1.0)]
    {
        check_found(&table(head, |(t, a, _)| format!("{t:.2};{:.3}", unit * a.to_degrees())), CENTIDEGREES, "");
    }
}

#[test]
fn a_magnetometer_beside_the_angle_is_neither_time_nor_point() {
    let three = |(t, a, v): Row| format!("{t:.2},{:.2},{:.2},{:.3}", 40.0 + v, 30.0 * a, a.to_degrees());
    for head in ["Time (s),Magnetic Field x (µT),Magnetic Field y (µT),Angle (°)\n", "t_s,mx_uT,B (T),angle_deg\n"] {
        let recording = check_found(&table(head, three), CENTIDEGREES, "");
        assert!(recording.notes().is_empty(), "{:?}", recording.notes());
    }
    let alone = table("Time (s),Magnetic Field x (µT),Magnetic Field y (µT),T (°C)\n", three);
    let refused = open(alone.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("no angle column"), "{refused}");
    let rates = table("t_s,mx_uT,gx_dps\n", |(t, a, v)| format!("{t:.2},{:.2},{:.4}", 30.0 * a, v.to_degrees()));
    let rates = open(rates.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(rates.measured(), Measured::Rate);
    assert!((rates.angles_rad()[25] - swing(RATE_HZ, 1)[25].2).abs() < 1e-5, "{:?}", rates.notes());
}

#[test]
fn accelerations_are_refused_with_what_to_record_instead() {
    let three = |(t, a, v): Row| format!("{t:.2},{:.4},{:.4},{:.4}", 9.81 * a.sin(), 9.81 * a.cos(), 0.1 * v);
    let phone = "Time (s),Acceleration x (m/s^2),Acceleration y (m/s^2),Absolute acceleration (m/s^2)\n";
    for head in [phone, "t_s,ax_g,ay_g,az_g\n", "Zeit (s),Beschleunigung x (m/s²),Beschleunigung y (m/s²),Betrag\n"] {
        let refused = open(table(head, three).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("accelerations, which can't be fitted") && refused.contains("gyroscope"), "{refused}");
    }
}

#[test]
fn a_clock_stands_behind_an_angle_that_is_held_at_first() {
    let held = (0..300).map(|idx| (f64::from(idx) / 100.0, 1.0));
    let rows = held.chain(swing(RATE_HZ, 20).into_iter().map(|(t, a, _)| (3.0 + t, a)));
    let creeping = |t: f64, a: f64| if t < 3.0 && t > 1.0 { a + 0.001 } else { a };
    for creeps in [false, true] {
        let angle = |t: f64, a: f64| if creeps { creeping(t, a) } else { a };
        let text: String =
            rows.clone().map(|(t, a)| format!("{:.4},0.0,{}\n", angle(t, a), 272_900.0 + 1e3 * t)).collect();
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let notes = recording.notes().join("; ");
        assert!(notes.contains("column 2 read as time"), "{notes}");
        assert!((recording.angles_rad()[325] - swing(RATE_HZ, 1)[25].1).abs() < 1e-4, "{notes}");
    }
}

#[test]
fn names_and_units_are_found_however_the_lines_above_part_them() {
    let tabs = |(t, a, v): Row| format!("{t:.2}\t{:.3}\t{v:.3}", a.to_degrees());
    let commented = "#Logger: 3\n#Time A\tAngle A\tSpeed A\n#[s]\t[deg]\t[au]\n";
    let blank = "# Time (s)\tAngle (deg)\tSpeed\n#\n";
    for head in [commented, blank, "--- Pendulum ---\nTime (s),Angle (deg),Speed\n", "Time;Angle;Speed\ns;deg;au\n"] {
        let recording = check_found(&table(head, tabs), CENTIDEGREES, "");
        assert!(recording.notes().is_empty(), "{head}: {:?}", recording.notes());
    }
    let commas = |(t, a, v): Row| format!("{t:.2},{:.3},{v:.3}", a.to_degrees());
    check_found(&table("Time,Angle,State of it\ns,deg,State\n\n", commas), CENTIDEGREES, "");
    // What a terminal shows before the first row is no line of names.
    check_found(&table("ready\n[ dpc ] >>> 7.5,1.25,0.1\n", commas), CENTIDEGREES, "column 0 read as time");
}

#[test]
fn two_columns_that_lie_on_a_circle_at_first_only_are_no_point() {
    let beside =
        |(t, a, _): Row| format!("{t:.2},{a:.6},{:.6}", if t < 5.0 { 1.0 - (1.0 - a * a / 1.44).sqrt() } else { 0.3 });
    let recording = check_found(&table("", beside), 1e-5, "column 0 read as time");
    assert!(!recording.notes().join("; ").contains("circle"), "{:?}", recording.notes());
}

#[test]
fn what_could_be_told_names_columns_of_this_very_file() {
    let five = |(t, a, v): Row| format!("0,{a:.5},7,{v:.5},{t:.2}");
    let refused = |head: &str, options: &ReadOptions| open(table(head, five).as_bytes(), options).unwrap_err();
    let angles = refused("a,theta1,b,theta2,t\n", &ReadOptions::default());
    assert!(angles.contains("e.g. t=4,theta=1 or t=4,theta=3"), "{angles}");
    let times = refused("Time A,b,c,d,Time B\n", &told("x=1,y=3"));
    assert!(times.contains("e.g. t=0,theta=1 or t=4,theta=1"), "{times}");
    let unknown = refused("a,theta1,b,c,t\n", &told("theta=9"));
    assert!(unknown.contains("no column 9") && unknown.contains("e.g. t=4,theta=1"), "{unknown}");
    let still = refused("a,b,theta,c,t\n", &ReadOptions::default());
    assert!(still.contains("2 (theta) does not move") && still.contains("e.g. t=4,theta=1"), "{still}");
    let counted = table("n,t,theta,c\n", |(t, a, _)| format!("{:.0},{t:.2},0,{a:.5}", 100.0 * t));
    let still = open(counted.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(still.contains("e.g. t=1,theta=3"), "{still}");
}

#[test]
fn a_column_that_never_moves_is_named_with_the_others() {
    let text = table("t,theta,beta\n", |(t, a, _)| format!("{t:.2},0.001,{a:.5}"));
    let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
    for word in ["1 (theta) does not move", "0.001", "beta", "--columns"] {
        assert!(refused.contains(word), "{refused}");
    }
    check(&text, &told("t=0,theta=beta"), 1e-5, "");
}

#[test]
fn a_stated_unit_that_the_period_contradicts_is_doubted() {
    let in_pi = table("t,angle (x pi rad)\n", |(t, a, _)| format!("{t:.2},{:.6}", a / std::f64::consts::PI));
    let notes = open(in_pi.as_bytes(), &ReadOptions::default()).unwrap().notes().join("; ");
    assert!(notes.contains("doubtful") && notes.contains("as large"), "{notes}");
    // Half degrees grow a quarter as much: no degrees, and nothing that could be guessed.
    let halves = table("", |(t, a, _)| format!("{t:.2},{:.4}", 2.0 * a.to_degrees()));
    let refused = open(halves.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("--degrees") && refused.contains("4096/turn"), "{refused}");
}

#[test]
fn an_old_workbook_is_named_as_such() {
    let bytes = [b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".as_slice(), &[0; 600]].concat();
    let refused = open(&bytes, &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("workbook") && refused.contains("save the sheet as CSV"), "{refused}");
}

fn cut(recording: &Recording) -> Segments {
    segment(recording, &SegmentOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn times_that_a_video_rounded_are_even_again() {
    let truth = swing(30, 20);
    let rows = truth.iter().map(|(t, a, _)| format!("{t:.2},{a:.5}\n")).collect::<String>();
    let recording = open(format!("t,theta\n{rows}").as_bytes(), &ReadOptions::default()).unwrap();
    assert!(recording.notes().join("; ").contains("30.0000 a second"), "{:?}", recording.notes());
    let off_s = recording.times_s().iter().zip(&truth).map(|(time_s, row)| (time_s - row.0).abs()).fold(0.0, f64::max);
    assert!(off_s < 2e-4, "{off_s}");
}

#[test]
fn readings_that_a_tracker_or_a_bus_lost_are_gaps_and_their_neighbours_stay() {
    let lost = |t: f64| [3.17, 7.44, 7.45, 7.46, 12.0].iter().any(|at| (t - at).abs() < 1e-3);
    for wrong in ["0.0", "-1.0", "2.5"] {
        let text =
            table("t,theta\n", |(t, a, _)| if lost(t) { format!("{t:.2},{wrong}") } else { format!("{t:.2},{a:.5}") });
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap();
        let notes = recording.notes().join("; ");
        assert!(notes.contains("5 readings at 3 places jump out of the swing and back, at 3.170 s first"), "{notes}");
        assert_eq!(recording.len(), 1995);
        assert!(recording.times_s().iter().all(|time_s| !lost(*time_s)));
    }
}

#[test]
fn eight_samples_a_period_are_a_swing() {
    for rate_hz in [8, 12] {
        let rows = swing(rate_hz, 40).into_iter().map(|(t, a, _)| format!("{t:.4},{a:.5}\n")).collect::<String>();
        let recording = open(format!("t,theta\n{rows}").as_bytes(), &ReadOptions::default()).unwrap();
        let segments = cut(&recording);
        assert!((0.45..0.55).contains(&segments.half_swing_s), "{segments:?}");
        assert!(segments.n_turning_points > 60 && segments.free.start == 0, "{segments:?}");
    }
}

#[test]
fn a_second_release_is_offered_and_a_driven_swing_doubted() {
    let again = |t: f64| 25.0 + t;
    let (first, second) = (swing(RATE_HZ, 20), swing(RATE_HZ, 15));
    let held = (0..500).map(|idx| {
        // Lifted by hand from where the first one ends.
        let (end, share) = (first[1999].1, f64::from(idx.min(200)) / 200.0);
        (20.0 + f64::from(idx) / 100.0, end + (1.0 - end) * (3.0 - 2.0 * share) * share * share, 0.0)
    });
    let rows = first.iter().copied().chain(held).chain(second.iter().map(|(t, a, v)| (again(*t), *a, *v)));
    let text = rows.map(|(t, a, _)| format!("{t:.2},{a:.5}\n")).collect::<String>();
    let recording = open(format!("t,theta\n{text}").as_bytes(), &ReadOptions::default()).unwrap();
    let notes = cut(&recording).notes.join("; ");
    let cut_s = notes.split("cut everything after ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((19.0..20.3).contains(&cut_s.parse::<f64>().unwrap()), "{notes}");
    assert!(notes.contains("a free swing from 25.") && notes.contains("--from 25."), "{notes}");
    let driven = (0..3000).map(|idx| f64::from(idx) / 100.0).map(|t| format!("{t:.2},{:.5}\n", 0.8 * (6.0 * t).cos()));
    let options = ReadOptions { angle_unit: Some(host::recording::AngleUnit::Radians), ..ReadOptions::default() };
    let driven = open(format!("t,theta\n{}", driven.collect::<String>()).as_bytes(), &options).unwrap();
    assert!(cut(&driven).notes.join("; ").contains("don't become smaller"));
    let free =
        open(table("t,theta\n", |(t, a, _)| format!("{t:.2},{a:.5}")).as_bytes(), &ReadOptions::default()).unwrap();
    assert!(cut(&free).notes.is_empty(), "{:?}", cut(&free).notes);
}

/// Rotary pendulums call the arm theta and the pendulum alpha.
#[test]
fn alpha_beside_theta_is_the_pendulum_the_acceleration_or_asked_for() {
    let read = |head: &str, arm: f64, more: &str| {
        let row = |(t, angle, _): Row| format!("{t},{:.6},{angle:.6}{more}", arm * (9.0 * t).sin());
        open(table(head, row).as_bytes(), &ReadOptions::default())
    };
    for (head, more) in [("t,theta,alpha\n", ""), ("t,theta,alpha,theta_dot,alpha_dot\n", ",0,0")] {
        let held = read(head, 1e-3, more).unwrap();
        assert!((held.angles_rad()[0] - 1.0).abs() < 1e-6);
        let note = "2 (alpha) taken as the angle, because 1 (theta) hardly moves";
        assert!(held.notes().iter().any(|found| found == note), "{:?}", held.notes());
        let error = read(head, 0.1, more).unwrap_err();
        assert!(error.contains("several columns could be the angle: 1 (theta), 2 (alpha)"), "{error}");
    }
    let row = |(t, angle, velocity): Row| format!("{t},{angle:.6},{velocity:.6},{:.6}", -40.0 * angle.sin());
    let recording = open(table("t,theta,omega,alpha\n", row).as_bytes(), &ReadOptions::default()).unwrap();
    assert!((recording.angles_rad()[0] - 1.0).abs() < 1e-6, "{:?}", recording.notes());
}

#[test]
fn gx_gy_and_gz_are_asked_for_as_the_axes_of_a_gyroscope() {
    let row = |(t, _, velocity): Row| format!("{t},0.1,0.2,{velocity:.6}");
    let error = open(table("t,gx,gy,gz\n", row).as_bytes(), &ReadOptions::default()).unwrap_err();
    for words in ["axes of a gyroscope", "--columns t=0,rate=1 or t=0,rate=2 or t=0,rate=3"] {
        assert!(error.contains(words), "{error}");
    }
    assert!(open(table("t,gx,gy,gz\n", row).as_bytes(), &told("t=0,rate=3:rad/s")).is_ok());
}

#[test]
fn a_point_in_one_cell_is_a_point() {
    let row = |(t, a, _): Row| format!("\"({:.1}, {:.1})\",{t:.2}", 600.0 + 4e3 * a.sin(), 100.0 + 4e3 * a.cos());
    let text = table("position,time\n", row);
    let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let off_rad = recording.angles_rad().iter().zip(swing(RATE_HZ, 20)).map(|(found, row)| (found - row.1).abs());
    assert!(off_rad.fold(0.0, f64::max) < 1e-3, "{:?}", recording.notes());
}
