//! Can mass, length and inertia be those of the pendulum that was recorded? One check for command line, page and library.
//!
//! Gravity alone makes small swings of `T = 2π √((m·l² + I) / (m·g·l))`, so the period T tells what `I` must be beside m
//! and l, and that l is at most `g·(T/2π)²`. A drive of the model (a spring, a magnet, a typed torque) changes the period;
//! with one nothing is judged.

use crate::number::significant;
use crate::pace::small_period_s;
use crate::recording::Measured;
use crate::recording::growth::lengthening;
use crate::recording::median;
use crate::recording::plausible::Swings;
use crate::recording::turning::half_swing_s;
use crate::swing::Swing;
use shared::effect::{Action, CUSTOM_FORMULA_ID, Effect};
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Springs and magnets that the model lacks change a period, but not to half or twice: four times the moment of inertia.
const MOST_OFF: f64 = 4.0;

/// Between grams and kilograms lies 1000; a drawing may be off by some.
const GRAMS: std::ops::Range<f64> = 300.0..3000.0;

/// Who has less than a gram on the shaft does not mean grams.
const LEAST_KG_IN_GRAMS: f64 = 1.0;

/// A length beyond what the period allows by this share is doubted: periods of real pendulums are found within half a percent, and
/// lengths go with their square.
const LONGER: f64 = 1.01;

/// An inertia that is a smaller share of m·l² than this is hardly seen in the period.
const SEEN_SHARE: f64 = 0.05;

/// A pendulum as short as this is one whose geometry is unknown (`host init --unknown-geometry`), m.
const UNKNOWN_LENGTH_M: f64 = 1e-3;

/// Swings whose period of small swings differs by more than this from the others' are doubted: of real pendulums it is
/// found within half a percent, and a bob moved by a twentieth changes it by more.
const OTHER_PERIOD: f64 = 0.02;

/// Without any inertia but m·l² a rod's moment about the pivot is 4/3 too small; what is off by more than this is doubted.
const OTHER_PENDULUM: f64 = 1.5;

/// Angles that should lengthen the period by this much …
const CLEAR_LENGTHENING: f64 = 1.05;

/// … but leave it within so much of that of small swings are doubted.
const NOT_LENGTHENED: f64 = 0.01;

/// A geometry that the recording contradicts.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GeometryError {
    /// The centre of mass is too far from the pivot.
    #[error(
        "{name}: it swings with a period of {period_s:.3} s, but with its centre of mass {length_m} m from the pivot it \
         would take at least {least_s:.3} s; the length must be in metres and at most {most_m:.3}: \
         set `length = {proposed_m}` in rig.toml, or give `host init` that length"
    )]
    Length {
        /// The recording.
        name: String,
        /// As measured, s.
        period_s: f64,
        /// As given, m.
        length_m: f64,
        /// Of a point at this distance, s.
        least_s: f64,
        /// What the period allows, m.
        most_m: f64,
        /// What would fit, m.
        proposed_m: f64,
    },
    /// The mass was given in grams.
    #[error(
        "{name}: with a mass of {mass_kg} kg its period of {period_s:.3} s needs an inertia of {} kg·m², \
         {factor:.0} times the {inertia_kg_m2} given; if the mass is in grams, set `mass = {proposed_kg}` in rig.toml, or \
         give `host init` that mass; if it is right, correct `inertia`",
        significant(*needed_kg_m2, 4)
    )]
    Mass {
        /// The recording.
        name: String,
        /// As measured, s.
        period_s: f64,
        /// As given, kg.
        mass_kg: f64,
        /// As given, kg·m².
        inertia_kg_m2: f64,
        /// What the period asks for, kg·m².
        needed_kg_m2: f64,
        /// How many times.
        factor: f64,
        /// The same in kilograms.
        proposed_kg: f64,
    },
    /// The moment of inertia is far too large.
    #[error(
        "{name}: it swings with a period of {period_s:.3} s, but with an inertia of {inertia_kg_m2} kg·m² beside mass and \
         length it would take {predicted_s:.3} s; {}",
        cure_of_inertia(*needed_kg_m2)
    )]
    Inertia {
        /// The recording.
        name: String,
        /// As measured, s.
        period_s: f64,
        /// As given, kg·m².
        inertia_kg_m2: f64,
        /// What it would make, s.
        predicted_s: f64,
        /// What the period asks for, kg·m²; below zero where no inertia makes it as fast.
        needed_kg_m2: f64,
    },
}

/// What to do where the period asks for another inertia, kg·m².
fn cure_of_inertia(needed_kg_m2: f64) -> String {
    if needed_kg_m2 < 0.0 {
        return "no moment of inertia makes it as fast: measure the length from the pivot to the centre of mass again, in metres; \
                if it is right, look for what pulls beside gravity, such as a magnet or a spring, or leave this recording out"
            .to_owned();
    }
    format!(
        "give the moment of inertia about the centre of mass in kg·m²: set `inertia = {needed_kg_m2:.2e}` in rig.toml, which fits \
         the period, or give `host init` that inertia"
    )
}

/// Compares the pendulum of a model with the periods of swings; gives what is doubtful, in words.
///
/// # Errors
/// A number that can't be in the unit in which it was taken.
pub fn check(parameters: &Parameters<f64>, swings: &[Swing]) -> Result<Vec<String>, GeometryError> {
    if is_unknown(&parameters.pendulum) || has_drive(parameters) {
        return Ok(Vec::new());
    }
    let mut doubts = Vec::new();
    for swing in swings {
        let Some(seen) = seen(swing) else { continue };
        judge(&swing.name, seen.small_period_s(), &parameters.pendulum)?;
        doubts.extend(doubt_of_unit(&swing.name, &seen, &parameters.pendulum));
    }
    Ok(doubts)
}

/// The first swing, by its place, that gravity alone can't make so fast with the centre of mass as far away as given, with what is
/// doubtful of that in words. [`check`] refuses what is further off.
pub fn too_long(parameters: &Parameters<f64>, swings: &[Swing]) -> Option<(usize, String)> {
    let Pendulum { length_m, gravity_m_s2, .. } = parameters.pendulum;
    if is_unknown(&parameters.pendulum) || has_drive(parameters) {
        return None;
    }
    let contradicts = |(idx, swing): (usize, &Swing)| {
        let period_s = seen(swing)?.small_period_s();
        let most_m = gravity_m_s2 * (period_s / TAU).powi(2);
        (length_m > LONGER * most_m).then_some((idx, period_s, most_m))
    };
    let (idx, period_s, most_m) = swings.iter().enumerate().find_map(contradicts)?;
    let words = format!(
        "with the period of {period_s:.3} s the centre of mass is at most {most_m:.3} m from the pivot where gravity alone swings \
         it, and the model has length = {} m: measure that again before you believe that a spring or anything else is missing",
        significant(length_m, 4)
    );
    Some((idx, words))
}

/// What to ask where a fit wants less inertia than none: with all mass in one point the pendulum would still be slower than these
/// swings. Below what [`too_long`] tells before a fit, which knows periods less well.
pub fn slower_than_seen(parameters: &Parameters<f64>, swings: &[Swing]) -> Option<String> {
    let Pendulum { length_m, gravity_m_s2, .. } = parameters.pendulum;
    if is_unknown(&parameters.pendulum) || has_drive(parameters) {
        return None;
    }
    let periods_s = swings.iter().filter_map(|swing| Some(seen(swing)?.small_period_s()));
    let most_m = gravity_m_s2 * (periods_s.fold(f64::INFINITY, f64::min) / TAU).powi(2);
    (length_m > most_m).then(|| {
        let [length, most, slow] = [length_m, most_m, 100.0 * ((length_m / most_m).sqrt() - 1.0)];
        format!(
            "the moment of inertia ends at zero, and with all mass in one point the pendulum would still be slower than it swings: \
             its period allows a length of {} m, and the model has {} m. Measure it again, or say how surely it was measured \
             (its std in rig.toml), before you believe that a spring or anything else is missing; a clock that is {} % slow \
             looks alike",
            significant(most, 4),
            significant(length, 4),
            significant(slow, 2)
        )
    })
}

/// The first swing whose period asks for a moment about the pivot that is so far from the model's that the model may be another
/// pendulum's, in words: a fit would find an inertia for it and say nothing.
pub fn of_another(parameters: &Parameters<f64>, swings: &[Swing]) -> Option<String> {
    let pendulum = &parameters.pendulum;
    if is_unknown(pendulum) || has_drive(parameters) {
        return None;
    }
    let usual = OTHER_PENDULUM.recip()..OTHER_PENDULUM;
    let off = |swing: &Swing| {
        let period_s = seen(swing)?.small_period_s();
        let ratio = inertia_about_pivot(pendulum, period_s) / pendulum.pivot_inertia_kg_m2();
        (!usual.contains(&ratio)).then(|| (swing.name.clone(), period_s, ratio))
    };
    let (name, period_s, ratio) = swings.iter().find_map(off)?;
    Some(format!(
        "doubtful: {name}: it swings like another pendulum: its period is {period_s:.3} s, the model's {:.3} s, so that the moment of \
         inertia about the pivot would have to be {} times the model's; check that the model is this pendulum's, and its mass, \
         length and inertia",
        small_period_s(pendulum),
        significant(ratio, 3)
    ))
}

/// Swings among others of another period, by their place, with what is doubtful of them in words. A drive of the model may
/// change the period with the amplitude; with one nothing is judged.
pub fn other_periods(parameters: &Parameters<f64>, swings: &[Swing]) -> Vec<(usize, String)> {
    let words = |(idx, period_s, usual_s): (usize, f64, f64)| {
        let words = format!(
            "its period of small swings is {period_s:.3} s, that of the others {usual_s:.3} s: is it of another pendulum? \
             Fit those apart; of one pendulum, something beside gravity moves it"
        );
        (idx, words)
    };
    with_other_periods(parameters, swings, swings).into_iter().map(words).collect()
}

/// Held-out swings of another period than the fitted ones, by their place, with what is doubtful of them in words.
pub fn held_out_of_other_periods(
    parameters: &Parameters<f64>,
    fitted: &[Swing],
    held_out: &[Swing],
) -> Vec<(usize, String)> {
    let words = |(idx, period_s, usual_s): (usize, f64, f64)| {
        let words = format!(
            "its period of small swings is {period_s:.3} s, that of the fitted ones {usual_s:.3} s: is it of another \
             pendulum? Then its error says nothing of this fit"
        );
        (idx, words)
    };
    with_other_periods(parameters, fitted, held_out).into_iter().map(words).collect()
}

/// Place, period and usual period (s) of the swings whose period is not that of the usual ones.
fn with_other_periods(parameters: &Parameters<f64>, usual: &[Swing], swings: &[Swing]) -> Vec<(usize, f64, f64)> {
    if has_drive(parameters) {
        return Vec::new();
    }
    let period = |swing: &Swing| seen(swing).map(|seen| seen.small_period_s());
    let usual_s = median(&mut usual.iter().filter_map(period).collect::<Vec<_>>());
    let is_other = |period_s: &f64| (period_s / usual_s - 1.0).abs() > OTHER_PERIOD;
    let others = swings.iter().enumerate().filter_map(|(idx, swing)| Some((idx, period(swing).filter(is_other)?)));
    others.map(|(idx, period_s)| (idx, period_s, usual_s)).collect()
}

/// Is nothing known but the motion, so that torques and inertia are per m·g·l?
pub fn is_unknown(pendulum: &Pendulum<f64>) -> bool {
    pendulum.length_m <= UNKNOWN_LENGTH_M
}

/// What the units of such a model mean.
pub const PER_GRAVITY: &str =
    "The geometry is unknown: every torque and inertia is per m·g·l, which counts as 1 N·m in files and commands.";

/// The unit of a parameter as a person is told it: where the geometry is unknown, torques and inertia are in m·g·l.
pub fn unit_of<'a>(unit: &'a str, pendulum: &Pendulum<f64>) -> Cow<'a, str> {
    if unit == "1" {
        return "".into();
    }
    if !is_unknown(pendulum) {
        return unit.into();
    }
    unit.replace("kg·m²", "m·g·l·s²").replace("N·m", "m·g·l").into()
}

/// What of such a model the period tells: the inertia about the pivot, of which `I` lacks m·l².
pub fn about_the_pivot(pendulum: &Pendulum<f64>) -> String {
    let of_point = pendulum.mass_kg * pendulum.length_m.powi(2) / pendulum.gravity_torque_nm();
    let whole = pendulum.pivot_inertia_kg_m2() / pendulum.gravity_torque_nm();
    format!(
        "For a period T or for g take (m·l² + I)/(m·g·l) = (T/2π)² = {} s²: the I above and {} s² for m·l².",
        significant(whole, 5),
        significant(of_point, 3)
    )
}

/// Is there a torque beside gravity that makes it swing?
fn has_drive(parameters: &Parameters<f64>) -> bool {
    let is_drive = |id: u16| {
        Effect::<f64>::by_id(id)
            .is_some_and(|effect| matches!(effect.action, Action::Drive(_) | Action::State(_) | Action::Support(_)))
    };
    parameters.effects.iter().any(|effect| effect.id == CUSTOM_FORMULA_ID || is_drive(effect.id))
}

fn judge(name: &str, period_s: f64, pendulum: &Pendulum<f64>) -> Result<(), GeometryError> {
    let Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2 } = *pendulum;
    let name = name.to_owned();
    let most_m = gravity_m_s2 * (period_s / TAU).powi(2);
    if length_m > MOST_OFF * most_m {
        let least_s = TAU * (length_m / gravity_m_s2).sqrt();
        let proposed_m = in_metres(length_m, most_m);
        return Err(GeometryError::Length { name, period_s, length_m, least_s, most_m, proposed_m });
    }
    let of_point = mass_kg * length_m.powi(2);
    let needed_kg_m2 = inertia_about_pivot(pendulum, period_s) - of_point;
    let factor = needed_kg_m2 / inertia_kg_m2;
    if GRAMS.contains(&factor) && needed_kg_m2 > SEEN_SHARE * of_point && mass_kg >= LEAST_KG_IN_GRAMS {
        let proposed_kg = plain(mass_kg / 1000.0);
        return Err(GeometryError::Mass { name, period_s, mass_kg, inertia_kg_m2, needed_kg_m2, factor, proposed_kg });
    }
    let predicted_s = small_period_s(pendulum);
    if predicted_s > MOST_OFF.sqrt() * period_s {
        return Err(GeometryError::Inertia { name, period_s, inertia_kg_m2, predicted_s, needed_kg_m2 });
    }
    Ok(())
}

/// What makes this period of small swings, kg·m².
fn inertia_about_pivot(pendulum: &Pendulum<f64>, period_s: f64) -> f64 {
    pendulum.gravity_torque_nm() * (period_s / TAU).powi(2)
}

/// Gives a pendulum of unknown geometry the inertia that makes the period of the swings, where its own is so far from
/// it that it was guessed without having seen any.
pub fn begin_with_the_period(pendulum: &mut Pendulum<f64>, swings: &[Swing]) {
    if !is_unknown(pendulum) {
        return;
    }
    let Some(period_s) = swings.first().and_then(period_s) else { return };
    let needed_kg_m2 =
        (inertia_about_pivot(pendulum, period_s) - pendulum.mass_kg * pendulum.length_m.powi(2)).max(0.0);
    let off = needed_kg_m2 / pendulum.inertia_kg_m2;
    if needed_kg_m2.is_finite() && !(MOST_OFF.recip()..MOST_OFF).contains(&off) {
        pendulum.inertia_kg_m2 = needed_kg_m2;
    }
}

/// The period of small swings; of a few swings in much noise, that of all.
fn period_s(swing: &Swing) -> Option<f64> {
    let rough_s = || half_swing_s(&swing.times_s, &swing.angles_rad, swing.noise_rad).map(|half_s| 2.0 * half_s);
    seen(swing).map(|seen| seen.small_period_s()).or_else(rough_s)
}

/// The swings as angles show them.
fn seen(swing: &Swing) -> Option<Swings> {
    let seen = Swings::of(&swing.times_s, &swing.angles_rad)?;
    Some(if swing.measured == Measured::Rate { seen.in_angles() } else { seen })
}

/// Large angles with the period of small ones are none.
fn doubt_of_unit(name: &str, seen: &Swings, pendulum: &Pendulum<f64>) -> Option<String> {
    let (amplitude_rad, period_s) = seen.typical()?;
    let wanted = lengthening(amplitude_rad);
    let found = period_s / small_period_s(pendulum);
    let is_off = wanted > CLEAR_LENGTHENING && (found - 1.0).abs() < NOT_LENGTHENED;
    is_off.then(|| {
        format!(
            "doubtful: {name}: at {amplitude_rad:.2} rad this pendulum's period is {:.1} % longer than that of small swings, \
             measured is {:+.1} %; are these angles in radians? Say the unit, --columns theta=1:deg",
            100.0 * (wanted - 1.0),
            100.0 * (found - 1.0)
        )
    })
}

/// A length in centimetres or millimetres, or the largest there can be.
fn in_metres(length_m: f64, most_m: f64) -> f64 {
    let known = [100.0, 1000.0].map(|units| plain(length_m / units));
    known.into_iter().find(|length_m| *length_m <= most_m).unwrap_or(plain((1e3 * most_m).floor() / 1e3))
}

/// Without the rounding of a division.
fn plain(value: f64) -> f64 {
    format!("{value:.9}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small swings with the period of the paper's pendulum, 1.047 s: m·l² + I = 6.420e-3 kg·m², m·g·l = 0.22468 N·m.
    fn swings(amplitude_rad: f64, period_s: f64) -> Vec<Swing> {
        let times_s: Vec<f64> = (0..4000).map(|idx| f64::from(idx) * 5e-3).collect();
        let angle = |t: &f64| amplitude_rad * (-0.02 * t).exp() * (TAU * t / period_s).cos();
        let angles_rad: Vec<f64> = times_s.iter().map(angle).collect();
        vec![Swing::new("swing.csv", &times_s, &angles_rad, 1e-4)]
    }

    fn paper_but(change: impl Fn(&mut Pendulum<f64>)) -> Parameters<f64> {
        let mut parameters = Parameters::paper();
        parameters.pendulum = Pendulum::paper();
        change(&mut parameters.pendulum);
        parameters
    }

    fn refusal(change: impl Fn(&mut Pendulum<f64>)) -> String {
        let period_s = small_period_s(&Pendulum::paper());
        check(&paper_but(change), &swings(0.1, period_s)).expect_err("a refusal").to_string()
    }

    #[test]
    fn of_an_unknown_geometry_torques_are_told_in_those_of_gravity() {
        let unknown = Pendulum { length_m: UNKNOWN_LENGTH_M, ..Pendulum::paper() };
        let units = ["N·m·s/rad", "N·m", "kg·m²", "N·m·s²/rad²", "N·m/rad", "rad", "s", "1"];
        let told = |pendulum: &Pendulum<f64>| units.map(|unit| unit_of(unit, pendulum).into_owned());
        let own = ["m·g·l·s/rad", "m·g·l", "m·g·l·s²", "m·g·l·s²/rad²", "m·g·l/rad", "rad", "s", ""];
        assert_eq!(told(&unknown), own);
        assert_eq!(told(&Pendulum::paper())[..3], units[..3]);
    }

    #[test]
    fn numbers_in_other_units_are_refused_with_the_line_that_cures_them() {
        let mass = refusal(|pendulum| pendulum.mass_kg *= 1000.0);
        assert!(mass.contains("an inertia of 2.8") && !mass.contains("e0 kg"), "{mass}");
        assert!(mass.contains("grams") && mass.contains("`mass = 0.1466084`"), "{mass}");
        let length = refusal(|pendulum| pendulum.length_m *= 100.0);
        assert!(length.contains("metres") && length.contains("`length = 0.1562177`"), "{length}");
        let length = refusal(|pendulum| pendulum.length_m *= 1000.0);
        assert!(length.contains("`length = 0.1562177`"), "{length}");
        let inertia = refusal(|pendulum| pendulum.inertia_kg_m2 *= 1000.0);
        assert!(inertia.contains("`inertia = 2.8"), "{inertia}");
    }

    #[test]
    fn no_inertia_is_proposed_where_none_makes_the_pendulum_as_fast() {
        // A point at the paper's length takes 0.79 s.
        let refused = check(&paper_but(|_| ()), &swings(0.1, 0.5)).expect_err("a refusal").to_string();
        assert!(refused.contains("no moment of inertia") && !refused.contains("`inertia"), "{refused}");
    }

    #[test]
    fn a_right_geometry_passes_and_so_does_one_that_is_unknown_or_has_a_spring() {
        let period_s = small_period_s(&Pendulum::paper());
        assert_eq!(check(&paper_but(|_| ()), &swings(0.1, period_s)), Ok(Vec::new()));
        assert_eq!(check(&paper_but(|p| p.inertia_kg_m2 *= 3.0), &swings(0.1, period_s)), Ok(Vec::new()));
        assert_eq!(check(&paper_but(|p| p.length_m = 1e-3), &swings(0.1, 0.3)), Ok(Vec::new()));
        let mut sprung = paper_but(|p| p.length_m *= 100.0);
        let drive = Effect::<f64>::ALL.iter().find(|effect| matches!(effect.action, Action::Drive(_))).unwrap();
        sprung.set(drive.id, &vec![0.0; drive.parameters.len()]).unwrap();
        assert_eq!(check(&sprung, &swings(0.1, period_s)), Ok(Vec::new()));
    }

    #[test]
    fn a_length_that_the_period_does_not_allow_is_doubted_unless_a_drive_may_shorten_it() {
        let period_s = small_period_s(&Pendulum::paper());
        let most_m = 9.81 * (period_s / TAU).powi(2);
        let of = |length_m: f64| too_long(&paper_but(|pendulum| pendulum.length_m = length_m), &swings(0.1, period_s));
        assert_eq!(of(1.005 * most_m), None);
        let (idx, words) = of(1.02 * most_m).unwrap();
        assert!(idx == 0 && words.contains(&format!("at most {most_m:.3} m")), "{words}");
        let (_, words) = of(0.40800000000000003).unwrap();
        assert!(words.contains("length = 0.4080 m:"), "{words}");
        let mut sprung = paper_but(|pendulum| pendulum.length_m = 1.02 * most_m);
        sprung.set(Effect::<f64>::by_name("torsional-spring").unwrap().id, &[0.0]).unwrap();
        assert_eq!(too_long(&sprung, &swings(0.1, period_s)), None);
    }

    #[test]
    fn a_length_that_leaves_no_inertia_is_told_with_the_one_that_the_period_allows() {
        let period_s = small_period_s(&Pendulum::paper());
        let most_m = 9.81 * (period_s / TAU).powi(2);
        let of = |length_m: f64| {
            slower_than_seen(&paper_but(|pendulum| pendulum.length_m = length_m), &swings(0.1, period_s))
        };
        assert_eq!(of(0.98 * most_m), None);
        let words = of(1.008 * most_m).unwrap();
        // The period is found within 0.04 %.
        assert!(words.contains("a length of 0.2801 m, and the model has 0.2826 m"), "{words}");
        assert!(words.contains("0.44 % slow"), "{words}");
    }

    #[test]
    fn a_swing_of_another_pendulum_among_others_is_doubted() {
        let of = |periods_s: &[f64]| -> Vec<Swing> {
            periods_s.iter().flat_map(|period_s| swings(0.1, *period_s)).collect()
        };
        let doubted = |periods_s: &[f64]| other_periods(&paper_but(|_| ()), &of(periods_s));
        assert_eq!(doubted(&[1.047, 1.049]), []);
        let two = doubted(&[1.047, 1.078]);
        assert!(two.len() == 1 && two[0].1.contains("1.047 s") && two[0].1.contains("1.078 s"), "{two:?}");
        let three = doubted(&[1.047, 1.047, 1.09]);
        assert!(three.len() == 1 && three[0].0 == 2, "{three:?}");
        let told = "its period of small swings is 1.090 s, that of the others 1.047 s";
        assert!(three[0].1.starts_with(told), "{three:?}");
    }

    /// A period 1.3 times as long asks for 1.69 times the moment about the pivot; 1.2 times for 1.44, a rod's left out.
    #[test]
    fn a_period_far_from_the_models_is_told_as_another_pendulums() {
        let told =
            |times: f64| of_another(&paper_but(|_| {}), &swings(0.1, times * small_period_s(&Pendulum::paper())));
        assert!(told(1.3).unwrap().contains("would have to be 1.69 times the model's"), "{:?}", told(1.3));
        assert!(told(0.8).unwrap().contains("swings like another pendulum"), "{:?}", told(0.8));
        assert_eq!([told(1.2), told(1.0), told(0.85)], [None, None, None]);
    }

    #[test]
    fn a_held_out_swing_of_another_pendulum_is_doubted_by_the_fitted_ones() {
        let doubted = |fitted_s: f64, held_out_s: f64| {
            let (fitted, held_out) = (swings(0.1, fitted_s), swings(0.1, held_out_s));
            held_out_of_other_periods(&paper_but(|_| ()), &fitted, &held_out)
        };
        assert_eq!(doubted(1.047, 1.049), []);
        let told = doubted(1.047, 1.09);
        let words =
            "its period of small swings is 1.090 s, that of the fitted ones 1.047 s: is it of another pendulum?";
        assert!(told.len() == 1 && told[0].1.starts_with(words), "{told:?}");
        assert_eq!(held_out_of_other_periods(&paper_but(|_| ()), &[], &swings(0.1, 1.0)), []);
    }

    #[test]
    fn large_angles_with_the_period_of_small_ones_are_doubted() {
        let period_s = small_period_s(&Pendulum::paper());
        let doubts = check(&paper_but(|_| ()), &swings(2.0, period_s)).unwrap();
        assert!(doubts.len() == 1 && doubts[0].contains("theta=1:deg"), "{doubts:?}");
    }
}
