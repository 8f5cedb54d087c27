//! What names say of a sensor: a gyroscope, the angles of an orientation, accelerations, a light gate.

use super::split::words;
use super::vocabulary::{DERIVED, DISPLACEMENT};
use crate::units::{angle_unit, time_unit};

/// The three angles of a body that an orientation sensor gives.
pub(super) const TURNS_OF_BODY: &[&str] =
    &["pitch", "roll", "yaw", "tangage", "roulis", "lacet", "cabeceo", "alabeo", "beccheggio"];

/// Does a name say that it is a gyroscope's? `Gyroscope`, `gyro_2`, `GyroscopeUncalibrated`.
pub(crate) fn is_gyroscope(name: &str) -> bool {
    words(name).iter().any(|word| word.starts_with("gyro") || word.starts_with("girosc"))
}

/// Is it how long a swing takes, or when it shuts a light gate? `Period [s]`, `Transit time`, `Schwingungsdauer`,
/// `State at A`.
pub(crate) fn is_duration(name: &str) -> bool {
    let words = words(name);
    words.iter().any(|word| DURATION.contains(&word.as_str())) || words.starts_with(&["state".into(), "at".into()])
}

/// Is it the length of the pendulum? `length (m)`, `l / cm`, `Pendellänge`.
pub(crate) fn is_length(name: &str) -> bool {
    words(name).iter().any(|word| LENGTH.contains(&word.as_str()))
}

/// Is it how far away something is, or how far from its middle, in a unit of length? `Distance (cm)`, `position (m)`,
/// `Abstand [mm]`, and no error or speed of it.
pub(crate) fn is_distance(name: &str) -> bool {
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let is_speed = name.contains('/') && words.iter().any(|word| time_unit(word).is_some());
    has(METRES) && (has(DISTANCE) || has(DISPLACEMENT)) && !has(DERIVED) && !is_speed && !is_length(name)
}

/// Units of length.
const METRES: &[&str] = &["m", "cm", "mm", "metre", "metres", "meter", "meters", "in", "inch"];

/// Words of what a ranger gives.
const DISTANCE: &[&str] = &[
    "distance",
    "dist",
    "range",
    "pos",
    "abstand",
    "entfernung",
    "weg",
    "auslenkung",
    "distancia",
    "distanza",
    "distância",
    "距离",
    "位移",
];

/// Words of a length.
const LENGTH: &[&str] = &[
    "length",
    "l",
    "länge",
    "laenge",
    "pendellänge",
    "fadenlänge",
    "longueur",
    "longitud",
    "lunghezza",
    "lengde",
    "længde",
    "längd",
    "lengte",
    "comprimento",
    "długość",
    "délka",
    "длина",
    "摆长",
    "长度",
];

/// Words of such durations.
const DURATION: &[&str] = &[
    "period",
    "periods",
    "transit",
    "gate",
    "blocked",
    "periode",
    "periodendauer",
    "schwingungsdauer",
    "dunkelzeit",
    "lichtschranke",
    "période",
    "durée",
    "periodo",
    "período",
];

/// Is it what a converter or a counter gives? `CH1(V)`, `Channel A (mV)`, `encoder`, `raw_angle`.
pub(crate) fn is_raw(name: &str) -> bool {
    let in_volts = name.split(|letter: char| !letter.is_alphanumeric()).any(|word| matches!(word, "V" | "mV" | "uV"));
    in_volts || is_turn_sensor(name) || words(name).iter().any(|word| RAW.contains(&word.as_str()))
}

/// Is it named after a sensor of a turn? `Pot (V)`, `encoder`, `Drehgeber`.
pub(crate) fn is_turn_sensor(name: &str) -> bool {
    words(name).iter().any(|word| TURN_SENSORS.contains(&word.as_str()))
}

/// Words of such sensors.
const TURN_SENSORS: &[&str] = &[
    "encoder",
    "enc",
    "pot",
    "poti",
    "potentiometer",
    "potenziometer",
    "potentiomètre",
    "potentiometre",
    "potenciómetro",
    "potenciometro",
    "potenciômetro",
    "potenziometro",
    "drehgeber",
    "codeur",
    "encodeur",
];

/// Words of volts and counts.
const RAW: &[&str] = &[
    "code", "codes", "volt", "volts", "voltage", "spannung", "tension", "voltaje", "tensione", "ch", "channel",
    "kanal", "canal", "adc", "analog", "count", "counts", "ticks", "pulses", "raw",
];

/// Is it a part of a quaternion? `qw`, `quaternion_x`, `orientation.w`.
pub(crate) fn is_quaternion(name: &str) -> bool {
    let words = words(name);
    let is_one = |word: &String| matches!(word.as_str(), "qw" | "qx" | "quat" | "quaternion" | "quaternions");
    words.iter().any(is_one) || is_orientation(name) && words.iter().any(|word| word == "w")
}

/// Where w, x, y and z of one thing stand: `w (number)`, `pose.w` and their like with the other letters.
pub(crate) fn w_x_y_z(names: &[String]) -> Option<[usize; 4]> {
    let all: Vec<Vec<String>> = names.iter().map(|name| words(name)).collect();
    let with = |parts: &[String], letter: &str| {
        let wanted = || parts.iter().map(|word| if word == "w" { letter } else { word.as_str() });
        all.iter().position(|other| wanted().eq(other.iter().map(String::as_str)))
    };
    all.iter()
        .enumerate()
        .filter(|(_, parts)| parts.iter().any(|word| word == "w"))
        .find_map(|(w, parts)| Some([w, with(parts, "x")?, with(parts, "y")?, with(parts, "z")?]))
}

/// Does it say orientation? Of that x, y and z are angles, or with a w the parts of a quaternion.
pub(crate) fn is_orientation(name: &str) -> bool {
    words(name).iter().any(|word| word == "orientation")
}

/// Does a name, of a file say, tell that x, y and z are the angles of an orientation? `EulerAngles`, `attitude_2`, `rpy`.
pub(crate) fn says_turns(name: &str) -> bool {
    words(name).iter().any(|word| word.starts_with("euler") || TURNS.contains(&word.as_str()))
}

/// Words of three such angles.
const TURNS: &[&str] = &["orientation", "orientierung", "attitude", "rpy", "ypr"];

/// Does it say angles, of an orientation or of several releases? `angles_2`.
pub(crate) fn says_angles(name: &str) -> bool {
    words(name).iter().any(|word| ANGLES.contains(&word.as_str()))
}

/// Words of several angles.
const ANGLES: &[&str] = &["angles", "ángulos", "angulos", "ângulos", "angoli"];

/// Is it one of the angles of an orientation? `pitch`, `Roll (deg)`, `AngleX`, `Euler_Y`, `tilt z`.
pub(crate) fn is_turn_of_body(name: &str) -> bool {
    let words = words(name);
    words.iter().any(|word| TURNS_OF_BODY.contains(&word.as_str())) || is_about_axis(&words)
}

/// An angle about one of three axes.
pub(super) fn is_about_axis(words: &[String]) -> bool {
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    has(&["x", "y", "z"]) && has(ABOUT_AXES)
}

/// Words of an angle that a sensor gives about each of its axes.
const ABOUT_AXES: &[&str] =
    &["angle", "ang", "euler", "orientation", "tilt", "inclination", "winkel", "neigung", "角度"];

/// Is it an acceleration along an axis? `Linear Acceleration x (m/s^2)`, `ax_g`, `x-axis (g)`, `Beschleunigung y`.
pub(crate) fn is_acceleration(name: &str) -> bool {
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let is_per_square = name.contains("/s²") || name.contains("/s^2") || name.contains("/s2");
    let in_metres = is_per_square && words.iter().any(|word| word == "m");
    let is_along_axis = has(&["ax", "ay", "az", "x", "y", "z"]);
    let in_g = words.last().is_some_and(|word| matches!(word.as_str(), "g" | "mg")) && is_along_axis;
    let is_angular = words.iter().any(|word| angle_unit(word).is_some() || ANGULAR.contains(&word.as_str()));
    (in_metres || in_g || words.iter().any(|word| names_acceleration(word))) && !is_angular
}

/// Is it that by its name or by its letters alone? `ax`, beside an angle, is no rate of a turn about x.
pub(crate) fn may_be_acceleration(name: &str) -> bool {
    is_acceleration(name) || matches!(words(name).as_slice(), [word] if ["ax", "ay", "az"].contains(&word.as_str()))
}

/// Is it an acceleration along an axis or of an angle?
pub(crate) fn is_any_acceleration(name: &str) -> bool {
    may_be_acceleration(name) || says_acceleration(&words(name))
}

/// Is it an acceleration of whatever kind by its words? `Winkelbeschleunigung`, `Accélération angulaire`.
pub(super) fn says_acceleration(words: &[String]) -> bool {
    let is_one =
        |word: &String| names_acceleration(word) || word.ends_with("beschleunigung") || word.ends_with("加速度");
    words.iter().any(is_one)
}

/// `accel`, and with the axis at either end: `accx`, `zaccl`.
fn names_acceleration(word: &str) -> bool {
    let is_axis = |letter: char| matches!(letter, 'x' | 'y' | 'z');
    let is_one = |word: &str| ACCELERATION.contains(&word);
    is_one(word) || word.strip_suffix(is_axis).is_some_and(is_one) || word.strip_prefix(is_axis).is_some_and(is_one)
}

/// Words of an acceleration.
const ACCELERATION: &[&str] = &[
    "acceleration",
    "accelerations",
    "accelerometer",
    "acc",
    "accel",
    "accl",
    "acce",
    "accelero",
    "beschleunigung",
    "beschleunigungen",
    "beschleunigungssensor",
    "beschl",
    "accélération",
    "accéléromètre",
    "accelerometre",
    "accél",
    "aceleración",
    "aceleracion",
    "aceleraciones",
    "acelerómetro",
    "acelerometro",
    "acel",
    "accelerazione",
    "accelerazioni",
    "accelerometro",
    "aceleração",
    "aceleracao",
    "acelerômetro",
    "versnelling",
    "akselerasjon",
    "kiihtyvyys",
    "przyspieszenie",
    "zrychlení",
    "gyorsulás",
    "ivme",
    "ускорение",
    "прискорення",
    "加速度",
    "가속도",
];

/// Words that make it one of the angle.
const ANGULAR: &[&str] = &["angular", "angulaire", "angolare", "theta", "phi"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_is_one_in_a_unit_of_length_and_neither_speed_nor_error() {
        for name in ["Distance (cm)", "position (m)", "Abstand [mm]", "displacement_m", "Weg / m", "Dist. (in)"] {
            assert!(is_distance(name), "{name}");
        }
        for name in
            ["Distance", "position", "Velocity (m/s)", "Distance (m/s)", "Dist Error (cm)", "length (m)", "x (m)"]
        {
            assert!(!is_distance(name), "{name}");
        }
    }

    #[test]
    fn files_of_orientations_are_told_from_those_of_releases() {
        for name in ["EulerAngles", "euler_20180927", "imu-attitude", "Orientation", "rpy1"] {
            assert!(says_turns(name), "{name}");
        }
        for name in ["angles", "release_angle_30", "ruler", "x", "altitude"] {
            assert!(!says_turns(name), "{name}");
        }
        assert!(says_angles("angles_2") && !says_angles("release_angle_30"));
    }

    #[test]
    fn four_letters_of_one_thing_are_found() {
        let found = |names: &[&str]| w_x_y_z(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(found(&["t", "w (number)", "x (number)", "y (number)", "z (number)"]), Some([1, 2, 3, 4]));
        assert_eq!(found(&["x", "pose.x", "pose.y", "pose.z", "pose.w"]), Some([4, 1, 2, 3]));
        assert_eq!(found(&["t", "w (rad/s)", "x", "y", "z"]), None);
    }

    #[test]
    fn volts_and_counts_are_told_from_speeds() {
        for name in ["CH1(V)", "Channel A (mV)", "encoder", "raw_angle", "pot (V)", "Channel 0", "1 Volt", "counts"] {
            assert!(is_raw(name), "{name}");
        }
        for name in ["v", "v (m/s)", "Velocity", "x (m)", "value", "theta"] {
            assert!(!is_raw(name), "{name}");
        }
    }

    #[test]
    fn accelerations_along_an_axis_are_told_from_those_of_an_angle() {
        for name in [
            "Linear Acceleration x (m/s^2)",
            "Acceleration y (m/s²)",
            "ax_g",
            "Beschleunigung z",
            "accX",
            "xAccl",
            "zaccl",
            "accy",
            "acel_x",
            "Beschl. x",
            "Aceleração z",
            "加速度 x",
            "x-axis (g)",
            "Z [mg]",
        ] {
            assert!(is_acceleration(name), "{name}");
        }
        for name in ["alpha (rad/s²)", "Angular acceleration (rad/s^2)", "x (m)", "angle", "t_s", "v (m/s)", "g"] {
            assert!(!is_acceleration(name), "{name}");
        }
    }
}
