//! A swing of a model as a sensor would record it, with noise and converter.

use crate::error::Failure;
use crate::formula::{self, effect_of};
use crate::number::significant;
use crate::random::Noise;
use crate::recording::{Calibration, Header, MOST_SAMPLES, sensor_name};
use crate::rigfile::Quantity;
use crate::sim::Scenario;
use crate::swing::step::longest_step_of;
use shared::effect::{CUSTOM_FORMULA_ID, Effect};
use shared::model::Model;
use shared::parameters::Parameters;
use shared::sensor::Sensor;

/// The pendulum is held still at the start angle for so long, s.
const HELD_S: f64 = 0.5;

/// Rates beyond this make files nobody wants.
const HIGHEST_RATE_HZ: f64 = 100_000.0;

/// Longer swings neither.
const LONGEST_S: f64 = 36_000.0;

/// Half a turn, as it is typed with a few digits, rad.
const FARTHEST_RELEASE_RAD: f64 = 3.15;

/// What is simulated.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The model.
    pub parameters: Parameters<f64>,
    /// Release angle, rad.
    pub start_rad: f64,
    /// Length of the swing, s.
    pub seconds: f64,
    /// Standard deviation of white noise on the angle, rad.
    pub noise_rad: f64,
    /// Equal seeds give equal noise.
    pub seed: u64,
    /// Samples per second.
    pub rate_hz: f64,
    /// The angle goes through this one, if through any.
    pub converter: Option<Sensor>,
}

/// How a simulated swing ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Samples, the held ones included.
    pub n_samples: usize,
    /// The model's last angle, rad.
    pub final_angle_rad: f64,
    /// Does it rest there?
    pub rests: bool,
}

impl Simulation {
    /// Hands every sample on: its time in s, its angle in rad, its code if there is a converter.
    ///
    /// # Errors
    /// Those of whoever takes them.
    pub fn run<E>(&self, mut take: impl FnMut(f64, f64, Option<u16>) -> Result<(), E>) -> Result<End, E> {
        let model = Model::new(&self.parameters);
        let mut state = model.release(self.start_rad, 0.0);
        let mut sensor = model.sensor_at_rest(&state);
        let mut noise = Noise::new(self.seed);
        // A sample may be too long for a step.
        let sample_s = 1.0 / self.rate_hz;
        let n_steps = (sample_s / longest_step_of(&self.parameters.pendulum) * (1.0 - 1e-9)).ceil().max(1.0);
        let n_held = (HELD_S * self.rate_hz).round() as usize;
        let n_samples = n_held + (self.seconds * self.rate_hz).round() as usize + 1;
        for sample_idx in 0..n_samples {
            if sample_idx > n_held {
                (0..n_steps as usize).for_each(|_| model.step(&mut state, sample_s / n_steps));
            }
            let angle_rad = model.read(&state, &mut sensor) + self.noise_rad * noise.normal();
            let converted = |sensor| convert(&sensor, angle_rad);
            let (angle_rad, code) = self.converter.map_or((angle_rad, None), converted);
            take(sample_idx as f64 / self.rate_hz, angle_rad, code)?;
        }
        Ok(End { n_samples, final_angle_rad: state.angle_rad, rests: state.contact.is_resting() })
    }

    /// How it was taken.
    pub fn header(&self) -> Header {
        let calibration = self.converter.as_ref().map(Calibration::of);
        let sensor = self.converter.as_ref().and_then(sensor_name);
        let comment = format!("simulated, noise {} rad, seed {}", self.noise_rad, self.seed);
        Header { rate_hz: Some(self.rate_hz), sensor, calibration, comment: Some(comment), ..Header::default() }
    }
}

/// Refuses what makes files nobody wants.
///
/// # Errors
/// Too long, too many samples a second, or more in all than are read again.
pub fn check_size(seconds: f64, rate_hz: f64) -> Result<(), Failure> {
    let n_samples = (HELD_S + seconds) * rate_hz + 1.0;
    if rate_hz > HIGHEST_RATE_HZ || seconds > LONGEST_S || n_samples > MOST_SAMPLES as f64 {
        let what = format!("{seconds} s at {rate_hz} Hz is too much");
        let most = format!("stay within {LONGEST_S} s, {HIGHEST_RATE_HZ} Hz and {MOST_SAMPLES} samples");
        return Err(Failure::wrong_use(what).next(most));
    }
    Ok(())
}

/// Refuses a release from beyond half a turn: whoever types 90 means degrees.
///
/// # Errors
/// Beyond half a turn, with the same in radians.
pub fn check_start(start_rad: f64) -> Result<(), Failure> {
    if start_rad.abs() <= FARTHEST_RELEASE_RAD {
        return Ok(());
    }
    let what = format!("the release at {start_rad} rad is more than half a turn from where the pendulum hangs");
    let meant_rad = significant(start_rad.to_radians(), 4);
    Err(Failure::wrong_use(what).next(format!("give radians: {start_rad} degrees are {meant_rad} rad")))
}

/// A swing that no recording can hold.
pub fn runs_away(time_s: f64, angle_rad: f64) -> Failure {
    let what = format!("the swing runs away: at {time_s:.3} s its angle is {angle_rad:e} rad");
    Failure::failed(what).next("an effect of the model feeds energy in without end; choose smaller values")
}

/// The scenario of this name.
///
/// # Errors
/// There is none.
pub fn scenario(name: &str) -> Result<&'static Scenario, Failure> {
    Scenario::by_name(name).ok_or_else(|| {
        let names: Vec<&str> = Scenario::ALL.iter().map(|scenario| scenario.name).collect();
        Failure::wrong_use(format!("there is no scenario called {name}"))
            .next(format!("choose one of {}", names.join(", ")))
    })
}

/// A number that is set, its name a symbol such as `Cq`.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// The symbol.
    pub name: String,
    /// In its unit.
    pub value: f64,
}

impl Assignment {
    /// The number of a model that is meant; those of a formula come first, and of several with this symbol the one whose
    /// effect the model has.
    fn quantity(&self, model: &Parameters<f64>) -> Result<Quantity, String> {
        let custom = effect_of(model, CUSTOM_FORMULA_ID);
        if let Some(typed) = custom.and_then(|effect| Quantity::by_formula_name(&self.name, effect)) {
            return Ok(typed);
        }
        let present = Quantity::all_of_name(&self.name).into_iter().filter(|quantity| quantity.get(model).is_some());
        if let [one] = present.collect::<Vec<_>>()[..] { Ok(one) } else { quantity(&self.name) }
    }
}

/// The number of this name.
///
/// # Errors
/// There is none, and the known ones are told; or several effects use the symbol.
pub fn quantity(name: &str) -> Result<Quantity, String> {
    let name = name.trim();
    match Quantity::all_of_name(name)[..] {
        [one] => Ok(one),
        [] => Err(format!("there is no parameter {name}; known are {}", Quantity::symbols())),
        ref several => {
            let [owners, names] = [|it: &Quantity| it.owner().to_owned(), |it: &Quantity| it.full_name()]
                .map(|told| several.iter().map(told).collect::<Vec<String>>());
            Err(format!("{name} is a number of {}; write {}", owners.join(" and of "), names.join(" or ")))
        }
    }
}

/// A model with a typed effect in it and some numbers set; their effects are added if need be.
///
/// # Errors
/// A name that is no parameter's, or a value outside its range.
pub fn with(
    parameters: &Parameters<f64>,
    effect: Option<&'static Effect<f64>>,
    assignments: &[Assignment],
) -> Result<Parameters<f64>, Failure> {
    let refused = |error| Failure::wrong_use(error).next("give --with a value within the range");
    let mut parameters = parameters.clone();
    if let Some(effect) = effect {
        let start: Vec<f64> = effect.parameters.iter().map(|parameter| parameter.start).collect();
        formula::add(&mut parameters, effect, &start).map_err(refused)?;
    }
    for assignment in assignments {
        let quantity = assignment
            .quantity(&parameters)
            .map_err(|error| Failure::wrong_use(error).next("name one of them in --with"))?;
        quantity.add_effect(&mut parameters).map_err(refused)?;
        quantity.set(&mut parameters, assignment.value);
    }
    parameters.check().map_err(refused)?;
    Ok(parameters)
}

/// Through the converter and back, as the rig does it.
fn convert(sensor: &Sensor, angle_rad: f64) -> (f64, Option<u16>) {
    let Calibration { zero_code: zero, radians_per_code: step } = Calibration::of(sensor);
    let exact = (angle_rad / step + zero).round();
    match sensor.span() {
        None => {
            let code = exact.clamp(0.0, f64::from(sensor.full_scale())) as u16;
            ((f64::from(code) - zero) * step, Some(code))
        }
        Some(span) => ((exact - zero) * step, Some(exact.rem_euclid(f64::from(span)) as u16)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_does_not_depend_on_how_often_it_is_sampled() {
        let end_rad = |rate_hz: f64| {
            let (parameters, converter) = (Parameters::paper(), None);
            let swing =
                Simulation { parameters, start_rad: 1.5, seconds: 10.0, noise_rad: 0.0, seed: 1, rate_hz, converter };
            swing.run(|_, _, _| Ok::<(), ()>(())).unwrap().final_angle_rad
        };
        for rate_hz in [10.0, 30.0, 100.0] {
            let off_rad = end_rad(rate_hz) - end_rad(1000.0);
            assert!(off_rad.abs() < 1e-4, "{rate_hz} Hz: {off_rad}");
        }
    }

    #[test]
    fn a_reading_is_the_nearest_code_and_the_file_says_how_it_was_made() {
        let sensor = Sensor::Potentiometer(shared::sensor::Potentiometer::nominal(4095));
        let converter = Some(sensor);
        let (parameters, start_rad, seconds) = (Parameters::paper(), 0.5, 1.0);
        let swing = Simulation { parameters, start_rad, seconds, noise_rad: 0.002, seed: 7, rate_hz: 100.0, converter };
        let Calibration { zero_code, radians_per_code } = Calibration::of(&sensor);
        for k in 0..20 {
            let angle_rad = 0.013 * f64::from(k);
            let (read_rad, code) = convert(&sensor, angle_rad);
            assert!((read_rad - angle_rad).abs() <= 0.5 * radians_per_code.abs() + 1e-12, "{angle_rad}");
            assert!((f64::from(code.unwrap()) - zero_code - read_rad / radians_per_code).abs() < 1e-9);
        }
        assert_eq!(swing.header().comment.as_deref(), Some("simulated, noise 0.002 rad, seed 7"));
        let end = swing.run(|_, _, _| Ok::<(), ()>(())).unwrap();
        assert!(!end.rests && end.n_samples == 151, "{end:?}");
        let end = Simulation { seconds: 60.0, ..swing }.run(|_, _, _| Ok::<(), ()>(())).unwrap();
        assert!(end.rests, "{end:?}");
    }

    #[test]
    fn a_symbol_of_several_effects_means_the_one_that_the_model_has() {
        let with = |assignments: &[&str]| {
            let assignments: Vec<Assignment> = assignments.iter().map(|text| text.parse().unwrap()).collect();
            with(&Parameters::paper(), None, &assignments)
        };
        let refused = with(&["dM=3e-4"]).unwrap_err();
        let told = "dM is a number of stribeck and of asymmetric-coulomb; write stribeck.dM or asymmetric-coulomb.dM";
        assert_eq!(refused.what(), told);
        let id = Effect::<f64>::by_name("stribeck").unwrap().id;
        assert_eq!(with(&["ws=0.3", "dM=3e-4"]).unwrap().values(id), Some(&[3e-4, 0.3][..]));
        assert_eq!(with(&["stribeck.dM=3e-4"]).unwrap().values(id).map(|values| values[0]), Some(3e-4));
    }

    #[test]
    fn what_makes_files_that_nobody_wants_is_refused() {
        assert!(check_size(LONGEST_S, 400.0).is_ok() && check_size(100.0, HIGHEST_RATE_HZ).is_ok());
        assert!(check_size(LONGEST_S, HIGHEST_RATE_HZ).is_err() && check_size(172.9, HIGHEST_RATE_HZ).is_err());
        assert!(check_size(LONGEST_S + 0.5, 100.0).is_err());
        let refused = check_size(10.0, 200_000.0).unwrap_err();
        assert_eq!(refused.what(), "10 s at 200000 Hz is too much");
    }
}
