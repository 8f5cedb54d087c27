//! Where a formula is looked at before it is used: everywhere it must give a number.

use super::FormulaError;
use super::parse::Parsed;
use shared::effect::MAX_VALUES;
use shared::formula::{Formula, Program};
use shared::motion::{Motion, Pendulum};
use std::f64::consts::PI;

const ANGLES_RAD: [f64; 7] = [-PI, -1.3, -0.2, 0.0, 0.31, 1.0, PI];
const VELOCITIES_RAD_S: [f64; 9] = [-25.0, -8.0, -0.7, -1e-3, 0.0, 2e-3, 0.5, 7.0, 25.0];
const TIMES_S: [f64; 3] = [0.0, 3.7, 60.0];

/// Where a parameter is looked at within its range.
const SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// Instants all over what a pendulum does.
pub(super) fn instants() -> impl Iterator<Item = Motion<f64>> {
    let at = |angle_rad: f64, velocity_rad_s: f64, time_s: f64| Motion {
        angle_rad,
        velocity_rad_s,
        direction: if velocity_rad_s == 0.0 { 0.0 } else { velocity_rad_s.signum() },
        time_s,
        pendulum: Pendulum::paper(),
    };
    ANGLES_RAD.into_iter().flat_map(move |angle| {
        VELOCITIES_RAD_S
            .into_iter()
            .flat_map(move |velocity| TIMES_S.into_iter().map(move |time| at(angle, velocity, time)))
    })
}

/// Every combination of low, middle and high values.
fn values(parsed: &Parsed) -> impl Iterator<Item = [f64; MAX_VALUES]> + '_ {
    let n = parsed.parameters.len();
    (0..SHARES.len().pow(n as u32)).map(move |combination| {
        std::array::from_fn(|index| {
            let share = SHARES[combination / SHARES.len().pow(index as u32) % SHARES.len()];
            parsed.parameters.get(index).map_or(0.0, |p| p.low + share * (p.high - p.low))
        })
    })
}

/// Refuses a formula that gives no number somewhere, and tells where.
pub(super) fn has_values(parsed: &Parsed, formula: &Formula) -> Result<(), FormulaError> {
    let (exact, as_on_board) = (Program::<f64>::new(formula), Program::<f32>::new(formula));
    for values in values(parsed) {
        for motion in instants() {
            let on_board = as_on_board.raw_nm(&rounded(&motion), &values.map(|value| value as f32));
            let raw = exact.raw_nm(&motion, &values);
            if !raw.is_finite() || !on_board.is_finite() {
                return Err(FormulaError::whole(&parsed.text, no_number(parsed, &motion, &values, raw)));
            }
        }
    }
    Ok(())
}

fn rounded(motion: &Motion<f64>) -> Motion<f32> {
    let p = &motion.pendulum;
    Motion {
        angle_rad: motion.angle_rad as f32,
        velocity_rad_s: motion.velocity_rad_s as f32,
        direction: motion.direction as f32,
        time_s: motion.time_s as f32,
        pendulum: Pendulum {
            mass_kg: p.mass_kg as f32,
            length_m: p.length_m as f32,
            inertia_kg_m2: p.inertia_kg_m2 as f32,
            gravity_m_s2: p.gravity_m_s2 as f32,
        },
    }
}

fn no_number(parsed: &Parsed, motion: &Motion<f64>, values: &[f64; MAX_VALUES], raw: f64) -> String {
    let numbers = parsed.parameters.iter().zip(values).map(|(p, value)| format!(", {} = {value}", p.name));
    let place = format!(
        "theta = {:.3}, omega = {}, t = {}{}",
        motion.angle_rad,
        motion.velocity_rad_s,
        motion.time_s,
        numbers.collect::<String>()
    );
    let hint = if raw.is_nan() {
        "0/0, or a broken power or root of a negative number: write abs(omega)^p, and sgn(omega) for its direction"
    } else {
        "a division by zero or an overflow: keep the divisor from zero, or narrow a range"
    };
    format!("the formula has no finite value at {place}; {hint}")
}
