//! What speaks against an effect that explains the fitted swings: numbers within their own errors, held-out swings that
//! contradict it, and an exponent that says it is another one.

use super::summary::SpecialCase;
use super::value::{Value, values};
use super::verdict::Judge;
use crate::fit::fitted::Fitted;
use crate::fit::identify::{Carries, HeldOut};
use crate::fit::refine::on_all;
use crate::swing::Swing;
use shared::effect::Effect;
use std::sync::atomic::AtomicUsize;

/// An exponent is known well enough to say which law it is, up to this standard deviation …
const EXPONENT_KNOWN: f64 = 0.05;

/// … if the special one is within so many of them.
const EXPONENT_STDS: f64 = 2.0;

impl Judge<'_, '_> {
    /// Without effects whose numbers can't be told from zero, each of them: whatever they gain, nobody knows by what. Of a wider
    /// law that may be since its numbers make up for each other; its special case has fewer.
    pub(super) fn beyond_their_errors(&self, claimed: Fitted) -> Fitted {
        if claimed.effects.is_empty() {
            return claimed;
        }
        let values = values(self.problem, &claimed);
        let is_vague = |effect: &&&'static Effect<f64>| {
            let mut own = values.iter().filter(|value| value.effect == effect.name);
            own.all(Value::is_within_its_error)
        };
        match claimed.effects.iter().find(is_vague).copied() {
            Some(effect) => {
                let special = self.special_case_of(&claimed, effect);
                self.beyond_their_errors(special.unwrap_or_else(|| self.smaller(&claimed, effect.id)))
            }
            None => claimed,
        }
    }

    /// The claimed model with the special case in place of one of its laws, as the search fitted it.
    fn special_case_of(&self, claimed: &Fitted, wider: &Effect<f64>) -> Option<Fitted> {
        let special = wider.generalises?;
        let level = self.found.levels.get(claimed.effects.len().checked_sub(1)?)?;
        let is_it = |model: &&Fitted| {
            model.has(special) && claimed.effects.iter().all(|other| other.id == wider.id || model.has(other.name))
        };
        level.iter().find(is_it).cloned()
    }

    /// Without effects that held-out swings contradict, the last one first; and their names.
    pub(super) fn not_contradicted(
        &self,
        mut claimed: Fitted,
        held_out: &[Swing],
        count: &AtomicUsize,
    ) -> (Fitted, Vec<&'static str>) {
        let of = |model: &Fitted| HeldOut::of(held_out, &model.parameters, count);
        let mut vetoed = Vec::new();
        let mut error = of(&claimed);
        while let (Some(effect), Some(after)) = (claimed.effects.last().copied(), &error) {
            let smaller = self.smaller(&claimed, effect.id);
            let before = of(&smaller);
            if before.as_ref().is_none_or(|before| after.after(before) != Carries::Contradicted) {
                break;
            }
            vetoed.push(effect.name);
            (claimed, error) = (smaller, before);
        }
        (claimed, vetoed)
    }

    /// What held-out swings say to a model in place of the base model.
    pub(super) fn carries(&self, claimed: &Fitted, held_out: &[Swing], count: &AtomicUsize) -> Option<Carries> {
        if claimed.effects.is_empty() {
            return None;
        }
        let before = HeldOut::of(held_out, &self.found.base.parameters, count)?;
        Some(HeldOut::of(held_out, &claimed.parameters, count)?.after(&before))
    }

    /// Where a wider law with a free exponent explains the swings as well as the claimed one, its exponent may say that
    /// both are the same: then that is no tie.
    pub(super) fn special_cases(
        &self,
        claimed: &Fitted,
        others: &[Fitted],
        undecided: &mut Vec<&'static str>,
    ) -> Vec<SpecialCase> {
        let models = || self.found.levels.iter().flatten().chain(others);
        let mut cases = Vec::new();
        for effect in undecided.iter().filter_map(|name| Effect::<f64>::by_name(name)) {
            let Some((special, (at, exponent))) = effect.generalises.zip(effect.rules.special_case_at) else {
                continue;
            };
            let is_it = |model: &&Fitted| {
                model.effects.len() == claimed.effects.len()
                    && model.has(effect.name)
                    && claimed.effects.iter().all(|other| other.name == special || model.has(other.name))
            };
            let Some(model) = models().find(is_it).filter(|_| claimed.has(special)) else { continue };
            let values = values(self.problem, model);
            let decides = values.iter().filter(|value| value.effect == effect.name).nth(usize::from(at));
            let Some((value, std)) = decides.and_then(|decides| Some((decides.value, decides.std?))) else { continue };
            if std < EXPONENT_KNOWN && (value - exponent).abs() < EXPONENT_STDS * std {
                let symbol = effect.parameters[usize::from(at)].symbol;
                cases.push(SpecialCase { effect: effect.name, symbol, value, std, special });
            }
        }
        undecided.retain(|name| cases.iter().all(|case| case.effect != *name));
        cases
    }

    /// A claimed model without one effect, refitted to all samples; the base model where none is left.
    fn smaller(&self, claimed: &Fitted, id: u16) -> Fitted {
        let rest = on_all(self.problem, &self.without(claimed, id));
        if rest.effects.is_empty() { self.found.base.clone() } else { rest }
    }
}
