//! What an effect does to one swing, told by numbers that a person can picture: energy lost, period, reading.
//!
//! The fitted model swings once from a usual amplitude, with the effect and without it; and once more where the longest
//! recording ends, because a reading may wander.

use crate::fit::problem::Problem;
use crate::formula::effect_of;
use crate::number::angle;
use crate::recording::Measured;
use crate::swing::kind;
use serde::Serialize;
use shared::effect::{Action, Effect, Family};
use shared::model::Model;
use shared::parameters::Parameters;

/// The amplitude, rad, unless the recordings did not reach it.
const AMPLITUDE_RAD: f64 = 1.0;

/// Steps in one period.
const STEPS: f64 = 2000.0;

/// Shares of lost energy and of the period, and angles as shares of the amplitude, below these are not worth a word; of
/// rates as many rad/s as rad of an angle.
const LEAST_LOSS: f64 = 0.01;
const LEAST_PERIOD: f64 = 1e-4;
const LEAST_READING: f64 = 1e-3;

/// A reading that is moved so many times further at the end of a swing than at its beginning wanders in time.
const WANDERS: f64 = 2.0;

/// A law that changes the period by more than this part of what it changes the loss is one of the period: a spring changes
/// the speed and with it the loss a little, a drag hardly the period.
const LOSS_PER_PERIOD: f64 = 10.0;

/// Friction that grows may end a wide swing at once by the end of the longest one: told is the latest of its half, its quarter
/// and so on at which it does not.
const HALVINGS: i32 = 6;

/// What one effect does.
#[derive(Clone, Debug, Serialize)]
pub struct Evidence {
    /// The effect.
    pub effect: &'static str,
    /// The amplitude of the swing, rad.
    pub amplitude_rad: f64,
    /// Its share of the energy that one period loses; negative if less is lost with it.
    pub loss_share: f64,
    /// By how much it lengthens the period, as a share.
    pub period_share: f64,
    /// The most by which it moves the reading of the same motion, rad; of one that wanders, until the swing's end; 0 of a
    /// law of the motion, with which another motion is read. Of rates in rad/s.
    pub reading_rad: f64,
    /// The same in words.
    pub words: String,
    /// The picture of `host compare` in which it shows.
    pub picture: &'static str,
}

/// One period of a model.
struct Period {
    lost_j: f64,
    period_s: f64,
    readings_rad: Vec<f64>,
}

/// Evidence for each added effect of a fitted model.
pub fn evidence(problem: &Problem, parameters: &Parameters<f64>) -> Vec<Evidence> {
    let reached_rad = problem.largest_rad();
    let amplitude_rad = AMPLITUDE_RAD.min(0.9 * reached_rad);
    let added = parameters.effects.iter().filter_map(|present| effect_of(parameters, present.id));
    let (longest_s, measured) = (problem.longest_s(), kind(problem.swings));
    let of = |effect: &'static Effect<f64>| {
        let mut without = parameters.clone();
        without.remove(effect.id);
        let both = |time_s: f64| [parameters, &without].map(|of| period(of, measured, amplitude_rad, time_s));
        let [with, without] = both(0.0);
        let (with, without) = (with?, without?);
        let (found, early_j) = (compared(effect, measured, amplitude_rad, &with, &without), with.lost_j);
        if effect.family == Family::Time {
            let of_late = |time_s: f64| {
                let [late, late_without] = both(time_s);
                let (late, late_without) = (late?, late_without?);
                let told = compared(effect, measured, amplitude_rad, &late, &late_without);
                Some(told.ageing(late.lost_j / early_j, time_s))
            };
            return (0..HALVINGS).find_map(|n| of_late(longest_s * 0.5_f64.powi(n))).or(Some(found));
        }
        if !is_of_the_sensor(effect) {
            return Some(found);
        }
        let [late, late_without] = both(longest_s);
        let late_rad = late.zip(late_without).map_or(0.0, |(with, without)| {
            // The first readings: both motions begin alike there.
            (with.readings_rad[0] - without.readings_rad[0]).abs()
        });
        Some(found.wandering(late_rad, longest_s, measured))
    };
    added.filter(|effect| !effect.is_base() && !problem.is_free_scale(effect)).filter_map(of).collect()
}

/// From a turning point, so long after the release, to the next on the same side; `None` if it comes to rest before.
fn period(parameters: &Parameters<f64>, measured: Measured, amplitude_rad: f64, time_s: f64) -> Option<Period> {
    let model = Model::new(parameters);
    let pendulum = parameters.pendulum;
    let small_s = 2.0 * std::f64::consts::PI * (pendulum.pivot_inertia_kg_m2() / pendulum.gravity_torque_nm()).sqrt();
    let step_s = small_s / STEPS;
    let mut state = model.release(amplitude_rad, 0.0);
    state.time_s = time_s;
    let mut sensor = match measured {
        Measured::Angle => model.sensor_at_rest(&state),
        Measured::Rate => model.rate_sensor_at_rest(&state),
    };
    let (energy_j, mut readings_rad, mut turns) = (model.energy_j(&state), Vec::new(), 0);
    for _ in 0..(3.0 * STEPS) as usize {
        let before = state;
        model.step(&mut state, step_s);
        readings_rad.push(match measured {
            Measured::Angle => model.read(&state, &mut sensor) - state.angle_rad,
            Measured::Rate => model.read_rate(&state, &mut sensor) - state.velocity_rad_s,
        });
        let (old, new) = (before.velocity_rad_s, state.velocity_rad_s);
        turns += usize::from(old * new < 0.0);
        if turns == 2 {
            let period_s = before.time_s - time_s + step_s * old / (old - new);
            return Some(Period { lost_j: energy_j - model.energy_j(&state), period_s, readings_rad });
        }
    }
    None
}

impl Evidence {
    /// The same of a friction that changes with time: so many times as much is lost so long after the release.
    fn ageing(self, times: f64, after_s: f64) -> Self {
        let at = angle(self.amplitude_rad);
        let words = format!(
            "at {at} rad amplitude it makes the pendulum lose {times:.2} times as much energy {after_s:.0} s after the release \
             as just behind it"
        );
        Self { words, ..self }
    }

    /// The same where its reading is moved so far at the end of the longest swing.
    fn wandering(self, late_rad: f64, longest_s: f64, measured: Measured) -> Self {
        if late_rad < WANDERS * self.reading_rad || late_rad < LEAST_READING * self.amplitude_rad {
            return self;
        }
        let words =
            format!("in {longest_s:.0} s it moves the reading by {:.1} {}", 1e3 * late_rad, measured.milli_unit());
        Self { reading_rad: late_rad, words, picture: "Measured minus modelled", ..self }
    }
}

/// Does an effect act on the reading, and on no motion?
fn is_of_the_sensor(effect: &Effect<f64>) -> bool {
    matches!(effect.action, Action::Sensor(_))
}

fn compared(effect: &Effect<f64>, measured: Measured, amplitude_rad: f64, with: &Period, without: &Period) -> Evidence {
    let loss_share = if with.lost_j > 0.0 { 1.0 - without.lost_j / with.lost_j } else { 0.0 };
    let period_share = with.period_s / without.period_s - 1.0;
    let apart = with.readings_rad.iter().zip(&without.readings_rad).map(|(a, b)| (a - b).abs());
    let reading_rad = if is_of_the_sensor(effect) { apart.fold(0.0, f64::max) } else { 0.0 };
    let at = format!("at {} rad amplitude", angle(amplitude_rad));
    let percent = |share: f64| format!("{:.2} %", 100.0 * share.abs());
    let is_of_loss = loss_share.abs() > LEAST_LOSS.max(LOSS_PER_PERIOD * period_share.abs());
    let (words, picture) = if reading_rad > LEAST_READING * amplitude_rad {
        let words = format!("{at} it moves the reading by up to {:.1} {}", 1e3 * reading_rad, measured.milli_unit());
        (words, "Residual against angle")
    } else if is_of_loss && loss_share > 0.0 {
        (
            format!("{at} it takes {:.0} % of the energy lost", 100.0 * loss_share),
            "Energy lost per path against amplitude",
        )
    } else if is_of_loss {
        let words = format!("{at} the pendulum loses {:.0} % less energy with it", -100.0 * loss_share);
        (words, "Energy lost per path against amplitude")
    } else if period_share.abs() > LEAST_PERIOD {
        let change = if period_share < 0.0 { "shorter" } else { "longer" };
        (format!("{at} it makes the period {} {change}", percent(period_share)), "Period against amplitude")
    } else {
        (format!("{at} it changes neither loss nor period visibly"), "Measured minus modelled")
    };
    Evidence { effect: effect.name, amplitude_rad, loss_share, period_share, reading_rad, words, picture }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;
    use crate::swing::Swing;

    fn of(name: &str, values: &[f64], viscous: f64) -> Evidence {
        of_swing(name, values, viscous, &[0.0, 0.1, 0.2])
    }

    fn of_swing(name: &str, values: &[f64], viscous: f64, times_s: &[f64]) -> Evidence {
        let mut parameters = Parameters::paper();
        parameters.set_friction(viscous, 0.0, 0.0, 0.0);
        parameters.set(Effect::<f64>::by_name(name).unwrap().id, values).unwrap();
        let swings = [Swing::new("wide", times_s, &[1.4, 1.3, 1.1], 1e-3)];
        let count = Tally::default();
        evidence(&problem_of(&swings, &parameters, &count), &parameters).remove(0)
    }

    #[test]
    fn a_drag_beside_viscous_friction_takes_its_share_of_the_energy() {
        // Over a small swing of speed v the losses are as (8/3π)·Cq·v to Mw; at 1 rad the swing is still nearly sine.
        let (viscous, drag) = (5e-5, 1e-5);
        let p = Parameters::paper().pendulum;
        let fastest = (2.0 * p.gravity_torque_nm() * (1.0 - 1.0_f64.cos()) / p.pivot_inertia_kg_m2()).sqrt();
        let ratio = 8.0 / (3.0 * std::f64::consts::PI) * drag * fastest / viscous;
        let found = of("quadratic-drag", &[drag], viscous);
        assert!((found.loss_share - ratio / (1.0 + ratio)).abs() < 0.03, "{found:?} for {ratio}");
        assert!(found.words.contains("of the energy lost") && found.picture.starts_with("Energy lost"), "{found:?}");
    }

    #[test]
    fn a_spring_shortens_the_period_and_a_gain_moves_the_reading() {
        let spring = of("torsional-spring", &[5e-3, 0.0], 1e-4);
        let stiffer = 5e-3 / Parameters::paper().pendulum.gravity_torque_nm();
        assert!((spring.period_share / (-0.5 * stiffer) - 1.0).abs() < 0.25, "{spring:?}");
        assert!(spring.words.contains("shorter") && spring.picture == "Period against amplitude", "{spring:?}");
        let gain = of("sensor-gain", &[0.02], 1e-4);
        assert!((gain.reading_rad - 0.02).abs() < 1e-3 && gain.words.contains("amplitude it moves"), "{gain:?}");
    }

    #[test]
    fn a_drag_is_one_of_the_loss_beside_a_sensor_that_lags_too() {
        // What a lag leaves behind depends on the speed, and this on the drag.
        let mut parameters = Parameters::paper();
        parameters.set_friction(5e-5, 0.0, 0.0, 0.0);
        parameters.set(Effect::<f64>::by_name("sensor-lag").unwrap().id, &[0.05]).unwrap();
        parameters.set(Effect::<f64>::by_name("quadratic-drag").unwrap().id, &[2e-4]).unwrap();
        let swings = [Swing::new("wide", &[0.0, 0.1, 0.2], &[1.4, 1.3, 1.1], 1e-3)];
        let count = Tally::default();
        let all = evidence(&problem_of(&swings, &parameters, &count), &parameters);
        let of = |name: &str| all.iter().find(|found| found.effect == name).unwrap();
        assert!(of("quadratic-drag").words.contains("of the energy lost"), "{all:?}");
        assert!(
            of("quadratic-drag").reading_rad == 0.0 && of("sensor-lag").words.contains("moves the reading"),
            "{all:?}"
        );
    }

    #[test]
    fn a_zero_that_wanders_is_told_by_what_it_comes_to() {
        let drift = of_swing("zero-drift", &[2e-3], 1e-4, &[0.0, 10.0, 20.0]);
        assert!((drift.reading_rad - 0.04).abs() < 1e-4 && drift.words.starts_with("in 20 s"), "{drift:?}");
    }

    #[test]
    fn friction_that_grows_is_told_by_what_it_comes_to() {
        let truth = |dry_nm: f64| {
            let mut parameters = Parameters::paper();
            parameters.set_friction(0.0, dry_nm, dry_nm, 0.0);
            parameters
        };
        // 3 mN·m that grow along a straight line: 4 after 100 s. A swing that loses more also becomes smaller.
        let mut grows = truth(3e-3);
        let effect = Effect::<f64>::by_name("general-drift").unwrap();
        grows.set(effect.id, &[1e-5, 0.0, 300.0, -1.0]).unwrap();
        let swings = [Swing::new("growing", &[0.0, 50.0, 100.0], &[1.4, 1.3, 1.1], 1e-4)];
        let count = Tally::default();
        let found = evidence(&problem_of(&swings, &grows, &count), &grows).remove(0);
        assert!(found.words.contains("lose 1.3") && found.words.contains("100 s after the release"), "{found:?}");
        assert!(found.picture.starts_with("Energy lost") && (0.2..0.3).contains(&found.loss_share), "{found:?}");
        // So strong in the end that no swing of this size is whole.
        grows.set(effect.id, &[3e-3, 0.0, 300.0, -1.0]).unwrap();
        let found = evidence(&problem_of(&swings, &grows, &count), &grows).remove(0);
        assert!(found.words.contains("times as much energy") && !found.words.contains("100 s after"), "{found:?}");
    }

    #[test]
    fn a_law_that_pushes_spares_energy_and_a_longer_period_is_called_so() {
        let effect = Effect::<f64>::by_name("quadratic-drag").unwrap();
        let period = |lost_j: f64, period_s: f64| Period { lost_j, period_s, readings_rad: vec![0.0] };
        let spares = compared(effect, Measured::Angle, 1.0, &period(4e-3, 1.0), &period(5e-3, 1.0));
        assert_eq!(spares.words, "at 1.00 rad amplitude the pendulum loses 25 % less energy with it");
        let slows = compared(effect, Measured::Angle, 1.0, &period(5e-3, 1.01), &period(5e-3, 1.0));
        assert_eq!(slows.words, "at 1.00 rad amplitude it makes the period 1.00 % longer");
        let nothing = compared(effect, Measured::Angle, 1.0, &period(5e-3, 1.0), &period(5e-3, 1.0));
        assert!(nothing.words.ends_with("changes neither loss nor period visibly"), "{}", nothing.words);
    }

    #[test]
    fn a_bias_of_a_gyroscope_is_told_as_a_rate() {
        let mut parameters = Parameters::paper();
        parameters.set(Effect::<f64>::by_name("zero-drift").unwrap().id, &[2e-3]).unwrap();
        let times_s: Vec<f64> = (0..=400).map(|i| f64::from(i) * 0.05).collect();
        let rates: Vec<f64> = times_s.iter().map(|time_s| 5.0 * (7.0 * time_s).sin()).collect();
        let swings = [Swing::of("gyroscope", Measured::Rate, &times_s, &rates, 1e-3)];
        let count = Tally::default();
        let found = evidence(&problem_of(&swings, &parameters, &count), &parameters).remove(0);
        assert_eq!(found.words, "in 20 s it moves the reading by 40.0 mrad/s");
    }
}
