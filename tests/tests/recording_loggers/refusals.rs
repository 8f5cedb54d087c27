//! What can not be read is refused, with what could be told or recorded instead.

use crate::swing::{Row, check, open, table, told};
use host::recording::ReadOptions;
use host::recording::segment::{SegmentOptions, segment};

#[test]
fn a_project_of_another_program_is_named_with_what_to_export() {
    for head in ["<?xml version=\"1.0\"?>\n<object class=\"TrackerPanel\">\n", "\u{feff}<!DOCTYPE html>\n<html>\n"] {
        let text = table(head, |(t, a, _)| format!("<point>{t:.2}, {a:.5}</point>"));
        let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("XML") && refused.contains("Tracker"), "{refused}");
    }
}

#[test]
fn volts_counts_and_quaternions_are_refused_with_what_to_tell() {
    let two = |(t, a, _): Row| format!("{t:.2},{:.4}", 1.65 + a);
    for head in [
        "Time(s),CH1(V)\n",
        "x-axis,1\nsecond,Volt\n",
        "x-axis,1\n",
        "Time,Channel A\n(s),(V)\n\n",
        "Source,CH1\nSecond,Volt\n",
    ] {
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

/// Of a board with an accelerometer on the pendulum, in steps of 4/1000 g.
#[test]
fn accelerations_without_names_are_refused_as_such() {
    let steps = |g: f64| 4.0 * (250.0 * g).round();
    let of_swing = |(_, a, w): Row| [steps(0.02 * w), steps(a.cos() + w * w / 40.0), steps(0.1)];
    let time_first = table("", |row| {
        let [x, y, z] = of_swing(row);
        format!("{:.0},{x},{y},{z}", 1000.0 * row.0)
    });
    let time_last = table("", |row| {
        let [x, y, z] = of_swing(row);
        format!("{x},{y},{z},{:.0}", 1000.0 * row.0)
    });
    for (text, axes) in [(time_first, "columns 1, 2 and 3"), (time_last, "columns 0, 1 and 2")] {
        let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains(axes) && refused.contains("accelerations in thousandths of g"), "{refused}");
    }
    let counts = table("", |(t, a, _)| format!("{:.0},{},{},4", 1000.0 * t, 402.0 + steps(a), 800.0));
    let refused = open(counts.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(!refused.contains("accelerations"), "{refused}");
}

/// As a program prints what an accelerometer, a gyroscope and a clock give.
#[test]
fn axes_in_brackets_without_names_are_refused_with_what_to_tell() {
    for parted in [", ", "; ", " "] {
        let text = table("", |(t, a, w)| {
            let (across, along) = (w * a, 9.81 * a.cos() + w * w / 4.0);
            format!("[{across:.4}, {along:.4}, 0.1]{parted}[0.2, {:.3}, -0.1]{parted}{t:.3}", w.to_degrees())
        });
        let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("columns 0 to 2, 3 to 5 stand in brackets"), "{refused}");
        assert!(refused.contains("--columns t=6,rate=3:deg/s"), "{refused}");
        let found = open(text.as_bytes(), &told("t=6,rate=4:deg/s")).unwrap();
        let off = table("", |(_, _, w)| w.to_string());
        let truth = off.lines().map(|rate| rate.parse::<f64>().unwrap());
        assert!(found.angles_rad().iter().zip(truth).all(|(rate, truth)| (rate - truth).abs() < 1e-4));
    }
}

#[test]
fn what_is_known_and_not_read_is_named_with_the_cure() {
    let cases: [(&[u8], &str, &str); 7] = [
        (b"\x80\x04\x95\x10", "pickle", "numpy.savetxt"),
        (b"PAR1\x15\x04", "Parquet", "to_csv"),
        (b"CL4\r\n180 0.1\r\n", "CASSY Lab 1", "export the table"),
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
fn where_no_name_is_known_columns_that_move_are_shown_as_examples() {
    let refused = |heading: &str| {
        let text = table(heading, |(t, a, w)| format!("{t:.3},{a:.4},{w:.4},7"));
        open(text.as_bytes(), &ReadOptions::default()).unwrap_err()
    };
    let none = refused("t,original,noisy,trial");
    assert!(none.contains("no angle column") && none.ends_with("theta=..., e.g. t=0,theta=1 or t=0,theta=2"), "{none}");
    // By its unit the one is something else, and by its words the other.
    let other = refused("t,Brightness (W/m^2),Angular acceleration X,n");
    assert!(other.contains("no angle column") && other.ends_with("theta=..."), "{other}");
}

#[test]
fn periods_of_a_light_gate_are_named_as_such() {
    let text: String = (1..40).map(|idx| format!("{:.6}\t2.133149\t0.031032\n", f64::from(idx) * 1.0665)).collect();
    let text = format!("#Time\tPeriod\tTransit time\n#[s]\t[s]\t[s]\n{text}");
    let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("light gate") && refused.contains("record the angle"), "{refused}");
}

#[test]
fn however_many_periods_a_table_has_they_are_no_times() {
    let periods = |n: u32| {
        let rows =
            (0..n).map(|idx| format!("{:.3},{:.3}\n", 0.33 - 1e-3 * f64::from(idx), 0.95 + 0.01 * f64::from(idx % 3)));
        format!("Amplitude (rad),Period (s)\n{}", rows.collect::<String>())
    };
    for n in [30, 300] {
        let refused = open(periods(n).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("record the angle"), "{n}: {refused}");
    }
    // The period of a loop is the time since the row before.
    let steps = table("period (ms),angle\n", |(t, a, _)| {
        format!("{},{a:.5}", 10 + 3 * (((1e2 * t).round() as u64 + 1) % 2) - 3 * u64::from(t > 0.0))
    });
    let read = open(steps.as_bytes(), &ReadOptions::default());
    assert!(!read.as_ref().is_err_and(|refused| refused.contains("record the angle")), "{read:?}");
}

#[test]
fn of_many_columns_a_message_lists_some() {
    let names: String = (0..200).map(|idx| format!("quantity {idx},")).collect();
    let row = |(_, a, v): Row| format!("{a:.5},").repeat(100) + &format!("{v:.5},").repeat(100);
    let refused = open(table(&format!("{names}\n"), row).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("quantity 29 and 170 more") && refused.len() < 1000, "{refused}");
}

#[test]
fn states_of_a_light_gate_and_times_for_lengths_are_no_recordings_of_a_swing() {
    let gate = table("Time,Event Time,State at A,State at B\ns,s,State,State\n\n", |(t, a, _)| {
        format!("{:.5},{:.5},{},0", 0.4 * t, 0.4 * t, u8::from(a > 0.0))
    });
    let lengths: String = (0..40)
        .map(|idx| 0.1 + 0.02 * f64::from(idx))
        .fold("lengde;tid\n".to_owned(), |text, l| text + &format!("{l:.2};{:.2}\n", 2.006 * l.sqrt()));
    for text in [gate, lengths] {
        let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("what a light gate gives") && refused.contains("record the angle"), "{refused}");
    }
}

#[test]
fn of_several_counters_the_pendulums_is_advised() {
    for head in ["t,motor_counts,pend_counts\n", "t,cart_enc,enc\n"] {
        let row = |(t, a, _): Row| format!("{t:.2},{:.0},{:.0}", 9e3 * t, a * 2048.0 / std::f64::consts::TAU);
        let refused = open(table(head, row).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("t=0,theta=2:4096/turn"), "{refused}");
    }
}

/// 131 are a degree a second.
#[test]
fn what_a_chip_gives_is_no_rate_until_it_is_told_what_one_is_worth() {
    let text = table("ms,ax,ay,az,gx,gy,gz\n", |(t, _, v)| {
        format!("{:.0},1,2,16384,3,4,{:.0}", 1e3 * t, 131.0 * v.to_degrees())
    });
    let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("neither that nor degrees a second"), "{refused}");
    let told = open(text.as_bytes(), &told("t=0:ms,rate=6:0.00763deg/s")).unwrap();
    // 0.00763 is 131 to three digits.
    assert!((told.angles_rad()[25] / crate::swing::swing(100, 1)[25].2 - 1.0).abs() < 1e-3, "{:?}", told.notes());
    let degrees = table("t,gyro\n", |(t, _, v)| format!("{t:.2},{:.3}", v.to_degrees()));
    let refused = open(degrees.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("these are degrees a second; say --columns t=0,rate=1:deg/s"), "{refused}");
}

/// Two degrees to either side: as rad/s they would be swings of half a turn, whose period grows by much.
#[test]
fn small_rates_in_degrees_a_second_are_told_by_a_period_that_does_not_grow() {
    let rows = crate::swing::swing_from(0.035, 100, 20).into_iter();
    let rows = rows.map(|(t, _, v)| format!("{t:.2},{:.4}\n", v.to_degrees())).collect::<String>();
    let text = format!("t,gyro_z\n{rows}");
    let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(
        refused.contains("the period should be") && refused.contains("say --columns t=0,rate=1:deg/s"),
        "{refused}"
    );
    let told = open(text.as_bytes(), &told("t=0,rate=1:deg/s")).unwrap();
    assert!(!told.notes().join("; ").contains("doubtful"), "{:?}", told.notes());
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
fn accelerations_are_refused_with_what_to_record_instead() {
    let three = |(t, a, v): Row| format!("{t:.2},{:.4},{:.4},{:.4}", 9.81 * a.sin(), 9.81 * a.cos(), 0.1 * v);
    let phone = "Time (s),Acceleration x (m/s^2),Acceleration y (m/s^2),Absolute acceleration (m/s^2)\n";
    let german = "Zeit (s),Beschleunigung x (m/s²),Beschleunigung y (m/s²),Betrag\n";
    for head in [phone, "t_s,ax_g,ay_g,az_g\n", "time,ax,ay,az\n", german] {
        let refused = open(table(head, three).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("accelerations, which can't be fitted") && refused.contains("gyroscope"), "{refused}");
    }
}

#[test]
fn what_could_be_told_names_columns_of_this_very_file() {
    let five = |(t, a, v): Row| format!("0,{a:.5},7,{v:.5},{t:.2}");
    let refused = |head: &str, options: &ReadOptions| open(table(head, five).as_bytes(), options).unwrap_err();
    let angles = refused("a,theta1,b,theta2,t\n", &ReadOptions::default());
    assert!(angles.contains("e.g. t=4,theta=1 or t=4,theta=3"), "{angles}");
    let two_clocks = |(t, a, v): Row| format!("{:.4},{a:.5},7,{v:.5},{t:.2}", t * t);
    let two = table("Time A,b,c,d,Time B\n", two_clocks);
    let times = open(two.as_bytes(), &told("x=1,y=3")).unwrap_err();
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
    let recording = open(in_pi.as_bytes(), &ReadOptions::default()).unwrap();
    let notes = segment(&recording, &SegmentOptions::default()).unwrap().notes.join("; ");
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

#[test]
fn gx_gy_and_gz_are_asked_for_as_the_axes_of_a_gyroscope() {
    let row = |(t, _, velocity): Row| format!("{t},0.1,0.2,{velocity:.6}");
    let error = open(table("t,gx,gy,gz\n", row).as_bytes(), &ReadOptions::default()).unwrap_err();
    for words in ["axes of a gyroscope", "--columns t=0,rate=1 or t=0,rate=2 or t=0,rate=3"] {
        assert!(error.contains(words), "{error}");
    }
    assert!(open(table("t,gx,gy,gz\n", row).as_bytes(), &told("t=0,rate=3:rad/s")).is_ok());
}

/// A length a row, and beside it how long some swings took, with the unit of the length alone below its name.
#[test]
fn a_table_of_times_beside_lengths_is_refused_as_one() {
    for units in ["(m),,,", "m,,,", "[m],,,", "(m),(s),(s),(s)"] {
        let rows: String = (1..=10)
            .map(|n| f64::from(n) / 10.0)
            .map(|length_m| {
                let ten_s = 20.0 * std::f64::consts::PI * (length_m / 9.81).sqrt();
                format!("{length_m:.1},{ten_s:.1},{:.1},{:.1}\n", ten_s + 0.2, ten_s - 0.1)
            })
            .collect();
        let text = format!("Length,1st run (second),2nd run (second),3rd Run (second)\n{units}\n{rows}");
        let refused = open(text.as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("among them are durations"), "{units}: {refused}");
    }
}

#[test]
fn a_period_beyond_a_pendulums_asks_for_the_unit_of_the_time_and_takes_the_answer() {
    let slow = table("t (s),theta\n", |(t, a, _)| format!("{:.1},{:.6}", 200.0 * t, 0.01 * a));
    let refused = |options: &ReadOptions| open(slow.as_bytes(), options).map(|_| ()).unwrap_err();
    let unsaid = refused(&ReadOptions::default());
    assert!(unsaid.contains("say it, --columns t=0:ms,theta=1"), "{unsaid}");
    let said = refused(&told("t=0:s,theta=1"));
    assert!(said.contains("as in a torsion pendulum") && !said.contains("say it"), "{said}");
}
