use super::*;

/// Places of a swing with these gains, each beyond chance and without anything else left.
fn places_of(gains: &[f64]) -> Vec<Place> {
    let place = |(k, gain): (usize, &f64)| Place {
        time_s: k as f64,
        jump_rad_s: 0.1,
        std_rad_s: 1e-3,
        gain: *gain,
        chi_square: 1e4,
        share: 0.9,
        half_swing_s: 1.0,
    };
    gains.iter().enumerate().map(place).collect()
}

/// Alike, but at some places.
fn gains(n: usize, touched: &[(usize, f64)]) -> Vec<f64> {
    let mut gains = vec![1.0; n];
    touched.iter().for_each(|(at, gain)| gains[*at] = *gain);
    gains
}

#[test]
fn one_place_that_stands_far_out_of_the_others_is_a_touch_and_one_that_hardly_does_is_none() {
    assert_eq!(outstanding(&places_of(&gains(40, &[(20, 4.1)]))), [20]);
    assert_eq!(outstanding(&places_of(&gains(40, &[(20, 3.9)]))), [] as [usize; 0]);
    // Its own windows see it too.
    assert_eq!(outstanding(&places_of(&gains(40, &[(14, 20.0), (20, 40.0), (26, 20.0)]))), [20]);
}

#[test]
fn a_jump_that_chance_would_make_or_that_leaves_much_is_no_touch() {
    let said = |change: fn(&mut Place)| {
        let mut places = places_of(&gains(40, &[(20, 100.0)]));
        change(&mut places[20]);
        outstanding(&places)
    };
    assert_eq!(said(|_| ()), [20]);
    // 2·ln(4·40/10⁻³) is 24.0.
    assert_eq!([said(|place| place.chi_square = 23.9), said(|place| place.chi_square = 24.1)], [vec![], vec![20]]);
    assert_eq!([said(|place| place.share = 0.74), said(|place| place.share = 0.76)], [vec![], vec![20]]);
}

#[test]
fn two_touches_are_told_in_order_and_five_are_none() {
    assert_eq!(outstanding(&places_of(&gains(60, &[(40, 90.0), (15, 30.0)]))), [15, 40]);
    let many: Vec<(usize, f64)> = (0..5).map(|k| (10 + 20 * k, 50.0)).collect();
    assert_eq!(outstanding(&places_of(&gains(120, &many))), [] as [usize; 0]);
}

#[test]
fn a_swing_with_hardly_any_other_place_is_not_judged() {
    // Of ten places three are further than six from the first one, of eleven four.
    assert_eq!(outstanding(&places_of(&gains(10, &[(0, 100.0)]))), [] as [usize; 0]);
    assert_eq!(outstanding(&places_of(&gains(11, &[(0, 100.0)]))), [0]);
}

fn swing() -> Swing {
    let times_s: Vec<f64> = (0..2000).map(|i| 3.0 + 0.01 * f64::from(i)).collect();
    let angles_rad: Vec<f64> = times_s.iter().map(|t| (6.0 * t).cos()).collect();
    Swing::new("swing.csv", &times_s, &angles_rad, 1e-3)
}

/// A touch of a swing 4 s or 15 s behind its first sample.
fn touch(at_s: f64) -> Touch {
    Touch::of(0, &swing(), &Place { time_s: at_s, half_swing_s: 0.5, ..places_of(&[1.0])[0] })
}

#[test]
fn a_touch_is_told_in_the_time_of_the_recording_with_the_longer_part() {
    let (early, late) = (touch(4.0), touch(15.0));
    assert!((early.time_s - 7.0).abs() < 1e-9 && (late.time_s - 18.0).abs() < 1e-9, "{early:?} {late:?}");
    assert_eq!(early.alone("fit"), "host fit swing.csv --from 7.12");
    assert_eq!(late.alone("compare"), "host compare swing.csv --to 17.88");
    assert!(
        early.words().contains("at 7.00 s of swing.csv") && early.words().contains("0.1000 ± 0.0022 rad/s"),
        "{early:?}"
    );
}

#[test]
fn parts_leave_out_what_is_about_a_touch_and_know_when_they_begin() {
    let touches = [touch(4.0), touch(15.0)];
    let parts = parted(&[swing()], &touches);
    let spans: Vec<(f64, f64)> =
        parts.iter().map(|part| (part.from_s - 3.0, part.begins_s + part.duration_s())).collect();
    let expected = [(0.0, 3.87), (4.13, 14.87), (15.13, 19.99)];
    for (found, expected) in spans.iter().zip(&expected) {
        assert!((found.0 - expected.0).abs() < 0.011 && (found.1 - expected.1).abs() < 0.011, "{spans:?}");
    }
    assert_eq!(parts.len(), 3);
    let longest = longest(&[swing()], &touches);
    assert!(longest.len() == 1 && longest[0].len() == parts[1].len());
    assert_eq!(super::longest(&[swing()], &[])[0].len(), 2000);
}

#[test]
fn each_touch_gets_the_start_behind_it_and_each_swing_its_first() {
    let start = |k: u32| Start { angle_rad: f64::from(k), velocity_rad_s: 0.0, offset_rad: 0.0 };
    let mut touches = [touch(4.0), touch(15.0), Touch { swing_idx: 2, ..touch(4.0) }];
    let starts = given_back(&[0, 1, 2, 3, 4, 5].map(start), 3, &mut touches);
    assert_eq!(starts, [0, 3, 4].map(start));
    assert_eq!(touches.map(|touch| touch.anew), [1, 2, 5].map(|k| Some(start(k))));
}
