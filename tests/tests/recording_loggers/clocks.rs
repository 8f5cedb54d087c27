//! Times: in whatever unit, rounded, coarse, counted, begun anew or stopped.

use crate::swing::{RATE_HZ, Row, check, check_found, open, swing, table, told};
use host::recording::ReadOptions;
use host::recording::segment::{SegmentOptions, segment};

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

/// As C's `ctime` writes it, which shows whole seconds, and MATLAB's `datestr`.
#[test]
fn dates_with_the_month_by_its_name_are_times() {
    let of_c = |(t, a, _): Row| format!("{a:.5};Sun Mar  1 12:00:{:02} 2026", t as u32);
    check_found(&table("angle;systemTime\n", of_c), 1e-5, "coarser than the samples");
    let of_matlab = |(t, a, _): Row| format!("01-Mar-2026 12:00:{t:06.3},{a:.5}");
    check_found(&table("Time,angle\n", of_matlab), 1e-5, "");
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
    let stopped = table("t,theta\n", |(t, a, _)| format!("{:.2},{a:.5}", if t < 19.5 { t.min(14.5) } else { t }));
    let refused = open(stopped.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("14.5 s stands there 500 times in a row") && refused.contains("--rate"), "{refused}");
}

#[test]
fn more_digits_are_asked_for_only_where_there_are_too_few() {
    // In the second half a third of the rows has the time of the one before.
    let read = |digits: usize| {
        let row = |(t, a, _): Row| {
            let late = t > 10.0 && (100.0 * t).round() as u32 % 3 == 1;
            let t = if late { t - 0.01 } else { t };
            format!("{:.digits$},{a:.5}", t + 3e-3 * (77.0 * t).sin())
        };
        open(table("t,theta\n", row).as_bytes(), &ReadOptions::default()).unwrap_err()
    };
    assert!(read(9).contains("leave out the second of two such rows"), "{}", read(9));
    assert!(read(3).contains("export more digits of the time"), "{}", read(3));
}

#[test]
fn a_clock_that_stops_for_good_ends_the_recording() {
    let stopped = table("t,theta\n", |(t, a, _)| format!("{:.2},{a:.5}", t.min(15.0)));
    let recording = open(stopped.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let notes = recording.notes().join("; ");
    assert_eq!(recording.len(), 1501, "{notes}");
    assert!(
        notes.contains("the clock stops at 15: the 499 rows behind have no time") && notes.contains("--rate"),
        "{notes}"
    );
    check(&stopped, &ReadOptions { rate_hz: Some(100.0), ..ReadOptions::default() }, 1e-5, "");
}

/// As a program leaves them that made room for more.
#[test]
fn rows_of_zeros_behind_the_last_time_are_no_samples() {
    let swing = table("t,theta\n", |(t, a, _)| format!("{:.2},{a:.5}", t + 0.01));
    let recording = check_found(&(swing.clone() + &"0,0\n".repeat(700)), 1e-5, "700 rows of nothing but zeros");
    assert_eq!(recording.len(), swing.lines().count() - 1);
    // A clock that begins anew is another recording.
    let refused = open((swing + &"0,0.001\n".repeat(700)).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("time goes back"), "{refused}");
}

#[test]
fn the_unit_that_is_offered_is_one_in_which_a_pendulum_can_be_followed() {
    for (tick_s, suffix) in [(1e-3, "t=0:ms"), (1e-6, "t=0:us"), (1e-9, "t=0:ns")] {
        // Steps of 25 ms, and nothing that swings.
        let text: String = (1..300).map(|k| format!("{:.0},0.{}\n", 0.025 * f64::from(k) / tick_s, k % 2)).collect();
        let refused = open(format!("time,theta\n{text}").as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains(suffix), "{refused}");
    }
}

/// As robots log it: the header of a message, `timeval` of C, a message in one row without names.
#[test]
fn whole_seconds_and_the_rest_of_them_are_one_time() {
    let parts = |t: f64, unit: f64| {
        let ticks = ((1_699_809_380.6 + t) * unit).round();
        ((ticks / unit).floor(), ticks.rem_euclid(unit))
    };
    for (names, unit) in [("sec,nanosec", 1e9), ("secs,nsecs", 1e9), ("tv_sec,tv_usec", 1e6), ("t_s,t_ms", 1e3)] {
        let row = |(t, a, _): Row| format!("{},{},{a:.5}", parts(t, unit).0, parts(t, unit).1);
        let recording = check_found(&table(&format!("{names},theta\n"), row), 1e-5, "the rest of them: added");
        assert!(!recording.notes().join("; ").contains("coarser"), "{:?}", recording.notes());
        check_found(&table("", row), 1e-5, "0 holds the whole seconds of the time, and 1 the rest of them");
    }
    // When it arrived stands beside it, and is another time.
    let late = |(t, a, _): Row| {
        let (seconds, rest) = parts(t, 1e9);
        format!("{:.4},{seconds},{rest},{a:.5}", 1_699_809_380.6 + t + 3e-3 * (1.0 + (77.0 * t).sin()))
    };
    let text = table("Time,header.stamp.secs,header.stamp.nsecs,position\n", late);
    check_found(&text, 1e-5, "1 (header.stamp.secs) taken as the time, when it was measured, and not 0 (Time)");
    let bare = table("", |(t, a, _)| format!("{},{},,arm,pole,0.25,{a:.5}", parts(t, 1e9).0, parts(t, 1e9).1));
    let refused = open(bare.as_bytes(), &told("theta=9")).unwrap_err();
    assert!(refused.contains("no column 9;") && refused.contains("e.g. t=0,theta=6"), "{refused}");
    check_found(&bare, 1e-5, "column 6 read as the angle, the only one that swings");
    check(&bare, &told("t=0,theta=6"), 1e-5, "the rest of them: added");
}

#[test]
fn a_clock_of_whole_seconds_and_the_rest_of_each_are_one_time() {
    let of = |unit: f64| {
        move |(t, a, _): Row| {
            let late = t + 7.25 + 1e-9;
            format!("12:00:{:02},{},{a:.5}", late as u64, (late.fract() * unit) as u64)
        }
    };
    for (head, unit) in
        [("time,ms,angle\n", 1e3), ("Uhrzeit,Millisekunden,Winkel\n", 1e3), ("timestamp,microseconds,angle\n", 1e6)]
    {
        check_found(&table(head, of(unit)), 1e-5, "holds the rest of each: added");
    }
    // A count of milliseconds that goes on is another clock, and so is one that begins anew at other moments.
    let goes_on = |(t, a, _): Row| format!("12:00:{:02},{},{a:.5}", t as u64, (1e3 * t).round());
    check_found(&table("time,ms,angle\n", goes_on), 1e-5, "coarser than the samples");
    let apart = |(t, a, _): Row| format!("12:00:{:02},{},{a:.5}", t as u64, (1e3 * t + 400.0).round() as u64 % 1000);
    check_found(&table("time,ms,angle\n", apart), 1e-5, "coarser than the samples");
}

#[test]
fn how_many_samples_a_second_is_said_in_a_line_above_a_lone_column() {
    for head in [
        "fs=100\n",
        "# fs = 100 Hz\n",
        "Sample rate: 100 Hz\nangle (rad)\n",
        "# dt = 0.01\ntheta\n",
        "Abtastzeit: 10 ms\n",
    ] {
        check_found(&table(head, |(_, a, _)| format!("{a:.5}")), 1e-5, "100 samples a second, as a line above");
    }
    // What is said of a table with times is not needed.
    check_found(&table("fs=50\nt,theta\n", |(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, "");
    for head in ["fs=fast\n", "Sampling time: 20 s\n", "rate=100\n"] {
        let refused = open(table(head, |(_, a, _)| format!("{a:.5}")).as_bytes(), &ReadOptions::default()).unwrap_err();
        assert!(refused.contains("--"), "{head}: {refused}");
    }
}

#[test]
fn numbers_that_may_be_frames_are_said_to_be() {
    let tens = table("x y\n", |(t, a, _)| format!("{:.0} {a:.5}", 1000.0 * t));
    check_found(&tens, 1e-5, "in milliseconds");
    check_found(&tens, 1e-5, "if it counts frames or samples, --rate says how many rows a second");
    let odd = table("x y\n", |(t, a, _)| format!("{:.0} {a:.5}", 1e6 * t + if t > 1.0 { 3.0 } else { 0.0 }));
    let recording = check_found(&odd, 1e-5, "in microseconds");
    assert!(!recording.notes().join("; ").contains("frames"), "{:?}", recording.notes());
}

#[test]
fn frames_that_would_make_a_pendulum_of_a_hundred_metres_are_refused() {
    let frames: String = swing(25, 40).iter().enumerate().map(|(n, (_, a, _))| format!("{n} {a:.5}\n")).collect();
    let refused = open(format!("x y\n{frames}").as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("nothing states the unit of the time") && refused.contains("--rate 30"), "{refused}");
    let at_25_hz = ReadOptions { rate_hz: Some(25.0), ..ReadOptions::default() };
    let recording = open(format!("x y\n{frames}").as_bytes(), &at_25_hz).unwrap();
    assert!((recording.step_s() - 0.04).abs() < 1e-9 && !recording.notes().join("; ").contains("doubtful"));
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
fn times_since_the_row_before_are_added_up() {
    // Milliseconds that scatter by one as rounded steps do; the sum is off by half a one at most.
    let ms = |t: f64| (1000.0 * t + 3.0 * (7.0 * t).sin()).round();
    let steps = table("angle,elapsed\n", |(t, a, _)| format!("{a:.5},{}", ms(t + 0.01) - ms(t)));
    let recording = open(steps.as_bytes(), &ReadOptions::default()).unwrap();
    let notes = recording.notes().join("; ");
    assert!(notes.contains("the time since the row before: added up") && notes.contains("in milliseconds"), "{notes}");
    let (first_s, last_s) = (recording.times_s()[0], recording.times_s()[1999]);
    assert!((last_s - first_s - 19.99).abs() < 0.01, "{first_s} {last_s}");
    // Always the same, which nothing but the name tells from a clock that stopped.
    for (head, step) in [("dt,theta\n", "0.01"), ("dt_ms,theta\n", "10"), ("theta_ref,Δt (s),theta\n", "0,0.01")] {
        check_found(&table(head, |(_, a, _)| format!("{step},{a:.5}")), 1e-5, "added up");
    }
    let stands = open(table("t,theta\n", |(_, a, _)| format!("0.01,{a:.5}")).as_bytes(), &ReadOptions::default());
    assert!(stands.unwrap_err().contains("its clock stopped"));
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
fn times_that_a_video_rounded_are_even_again() {
    let truth = swing(30, 20);
    let rows = truth.iter().map(|(t, a, _)| format!("{t:.2},{a:.5}\n")).collect::<String>();
    let recording = open(format!("t,theta\n{rows}").as_bytes(), &ReadOptions::default()).unwrap();
    assert!(recording.notes().join("; ").contains("30.0000 a second"), "{:?}", recording.notes());
    let off_s = recording.times_s().iter().zip(&truth).map(|(time_s, row)| (time_s - row.0).abs()).fold(0.0, f64::max);
    assert!(off_s < 2e-4, "{off_s}");
}

#[test]
fn rows_that_stand_there_last_one_first_are_read_from_below() {
    let upside_down = |head: &str, row: &dyn Fn(Row) -> String| {
        let rows: Vec<String> = swing(RATE_HZ, 20).into_iter().rev().map(|values| row(values) + "\n").collect();
        format!("{head}{}", rows.concat())
    };
    let note = "the last row was the first in time";
    check_found(&upside_down("t,theta\n", &|(t, a, _)| format!("{t:.2},{a:.5}")), 1e-5, note);
    // A motor's column is turned round with it, and what counts the rows names no runs.
    let with_motor = |(t, a, _): Row| format!("{:.0},{:.0},{a:.5},{}", 100.0 * t, 1.7e12 + 1e3 * t, u8::from(t < 5.0));
    let recording = check_found(&upside_down("ID,ms,theta,pwm\n", &with_motor), 1e-5, note);
    let cut = segment(&recording, &SegmentOptions::default()).unwrap();
    assert!(cut.notes.join("; ").contains("moves between 0.00 and 4.99 s"), "{:?}", cut.notes);
    // One row that stands still among them: nobody knows what that clock did.
    let halting = upside_down("t,theta\n", &|(t, a, _)| format!("{:.2},{a:.5}", if t == 3.0 { 3.01 } else { t }));
    let refused = open(halting.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("time goes back from 19.99"), "{refused}");
}

#[test]
fn a_spreadsheets_apostrophe_before_what_was_typed_is_no_part_of_it() {
    check_found(&table("tiempo,ángulo\n", |(t, a, _)| format!("'0:0:{t:.2},{a:.5}")), 1e-5, "");
    check_found(&table("t,theta\n", |(t, a, _)| format!("'{t:.2},'{a:.5}")), 1e-5, "");
}
