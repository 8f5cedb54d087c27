//! Descents of a model from where it is: Ms and DV as they are, or along with the rest.

use super::descent::{Tolerance, descend};
use super::fitted::{Fitted, sort};
use super::linear::Steps;
use super::problem::{Problem, Unknown};
use crate::cores::on_all_cores;
use crate::swing::Window;
use shared::effect::Effect;
use shared::parameters::base;

impl Fitted {
    /// Fitted within a window, Ms and DV as they are.
    pub(super) fn descended(&self, on: &Problem, window: Window, tolerance: Tolerance) -> Self {
        let (problem, point) = (self.problem(on), self.point());
        let steps = self.steps.clone().unwrap_or_else(|| Steps::found(&problem, &point));
        self.after(descend(&problem, &point, window, tolerance, steps))
    }

    /// Fitted with Ms and DV among the unknowns, then with the ones found.
    pub(super) fn with_free_band(&self, on: &Problem, tolerance: Tolerance) -> Self {
        let mut all = self.clone();
        let stiction = Effect::by_id(base::STICTION);
        all.unknowns.extend(stiction.into_iter().flat_map(|effect| Unknown::all_of_effect(effect, &self.parameters)));
        all.steps = Some(Steps::new(&all.problem(on)));
        let all = all.descended(on, Window::Whole, tolerance);
        let found = Self { unknowns: self.unknowns.clone(), ..all };
        let steps = Some(Steps::new(&found.problem(on)));
        Self { steps, ..found.with_stiction(found.stiction()) }.descended(on, Window::Whole, tolerance)
    }
}

/// The best of some models on the swings of a problem. There must be one.
pub(super) fn best_on(on: &Problem, models: &[Fitted], tolerance: Tolerance) -> Fitted {
    let mut all: Vec<Fitted> = on_all_cores(models, |model| model.descended(on, Window::Whole, tolerance));
    sort(&mut all);
    all.swap_remove(0)
}
