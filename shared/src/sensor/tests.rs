use super::*;
use crate::rig::{MAX_STORED, Rig, Stored};
use crate::wire::{Settings, StoreState};

/// One of each.
fn examples() -> [Sensor; 2] {
    [Potentiometer { zero_code: 8190.5, ..Potentiometer::nominal(16_380) }.into(), Encoder::new(-4096).into()]
}

fn settings(sensor: Sensor) -> Settings {
    Settings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, sensor }
}

/// What programs and firmware from before there were other sensors read.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct OldSettings {
    rate_hz: f32,
    cutoff_hz: f32,
    bandwidth_rad_s: f32,
    potentiometer: Potentiometer,
}

#[test]
fn there_is_an_example_of_every_sensor_and_each_has_a_name() {
    let names: std::vec::Vec<&str> = examples().iter().map(Sensor::name).collect();
    assert_eq!(names, Sensor::NAMES);
    assert!(names.iter().enumerate().all(|(index, name)| !names[..index].contains(name)));
}

#[test]
fn numbers_give_the_sensor_back() {
    for sensor in examples() {
        let numbers: std::vec::Vec<(&Number, f32)> = sensor.numbers().collect();
        let value = |wanted: &'static Number| {
            let found = numbers.iter().find(|(number, _)| **number == *wanted);
            found.map(|(_, value)| f64::from(*value)).ok_or(wanted.key)
        };
        assert_eq!(Sensor::read(sensor.name(), value), Ok(Some(sensor)));
        assert!(numbers.iter().all(|(number, value)| number.whole.is_none() || value.fract() == 0.0));
        assert!(sensor.is_valid());
    }
    assert_eq!(Sensor::read("barometer", |_| Ok::<f64, ()>(1.0)), Ok(None));
}

#[test]
fn readings_follow_the_line_and_its_zero() {
    for sensor in examples() {
        let moved = sensor.with_zero(3000.5);
        let Line { zero_code, radian_per_code } = moved.line();
        assert_eq!(zero_code, 3000.5);
        assert!((moved.angle_at(3100).0 - 99.5 * radian_per_code).abs() < 1e-6);
        assert!(sensor.step_rad() > 0.0 && sensor.still_codes() > 0.0);
        assert!(sensor.span().is_none_or(|span| (2..=1 << 16).contains(&span)));
    }
}

#[test]
fn a_potentiometer_has_the_bytes_that_it_always_had() {
    let potentiometer = Potentiometer { zero_code: 8190.5, ..Potentiometer::nominal(16_380) };
    let old = OldSettings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, potentiometer };
    let (mut before, mut now) = ([0; 64], [0; 64]);
    let before = postcard::to_slice(&old, &mut before).unwrap();
    let now = postcard::to_slice(&settings(potentiometer.into()), &mut now).unwrap();
    assert_eq!(before, now);
    assert_eq!(postcard::take_from_bytes::<Settings>(before), Ok((settings(potentiometer.into()), &[][..])));
}

#[test]
fn who_knows_potentiometers_only_finds_bytes_left_over() {
    for sensor in examples().into_iter().filter(|sensor| !matches!(sensor, Sensor::Potentiometer(_))) {
        let mut buffer = [0; 64];
        let bytes = postcard::to_slice(&settings(sensor), &mut buffer).unwrap();
        assert_eq!(postcard::take_from_bytes::<Settings>(bytes), Ok((settings(sensor), &[][..])));
        let (old, rest) = postcard::take_from_bytes::<OldSettings>(bytes).unwrap();
        assert!(!rest.is_empty() && !old.potentiometer.is_valid(), "{old:?}");
    }
}

#[test]
fn flash_says_by_its_version_whether_old_firmware_can_read_it() {
    for sensor in examples() {
        let rig = Rig::new("test", 4095, Err(StoreState::Empty));
        let stored = Stored { parameters: rig.parameters().clone(), settings: rig.settings().with_sensor(sensor) };
        let mut buffer = [0; MAX_STORED];
        let bytes = stored.encode(&mut buffer).unwrap();
        assert_eq!(u16::from(bytes[0]), sensor.protocol());
        assert_eq!(Stored::decode(bytes), Ok(stored));
    }
}

#[test]
fn a_zero_outlasts_the_power_only_where_the_sensor_knows_it() {
    for sensor in examples() {
        let zeroed = sensor.with_zero(3500.25);
        let kept = zeroed.at_power_up().line().zero_code == 3500.25;
        assert_eq!(kept, sensor.keeps_zero());
        // From a file or flash: a zero of the power-up before is not taken over, the one in use is.
        let taken = sensor.with_zero(99.0).taken_over(&zeroed).line().zero_code;
        assert_eq!(taken, if sensor.keeps_zero() { 99.0 } else { 3500.25 });
        for other in examples().into_iter().filter(|other| !other.is_like(&sensor)) {
            assert_eq!(sensor.taken_over(&other), sensor.at_power_up());
        }
    }
}
