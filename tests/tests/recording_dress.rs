//! One swing in dresses that few wear: other line ends and alphabets, sine and cosine, points of trackers, summaries below
//! the table, several runs in one file. Each is read rightly, or refused with what this very file needs.
//!
//! The swing is integrated here: `θ̈ = −40 sin θ − 0.06 ω − 0.05 sgn ω`, 100 samples a second.

#[path = "recording_dress/runs.rs"]
mod runs;

use host::recording::{Measured, ReadOptions, Recording, read_bytes};
use std::fmt::Write as _;

/// Time (s), angle (rad), angular velocity (rad/s).
type Row = (f64, f64, f64);

const RATE_HZ: usize = 100;

fn swing_from(start_rad: f64) -> Vec<Row> {
    const STEPS: usize = 50;
    let dt = 1.0 / (STEPS * RATE_HZ) as f64;
    let (mut angle, mut velocity) = (start_rad, 0.0_f64);
    let mut rows = Vec::new();
    for idx in 0..20 * RATE_HZ {
        rows.push((idx as f64 / RATE_HZ as f64, angle, velocity));
        for _ in 0..STEPS {
            let dry = if velocity == 0.0 { 0.0 } else { 0.05 * velocity.signum() };
            let middle = velocity + dt / 2.0 * (-40.0 * angle.sin() - 0.06 * velocity - dry);
            angle += dt * middle;
            velocity = middle + dt / 2.0 * (-40.0 * angle.sin() - 0.06 * middle - dry);
        }
    }
    rows
}

fn swing() -> Vec<Row> {
    swing_from(1.0)
}

fn table(head: &str, row: impl Fn(Row) -> String) -> String {
    swing().into_iter().fold(head.to_owned(), |text, values| text + &row(values) + "\n")
}

fn open(text: &[u8], options: &ReadOptions) -> Result<Recording, String> {
    read_bytes("swing.csv", text, options).map_err(|error| error.to_string())
}

fn told(columns: &str) -> ReadOptions {
    ReadOptions { columns: Some(columns.parse().unwrap()), ..ReadOptions::default() }
}

#[track_caller]
fn check_swing(found: &Recording, truth: &[Row], within_rad: f64, note: &str) {
    let notes = found.notes().join("; ");
    assert_eq!(found.len(), truth.len(), "{notes}");
    let begin_s = found.times_s()[0] - truth[0].0;
    for (idx, (time_s, angle_rad, _)) in truth.iter().enumerate() {
        let (off_s, off_rad) = (found.times_s()[idx] - begin_s - time_s, found.angles_rad()[idx] - angle_rad);
        assert!(off_s.abs() < 1e-3 && off_rad.abs() < within_rad, "{idx}: {off_s} s {off_rad} rad {notes}");
    }
    assert!(notes.contains(note), "{notes}");
}

/// Half a digit of what is written, and as much again.
#[track_caller]
fn check(text: &[u8], within_rad: f64, note: &str) {
    let found = open(text, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    check_swing(&found, &swing(), within_rad, note);
}

#[track_caller]
fn check_refused(text: &str, options: &ReadOptions, expected: &str) {
    let error = open(text.as_bytes(), options).map(|found| found.notes().join("; ")).unwrap_err();
    assert!(error.contains(expected), "{error}");
}

fn plain((time, angle, _): Row) -> String {
    format!("{time:.2},{angle:.6}")
}

#[test]
fn lines_may_end_with_a_carriage_return_alone() {
    check(table("t,theta\n", plain).replace('\n', "\r").as_bytes(), 1e-6, "");
}

#[test]
fn minus_signs_of_typesetters_are_minus_signs() {
    check(table("t;theta\n", plain).replace(',', ";").replace('-', "\u{2212}").as_bytes(), 1e-6, "");
}

/// Windows-1251: the alphabet begins at 192.
#[test]
fn cyrillic_names_of_windows_are_read() {
    let text = table("Время (мс);Угол (град)\n", |(time, angle, _)| {
        format!("{:.0};{:.4}", 1e3 * time, angle.to_degrees()).replace('.', ",")
    });
    let bytes = |letter: char| match u32::from(letter) {
        code @ 0x410..0x450 => (code - 0x410 + 0xc0) as u8,
        code => code as u8,
    };
    check(&text.chars().map(bytes).collect::<Vec<u8>>(), 2e-6, "");
}

#[test]
fn sine_and_cosine_are_the_angle_however_little_it_swings() {
    let of = |(time, angle, _): Row| format!("{time:.2},{:.6},{:.6}", angle.cos(), angle.sin());
    check(table("t,cos(theta),sin(theta)\n", of).as_bytes(), 1e-5, "pivot at (0.0000, 0.0000)");
    let upright = |(time, angle, speed): Row| format!("{time:.2},{:.6},{:.6},{speed}", -angle.cos(), angle.sin());
    check(table("t,cos_theta,sin_theta,theta_dot\n", upright).as_bytes(), 1e-5, "");
    let small = swing_from(0.05).into_iter().fold("t,sin,cos\n".to_owned(), |text, (time, angle, _)| {
        text + &format!("{time:.2},{:.6},{:.6}\n", angle.sin(), angle.cos())
    });
    check_swing(&open(small.as_bytes(), &ReadOptions::default()).unwrap(), &swing_from(0.05), 1e-5, "");
}

#[test]
fn points_of_trackers_are_found_by_other_names_or_asked_for() {
    let pixels = |(time, angle, _): Row| {
        format!("{time:.2},{:.3},{:.3}", 640.0 + 300.0 * angle.sin(), 100.0 + 300.0 * angle.cos())
    };
    check(table("t,cx,cy\n", pixels).as_bytes(), 1e-4, "y counting down: pivot at (640");
    let two = |row: Row| format!("{},300,200", pixels(row));
    let text = table("t,x_bob,y_bob,x_mark,y_mark\n", two);
    let asks = "several columns could be the x and y of the pendulum: 1 (x_bob), 2 (y_bob), 3 (x_mark), 4 (y_mark); choose \
                with --columns, e.g. t=0,x=1,y=2 or t=0,x=3,y=4";
    check_refused(&text, &ReadOptions::default(), asks);
    check_swing(&open(text.as_bytes(), &told("t=0,x=1,y=2")).unwrap(), &swing(), 1e-4, "");
}

/// 0.1 rad to either side, seen with a third of a percent of the width too much of curvature; the pivot is the origin.
fn short_arc(off: f64) -> (Vec<Row>, String) {
    let truth = swing_from(0.1);
    let mut text = String::new();
    for (time, angle, _) in &truth {
        let x = 0.75 * angle.sin();
        let y = -0.75 * angle.cos() - 0.0005 * (angle / 0.1).powi(2);
        writeln!(text, "{time:.2},{:.6},{:.6}", x + off, y + off).unwrap();
    }
    (truth, text)
}

#[test]
fn a_point_on_a_short_arc_without_names_is_no_angle_in_radians() {
    let (truth, text) = short_arc(0.0);
    let found = open(text.as_bytes(), &ReadOptions::default()).unwrap();
    check_swing(&found, &truth, 3e-4, "the origin of x and y, from which all points are equally far");
    let (_, text) = short_arc(0.2);
    let found = open(text.as_bytes(), &ReadOptions::default()).unwrap();
    let notes = found.notes().join("; ");
    assert!(notes.contains("doubtful, the arc is short") && notes.contains("--pivot X,Y"), "{notes}");
    // Heights that scatter by as much as the arc sags.
    let mut chance = 1_u32;
    let coarse = text.lines().fold(String::new(), |text, line| {
        chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        text + &format!(
            "{},{:.4},{:.4}\n",
            cells[0],
            cells[1],
            cells[2] + 0.004 * (f64::from(chance >> 8) / 2_f64.powi(24) - 0.5)
        )
    });
    check_refused(
        &coarse,
        &ReadOptions::default(),
        "columns 1 and 2 move like x and y of a point, and x and y cover too",
    );
    let found = open(coarse.as_bytes(), &ReadOptions { pivot: Some([0.2, 0.2]), ..ReadOptions::default() }).unwrap();
    assert!(found.notes().join("; ").contains("pivot at (0.2000, 0.2000)"), "{:?}", found.notes());
}

/// Angle and rate of a pendulum that takes 2π s lie on a circle, and go round it.
#[test]
fn angle_and_rate_without_names_are_no_point() {
    let mut text = String::new();
    let (mut angle, mut speed) = (0.4_f64, 0.0_f64);
    for idx in 0..3000 {
        writeln!(text, "{:.2},{angle:.6},{speed:.6}", f64::from(idx) / 50.0).unwrap();
        speed -= 0.02 * (angle.sin() + 0.002 * speed);
        angle += 0.02 * speed;
    }
    let found = open(text.as_bytes(), &ReadOptions::default()).unwrap();
    assert!(found.angles_rad().iter().all(|angle| angle.abs() < 0.41), "{:?}", found.notes());
}

#[test]
fn the_name_of_the_pendulum_alone_is_its_angle() {
    check(table("time_ms,pendulum\n", |(time, angle, _)| format!("{:.0},{angle:.6}", 1e3 * time)).as_bytes(), 1e-6, "");
    let beside = |row: Row| format!("{},0.5", plain(row));
    check(table("t,pendulum_angle,pendulum\n", beside).as_bytes(), 1e-6, "");
}

#[test]
fn a_summary_below_the_table_is_left_out_and_words_within_it_are_not() {
    let text = table("t,theta\n", plain);
    check(format!("{text}Mean,0.003\nMax,1.0\n").as_bytes(), 1e-6, "2 lines below the table left out");
    let within = text.replacen("\n1.00,", "\nMean,0.1\n1.00,", 1);
    check_refused(&within, &ReadOptions::default(), "\"Mean\" is not a finite number");
}

#[test]
fn the_clock_of_a_monitor_tells_the_time_of_labels_that_have_none() {
    let line = |(time, angle, _): Row| {
        format!("12:00:{time:06.3} -> angle={:.4} deg, raw={:.0}", angle.to_degrees(), 100.0 * angle)
    };
    check(table("", line).as_bytes(), 2e-6, "");
}

#[test]
fn alpha_of_a_rotary_pendulum_is_offered_with_what_stands_beside_it() {
    let row =
        |(time, angle, speed): Row| format!("{angle:.5};{speed:.4};{:.5};3.2;{time:.2}", 0.3 * (7.0 * angle).sin());
    let text = table("alphaQube;alphaDotQube;thetaQube;cameraAngle;systemTime\n", row);
    check_refused(&text, &ReadOptions::default(), "0 (alphaQube)");
}

#[test]
fn advice_names_the_columns_of_the_very_file() {
    let text = table("", |(time, angle, _)| format!("{:.1},{time:.2}", 100.0 * angle + 300.0));
    check_refused(&text, &ReadOptions::default(), "--columns t=1,theta=0:4096/turn or theta=0:54.5deg");
}

#[test]
fn frames_that_were_lost_are_gaps_where_the_rate_is_told_or_said() {
    let rows = swing().into_iter().enumerate().filter(|(idx, _)| idx % 13 != 7).collect::<Vec<_>>();
    let truth: Vec<Row> = rows.iter().map(|(_, row)| *row).collect();
    let text = |head: &str| {
        rows.iter().fold(head.to_owned(), |text, (idx, (_, angle, _))| text + &format!("{},{angle:.6}\n", 250 + idx))
    };
    let rate = ReadOptions { rate_hz: Some(100.0), ..ReadOptions::default() };
    let found = open(text("frame,angle\n").as_bytes(), &rate).unwrap();
    check_swing(&found, &truth, 1e-6, "0 (frame) counts the samples, 100 a second");
    let said = text("# Sampling frequency: 100 Hz\nSample,angle\n");
    check_swing(&open(said.as_bytes(), &ReadOptions::default()).unwrap(), &truth, 1e-6, "");
    check_refused(&text("# Baud rate: 9600\nsample,angle\n"), &ReadOptions::default(), "no time column");
}

#[test]
fn a_picture_that_was_turned_is_turned_back() {
    let of = |(time, angle, _): Row| {
        format!("{time:.3},{:.4},{:.4}", 400.0 - 300.0 * angle.cos(), 900.0 + 300.0 * angle.sin())
    };
    let found = open(table("t,x,y\n", of).as_bytes(), &ReadOptions::default()).unwrap();
    let notes = found.notes().join("; ");
    let off = |sign: f64| {
        let offs = found.angles_rad().iter().zip(swing()).map(|(found, (_, angle, _))| (found - sign * angle).abs());
        offs.fold(0.0, f64::max)
    };
    assert!(notes.contains("the picture is turned, "), "{notes}");
    assert!(off(1.0).min(off(-1.0)) < 1e-4, "{notes}");
}

#[test]
fn what_is_no_angle_is_called_what_it_is() {
    let x = table("t,x\n", |(time, angle, _)| format!("{time:.2},{:.4}", 0.3 * angle.sin()));
    check_refused(&x, &ReadOptions::default(), "1 (x) is one coordinate of a point and no angle; export x and y of it");
    let distance = |row: fn(Row) -> String| table("Time (s),Distance (cm),Dist Error (cm),Velocity (cm/s)\n", row);
    let ranged = distance(|(t, a, w)| format!("{t:.2},{:.3},0.2,{:.2}", 60.0 + 20.0 * a, 20.0 * w));
    let advice = "1 (Distance (cm)) is one coordinate of a point and no angle";
    check_refused(&ranged, &ReadOptions::default(), advice);
    check_refused(&ranged, &ReadOptions::default(), "--columns t=0,theta=1:0.19deg");
    let beside = table("t,position (m),omega (rad/s)\n", |(t, a, w)| format!("{t:.2},{:.4},{w:.5}", 0.2 * a));
    let rates = open(beside.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!(rates.measured(), Measured::Rate);
    let row = |(time, angle, _): Row| format!("{:.0},{:.0},12,0,{time:.2}", 1e3 * angle.sin(), 1e3 * angle.cos());
    let accelerations = table("xAccl,yAccl,zAccl,motor_steps,time\n", row);
    check_refused(&accelerations, &ReadOptions::default(), "among them are accelerations");
}

#[test]
fn the_time_is_found_among_columns_without_names_though_one_row_is_out_of_order() {
    let mut rows: Vec<String> =
        swing().iter().map(|(time, angle, speed)| format!("{angle:.5},{speed:.4},{time:.3}\n")).collect();
    rows[40] = rows[40].replace(",0.400", ",0.353");
    let found = open(rows.concat().as_bytes(), &ReadOptions::default()).unwrap();
    let notes = found.notes().join("; ");
    assert!(notes.contains("column 2 read as time") && notes.contains("1 row is out of the order of time"), "{notes}");
    assert_eq!(found.len(), swing().len() - 1);
}

#[test]
fn an_angle_that_begins_later_than_its_clock_is_found_in_a_column_without_a_name() {
    let row = |(time, angle, _): Row| match time < 1.5 {
        true => format!("{time:.2},"),
        false => format!("{time:.2},{angle:.6}"),
    };
    let found = open(table("", row).as_bytes(), &ReadOptions::default()).unwrap();
    check_swing(&found, &swing()[150..], 1e-6, "150 rows without a value are gaps");
}

#[test]
fn an_angular_velocity_needs_no_unit_to_be_one() {
    for name in ["angular_velocity", "AngVel", "Vitesse angulaire", "velocidad angular"] {
        let text = table(&format!("time,{name}\n"), |(time, _, speed)| format!("{time:.2},{speed:.5}"));
        let found = open(text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(found.measured(), Measured::Rate, "{name}");
        assert!(found.notes().join("; ").contains("read as rad/s"), "{name}");
    }
}

#[test]
fn moments_are_read_in_json_and_as_spans_of_days() {
    let moment = |time: f64| format!("{:02}:{:06.3}", 23 + (time / 60.0) as usize, time % 60.0);
    let of = |(time, angle, _): Row| {
        let moment = moment(time);
        format!("{{\"timestamp\": \"2026-03-01T14:{moment}Z\", \"pendulum\": {{\"angle_rad\": {angle:.6}}}}}")
    };
    check(table("", of).as_bytes(), 1e-6, "");
    let span = |(time, angle, _): Row| format!("0 days 00:{}000,{angle:.6}", moment(time));
    check(table(",theta\n", span).as_bytes(), 1e-6, "");
    let colons = |(time, angle, _): Row| format!("09:{},{angle:.6}", moment(time).replace('.', ":"));
    check(table("time,theta\n", colons).as_bytes(), 1e-6, "");
}

#[test]
fn an_alpha_that_is_known_as_the_angle_is_not_named_twice() {
    let row = |(time, angle, _): Row| format!("{time:.2},0.0015,{angle:.6}");
    check(table("Time (s),theta (rad),alpha (rad)\n", row).as_bytes(), 1e-6, "because 1 (theta (rad)) never moves");
}

#[test]
fn a_table_of_periods_is_no_swing() {
    let rows =
        |head: &str, row: fn(f64) -> String| (1..30).fold(head.to_owned(), |text, n| text + &row(f64::from(n)) + "\n");
    let period = |amplitude: f64| format!("{amplitude},{:.4}", 0.82 * (1.0 + amplitude * amplitude / 52_000.0));
    let of_length = |n: f64| format!("{:.2},{:.4}", 0.1 * n, 2.006 * (0.1 * n).sqrt());
    for text in [
        rows("n,period\n", period),
        rows("n,T (s)\n", period),
        rows("amplitude (deg),period (s)\n", period),
        rows("angle (deg),T (s)\n", period),
        rows("Winkel,Periodendauer (s)\n", period),
        rows("length (m),T (s)\n", of_length),
        rows("l,T\n", of_length),
    ] {
        check_refused(&text, &ReadOptions::default(), "periods or what a light gate gives, which can't be fitted");
    }
    // A time may be called so.
    check(table("T (s),theta\n", plain).as_bytes(), 1e-6, "");
}

#[test]
fn tables_of_markdown_and_lists_of_programs_are_read() {
    let bars = |(time, angle, _): Row| format!("| {time:.2} | {angle:.6} |");
    check(table("# My swing\n\n| t (s) | theta |\n|:---|---:|\n", bars).as_bytes(), 1e-6, "");
    let list = |number: fn(&Row) -> String| swing().iter().map(number).collect::<Vec<_>>().join(", ");
    let (times, angles) = (list(|row| format!("{:.2}", row.0)), list(|row| format!("{:.6}", row.1)));
    check(format!("[{times}]\n[{angles}]\n").as_bytes(), 1e-6, "a quantity a line");
    check(format!("t = [{times}]\ntheta = [{angles}]\n").as_bytes(), 1e-6, "");
    check(format!("t = np.array([{times}])\ntheta = np.array([{angles}])\n").as_bytes(), 1e-6, "");
    check(format!("{{'t': [{times}], 'theta': [{angles}]}}\n").as_bytes(), 1e-6, "");
    let pairs = list(|row| format!("({:.2}, {:.6})", row.0, row.1));
    check(format!("[{pairs}]\n").as_bytes(), 1e-6, "");
    check(format!("swing = [{pairs},]\n").as_bytes(), 1e-6, "");
    check_refused("t = [0 0.01 0.02]\n", &ReadOptions::default(), "file of lists: expected `,` or `]`");
    check_refused("t = [0 0.01 0.02]\n", &ReadOptions::default(), "expected t = [0.0, 0.01, …]");
}
