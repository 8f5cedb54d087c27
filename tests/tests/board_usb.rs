//! The Feather's image and a PC that resets, sleeps, is unplugged, dies, or asks nonsense: it always sends on.
#![cfg(unix)]

use serde_json::json;
use shared::wire::{Answer, Command, SAMPLES_PER_FRAME, Stream};
use tests::chance::Chance;
use tests::emulator::{Chip, Emulated, stream};
use tests::image::Board;

/// Faults of each kind; `USB_FAULTS=100` takes some minutes.
const N_FAULTS: u64 = 5;

/// Strange requests; `USB_REQUESTS=100000` takes some minutes.
const N_REQUESTS: u64 = 5000;

/// Bytes of the link, of both boards together; `LINK_BYTES=100000` takes some minutes.
const N_LINK_BYTES: u64 = 5000;

/// Enough for a dozen whose data come when the request has been taken and not been refused yet, which takes 3 µs.
const N_REFUSED: usize = 100;

/// After a fault samples come again within this time from when the PC can take them, s.
const WITHIN_S: f64 = 1.0;

/// Frames that a fault takes with it: one in the chip's FIFO, one that is being written.
const ON_THEIR_WAY: u64 = 2;

/// A request is answered within this time, s; a PC waits five.
const ANSWERED_S: f64 = 0.01;

/// A PC enumerates within this time, s.
const ENUMERATION_S: f64 = 2.0;

fn number(variable: &str, otherwise: u64) -> u64 {
    std::env::var(variable).map_or(otherwise, |number| number.parse().expect("a number"))
}

/// A Feather that streams over USB.
fn streaming() -> Emulated {
    let mut board = Emulated::new(&Chip::of(Board::FeatherF405));
    board.hello();
    board.stream(0);
    board
}

/// Lets the PC enumerate the board anew.
#[track_caller]
fn wait_until_configured(board: &mut Emulated, what: &str) {
    let end_s = board.now_s + ENUMERATION_S;
    while board.now_s < end_s {
        if board.obey("look", json!({}))["usb_configured"] == true {
            return;
        }
        board.run(0.01);
    }
    panic!("{what}: not enumerated within {ENUMERATION_S} s; {:?}", board.events.last());
}

/// How long until samples come, s.
#[track_caller]
fn silence_s(board: &mut Emulated, what: &str) -> f64 {
    let (n_frames, began_s) = (board.frames.len(), board.now_s);
    while board.frames.len() == n_frames {
        assert!(board.now_s - began_s < WITHIN_S, "{what}: silent for {WITHIN_S} s; {:?}", board.events.last());
        board.run(0.005);
    }
    board.now_s - began_s
}

/// Streams, lets a fault happen at random moments, and wants the stream back.
fn survives(kind: &str, mut fault: impl FnMut(&mut Emulated, &mut Chance)) {
    let mut board = streaming();
    let mut chance = Chance::new(kind.len() as u64);
    let mut longest_s: f64 = 0.0;
    let n_faults = number("USB_FAULTS", N_FAULTS);
    for i in 0..n_faults {
        board.run(chance.within(0.05..0.3));
        let what = format!("{kind} {i}");
        fault(&mut board, &mut chance);
        wait_until_configured(&mut board, &what);
        longest_s = longest_s.max(silence_s(&mut board, &what));
    }
    board.run(0.3);
    let gaps = stream::check_numbers(&board.frames, 1e-3).unwrap_or_else(|reason| panic!("{kind}: {reason}"));
    board.hello();
    let statistics = board.statistics();
    println!("{kind}: silent for {longest_s:.3} s at most; {gaps:?}");
    assert_eq!(statistics.health.resets, 0, "{kind}");
    assert_eq!((statistics.overruns, statistics.paused), (0, 0), "{kind}");
    // What was on its way shows in the frames' numbers alone, by which the PC counts it.
    let counted = u64::from(statistics.dropped_frames) + n_faults * ON_THEIR_WAY;
    assert!(gaps.n_missing <= counted * SAMPLES_PER_FRAME as u64, "{kind}: {gaps:?}, {statistics:?}");
}

#[test]
fn sending_goes_on_after_a_bus_reset() {
    survives("bus reset", |board, _| {
        board.usb("bus_reset");
        board.run(0.1);
    });
}

#[test]
fn sending_goes_on_after_a_suspend() {
    survives("suspend", |board, chance| {
        board.usb("suspend");
        board.run(chance.within(0.001..0.4));
        board.usb("resume");
    });
}

#[test]
fn sending_goes_on_after_the_cable_was_pulled_on_a_battery() {
    survives("replug", |board, chance| {
        board.usb("unplug");
        board.run(chance.within(0.001..1.0));
        board.usb("plug");
    });
}

#[test]
fn sending_goes_on_after_the_pc_died_in_the_middle() {
    survives("dead PC", |board, chance| {
        board.usb("die");
        board.run(chance.within(0.001..1.0));
        board.usb("wake_with_reset");
        board.run(0.1);
    });
}

#[test]
fn sending_goes_on_after_the_reading_program_was_killed() {
    survives("killed reader", |board, chance| {
        board.usb("close");
        board.run(chance.within(0.001..5.0));
        board.usb("open");
    });
}

#[test]
fn a_request_that_the_pc_gives_up_leaves_the_board_reachable() {
    // Eight bytes of a device descriptor, a configuration, a string, and a line coding that is never sent.
    let requests = ["8006000100000800", "8006000200000900", "80060203090440ff", "2120000000000700"];
    survives("abandoned request", |board, chance| {
        let request = requests[chance.within(0.0..requests.len() as f64) as usize];
        let steps = chance.within(0.0..5.0) as u64;
        board.obey("abandon", json!({ "setup": request, "steps": steps }));
        board.run(chance.within(0.001..0.2));
        board.usb("bus_reset");
        board.run(0.1);
    });
}

/// Abandoned requests leave an answer that waits, or data that never come; the next request comes without a reset.
#[test]
fn a_request_in_place_of_an_answer_is_answered() {
    let mut board = streaming();
    let mut chance = Chance::new(10);
    let mut after = |request: &str, steps: u64, gap_s: f64| {
        board.obey("abandon", json!({ "setup": request, "steps": steps }));
        board.run(gap_s);
        let device = json!({ "setup": "8006000100001200", "within": ANSWERED_S });
        let answer = board.obey("request", device)["answer"].to_string();
        assert!(answer.starts_with("\"1201"), "{gap_s} s after {steps} steps of {request}: {answer}");
        silence_s(&mut board, request);
    };
    for request in ["8006000100001200", "8006000200004300", "80060203090440ff", "2120000000000700"] {
        (0..5).for_each(|steps| after(request, steps, 5e-3));
        // While the first one is on its way from the interrupt to who answers it.
        (0..20).for_each(|_| after(request, 0, chance.within(1e-6..40e-6)));
    }
}

#[test]
fn a_request_for_nothing_is_agreed_to() {
    let mut board = streaming();
    for request in ["8000000000000000", "8006000100000000", "a121000000000000"] {
        let reply = board.obey("request", json!({ "setup": request, "within": ANSWERED_S }));
        assert_eq!(reply["answer"], "", "{request}");
    }
    silence_s(&mut board, "after requests for nothing");
}

#[test]
fn a_bus_that_goes_on_without_a_word_is_answered() {
    let mut board = streaming();
    board.usb("suspend");
    board.run(0.5);
    board.usb("go_on");
    board.run(0.05);
    let reply = board.obey("request", json!({ "setup": "8000000000000200", "within": ANSWERED_S }));
    assert_eq!(reply["answer"], "0000");
    silence_s(&mut board, "going on");
}

/// As programs do that open the device by themselves, and virtual machines that take it over.
#[test]
fn sending_goes_on_after_the_configuration_was_chosen_again() {
    let mut board = streaming();
    let mut chance = Chance::new(8);
    let [configuration, interface, clear_in, clear_out] =
        ["0009010000000000", "010b000001000000", "0201000082000000", "0201000001000000"];
    for (i, request) in [configuration, interface, clear_in, clear_out].into_iter().cycle().take(16).enumerate() {
        board.run(chance.within(0.05..0.1));
        // In every other round nobody reads, and a packet waits.
        if i / 4 % 2 == 1 {
            board.usb("close");
            board.run(0.1);
        }
        assert_eq!(board.obey("request", json!({ "setup": request }))["answer"], "", "{request}");
        board.usb("open");
        silence_s(&mut board, &format!("{request} in round {}", i / 4));
        // Neither side takes a first packet for one that it has.
        assert_eq!(board.statistics().health.resets, 0);
        assert_eq!(board.look("usb_repeated"), 0.0, "{request}");
    }
    for endpoint in [0x82, 0x01] {
        let [halt, status, clear] = [
            [0x02, 3, 0, 0, endpoint, 0, 0, 0],
            [0x82, 0, 0, 0, endpoint, 0, 2, 0],
            [0x02, 1, 0, 0, endpoint, 0, 0, 0],
        ];
        let mut ask = |setup: [u8; 8]| board.obey("request", json!({ "setup": hex(&setup) }))["answer"].clone();
        assert_eq!((ask(halt), ask(status), ask(clear)), (json!(""), json!("0100"), json!("")));
        silence_s(&mut board, "halted and not any more");
        board.statistics();
    }
    assert_eq!(board.obey("request", json!({ "setup": "0009000000000000" }))["answer"], "");
    board.run(0.2);
    assert_eq!(board.obey("request", json!({ "setup": configuration }))["answer"], "");
    silence_s(&mut board, "configured again");
    assert_eq!(board.statistics().health.resets, 0);
}

#[test]
fn a_request_to_an_endpoint_that_is_not_there_is_refused() {
    let mut board = streaming();
    // The status of an endpoint, its halt set, its halt cleared; for each number that an address may have.
    for (kind, request) in [(0x82, 0), (0x02, 3), (0x02, 1)] {
        for address in (3..16).flat_map(|number| [number, 0x80 | number]) {
            let length = 2 * (kind >> 7);
            let setup = hex(&[kind, request, 0, 0, address, 0, length, 0]);
            assert_eq!(board.obey("request", json!({ "setup": setup }))["answer"], "refused", "{setup}");
        }
    }
    assert_eq!(board.obey("request", json!({ "setup": "8200000082000200" }))["answer"], "0000", "one that is there");
    silence_s(&mut board, "after requests to other endpoints");
    assert_eq!(board.statistics().health.resets, 0);
}

#[test]
fn data_of_a_refused_request_are_not_taken_for_the_next_ones() {
    let mut board = streaming();
    let mut chance = Chance::new(9);
    for i in 0..N_REFUSED {
        // More data than any request of a serial port has, sent at about the time of the refusal; then a line coding.
        let gap_s = chance.within(2e-6..15e-6);
        let long = json!({ "setup": "214000000000c800", "data": hex(&[0x5a; 200]), "gap_s": gap_s });
        assert_eq!(board.obey("request", long)["answer"], "refused", "{gap_s} s");
        let coding = json!({ "setup": "2120000000000700", "data": "00c20100000008" });
        assert_eq!(board.obey("request", coding)["answer"], "", "line coding {i}");
    }
}

/// Mostly requests that exist, with strange values; often lengths that are too long.
fn strange_request(chance: &mut Chance) -> [u8; 8] {
    let mut byte = || chance.within(0.0..256.0) as u8;
    let mut request = [byte(), byte(), byte(), byte(), byte(), byte(), byte(), byte()];
    let mut mostly = || chance.within(0.0..8.0) < 7.0;
    if mostly() {
        request[0] = [0x00, 0x80, 0x01, 0x81, 0x02, 0x82, 0x21, 0xa1][usize::from(request[0] % 8)];
        request[1] = if request[0] & 0x20 == 0 { request[1] % 13 } else { 0x20 | (request[1] % 4) };
    }
    if mostly() {
        request[2] %= 4;
        request[3] %= 4;
        request[4] &= 0x83;
        request[5] = 0;
    }
    if mostly() {
        request[7] = 0;
    }
    // Another address would be the PC's own doing.
    if request[..2] == [0, 5] { [0x80, 0, 0, 0, 0, 0, 2, 0] } else { request }
}

#[test]
fn no_request_however_strange_silences_the_board() {
    let mut board = streaming();
    let mut chance = Chance::new(3);
    let (mut n_answered, mut n_refused) = (0, 0);
    for i in 0..number("USB_REQUESTS", N_REQUESTS) {
        let setup = strange_request(&mut chance);
        let data = hex(&[0x5a; 200]);
        let gap_s = chance.within(2e-6..60e-6);
        let reply = board.obey("request", json!({ "setup": hex(&setup), "data": data, "gap_s": gap_s, "within": 0.5 }));
        match reply["answer"].as_str() {
            Some("refused") => n_refused += 1,
            Some("none") | None => {
                // A PC resets what no longer answers, as after a transfer that came half.
                board.usb("bus_reset");
                board.run(0.1);
                wait_until_configured(&mut board, &format!("request {i} {setup:02x?}"));
            }
            Some(_) => n_answered += 1,
        }
        board.forget();
        if i % 250 == 249 {
            // Whatever was configured or halted is as it was.
            board.usb("bus_reset");
            board.run(0.1);
            let what = format!("after request {i} {setup:02x?}");
            wait_until_configured(&mut board, &what);
            silence_s(&mut board, &what);
        }
    }
    println!("{n_answered} requests answered, {n_refused} refused");
    assert!(n_answered > 0 && n_refused > 0);
    board.hello();
    assert_eq!(board.statistics().health.resets, 0);
}

#[test]
fn no_bytes_however_strange_silence_a_board() {
    for kind in [Board::FeatherF405, Board::NucleoF446] {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        let stream = Command::Start(Stream { raw: true, live_every: 1 });
        assert_eq!(board.ask(stream), Answer::Done);
        let mut chance = Chance::new(4);
        let mut left = number("LINK_BYTES", N_LINK_BYTES) as i64 / 2;
        while left > 0 {
            let bytes: Vec<u8> = (0..chance.within(1.0..200.0) as usize)
                .map(|_| if chance.within(0.0..8.0) < 1.0 { 0 } else { chance.within(0.0..256.0) as u8 })
                .collect();
            left -= bytes.len() as i64;
            board.run_and_send(chance.within(0.001..0.02), &bytes);
        }
        board.hello();
        let statistics = board.statistics();
        assert!(statistics.bad_frames > 0);
        assert_eq!((statistics.health.resets, statistics.overruns), (0, 0));
    }
}

/// Breaks, noise, and a PC whose port has another speed.
#[test]
fn errors_on_the_nucleos_line_cost_the_bytes_that_they_hit() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    board.stream(0);
    for error in ["break", "framing", "noise", "overrun"] {
        for n in [1, 30] {
            (0..n).for_each(|_| {
                board.obey("garble", json!({ "error": error }));
                board.run(2e-5);
            });
            // What ends the garbage.
            board.run_and_send(0.0, &[0]);
            board.statistics();
        }
    }
    for baud in [9600, 115_200, 2_000_000] {
        board.run_and_send_at(baud, 0.05, &[0x5a; 20]);
        board.run_and_send(0.0, &[0]);
        assert_eq!(board.statistics().health.resets, 0, "{baud}");
    }
    let gaps = stream::check(&board.frames, 1e-3).unwrap();
    assert!(gaps.n_missing == 0 && board.n_bad == 0, "{gaps:?}");
}

/// Two rigs on one PC are told apart.
#[test]
fn the_serial_number_is_the_chips_unique_id() {
    let serial = |id: [u8; 12]| {
        let mut board = Emulated::new(&Chip { unique_id: Some(id), ..Chip::of(Board::FeatherF405) });
        board.hello();
        let on_usb = board.obey("look", json!({}))["serial"].clone();
        let Answer::Chip(chip) = board.ask(Command::Chip) else { panic!("asked for the chip") };
        // `host update` knows the bootloader by what the rig says of itself.
        assert_eq!(on_usb, chip.serial.as_str());
        on_usb
    };
    // As ST's bootloader makes it of the bytes 11, 10 + 2, 9, 8 + 0, 7 and 6.
    assert_eq!(serial(*b"\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b\x0c"), "0C0E0A0A0807");
    assert_eq!(serial([0xa5; 12]), "A54AA54AA5A5");
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
