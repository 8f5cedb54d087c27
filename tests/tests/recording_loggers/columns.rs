//! Which column is the angle, the rate or a point, among others and with names of all kinds.

use crate::swing::{CENTIDEGREES, RATE_HZ, Row, check, check_found, open, swing, swing_from, table, told};
use host::recording::segment::{SegmentOptions, segment};
use host::recording::{AngleUnit, Measured, ReadOptions, read_bytes};
use tests::chance::Chance;

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
fn what_an_observer_tells_of_an_angle_is_no_rival() {
    let both = |(t, a, w): Row| format!("{t:.2},{a:.5},{:.5}", a + 0.01 * w);
    let note = "1 (pole_angle) taken as the angle, which was measured, and not 2 (pole_angle_hat)";
    check_found(&table("t,pole_angle,pole_angle_hat\n", both), 1e-5, note);
    check_found(
        &table("t,shaft angle (deg),estimated shaft angle (deg)\n", |(t, a, w)| {
            format!("{t:.2},{:.4},{:.4}", a.to_degrees(), (a + 0.01 * w).to_degrees())
        }),
        1e-5,
        "which was measured",
    );
    // Alone it is all that there is.
    check_found(&table("t,theta_hat\n", |(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, "");
    check_found(&table("t,pole_angle,pole_angle_hat\n", |(t, a, _)| format!("{t:.2},0,{a:.5}")), 1e-5, "never moves");
}

/// As LabVIEW exports a plot: a number of the row stands before what the names belong to.
#[test]
fn a_column_without_a_name_that_goes_on_evenly_is_a_better_time_than_a_count_of_rows() {
    let row = |(t, a, _): Row| format!("{:.0};{a:.5};{:.3}", 14.0 + 100.0 * t, 0.35 + t);
    let note = "column 2 without a name rises evenly and is the time: 0 (Time - Plot 0) counts rows";
    let plot = table("Time - Plot 0;Amplitude - Plot 0;\n", row);
    check_found(&plot, 1e-5, note);
    check(&plot, &told("theta=1"), 1e-5, note);
    check_found(&table("", row), 1e-5, "column 2 read as time");
    // With a name that says something else it is that.
    let named = open(table("t;b;c\n", row).as_bytes(), &told("theta=9")).unwrap_err();
    assert!(named.contains("the columns t, b, c: choose with --columns, e.g. t=0,"), "{named}");
    let unnamed = open(table("Time;Reading of it;;\n", |values| row(values) + ";").as_bytes(), &ReadOptions::default());
    let unnamed = unnamed.unwrap_err();
    assert!(unnamed.contains("among the columns Time, Reading of it, 2 without a name; name it"), "{unnamed}");
}

#[test]
fn without_names_what_is_told_to_a_controller_is_no_time_beside_one_that_goes_on() {
    // A loop that takes 2 ms and 18 ms in turn.
    let uneven = |t: f64| t + if ((100.0 * t).round() as u32).is_multiple_of(2) { 0.0 } else { -8e-3 };
    for told_to in [|t: f64| if t < 0.6 { 0.0 } else { 45.22 }, |t: f64| (t - 1.97).clamp(0.0, 5.0)] {
        let text = table("", |(t, a, _)| format!("{a:.5},{:.2},{:.5}", told_to(t), uneven(t)));
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        let notes = recording.notes().join("; ");
        assert!(
            notes.contains("column 2 read as time") && notes.contains("column 0 of 3 read as the angle"),
            "{notes}"
        );
    }
}

/// As a board logs an arm and what hangs on it, in a matrix without names.
#[test]
fn without_names_what_swings_much_farther_is_a_rival_unless_it_follows_from_the_angle() {
    let arm = |t: f64| 0.1 * (4.9 * t).sin() * (-0.2 * t).exp();
    let both = table("", |(t, a, _)| format!("{t:.2},{:.5},{a:.5}", arm(t)));
    let refused = open(both.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("could be the angle: 1, 2;") && refused.contains("t=0,theta=2"), "{refused}");
    check(&both, &told("t=0,theta=2"), 1e-5, "");
    let late = table("", |(t, a, _)| format!("{:.5},{a:.5},{t:.2}", arm(t)));
    let refused = open(late.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("t=2,theta=0 or t=2,theta=1"), "{refused}");
    // A rate goes six times as far here; a voltage is noise, and a motor's angle goes on.
    check_found(&table("", |(t, a, w)| format!("{t:.2},{a:.5},{w:.4}")), 1e-5, "column 0 read as time");
    let mut chance = Chance::new(7);
    let noise: Vec<f64> = (0..2000).map(|_| 3.0 * chance.normal().clamp(-2.0, 2.0)).collect();
    let beside = |(t, a, _): Row| format!("{t:.2},{a:.5},{:.3},{:.3}", noise[(100.0 * t).round() as usize], 0.3 * t);
    check_found(&table("", beside), 1e-5, "column 0 read as time");
}

/// Beside one that drifts, and beside a rate that lies on a circle with it at first. Small swings tell no unit.
#[test]
fn degrees_that_are_told_hold_whichever_column_without_a_name_is_taken() {
    let degrees = ReadOptions { angle_unit: Some(AngleUnit::Degrees), ..ReadOptions::default() };
    let small = swing_from(0.05, 1000, 20);
    let from_below = small.iter().skip_while(|(_, a, _)| *a > 0.0);
    let circle: Vec<Row> = from_below.copied().collect();
    let beside_drift = |(t, a, _): &Row| format!("{t:.3} {:.4} {:.6}\n", 0.1 + 0.002 * t, a.to_degrees());
    let beside_rate =
        |(t, a, w): &Row| format!("{t:.3} {:.6} {:.6}\n", a.to_degrees(), (w / 40f64.sqrt()).to_degrees());
    let texts: [(String, &[Row]); 2] =
        [(small.iter().map(beside_drift).collect(), &small), (circle.iter().map(beside_rate).collect(), &circle)];
    for (text, truth) in texts {
        let recording = open(text.as_bytes(), &degrees).unwrap_or_else(|error| panic!("{error}"));
        let off_rad = |(found, (_, a, _)): (&f64, &Row)| (found - a).abs();
        let most_off_rad = recording.angles_rad().iter().zip(truth).map(off_rad).fold(0.0, f64::max);
        assert!(most_off_rad < 1e-6, "{most_off_rad} {:?}", recording.notes());
    }
}

/// As the example of an MPU6050 prints yaw, pitch and roll, in a monitor and without one.
#[test]
fn a_word_before_each_row_is_no_column_and_of_columns_without_names_the_one_that_swings_is_taken() {
    let row = |(t, a, _): Row| format!("ypr\t{:.2}\t{:.4}\t-0.09", -0.14 - 0.002 * t, a.to_degrees());
    let stamped = |row_of: Row| format!("12:34:{:06.3} -> {}", 5.0 + row_of.0, row(row_of));
    check_found(&table("", stamped), 1e-5, "column 2 read as the angle, the only one that swings");
    check(&table("", stamped), &told("t=0,theta=2:deg"), 1e-5, "");
    let rate = ReadOptions { rate_hz: Some(RATE_HZ as f64), ..ReadOptions::default() };
    check(&table("", row), &rate, 1e-5, "column 2 read as the angle, the only one that swings");
    let refused = open(table("", row).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("no time column among 4 columns without names"), "{refused}");
    // Another one that swings by itself, and a time behind the word.
    let other = |t: f64| 20.0 * (4.9 * t).sin() * (-0.2 * t).exp();
    let both = table("", |(t, a, w)| format!("{}\t{:.3}", stamped((t, a, w)), other(t)));
    let refused = open(both.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("could be the angle: 2, 4;") && refused.contains("t=0,theta=2"), "{refused}");
    check_found(&table("", |(t, a, _)| format!("imu,{t:.2},0.0,{a:.5}")), 1e-5, "column 1 read as time");
}

#[test]
fn an_angle_in_two_units_is_one_angle() {
    let both = table("t,theta(deg),theta(rad)\n", |(t, a, _)| format!("{t:.2},{:.3},{a:.5}", a.to_degrees()));
    check_found(&both, 1e-5, "2 (theta(rad)) taken as the angle: 1 (theta(deg)) is the same in another unit");
}

/// Four seconds from 17°, by 1 % noise: the period grows by 0.5 % at most, and that is not seen.
#[test]
fn what_is_called_an_angle_and_goes_beyond_a_turn_of_radians_is_in_degrees() {
    let mut chance = Chance::new(11);
    let noise: Vec<f64> = (0..400).map(|_| 0.2 * chance.normal()).collect();
    let small = swing_from(0.3, RATE_HZ, 4);
    let written = |head: &str, cell: fn(f64) -> String| {
        let rows = small.iter().zip(&noise);
        let rows: String =
            rows.map(|((t, a, _), noise)| format!("{t:.2},{}\n", cell(a.to_degrees() + noise))).collect();
        open(format!("{head}{rows}").as_bytes(), &ReadOptions::default())
    };
    let degrees = |angle: f64| format!("{angle:.3}");
    let found = written("mass A,\nt,θr\n", degrees).unwrap();
    let off_rad = |(found, (_, a, _)): (&f64, &Row)| (found - a).abs();
    assert!(found.angles_rad().iter().zip(&small).map(off_rad).fold(0.0, f64::max) < 0.02);
    let notes = found.notes().join("; ");
    assert!(notes.contains("1 (θr) is called an angle, whose unit is not stated: read as degrees"), "{notes}");
    // Counts, and what is called nothing, may be anything.
    for refused in [written("t,angle\n", |angle| format!("{angle:.0}")), written("t,value\n", degrees)] {
        assert!(refused.unwrap_err().contains("if they are degrees say --degrees"));
    }
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
fn of_the_boxes_of_a_detector_the_middle_is_the_point_where_the_numbers_say_so() {
    let middle = |a: f64| (640.0 + 300.0 * a.sin(), 100.0 + 300.0 * a.cos());
    let row = |(t, a, off): Row| {
        let ((x, y), wide) = (middle(a), 40.0 + 8.0 * a);
        let corners = format!("{:.3},{:.3},{:.3},{:.3}", x - wide, y - 20.0, x + wide, y + 20.0);
        if t < 0.05 { format!("{t:.2},,,,,,") } else { format!("{t:.2},{corners},{:.3},{y:.3}", x + off) }
    };
    let of = |head: &str, off: f64| table(head, |(t, a, _)| row((t, a, off)));
    let head = "t,x1,y1,x2,y2,cx,cy\n";
    let recording = open(of(head, 0.0).as_bytes(), &ReadOptions::default()).unwrap();
    let notes = recording.notes().join("; ");
    assert!(
        notes.contains("5 (cx), 6 (cy) taken as the point") && notes.contains("the box of 1 (x1), 3 (x2)"),
        "{notes}"
    );
    let truth = swing(RATE_HZ, 20);
    let off_rad = |(found, row): (&f64, &Row)| (found - row.1).abs();
    assert!(recording.angles_rad().iter().zip(&truth[5..]).map(off_rad).fold(0.0, f64::max) < 1e-4);
    // Another point of that name.
    let refused = open(of(head, 15.0).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("could be the x and y of the pendulum: 1 (x1), 2 (y1), 3 (x2)"), "{refused}");
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
fn an_amplitude_alone_is_the_angle() {
    let degrees = |(t, a, _): Row| format!("{t:.2},{:.2}", a.to_degrees());
    check_found(&table("time,Amplitude\n", degrees), CENTIDEGREES, "says nothing else and is read as the angle");
    // The sizes of the swings one after the other are no swing.
    let sizes: String =
        (0..300).map(|idx| format!("{:.2},{:.3}\n", 0.5 * f64::from(idx), (-0.01 * f64::from(idx)).exp())).collect();
    let read = open(format!("time,amplitude\n{sizes}").as_bytes(), &ReadOptions::default());
    assert!(read.is_err() || segment(&read.unwrap(), &SegmentOptions::default()).is_err());
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
    let fitted = |(t, a, _): Row| format!("{t:.2}\t{a:.5}\t0.0008\t0.008");
    check_found(&table("t\tfunc\t0.0008\t0.008\n", fitted), 1e-5, "1 (func) says nothing else");
    check_found(&table("time,val\n", |(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, "1 (val) says nothing else");
    // Input and output, as whoever identifies systems calls them.
    let identified = |(t, a, _): Row| format!("{t:.2},0,{a:.5}");
    check_found(&table("t,u,y\n", identified), 1e-5, "2 (y) says nothing else and is read as the angle");
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
    let swapped = |(t, a, _): Row| format!("{a:.5},{t:.2},0.02,0.01");
    check_found(&table("X,Y,X',Y'\n", swapped), 1e-5, "1 (Y) goes on evenly: read as the time");
    let standing = |(t, a, _): Row| format!("0,{t:.2},{a:.5}");
    check_found(&table("timeTrigger,time,theta\n", standing), 1e-5, "");
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
fn of_the_angles_about_three_axes_the_one_that_moves_most_is_taken() {
    let three = |(t, a, _): Row| {
        let (x, z) = (350.0 + (0.3 * t).sin(), -2.0 + 0.5 * (0.4 * t).cos());
        format!("{t:.2},{x:.2},{:.3},{z:.2}", a.to_degrees())
    };
    for head in ["t,Euler_X,Euler_Y,Euler_Z\n", "t,AngleX(deg),AngleY(deg),AngleZ(deg)\n", "t,tilt x,tilt y,tilt z\n"] {
        check_found(&table(head, three), CENTIDEGREES, "of 3 angles of the sensor 2 (");
    }
    let orientation = table("t,Orientation X,Orientation Y,Orientation Z\n", three);
    check_found(&orientation, CENTIDEGREES, "2 (Orientation Y) moves most");
}

#[test]
fn an_orientation_with_a_w_is_a_quaternion_and_no_angle() {
    let parts = |(t, a, v): Row| format!("{t:.2},{:.5},0,0,{:.5},{v:.5}", (a / 2.0).sin(), (a / 2.0).cos());
    let head = "t,orientation.x,orientation.y,orientation.z,orientation.w,";
    let refused = open(table(&format!("{head}temp\n"), parts).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("as a quaternion"), "{refused}");
    let rates = table(&format!("{head}angular_velocity.x\n"), parts);
    assert_eq!(open(rates.as_bytes(), &ReadOptions::default()).unwrap().measured(), Measured::Rate);
}

#[test]
fn an_angular_displacement_is_an_angle_and_an_acceleration_no_rate() {
    check_found(&table("Time,Angular displacement\n", |(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, "");
    let row = |(t, a, _): Row| format!("{t:.2},{:.4}", -40.0 * a.sin());
    let refused = open(table("Zeit,Winkelbeschleunigung (rad/s2)\n", row).as_bytes(), &ReadOptions::default());
    assert!(refused.unwrap_err().contains("no angle column"));
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
fn two_columns_that_lie_on_a_circle_at_first_only_are_no_point() {
    let beside =
        |(t, a, _): Row| format!("{t:.2},{a:.6},{:.6}", if t < 5.0 { 1.0 - (1.0 - a * a / 1.44).sqrt() } else { 0.3 });
    let recording = check_found(&table("", beside), 1e-5, "column 0 read as time");
    assert!(!recording.notes().join("; ").contains("circle"), "{:?}", recording.notes());
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
fn alpha_with_a_rate_of_its_own_is_an_angle_though_no_theta_stands_there() {
    let row = |(t, a, v): Row| format!("{t:.2},{a:.5},{v:.4}");
    let recording = check_found(&table("t,alpha,dalpha\n", row), 1e-5, "");
    assert_eq!(recording.measured(), Measured::Angle);
    let refused = open(table("t,alpha,beta\n", row).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("no angle column"), "{refused}");
}

#[test]
fn an_angle_that_names_its_time_or_a_sensor_with_a_number_is_one() {
    let at_time = |(t, a, v): Row| format!("{t:.2},{:.3},{v:.2}", a.to_degrees());
    check_found(&table("TimeSinceFirstFrame(s),AngleAtTime(deg),dAngle(0.01deg)\n", at_time), CENTIDEGREES, "");
    check_found(&table("Time,IMU1Angle,IMU1Temp\n", |(t, a, _)| format!("{t:.2},{a:.5},21")), 1e-5, "");
}

#[test]
fn of_several_columns_without_names_it_is_said_which_one_is_the_angle() {
    let text = table("", |(t, a, v)| format!("{t:.2} {a:.5} {v:.3} 0"));
    check_found(&text, 1e-5, "column 1 of 4 read as the angle; --columns theta=... takes another one");
    let alone = check_found(&table("", |(t, a, _)| format!("{t:.2} {a:.5}")), 1e-5, "");
    assert!(!alone.notes().join("; ").contains("read as the angle"), "{:?}", alone.notes());
}
