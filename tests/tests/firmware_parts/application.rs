//! What the application does on a board: streams, settings, sensors, saving.

use crate::bench::{Bench, code_at};
use firmware::ports::{BATCH, FULL_SCALE};
use shared::rig::Rig;
use shared::sensor::Encoder;
use shared::wire::{Answer, Command, Frame, Refusal, Settings, StoreState, Stream};

#[test]
fn a_link_that_takes_nothing_for_a_while_costs_frames_but_no_samples() {
    let bench = Bench::default();
    let script = async {
        bench.link_takes.set(true);
        bench.send(Command::Start(Stream { raw: true, live_every: 0 }));
        bench.pass(50).await;
        bench.link_takes.set(false);
        bench.pass(1000).await;
        bench.link_takes.set(true);
        bench.pass(1000).await;
        bench.send(Command::Stop);
        bench.send(Command::Statistics);
        bench.pass(300).await;
    };
    bench.run(script);

    let frames = bench.frames();
    let n_dropped = frames.iter().find_map(|frame| match frame {
        Frame::Answer(_, Answer::Statistics(statistics)) => Some(statistics.dropped_frames),
        _ => None,
    });
    let sequences: Vec<u32> = frames
        .iter()
        .filter_map(|frame| if let Frame::Samples(samples) = frame { Some(samples.sequence) } else { None })
        .collect();
    let n_missing: u32 = sequences.windows(2).map(|pair| pair[1] - pair[0] - 1).sum();
    let n_gaps = sequences.windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
    assert_eq!(n_dropped, Some(n_missing));
    // One gap for the pause, and one if a frame stood between queue and link when it began.
    assert!(n_missing > 1000 && (1..=2).contains(&n_gaps), "{n_missing} in {n_gaps} gaps");
    assert_eq!(bench.n_fed.get(), bench.n_batches.get());
}

/// Answers to commands, in order.
fn answers(bench: &Bench) -> Vec<Answer> {
    let answer = |frame| if let Frame::Answer(_, answer) = frame { Some(answer) } else { None };
    bench.frames().into_iter().filter_map(answer).collect()
}

#[test]
fn the_rate_that_is_made_is_told_kept_and_loaded() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        let odd = Settings { rate_hz: 333.4, ..*Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings() };
        let slow = Settings { rate_hz: 50.4, cutoff_hz: 22.6, ..odd };
        for settings in [odd, slow] {
            bench.send(Command::SetSettings(settings));
            bench.send(Command::Save);
            bench.send(Command::Load);
            bench.send(Command::GetSettings);
            bench.pass(100).await;
        }
        bench.send(Command::SetSettings(Settings { rate_hz: 49.9, ..slow }));
        bench.send(Command::SetSettings(Settings { rate_hz: 10_001.0, ..slow }));
        bench.pass(20).await;
    });
    let answers = answers(&bench);
    let given: Vec<Settings> = answers
        .iter()
        .filter_map(|answer| if let Answer::Settings(settings) = answer { Some(*settings) } else { None })
        .collect();
    assert_eq!(given.iter().map(|settings| settings.rate_hz).collect::<Vec<_>>(), [333.0, 50.0]);
    // The cut-off goes with it: at most 0.45 of the rate.
    assert_eq!(given.iter().map(|settings| settings.cutoff_hz).collect::<Vec<_>>(), [50.0, 22.5]);
    let refused = Answer::Refused(Refusal::Setting { index: 0 });
    assert_eq!(answers[answers.len() - 2..], [refused.clone(), refused]);
}

/// A batch that began at the old rate ends when the new one is in use already.
#[test]
fn no_sample_of_the_old_rate_is_taken_for_one_of_the_new_rate() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        let settings = *Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings();
        for (k, rate_hz) in [500.0, 2000.0, 100.0, 1000.0].into_iter().enumerate() {
            bench.pass(10 + k as u64).await;
            bench.send(Command::SetSettings(Settings { cutoff_hz: 40.0, rate_hz, ..settings }));
            bench.send(Command::Start(Stream { raw: true, live_every: 0 }));
            bench.pass(10).await;
            bench.send(Command::Stop);
        }
        bench.pass(10).await;
    });
    let mut taken: Vec<u16> = Vec::new();
    for frame in bench.frames() {
        match frame {
            Frame::Samples(samples) => taken.extend(&samples.codes),
            Frame::Answer(_, answer) => assert_eq!(answer, Answer::Done),
            _ => {}
        }
    }
    taken.dedup();
    assert_eq!(taken, [500.0, 2000.0, 100.0, 1000.0].map(code_at));
}

#[test]
fn a_board_without_an_input_for_a_sensor_says_so_and_goes_on_with_its_own() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        let settings = *Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings();
        bench.send(Command::SetSettings(settings.with_sensor(Encoder::new(4096).into())));
        bench.send(Command::GetSettings);
        bench.pass(20).await;
    });
    let refused = Answer::Refused(Refusal::NoSuchSensor);
    let settings = Settings { rate_hz: 1000.0, ..*Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings() };
    assert_eq!(answers(&bench), [refused, Answer::Settings(settings)]);
}

#[test]
fn with_too_low_a_supply_nothing_is_saved() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        bench.supply_is_low.set(true);
        bench.send(Command::Save);
        bench.pass(20).await;
        bench.send(Command::Load);
        bench.pass(20).await;
        bench.supply_is_low.set(false);
        bench.send(Command::Save);
        bench.pass(20).await;
    });
    let expected = [Answer::Refused(Refusal::Supply), Answer::Refused(Refusal::NothingStored), Answer::Done];
    assert_eq!(answers(&bench), expected);
}

#[test]
fn the_chip_tells_what_its_stages_took() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        bench.send(Command::Save);
        bench.pass(20).await;
        bench.send(Command::Chip);
        bench.pass(20).await;
    });
    let [Answer::Done, Answer::Chip(chip)] = &answers(&bench)[..] else { panic!("{:?}", answers(&bench)) };
    assert_eq!((chip.sample.mean, chip.sample.worst, chip.clock_hz), (100.0, 100, 1_000_000));
    assert!(chip.sample.count >= 20 * BATCH as u32 && chip.observer.count == chip.sample.count && chip.save.count == 1);
}

#[test]
fn more_live_points_than_the_link_carries_are_refused() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        // At 1 kHz this board carries every tenth.
        bench.send(Command::Start(Stream { raw: true, live_every: 9 }));
        bench.pass(20).await;
        bench.send(Command::Start(Stream { raw: true, live_every: 10 }));
        bench.pass(20).await;
    });
    let answers: Vec<Frame> = bench.frames().into_iter().filter(|frame| matches!(frame, Frame::Answer(..))).collect();
    assert_eq!(answers, [Frame::Answer(1, Answer::Refused(Refusal::NotHere)), Frame::Answer(1, Answer::Done)]);
}
