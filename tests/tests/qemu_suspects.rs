//! The real firmware names by itself what its model lacks: a drag that is hidden in the pendulum, until it is added.

use serde_json::{Value, json};
use shared::effect::Effect;
use shared::parameters::Parameters;
use shared::wire::{Answer, Command, Suspects};
use std::path::Path;
use std::time::{Duration, Instant};
use tests::HANG;
use tests::image::{Board, firmware};
use tests::link::Link;
use tests::plant::Scenario;
use tests::program::host;
use tests::qemu::Qemu;

const DRAG: &str = "quadratic-drag";

/// Hidden in the pendulum, N·m·s²/rad².
const DRAG_SIZE: f64 = 1.0e-4;

/// Samples of a release with everything before it.
const RELEASE: u64 = 50_000;

/// Of the stack so much is left, even where a look is interrupted at its deepest.
const SPARE_SHARE: f64 = 0.25;

fn scenario(parameters: Parameters<f64>) -> Scenario {
    Scenario { parameters, release_rad: 1.3, swing_s: 45.0, alternate: true, ..Scenario::default() }
}

fn suspects(link: &mut Link) -> Suspects {
    match link.ask(Command::Suspects).unwrap() {
        Answer::Suspects(suspects) => suspects,
        other => panic!("asked for suspects, got {other:?}"),
    }
}

/// What the rig says once so many more samples have passed and it has looked again, for which it lets the pendulum wait.
fn after(n_samples: u64, qemu: &Qemu, link: &mut Link, n_looks: u32) -> Suspects {
    let (began, until) = (Instant::now(), qemu.n_samples() + n_samples);
    qemu.gauge().let_pass(n_samples);
    loop {
        let (said, passed) = (suspects(link), qemu.n_samples());
        if passed >= until && said.n_looks > n_looks && !said.is_looking {
            println!("{:.1?}, {} cycles: {said:?}", began.elapsed(), said.cycles);
            return said;
        }
        assert!(began.elapsed() < HANG, "no look within {HANG:?}, {passed} of {until} samples: {said:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn link_to(qemu: &Qemu) -> Link {
    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    link
}

fn push(link: &mut Link, parameters: &Parameters<f64>) {
    let answer = link.ask(Command::SetParameters((&parameters.map(|value| value as f32)).into())).unwrap();
    assert_eq!(answer, Answer::Done);
}

#[test]
fn a_hidden_drag_is_named_by_the_rig_and_suspected_no_more_once_it_is_added() {
    let drag = Effect::<f64>::by_name(DRAG).unwrap().id;
    let (known, mut truth) = (Parameters::paper(), Parameters::paper());
    truth.set(drag, &[DRAG_SIZE]).unwrap();
    let qemu = Qemu::start(&firmware(Board::Qemu).unwrap(), scenario(truth)).unwrap();
    push(&mut link_to(&qemu), &known);

    let run = host(Path::new("."), &format!("watch --port {} --json --quiet", qemu.port()));
    qemu.hold(true);
    let look: Value = serde_json::from_str(run.succeeded()).unwrap();
    assert_eq!((&look["named"], &look["judge"]), (&json!([DRAG]), &json!("rig")), "{look:#}");
    let number = &look["candidates"][0]["values"][0];
    let (size, std) = (number["value"].as_f64().unwrap(), number["std"].as_f64().unwrap());
    assert!((size / DRAG_SIZE - 1.0).abs() < 0.1 && std > 0.0, "{size} ± {std}");

    // What is pushed is looked at at once, on the releases that are there.
    let mut link = link_to(&qemu);
    let before = suspects(&mut link);
    assert!(before.names());
    let mut larger = known.clone();
    larger.set(drag, &[size]).unwrap();
    push(&mut link, &larger);
    assert!(!after(0, &qemu, &mut link, before.n_looks).names());
    assert!(!after(RELEASE, &qemu, &mut link, before.n_looks + 1).names());

    let Answer::Statistics(statistics) = link.ask(Command::Statistics).unwrap() else { panic!("no statistics") };
    let (used, size) = (statistics.health.stack_used, statistics.health.stack_size);
    println!("{used} of {size} bytes of stack");
    assert!(f64::from(used) <= (1.0 - SPARE_SHARE) * f64::from(size), "{used} of {size} bytes of stack");
    assert_eq!((statistics.overruns, statistics.dropped_frames), (0, 0));
}
