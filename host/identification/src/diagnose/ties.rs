//! Laws that the windows of the swings can't separate, and the family they belong to.

use super::extension::swings;
use super::holds::{Holding, Standing};
use super::verdict::Judge;
use crate::fit::clusters::{Cluster, clusters, is_beyond_chance, squares};
use crate::fit::fitted::Fitted;
use crate::fit::problem::Problem;
use serde::Serialize;
use shared::effect::Effect;

/// A kind of law that holds, while its members can't be told apart.
#[derive(Clone, Debug, Serialize)]
pub struct FamilyClaim {
    /// What its members have in common.
    pub words: &'static str,
    /// The claimed effect first.
    pub members: Vec<&'static str>,
}

/// The family of a claimed effect, where the undecided ones all belong to it.
pub(super) fn family(claimed: &Fitted, undecided: &[&'static str]) -> Option<FamilyClaim> {
    let rivals: Vec<&Effect<f64>> = undecided.iter().filter_map(|name| Effect::by_name(name)).collect();
    let family = rivals.first()?.family;
    let member = claimed.effects.iter().find(|effect| effect.family == family)?;
    let all = rivals.iter().all(|rival| rival.family == family);
    let members = std::iter::once(member.name).chain(undecided.iter().copied()).collect();
    all.then(|| FamilyClaim { words: family.words(), members })
}

/// What a model leaves in the clusters of another one, its starts free in every window.
fn left_in(on: &Problem, model: &Fitted, clusters: &[Cluster]) -> Vec<f64> {
    let bare = Fitted { unknowns: Vec::new(), steps: None, ..model.clone() };
    squares(&bare.linearised(on), clusters)
}

/// A rival removes at least this share of what the claimed effect removes.
const RIVAL_SHARE: f64 = 0.5;

/// A law with fewer numbers is taken instead of the claimed one if the clusters can't separate them and it removes at
/// least this share of what that one does.
const SIMPLER_SHARE: f64 = 0.9;

impl Judge<'_, '_> {
    /// Effects that could stand for a claimed one as far as the clusters tell.
    pub(super) fn not_separated(&self, claimed: &Fitted, others: &[Fitted]) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = Vec::new();
        for name in self.rivals(claimed, others).into_iter().flat_map(Fitted::names) {
            if !claimed.has(name) && !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// The model with the fewest numbers that the clusters can't separate from a claimed one with more of them, if it
    /// holds on every part too: that friction grows with the speed may be sure while its shape is not.
    pub(super) fn simpler(&self, claimed: &Fitted, others: &[Fitted]) -> Option<(Fitted, Vec<Holding>)> {
        let removed = |model: &Fitted| self.found.base.cost - model.cost;
        let is_simpler = |model: &&Fitted| {
            let removes_as_much = removed(model) > SIMPLER_SHARE * removed(claimed);
            // What swings beside the pendulum imitates much, and leaves less than the law that it imitates.
            let leaves_as_much = self.leaves_about_as_much(model, claimed) || swings(claimed) && !swings(model);
            model.n_added() < claimed.n_added() && removes_as_much && leaves_as_much
        };
        let mut simpler: Vec<&Fitted> = self.rivals(claimed, others).into_iter().filter(is_simpler).collect();
        simpler.sort_by(|a, b| a.n_added().cmp(&b.n_added()).then(a.cost.total_cmp(&b.cost)));
        simpler.into_iter().find_map(|model| {
            let found = self.holdings(model);
            found.iter().all(|holding| holding.standing == Standing::Holds).then(|| (model.clone(), found))
        })
    }

    /// Models with one effect exchanged that the clusters can't separate from the claimed one: where more than noise is
    /// left, sums of squares over coherent residuals are no measure of how much better one law is than another.
    fn rivals<'t>(&'t self, claimed: &Fitted, others: &'t [Fitted]) -> Vec<&'t Fitted> {
        let Some(level) = claimed.effects.len().checked_sub(1) else { return Vec::new() };
        let removed = self.found.base.cost - claimed.cost;
        let is_rival = |model: &&Fitted| {
            model.effects.len() == claimed.effects.len()
                && self.found.base.cost - model.cost > RIVAL_SHARE * removed
                && model.names().iter().filter(|name| !claimed.has(name)).count() == 1
        };
        let rivals: Vec<&Fitted> =
            self.found.levels.get(level).into_iter().flatten().chain(others).filter(is_rival).collect();
        if rivals.is_empty() {
            return Vec::new();
        }
        let linear = claimed.linearised(self.problem);
        let clusters = clusters(self.problem, &linear, &claimed.starts, |_| true);
        let own = left_in(self.problem, claimed, &clusters);
        let is_separate = |rival: &Fitted| {
            let left = left_in(self.problem, rival, &clusters);
            let more: Vec<f64> = left.iter().zip(&own).map(|(rival, own)| rival - own).collect();
            more.iter().sum::<f64>() > 0.0 && is_beyond_chance(&more)
        };
        rivals.into_iter().filter(|rival| !is_separate(rival)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, rig};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;

    #[test]
    fn a_family_is_told_where_all_rivals_belong_to_it() {
        let count = Tally::default();
        let problem = problem_of(&[], &rig(), &count);
        let base = Fitted::at(&problem, &Point { values: problem.template_values(), starts: Vec::new() });
        let drag = effect("quadratic-drag");
        let claimed = base.with(drag, &drag.starts[0]).unwrap();
        let found = family(&claimed, &["power-law-drag"]).unwrap();
        assert_eq!((found.words, found.members), (drag.family.words(), vec!["quadratic-drag", "power-law-drag"]));
        assert!(family(&claimed, &["power-law-drag", "torsional-spring"]).is_none());
        assert!(family(&claimed, &[]).is_none() && family(&base, &["power-law-drag"]).is_none());
    }
}
