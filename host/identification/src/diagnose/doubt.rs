//! What speaks against an effect that explains the fitted swings: numbers within their own errors, held-out swings that
//! contradict it, and an exponent that says it is another one.

use super::holds::{Holding, Standing};
use super::strength::strengths;
use super::summary::SpecialCase;
use super::value::values;
use super::verdict::Judge;
use crate::fit::fitted::Fitted;
use crate::fit::identify::{Carries, HeldOut};
use crate::fit::tally::Tally;
use crate::swing::Swing;
use crate::verdict::{CHANCE_STDS, Left};
use shared::effect::Effect;

/// An exponent is known well enough to say which law it is, up to this standard deviation.
const EXPONENT_KNOWN: f64 = 0.05;

/// Which numbers of an effect say where on the way it acts: angles to either side that are no strength.
fn places(effect: &Effect<f64>) -> Vec<usize> {
    let strong = strengths(effect);
    let is_place = |index: &usize| {
        let parameter = &effect.parameters[*index];
        parameter.unit == "rad" && parameter.low < 0.0 && !strong.contains(index)
    };
    (0..effect.parameters.len()).filter(is_place).collect()
}

impl Judge<'_, '_> {
    /// Without effects whose strengths can't be told from zero, each of them: whatever they gain, nobody knows by what. Of a
    /// wider law that may be since its numbers make up for each other; its special case has fewer.
    pub(super) fn beyond_their_errors(&self, claimed: Fitted) -> Fitted {
        let Some(effect) = self.vague(&claimed) else { return claimed };
        let surer =
            self.special_case_of(&claimed, effect).or_else(|| self.surer(&claimed)).or_else(|| self.surest(&claimed));
        self.beyond_their_errors(surer.unwrap_or_else(|| self.without_doubtful(&claimed, effect.name)))
    }

    /// What was dropped on the way from a model to one of fewer effects, as no number of it is known, where more than noise is left
    /// without it: that is told with its reason.
    pub(super) fn vague_claims(&self, model: &Fitted, sure: &Fitted) -> Vec<Holding> {
        let is_told =
            sure.effects.len() < model.effects.len() && self.problem.chi_square(sure.cost).left() == Left::Missing;
        let all = if is_told { self.holdings(model) } else { Vec::new() };
        let dropped = all.into_iter().filter(|holding| !sure.has(holding.effect));
        dropped.map(|holding| Holding { standing: Standing::Vague, ..holding }).collect()
    }

    /// The first effect that can't be told from none. A strength and an exponent make up for each other, so that either is enough
    /// if it is beyond its own error, while a place that is known proves nothing, nor does an exponent on the end of its range. Of
    /// a sine and a cosine one has to be beyond chance, however well their notches are known.
    fn vague(&self, model: &Fitted) -> Option<&'static Effect<f64>> {
        if model.effects.is_empty() {
            return None;
        }
        let values = values(self.problem, model);
        let is_vague = |effect: &&'static Effect<f64>| {
            let own = values.iter().filter(|value| value.effect == effect.name);
            let (strong, places) = (strengths(effect), places(effect));
            let are_several = strong.len() > 1;
            let mut telling = own.enumerate().filter(|(index, value)| match strong.contains(index) {
                true => true,
                false => !are_several && !places.contains(index) && !value.is_on_an_end(),
            });
            telling.all(|(_, value)| value.is_within(if are_several { CHANCE_STDS } else { 1.0 }))
        };
        model.effects.iter().copied().find(is_vague)
    }

    /// The best model of as many effects that has fewer numbers, no law of which is vague, and that leaves about as much.
    fn surer(&self, claimed: &Fitted) -> Option<Fitted> {
        let level = self.found.levels.get(claimed.effects.len().checked_sub(1)?)?;
        let mut simpler: Vec<&Fitted> = level
            .iter()
            .filter(|model| model.n_added() < claimed.n_added() && self.leaves_about_as_much(model, claimed))
            .collect();
        simpler.sort_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)));
        simpler.into_iter().find(|model| self.vague(model).is_none()).cloned()
    }

    /// In place of a single law that is vague, the best one that is not and is worth it, though it leaves more.
    fn surest(&self, claimed: &Fitted) -> Option<Fitted> {
        let level = self.found.levels.first().filter(|_| claimed.effects.len() == 1)?;
        let is_worth_it = |model: &&Fitted| self.is_worth_it(&self.found.base, model) && self.vague(model).is_none();
        let others = level.iter().filter(|model| model.n_added() < claimed.n_added()).filter(is_worth_it);
        others.min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b))).cloned()
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
        count: &Tally,
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
    pub(super) fn carries(&self, claimed: &Fitted, held_out: &[Swing], count: &Tally) -> Option<Carries> {
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
            if std < EXPONENT_KNOWN && (value - exponent).abs() < CHANCE_STDS * std {
                let symbol = effect.parameters[usize::from(at)].symbol;
                cases.push(SpecialCase { effect: effect.name, symbol, value, std, special });
            }
        }
        undecided.retain(|name| cases.iter().all(|case| case.effect != *name));
        cases
    }

    /// A claimed model without one effect, refitted to all samples; the base model where none is left.
    fn smaller(&self, claimed: &Fitted, id: u16) -> Fitted {
        let rest = self.without_on_all(claimed, id);
        if rest.effects.is_empty() { self.found.base.clone() } else { rest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_magnet_and_a_relaxed_spring_have_a_place_and_nothing_else_has() {
        let of_effect = |effect: &Effect<f64>| {
            let symbols = places(effect).into_iter().map(|index| effect.parameters[index].symbol);
            symbols.collect::<Vec<_>>()
        };
        let found: Vec<&str> = Effect::<f64>::usual().flat_map(of_effect).collect();
        assert_eq!(found, ["thb", "ths"]);
        for effect in Effect::<f64>::usual() {
            let wide = effect.wider_form().map_or(0, |wide| places(wide).len());
            assert!(effect.wider_form().is_none() || wide == places(effect).len(), "{}", effect.name);
        }
    }
}
