mod hands;
mod noise;
mod refusals;
mod upright;

use super::*;

pub(super) const STEP_S: f64 = 0.005;

/// A pendulum with dry and viscous friction (ω0² = 70/s²), released from `angle_rad`, in steps of 0.1 ms.
fn swing(angle_rad: f64, duration_s: f64) -> Vec<f64> {
    moved_swing(angle_rad, duration_s, |_| 0.0)
}

/// The same with what somebody adds to its acceleration (rad/s²) at a time (s).
pub(super) fn moved_swing(angle_rad: f64, duration_s: f64, hand: impl Fn(f64) -> f64) -> Vec<f64> {
    let (mut angle, mut velocity) = (angle_rad, 0.0_f64);
    let mut angles = Vec::new();
    for step_idx in 0..(duration_s / 1e-4) as usize {
        if step_idx % 50 == 0 {
            angles.push(angle);
        }
        let gravity = -70.0 * angle.sin();
        let is_stuck = velocity.abs() < 1e-4 && gravity.abs() < 0.3;
        let acceleration = gravity - 0.3 * velocity.signum() - 0.1 * velocity + hand(1e-4 * step_idx as f64);
        velocity = if is_stuck { 0.0 } else { velocity + 1e-4 * acceleration };
        angle += 1e-4 * velocity;
    }
    angles
}

pub(super) fn noisy(angles_rad: &[f64]) -> Recording {
    let mut state = 17_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let noise_rad = 1e-3 * 12f64.sqrt();
    Recording::uniform(1.0 / STEP_S, angles_rad.iter().map(|angle| angle + noise_rad * uniform()).collect()).unwrap()
}

fn in_noise(angles_rad: &[f64], rms_rad: f64) -> Segments {
    let mut noise = crate::random::Noise::new(1);
    let angles_rad = angles_rad.iter().map(|angle| angle + rms_rad * noise.normal()).collect();
    segment(&Recording::uniform(1.0 / STEP_S, angles_rad).unwrap(), &SegmentOptions::default()).unwrap()
}

pub(super) fn find(angles_rad: &[f64]) -> Segments {
    segment(&noisy(angles_rad), &SegmentOptions::default()).unwrap()
}

#[test]
fn a_held_pendulum_is_free_just_after_its_release() {
    for angle_rad in [-2.5, -0.3, 0.15, 0.8, 1.57, 2.8] {
        let held = vec![angle_rad; 100];
        let segments = find(&[held, swing(angle_rad, 20.0)].concat());
        let late = segments.free.start as f64 * STEP_S - 0.5;
        assert!((0.0..0.06).contains(&late), "{angle_rad}: {late} {segments:?}");
        assert!(segments.notes[0].contains("held still before the release"), "{segments:?}");
    }
}

/// Four to six samples a swing of 0.75 s, at uneven times as somebody picks frames, read to a degree: a top between them is off
/// by more than a swing loses.
#[test]
fn tops_between_few_samples_are_no_growth() {
    let all = swing(0.5, 12.0);
    for first_seed in 1..12_u64 {
        let (mut random, mut idx, mut rows) = (crate::random::Noise::new(first_seed), 0_usize, Vec::new());
        while idx < all.len() {
            rows.push((idx as f64 * STEP_S, all[idx].to_degrees().round().to_radians()));
            idx += (29.0 + 6.0 * random.normal().clamp(-2.0, 2.0)) as usize;
        }
        let (times_s, angles_rad) = rows.into_iter().unzip();
        let few = Recording::new(crate::Header::default(), times_s, angles_rad, None).unwrap();
        let found = segment(&few, &SegmentOptions::default()).unwrap();
        assert_eq!(found.free.start, 0, "{first_seed} {found:?}");
        assert!(!found.notes.iter().any(|note| note.contains("other than gravity")), "{first_seed} {found:?}");
    }
}

/// A hold of some samples, and twelve or eight of a swing of 0.75 s: too few for accelerations.
#[test]
fn a_hold_of_few_samples_a_swing_is_cut_and_a_swing_from_its_turn_is_not() {
    for every in [12, 18] {
        let rate_hz = 1.0 / (STEP_S * f64::from(every));
        let fewer = |angles_rad: &[f64]| {
            let mut noise = crate::random::Noise::new(2);
            let kept = angles_rad.iter().step_by(every as usize).map(|angle| angle + 1e-3 * noise.normal());
            segment(&Recording::uniform(rate_hz, kept.collect()).unwrap(), &SegmentOptions::default()).unwrap()
        };
        for n_held in [0, 3, 5, 7, 20] {
            for angle_rad in [0.1, 0.5, -0.9] {
                let held = vec![angle_rad; n_held * every as usize];
                let segments = fewer(&[held, swing(angle_rad, 20.0)].concat());
                // The sample at the release itself is one of the hold, and the next one may not have fallen far.
                let expected = if n_held == 0 { 0..=0 } else { n_held..=n_held + 2 };
                assert!(expected.contains(&segments.free.start), "{every} {n_held} {angle_rad} {segments:?}");
            }
        }
    }
}

/// Without the rows in between (s), whatever hangs or turns there.
fn find_past_hole(angles_rad: &[f64], from_s: f64, to_s: f64) -> Segments {
    let whole = noisy(angles_rad);
    let kept = || (0..whole.len()).filter(|idx| !(from_s..to_s).contains(&whole.times_s()[*idx]));
    let of = |list: &[f64]| kept().map(|idx| list[idx]).collect::<Vec<f64>>();
    let recording = Recording::new(whole.header().clone(), of(whole.times_s()), of(whole.angles_rad()), None).unwrap();
    segment(&recording, &SegmentOptions::default()).unwrap()
}

#[test]
fn a_hole_in_the_rows_that_hides_where_it_turned_is_bridged() {
    // A period takes 0.75 s at first.
    let free = swing(0.8, 20.0);
    for from in 0..25 {
        for length_s in [0.1, 0.2, 0.3, 0.5, 0.7] {
            let from_s = 5.0 + 0.03 * f64::from(from);
            let segments = find_past_hole(&free, from_s, from_s + length_s);
            assert!(segments.free.start == 0 && segments.notes.is_empty(), "{from_s} {length_s} {segments:?}");
        }
    }
}

#[test]
fn a_push_in_a_hole_of_the_rows_is_seen_behind_it() {
    // Along its way, for most of one half swing.
    let push = |t: f64| if (5.35..5.65).contains(&t) { -6.0 } else { 0.0 };
    let pushed = moved_swing(0.8, 20.0, push);
    let segments = find_past_hole(&pushed, 5.3, 5.7);
    let start_s = segments.free.start as f64 * STEP_S + 0.4;
    assert!((5.7..7.0).contains(&start_s), "{start_s} {segments:?}");
}

#[test]
fn a_push_at_the_release_begins_where_it_was_given() {
    for (angle_rad, push_rad_s) in [(1.2, 2.0), (1.2, 3.0), (0.4, 1.0), (0.4, -1.5), (-0.8, -2.0)] {
        let hand = |time_s: f64| if time_s < 1e-4 { push_rad_s / 1e-4 } else { 0.0 };
        let segments = find(&[vec![angle_rad; 240], moved_swing(angle_rad, 20.0, hand)].concat());
        let late = segments.free.start as f64 * STEP_S - 1.2;
        assert!((0.0..0.03).contains(&late), "{angle_rad}, {push_rad_s}: {late} {segments:?}");
    }
}

/// With so much noise that no acceleration shows whether it is held.
#[test]
fn a_knock_on_a_held_pendulum_is_no_release() {
    let knocked = |idx: usize| if (122..128).contains(&idx) { 1.43 + 0.012 } else { 1.43 };
    let whole = [(0..170).map(knocked).collect(), swing(1.43, 20.0)].concat();
    let third: Vec<f64> = whole.iter().map(|angle| angle / 3.0).collect();
    let angles_rad = noisy(&third).angles_rad().iter().map(|angle| 3.0 * angle).collect();
    let recording = Recording::uniform(1.0 / STEP_S, angles_rad).unwrap();
    let segments = segment(&recording, &SegmentOptions::default()).unwrap();
    let late = segments.free.start as f64 * STEP_S - 0.85;
    assert!((0.0..0.06).contains(&late), "{late} {segments:?}");
}

/// Ten samples a second, eight a period, are too few to see a hand, and enough to see a pendulum that does not fall.
#[test]
fn a_held_pendulum_is_seen_between_few_samples() {
    let whole = [vec![1.2; 200], swing(1.2, 20.0)].concat();
    let recording = Recording::uniform(10.0, noisy(&whole).angles_rad().iter().step_by(20).copied().collect()).unwrap();
    let segments = segment(&recording, &SegmentOptions::default()).unwrap();
    assert!((10..12).contains(&segments.free.start), "{segments:?}");
}

#[test]
fn a_swing_begins_where_it_has_left_upright() {
    let angle_rad = 3.13;
    let whole = [vec![angle_rad; 100], swing(angle_rad, 20.0)].concat();
    let segments = find(&whole);
    let left = std::f64::consts::PI - whole[segments.free.start];
    assert!((0.19..0.3).contains(&left), "{left} {segments:?}");
    assert!(segments.notes[1].contains("near upright"), "{segments:?}");
    let asked = SegmentOptions { from_s: Some(0.6), to_s: None };
    assert_eq!(segment(&noisy(&whole), &asked).unwrap().free.start, 120);
}

#[test]
fn what_jumps_before_the_release_is_no_noise_of_the_swing() {
    let put_down = [vec![1.7; 60], vec![0.0; 60], vec![0.9; 100], swing(0.9, 20.0)].concat();
    let segments = find(&put_down);
    assert!((segments.noise.total_rms / 1e-3 - 1.0).abs() < 0.05, "{segments:?}");
}

#[test]
fn a_recording_that_begins_with_the_release_is_kept_whole() {
    let segments = find(&swing(1.0, 8.0));
    assert_eq!(segments.free, 0..1600);
    assert_eq!((segments.lead_in, segments.rest), (None, None));
    assert!(segments.notes.is_empty());
}

/// On a spring of 11 % of gravity that gives way at 0.02 rad: the small swings are faster than the large ones, and most
/// of the recording is small swings. The sensor has steps of 0.1 mrad.
#[test]
fn large_swings_that_a_pivot_slows_are_not_cut_off() {
    let (mut angle, mut velocity, mut bent) = (0.15_f64, 0.0_f64, 0.0_f64);
    let mut angles = Vec::new();
    for step_idx in 0..1_500_000 {
        if step_idx % 50 == 0 {
            angles.push((1e4 * angle).round() / 1e4);
        }
        velocity += 1e-4 * (-70.0 * f64::sin(angle) - 8.0 * bent - 0.08 * velocity);
        angle += 1e-4 * velocity;
        bent = (bent + 1e-4 * velocity).clamp(-0.02, 0.02);
    }
    let recording = Recording::uniform(1.0 / STEP_S, angles).unwrap();
    let segments = segment(&recording, &SegmentOptions::default()).unwrap();
    assert_eq!(segments.free.start, 0, "{:?}", segments.notes);
}

/// Dry friction that lets go below 0.02 rad, where the string no longer rubs: most of the recording is the tail, seen 30
/// times a second with 0.3 mrad of noise.
#[test]
fn large_swings_that_rub_are_not_cut_off_before_a_long_tail_that_does_not() {
    let (mut angle, mut velocity) = (0.15_f64, 0.0_f64);
    let mut angles = Vec::new();
    let mut state = 17_u64;
    for step_idx in 0..3_200_000_u32 {
        if step_idx % 333 == 0 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            angles.push(angle + 1e-3 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5));
        }
        let energy = velocity * velocity / 2.0 + 100.0 * (1.0 - f64::cos(angle));
        let dry = if energy > 0.5 * 100.0 * 0.02 * 0.02 { 0.12 * velocity.signum() } else { 0.0 };
        velocity += 1e-4 * (-100.0 * f64::sin(angle) - dry - 0.02 * velocity);
        angle += 1e-4 * velocity;
    }
    let recording = Recording::uniform(1.0 / 0.0333, angles).unwrap();
    let segments = segment(&recording, &SegmentOptions::default()).unwrap();
    assert_eq!(segments.free.start, 0, "{:?}", segments.notes);
}

/// Seen of an encoder that tells one side of the swing much larger than the other.
#[test]
fn regular_swings_that_are_cut_are_doubted() {
    let doubts = |angles_rad: &[f64]| {
        let segments = find(angles_rad);
        let doubted = segments.notes.iter().find(|note| note.contains("die away one after the other")).cloned();
        (segments.free.start, doubted)
    };
    for uneven in [0.3, 0.4, 0.5] {
        let read = |angle: &f64| angle + uneven * angle * angle;
        let (cut, doubted) = doubts(&moved_swing(0.9, 40.0, |_| 0.0).iter().map(read).collect::<Vec<f64>>());
        assert!(cut > 500 && doubted.is_some_and(|note| note.contains("--from 0.39 takes them")), "{uneven} {cut}");
    }
    // A motor holds a swing, or lets it grow.
    for grows in [0.0, 0.02] {
        let held = |idx: u32| {
            let time_s = f64::from(idx) * STEP_S;
            0.5 * (grows * time_s).exp() * (69_f64.sqrt() * time_s).cos()
        };
        let driven: Vec<f64> = (0..3030).map(held).collect();
        let largest = 0.5 * (grows * 15.0).exp();
        let (cut, doubted) = doubts(&[driven, moved_swing(largest, 25.0, |_| 0.0)].concat());
        assert!(cut > 2000 && doubted.is_none(), "{grows} {cut} {doubted:?}");
    }
}

/// Seen of the exciter of a torsion pendulum, whose counter jumped: a beginning of few half swings can't tell that nothing is lost.
#[test]
fn a_beginning_that_a_motor_holds_is_not_said_to_die_away() {
    for jump_s in [5.0, 6.0, 7.0, 8.0] {
        let angle = |idx: u32| {
            let time_s = f64::from(idx) * STEP_S;
            let jumped = 0.3 * (time_s - jump_s).clamp(0.0, 0.04) / 0.04;
            0.5 * (36_f64.sqrt() * time_s).cos() + jumped
        };
        let notes = find(&(0..7000).map(angle).collect::<Vec<f64>>()).notes;
        assert!(notes.iter().any(|note| note.contains("don't become smaller")), "{jump_s} {notes:?}");
        assert!(!notes.iter().any(|note| note.contains("die away one after")), "{jump_s} {notes:?}");
    }
}

/// Seen of a wheel that a motor keeps going, of which a sensor of 0.01 rad is read ten times a second.
#[test]
fn a_motor_that_keeps_a_swing_going_is_doubted_whatever_a_coarse_sensor_makes_of_it() {
    let doubted = |period_s: f64, phase: f64, loses: f64| {
        let mut noise = crate::random::Noise::new((100.0 * (period_s + phase)) as u64);
        let mut angle = |idx: u32| {
            let time_s = f64::from(idx) / 10.0;
            let angle = 0.36 * f64::exp(-loses * time_s) * f64::sin(time_s * std::f64::consts::TAU / period_s + phase);
            ((angle + 0.004 * noise.normal()) / 0.01).round() * 0.01
        };
        let recording = Recording::uniform(10.0, (0..357).map(&mut angle).collect()).unwrap();
        let notes = segment(&recording, &SegmentOptions::default()).unwrap().notes;
        notes.iter().any(|note| note.contains("don't become smaller"))
    };
    let cases: Vec<(f64, f64)> =
        (0..24).map(|idx| (1.5 + 0.03 * f64::from(idx % 8), 0.7 * f64::from(idx / 8))).collect();
    let count = |loses: f64| cases.iter().filter(|(period_s, phase)| doubted(*period_s, *phase, loses)).count();
    assert!(count(0.0) >= 23, "{}", count(0.0));
    // Free ones that lose 0.3 % from swing to swing, and more.
    assert_eq!([count(0.002), count(0.008)], [0, 0]);
}

/// Gates on leaning hinges, whose swings lose a tenth of themselves and more and end in the noise, and a pendulum on a cart that stands,
/// with holes in its rows.
#[test]
fn swings_that_lose_much_and_end_in_noise_or_have_holes_are_not_doubted() {
    for name in ["caspar_gate_11mm", "caspar_gate_75mm", "caspar_gate_no_magnet", "pendulepi_release_a"] {
        let file = format!("{}/../data/recordings/real/more/{name}.csv", env!("CARGO_MANIFEST_DIR"));
        let recording = crate::read(std::path::Path::new(&file), &crate::ReadOptions::default()).unwrap();
        let segments = segment(&recording, &SegmentOptions::default()).unwrap();
        assert!(segments.fades, "{name} {segments:?}");
    }
}

/// A coil adds 1.2 % to each half swing, seen at 20 Hz, twelve samples a period: no step is a growth for certain.
#[test]
fn a_few_swings_that_grow_are_doubted_and_a_few_free_ones_are_not() {
    for (grows, doubted) in [(0.04, true), (-0.04, false), (0.0, false)] {
        let angle = |idx: u32| {
            let time_s = f64::from(idx) / 20.0;
            0.9 * f64::exp(grows * time_s) * f64::cos(10.0 * time_s)
        };
        let recording = Recording::uniform(20.0, (0..100).map(angle).collect()).unwrap();
        let notes = segment(&recording, &SegmentOptions::default()).unwrap().notes;
        assert_eq!(notes.iter().any(|note| note.contains("don't become smaller")), doubted, "{grows} {notes:?}");
        let told = notes.iter().any(|note| note.contains("but grow from 0.94 to 1.1 rad to either side"));
        assert_eq!(told, doubted, "{grows} {notes:?}");
    }
}

/// Each half swing is 5 % larger than the one before: no two of them are free.
#[test]
fn a_swing_that_grows_throughout_is_told_from_one_that_is_too_short() {
    let angle = |idx: u32| {
        let time_s = f64::from(idx) * STEP_S;
        0.05 * f64::exp(0.1 * time_s) * f64::sin(6.0 * time_s)
    };
    let growing: Vec<f64> = (0..4000).map(angle).collect();
    let growing = Recording::uniform(1.0 / STEP_S, growing).unwrap();
    let told = segment(&growing, &SegmentOptions::default()).unwrap_err().to_string();
    assert!(told.starts_with("its swings grow, from 0.05"), "{told}");
    assert!(told.contains(" to 0.35 rad to either side, where free ones die away"), "{told}");
    assert!(told.contains("--from and --to"), "{told}");
    let short = noisy(&swing(0.5, 0.9));
    let told = segment(&short, &SegmentOptions::default()).unwrap_err();
    assert!(matches!(told, SegmentError::TooFewSwings { .. }), "{told}");
}

#[test]
fn a_hand_that_ends_the_swing_is_cut() {
    let mut angles_rad = swing(1.2, 8.0);
    let caught_rad = angles_rad[1200];
    angles_rad.iter_mut().skip(1200).for_each(|angle| *angle = caught_rad);
    let segments = find(&angles_rad);
    assert!((1100..=1205).contains(&segments.free.end), "{segments:?}");
    assert!(segments.notes[0].contains("cut everything after"), "{segments:?}");
}

#[test]
fn of_two_swings_in_one_recording_the_longer_one_is_taken() {
    let segments = find(&[swing(0.8, 4.0), vec![1.0; 100], swing(1.0, 12.0)].concat());
    let start_s = segments.free.start as f64 * STEP_S;
    assert!((4.5..4.7).contains(&start_s), "{segments:?}");
}

#[test]
fn a_push_in_the_middle_divides_the_swing() {
    let first = swing(0.7, 3.0);
    let last_rad = *first.last().unwrap();
    let pushed: Vec<f64> = (0..80).map(|idx| last_rad + (1.4 - last_rad) * f64::from(idx) / 80.0).collect();
    let segments = find(&[first, pushed, swing(1.4, 10.0)].concat());
    let start_s = segments.free.start as f64 * STEP_S;
    assert!((3.39..3.6).contains(&start_s), "{segments:?}");
}

/// Lifted slowly enough that no acceleration tells of a hand, after it has hung still: 0.2 rad in 8 s.
#[test]
fn a_swing_that_is_picked_up_again_long_after_is_kept() {
    let hanging = vec![0.0; 1000];
    let rise = |idx: i32| 0.2 * (f64::from(idx) / 1600.0).powi(2) + 0.03 * (f64::from(idx) / 100.0).sin();
    let trembling: Vec<f64> = (0..1600).map(rise).collect();
    let segments = find(&[swing(0.8, 20.0), hanging, trembling].concat());
    assert!(segments.free.start < 10 && segments.n_turning_points > 30, "{segments:?}");
    assert!((3000..5400).contains(&segments.free.end), "{segments:?}");
}

/// To either side of where it last turned, in a noise that hides it in accelerations.
#[test]
fn a_hand_that_lifts_a_resting_pendulum_at_the_end_is_cut() {
    for lifted_rad in [1.0, -1.0] {
        let lift = |idx: i32| lifted_rad * f64::from(idx.min(200)) / 200.0;
        let whole = [swing(0.8, 20.0), vec![0.0; 200], (0..400).map(lift).collect()].concat();
        let segments = in_noise(&whole, 0.02);
        assert!((3900..4300).contains(&segments.free.end), "{lifted_rad} {segments:?}");
    }
}

/// Eight samples a half swing, as of a slow video: what turns may be back at its mean whenever it is looked at.
#[test]
fn between_few_samples_a_swing_begins_where_the_recording_does() {
    let mut noise = crate::random::Noise::new(3);
    let whole = swing(0.8, 20.0);
    for first in 0..32 {
        let few: Vec<f64> = whole[5 * first..].iter().step_by(10).map(|angle| angle + 0.01 * noise.normal()).collect();
        let segments = segment(&Recording::uniform(0.1 / STEP_S, few).unwrap(), &SegmentOptions::default()).unwrap();
        assert_eq!(segments.free.start, 0, "{first} {segments:?}");
    }
}

/// Seen in lines of a quarter of a degree, of which one lies where it hangs.
fn in_lines(angles_rad: impl Iterator<Item = f64>) -> Segments {
    let line_rad = 0.25_f64.to_radians();
    let angles_rad = angles_rad.map(|angle| (angle / line_rad).round() * line_rad).collect();
    segment(&Recording::uniform(1.0 / STEP_S, angles_rad).unwrap(), &SegmentOptions::default()).unwrap()
}

#[test]
fn what_hung_still_until_a_hand_lifted_it_is_free_from_its_largest_swing_on() {
    for lift_s in [0.5, 0.65, 1.0, 2.0] {
        let n_lift = (lift_s / STEP_S) as usize;
        let lift = |idx: usize| 0.1 * (1.0 - (std::f64::consts::PI * idx as f64 / n_lift as f64).cos());
        let lead_in = [vec![0.0; 500], (0..n_lift).map(lift).collect()].concat();
        let let_go_s = lead_in.len() as f64 * STEP_S;
        // Where it hangs lies between two lines.
        let segments = in_lines([lead_in, swing(0.2, 20.0)].concat().into_iter().map(|angle| angle + 1.5e-3));
        let late_s = segments.free.start as f64 * STEP_S - let_go_s;
        assert!((-0.1..0.8).contains(&late_s), "{lift_s} {late_s} {segments:?}");
    }
}

/// Held still by a hand that then moves it farther off before it opens.
#[test]
fn a_hand_that_moves_it_once_more_is_no_noise_of_the_sensor_either() {
    let trembling = (0..400).map(|idx| 0.8 + 4e-3 * (0.11 * f64::from(idx)).sin());
    let farther = (0..160).map(|idx| 0.8 + 0.2 * (1.0 - (0.02 * f64::from(idx)).cos()) / 2.0);
    let segments = find(&[trembling.chain(farther).collect(), swing(1.0, 12.0)].concat());
    assert!(
        segments.notes[0].contains("s, and then it does not follow a free swing (a hand,") && segments.rest.is_none(),
        "no case: {segments:?}"
    );
    assert!((segments.noise.level_rad() / 1e-3 - 1.0).abs() < 0.05, "{:?}", segments.noise);
}

#[test]
fn sizes_that_fall_by_whole_lines_are_no_motor_that_was_switched_off() {
    for (size_rad, lasts_s) in [(0.05, 60.0), (0.04, 90.0), (0.07, 45.0)] {
        let angle = |idx: u32| {
            let time_s = f64::from(idx) * STEP_S;
            size_rad * (-time_s / lasts_s).exp() * (5.34 * time_s).cos()
        };
        let segments = in_lines((0..14_000).map(angle));
        assert_eq!(segments.free.start, 0, "{size_rad} {segments:?}");
    }
}

/// Hung still, lifted, held, let go: rms noises in mrad and holds in s, in swings of 0.68 rad.
#[test]
fn a_hand_that_lifts_and_holds_is_cut_in_noise_up_to_a_tenth_of_the_swing() {
    for (noise_mrad, hold_s) in [(1.0, 0.3), (3.0, 0.3), (3.0, 3.0), (10.0, 1.0), (30.0, 1.0), (68.0, 1.0)] {
        for lift_s in [0.35, 1.0] {
            let n_lift = (lift_s / STEP_S) as usize;
            let lift = |idx: usize| -0.34 * (1.0 - (std::f64::consts::PI * idx as f64 / n_lift as f64).cos());
            let n_hold = (hold_s / STEP_S) as usize;
            let lead_in = [vec![0.0; 280], (0..n_lift).map(lift).collect(), vec![-0.68; n_hold]].concat();
            let release_s = lead_in.len() as f64 * STEP_S;
            let truth = [lead_in, swing(-0.68, 17.0)].concat();
            let segments = in_noise(&truth, 1e-3 * noise_mrad);
            let late_s = segments.free.start as f64 * STEP_S - release_s;
            assert!((-0.01..0.2).contains(&late_s), "{noise_mrad} {hold_s} {lift_s}: {late_s} {segments:?}");
        }
    }
}

/// A hand that is seen for 0.1 s and then adds a tenth of gravity until it lets go, in the first half swing.
#[test]
fn a_hand_that_moves_it_a_little_until_it_lets_go_is_cut() {
    let hand = |time_s: f64| if time_s < 0.1 { 60.0 } else { 2.1 };
    let moved = moved_swing(0.3, 15.0, |time_s| if time_s < 0.45 { hand(time_s) } else { 0.0 });
    let segments = find(&moved);
    let start_s = segments.free.start as f64 * STEP_S;
    assert!((0.4..1.2).contains(&start_s), "{start_s} {segments:?}");
}

/// Forced vibration at the natural frequency, then nothing: amplitudes stay, then they fall.
#[test]
fn a_motor_that_is_switched_off_is_cut() {
    for (driven_s, free_s) in [(60.0, 20.0), (20.0, 60.0)] {
        let n_driven = (driven_s / STEP_S) as usize;
        let left_alone = |time_s: f64| (-(time_s - driven_s).max(0.0) / 15.0).exp();
        let angle = |idx: usize| {
            let time_s = idx as f64 * STEP_S;
            0.3 * left_alone(time_s) * (70_f64.sqrt() * time_s).cos()
        };
        let n_all = n_driven + (free_s / STEP_S) as usize;
        let segments = find(&(0..n_all).map(angle).collect::<Vec<f64>>());
        let late_s = segments.free.start as f64 * STEP_S - driven_s;
        assert!((-1.0..2.0).contains(&late_s) && segments.fades, "{late_s} {segments:?}");
        assert!(segments.notes[0].contains("a motor"), "{segments:?}");
    }
}

/// A twentieth of the swing is noise: hardly any pair of turns tells where it was switched off, but all together do.
#[test]
fn a_motor_that_is_switched_off_is_cut_in_loud_noise_too() {
    let size = |time_s: f64| 0.3 * (-(time_s - 60.0).max(0.0) / 22.0).exp();
    let angle = |idx: u32| size(f64::from(idx) * STEP_S) * (70_f64.sqrt() * f64::from(idx) * STEP_S).cos();
    let segments = in_noise(&(0..24_000).map(angle).collect::<Vec<f64>>(), 0.015);
    let start_s = segments.free.start as f64 * STEP_S;
    assert!((58.0..66.0).contains(&start_s), "{start_s} {segments:?}");
}

/// Ten half swings that lose a share of their size, then six that lose another one, as friction does that changes with the
/// place: of so few, eight times as much is wanted.
#[test]
fn a_motor_that_is_switched_off_shortly_before_the_end_is_cut_where_it_held_the_swing() {
    let half_swing_s = std::f64::consts::PI / 70_f64.sqrt();
    let start_s = |lost_before: f64, lost_after: f64| {
        let angle = |idx: usize| {
            let n = idx as f64 * STEP_S / half_swing_s;
            let left = 1.0 - lost_before * n.min(10.0) - lost_after * (n - 10.0).max(0.0);
            0.5 * left * (std::f64::consts::PI * n).cos()
        };
        let n_all = (16.3 * half_swing_s / STEP_S) as usize;
        find(&(0..n_all).map(angle).collect::<Vec<f64>>()).free.start as f64 * STEP_S
    };
    let held_s = start_s(0.001, 0.1);
    assert!((8.0..11.0).contains(&(held_s / half_swing_s)), "{held_s}");
    let free_s = start_s(0.02, 0.1);
    assert!(free_s < half_swing_s, "{free_s}");
}

/// A camera at 60 pictures a second that stamps them 3 ms early or late: 15 mrad where it swings fast, nothing where it rests.
#[test]
fn readings_that_are_stamped_late_are_no_hand_where_the_swing_is_fast() {
    let mut noise = crate::random::Noise::new(1);
    let mut angle = |idx: u32| {
        let time_s = f64::from(idx) / 60.0 + 3e-3 * noise.normal();
        0.6 * (-time_s / 4.0).exp() * (70_f64.sqrt() * time_s).cos() + 5e-5 * noise.normal()
    };
    let recording = Recording::uniform(60.0, (0..1500).map(&mut angle).collect()).unwrap();
    let segments = segment(&recording, &SegmentOptions::default()).unwrap();
    assert!(segments.free.start < 30, "{segments:?}");
}

/// Little friction; for three half swings after a minute a tracker sees two thirds of the swing, and then all of it again.
#[test]
fn where_a_tracker_loses_some_swings_no_motor_is_switched_off_before() {
    let half_swing_s = std::f64::consts::PI / 70_f64.sqrt();
    let angle = |idx: u32| {
        let time_s = f64::from(idx) * STEP_S;
        let size_rad = 0.3 * (-time_s / 300.0).exp();
        let seen = if (159.5..162.5).contains(&(time_s / half_swing_s)) { 0.67 } else { 1.0 };
        seen * size_rad * (70_f64.sqrt() * time_s).cos()
    };
    let segments = find(&(0..18_000).map(angle).collect::<Vec<f64>>());
    let (start_s, end_s) = (segments.free.start as f64 * STEP_S, segments.free.end as f64 * STEP_S);
    assert!(start_s < 1.0 && (59.0..62.0).contains(&end_s), "{segments:?}");
}

/// From 0.2 rad down to 5 mrad, which a tracker of few pixels sees for forty seconds, and then less again.
#[test]
fn a_tail_that_a_tracker_follows_in_steps_is_no_motor_that_is_switched_off() {
    let size_rad = |time_s: f64| match 0.2 * (-time_s / 20.0).exp() {
        size_rad if time_s < 74.0 => size_rad,
        _ => 5e-3 * (-(time_s - 114.0).max(0.0) / 15.0).exp(),
    };
    let angle = |idx: u32| size_rad(f64::from(idx) * STEP_S) * (70_f64.sqrt() * f64::from(idx) * STEP_S).cos();
    let segments = in_noise(&(0..27_000).map(angle).collect::<Vec<f64>>(), 1e-7);
    assert!((segments.free.start as f64) * STEP_S < 1.0, "{segments:?}");
}

/// At 25 samples a second, as a camera takes them.
#[test]
fn a_reading_on_the_other_side_does_not_make_small_swings_a_rest() {
    let mut angles_rad: Vec<f64> = noisy(&swing(0.6, 20.0)).angles_rad().iter().step_by(8).copied().collect();
    let of_camera = |angles_rad: &[f64]| {
        segment(&Recording::uniform(25.0, angles_rad.to_vec()).unwrap(), &SegmentOptions::default()).unwrap()
    };
    let clean = of_camera(&angles_rad);
    angles_rad[9] = -angles_rad[9];
    let spoilt = of_camera(&angles_rad);
    assert_eq!((clean.free.end, clean.rest), (spoilt.free.end, spoilt.rest), "{:?}", spoilt.notes);
}

/// A motor holds the swing for a minute, then something strikes it twice: what lies between is too short to be free.
#[test]
fn a_short_piece_beside_a_driven_swing_is_not_taken_for_a_free_one() {
    let angle = |idx: u32| {
        let time_s = f64::from(idx) * STEP_S;
        // Moved by so much within 0.05 s.
        let struck = |at_s: f64, by_rad: f64| by_rad * (time_s - at_s).clamp(0.0, 0.05) / 0.05;
        0.5 * (70_f64.sqrt() * time_s).cos() + struck(60.0, 0.2) + struck(61.2, -0.4)
    };
    let segments = find(&(0..12_400).map(angle).collect::<Vec<f64>>());
    assert!(segments.n_turning_points > 100 && !segments.fades, "{segments:?}");
}

#[test]
fn limits_before_the_recordings_own_clock_are_noted() {
    let angles_rad = swing(1.0, 12.0);
    let times_s: Vec<f64> = (0..angles_rad.len()).map(|idx| 270.0 + idx as f64 * STEP_S).collect();
    let late = Recording::new(noisy(&angles_rad).header().clone(), times_s, angles_rad, None).unwrap();
    let asked = SegmentOptions { from_s: Some(2.0), to_s: None };
    let notes = segment(&late, &asked).unwrap().notes;
    assert!(notes[0].contains("its own clock starts at 270 s"), "{notes:?}");
    // Between two samples of it is no time before it.
    let notes = segment(&late, &SegmentOptions { from_s: Some(271.002), to_s: None }).unwrap().notes;
    assert!(!notes.is_empty() && notes.iter().all(|note| !note.contains("its own clock")), "{notes:?}");
}

#[test]
fn a_hanging_angle_that_is_not_zero_does_not_matter() {
    let angles_rad: Vec<f64> = [vec![0.9; 100], swing(0.9, 25.0)].concat().iter().map(|angle| angle + 0.2).collect();
    let segments = find(&angles_rad);
    assert!((100..112).contains(&segments.free.start), "{segments:?}");
    assert!(segments.rest.is_some(), "{segments:?}");
}
