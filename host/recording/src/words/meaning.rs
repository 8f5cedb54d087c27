//! What a column name means: time, angle, rate, code, a coordinate, or something else.

use super::derivative::{has_derivative_sign, is_derivative};
use super::hints::is_of_pendulum;
use super::sensors::{TURNS_OF_BODY, is_about_axis, is_acceleration, says_acceleration};
use super::split::{pieces, words};
use super::unit_in_name::{InName, PerTime, per_time, unit_in};
use super::vocabulary::{
    ANGLE, CODE, COSINE, DATE, DERIVED, DISPLACEMENT, OF_PLACE, OTHER_QUANTITIES, OTHER_UNITS, RATE, SINE, SPEED, TILT,
    TIME, X, Y,
};
use crate::units::{AngleUnit, RateUnit, TimeUnit, angle_unit, rate_word, time_unit};

/// What a column name says about its content.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Meaning {
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

/// Is it a temperature, a magnetic field and the like?
pub(crate) fn is_other_quantity(name: &str) -> bool {
    Name::of(name).has(OTHER_QUANTITIES)
}

const ALPHA: &[&str] = &["alpha", "α"];

/// Is it called an angle, and not by a unit or a place alone?
pub(crate) fn is_named_angle(name: &str) -> bool {
    matches!(meaning(name), Meaning::Angle { strength: NAMES_THE_THING, .. })
}

/// Reads the words of a column name: the first that they say of it counts.
pub(crate) fn meaning(name: &str) -> Meaning {
    let name = Name::of(name);
    let said = [
        Name::other_quantity,
        Name::alpha,
        Name::derived,
        Name::named_time,
        Name::of_sine,
        Name::angular_displacement,
        Name::axis_of_seconds,
        Name::about_axis,
        Name::coordinate,
        Name::other_unit,
        Name::named_angle,
    ];
    said.iter().find_map(|says| says(&name)).unwrap_or_else(|| name.by_its_unit())
}

/// A column name with its words and units.
struct Name<'a> {
    name: &'a str,
    words: Vec<String>,
    time: Option<TimeUnit>,
    angle: Option<AngleUnit>,
    per_time: Option<PerTime>,
    /// Of a unit of time and one of an angle: is the latter that of the column?
    is_in_angles: bool,
}

impl<'a> Name<'a> {
    fn of(name: &'a str) -> Self {
        let pieces = pieces(name);
        let (time, angle) = (unit_in(&pieces, time_unit), unit_in(&pieces, angle_unit));
        let is_in_angles = angle.as_ref().map(InName::rank) > time.as_ref().map(InName::rank);
        let (time, angle) = (time.map(|found| found.unit), angle.map(|found| found.unit));
        Self { name, words: words(name), time, angle, per_time: per_time(&pieces), is_in_angles }
    }

    fn has(&self, list: &[&str]) -> bool {
        self.words.iter().any(|word| list.contains(&word.as_str()))
    }

    fn other_quantity(&self) -> Option<Meaning> {
        let in_tesla = ["(T)", "[T]", "/ T"].iter().any(|unit| self.name.trim_end().ends_with(unit));
        let is_other = (self.has(OTHER_QUANTITIES) || in_tesla) && self.angle.is_none();
        // Degrees may be those of a place on earth.
        ((is_other || self.has(OF_PLACE)) && !self.has(ANGLE)).then_some(Meaning::Other)
    }

    /// `α / °` is an angle; without a unit it is taken for the acceleration.
    fn alpha(&self) -> Option<Meaning> {
        let is_angle = self.angle.is_some() && self.per_time.is_none() && self.has(ALPHA);
        (is_angle && self.words.len() <= 2 && !self.is_squared())
            .then_some(Meaning::Angle { unit: self.angle, strength: NAMES_THE_THING })
    }

    /// An acceleration, or the square of a rate.
    fn is_squared(&self) -> bool {
        let is_power =
            || self.name.contains('²') || self.name.match_indices('^').any(|(at, _)| !is_inverse(&self.name[at..]));
        self.per_time.as_ref().is_some_and(|per_time| per_time.is_squared) || is_power()
    }

    /// A derivative: an angular velocity, or nothing that is read.
    fn derived(&self) -> Option<Meaning> {
        let is_per_time = self.per_time.is_some();
        let has_rate_unit = self.words.iter().any(|word| rate_word(word).is_some());
        if !(is_per_time || has_rate_unit || self.is_derived()) {
            return None;
        }
        let is_rate = (is_per_time || has_rate_unit || self.has(RATE) || self.is_angular_velocity())
            && !self.is_squared()
            && !says_acceleration(&self.words)
            && !self.has(&["alpha"]);
        Some(if is_rate { Meaning::Rate { unit: self.rate_unit() } } else { Meaning::Other })
    }

    fn is_derived(&self) -> bool {
        // Of an angle alpha its sine is none.
        let is_sine = self.has(SINE) || self.has(COSINE);
        let is_alpha = |word: &str| is_sine && ALPHA.contains(&word);
        let says_derived = self.words.iter().any(|word| DERIVED.contains(&word.as_str()) && !is_alpha(word));
        // `dAngle` falls into two words.
        let is_step = self.words.windows(2).any(|pair| pair[0] == "d" && is_derivative(&pair.concat()));
        says_derived
            || says_acceleration(&self.words)
            || is_step
            || self.words.iter().any(|word| is_derivative(word))
            || has_derivative_sign(self.name)
    }

    /// `angular_velocity`, `AngVel`, `vitesse angulaire`, `yaw_speed`, and no acceleration.
    fn is_angular_velocity(&self) -> bool {
        (self.is_angular() || self.has(&["ang"]) || self.has(TURNS_OF_BODY)) && self.has(SPEED) || self.has(&["angvel"])
    }

    fn is_angular(&self) -> bool {
        self.has(&["angular", "angulaire", "angolare"])
    }

    /// Of a rate: an angle alone is meant per second.
    fn rate_unit(&self) -> Option<RateUnit> {
        let per_time = self.per_time.as_ref().map(|per_time| per_time.unit);
        let in_one_word = || self.words.iter().find_map(|word| rate_word(word));
        per_time.or_else(in_one_word).or_else(|| self.angle.map(RateUnit::per_second))
    }

    fn named_time(&self) -> Option<Meaning> {
        // `AngleAtTime(deg)` is none.
        let is_time = self.has(TIME) && !(self.angle.is_some() && self.has(ANGLE));
        is_time.then_some(Meaning::Time { unit: self.time, strength: NAMES_THE_THING })
    }

    /// The sine and the cosine of an angle are x and y of a point at distance 1.
    fn of_sine(&self) -> Option<Meaning> {
        one_of(self.has(SINE), self.has(COSINE))
    }

    fn angular_displacement(&self) -> Option<Meaning> {
        (self.is_angular() && self.has(DISPLACEMENT))
            .then_some(Meaning::Angle { unit: self.angle, strength: NAMES_THE_THING })
    }

    /// Does it name an angle, by a unit or by a word that is more than a place?
    fn is_angle(&self) -> bool {
        self.angle.is_some() || self.words.iter().any(|word| ANGLE.contains(&word.as_str()) && !word.starts_with("pos"))
    }

    /// The axis along which a plot or a screen counts seconds.
    fn axis_of_seconds(&self) -> Option<Meaning> {
        let is_short = matches!(self.time, Some(unit) if unit != TimeUnit::Minutes && unit != TimeUnit::Days);
        let is_x = self.has(&["x"]) && !self.has(&["y"]);
        (is_short && is_x && !self.has(OTHER_UNITS) && !self.is_angle())
            .then_some(Meaning::Time { unit: self.time, strength: NAMES_A_UNIT })
    }

    fn about_axis(&self) -> Option<Meaning> {
        (!self.is_angle() && is_about_axis(&self.words))
            .then_some(Meaning::Angle { unit: None, strength: NAMES_A_UNIT })
    }

    fn coordinate(&self) -> Option<Meaning> {
        one_of(self.has(X), self.has(Y)).filter(|_| !self.is_angle() && !is_acceleration(self.name))
    }

    fn other_unit(&self) -> Option<Meaning> {
        self.has(OTHER_UNITS).then_some(Meaning::Other)
    }

    fn named_angle(&self) -> Option<Meaning> {
        let strength = if self.is_angle() { NAMES_THE_THING } else { NAMES_IT_PERHAPS };
        self.has(ANGLE).then_some(Meaning::Angle { unit: self.angle, strength })
    }

    /// What a name says that names nothing.
    fn by_its_unit(&self) -> Meaning {
        match (self.has(CODE), self.time, self.angle) {
            (true, ..) => Meaning::Code,
            (_, Some(_), _) if !self.is_in_angles => Meaning::Time { unit: self.time, strength: NAMES_A_UNIT },
            (.., Some(_)) => Meaning::Angle { unit: self.angle, strength: NAMES_A_UNIT },
            _ if self.has(TILT) || self.has(TURNS_OF_BODY) => Meaning::Angle { unit: None, strength: NAMES_A_UNIT },
            // `pendulum`, where nothing else is said of it.
            _ if is_of_pendulum(self.name) && self.words.len() == 1 => {
                Meaning::Angle { unit: None, strength: NAMES_IT_PERHAPS }
            }
            _ if self.has(DATE) => Meaning::Time { unit: None, strength: NAMES_IT_PERHAPS },
            _ => Meaning::Other,
        }
    }
}

/// Of a power: is it that of one divided by it? `^-1`, `^(-1)`, `^{-1}`.
fn is_inverse(power: &str) -> bool {
    power.trim_start_matches(['^', '(', '{']).starts_with("-1")
}

/// x or y, where it is not both.
fn one_of(is_x: bool, is_y: bool) -> Option<Meaning> {
    match (is_x, is_y) {
        (true, false) => Some(Meaning::X),
        (false, true) => Some(Meaning::Y),
        _ => None,
    }
}

/// Whether a cell is nothing but a unit, as in a second header line.
pub(crate) fn is_unit(cell: &str) -> bool {
    let cell = cell.trim_matches(['[', ']', '(', ')', ' ']).to_lowercase();
    time_unit(&cell).is_some()
        || angle_unit(&cell).is_some()
        || OTHER_UNITS.contains(&cell.as_str())
        || matches!(cell.as_str(), "rad/s" | "deg/s" | "°/s" | "v" | "g" | "m/s" | "m/s²" | "m/s^2")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::rate_unit;

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
            ("θr", angle(None)),
            ("theta_r", angle(None)),
            ("angle (deg)", angle(Some(AngleUnit::Degrees))),
            ("angles", angle(None)),
            ("Ángulos (°)", angle(Some(AngleUnit::Degrees))),
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
            ("FFT f_3 / rad", Meaning::Other),
            ("thetadot", Meaning::Other),
            ("dθ/dt", Meaning::Other),
            ("Gyroscope x (rad/s)", rate(AngleUnit::Radians)),
            ("Winkelgeschwindigkeit [°/s]", rate(AngleUnit::Degrees)),
            ("Drehzahl (rpm)", Meaning::Rate { unit: rate_unit("rpm") }),
            ("Vitesse angulaire (rad/s)", rate(AngleUnit::Radians)),
            ("Angular acceleration (rad/s²)", Meaning::Other),
            ("Angular displacement", angle(None)),
            ("Desplazamiento angular (°)", angle(Some(AngleUnit::Degrees))),
            ("Euler_X", Meaning::Angle { unit: None, strength: NAMES_A_UNIT }),
            ("orientation.w", Meaning::Other),
            ("Winkelbeschleunigung (rad/s2)", Meaning::Other),
            ("Accélération angulaire (rad/s2)", Meaning::Other),
            ("Displacement (m)", Meaning::Other),
            ("displacement", Meaning::Other),
            ("摆角(弧度)", angle(Some(AngleUnit::Radians))),
            ("角位移", angle(None)),
            ("角速度(度/秒)", rate(AngleUnit::Degrees)),
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
            ("KE_Y", Meaning::Other),
            ("x kinetic energy (J)", Meaning::Other),
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
            ("Time in s", time(Some(TimeUnit::Seconds))),
            ("Angle in degrees", angle(Some(AngleUnit::Degrees))),
            ("Winkel in Grad", angle(Some(AngleUnit::Degrees))),
            ("Angle en degrés", angle(Some(AngleUnit::Degrees))),
            ("Ángulo en grados", angle(Some(AngleUnit::Degrees))),
            ("position in", Meaning::Other),
            ("Position in m", Meaning::Other),
            ("Temps (s)", time(Some(TimeUnit::Seconds))),
            ("Tiempo [ms]", time(Some(TimeUnit::Milliseconds))),
            ("Tempo (s)", time(Some(TimeUnit::Seconds))),
            ("v (rad/s)", rate(AngleUnit::Radians)),
            ("adc_code", Meaning::Code),
            ("voltage", Meaning::Other),
            ("Magnetic Field x (µT)", Meaning::Other),
            ("acel x", Meaning::Other),
            ("mx_uT", Meaning::Other),
            ("Latitude (°)", Meaning::Other),
            ("Direction (°)", Meaning::Other),
            ("B (mT)", Meaning::Other),
            ("mV", Meaning::Other),
            ("gx_dps", rate(AngleUnit::Degrees)),
            ("motor_rpm", Meaning::Rate { unit: rate_unit("rpm") }),
            ("Angle after 10 s (deg)", angle(Some(AngleUnit::Degrees))),
            ("α after 10 s (deg)", Meaning::Other),
            (
                "Ground To PENDULUM - 4.9966e-003 s (Relative Rotation Z) [°]",
                Meaning::Angle { unit: Some(AngleUnit::Degrees), strength: NAMES_A_UNIT },
            ),
            (
                "Pendulum (deg), released after 10 s",
                Meaning::Angle { unit: Some(AngleUnit::Degrees), strength: NAMES_A_UNIT },
            ),
            ("ω (rad·s⁻¹)", rate(AngleUnit::Radians)),
            ("ω [rad s^{-1}]", rate(AngleUnit::Radians)),
            ("wz_deg_s", rate(AngleUnit::Degrees)),
            ("pink_s0.05", Meaning::Other),
            ("x (rad/s²)", Meaning::Other),
            ("x-axis (g)", Meaning::Other),
            ("y (m/s²)", Meaning::Other),
            ("theta_rad_s2", Meaning::Other),
            ("omega^2", Meaning::Other),
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
