//! Columns of a motor beside the angle: a swing that it drives is no free one.

use crate::swing::{CENTIDEGREES, Row, check_found, open, swing, table};
use host::recording::segment::{SegmentOptions, Segments, segment};
use host::recording::{ReadOptions, Recording};

fn cut(recording: &Recording) -> Segments {
    segment(recording, &SegmentOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn notes(name: &str, drive: impl Fn(Row) -> String) -> String {
    let text = table(&format!("t,theta,{name}\n"), |row| format!("{:.2},{:.5},{}", row.0, row.1, drive(row)));
    cut(&check_found(&text, CENTIDEGREES, "")).notes.join("; ")
}

#[test]
fn a_motor_that_is_on_all_the_time_is_doubted_in_whatever_language() {
    let hold = |(_, angle, velocity): Row| format!("{:.3}", -0.2 * angle - 0.1 * velocity);
    for name in ["pwm", "u", "Torque (Nm)", "Motorspannung [V]", "commande", "corriente (A)", "控制量", "motor_speed"]
    {
        let notes = notes(name, hold);
        assert!(notes.contains(&format!("doubtful: 2 ({name}) goes from -0.")), "{name}: {notes}");
        assert!(notes.contains("in 100 % of the free swing") && notes.contains("--from and --to"), "{notes}");
    }
}

#[test]
fn a_motor_that_stands_still_is_not_mentioned() {
    for still in ["0", "0.00", "1500", "", "off", "NaN"] {
        assert_eq!(notes("control", |_| still.to_owned()), "", "{still}");
    }
    let mut state = 7_u32;
    let mut trembling = (0..2000).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 16) / 65536.0
    });
    let trembling: Vec<f64> = trembling.by_ref().collect();
    let current = |(t, ..): Row| format!("{:.4}", 0.02 * trembling[(t * 100.0).round() as usize]);
    assert_eq!(notes("motor_current", current), "");
    // The voltage is that of the angle's own sensor, and nothing else is a motor's.
    assert_eq!(notes("voltage", |(_, angle, _)| format!("{:.4}", 2.5 + 0.8 * angle)), "");
    assert!(
        notes("voltage", |(_, angle, velocity)| format!("{:.4}", 0.8 * angle + 0.1 * velocity)).contains("doubtful")
    );
    for name in ["battery voltage", "temperature", "omega", "u_theta"] {
        assert_eq!(notes(name, |(_, _, velocity)| format!("{velocity:.3}")), "", "{name}");
    }
}

/// A motor swings it for ten seconds, to and fro as it would swing by itself, and is switched off.
fn switched_off(pause: &str) -> String {
    let driven = (0..1000).map(|idx| f64::from(idx) / 100.0).map(|t| {
        let phase = 6.3 * (t - 10.0);
        format!("{t:.2},{:.5},{:.3}\n", 1.0 * phase.cos() * (0.9 + 0.01 * t), (3.0 * phase).sin() * 12.0)
    });
    let free = swing(100, 15).into_iter().map(|(t, angle, _)| format!("{:.2},{angle:.5},{pause}\n", t + 10.0));
    driven.chain(free).collect()
}

#[test]
fn the_stretch_is_taken_in_which_the_motor_stands_still() {
    for pause in ["0", "0.004", "3"] {
        let recording =
            open(format!("t,theta,u\n{}", switched_off(pause)).as_bytes(), &ReadOptions::default()).unwrap();
        let segments = cut(&recording);
        let notes = segments.notes.join("; ");
        let begin_s = recording.times_s()[segments.free.start];
        assert!(!notes.contains("doubtful") && (9.9..10.3).contains(&begin_s), "{begin_s} {notes}");
        let taken = "2 (u) moves between 0.00 and 9.99 s: the free swing is taken where it stands still";
        assert!(notes.contains(taken), "{notes}");
    }
}

/// So weak that the motion does not show it.
#[test]
fn a_motor_that_nothing_else_tells_of_is_cut_off() {
    let text = table("t,theta,u\n", |(t, angle, _)| {
        format!("{t:.2},{angle:.5},{:.3}", if t < 8.0 { (3.0 * t).sin() } else { 0.0 })
    });
    let segments = cut(&check_found(&text, CENTIDEGREES, ""));
    assert!((799..830).contains(&segments.free.start), "{segments:?}");
}

#[test]
fn a_motor_that_goes_on_at_another_number_than_its_zero_is_doubted() {
    let text = format!("t,theta,u\n-0.01,1,0\n{}", switched_off("3"));
    let notes = cut(&open(text.as_bytes(), &ReadOptions::default()).unwrap()).notes.join("; ");
    assert!(notes.contains("doubtful: 2 (u) is 3, and not off, in 100 % of the free swing"), "{notes}");
}

#[test]
fn an_arm_that_moves_with_the_pendulum_is_doubted_and_one_that_is_held_is_not() {
    let said = |names: &str, arm: &dyn Fn(Row) -> f64| {
        let text = table(&format!("t,{names}\n"), |row| {
            format!("{:.2},{:.2},{:.2}", row.0, arm(row).to_degrees(), row.1.to_degrees())
        });
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        cut(&recording).notes.join("; ")
    };
    let same = |(_, angle, _): Row| -angle + 0.3;
    let loose = |(_, angle, velocity): Row| -0.05 * angle + 0.001 * velocity;
    assert!(said("arm_angle,pendulum_angle", &|(_, angle, _)| -0.05 * angle).contains("carries"));
    for names in ["arm_deg,pendulum_deg", "motor angle (deg),pendulum angle (deg)", "base_angle,pendulum_angle"] {
        let notes = said(names, &loose);
        assert!(notes.contains("doubtful: 1 (") && notes.contains("what carries the pendulum moves too"), "{notes}");
        assert_eq!(
            said(names, &|(t, ..)| if ((t * 100.0) as u64).is_multiple_of(7) { 1e-4 } else { 0.0 }),
            "",
            "{names}"
        );
    }
    // That of the same shaft, and in another unit.
    assert_eq!(said("motor_angle,pendulum_angle", &same), "");
    assert_eq!(said("arm_rad,pendulum_deg", &loose), "");
}

/// As where several runs stand in one file, of which the first has no such column.
#[test]
fn an_arm_of_which_the_first_rows_say_nothing_is_doubted_all_the_same() {
    let text = table("t,arm_deg,pendulum_deg\n", |(t, angle, velocity)| {
        let arm_deg = (-0.05 * angle + 0.001 * velocity).to_degrees();
        let arm = if t < 2.0 { String::new() } else { format!("{arm_deg:.2}") };
        format!("{t:.2},{arm},{:.2}", angle.to_degrees())
    });
    let notes = cut(&open(text.as_bytes(), &ReadOptions::default()).unwrap()).notes.join("; ");
    assert!(notes.contains("doubtful: 1 (arm_deg)"), "{notes}");
}

#[test]
fn what_the_user_chooses_is_doubted_where_a_motor_moves_in_it() {
    let recording = open(format!("t,theta,u\n{}", switched_off("0")).as_bytes(), &ReadOptions::default()).unwrap();
    let options = |from_s| SegmentOptions { from_s: Some(from_s), to_s: Some(20.0) };
    let said = |from_s| segment(&recording, &options(from_s)).unwrap().notes.join("; ");
    assert!(said(4.0).contains("doubtful: 2 (u) goes from -1"), "{}", said(4.0));
    assert!(!said(11.0).contains("(u)"), "{}", said(11.0));
}

/// Pushed to start the swing, a cart rolls on by 25 mm for a third of a second, and stands.
#[test]
fn a_swing_on_a_cart_begins_where_the_cart_stands() {
    let cart = |rolls_s: f64| {
        let text = table("time,PendPos,CartPos\n", |(t, a, _)| {
            let left = if t < rolls_s { (1.0 - t / rolls_s).powi(2) } else { 0.0 };
            format!("{t:.2},{a:.5},{:.5}", -0.078 + 0.025 * left + 1e-4 * (6.3 * t).sin())
        });
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap();
        segment(&recording, &SegmentOptions::default()).unwrap()
    };
    let rolling = cart(0.33);
    assert!((20..=33).contains(&rolling.free.start), "{rolling:?}");
    assert!(rolling.notes.iter().any(|note| note.contains("more in which 2 (CartPos) still moves")), "{rolling:?}");
    assert_eq!((cart(0.0).free.start, cart(0.0).notes), (0, Vec::new()));
}

#[test]
fn where_hardly_anything_swings_freely_because_a_motor_moves_it_that_is_said() {
    // A controller takes it from one angle to another, or somebody does.
    let told = |share: f64| {
        let row = |(t, ..): Row| {
            let angle = (0.4 * t).tanh() + 0.3 * (t - 9.0).tanh();
            format!("{t:.2},{angle:.5},{:.2}", if t < 20.0 * share { 1.5 + (0.3 * t).sin() } else { 0.0 })
        };
        let text = table("t,theta,torque\n", row);
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap();
        segment(&recording, &SegmentOptions::default()).unwrap_err().to_string()
    };
    let driven = told(0.8);
    assert!(driven.contains("because 2 (torque) moves it: it goes from 0 to 2.5"), "{driven}");
    assert!(driven.contains("is on in 80 % of the recording; record how it swings with the motor off"), "{driven}");
    let pushed = told(0.1);
    assert!(pushed.contains("release from a larger angle") && !pushed.contains("torque"), "{pushed}");
}
