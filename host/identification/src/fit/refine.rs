//! The one operation that makes a better model of a fitted one: from where it is, on which samples, with which freedom
//! for Ms and DV, to which tolerance. On decimated swings it finds the way, on all of them it decides.

use super::descended::best_on;
use super::descent::{Termination, Tolerance};
use super::fitted::{Fitted, Stiction};
use super::problem::Problem;
use super::windows::CALMING;
use super::{stiction, stop_level};
use crate::swing::Window;
use crate::verdict::Left;

/// What becomes of Ms and DV.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Band {
    /// They stay as they are.
    Held,
    /// They are fitted along where there is a band, and stay where there is none.
    Free,
    /// They are searched ever finer around where they are.
    Near,
    /// Ms is searched; a band that is there may stay, none is sought.
    Level,
    /// Both are searched; no band stays that is not worth its numbers.
    Searched,
}

/// So many rounds of a descent at most. A drag of exponent 1.3 needed two, and grease that thins beside an eccentric sensor three; a
/// disc whose exponent had come to its bound crept on for all six. Half would do for the former two; twice was not tried.
const VALLEY_ROUNDS: usize = 6;

impl Fitted {
    /// This model, fitted on to the swings of a problem.
    pub fn refined(&self, on: &Problem, band: Band, tolerance: Tolerance) -> Self {
        match band {
            Band::Held => self.descended(on, Window::Whole, tolerance),
            Band::Free if self.has_band() => self.with_free_band(on, tolerance),
            Band::Free => self.descended(on, Window::Whole, tolerance),
            Band::Near => stiction::near(on, &stiction::tried(on, self, self.stiction(), tolerance), tolerance),
            Band::Level => on_all(on, &levels(&on.on(&on.decimated()), self)),
            Band::Searched => {
                let searched = stiction::searched(on, self, tolerance);
                if self.has_band() { self.descended(on, Window::Whole, tolerance).better(searched) } else { searched }
            }
        }
    }

    /// To where nothing moves any more: a search ends on the way where the numbers of a law lie in a curved valley, and
    /// ± are those of the lowest point. The base model has no such valley.
    pub fn settled(self, on: &Problem) -> Self {
        if self.effects.is_empty() {
            return self;
        }
        match on.chi_square(self.cost).left() {
            Left::Noise => self.led_along_its_valley(on),
            _ => self.refined(on, Band::Free, Tolerance::LAST).better(self),
        }
    }

    /// What explains the swings, in rounds as long as one still gains what is no chance: its numbers count.
    fn led_along_its_valley(self, on: &Problem) -> Self {
        let mut model = self;
        for _ in 0..VALLEY_ROUNDS {
            let led = model.refined(on, Band::Free, Tolerance::EXPLAINED);
            let goes_on = matches!(led.termination, Some(Termination::LostPatience | Termination::LeftValley));
            let gain = model.cost - led.cost;
            model = led.better(model);
            if !goes_on || gain < on.least_variance() {
                break;
            }
        }
        model
    }

    /// With its starts fitted and nothing else, the window growing: what the model is worth as it stands.
    pub fn started(&self, on: &Problem) -> Self {
        let fixed = Self { unknowns: Vec::new(), ..self.clone() };
        let started = fixed.regrown(on).descended(on, Window::Whole, Tolerance::FINE);
        Self { unknowns: self.unknowns.clone(), steps: None, ..started }
    }

    /// Fitted to all but the last swings before rest, Ms and DV as they are.
    pub fn lively(&self, on: &Problem, tolerance: Tolerance) -> Self {
        self.descended(on, Window::Lively, tolerance)
    }

    /// Begun anew with the first swings, on decimated ones: out of the side valley where a fit got stuck.
    pub fn regrown(&self, on: &Problem) -> Self {
        self.after(super::windows::grow(&self.problem(on), &self.point()))
    }

    /// Begun anew without Ms and DV, with the first swings, then with ever more of the last ones, on decimated ones: the turn
    /// at which dry friction stops the pendulum comes last, when all before it are followed. The cost is that of the last
    /// window.
    pub fn calmed(&self, on: &Problem) -> Self {
        let begin = self.with_stiction(Stiction::NONE).regrown(on);
        let decimated = on.decimated();
        let on = on.on(&decimated);
        let calm = |model: Self, share| model.descended(&on, Window::Calming(share), Tolerance::ROUGH);
        CALMING.into_iter().fold(begin, calm)
    }
}

/// A model on decimated swings with each stop level that may be the best on all of them, the best first. Never empty.
pub fn levels(decimated: &Problem, from: &Fitted) -> Vec<Fitted> {
    let levels = stop_level::levels(decimated, from);
    if from.has_band() {
        let with_band = from.refined(decimated, Band::Held, Tolerance::ROUGH);
        if with_band.cost <= levels[0].cost {
            return vec![with_band];
        }
    }
    levels
}

/// The best of some stop levels on all samples, until nothing moves.
pub fn on_all(on: &Problem, levels: &[Fitted]) -> Fitted {
    if levels[0].has_band() {
        return levels[0].refined(on, Band::Free, Tolerance::JUDGE);
    }
    best_on(on, levels, Tolerance::JUDGE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted, rig};
    use crate::fit::identify::problem_of;
    use crate::fit::own_swing::swing;
    use crate::fit::problem::{Quantity, Unknown};
    use crate::fit::tally::Tally;

    /// Strength and exponent of a drag make up for each other and for viscous and dry friction: 58 noise variances are left where
    /// one descent ends.
    #[test]
    fn a_law_that_explains_the_swings_is_led_to_the_end_of_its_valley() {
        let drag = |_: f64, velocity: f64| -2e-4 * velocity.abs().powf(1.3) * velocity.signum();
        let (swings, count) = ([1.8, 0.9, 0.4].map(|release_rad| swing(release_rad, drag)), Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let law = effect("power-law-drag");
        let begun = fitted(&problem, &rig()).with(law, &[1e-4, 1.8]).unwrap();
        // All but the exponent has answered.
        let is_exponent = |unknown: &Unknown| unknown.quantity == Quantity::Effect { id: law.id, index: 1 };
        let others = begun.unknowns.iter().filter(|unknown| !is_exponent(unknown)).cloned().collect();
        let held = Fitted { unknowns: others, ..begun.clone() }.refined(&problem, Band::Held, Tolerance::FINE);
        let far = Fitted { unknowns: begun.unknowns, steps: None, ..held };
        assert_eq!(problem.chi_square(far.cost).left(), Left::Noise);
        let settled = far.clone().settled(&problem);
        let once = far.refined(&problem, Band::Free, Tolerance::LAST);
        let further = settled.refined(&problem, Band::Free, Tolerance::EXPLAINED);
        let above = |model: &Fitted| (model.cost - further.cost) / problem.least_variance();
        assert!(above(&once) > 10.0 && above(&settled) < 0.5, "{} {}", above(&once), above(&settled));
    }
}
