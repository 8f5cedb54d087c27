//! Parameters, settings and counters from and to the rig.

use super::error::MODEL;
use super::received::judged;
use super::{LinkError, Session};
use crate::error::Failure;
use crate::formula;
use crate::rigfile::{Quantity, RigFile, Source};
use shared::curve::Curve;
use shared::effect::{Action, CURVE_ID, CURVE_NAME, CUSTOM_FORMULA_ID};
use shared::formula::Formula;
use shared::parameters::Parameters;
use shared::potentiometer::Potentiometer;
use shared::sensor::Sensor;
use shared::wire::{Answer, Chip, Clock, Command, PROTOCOL, Refusal, SUSPECTS, Settings, Statistics, Suspects};

/// The sensor among the settings, as [`Refusal::Setting`] counts them.
const SENSOR: u8 = 3;

impl Session {
    /// The parameters in use.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn parameters(&mut self) -> Result<Parameters<f32>, LinkError> {
        match self.ask(&Command::GetParameters)? {
            Answer::Parameters(numbers) => self.with_formula(numbers.into()).and_then(|found| self.with_curve(found)),
            _ => Err(LinkError::WrongAnswer { command: "give its parameters" }),
        }
    }

    /// The custom effect's law, if there is such an effect.
    fn with_formula(&mut self, mut parameters: Parameters<f32>) -> Result<Parameters<f32>, LinkError> {
        if parameters.values(CUSTOM_FORMULA_ID).is_some() {
            let held = self.exchange_formula(&[])?;
            parameters.formula = Formula::from_bytes(&held);
            let understood = formula::effect_of(&parameters, CUSTOM_FORMULA_ID).map(|effect| effect.action);
            let same = matches!(understood, Some(Action::Formula(law)) if Some(law) == parameters.formula.as_ref());
            if !same {
                return Err(LinkError::UnknownFormula);
            }
        }
        Ok(parameters)
    }

    /// The knots of the friction curve, if there is one.
    fn with_curve(&mut self, mut parameters: Parameters<f32>) -> Result<Parameters<f32>, LinkError> {
        if parameters.values(CURVE_ID).is_some() {
            parameters.curve = Curve::through(&self.exchange_curve(&[])?);
        }
        Ok(parameters)
    }

    /// The settings in use.
    ///
    /// # Errors
    /// As [`Session::ask`]; settings that can't be computed with.
    pub fn settings(&mut self) -> Result<Settings, LinkError> {
        match self.ask(&Command::GetSettings)? {
            Answer::Settings(settings) => judged(settings),
            _ => Err(LinkError::WrongAnswer { command: "give its settings" }),
        }
    }

    /// The model that the rig reports, as a file.
    ///
    /// # Errors
    /// As [`Session::ask`], or parameters that this program does not know.
    pub fn model_file(&mut self) -> Result<RigFile, Failure> {
        let parameters = self.parameters()?;
        let sensor = self.settings()?.sensor;
        let source = Source::read_from(&self.rig().name);
        let mut file = RigFile::of_rig(&parameters, &source)?;
        file.set_sensor(sensor);
        Ok(file)
    }

    /// The counters since the last reset.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn statistics(&mut self) -> Result<Statistics, LinkError> {
        match self.ask(&Command::Statistics)? {
            Answer::Statistics(statistics) => Ok(statistics),
            _ => Err(LinkError::WrongAnswer { command: "give its statistics" }),
        }
    }

    /// What the rig says of its chip; `None` from firmware that does not know the question.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn chip(&mut self) -> Result<Option<Chip>, LinkError> {
        match self.ask(&Command::Chip) {
            Ok(Answer::Chip(chip)) => Ok(Some(chip)),
            Ok(_) => Err(LinkError::WrongAnswer { command: "describe its chip" }),
            Err(LinkError::NoAnswer { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// What the rig's samples are timed by; unknown where its firmware does not say.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn clock(&mut self) -> Result<Clock, LinkError> {
        Ok(self.chip()?.map_or(Clock::Unknown, |chip| chip.clock))
    }

    /// What the rig itself found missing in its model; `None` from firmware that does not look, or says it in another
    /// version.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn suspects(&mut self) -> Result<Option<Suspects>, LinkError> {
        match self.ask(&Command::Suspects) {
            Ok(Answer::Suspects(suspects)) => Ok(Some(suspects).filter(|suspects| suspects.version == SUSPECTS)),
            Ok(_) => Err(LinkError::WrongAnswer { command: "say what it found missing" }),
            Err(LinkError::NoAnswer { .. } | LinkError::Refused { refusal: Refusal::NotHere, .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Samples at this rate from now on; gives the rate that the rig makes of it, and the settings before.
    ///
    /// # Errors
    /// As [`Session::ask`].
    pub fn sample_at(&mut self, rate_hz: f32) -> Result<(f32, Settings), LinkError> {
        let before = self.settings()?;
        self.tell(&Command::SetSettings(before.at_rate(rate_hz)))?;
        Ok((self.settings()?.rate_hz, before))
    }

    /// Sets the parameters, saves them to flash, loads them from there and compares. What the rig had is kept on this
    /// computer, for [`Session::previous`]; if it can't be, that is given, for a person.
    ///
    /// # Errors
    /// A refusal, no answer, or a value that came back different.
    pub fn push(&mut self, parameters: &Parameters<f64>) -> Result<Option<String>, LinkError> {
        let sent = parameters.map(|value| value as f32);
        let lost = self.keep_before(&sent)?;
        if let Some(formula) = &sent.formula {
            // First a question: firmware that knows no formulas can say so.
            self.exchange_formula(&[])?;
            self.exchange_formula(formula.bytes())?;
        }
        if let Some(curve) = &sent.curve {
            self.exchange_curve(&curve.knots())?;
        }
        self.tell(&Command::SetParameters((&sent).into()))?;
        self.save(MODEL)?;
        self.tell(&Command::Load)?;
        let got = self.parameters()?;
        compare(&sent, &got).map(|()| lost)
    }

    /// Keeps what is in use, which is news to flash.
    fn save(&mut self, what: &'static str) -> Result<(), LinkError> {
        self.tell(&Command::Save).map_err(|error| match error {
            LinkError::Refused { refusal, .. } => LinkError::NotSaved { what, refusal },
            error => error,
        })
    }

    /// Uses this sensor with its calibration from now on. A zero that the rig alone can know stays.
    ///
    /// # Errors
    /// A refusal, no answer, or firmware that does not know the sensor.
    pub fn use_sensor(&mut self, sensor: &Sensor) -> Result<Sensor, LinkError> {
        let before = self.settings()?;
        let sensor = sensor.taken_over(&before.sensor);
        match self.tell(&Command::SetSettings(before.with_sensor(sensor))) {
            // Firmware from before there were other sensors cannot even read the command.
            Err(LinkError::NoAnswer { .. }) if sensor.protocol() != PROTOCOL => {
                Err(LinkError::OldSensors { firmware: self.firmware(), sensor: sensor.name() })
            }
            Err(error @ LinkError::Refused { refusal: Refusal::Setting { index: SENSOR }, .. }) => {
                Err(other_scale(&sensor, &before.sensor).unwrap_or(error))
            }
            told => told.map(|()| sensor),
        }
    }

    /// Sets sensor and calibration, the zero included, saves them to flash with everything else in use, loads them from
    /// there and compares.
    ///
    /// # Errors
    /// A refusal, no answer, or a value that came back different.
    pub fn calibrate(&mut self, sensor: &Sensor) -> Result<(), LinkError> {
        self.use_sensor(sensor)?;
        let settings = self.settings()?.with_sensor(*sensor);
        self.tell(&Command::SetSettings(settings))?;
        self.save("calibration")?;
        self.tell(&Command::Load)?;
        let got = self.settings()?.sensor;
        let numbers = |of: &Sensor| [of.line().zero_code, of.line().radian_per_code];
        let names = ["the zero code", "the angle per code"];
        let pairs = names.into_iter().zip(numbers(sensor)).zip(numbers(&got));
        match pairs.into_iter().find(|((_, sent), got)| sent != got) {
            None => Ok(()),
            Some(((what, sent), got)) => Err(LinkError::NotKept { what: what.to_owned(), sent, got }),
        }
    }
}

/// The refusal of a potentiometer's calibration because the rig's converter has other codes. Its angles are shares of the
/// whole, whatever the converter calls that.
fn other_scale(wanted: &Sensor, rigs: &Sensor) -> Option<LinkError> {
    let (Sensor::Potentiometer(made_for), Sensor::Potentiometer(rigs)) = (*wanted, rigs) else { return None };
    let ratio = f64::from(rigs.full_scale) / f64::from(made_for.full_scale);
    let scaled = Potentiometer {
        zero_code: (f64::from(made_for.zero_code) * ratio) as f32,
        radian_per_code: (f64::from(made_for.radian_per_code) / ratio) as f32,
        full_scale: rigs.full_scale,
    };
    (made_for.full_scale != rigs.full_scale).then_some(LinkError::OtherScale { made_for, scaled })
}

/// Equal to the last bit, or the first value that is not.
fn compare(sent: &Parameters<f32>, got: &Parameters<f32>) -> Result<(), LinkError> {
    if sent == got {
        return Ok(());
    }
    if sent.formula != got.formula {
        return Err(LinkError::UnknownFormula);
    }
    if let Some([sent, got]) = different_knot(sent, got) {
        return Err(LinkError::NotKept { what: format!("a knot of {CURVE_NAME}"), sent, got });
    }
    let (sent, got) = (sent.map(f64::from), got.map(f64::from));
    let quantities = [Quantity::all(&sent), Quantity::all(&got)].concat();
    let value = |quantity: Quantity, of| quantity.get(of).map_or(f32::NAN, |value| value as f32);
    let different = quantities.into_iter().find(|quantity| quantity.get(&sent) != quantity.get(&got));
    match different {
        None => Ok(()),
        Some(quantity) => Err(LinkError::NotKept {
            what: quantity.symbol().to_owned(),
            sent: value(quantity, &sent),
            got: value(quantity, &got),
        }),
    }
}

/// The first number of a friction curve that came back different.
fn different_knot(sent: &Parameters<f32>, got: &Parameters<f32>) -> Option<[f32; 2]> {
    let [sent, got] = [sent, got].map(|of| of.curve.as_ref().map(Curve::knots).unwrap_or_default().concat());
    let pair = |i| [&sent, &got].map(|numbers: &Vec<f32>| numbers.get(i).copied().unwrap_or(f32::NAN));
    (0..sent.len().max(got.len())).map(pair).find(|[sent, got]| sent != got)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::changed;
    use shared::wire::{Frame, Hello, catalogue_hash};

    #[test]
    fn a_rig_with_settings_that_nobody_can_compute_with_is_left_alone() {
        let without_rate = |frame| match frame {
            Frame::Answer(number, Answer::Settings(settings)) => {
                vec![Frame::Answer(number, Answer::Settings(Settings { rate_hz: 0.0, ..settings }))]
            }
            frame => vec![frame],
        };
        let mut session = changed::session(without_rate).unwrap();
        let error = session.settings().unwrap_err();
        assert!(matches!(error, LinkError::BadSetting { what: "sampling rate", .. }), "{error}");
    }

    #[test]
    fn a_rig_may_keep_to_itself_which_effects_it_knows() {
        let knows = |catalogue: u32| {
            let greeting = move |frame| match frame {
                Frame::Hello(hello) => vec![Frame::Hello(Hello { catalogue, ..hello })],
                frame => vec![frame],
            };
            changed::session(greeting).unwrap().knows_the_same_effects()
        };
        assert_eq!([0, catalogue_hash(), 12_345].map(knows), [true, true, false]);
    }

    #[test]
    fn a_model_that_is_not_saved_is_in_use_and_that_is_said() {
        let mut n_done = 0;
        // The first is that the parameters are in use.
        let worn_out = move |frame| match frame {
            Frame::Answer(number, Answer::Done) => {
                n_done += 1;
                let answer = if n_done == 2 { Answer::Refused(Refusal::Flash) } else { Answer::Done };
                vec![Frame::Answer(number, answer)]
            }
            frame => vec![frame],
        };
        let error = changed::session(worn_out).unwrap().push(&Parameters::paper()).unwrap_err();
        assert!(error.to_string().starts_with("the rig uses the new model until its power goes"), "{error}");
        let next = error.next_step();
        assert!(next.contains("flash is worn out") && next.contains("host push"), "{next}");
    }

    #[test]
    fn a_calibration_of_another_converter_is_refused_with_what_it_comes_to_on_this_one() {
        let mut session = changed::session(|frame| vec![frame]).unwrap();
        let foreign = Potentiometer { zero_code: 8000.0, radian_per_code: 0.5e-3, full_scale: 4 * 4095 };
        let error = session.use_sensor(&foreign.into()).unwrap_err();
        assert!(error.to_string().contains("0 … 16380, and the rig's reads 0 … 4095"), "{error}");
        let next = error.next_step();
        for word in ["host calibrate", "zero_code = 2000,", "radians_per_code = 0.002 ", "full_scale = 4095 "] {
            assert!(next.contains(word), "{word}: {next}");
        }
        let told = Potentiometer { zero_code: 2000.0, radian_per_code: 0.002, full_scale: 4095 };
        assert_eq!(session.use_sensor(&told.into()).unwrap(), told.into());
        // What is wrong by itself is not a matter of scale.
        let nothing = Potentiometer { radian_per_code: 0.0, ..told };
        assert!(matches!(session.use_sensor(&nothing.into()), Err(LinkError::Refused { .. })));
    }

    #[test]
    fn a_value_that_came_back_different_is_named() {
        let sent = Parameters::paper().map(|value| value as f32);
        assert!(compare(&sent, &sent).is_ok());
        let mut got = sent.clone();
        got.set(2, &[1.0]).unwrap();
        let error = compare(&sent, &got).unwrap_err().to_string();
        assert!(error.starts_with("Mc came back"), "{error}");
    }
}
