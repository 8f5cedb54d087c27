//! Whatever bytes or text come in, parsers answer: no panic, no hang. `BOLERO_RANDOM_ITERATIONS` makes it more.

use bolero::check;
use host::formula;
use host::recording::{ReadOptions, read_bytes};
use host::rigfile::RigFile;
use shared::wire::{self, Deframer, Frame, Hello, MAX_FRAME};

const RIG: &str = "\
[pendulum]
mass = 0.1466084
length = 0.1562177
inertia = 0.00284252
[effect.viscous]
Mw = 5.4e-4
";

const RECORDING: &str = "t,theta\n0,0.1\n0.01,0.09\n0.02,0.07\n0.03,0.04\n";

const FORMULA: &str = "torque = -k * omega * abs(omega)^p; k in 0..1e-3 N·m; p in 0..3";

/// Something sensible with the input written over a part of it, so that the deeper parts are reached too.
fn grafted(sensible: &[u8], input: &[u8]) -> Vec<u8> {
    let [place, length, rest @ ..] = input else { return input.to_vec() };
    if *place == 0 {
        return rest.to_vec();
    }
    let from = usize::from(*place) * sensible.len() / 256;
    let to = (from + usize::from(*length) % 16).min(sensible.len());
    [&sensible[..from], rest, &sensible[to..]].concat()
}

#[test]
fn frames() {
    let mut buffer = [0; MAX_FRAME];
    let hello = wire::encode(&Frame::Hello(Hello::new("fuzz")), &mut buffer).unwrap().to_vec();
    check!().for_each(|input: &[u8]| {
        let (mut at_pc, mut at_rig) = (Deframer::new(), Deframer::new());
        for byte in grafted(&hello, input) {
            let _ = (at_pc.push(byte), at_rig.push_at_rig(byte));
        }
        // Whatever came before, the next whole frame is understood.
        let mut last = at_pc.push(0);
        hello.iter().for_each(|byte| last = at_pc.push(*byte));
        assert!(matches!(last, Some(Ok(Frame::Hello(_)))));
    });
}

#[test]
fn recordings() {
    check!().for_each(|input: &[u8]| {
        let bytes = grafted(RECORDING.as_bytes(), input);
        if let Ok(recording) = read_bytes("fuzz.csv", &bytes, &ReadOptions::default()) {
            assert!(recording.angles_rad().iter().all(|angle| angle.is_finite()));
            assert!(recording.times_s().windows(2).all(|pair| pair[0] < pair[1]));
        }
    });
}

#[test]
fn rig_files() {
    check!().for_each(|input: &[u8]| {
        let bytes = grafted(RIG.as_bytes(), input);
        if let Ok(file) = RigFile::parse("fuzz.toml", &String::from_utf8_lossy(&bytes)) {
            assert!(file.parameters().pendulum.inertia_kg_m2.is_finite());
        }
    });
}

#[test]
fn formulas() {
    check!().for_each(|input: &[u8]| {
        let bytes = grafted(FORMULA.as_bytes(), input);
        let _ = formula::read(&String::from_utf8_lossy(&bytes));
    });
}
