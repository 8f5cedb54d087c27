//! The numbers of a model by name: m, l, I, g, and every effect's parameters by symbol.

use crate::formula::{add, effect_of};
use shared::effect::{Action, CUSTOM_FORMULA_ID, Effect};
use shared::parameters::{ParameterError, Parameters};
use std::collections::HashSet;

/// A number of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// m, kg.
    Mass,
    /// l, m.
    Length,
    /// I, the moment of inertia about the centre of mass, kg·m².
    Inertia,
    /// g, m/s².
    Gravity,
    /// A number of an effect.
    Effect {
        /// The effect's id.
        id: u16,
        /// Position in its parameter list.
        index: usize,
    },
    /// A number of a formula that somebody typed.
    Custom {
        /// The formula as an effect.
        effect: &'static Effect<f64>,
        /// Position in its parameter list.
        index: usize,
    },
}

/// Symbol, key in the file, unit and meaning of the pendulum's own numbers.
const PENDULUM: [(Quantity, &str, &str, &str, &str); 4] = [
    (Quantity::Mass, "m", "mass", "kg", "mass"),
    (Quantity::Length, "l", "length", "m", "from pivot to centre of mass"),
    (Quantity::Inertia, "I", "inertia", "kg·m²", "moment of inertia about the centre of mass"),
    (Quantity::Gravity, "g", "gravity", "m/s²", "gravitational acceleration"),
];

impl Quantity {
    /// The pendulum's own numbers.
    pub const PENDULUM: [Self; 4] = [Self::Mass, Self::Length, Self::Inertia, Self::Gravity];

    /// Every number of a model: the pendulum's and those of its effects.
    pub fn all(parameters: &Parameters<f64>) -> Vec<Self> {
        let present = parameters.effects.iter().filter_map(|present| effect_of(parameters, present.id));
        let of_effects = present.flat_map(Self::all_of_effect);
        Self::PENDULUM.into_iter().chain(of_effects).collect()
    }

    /// Every number of an effect.
    pub fn all_of_effect(effect: &'static Effect<f64>) -> impl Iterator<Item = Self> {
        (0..effect.parameters.len()).map(move |index| Self::of_effect(effect, index))
    }

    /// A number of an effect.
    pub(super) fn of_effect(effect: &'static Effect<f64>, index: usize) -> Self {
        match effect.action {
            Action::Formula(_) => Self::Custom { effect, index },
            _ => Self::Effect { id: effect.id, index },
        }
    }

    /// By symbol (`k`) or effect and symbol (`custom.k`) among the numbers of a formula.
    pub fn by_formula_name(name: &str, effect: &'static Effect<f64>) -> Option<Self> {
        let symbol = name.strip_prefix(effect.name).and_then(|rest| rest.strip_prefix('.')).unwrap_or(name);
        Self::all_of_effect(effect).find(|quantity| quantity.symbol() == symbol)
    }

    /// By symbol (`Mw`), key (`inertia`), or effect and symbol (`viscous.Mw`); `None` too if several effects use the symbol.
    pub fn by_name(name: &str) -> Option<Self> {
        let all = Self::all_of_name(name);
        if let [one] = all[..] { Some(one) } else { None }
    }

    /// All that a name may mean: a symbol that several effects use stands for a number of each.
    pub fn all_of_name(name: &str) -> Vec<Self> {
        let own = PENDULUM.iter().find(|(_, symbol, key, ..)| *symbol == name || *key == name);
        own.map_or_else(|| Self::all_of_effect_name(name), |(quantity, ..)| vec![*quantity])
    }

    fn all_of_effect_name(name: &str) -> Vec<Self> {
        let (effect_name, symbol) = match name.split_once('.') {
            Some((effect, symbol)) => (Some(effect), symbol),
            None => (None, name),
        };
        let meant = |effect: &&'static Effect<f64>| effect_name.is_none_or(|wanted| wanted == effect.name);
        let numbers = Effect::<f64>::ALL.iter().filter(meant).flat_map(Self::all_of_effect);
        numbers.filter(|quantity| quantity.symbol() == symbol).collect()
    }

    /// Its effect and symbol (`viscous.Mw`), which no other number has.
    pub fn full_name(self) -> String {
        format!("{}.{}", self.owner(), self.symbol())
    }

    /// All symbols that [`Quantity::by_name`] knows, for messages.
    pub fn symbols() -> String {
        let own = PENDULUM.iter().map(|(_, symbol, ..)| *symbol);
        let of_effects = Effect::<f64>::ALL.iter().flat_map(|effect| effect.parameters.iter().map(|p| p.symbol));
        let mut told = HashSet::new();
        own.chain(of_effects).filter(|symbol| told.insert(*symbol)).collect::<Vec<_>>().join(", ")
    }

    /// The literature's symbol.
    pub fn symbol(self) -> &'static str {
        self.described().0
    }

    /// SI unit.
    pub fn unit(self) -> &'static str {
        self.described().2
    }

    /// In a few words.
    pub fn meaning(self) -> &'static str {
        self.described().3
    }

    /// The effect's name, or `pendulum`.
    pub fn owner(self) -> &'static str {
        match self {
            Self::Effect { id, .. } => Effect::<f64>::by_id(id).map_or("?", |effect| effect.name),
            Self::Custom { effect, .. } => effect.name,
            _ => "pendulum",
        }
    }

    /// The key in the model file.
    pub fn key(self) -> &'static str {
        self.described().1
    }

    /// Is it measured by other means than swings?
    pub(super) fn is_measured(self) -> bool {
        matches!(self, Self::Mass | Self::Length)
    }

    /// May it have been measured to a tolerance before any swing?
    pub(super) fn has_tolerance(self) -> bool {
        self.is_measured() || self == Self::Inertia
    }

    pub(super) fn is_of(self, wanted: u16) -> bool {
        self.place().is_some_and(|(id, _)| id == wanted)
    }

    /// Its effect's id and its position there.
    pub(super) fn place(self) -> Option<(u16, usize)> {
        match self {
            Self::Effect { id, index } => Some((id, index)),
            Self::Custom { index, .. } => Some((CUSTOM_FORMULA_ID, index)),
            _ => None,
        }
    }

    fn described(self) -> (&'static str, &'static str, &'static str, &'static str) {
        let effect = match self {
            Self::Effect { id, .. } => Effect::<f64>::by_id(id),
            Self::Custom { effect, .. } => Some(effect),
            _ => None,
        };
        if let Some((_, index)) = self.place() {
            let parameter = effect.and_then(|effect| effect.parameters.get(index));
            return parameter.map_or(("?", "?", "?", "?"), |p| (p.symbol, p.symbol, p.unit, p.meaning));
        }
        let found = PENDULUM.iter().find(|(quantity, ..)| *quantity == self);
        found.map_or(("?", "?", "?", "?"), |(_, symbol, key, unit, meaning)| (*symbol, *key, *unit, *meaning))
    }

    /// Its value; `None` if its effect is absent.
    pub fn get(self, parameters: &Parameters<f64>) -> Option<f64> {
        let pendulum = &parameters.pendulum;
        match self {
            Self::Mass => Some(pendulum.mass_kg),
            Self::Length => Some(pendulum.length_m),
            Self::Inertia => Some(pendulum.inertia_kg_m2),
            Self::Gravity => Some(pendulum.gravity_m_s2),
            Self::Effect { id, index } => parameters.values(id)?.get(index).copied(),
            Self::Custom { index, .. } => parameters.values(CUSTOM_FORMULA_ID)?.get(index).copied(),
        }
    }

    /// Sets it; its effect must be present.
    pub fn set(self, parameters: &mut Parameters<f64>, value: f64) {
        let pendulum = &mut parameters.pendulum;
        match self {
            Self::Mass => pendulum.mass_kg = value,
            Self::Length => pendulum.length_m = value,
            Self::Inertia => pendulum.inertia_kg_m2 = value,
            Self::Gravity => pendulum.gravity_m_s2 = value,
            Self::Effect { .. } | Self::Custom { .. } => {
                let Some((id, index)) = self.place() else { return };
                let effect = parameters.effects.iter_mut().find(|effect| effect.id == id);
                if let Some(slot) = effect.and_then(|effect| effect.values.get_mut(index)) {
                    *slot = value;
                }
            }
        }
    }

    /// Adds its effect with start values if it is absent; tells whether it had to.
    pub fn add_effect(self, parameters: &mut Parameters<f64>) -> Result<bool, ParameterError> {
        let Some((id, _)) = self.place() else { return Ok(false) };
        if parameters.values(id).is_some() {
            return Ok(false);
        }
        let effect = match self {
            Self::Custom { effect, .. } => effect,
            _ => Effect::<f64>::by_id(id).ok_or(ParameterError::UnknownEffect { id })?,
        };
        let start: Vec<f64> = effect.parameters.iter().map(|parameter| parameter.start).collect();
        add(parameters, effect, &start).map(|()| true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_finds_its_number_and_the_number_its_symbol() {
        for quantity in Quantity::PENDULUM {
            assert_eq!(Quantity::by_name(quantity.symbol()), Some(quantity));
            assert_eq!(Quantity::by_name(quantity.key()), Some(quantity));
        }
        for effect in Effect::<f64>::ALL {
            for (index, parameter) in effect.parameters.iter().enumerate() {
                let quantity = Quantity::Effect { id: effect.id, index };
                assert_eq!(Quantity::by_name(&format!("{}.{}", effect.name, parameter.symbol)), Some(quantity));
                assert_eq!((quantity.symbol(), quantity.unit()), (parameter.symbol, parameter.unit));
            }
        }
        assert_eq!(Quantity::by_name("Mx"), None);
        let names: Vec<String> = Quantity::all_of_name("dM").into_iter().map(Quantity::full_name).collect();
        assert_eq!((names.join(" "), Quantity::by_name("dM")), ("stribeck.dM asymmetric-coulomb.dM".to_owned(), None));
    }

    #[test]
    fn a_symbol_that_several_effects_use_is_listed_once() {
        let listed = Quantity::symbols();
        let symbols: Vec<&str> = listed.split(", ").collect();
        assert_eq!(symbols.iter().collect::<HashSet<_>>().len(), symbols.len(), "{listed}");
        assert!(symbols.contains(&"dM") && symbols.contains(&"Mw"), "{listed}");
    }

    #[test]
    fn setting_a_number_of_an_absent_effect_adds_it_first() {
        let mut parameters = Parameters::paper();
        let drag = Quantity::by_name("Cq").unwrap();
        assert_eq!(drag.get(&parameters), None);
        assert_eq!(drag.add_effect(&mut parameters), Ok(true));
        drag.set(&mut parameters, 1e-4);
        assert_eq!(drag.get(&parameters), Some(1e-4));
    }
}
