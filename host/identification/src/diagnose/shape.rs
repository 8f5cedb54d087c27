//! How far the numbers of the rig itself depend on the shape of the laws that are claimed beside them.
//!
//! ± of one law are right if the truth has exactly its shape, which a diagnosis never knows. So the laws that the swings
//! hardly tell from the claimed ones are asked as well, and ± hold how far friction and inertia move from one to the
//! other.
//! Source: S. T. Buckland, K. P. Burnham, N. H. Augustin, Biometrics 53 (1997) 603: the uncertainty of a choice of
//! models.

use super::models::is_explained;
use super::value::{Value, values};
use super::verdict::{INDISTINGUISHABLE, Judge};
use super::widening::{in_usual_form, in_wider_forms};
use crate::fit::fitted::Fitted;
use crate::fit::refine::on_all;
use crate::fit::uncertainty::{Status, UNKNOWN_SHARE, size, with_the_rig_free};
use crate::verdict::Left;

impl Judge<'_, '_> {
    /// The numbers of a claimed model; `others` are models beside those of the search.
    pub(super) fn values_of(&self, claimed: &Fitted, others: &[Fitted]) -> Vec<Value> {
        let mut values = values(self.problem, claimed);
        if claimed.effects.is_empty() {
            return values;
        }
        let alike = self.alike(claimed, others);
        // Where nothing is on a bound they have been free already.
        let free = match is_cornered(claimed) {
            true => with_the_rig_free(self.problem, claimed).numbers,
            false => Vec::new(),
        };
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

    /// Models with laws of another shape that leave as little as the claimed one, or nothing but noise; and those with a
    /// law in its usual form that would nearly do, or where a law drives a number of the rig onto its bound, which is no
    /// place for one: what lies between a law and its usual form may be the truth.
    fn alike(&self, claimed: &Fitted, others: &[Fitted]) -> Vec<Fitted> {
        let n_effects = claimed.effects.len();
        let Some(level) = n_effects.checked_sub(1) else { return Vec::new() };
        let settled = |model: Fitted| on_all(self.problem, &[model]).settled(self.problem);
        let wider: Vec<Fitted> = in_wider_forms(self.rough, claimed).into_iter().map(settled).collect();
        let usual = claimed.effects.iter().filter_map(|effect| in_usual_form(self.rough, claimed, effect)).map(settled);
        let reach = INDISTINGUISHABLE * self.unit();
        let is_alike = |model: &&Fitted| {
            let is_other = model.effects.len() == n_effects && model.names() != claimed.names();
            is_other && (model.cost - claimed.cost < reach || is_explained(self.problem, model))
        };
        let of_search = self.found.levels.get(level).into_iter().flatten();
        let is_cornered = is_cornered(claimed);
        let nearly_does = |model: &Fitted| is_cornered || self.problem.chi_square(model.cost).left() != Left::Missing;
        let alike = of_search.chain(others).chain(&wider).filter(is_alike).cloned();
        alike.chain(usual.filter(nearly_does)).collect()
    }
}

/// Does a number of the rig lie on its bound?
fn is_cornered(model: &Fitted) -> bool {
    model.unknowns.iter().any(|unknown| unknown.is_of_the_rig() && unknown.is_at_end(&model.parameters))
}

/// The ± of a number of this size, with what it has where nothing is on a bound and how far it moves beside.
fn widen(value: &mut Value, free: Option<f64>, moved: f64, size: f64) {
    let own = [value.std, free].into_iter().flatten().reduce(f64::max);
    value.std = own.map(|own| own.hypot(moved)).or((moved > 0.0).then_some(moved));
    let is_vague = value.std.is_some_and(|std| std >= UNKNOWN_SHARE * size);
    value.status = if is_vague && value.status == Status::Identified { Status::NotIdentified } else { value.status };
}
