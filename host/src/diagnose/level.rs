//! Models with the same number of added effects, the lowest cost first.

use super::trial::Trial;

/// Costs within this factor of the best are worth a fit to the last digit on sketches.
pub(super) const NEAR: f64 = 1.3;

/// The models of a sorted level that nearly cost what the best one does.
pub(super) fn near_the_best(level: &[Trial]) -> &[Trial] {
    let n_near = level.iter().take_while(|trial| trial.cost < NEAR * level[0].cost).count();
    &level[..n_near]
}

/// Puts the lowest cost first.
pub(super) fn sort(level: &mut [Trial]) {
    level.sort_by(|a, b| a.cost.total_cmp(&b.cost));
}

/// Of models with the same effects only the first is kept.
pub(super) fn drop_doubles(level: &mut Vec<Trial>) {
    let mut seen: Vec<Vec<u16>> = Vec::new();
    level.retain(|trial| {
        let mut ids: Vec<u16> = trial.effects.iter().map(|effect| effect.id).collect();
        ids.sort_unstable();
        let new = !seen.contains(&ids);
        seen.push(ids);
        new
    });
}
