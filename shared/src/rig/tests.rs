use super::*;
use crate::parameters::ParameterError;
use crate::sensor::Encoder;
use crate::wire::{NEWEST_PROTOCOL, POINTS_PER_FRAME};

fn rig() -> Rig {
    Rig::new("test", 4095, Err(StoreState::Empty))
}

fn ask(rig: &mut Rig, command: Command) -> Answer {
    match rig.on_frame(Frame::Command(5, command)) {
        Outcome::Send(Frame::Answer(5, answer)) | Outcome::SendThenDo(Frame::Answer(5, answer), _) => answer,
        other => panic!("no answer but {other:?}"),
    }
}

fn feed(rig: &mut Rig, code: u16, n_samples: usize) -> std::vec::Vec<Frame> {
    let mut frames = std::vec::Vec::new();
    (0..n_samples).for_each(|_| rig.on_sample(Code(code), |frame| frames.push(frame)));
    frames
}

#[test]
fn it_streams_only_when_asked_and_every_sample_once() {
    let mut rig = rig();
    assert!(feed(&mut rig, 2048, 100).is_empty());
    assert_eq!(ask(&mut rig, Command::Start(Stream { raw: true, live_every: 0 })), Answer::Done);
    let frames = feed(&mut rig, 2048, 64);
    let firsts: std::vec::Vec<u64> = frames
        .iter()
        .map(|frame| match frame {
            Frame::Samples(samples) => samples.first_sample,
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(firsts, [100, 116, 132, 148]);
    assert_eq!(ask(&mut rig, Command::Stop), Answer::Done);
    assert!(feed(&mut rig, 2048, 100).is_empty());
}

#[test]
fn lost_samples_leave_an_exact_gap_and_take_nothing_with_them() {
    let mut rig = rig();
    ask(&mut rig, Command::Start(Stream { raw: true, live_every: 3 }));
    let mut frames = feed(&mut rig, 2048, 20);
    rig.on_samples_lost(7, true, |frame| frames.push(frame));
    frames.extend(feed(&mut rig, 2048, 32));
    let raw = frames.iter().filter_map(|frame| match frame {
        Frame::Samples(raw) => Some((raw.sequence, raw.first_sample, raw.codes.len(), raw.status)),
        _ => None,
    });
    let lost = status::SAMPLES_LOST;
    assert_eq!(raw.collect::<std::vec::Vec<_>>(), [(0, 0, 16, 0), (1, 16, 4, 0), (2, 27, 16, lost), (3, 43, 16, 0)]);
    let live = frames.iter().filter_map(|frame| match frame {
        Frame::Live(live) => Some((live.sequence, live.first_sample, live.points.len(), live.every, live.status)),
        _ => None,
    });
    assert_eq!(live.collect::<std::vec::Vec<_>>(), [(0, 0, 7, 3, 0), (1, 27, 8, 3, lost)]);
    let Answer::Statistics(statistics) = ask(&mut rig, Command::Statistics) else { panic!() };
    assert_eq!((statistics.samples, statistics.overruns), (52, 7));
}

#[test]
fn samples_lost_after_a_stream_has_ended_send_nothing() {
    let mut rig = rig();
    ask(&mut rig, Command::Start(Stream { raw: true, live_every: 1 }));
    feed(&mut rig, 2048, 5);
    ask(&mut rig, Command::Stop);
    rig.on_samples_lost(7, true, |frame| panic!("{frame:?}"));
}

#[test]
fn bad_parameters_are_refused_and_the_old_ones_stay() {
    let mut rig = rig();
    let before = rig.parameters().clone();
    let mut bad = before.clone();
    bad.set(999, &[1.0]).unwrap();
    let refusal = Refusal::Parameters(ParameterError::UnknownEffect { id: 999 });
    assert_eq!(ask(&mut rig, Command::SetParameters((&bad).into())), Answer::Refused(refusal));
    assert_eq!(*rig.parameters(), before);
}

#[test]
fn another_protocol_is_greeted_and_refused_with_both_versions() {
    let mut rig = rig();
    let stranger = Hello { protocol: 77, ..Hello::new("host") };
    assert!(matches!(rig.on_frame(Frame::Hello(stranger)), Outcome::Send(Frame::Hello(_))));
    let refused = Answer::Refused(Refusal::Protocol { host: 77, rig: PROTOCOL });
    assert_eq!(ask(&mut rig, Command::GetParameters), refused);
    rig.on_frame(Frame::Hello(Hello::new("host")));
    assert!(matches!(ask(&mut rig, Command::GetParameters), Answer::Parameters(_)));
}

#[test]
fn what_is_stored_comes_back_and_anything_else_is_refused_with_a_reason() {
    let mut rig = rig();
    assert_eq!(rig.on_frame(Frame::Command(5, Command::Save)), Outcome::Do(5, Request::Save));
    let (stored, mut buffer) = (rig.stored(), [0; MAX_STORED]);
    let bytes = stored.encode(&mut buffer).unwrap();
    assert_eq!(Stored::decode(bytes), Ok(stored.clone()));
    assert_eq!(Stored::decode(&[]), Err(StoreState::Damaged));
    assert_eq!(Stored::decode(&[99, 1, 2]), Err(StoreState::OtherVersion));
    assert_eq!(Stored::decode(&bytes[..bytes.len() - 3]), Err(StoreState::Damaged));
}

#[test]
#[cfg_attr(miri, ignore = "too long for an interpreter")]
fn zero_and_gain_are_calibrated_only_while_still() {
    let mut rig = rig();
    (0..500).for_each(|i| {
        feed(&mut rig, 2000 + i, 1);
    });
    assert_eq!(ask(&mut rig, Command::ZeroHere), Answer::Refused(Refusal::NotStill));
    feed(&mut rig, 2000, 5000);
    assert_eq!(ask(&mut rig, Command::ZeroHere), Answer::Done);
    assert!((rig.settings().sensor.line().zero_code - 2000.0).abs() < 0.02);
    feed(&mut rig, 3000, 5000);
    assert_eq!(ask(&mut rig, Command::CalibrateGain(Radian(1.5))), Answer::Done);
    assert!((rig.settings().sensor.angle_at(3000).0 - 1.5).abs() < 1e-4);
    assert_eq!(ask(&mut rig, Command::CalibrateGain(Radian(9.0))), Answer::Refused(Refusal::BadAngle));
}

#[test]
fn a_broken_wire_is_flagged_and_sampling_goes_on() {
    let mut rig = rig();
    ask(&mut rig, Command::Start(Stream { raw: true, live_every: 1 }));
    let frames = feed(&mut rig, 0, 16);
    assert!(frames.iter().all(|frame| match frame {
        Frame::Samples(samples) => samples.status == status::DISCONNECTED,
        Frame::Live(live) => live.status == status::DISCONNECTED && live.points[0].angle_rad.is_finite(),
        _ => false,
    }));
    assert_eq!(frames.len(), 3);
}

#[test]
fn settings_outside_their_range_are_refused_by_position() {
    let mut rig = rig();
    let good = *rig.settings();
    for (index, bad) in [
        Settings { rate_hz: 49.0, ..good },
        Settings { cutoff_hz: 480.0, ..good },
        Settings { bandwidth_rad_s: f32::NAN, ..good },
        good.with_sensor(Potentiometer { radian_per_code: 0.0, ..Potentiometer::nominal(4095) }.into()),
    ]
    .into_iter()
    .enumerate()
    {
        let refused = Answer::Refused(Refusal::Setting { index: index as u8 });
        assert_eq!(ask(&mut rig, Command::SetSettings(bad)), refused);
    }
    assert_eq!(*rig.settings(), good);
}

#[test]
fn a_calibration_for_another_converter_is_refused() {
    let mut rig = rig();
    let before = *rig.settings();
    let foreign = before.with_sensor(Potentiometer::nominal(16_380).into());
    assert_eq!(ask(&mut rig, Command::SetSettings(foreign)), Answer::Refused(Refusal::Setting { index: 3 }));
    assert_eq!(*rig.settings(), before);
}

#[test]
#[cfg_attr(miri, ignore = "too long for an interpreter")]
fn a_dead_sensor_is_not_calibrated() {
    let mut rig = rig();
    let before = *rig.settings();
    for code in [0, 10, 4090] {
        feed(&mut rig, code, 5000);
        for command in [Command::ZeroHere, Command::CalibrateGain(Radian(1.5))] {
            assert_eq!(ask(&mut rig, command), Answer::Refused(Refusal::SensorDisconnected), "{code}");
        }
    }
    assert_eq!(*rig.settings(), before);
}

/// The first live point of these codes, after what came before.
fn first_point(rig: &mut Rig, code: u16) -> Point {
    ask(rig, Command::Start(Stream { raw: false, live_every: 1 }));
    let frames = feed(rig, code, POINTS_PER_FRAME);
    let Frame::Live(live) = &frames[0] else { panic!("{frames:?}") };
    live.points[0]
}

/// Hanging at code 2048, lost for so many seconds, a sample at a time or all at once, and found at code 3000.
fn found_after(seconds: usize, at_once: bool, cutoff_hz: f32) -> (Point, f32) {
    let mut rig = rig();
    let settings = Settings { cutoff_hz, ..*rig.settings() };
    assert_eq!(ask(&mut rig, Command::SetSettings(settings)), Answer::Done);
    feed(&mut rig, 2048, 100);
    match at_once {
        true => rig.on_samples_lost(1000 * seconds as u32, false, |_| ()),
        false => drop(feed(&mut rig, 0, 1000 * seconds)),
    }
    (first_point(&mut rig, 3000), rig.settings().sensor.angle_at(3000).0)
}

#[test]
#[cfg_attr(miri, ignore = "too long for an interpreter")]
fn after_a_long_time_without_angles_observer_and_filter_begin_anew() {
    for at_once in [false, true] {
        let (point, angle_rad) = found_after(6, at_once, 1.0);
        assert_eq!((point.innovation_rad, point.filtered_rad), (0.0, angle_rad));
        // Within 5 s the model goes on, and what a filter of 1 Hz remembers is older than its time constant.
        let (point, _) = found_after(4, at_once, 1.0);
        assert!(point.innovation_rad > 1.0 && point.filtered_rad == angle_rad, "{point:?}");
    }
}

#[test]
fn a_moment_without_angles_is_no_step_for_the_filter() {
    let mut rig = rig();
    let settings = Settings { cutoff_hz: 1.0, ..*rig.settings() };
    assert_eq!(ask(&mut rig, Command::SetSettings(settings)), Answer::Done);
    feed(&mut rig, 2048, 100);
    feed(&mut rig, 0, 100);
    let point = first_point(&mut rig, 3000);
    assert!(point.filtered_rad < 0.01 && point.filtered_rad > 0.0, "{point:?}");
}

#[test]
fn another_zero_is_no_blow_to_the_pendulum() {
    let mut rig = rig();
    feed(&mut rig, 2048, 100);
    let Sensor::Potentiometer(before) = rig.settings().sensor else { panic!() };
    let moved = rig.settings().with_sensor(Potentiometer { zero_code: 1500.0, ..before }.into());
    assert_eq!(ask(&mut rig, Command::SetSettings(moved)), Answer::Done);
    let point = first_point(&mut rig, 2048);
    assert!(point.innovation_rad == 0.0 && point.filtered_rad > 0.5, "{point:?}");
}

/// A rig with an encoder in use.
fn with_encoder(counts_per_turn: i32) -> Rig {
    let mut rig = rig();
    let settings = rig.settings().with_sensor(Encoder::new(counts_per_turn).into());
    let outcome = rig.on_frame(Frame::Command(1, Command::SetSettings(settings)));
    assert_eq!(outcome, Outcome::Do(1, Request::SetRate(settings.rate_hz)), "the board has to read another input");
    rig
}

#[test]
fn another_sensor_is_said_in_the_greeting_and_kept_in_flash_without_its_zero() {
    let mut rig = with_encoder(4096);
    let greeting = |rig: &mut Rig| match rig.on_frame(Frame::Hello(Hello::new("host"))) {
        Outcome::Send(Frame::Hello(hello)) => hello.protocol,
        other => panic!("{other:?}"),
    };
    assert_eq!(greeting(&mut rig), NEWEST_PROTOCOL);
    feed(&mut rig, 33_000, 5000);
    assert_eq!(ask(&mut rig, Command::ZeroHere), Answer::Done);
    assert!((rig.settings().sensor.line().zero_code - 33_000.0).abs() < 0.02);
    let stored = Stored { parameters: rig.parameters().clone(), settings: *rig.settings() };
    rig.finished(2, Finished::Loaded(stored.clone()));
    assert!((rig.settings().sensor.line().zero_code - 33_000.0).abs() < 0.02, "the power stayed on");
    let mut restarted = Rig::new("test", 4095, Ok(stored));
    assert_eq!(restarted.settings().sensor, Encoder::new(4096).into());
    assert_eq!(greeting(&mut restarted), NEWEST_PROTOCOL);
    assert!(matches!(restarted.on_frame(Frame::Command(3, Command::Defaults)), Outcome::Do(3, Request::SetRate(_))));
    assert_eq!(greeting(&mut restarted), PROTOCOL);
}

#[test]
fn an_encoder_is_never_disconnected_turns_for_ever_and_has_no_gain_to_measure() {
    let mut rig = with_encoder(1000);
    ask(&mut rig, Command::Start(Stream { raw: false, live_every: 1 }));
    // Ninety turns, one a second: the counter begins again on the way.
    let counts = (0..90_000_u32).map(|count| (32_768 + count) as u16);
    let mut last_rad = 0.0;
    for code in counts {
        for frame in feed(&mut rig, code, 1) {
            let Frame::Live(live) = frame else { panic!("only live points were asked for") };
            assert_eq!(live.status, 0);
            last_rad = live.points.last().unwrap().filtered_rad;
        }
    }
    assert!((last_rad / core::f32::consts::TAU - 90.0).abs() < 0.05, "{last_rad}");
    feed(&mut rig, 10_000, 5000);
    assert_eq!(ask(&mut rig, Command::CalibrateGain(Radian(1.0))), Answer::Refused(Refusal::GainIsKnown));
}
