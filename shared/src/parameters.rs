//! The numbers of a model: the pendulum and a bounded list of (effect id, values), as they stand in flash, in
//! messages and in `rig.toml`.

use crate::curve::Curve;
use crate::effect::{Action, CURVE_ID, CURVE_NAME, CUSTOM_FORMULA_ID, CUSTOM_FORMULA_NAME, Effect, MAX_VALUES};
use crate::formula::Formula;
use crate::motion::Pendulum;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The most effects a model may have, the base effects included.
pub const MAX_EFFECTS: usize = 10;

/// How many of them may be torques with a memory: each takes room in every state of the pendulum.
pub const MAX_MEMORIES: usize = 2;

/// How many of them may act on the sensor.
pub const MAX_SENSORS: usize = 5;

/// A value this many times above the usual range of its parameter is refused as a mistake of units.
pub const ABSURD: f64 = 1000.0;

/// In SI units no pendulum's mass, length, inertia or gravity is larger, nor smaller than its inverse: beyond, products
/// of them leave `f32`.
const ENORMOUS: f64 = 1e6;

/// One effect's numbers, in the order of its parameter list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectValues<R> {
    /// The effect's id.
    pub id: u16,
    /// As many as the effect has parameters.
    pub values: Vec<R, MAX_VALUES>,
}

/// The pendulum and everything that acts on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters<R> {
    /// Geometry and inertia.
    pub pendulum: Pendulum<R>,
    /// Present effects; one that is not listed does not act.
    pub effects: Vec<EffectValues<R>, MAX_EFFECTS>,
    /// The law of the effect [`CUSTOM_FORMULA_ID`]; stored and sent on its own.
    #[serde(skip)]
    pub formula: Option<Formula>,
    /// The knots of the effect [`CURVE_ID`]; stored and sent on their own.
    #[serde(skip)]
    pub curve: Option<Curve<R>>,
}

/// What is wrong with a set of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ParameterError {
    /// Mass, length or gravity not positive, inertia negative, or one of them not a number or beyond all that is
    /// built: which, by position.
    Pendulum {
        /// 0 mass, 1 length, 2 inertia, 3 gravity.
        index: u8,
    },
    /// This firmware or program has no effect with the id.
    UnknownEffect {
        /// The unknown id.
        id: u16,
    },
    /// An effect came with too few or too many values.
    WrongCount {
        /// The effect.
        id: u16,
        /// How many it has.
        expected: u8,
        /// How many came.
        got: u8,
    },
    /// A value is not a number or outside its range.
    OutOfRange {
        /// The effect.
        id: u16,
        /// Which of its parameters.
        index: u8,
    },
    /// An effect is listed twice.
    Twice {
        /// The effect.
        id: u16,
    },
    /// More effects than [`MAX_EFFECTS`].
    TooMany,
    /// More effects that remember something than there is memory for.
    NoRoom {
        /// The first that has no place.
        id: u16,
        /// How many of its kind have one.
        limit: u8,
    },
    /// Coulomb or viscous friction beside a friction curve, which stands in their place.
    BesideCurve {
        /// The effect that must be zero or absent.
        id: u16,
    },
}

impl core::fmt::Display for ParameterError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let name = |id| match id {
            CUSTOM_FORMULA_ID => CUSTOM_FORMULA_NAME,
            CURVE_ID => CURVE_NAME,
            _ => Effect::<f64>::by_id(id).map_or("?", |effect| effect.name),
        };
        match *self {
            Self::Pendulum { index } => {
                let what = ["mass", "length", "inertia", "gravity"].get(usize::from(index)).copied().unwrap_or("?");
                let low = if what == "inertia" { "0" } else { "1e-6" };
                write!(f, "the pendulum's {what} is not a number from {low} to 1e6 (SI units)")
            }
            Self::UnknownEffect { id: CUSTOM_FORMULA_ID } => {
                write!(f, "there are values of a custom formula, but no formula")
            }
            Self::UnknownEffect { id: CURVE_ID } => write!(f, "there is an effect {CURVE_NAME}, but no curve"),
            Self::UnknownEffect { id } => write!(f, "there is no effect with the id {id} here; is the firmware older?"),
            Self::WrongCount { id, expected, got } => {
                write!(f, "effect {} takes {expected} values, not {got}", name(id))
            }
            Self::OutOfRange { id: CURVE_ID, index } => {
                write!(f, "torque {} of {CURVE_NAME} is not a number from 0 to 1e6 N·m", index + 1)
            }
            Self::OutOfRange { id, index } => {
                let parameter = Effect::<f64>::by_id(id).and_then(|effect| effect.parameters.get(usize::from(index)));
                match parameter {
                    Some(p) => {
                        write!(f, "{} of effect {} is outside {} … {} {}", p.symbol, name(id), p.low, p.high, p.unit)
                    }
                    None => write!(f, "a value of effect {} is outside its range", name(id)),
                }
            }
            Self::BesideCurve { id } => {
                write!(f, "{CURVE_NAME} stands in place of {}: set that to 0, or take the curve out", name(id))
            }
            Self::Twice { id } => write!(f, "effect {} is listed twice", name(id)),
            Self::TooMany => write!(f, "a model has at most {MAX_EFFECTS} effects"),
            Self::NoRoom { id, limit } => {
                let (name, kind) = (name(id), Kind::of(id).map_or("of its kind", Kind::words));
                write!(
                    f,
                    "there is no room for effect {name}: a model has at most {limit} effects {kind}; take one out"
                )
            }
        }
    }
}

impl core::error::Error for ParameterError {}

impl<R: Copy> Parameters<R> {
    /// A pendulum on which nothing acts but gravity.
    pub fn frictionless(pendulum: Pendulum<R>) -> Self {
        Self { pendulum, effects: Vec::new(), formula: None, curve: None }
    }

    /// The values of an effect, if it is present.
    pub fn values(&self, id: u16) -> Option<&[R]> {
        self.effects.iter().find(|effect| effect.id == id).map(|effect| effect.values.as_slice())
    }

    /// Sets an effect's values, adding it if absent.
    pub fn set(&mut self, id: u16, values: &[R]) -> Result<(), ParameterError> {
        let too_long = ParameterError::WrongCount { id, expected: MAX_VALUES as u8, got: values.len().min(255) as u8 };
        let values = Vec::from_slice(values).map_err(|_| too_long)?;
        match self.effects.iter_mut().find(|effect| effect.id == id) {
            Some(effect) => effect.values = values,
            None => {
                let ids = self.effects.iter().map(|effect| effect.id).chain([id]);
                check_room(ids.map(|id| (id, Kind::of(id))))?;
                self.effects.push(EffectValues { id, values }).map_err(|_| ParameterError::TooMany)?;
            }
        }
        Ok(())
    }

    /// Sets the law of the custom effect and its values.
    pub fn set_formula(&mut self, formula: &Formula, values: &[R]) -> Result<(), ParameterError> {
        self.set(CUSTOM_FORMULA_ID, values)?;
        self.formula = Some(formula.clone());
        Ok(())
    }

    /// Sets the friction curve; Coulomb and viscous friction must be zero beside it.
    pub fn set_curve(&mut self, curve: &Curve<R>) -> Result<(), ParameterError> {
        self.set(CURVE_ID, &[])?;
        self.curve = Some(curve.clone());
        Ok(())
    }

    /// Takes an effect out.
    pub fn remove(&mut self, id: u16) {
        self.effects.retain(|effect| effect.id != id);
        if id == CUSTOM_FORMULA_ID {
            self.formula = None;
        }
        if id == CURVE_ID {
            self.curve = None;
        }
    }

    /// The same numbers in another type.
    pub fn map<S: Copy>(&self, convert: impl Fn(R) -> S) -> Parameters<S> {
        let p = &self.pendulum;
        let pendulum = Pendulum {
            mass_kg: convert(p.mass_kg),
            length_m: convert(p.length_m),
            inertia_kg_m2: convert(p.inertia_kg_m2),
            gravity_m_s2: convert(p.gravity_m_s2),
        };
        let convert_effect = |effect: &EffectValues<R>| EffectValues {
            id: effect.id,
            values: effect.values.iter().map(|value| convert(*value)).collect(),
        };
        let effects = self.effects.iter().map(convert_effect).collect();
        let curve = self.curve.as_ref().map(|curve| curve.map(&convert));
        Parameters { pendulum, effects, formula: self.formula.clone(), curve }
    }
}

impl<R: Copy + Into<f64>> Parameters<R> {
    /// Checks everything that a model relies on; behind this point nothing can fail.
    pub fn check(&self) -> Result<(), ParameterError> {
        self.check_pendulum()?;
        for (position, effect) in self.effects.iter().enumerate() {
            if self.effects[..position].iter().any(|earlier| earlier.id == effect.id) {
                return Err(ParameterError::Twice { id: effect.id });
            }
            match effect.id {
                CUSTOM_FORMULA_ID => self.check_formula(effect)?,
                CURVE_ID => self.check_curve(effect)?,
                _ => check_effect(effect)?,
            }
        }
        check_room(self.effects.iter().map(|effect| (effect.id, Kind::of(effect.id))))
    }

    /// Its ranges are the business of whoever typed it; a number it has to be.
    fn check_formula(&self, effect: &EffectValues<R>) -> Result<(), ParameterError> {
        let id = effect.id;
        let formula = self.formula.as_ref().ok_or(ParameterError::UnknownEffect { id })?;
        check_count(id, formula.n_parameters(), effect.values.len())?;
        let not_finite = |value: &R| !(*value).into().is_finite();
        match effect.values.iter().position(not_finite) {
            Some(index) => Err(ParameterError::OutOfRange { id, index: index as u8 }),
            None => Ok(()),
        }
    }

    /// Torques that are none, and no friction that the curve replaces.
    fn check_curve(&self, effect: &EffectValues<R>) -> Result<(), ParameterError> {
        let id = effect.id;
        let curve = self.curve.as_ref().ok_or(ParameterError::UnknownEffect { id })?;
        check_count(id, 0, effect.values.len())?;
        let acts = |id: u16| self.values(id).is_some_and(|values| values.iter().any(|value| (*value).into() != 0.0));
        if let Some(id) = [base::VISCOUS, base::COULOMB].into_iter().find(|id| acts(*id)) {
            return Err(ParameterError::BesideCurve { id });
        }
        match curve.torques_nm().iter().position(|torque| !(0.0..=ENORMOUS).contains(&(*torque).into())) {
            Some(index) => Err(ParameterError::OutOfRange { id, index: index as u8 }),
            None => Ok(()),
        }
    }

    fn check_pendulum(&self) -> Result<(), ParameterError> {
        let p = &self.pendulum;
        let sensible = |value: R| (1.0 / ENORMOUS..=ENORMOUS).contains(&value.into());
        let good = [
            sensible(p.mass_kg),
            sensible(p.length_m),
            (0.0..=ENORMOUS).contains(&p.inertia_kg_m2.into()),
            sensible(p.gravity_m_s2),
        ];
        match good.iter().position(|good| !good) {
            Some(index) => Err(ParameterError::Pendulum { index: index as u8 }),
            None => Ok(()),
        }
    }
}

/// Effects that take memory in every state, and so are bounded in number.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Torque,
    Sensor,
}

impl Kind {
    fn of(id: u16) -> Option<Self> {
        match Effect::<f32>::by_id(id)?.action {
            Action::State(_) | Action::Support(_) => Some(Self::Torque),
            Action::Sensor(_) => Some(Self::Sensor),
            _ => None,
        }
    }

    fn limit(self) -> usize {
        match self {
            Self::Torque => MAX_MEMORIES,
            Self::Sensor => MAX_SENSORS,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Torque => "with a memory",
            Self::Sensor => "on the sensor",
        }
    }
}

/// Refuses the first effect for which there is no memory left.
fn check_room(effects: impl Iterator<Item = (u16, Option<Kind>)>) -> Result<(), ParameterError> {
    let mut taken = [(Kind::Torque, 0), (Kind::Sensor, 0)];
    for (id, kind) in effects {
        if let Some((kind, n)) = taken.iter_mut().find(|(of, _)| Some(*of) == kind) {
            *n += 1;
            if *n > kind.limit() {
                return Err(ParameterError::NoRoom { id, limit: kind.limit() as u8 });
            }
        }
    }
    Ok(())
}

fn check_effect<R: Copy + Into<f64>>(effect: &EffectValues<R>) -> Result<(), ParameterError> {
    let id = effect.id;
    let known = Effect::<f32>::by_id(id).ok_or(ParameterError::UnknownEffect { id })?;
    check_count(id, known.parameters.len(), effect.values.len())?;
    for (index, (parameter, value)) in known.parameters.iter().zip(&effect.values).enumerate() {
        let value: f64 = (*value).into();
        let low = if parameter.low < 0.0 {
            parameter.low * ABSURD
        } else {
            f64::from(parameter.low as f32).min(parameter.low)
        };
        // Not a number fails the comparison and is refused as well.
        if !(low..=parameter.high * ABSURD).contains(&value) {
            return Err(ParameterError::OutOfRange { id, index: index as u8 });
        }
    }
    Ok(())
}

fn check_count(id: u16, expected: usize, got: usize) -> Result<(), ParameterError> {
    let wrong = ParameterError::WrongCount { id, expected: expected as u8, got: got as u8 };
    if expected == got { Ok(()) } else { Err(wrong) }
}

/// The ids of the base effects, by the name the paper gives their numbers.
pub mod base {
    /// Viscous friction: Mw.
    pub const VISCOUS: u16 = 1;
    /// Coulomb friction: Mc.
    pub const COULOMB: u16 = 2;
    /// Stiction: Ms and DV.
    pub const STICTION: u16 = 3;

    /// Does the id belong to one of them?
    pub fn has(id: u16) -> bool {
        crate::effect::Effect::<f32>::by_id(id).is_some_and(crate::effect::Effect::is_base)
    }
}

impl Parameters<f64> {
    /// The paper's model at the optimum of its third design (Tables 1 and 9).
    pub fn paper() -> Self {
        let pendulum = Pendulum { inertia_kg_m2: 0.002_706_768_718, ..Pendulum::paper() };
        let mut parameters = Self::frictionless(pendulum);
        parameters.set_friction(0.000_540_104_134, 0.000_712_350_307, 0.001, 0.055);
        parameters
    }
}

impl<R: Copy> Parameters<R> {
    /// Sets the base effects: Mw in N·m·s/rad, Mc and Ms in N·m, DV in rad/s.
    pub fn set_friction(&mut self, viscous: R, coulomb: R, stiction: R, velocity_band: R) {
        let entries: [(u16, &[R]); 3] =
            [(base::VISCOUS, &[viscous]), (base::COULOMB, &[coulomb]), (base::STICTION, &[stiction, velocity_band])];
        for (id, values) in entries {
            self.effects.retain(|effect| effect.id != id);
            let values = values.iter().copied().collect();
            // The three base effects are part of the bound on the list.
            let _ = self.effects.push(EffectValues { id, values });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_parameters_are_accepted() {
        assert_eq!(Parameters::paper().check(), Ok(()));
        assert_eq!(Parameters::paper().map(|v| v as f32).check(), Ok(()));
    }

    #[test]
    fn bad_numbers_are_named() {
        let mut p = Parameters::paper();
        p.pendulum.mass_kg = -1.0;
        assert_eq!(p.check(), Err(ParameterError::Pendulum { index: 0 }));

        let check_with = |id: u16, values: &[f64]| {
            let mut p = Parameters::paper();
            p.set(id, values).unwrap();
            p.check()
        };
        assert_eq!(check_with(1, &[f64::NAN]), Err(ParameterError::OutOfRange { id: 1, index: 0 }));
        assert_eq!(check_with(3, &[1e-3, -0.1]), Err(ParameterError::OutOfRange { id: 3, index: 1 }));
        assert_eq!(check_with(3, &[1e-3]), Err(ParameterError::WrongCount { id: 3, expected: 2, got: 1 }));
        assert_eq!(check_with(999, &[1.0]), Err(ParameterError::UnknownEffect { id: 999 }));
    }

    #[test]
    fn the_first_sensor_effect_or_memory_without_a_place_is_refused_by_name() {
        let full = |kind: Kind| (1..).take(kind.limit()).map(move |id| (id, Some(kind)));
        for (kind, words) in [(Kind::Sensor, "at most 5 effects on the sensor"), (Kind::Torque, "2 effects with a")] {
            assert_eq!(check_room(full(kind)), Ok(()));
            let limit = kind.limit() as u8;
            let id = Effect::<f32>::ALL.iter().find(|effect| Kind::of(effect.id) == Some(kind)).unwrap().id;
            let refused = check_room(full(kind).chain([(7, None), (id, Some(kind)), (99, Some(kind))]));
            assert_eq!(refused, Err(ParameterError::NoRoom { id, limit }));
            use std::string::ToString;
            let said = refused.unwrap_err().to_string();
            let name = Effect::<f32>::by_id(id).unwrap().name;
            assert!(said.contains(words) && said.contains(name), "{said}");
        }
    }

    #[test]
    fn a_friction_curve_stands_in_place_of_viscous_and_coulomb_friction() {
        let curve = |torque: f64| Curve::new(&[0.0, 2.0], &[1e-3, torque]).unwrap();
        let mut p = Parameters::paper();
        p.set_curve(&curve(2e-3)).unwrap();
        assert_eq!(p.check(), Err(ParameterError::BesideCurve { id: base::VISCOUS }));
        p.set(base::VISCOUS, &[0.0]).unwrap();
        p.remove(base::COULOMB);
        assert_eq!(p.check(), Ok(()));
        p.set_curve(&curve(-1e-6)).unwrap();
        assert_eq!(p.check(), Err(ParameterError::OutOfRange { id: CURVE_ID, index: 1 }));
        p.curve = None;
        assert_eq!(p.check(), Err(ParameterError::UnknownEffect { id: CURVE_ID }));
    }

    #[test]
    fn an_effect_listed_twice_is_refused() {
        let mut p = Parameters::paper();
        p.effects.push(p.effects[0].clone()).unwrap();
        assert_eq!(p.check(), Err(ParameterError::Twice { id: p.effects[0].id }));
    }
}
