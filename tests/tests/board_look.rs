//! The rig's own look on the boards' images: it waits while somebody records, takes spare time only, and is not counted as
//! work that the rig has to do.
#![cfg(unix)]

use shared::wire::{Answer, Command, Frame, Samples, Suspects};
use tests::emulator::{Chip, Emulated};
use tests::image::Board;

/// From power-up until the swing says no more, and long enough for a look after that.
const RELEASE_S: f64 = 11.0;

/// A part of a look.
const PART_S: f64 = 0.15;

/// A look takes no longer, with all else.
const LOOK_S: f64 = 2.0;

/// What the stream takes of the processor is the same beside a look, but for the interrupts that are not tasks.
const LEAST_SHARE: f64 = 0.7;
const MOST_SHARE: f64 = 1.2;

fn suspects(board: &mut Emulated) -> Suspects {
    match board.ask(Command::Suspects) {
        Answer::Suspects(suspects) => suspects,
        other => panic!("asked for suspects, got {other:?}"),
    }
}

/// The share of the processor that is in use while time passes, in thousandths.
fn busy_permille(board: &mut Emulated) -> f64 {
    board.statistics();
    board.run(PART_S);
    f64::from(board.statistics().health.cpu_permille)
}

/// Samples that a stream left out.
fn n_missing(frames: &[Frame]) -> u64 {
    let samples =
        || frames.iter().filter_map(|frame| if let Frame::Samples(samples) = frame { Some(samples) } else { None });
    let n = |samples: &Samples| samples.codes.len() as u64;
    let (first, last) = (samples().next().unwrap(), samples().next_back().unwrap());
    last.first_sample + n(last) - first.first_sample - samples().map(n).sum::<u64>()
}

#[test]
fn a_look_waits_for_a_recording_and_takes_nothing_from_the_stream() {
    let mut board = Emulated::swinging(&Chip::of(Board::NucleoF446));
    board.hello();
    board.stream(0);
    board.run(RELEASE_S - board.now_s);
    let quiet = busy_permille(&mut board);
    let held = suspects(&mut board);
    assert!(held.is_looking && held.n_looks == 0, "{held:?}");

    // Whoever asks need not stop his recording.
    let looking = busy_permille(&mut board);
    assert!(suspects(&mut board).is_looking, "the look ended within {PART_S} s");
    let share = looking / quiet;
    println!("{quiet} per mille busy, beside a look {looking}");
    assert!((LEAST_SHARE..MOST_SHARE).contains(&share), "{quiet} and {looking} per mille");

    board.run(LOOK_S);
    let found = suspects(&mut board);
    println!("{} cycles, {:?}", found.cycles, found.reason);
    assert!(!found.is_looking && (found.n_looks, found.n_releases) == (1, 1), "{found:?}");
    let statistics = board.statistics();
    assert_eq!((n_missing(&board.frames), statistics.overruns, statistics.dropped_frames), (0, 0, 0));
}
