//! What stays of a model without one of its effects: fitted once, however often a verdict asks for it.

use crate::fit::fitted::Fitted;
use std::sync::{Mutex, PoisonError};

/// Of the models that were asked for so far.
#[derive(Default)]
pub(super) struct Rests(Mutex<Vec<Rest>>);

#[derive(Clone)]
struct Rest {
    of: Fitted,
    without: u16,
    /// On decimated swings, with the stop levels that may suit it.
    levels: Vec<Fitted>,
    /// On all samples, once that was asked for.
    on_all: Option<Fitted>,
}

impl Rests {
    /// A model without an effect, on decimated swings with the stop levels that may suit it.
    pub(super) fn levels(&self, of: &Fitted, without: u16, fit: impl FnOnce() -> Vec<Fitted>) -> Vec<Fitted> {
        if let Some(known) = self.known(of, without) {
            return known.levels;
        }
        // Nothing is locked meanwhile: who fits may ask for others.
        let levels = fit();
        self.all().push(Rest { of: of.clone(), without, levels: levels.clone(), on_all: None });
        levels
    }

    /// The same on all samples; its levels were asked for before.
    pub(super) fn on_all(&self, of: &Fitted, without: u16, fit: impl FnOnce() -> Fitted) -> Fitted {
        if let Some(on_all) = self.known(of, without).and_then(|known| known.on_all) {
            return on_all;
        }
        let on_all = fit();
        self.all().iter_mut().filter(|rest| rest.is(of, without)).for_each(|rest| rest.on_all = Some(on_all.clone()));
        on_all
    }

    fn known(&self, of: &Fitted, without: u16) -> Option<Rest> {
        self.all().iter().find(|rest| rest.is(of, without)).cloned()
    }

    fn all(&self) -> std::sync::MutexGuard<'_, Vec<Rest>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Rest {
    fn is(&self, of: &Fitted, without: u16) -> bool {
        self.without == without && is_same(&self.of, of)
    }
}

/// Are all numbers the same, to the last bit?
fn is_same(one: &Fitted, other: &Fitted) -> bool {
    one.cost == other.cost
        && one.effects.iter().map(|effect| effect.id).eq(other.effects.iter().map(|effect| effect.id))
        && one.stiction() == other.stiction()
        && one.point() == other.point()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, rig};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;

    #[test]
    fn each_rest_is_fitted_once_and_of_another_model_anew() {
        let count = Tally::default();
        let problem = problem_of(&[], &rig(), &count);
        let base = Fitted::at(&problem, &Point { values: problem.template_values(), starts: Vec::new() });
        let (drag, spring) = (effect("quadratic-drag"), effect("torsional-spring"));
        let model = base.with(drag, &drag.starts[0]).unwrap().with(spring, &spring.starts[0]).unwrap();
        let stronger = base
            .with(drag, &drag.starts[0].map(|number| number + 1e-4))
            .unwrap()
            .with(spring, &spring.starts[0])
            .unwrap();
        let (rests, mut n_fits) = (Rests::default(), 0);
        let mut ask = |of: &Fitted, id: u16| {
            let levels = rests.levels(of, id, || {
                n_fits += 1;
                vec![of.without(id)]
            });
            let on_all = rests.on_all(of, id, || {
                n_fits += 1;
                Fitted { cost: f64::from(id), ..levels[0].clone() }
            });
            (levels[0].names(), on_all.cost, n_fits)
        };
        let (of_drag, of_spring) = (f64::from(drag.id), f64::from(spring.id));
        assert_eq!(ask(&model, drag.id), (vec![spring.name], of_drag, 2));
        assert_eq!(ask(&model, drag.id), (vec![spring.name], of_drag, 2));
        assert_eq!(ask(&model, spring.id), (vec![drag.name], of_spring, 4));
        assert_eq!(ask(&stronger, drag.id), (vec![spring.name], of_drag, 6));
        assert_eq!(ask(&Fitted { cost: 1.0, ..model.clone() }, drag.id), (vec![spring.name], of_drag, 8));
        assert_eq!(ask(&model, spring.id), (vec![drag.name], of_spring, 8));
    }
}
