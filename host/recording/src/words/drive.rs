//! Names of what moves a pendulum: the command of a motor, its voltage, its torque.

use super::meaning::{Meaning, meaning};
use super::split::words;

/// What drives the pendulum where it moves, as a name says it: `pwm`, `u`, `motor_current (A)`, `Stellgröße`.
pub(crate) fn is_of_drive(name: &str) -> bool {
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let is_bare = || words.iter().all(|word| BARE.contains(&word.as_str()) || UNITS.contains(&word.as_str()));
    let may_be = matches!(meaning(name), Meaning::Other | Meaning::Rate { .. }) && !has(OTHERS);
    may_be && (has(DRIVE) || (has(BARE) && is_bare()) || is_of_volts(name))
}

/// Does it say volts and nothing else? The voltage of a motor is one, and that of a potentiometer.
pub(crate) fn is_of_volts(name: &str) -> bool {
    let words = words(name);
    let is_of = |word: &String| VOLTS.contains(&word.as_str());
    words.iter().any(is_of) && words.iter().all(|word| is_of(word) || UNITS.contains(&word.as_str()))
}

/// Words that are enough.
const DRIVE: &[&str] = &[
    "pwm",
    "duty",
    "dutycycle",
    "torque",
    "tau",
    "τ",
    "motor",
    "servo",
    "throttle",
    "cmd",
    "command",
    "control",
    "ctrl",
    "actuator",
    "actuation",
    "action",
    "effort",
    "drive",
    "driver",
    "driving",
    "excitation",
    "armature",
    "vm",
    "umotor",
    "vmotor",
    "imotor",
    "drehmoment",
    "motormoment",
    "motorspannung",
    "motorstrom",
    "ankerspannung",
    "ankerstrom",
    "strom",
    "stellgröße",
    "stellgroesse",
    "stellsignal",
    "stellwert",
    "steuerung",
    "steuersignal",
    "erreger",
    "anregung",
    "antrieb",
    "couple",
    "commande",
    "moteur",
    "courant",
    "forçage",
    "comando",
    "mando",
    "corriente",
    "forzamiento",
    "forzado",
    "coppia",
    "motore",
    "corrente",
    "forzante",
    "sterowanie",
    "prąd",
    "двигатель",
    "момент",
    "ток",
    "управление",
    "电机",
    "电流",
    "扭矩",
    "力矩",
    "控制量",
    "占空比",
    "モータ",
    "トルク",
    "電流",
];

/// Letters and words that say it where nothing but a unit stands beside them: `u (V)`, and not `u_theta`, which is how sure
/// an angle is; `current (A)`, and not `current value`.
const BARE: &[&str] = &["u", "input", "uin", "outu", "uout", "current"];

/// Words of a voltage.
const VOLTS: &[&str] = &[
    "voltage",
    "volts",
    "volt",
    "spannung",
    "voltaje",
    "tensione",
    "tensão",
    "tensao",
    "napięcie",
    "напряжение",
    "电压",
    "電圧",
];

/// Units of them.
const UNITS: &[&str] = &["v", "mv", "volt", "volts", "a", "ma", "n", "nm", "mnm", "m", "percent"];

/// Words of what a file says of a battery, of a torque that is worked out, or of what should be.
const OTHERS: &[&str] = &[
    "battery",
    "bat",
    "batt",
    "vbat",
    "supply",
    "akku",
    "restoring",
    "gravity",
    "gravitational",
    "friction",
    "damping",
    "drag",
    "inertia",
    "mode",
    "state",
    "time",
    "count",
    "temperature",
    "temp",
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_a_pendulum_is_told_from_what_moves_with_it() {
        let drives = [
            "pwm",
            "PWM_duty (%)",
            "u",
            "u (V)",
            "torque [Nm]",
            "meas_tau",
            "motor_current (A)",
            "MotorVoltage",
            "voltage",
            "Vm (V)",
            "Current",
            "control",
            "cmd_vel",
            "motor_speed",
            "motor_rpm",
            "Stellgröße",
            "Drehmoment (Nm)",
            "Forzante",
            "commande",
            "控制量",
            "Input (V)",
            "outu",
        ];
        for name in drives {
            assert!(is_of_drive(name), "{name}");
        }
        let others = [
            "u_theta",
            "u(theta)",
            "current_angle",
            "current value",
            "Current Time (s)",
            "battery voltage",
            "restoring torque",
            "motor_angle",
            "x",
            "theta",
            "omega",
            "alpha",
            "Force (N)",
            "input angle",
            "control mode",
            "v",
        ];
        for name in others {
            assert!(!is_of_drive(name), "{name}");
        }
        assert!(is_of_volts("Voltage (V)") && !is_of_volts("motor voltage") && !is_of_volts("pwm"));
    }
}
