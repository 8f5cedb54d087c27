//! Lines of monitors, spreadsheets and programs: what is a row, and where the names and units stand.

use crate::swing::{CENTIDEGREES, RATE_HZ, Row, check_found, open, swing, swing_from, table};
use host::recording::ReadOptions;

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
fn a_word_and_brackets_around_each_row_fall_off() {
    let log = |(t, a, v): Row| format!("log=[{:.0},{a:.5},{v:.3}]", 127_134.0 + 1e3 * t);
    check_found(&table("# log on\nlog=[t_ms,theta,omega]\n", log), 1e-5, "");
    let read = |(t, a, _): Row| format!("Read ({t:.2}, {a:.5})");
    check_found(&table("boot\n", read), 1e-5, "column 0 read as time");
}

#[test]
fn the_time_in_front_of_what_a_chip_logs_is_the_time() {
    let ms = |t: f64| 1055 + (1e3 * t).round() as u64;
    let in_brackets = |(t, a, v): Row| format!("[{}ms] angle={:.2} vel={v:.2}", ms(t), a.to_degrees());
    check_found(&table("", in_brackets), CENTIDEGREES, "read as degrees");
    let in_seconds = |(t, a, v): Row| format!("[{:.3} s] {a:.5}, {v:.2}", 0.3 + t);
    check_found(&table("boot\n", in_seconds), 1e-5, "");
    let with_level = |(t, a, _): Row| format!("I ({}) pendulum: angle: {:.2} deg", ms(t), a.to_degrees());
    check_found(&table("W (12) wifi: no network\n", with_level), CENTIDEGREES, "in milliseconds");
    let counts = |(t, a, v): Row| format!("[{}ms] enc={} vel={v:.2}", ms(t), (a * 652.0).round());
    let refused = open(table("", counts).as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(refused.contains("--columns t=0,theta=1:4096/turn"), "{refused}");
}

#[test]
fn degrees_and_minutes_are_degrees() {
    let sixtieths =
        |angle: f64| ((angle.to_degrees() * 3600.0).round().abs() as u64, if angle < 0.0 { "-" } else { "" });
    let minutes = |(t, a, _): Row| {
        let (seconds, sign) = sixtieths(a);
        format!("{t:.2};{sign}{}°{:.2}'", seconds / 3600, (seconds % 3600) as f64 / 60.0)
    };
    check_found(&table("t;theta\n", minutes), CENTIDEGREES, "");
    let seconds = |(t, a, _): Row| {
        let (seconds, sign) = sixtieths(a);
        format!("{t:.2},{sign}{}° {:02}′ {:02}″", seconds / 3600, seconds / 60 % 60, seconds % 60)
    };
    check_found(&table("t,theta\n", seconds), CENTIDEGREES, "");
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
        (
            list(&|(t, a, _)| format!("{{\"t\": {t:.2}, \"msg\": {{\"pole\": {{\"theta\": {a:.5}}}}}}}\n"))
                .replace(", {\"t", "{\"t"),
            "",
        ),
    ] {
        check_found(&text, 1e-5, note);
    }
}

#[test]
fn settings_above_the_rows_are_none_of_them() {
    let lone = table("trigger_deg, sample_rate, duration\n90, 100, 20\n", |(_, a, _)| format!("{a:.5}"));
    check_found(&lone, 1e-5, "\"90, 100, 20\" above the table are settings, no row, with 100 samples a second");
    let named = table("rate,seconds\n100,20\nt,theta\n", |(t, a, _)| format!("{t:.2},{a:.5}"));
    check_found(&named, 1e-5, "\"100,20\" above the table are settings, no row");
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
fn names_of_several_words_and_names_before_a_remark_are_found() {
    let columns = |(t, a, v): Row| format!("{t:8.2}   {a:9.5}   {v:9.4}");
    let recording = check_found(&table("time (s)   angle (rad)   ang. vel. (rad/s)\n", columns), 1e-5, "");
    assert!(recording.notes().is_empty(), "{:?}", recording.notes());
    let small = swing_from(0.05, RATE_HZ, 5).into_iter();
    let small = small.map(|(t, a, _)| format!("{t:.2} {:.4}\n", a.to_degrees())).collect::<String>();
    let text = format!("# t theta_degree | from a video of the bob\n{small}");
    let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap();
    assert!((recording.angles_rad()[0] - 0.05).abs() < 1e-5, "{:?}", recording.notes());
}

#[test]
fn a_heading_in_gbk_is_read() {
    // 时间(s),摆角(°),备注, small enough that nothing but the unit tells degrees.
    let heading = b"\xca\xb1\xbc\xe4(s),\xb0\xda\xbd\xc7(\xa1\xe3),\xb1\xb8\xd7\xa2\n".to_vec();
    let rows = swing_from(0.05, RATE_HZ, 5).into_iter();
    let rows = rows.map(|(t, a, _)| format!("{t:.2},{:.4},7\n", a.to_degrees())).collect::<String>();
    let recording = open(&[heading, rows.into_bytes()].concat(), &ReadOptions::default()).unwrap();
    assert!((recording.angles_rad()[0] - 0.05).abs() < 1e-5, "{:?}", recording.notes());
}

#[test]
fn a_point_in_one_cell_is_a_point() {
    let row = |(t, a, _): Row| format!("\"({:.1}, {:.1})\",{t:.2}", 600.0 + 4e3 * a.sin(), 100.0 + 4e3 * a.cos());
    let text = table("position,time\n", row);
    let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let off_rad = recording.angles_rad().iter().zip(swing(RATE_HZ, 20)).map(|(found, row)| (found - row.1).abs());
    assert!(off_rad.fold(0.0, f64::max) < 1e-3, "{:?}", recording.notes());
}

#[test]
fn a_row_that_is_stuck_to_the_names_is_left_out_and_said() {
    let text = table("t theta\n", |(t, a, _)| format!("{t:.2} {a:.5}")).replace("theta\n0.00", "theta0.00");
    let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap();
    let notes = recording.notes().join("; ");
    assert!(notes.contains("line 1: the first row stands behind the names"), "{notes}");
    assert!((recording.times_s()[0] - 0.01).abs() < 1e-9);
    let whole = table("t theta1\n", |(t, a, _)| format!("{t:.2} {a:.5}"));
    let recording = open(whole.as_bytes(), &ReadOptions::default()).unwrap();
    assert!(!recording.notes().join("; ").contains("behind the names"), "{:?}", recording.notes());
}
