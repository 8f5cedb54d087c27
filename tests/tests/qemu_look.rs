//! A look on the microcontroller: what it takes, how deep its stack is, and that single precision says there what
//! double precision says on the PC.

use shared::bank::findings::look;
use shared::bank::keeper::Keeper;
use shared::bank::order::ERROR_A_LOOK;
use shared::bank::refit::Releases;
use shared::bank::tape::Tape;
use shared::bank::window::Readings;
use shared::effect::Effect;
use shared::parameters::Parameters;
use shared::sensor::Potentiometer;
use shared::wire::{Answer, Frame, Suspects, decode};
use tests::image::target_program;
use tests::plant::{Plant, Scenario};
use tests::qemu::run;

const RATE_HZ: f32 = 1000.0;

/// Three releases of the paper's pendulum, with everything before them.
const N_SAMPLES: usize = 150_000;

/// An instruction takes 1 ns, so that SysTick resolves them.
const COUNT_ICOUNT: &str = "shift=0";

/// For three releases as long as the tape keeps: at two cycles an instruction 5 % of the swing's time at 168 MHz. 403
/// million now, with two suspects put into the model.
const MOST_INSTRUCTIONS: u64 = 410_000_000;

/// Bytes; 3.3 KB now.
const MOST_STACK: u32 = 5 * 1024;

/// Single against double precision.
const F_APART: f64 = 0.02;

fn codes() -> Vec<u16> {
    let mut parameters = Parameters::paper();
    parameters.set(Effect::<f64>::by_name("quadratic-drag").unwrap().id, &[1e-4]).unwrap();
    let mut plant =
        Plant::new(Scenario { parameters, release_rad: 1.3, swing_s: 45.0, alternate: true, ..Scenario::default() });
    (0..N_SAMPLES).map(|_| plant.next_code().0).collect()
}

/// What the board says, the instructions it takes, and its stack in bytes.
fn on_the_board(codes: &[u16]) -> (Suspects, u64, u32) {
    let directory = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = codes.iter().flat_map(|code| code.to_le_bytes()).collect();
    std::fs::write(directory.path().join("codes.bin"), bytes).unwrap();
    let said = run(&target_program("look").unwrap(), directory.path(), Some(COUNT_ICOUNT)).unwrap();
    let of = |name: &str| {
        let line = said.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap_or_else(|| panic!("no {name} in\n{said}")).trim().to_owned()
    };
    let found = of("found");
    let hexadecimal = |i: usize| u8::from_str_radix(&found[i..i + 2], 16).unwrap();
    let mut frame: Vec<u8> = (0..found.len() - 2).step_by(2).map(hexadecimal).collect();
    let Ok(Frame::Answer(0, Answer::Suspects(suspects))) = decode(&mut frame) else { panic!("{said}") };
    (suspects, of("count").parse().unwrap(), of("stack").parse().unwrap())
}

#[test]
fn a_look_takes_what_a_board_has_and_says_what_double_precision_says() {
    let codes = codes();
    let (said, n_instructions, stack) = on_the_board(&codes);
    println!("{n_instructions} instructions, {stack} bytes of stack: {said:?}");
    assert!(n_instructions <= MOST_INSTRUCTIONS && stack <= MOST_STACK);

    let (tape, sensor) = (Box::new(Tape::new()), Potentiometer::nominal(firmware::ports::FULL_SCALE).into());
    let mut keeper = Keeper::new(RATE_HZ, sensor);
    codes.iter().for_each(|code| {
        keeper.take(shared::units::Code(*code), &tape);
    });
    let angles = |span| {
        let taped = tape.read(span, keeper.radian_per_step());
        (0..taped.len()).map(|index| f64::from(taped.at(index))).collect()
    };
    let releases: Vec<Vec<f64>> = keeper.releases(&tape).into_iter().map(angles).collect();
    assert_eq!(releases.len(), usize::from(said.n_releases));
    let parts: Vec<&[f64]> = releases.iter().map(Vec::as_slice).collect();
    let on = Releases::new(&parts, f64::from(keeper.interval_s()));
    let exact = look(&Parameters::paper(), &on, f64::from(ERROR_A_LOOK));
    assert_eq!(said.reason, exact.reason);
    let (single, double) = (&said.suspects[0], &exact.suspects[0]);
    assert_eq!(single.effect, double.effect.id);
    let ratio = f64::from(single.f) / double.evidence.f;
    assert!((ratio - 1.0).abs() < F_APART, "F {} on the board, {} on the PC", single.f, double.evidence.f);
}
