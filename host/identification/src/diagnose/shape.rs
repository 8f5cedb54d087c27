//! How far the numbers of the rig itself depend on the shape of the laws that are claimed beside them.
//!
//! ± of one law are right if the truth has exactly its shape, which a diagnosis never knows. So the laws that the swings hardly
//! tell from the claimed ones are asked as well, and ± hold how far friction and inertia move from one to the other.
//! Source: S. T. Buckland, K. P. Burnham, N. H. Augustin, Biometrics 53 (1997) 603: the uncertainty of a choice of models.

use super::models::is_explained;
use super::value::{Value, values};
use super::verdict::{INDISTINGUISHABLE, Judge};
use super::widening::{in_usual_form, widenings};
use crate::fit::fitted::Fitted;
use crate::fit::refine::on_all;
use crate::fit::uncertainty::{Status, UNKNOWN_SHARE, size, with_the_rig_free};
use crate::verdict::Left;
use rayon::prelude::*;

impl Judge<'_, '_> {
    /// The numbers of a claimed model; `others` are models beside those of the search.
    pub(super) fn values_of(&self, claimed: &Fitted, others: &[Fitted]) -> Vec<Value> {
        let mut values = values(self.problem, claimed);
        if claimed.effects.is_empty() {
            return values;
        }
        let alike = self.alike(claimed, others);
        let free = with_the_rig_free(self.problem, claimed).numbers;
        for unknown in claimed.unknowns.iter().filter(|unknown| unknown.is_of_the_rig()) {
            let at = |model: &Fitted| unknown.get(&model.parameters);
            let moved = alike.iter().map(|model| (at(model) - at(claimed)).abs()).fold(0.0, f64::max);
            let own = free.iter().find(|number| number.unknown.quantity == unknown.quantity).and_then(|it| it.std);
            let value = values.iter_mut().find(|value| value.symbol == unknown.symbol && value.effect == unknown.name);
            if let Some(value) = value {
                widen(value, own, moved, size(unknown, claimed));
            }
        }
        values
    }

    /// Models with laws of another shape that leave as little as the claimed one, or nothing but noise.
    fn alike(&self, claimed: &Fitted, others: &[Fitted]) -> Vec<Fitted> {
        let n_effects = claimed.effects.len();
        let Some(level) = n_effects.checked_sub(1) else { return Vec::new() };
        let wider: Vec<Fitted> = widenings(claimed)
            .collect::<Vec<_>>()
            .par_iter()
            .filter_map(|widening| widening.fitted(self.rough))
            .map(|mut found| found.swap_remove(0))
            .collect();
        let usual = claimed.effects.iter().filter_map(|effect| in_usual_form(self.rough, claimed, effect));
        let [wider, usual] = [wider, usual.collect()].map(|shapes: Vec<Fitted>| {
            let settled = |model: &Fitted| on_all(self.problem, std::slice::from_ref(model)).settled(self.problem);
            shapes.iter().map(settled).collect::<Vec<Fitted>>()
        });
        let reach = INDISTINGUISHABLE * self.unit();
        let is_alike = |model: &&Fitted| {
            let is_other = model.effects.len() == n_effects && model.names() != claimed.names();
            is_other && (model.cost - claimed.cost < reach || is_explained(self.problem, model))
        };
        let of_search = self.found.levels.get(level).into_iter().flatten();
        // What lies between a law and its usual form may be the truth, if the usual one would nearly do; or if the law drives
        // a number of the rig onto its bound, which is no place for one.
        let is_cornered = claimed.unknowns.iter().any(|unknown| {
            let value = unknown.get(&claimed.parameters);
            unknown.is_of_the_rig() && (value <= unknown.low || value >= unknown.high)
        });
        let nearly_does = |model: &&Fitted| is_cornered || self.problem.chi_square(model.cost).left() != Left::Missing;
        let nearly = usual.iter().filter(nearly_does);
        of_search.chain(others).chain(&wider).filter(is_alike).chain(nearly).cloned().collect()
    }
}

/// The ± of a number of this size, with what it has where nothing is on a bound and how far it moves beside.
fn widen(value: &mut Value, free: Option<f64>, moved: f64, size: f64) {
    let own = [value.std, free].into_iter().flatten().reduce(f64::max);
    value.std = own.map(|own| own.hypot(moved)).or((moved > 0.0).then_some(moved));
    let is_vague = value.std.is_some_and(|std| std >= UNKNOWN_SHARE * size);
    value.status = if is_vague && value.status == Status::Identified { Status::NotIdentified } else { value.status };
}
