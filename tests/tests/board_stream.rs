//! The boards' images, streaming: every sample comes once, in order, and shows what the potentiometer showed then.
#![cfg(unix)]

use shared::sensor::{Encoder, Sensor};
use shared::wire::{Answer, Command, Frame, NEWEST_PROTOCOL, PROTOCOL, Settings};
use tests::emulator::{Chip, Emulated, stream};
use tests::image::Board;

const BOARDS: [Board; 2] = [Board::FeatherF405, Board::NucleoF446];

/// Virtual seconds.
const SECONDS: f64 = 30.0;

fn settings(board: &mut Emulated) -> Settings {
    match board.ask(Command::GetSettings) {
        Answer::Settings(settings) => settings,
        other => panic!("asked for settings, got {other:?}"),
    }
}

#[test]
fn half_a_minute_of_samples_and_live_points_comes_whole() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip { cpi: 4.0, ..Chip::of(kind) });
        board.hello();
        board.statistics();
        board.stream(10);
        let (began, began_s) = (std::time::Instant::now(), board.now_s);
        board.run(SECONDS);
        let speed = (board.now_s - began_s) / began.elapsed().as_secs_f64();
        let gaps = stream::check(&board.frames, 1e-3).unwrap();
        let statistics = board.statistics();
        let busy_percent = f64::from(statistics.health.cpu_permille) / 10.0;
        println!("{kind:?}: {gaps:?}, {busy_percent} % busy at CPI 4, {speed:.1} x real time");
        assert!(gaps.n_samples as f64 > (SECONDS - 0.1) * 1000.0 && gaps.n_missing == 0, "{gaps:?}");
        assert_eq!((statistics.overruns, statistics.paused, statistics.dropped_frames), (0, 0, 0));
        assert_eq!((statistics.health.resets, board.n_bad), (0, 0));
        assert!(busy_percent <= 12.0, "{busy_percent} %");
    }
}

#[test]
fn the_more_cycles_an_instruction_takes_the_busier_is_the_processor() {
    let busy = [1.5, 2.0, 4.0].map(|cpi| {
        let mut board = Emulated::new(&Chip { cpi, ..Chip::of(Board::NucleoF446) });
        board.hello();
        board.statistics();
        board.stream(10);
        board.run(2.0);
        f64::from(board.statistics().health.cpu_permille) / cpi
    });
    println!("{busy:?} per mille busy at one cycle an instruction");
    assert!(busy.iter().all(|share| (share / busy[1] - 1.0).abs() < 0.1), "{busy:?}");
}

#[test]
fn the_feather_streams_ten_thousand_samples_a_second_without_a_loss() {
    let mut board = Emulated::new(&Chip::of(Board::FeatherF405));
    board.hello();
    let settings = Settings { rate_hz: 10_000.0, ..settings(&mut board) };
    board.order(Command::SetSettings(settings));
    board.run(0.2);
    board.stream(1);
    board.run(3.0);
    let gaps = stream::check(&board.frames, 1e-4).unwrap();
    let statistics = board.statistics();
    println!("{gaps:?}, {} permille busy", statistics.health.cpu_permille);
    assert!(gaps.n_samples > 29_000 && gaps.n_missing == 0, "{gaps:?}");
    assert_eq!((statistics.overruns, statistics.paused, statistics.dropped_frames), (0, 0, 0));
}

/// The first sample of a stream that shows a count, and how many samples there are of each count.
fn counts(board: &Emulated) -> Vec<u16> {
    let codes = |frame: &Frame| match frame {
        Frame::Samples(samples) => samples.codes.to_vec(),
        _ => Vec::new(),
    };
    board.frames.iter().flat_map(codes).collect()
}

/// An encoder that turns by a count each millisecond: at 1 kHz every sample is one count further, at 4 kHz four show
/// each, whatever the processor does meanwhile; saving to flash loses none of them.
#[test]
fn an_encoder_is_read_at_exact_instants_on_both_boards() {
    for kind in BOARDS {
        let mut board = Emulated::turning(&Chip::of(kind));
        assert_eq!(board.hello().protocol, PROTOCOL);
        let sensor = Encoder::new(4096).into();
        let encoder = settings(&mut board).with_sensor(sensor);
        for (rate_hz, a_count) in [(1000.0, 1), (4000.0, 4)] {
            board.order(Command::SetSettings(Settings { rate_hz, ..encoder }));
            board.run(0.1);
            board.stream(10);
            board.run(0.6);
            let counts = counts(&board);
            assert!(counts.len() as f32 > 0.5 * rate_hz, "{kind:?}: {} samples", counts.len());
            assert!(counts[0] > Sensor::BEGINS_AT, "{kind:?}: it has turned since power-up");
            let late = counts.windows(a_count + 1).find(|window| window[a_count] != window[0] + 1);
            assert_eq!(late, None, "{kind:?} at {rate_hz} Hz");
        }
        board.order(Command::Stop);
        board.order(Command::Save);
        board.order(Command::Reset);
        board.run(0.5);
        assert_eq!(board.hello().protocol, NEWEST_PROTOCOL);
        assert_eq!(settings(&mut board).sensor, sensor, "{kind:?}: flash keeps which sensor it is");
        let statistics = board.statistics();
        assert_eq!((statistics.overruns, statistics.disconnected, board.n_bad), (0, 0, 0), "{kind:?}");
    }
}

/// So many that two hours recycle the store several times.
const SAVES_A_ROUND: usize = 10;

/// What happens in a round of the long run, one after the other.
#[derive(Clone, Copy, Debug)]
enum Then {
    Save,
    Reset,
    Rate(f32),
}

#[test]
#[ignore = "two virtual hours take more than one: tests/more boards"]
fn for_hours_of_saves_resets_and_rates_every_gap_is_counted() {
    let seconds: f64 = std::env::var("STREAM_S").map_or(120.0, |number| number.parse().expect("a number"));
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    let then = [Then::Save, Then::Rate(500.0), Then::Save, Then::Reset, Then::Rate(2000.0), Then::Rate(1000.0)];
    let (mut n_samples, mut n_missing, mut n_saves, mut n_resets) = (0, 0, 0, 0);
    for then in then.into_iter().cycle() {
        if board.now_s > seconds {
            break;
        }
        let period_s = 1.0 / f64::from(settings(&mut board).rate_hz);
        let before = board.statistics();
        board.stream(10);
        board.run(10.0);
        if matches!(then, Then::Save) {
            (0..SAVES_A_ROUND).for_each(|_| board.order(Command::Save));
            n_saves += SAVES_A_ROUND;
            board.run(1.0);
        }
        board.order(Command::Stop);
        let gaps = stream::check(&board.frames, period_s).unwrap_or_else(|reason| panic!("{then:?}: {reason}"));
        let after = board.statistics();
        assert_eq!(u64::from(after.paused - before.paused), gaps.n_missing, "{then:?}");
        assert_eq!((after.overruns, after.dropped_frames, board.n_bad), (0, 0, 0), "{then:?}");
        let resets: Vec<String> = board.events_of("reset").map(ToString::to_string).collect();
        assert_eq!(u32::from(after.health.resets), n_resets, "{then:?}: {resets:?}");
        (n_samples, n_missing) = (n_samples + gaps.n_samples, n_missing + gaps.n_missing);
        match then {
            Then::Save => {}
            Then::Reset => {
                board.order(Command::Reset);
                board.run(0.5);
                board.hello();
                n_resets += 1;
                println!("{:.0} s: {n_samples} samples, {n_missing} missing and counted, {n_saves} saves", board.now_s);
            }
            Then::Rate(rate_hz) => {
                let settings = Settings { rate_hz, ..settings(&mut board) };
                board.order(Command::SetSettings(settings));
                board.run(0.1);
            }
        }
    }
    let n_erases = board.events_of("erase").count();
    println!("{n_saves} saves, {n_erases} erases, {n_resets} resets asked for");
}
