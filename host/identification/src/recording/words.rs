//! What the words of a column name mean, in English, German, French, Spanish and Italian, and the commonest ones in a
//! dozen languages more.
//!
//! `Time [s]`, `time_ms`, `thetaRad`, `Winkel / °`, `Temps (s)`. A name with a word of motion (`omega`, `vitesse`,
//! `theta_punkt`) is no angle, nor is one with a unit that no angle has (`position (m)`).

mod rotary;
mod sensors;

use super::units::{AngleUnit, RateUnit, TimeUnit, rate_word};
pub(super) use super::units::{angle_unit, rate_unit, time_unit};
pub(super) use rotary::{beside_alpha, beside_theta, is_rate_of_alpha, is_speed};
use sensors::TURNS_OF_BODY;
pub(super) use sensors::{
    is_acceleration, is_duration, is_gyroscope, is_length, is_quaternion, is_raw, is_turn_of_body,
};

/// What a column name says about its content.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meaning {
    /// Time, with the unit if the name has one; `strength` orders several candidates.
    Time { unit: Option<TimeUnit>, strength: u8 },
    /// Angle, likewise.
    Angle { unit: Option<AngleUnit>, strength: u8 },
    /// Converter code.
    Code,
    /// A coordinate of a point: to the right.
    X,
    /// And up or down.
    Y,
    /// An angular velocity, with the unit if the name has one.
    Rate { unit: Option<RateUnit> },
    /// Something else.
    Other,
}

const NAMES_THE_THING: u8 = 2;
const NAMES_A_UNIT: u8 = 1;

/// A position may be that of the cart under the pendulum, and a date stands beside the time.
const NAMES_IT_PERHAPS: u8 = 0;

/// Words after which a column is not the angle itself, whatever else it says.
const DERIVED: &[&str] = &[
    "omega",
    "ω",
    "velocity",
    "vel",
    "velo",
    "speed",
    "acceleration",
    "acc",
    "accel",
    "accl",
    "alpha",
    "α",
    "rate",
    "dot",
    "target",
    "setpoint",
    "reference",
    "ref",
    "v",
    "gyro",
    "gyr",
    "gyroscope",
    "gyroskop",
    "tacho",
    "tachometer",
    "rpm",
    "derivative",
    "error",
    "residual",
    "model",
    "fit",
    "std",
    "sigma",
    "noise",
    "punkt",
    "geschwindigkeit",
    "winkelgeschwindigkeit",
    "drehrate",
    "beschleunigung",
    "winkelbeschleunigung",
    "drehzahl",
    "sollwert",
    "ableitung",
    "vitesse",
    "accélération",
    "consigne",
    "gyromètre",
    "gyroscope",
    "velocidad",
    "aceleración",
    "aceleracion",
    "giroscopio",
    "consigna",
    "derivada",
    "velocità",
    "velocita",
    "accelerazione",
];

/// Words of an angular velocity among them, if the unit does not say it.
const RATE: &[&str] = &[
    "omega",
    "ω",
    "gyro",
    "gyr",
    "gyroscope",
    "gyroskop",
    "gyromètre",
    "giroscopio",
    "tacho",
    "tachometer",
    "rate",
    "drehrate",
    "winkelgeschwindigkeit",
    "rpm",
    "drehzahl",
];

const TIME: &[&str] = &[
    "t",
    "time",
    "times",
    "timestamp",
    "datetime",
    "elapsed",
    "clock",
    "epoch",
    "zeit",
    "zeitpunkt",
    "zeitstempel",
    "uhrzeit",
    "messzeit",
    "temps",
    "heure",
    "horodatage",
    "tiempo",
    "hora",
    "tempo",
    "ora",
    "ts",
    "tout",
    "tijd",
    "tid",
    "aika",
    "czas",
    "čas",
    "idő",
    "zaman",
    "время",
    "час",
    "时间",
    "時間",
    "时刻",
    "時刻",
    "시간",
];

/// Words of a day, and of the time since the row before, which are the time where nothing else is.
const DATE: &[&str] = &["date", "datum", "fecha", "dt", "δt"];

const ANGLE: &[&str] = &[
    "theta",
    "th",
    "tita",
    "teta",
    "angle",
    "ang",
    "position",
    "pos",
    "phi",
    "θ",
    "φ",
    "ϑ",
    "winkel",
    "auslenkwinkel",
    "pendelwinkel",
    "drehwinkel",
    "ángulo",
    "angulo",
    "angolo",
    "ângulo",
    "hoek",
    "vinkel",
    "kulma",
    "kąt",
    "kat",
    "úhel",
    "uhel",
    "szög",
    "açı",
    "угол",
    "кут",
    "角度",
    "각도",
];
const TILT: &[&str] =
    &["tilt", "inclination", "neigung", "neigungswinkel", "inclinaison", "inclinación", "inclinazione"];

const CODE: &[&str] = &["code", "codes", "adc"];

/// Words of a point in a picture.
const X: &[&str] = &["x", "cx", "xc", "xpos", "posx", "xcoord"];
const Y: &[&str] = &["y", "cy", "yc", "ypos", "posy", "ycoord"];

/// Of a sensor or a program that gives no angle, but these.
const SINE: &[&str] = &["sin", "sine", "sinus", "sen", "seno"];
const COSINE: &[&str] = &["cos", "cosine", "cosinus", "kosinus", "coseno"];

/// Units that no angle and no time has.
const OTHER_UNITS: &[&str] = &[
    "m", "cm", "mm", "px", "pixel", "pixels", "in", "inch", "volt", "volts", "mv", "hz", "percent", "counts", "count",
    "ticks", "raw",
];

/// Words and units of what is neither a time nor of the pendulum, though its name may hold a `t` or an `x`.
const OTHER_QUANTITIES: &[&str] = &[
    "ut",
    "µt",
    "μt",
    "nt",
    "mt",
    "gauss",
    "tesla",
    "field",
    "feld",
    "magnetic",
    "magnetfeld",
    "mag",
    "magnetometer",
    "force",
    "kraft",
    "temperature",
    "temperatur",
    "celsius",
    "°c",
    "pressure",
    "hpa",
];

/// Reads the words of a column name.
pub(super) fn meaning(name: &str) -> Meaning {
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let time = words.iter().rev().find_map(|word| time_unit(word));
    let angle = words.iter().rev().find_map(|word| angle_unit(word));
    let in_tesla = ["(T)", "[T]", "/ T"].iter().any(|unit| name.trim_end().ends_with(unit));
    if (has(OTHER_QUANTITIES) || in_tesla) && angle.is_none() && !has(ANGLE) {
        return Meaning::Other;
    }
    // `α / °` is an angle; without a unit it is taken for the acceleration.
    let is_alpha_angle =
        angle.is_some() && time.is_none() && words.iter().any(|word| matches!(word.as_str(), "alpha" | "α"));
    if is_alpha_angle && words.len() <= 2 && !name.contains(['²', '^']) {
        return Meaning::Angle { unit: angle, strength: NAMES_THE_THING };
    }
    // rad/s, deg/s: an angle and a time unit in one name is a velocity; with s² it is an acceleration.
    let is_per_time = angle.is_some() && time.is_some();
    let has_rate_unit = words.iter().any(|word| rate_word(word).is_some());
    let is_sine = has(SINE) || has(COSINE);
    let is_alpha = |word: &str| is_sine && matches!(word, "alpha" | "α");
    let says_derived = words.iter().any(|word| DERIVED.contains(&word.as_str()) && !is_alpha(word));
    let is_derived = says_derived || words.iter().any(|word| is_derivative(word)) || has_derivative_sign(name);
    if is_derived || is_per_time || has_rate_unit {
        let is_rate = (is_per_time || has_rate_unit || has(RATE) || is_angular_velocity(&words))
            && !name.contains(['²', '^'])
            && !has(&["acceleration", "alpha"]);
        return if is_rate { Meaning::Rate { unit: rate_unit_of(&words, angle, time) } } else { Meaning::Other };
    }
    if has(TIME) {
        return Meaning::Time { unit: time, strength: NAMES_THE_THING };
    }
    // The sine and the cosine of an angle are x and y of a point at distance 1.
    match (has(SINE), has(COSINE)) {
        (true, false) => return Meaning::X,
        (false, true) => return Meaning::Y,
        _ => {}
    }
    let is_angle =
        angle.is_some() || words.iter().any(|word| ANGLE.contains(&word.as_str()) && !word.starts_with("pos"));
    // The axis along which a plot or a screen counts seconds.
    let is_short = matches!(time, Some(unit) if unit != TimeUnit::Minutes && unit != TimeUnit::Days);
    if is_short && has(&["x"]) && !has(&["y"]) && !has(OTHER_UNITS) && !is_angle {
        return Meaning::Time { unit: time, strength: NAMES_A_UNIT };
    }
    match (has(X), has(Y)) {
        (true, false) if !is_angle => return Meaning::X,
        (false, true) if !is_angle => return Meaning::Y,
        _ => {}
    }
    if has(OTHER_UNITS) {
        return Meaning::Other;
    }
    if has(ANGLE) {
        let strength = if is_angle { NAMES_THE_THING } else { NAMES_IT_PERHAPS };
        return Meaning::Angle { unit: angle, strength };
    }
    match (has(CODE), time, angle) {
        (true, ..) => Meaning::Code,
        (_, Some(_), _) => Meaning::Time { unit: time, strength: NAMES_A_UNIT },
        (.., Some(_)) => Meaning::Angle { unit: angle, strength: NAMES_A_UNIT },
        _ if has(TILT) || has(TURNS_OF_BODY) => Meaning::Angle { unit: None, strength: NAMES_A_UNIT },
        // `pendulum`, where nothing else is said of it.
        _ if is_of_pendulum(name) && words.len() == 1 => Meaning::Angle { unit: None, strength: NAMES_IT_PERHAPS },
        _ if has(DATE) => Meaning::Time { unit: None, strength: NAMES_IT_PERHAPS },
        _ => Meaning::Other,
    }
}

/// `angular_velocity`, `AngVel`, `vitesse angulaire`, and no acceleration.
fn is_angular_velocity(words: &[String]) -> bool {
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    has(&["angular", "angulaire", "angolare", "ang"]) && has(rotary::SPEED) || has(&["angvel"])
}

/// `thetadot`, `phipunkt`, `dtheta`: one word for a derivative.
fn is_derivative(word: &str) -> bool {
    let is_angle = |rest: Option<&str>| rest.is_some_and(|rest| ANGLE.contains(&rest));
    ["dot", "punkt", "ddot", "p"].iter().any(|end| is_angle(word.strip_suffix(end)))
        || ["d", "dd", "delta"].iter().any(|begin| is_angle(word.strip_prefix(begin)))
        || word.ends_with("geschwindigkeit")
        || word.ends_with("velocity")
}

/// `θ'`, `dθ/dt`, `θ̇`, and not `'Group'/'Angle'`, whose quotes open before a word.
fn has_derivative_sign(name: &str) -> bool {
    let is_quoted = name.split('\'').skip(1).any(|behind| behind.starts_with(char::is_alphabetic));
    name.contains("/dt")
        || (name.trim_end().ends_with('\'') && !is_quoted)
        || name.contains('\u{307}')
        || name.contains('\u{308}')
}

/// Whether a cell is nothing but a unit, as in a second header line.
pub(super) fn is_unit(cell: &str) -> bool {
    let cell = cell.trim_matches(['[', ']', '(', ')', ' ']).to_lowercase();
    time_unit(&cell).is_some()
        || angle_unit(&cell).is_some()
        || OTHER_UNITS.contains(&cell.as_str())
        || matches!(cell.as_str(), "rad/s" | "deg/s" | "°/s" | "v" | "g" | "m/s" | "m/s²" | "m/s^2")
}

/// Of the words of a name that is a rate: an angle alone is meant per second.
fn rate_unit_of(words: &[String], angle: Option<AngleUnit>, time: Option<TimeUnit>) -> Option<RateUnit> {
    let in_time = angle.map(|angle| RateUnit { angle, time: time.unwrap_or(TimeUnit::Seconds) });
    words.iter().find_map(|word| rate_word(word)).or(in_time)
}

/// Is it the size of a vector, which has no sign? `Absolute (rad/s)`, `Gyroscope abs`.
pub(super) fn is_size(name: &str) -> bool {
    words(name).iter().any(|word| SIZE.contains(&word.as_str()))
}

/// `time`, `theta1 (deg)`, and not `timeTrigger` or `theta_noisy`.
pub(super) fn says_nothing_else(name: &str) -> bool {
    let says = |word: &&String| time_unit(word).is_none() && angle_unit(word).is_none() && !word.starts_with("pend");
    words(name).iter().filter(says).count() <= 1
}

/// `data`, `value`, `simout`: no word says what was measured.
pub(super) fn says_nothing(name: &str) -> bool {
    let words = words(name);
    !words.is_empty() && words.iter().all(|word| MUTE.contains(&word.as_str()))
}

/// When a message was made, as against when it arrived: `header.stamp`.
pub(super) fn is_stamp(name: &str) -> bool {
    let words = words(name);
    ["header", "stamp"].iter().all(|wanted| words.iter().any(|word| word == wanted))
}

/// Is it the sine or the cosine of an angle?
pub(super) fn is_of_sine(name: &str) -> bool {
    words(name).iter().any(|word| SINE.contains(&word.as_str()) || COSINE.contains(&word.as_str()))
}

/// Does it count frames, samples or rows? `frame`, `Frame number`, `sample_idx`, `Bild`.
pub(super) fn is_counter(name: &str) -> bool {
    let words = words(name);
    words.first().is_some_and(|word| COUNTER.contains(&word.as_str()))
        && words[1..].iter().all(|word| matches!(word.as_str(), "number" | "no" | "nr" | "idx" | "index" | "id"))
}

/// Does a name say that it is the pendulum's? `PendPos`, `pendulum_angle`, `Pendelwinkel`.
pub(super) fn is_of_pendulum(name: &str) -> bool {
    words(name)
        .iter()
        .any(|word| word.starts_with("pend") || word.starts_with("pénd") || PENDULUM.contains(&word.as_str()))
}

/// Or that of what carries and moves it? `CartPos`, `arm_angle`.
pub(super) fn is_of_carrier(name: &str) -> bool {
    words(name).iter().any(|word| CARRIER.contains(&word.as_str()))
}

/// Words that tell nothing of a quantity.
const MUTE: &[&str] = &[
    "data",
    "field",
    "measurement",
    "messwert",
    "output",
    "reading",
    "sensor",
    "signal",
    "simout",
    "untitled",
    "valeur",
    "valor",
    "valore",
    "value",
    "wert",
    "yout",
];

/// Words of what is counted.
const COUNTER: &[&str] =
    &["frame", "frames", "sample", "samples", "row", "index", "idx", "step", "bild", "image", "cuadro", "fotogramma"];

/// Words of a pendulum on a cart or an arm.
const PENDULUM: &[&str] = &["pole", "bob", "stange"];

/// Words of what carries it.
const CARRIER: &[&str] =
    &["cart", "trolley", "wagen", "chariot", "carro", "base", "arm", "motor", "servo", "rotor", "wheel"];

/// Words of a size.
const SIZE: &[&str] =
    &["absolute", "abs", "magnitude", "norm", "total", "absolut", "betrag", "absolue", "absoluto", "assoluto"];

/// Lower-case words of a name, split at signs and where a small letter meets a capital; digits at the end fall off.
fn words(name: &str) -> Vec<String> {
    name.split(|letter: char| !letter.is_alphanumeric() && letter != '°')
        .flat_map(|part| if is_unit_with_prefix(part) { vec![part.to_owned()] } else { humps(part) })
        .map(|word| word.to_lowercase().trim_end_matches(|letter: char| letter.is_ascii_digit()).to_owned())
        .filter(|word| !word.is_empty())
        .collect()
}

/// `timeMs` in two.
fn humps(part: &str) -> Vec<String> {
    let mut humps = vec![String::new()];
    let mut before_is_small = false;
    for letter in part.chars() {
        if before_is_small && letter.is_uppercase() {
            humps.push(String::new());
        }
        before_is_small = letter.is_lowercase();
        if let Some(hump) = humps.last_mut() {
            hump.push(letter);
        }
    }
    humps
}

/// `µT`, `mV`, `kHz`: of a unit with a capital its prefix is no word.
fn is_unit_with_prefix(part: &str) -> bool {
    let mut rest = part.chars();
    let is_prefix = rest.next().is_some_and(|letter| matches!(letter, 'n' | 'u' | 'µ' | 'μ' | 'm' | 'c' | 'h' | 'k'));
    is_prefix && matches!(rest.as_str(), "T" | "G" | "V" | "A" | "W" | "N" | "J" | "K" | "Hz" | "Pa")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_labs_are_understood() {
        let time = |unit| Meaning::Time { unit, strength: NAMES_THE_THING };
        let angle = |unit| Meaning::Angle { unit, strength: NAMES_THE_THING };
        let rate = |angle| Meaning::Rate { unit: Some(RateUnit::per_second(angle)) };
        let cases = [
            ("t", time(None)),
            ("Time [s]", time(Some(TimeUnit::Seconds))),
            ("time_ms", time(Some(TimeUnit::Milliseconds))),
            ("timestamp_us", time(Some(TimeUnit::Microseconds))),
            ("timeMs", time(Some(TimeUnit::Milliseconds))),
            ("ms", Meaning::Time { unit: Some(TimeUnit::Milliseconds), strength: NAMES_A_UNIT }),
            ("seconds", Meaning::Time { unit: Some(TimeUnit::Seconds), strength: NAMES_A_UNIT }),
            ("theta", angle(None)),
            ("THETA1", angle(None)),
            ("angle (deg)", angle(Some(AngleUnit::Degrees))),
            ("Winkel / °", angle(Some(AngleUnit::Degrees))),
            ("position_rad", angle(Some(AngleUnit::Radians))),
            ("deg", Meaning::Angle { unit: Some(AngleUnit::Degrees), strength: NAMES_A_UNIT }),
            ("omega", Meaning::Rate { unit: None }),
            ("angle rate", Meaning::Rate { unit: None }),
            ("angular_velocity", Meaning::Rate { unit: None }),
            ("AngVel", Meaning::Rate { unit: None }),
            ("Velocidad angular", Meaning::Rate { unit: None }),
            ("velocity", Meaning::Other),
            ("theta_dot", Meaning::Other),
            ("phi_punkt", Meaning::Other),
            ("theta_v", Meaning::Other),
            ("thetadot", Meaning::Other),
            ("dθ/dt", Meaning::Other),
            ("Gyroscope x (rad/s)", rate(AngleUnit::Radians)),
            ("Winkelgeschwindigkeit [°/s]", rate(AngleUnit::Degrees)),
            ("Drehzahl (rpm)", Meaning::Rate { unit: rate_unit("rpm") }),
            ("Vitesse angulaire (rad/s)", rate(AngleUnit::Radians)),
            ("Angular acceleration (rad/s²)", Meaning::Other),
            ("Position (m)", Meaning::Other),
            ("cart_pos", Meaning::Angle { unit: None, strength: NAMES_IT_PERHAPS }),
            ("α / °", angle(Some(AngleUnit::Degrees))),
            ("alpha", Meaning::Other),
            ("alpha (rad/s²)", Meaning::Other),
            ("cos(theta)", Meaning::Y),
            ("sin_alpha", Meaning::X),
            ("cx", Meaning::X),
            ("pendulum", Meaning::Angle { unit: None, strength: NAMES_IT_PERHAPS }),
            ("pendulum length", Meaning::Other),
            ("bob x (m)", Meaning::X),
            ("Datum", Meaning::Time { unit: None, strength: NAMES_IT_PERHAPS }),
            ("Tijd (s)", time(Some(TimeUnit::Seconds))),
            ("Vinkel [grader]", angle(Some(AngleUnit::Degrees))),
            ("Ângulo (graus)", angle(Some(AngleUnit::Degrees))),
            ("角度(°)", angle(Some(AngleUnit::Degrees))),
            ("x (m)", Meaning::X),
            ("y_px", Meaning::Y),
            ("Winkel [Grad]", angle(Some(AngleUnit::Degrees))),
            ("Ángulo (°)", angle(Some(AngleUnit::Degrees))),
            ("Angolo [gradi]", angle(Some(AngleUnit::Degrees))),
            ("Angle (degrés)", angle(Some(AngleUnit::Degrees))),
            ("Zeit in Sekunden", time(Some(TimeUnit::Seconds))),
            ("Temps (s)", time(Some(TimeUnit::Seconds))),
            ("Tiempo [ms]", time(Some(TimeUnit::Milliseconds))),
            ("Tempo (s)", time(Some(TimeUnit::Seconds))),
            ("v (rad/s)", rate(AngleUnit::Radians)),
            ("adc_code", Meaning::Code),
            ("voltage", Meaning::Other),
            ("Magnetic Field x (µT)", Meaning::Other),
            ("mx_uT", Meaning::Other),
            ("B (mT)", Meaning::Other),
            ("mV", Meaning::Other),
            ("gx_dps", rate(AngleUnit::Degrees)),
            ("motor_rpm", Meaning::Rate { unit: rate_unit("rpm") }),
        ];
        for (name, expected) in cases {
            assert_eq!(meaning(name), expected, "{name}");
        }
    }

    #[test]
    fn one_word_may_be_a_derivative() {
        for word in ["thetadot", "phipunkt", "thetaddot", "dtheta", "ddphi", "winkelgeschwindigkeit", "angularvelocity"]
        {
            assert!(is_derivative(word), "{word}");
            assert!(!matches!(meaning(&format!("{word} (deg)")), Meaning::Angle { .. }), "{word}");
        }
        for word in ["theta", "dot", "d", "angle"] {
            assert!(!is_derivative(word), "{word}");
        }
    }
}
