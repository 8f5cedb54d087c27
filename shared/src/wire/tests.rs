use super::*;
use crate::effect::Effect;
use crate::parameters::Parameters;
use heapless::{String, Vec};

fn full_parameters() -> Parameters<f32> {
    let mut p = Parameters::paper().map(|v| v as f32);
    for effect in Effect::<f32>::ALL.iter().filter(|effect| !effect.is_base()) {
        let values: Vec<f32, 4> = effect.parameters.iter().map(|p| p.start as f32).collect();
        let _ = p.set(effect.id, &values);
    }
    p
}

fn settings() -> Settings {
    let sensor = crate::sensor::Potentiometer::nominal(4095).into();
    Settings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, sensor }
}

fn examples() -> [Frame; 8] {
    let point =
        Point { filtered_rad: 1.5, angle_rad: 1.5, velocity_rad_s: -2.0, innovation_rad: 1e-3, friction_nm: 1e-3 };
    [
        Frame::Hello(Hello::new("feather-f405")),
        Frame::Command(7, Command::SetParameters((&full_parameters()).into())),
        Frame::Command(8, Command::SetSettings(settings())),
        Frame::Answer(u16::MAX, Answer::Parameters((&full_parameters()).into())),
        Frame::Answer(9, Answer::Refused(Refusal::Protocol { host: 1, rig: 2 })),
        Frame::Answer(9, Answer::Statistics(Statistics { samples: u64::MAX, ..Statistics::default() })),
        Frame::Samples(Samples {
            sequence: u32::MAX,
            first_sample: u64::MAX,
            status: 0xff,
            codes: [u16::MAX; SAMPLES_PER_FRAME].into_iter().collect(),
        }),
        Frame::Live(Live {
            sequence: u32::MAX,
            first_sample: u64::MAX,
            every: u16::MAX,
            status: 0xff,
            points: [point; POINTS_PER_FRAME].into_iter().collect(),
        }),
    ]
}

#[test]
fn every_kind_of_frame_comes_back_and_fits() {
    for frame in examples() {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&frame, &mut buffer).unwrap();
        let mut deframer = Deframer::new();
        let mut got = None;
        for byte in bytes {
            got = got.or(deframer.push(*byte));
        }
        assert_eq!(got, Some(Ok(frame)));
    }
}

#[test]
fn a_rig_understands_what_is_meant_for_it_and_nothing_else() {
    for frame in examples() {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&frame, &mut buffer).unwrap();
        let mut deframer = Deframer::new();
        let got = bytes.iter().find_map(|byte| deframer.push_at_rig(*byte));
        let for_rig = matches!(frame, Frame::Hello(_) | Frame::Command(..));
        assert_eq!(got, Some(if for_rig { Ok(frame) } else { Err(WireError::Damaged) }));
    }
}

#[test]
fn the_hello_keeps_its_bytes_for_ever() {
    let hello = Hello {
        magic: MAGIC,
        protocol: 300,
        catalogue: 0x1234_5678,
        version: [1, 2, 3],
        name: String::try_from("qemu").unwrap(),
    };
    let mut buffer = [0; MAX_FRAME];
    let bytes = encode(&Frame::Hello(hello), &mut buffer).unwrap();
    let body = [0, b'P', b'N', b'D', b'L', 0xac, 2, 0xf8, 0xac, 0xd1, 0x91, 1, 1, 2, 3, 4, b'q', b'e', b'm', b'u'];
    // COBS: the leading zero (the frame's kind) becomes the first run; the check sum of four bytes follows.
    assert_eq!(bytes[..2], [1, 24]);
    assert_eq!(bytes[2..21], body[1..]);
    assert_eq!((bytes.len(), bytes[25]), (26, 0));
}

#[test]
#[cfg_attr(miri, ignore = "too long for an interpreter")]
fn a_garbled_byte_never_passes_and_the_next_frame_does() {
    let frame = &examples()[6];
    let mut buffer = [0; MAX_FRAME];
    let good: std::vec::Vec<u8> = encode(frame, &mut buffer).unwrap().to_vec();
    for position in 0..good.len() {
        for bit in 0..8 {
            let mut bytes = good.clone();
            bytes[position] ^= 1 << bit;
            bytes.push(0);
            bytes.extend_from_slice(&good);
            let mut deframer = Deframer::new();
            let frames: std::vec::Vec<_> =
                bytes.iter().filter_map(|byte| deframer.push(*byte)).filter_map(Result::ok).collect();
            assert_eq!(frames, core::slice::from_ref(frame), "byte {position} bit {bit}");
        }
    }
}

#[test]
fn an_endless_frame_is_reported_once_and_forgotten() {
    let mut deframer = Deframer::new();
    assert!((0..10_000).all(|_| deframer.push(1).is_none()));
    assert_eq!(deframer.push(0), Some(Err(WireError::TooLong)));
    assert_eq!(deframer.push(0), None);
}

proptest::proptest! {
    #[test]
    fn any_bytes_are_survived(bytes: std::vec::Vec<u8>) {
        let mut deframer = Deframer::new();
        for byte in bytes {
            let _ = deframer.push(byte);
        }
        let _ = deframer.push(0);
    }
}
