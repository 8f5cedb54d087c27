//! What a fit of a rig's swings has to find.

use super::problem::{Problem, Unknown};
use super::tally::Tally;
use super::tolerance::KnownRig;
use crate::formula::effect_of;
use crate::geometry;
use crate::recording::Measured;
use crate::swing::Swing;
use shared::effect::Effect;
use shared::parameters::{Parameters, base};

/// The problem of a rig: its inertia and all numbers of its effects, in the paper's order; the base effects are always
/// there.
pub fn problem_of<'a, 'r>(swings: &'a [Swing], rig: impl Into<KnownRig<'r>>, count: &'a Tally) -> Problem<'a> {
    let KnownRig { parameters, tolerances } = rig.into();
    let mut template = tolerances.centred(parameters);
    for id in [base::VISCOUS, base::COULOMB, base::STICTION] {
        let n_values = Effect::<f64>::by_id(id).map_or(0, |effect| effect.parameters.len());
        if template.values(id).is_none() {
            // A rig file has room for the base effects: it is checked when read.
            let _ = template.set(id, &vec![0.0; n_values]);
        }
    }
    add_scale_of_rates(swings, &mut template);
    geometry::begin_with_the_period(&mut template.pendulum, swings);
    let of_effect =
        |id: u16| effect_of(&template, id).map_or(Vec::new(), |effect| Unknown::all_of_effect(effect, &template));
    let added = template.effects.iter().map(|effect| effect.id).filter(|id| *id > base::STICTION);
    let ids = [base::VISCOUS, base::COULOMB, base::STICTION].into_iter().chain(added);
    let ids = ids.filter(|id| template.curve.is_none() || *id == base::STICTION || !base::has(*id));
    let mut unknowns: Vec<Unknown> = ids.flat_map(of_effect).collect();
    let inertia_at = unknowns.iter().rposition(Unknown::is_stiction).map_or(0, |last| last + 1);
    unknowns.insert(inertia_at, Unknown::inertia_within(&tolerances, &template));
    Problem { tolerances, ..Problem::new(swings, &template, unknowns, count) }
}

/// A gyroscope's scale is known to some percent only, so that it is a number of every fit of rates; its bias is the free
/// offset of each swing.
fn add_scale_of_rates(swings: &[Swing], template: &mut Parameters<f64>) {
    let gain = Effect::<f64>::with(|rules| rules.is_calibrated).next();
    let is_rate = swings.iter().any(|swing| swing.measured == Measured::Rate);
    if let Some(gain) = gain.filter(|gain| is_rate && template.values(gain.id).is_none()) {
        // A model that is full keeps the scale that it has.
        let _ = template.set(gain.id, &[gain.parameters[0].start]);
    }
}
