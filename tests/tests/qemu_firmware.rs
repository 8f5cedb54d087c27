//! The whole firmware in QEMU: greets, streams, keeps parameters over a restart, and survives bad input.

use defmt_decoder::Table;
use object::{Object, ObjectSymbol};
use shared::parameters::{ParameterError, Parameters};
use shared::wire::{Answer, Command, Frame, Hello, PROTOCOL, Refusal, ResetCause, StoreState, Stream};
use tests::image::{Board, firmware};
use tests::innovation;
use tests::link::Link;
use tests::plant::Scenario;
use tests::qemu::Qemu;

/// The deepest call (a save that has to move the store to another sector) stays below this.
const MOST_STACK: u32 = 16 * 1024;

/// Saves that are cut by a restart, after the first write, the last, and between.
const N_CUT_SAVES: u32 = 20;

/// Nothing is there to be executed.
const NOWHERE: u32 = 0xefff_fff0;

fn start() -> (Qemu, Link) {
    let image = firmware(Board::Qemu).unwrap();
    let qemu = Qemu::start(&image, Scenario::default()).unwrap();
    let link = Link::open(qemu.port()).unwrap();
    (qemu, link)
}

fn other_parameters() -> Parameters<f32> {
    let mut parameters = Parameters::paper().map(|value| value as f32);
    parameters.pendulum.inertia_kg_m2 = 0.002_75;
    parameters.set(10, &[1e-4]).unwrap();
    parameters
}

#[test]
fn it_greets_streams_every_sample_and_counts_them() {
    let (_qemu, mut link) = start();
    assert_eq!(link.hello().unwrap().name, "qemu");
    // A hello that arrives while the firmware starts is half a frame.
    let bad_frames = link.statistics().unwrap().bad_frames;
    assert_eq!(link.ask(Command::Start(Stream { raw: true, live_every: 10 })).unwrap(), Answer::Done);
    link.collect(|frames| frames.len() >= 600).unwrap();
    assert_eq!(link.ask(Command::Stop).unwrap(), Answer::Done);
    let (mut next_sample, mut next_sequence) = (None, 0);
    for frame in &link.frames {
        let Frame::Samples(samples) = frame else { continue };
        assert_eq!(samples.first_sample, next_sample.unwrap_or(samples.first_sample));
        assert_eq!((samples.sequence, samples.status), (next_sequence, 0));
        next_sample = Some(samples.first_sample + samples.codes.len() as u64);
        next_sequence += 1;
    }
    let statistics = link.statistics().unwrap();
    assert!(statistics.samples >= next_sample.unwrap());
    assert_eq!((statistics.overruns, statistics.dropped_frames, statistics.bad_frames), (0, 0, bad_frames));
    assert!((1..=1000).contains(&statistics.health.cpu_permille));
}

#[test]
fn saved_parameters_are_there_after_a_restart_and_unsaved_ones_are_not() {
    let (_qemu, mut link) = start();
    link.hello().unwrap();
    let at_first = link.statistics().unwrap().health;
    assert_eq!((at_first.store, at_first.cause, at_first.resets), (StoreState::Empty, ResetCause::Power, 0));
    assert_eq!(link.ask(Command::Load).unwrap(), Answer::Refused(Refusal::NothingStored));

    let saved = other_parameters();
    assert_eq!(link.ask(Command::SetParameters((&saved).into())).unwrap(), Answer::Done);
    assert_eq!(link.ask(Command::Save).unwrap(), Answer::Done);
    assert_eq!(link.ask(Command::Defaults).unwrap(), Answer::Done);
    assert_ne!(link.ask(Command::GetParameters).unwrap(), Answer::Parameters((&saved).into()));

    assert_eq!(link.ask(Command::Reset).unwrap(), Answer::Done);
    let after = link.hello_after_restart(1).unwrap().health;
    assert_eq!(link.ask(Command::GetParameters).unwrap(), Answer::Parameters((&saved).into()));
    assert_eq!((after.store, after.cause, after.resets), (StoreState::Loaded, ResetCause::Asked, 1));
}

#[test]
fn bad_input_is_answered_and_changes_nothing() {
    let (_qemu, mut link) = start();
    link.hello().unwrap();
    // A hello that arrives while the firmware starts is half a frame.
    let at_first = link.statistics().unwrap().bad_frames;
    link.send_bytes(&[0x55; 2000]).unwrap();
    link.hello().unwrap();
    let Answer::Parameters(before) = link.ask(Command::GetParameters).unwrap() else { panic!() };

    let mut unknown = Parameters::from(before.clone());
    unknown.set(999, &[1.0]).unwrap();
    let refusal = Refusal::Parameters(ParameterError::UnknownEffect { id: 999 });
    assert_eq!(link.ask(Command::SetParameters((&unknown).into())).unwrap(), Answer::Refused(refusal));
    assert_eq!(link.ask(Command::Bootloader).unwrap(), Answer::Refused(Refusal::NotHere));

    link.hello_as(Hello { protocol: PROTOCOL + 1, ..Hello::new("stranger") }).unwrap();
    let refused = Answer::Refused(Refusal::Protocol { host: PROTOCOL + 1, rig: PROTOCOL });
    assert_eq!(link.ask(Command::GetParameters).unwrap(), refused);

    link.hello().unwrap();
    assert_eq!(link.ask(Command::GetParameters).unwrap(), Answer::Parameters(before));
    assert_eq!(link.statistics().unwrap().bad_frames, at_first + 1);
}

#[test]
fn many_saves_move_through_all_sectors_on_a_bounded_stack() {
    let (_qemu, mut link) = start();
    link.hello().unwrap();
    let mut parameters = other_parameters();
    // More than the store holds, several times.
    for i in 0..400 {
        parameters.pendulum.inertia_kg_m2 = 0.002 + 1e-6 * i as f32;
        assert_eq!(link.ask(Command::SetParameters((&parameters).into())).unwrap(), Answer::Done);
        assert_eq!(link.ask(Command::Save).unwrap(), Answer::Done, "save {i}");
    }
    assert_eq!(link.ask(Command::Defaults).unwrap(), Answer::Done);
    assert_eq!(link.ask(Command::Load).unwrap(), Answer::Done);
    assert_eq!(link.ask(Command::GetParameters).unwrap(), Answer::Parameters((&parameters).into()));
    let health = link.statistics().unwrap().health;
    println!("stack: {} of {} bytes", health.stack_used, health.stack_size);
    assert!(health.stack_used > 0 && health.stack_used <= MOST_STACK, "{}", health.stack_used);
}

#[test]
fn a_hard_fault_restarts_the_rig_and_is_remembered() {
    let (qemu, mut link) = start();
    link.hello().unwrap();
    qemu.jump_to(NOWHERE).unwrap();
    let health = link.hello_after_restart(1).unwrap().health;
    assert_eq!((health.cause, health.resets), (ResetCause::HardFault, 1));
    assert!(health.last_fault.starts_with("pc 0xefffff"), "{}", health.last_fault);

    link.ask(Command::Reset).unwrap();
    let later = link.hello_after_restart(2).unwrap().health;
    assert_eq!((later.cause, later.resets, &later.last_fault), (ResetCause::Asked, 2, &health.last_fault));

    let log = logged(&qemu);
    let fault = format!("WARN last fault: {}", health.last_fault);
    let firmware = concat!("INFO pendulum-rig firmware ", env!("CARGO_PKG_VERSION"), " for qemu;");
    let starts: Vec<&[String]> = log.split(|line| line == firmware).collect();
    let expected: [&[&str]; 4] = [
        &[],
        &["INFO 0 restarts since power-up"],
        &["INFO 1 restarts since power-up", &fault],
        &["INFO 2 restarts since power-up", &fault],
    ];
    assert_eq!(starts, expected, "{log:?}");
}

#[test]
fn a_restart_in_the_middle_of_a_save_leaves_the_old_or_the_new_parameters() {
    let (qemu, mut link) = start();
    link.hello().unwrap();
    // Samples, which none of this needs, would come as fast as they are taken.
    qemu.hold(true);
    let mut old = other_parameters();
    assert_eq!(link.ask(Command::SetParameters((&old).into())).unwrap(), Answer::Done);
    assert_eq!(link.ask(Command::Save).unwrap(), Answer::Done);
    let flash = simulated_flash();
    // The first is not cut: it tells how many writes a save has.
    let (mut n_writes, mut n_new) = (u32::MAX, 0);
    for i in 0..=N_CUT_SAVES {
        let mut new = old.clone();
        new.pendulum.inertia_kg_m2 += 1e-5;
        assert_eq!(link.ask(Command::SetParameters((&new).into())).unwrap(), Answer::Done);
        let writes = qemu.watch_writes(&flash).unwrap();
        link.send(&Frame::Command(u16::MAX, Command::Save)).unwrap();
        let cut_after = if i == 0 { u32::MAX } else { 1 + (n_writes - 1) * (i - 1) / (N_CUT_SAVES - 1) };
        let is_saved = || matches!(link.receive(), Ok(Some(Frame::Answer(u16::MAX, Answer::Done))));
        let n_seen = writes.jump_after(cut_after, NOWHERE, is_saved).unwrap();
        if i == 0 {
            n_writes = n_seen;
        }
        let restarted = link.hello_after_restart(i as u16 + 1).unwrap();
        let Answer::Parameters(kept) = link.ask(Command::GetParameters).unwrap() else { panic!() };
        let kept = Parameters::from(kept);
        assert!(kept == old || kept == new, "restart {i}, after {n_seen} writes: {kept:?}");
        assert_eq!(restarted.health.store, StoreState::Loaded, "restart {i}, after {n_seen} writes");
        n_new += u32::from(kept == new);
        println!("after {n_seen} writes the {} parameters are there", if kept == new { "new" } else { "old" });
        old = kept;
    }
    assert!(n_new > 1 && n_new < N_CUT_SAVES, "{n_new} new");
}

/// Where the image keeps what stands for flash.
fn simulated_flash() -> std::ops::Range<u64> {
    let image = std::fs::read(firmware(Board::Qemu).unwrap()).unwrap();
    let file = object::File::parse(&*image).unwrap();
    let memory = file.symbols().find(|symbol| symbol.name().is_ok_and(|name| name.contains("ram_flash6MEMORY")));
    let memory = memory.expect("the image names its simulated flash");
    memory.address()..memory.address() + memory.size()
}

/// Level and text of everything logged so far.
fn logged(qemu: &Qemu) -> Vec<String> {
    let image = std::fs::read(firmware(Board::Qemu).unwrap()).unwrap();
    let table = Table::parse(&image).unwrap().expect("the image has defmt's table");
    let mut decoder = table.new_stream_decoder();
    decoder.received(&qemu.log());
    let mut lines = Vec::new();
    while let Ok(frame) = decoder.decode() {
        lines.push(format!("{} {}", frame.level().unwrap().as_str().to_uppercase(), frame.display_message()));
    }
    lines
}

fn innovation_rad(parameters: &Parameters<f32>) -> f64 {
    let image = firmware(Board::Qemu).unwrap();
    let scenario = Scenario { rest_s: 0.5, lift_s: 0.5, hold_s: 0.5, swing_s: 12.0, ..Scenario::default() };
    let qemu = Qemu::start(&image, scenario).unwrap();
    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    link.ask(Command::SetParameters(parameters.into())).unwrap();
    innovation::of_the_next_swing(&mut link).unwrap()
}

#[test]
fn the_innovation_tells_right_parameters_from_wrong_ones() {
    let noise_rad = Scenario::default().noise_rad;
    let right = Parameters::paper().map(|value| value as f32);
    let mut wrong = right.clone();
    wrong.pendulum.inertia_kg_m2 *= 1.05;
    let (with_right, with_wrong) = (innovation_rad(&right), innovation_rad(&wrong));
    println!("innovation {with_right:.2e} rad with the right model, {with_wrong:.2e} with the wrong one");
    assert!(with_right <= 1.3 * noise_rad && with_wrong >= 3.0 * noise_rad);
}
