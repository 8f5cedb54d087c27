//! Recordings that no one model follows, each of which one of its own follows far better.
//!
//! What differs between them is no law of the motion then: somebody set a brake, oiled the bearing or hung another pendulum.

use super::descent::Tolerance;
use super::fitted::Fitted;
use super::problem::{Point, Problem};
use super::refine::Band;
use crate::cores::on_all_cores;
use crate::verdict::hardly_follows;

/// One model each leaves less than this share of what one for all leaves: 0.4 of three runs between which a brake was set. Half and
/// twice of it were not tried.
const FAR_BETTER: f64 = 0.5;

/// The error (root mean square, rad) of one model for each recording, where one for all hardly follows them and these do far
/// better. Each is refined from the common one: a fit of its own may leave still less.
pub fn apart_rmse(on: &Problem, model: &Fitted) -> Option<f64> {
    if on.swings.len() < 2 || !hardly_follows(on.left_of_motion(model.cost)) {
        return None;
    }
    let values: Vec<f64> = on.unknowns.iter().map(|unknown| unknown.get(&model.parameters)).collect();
    let alone = |place: usize| {
        let own = on.on(&on.swings[place..place + 1]);
        let begun = Point { values: values.clone(), starts: vec![model.starts[place]] };
        Fitted::at(&own, &begun).refined(&own, Band::Held, Tolerance::JUDGE).cost
    };
    let cost: f64 = on_all_cores(0..on.swings.len(), alone).into_iter().sum();
    let [apart, together] = [cost, model.cost].map(|cost| on.rmse_rad(cost));
    (apart < FAR_BETTER * together).then_some(apart)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;
    use crate::swing::Swing;
    use shared::parameters::base;

    #[test]
    fn recordings_with_a_brake_that_was_set_between_them_are_followed_one_by_one() {
        let braked = |times: f64, seed: u64| {
            let mut rig = rig();
            let numbers = [base::COULOMB, base::STICTION].map(|id| (id, rig.values(id).unwrap().to_vec()));
            for (id, mut values) in numbers {
                values[0] *= times;
                rig.set(id, &values).unwrap();
            }
            simulated("swing", &rig, 14.0, seed)
        };
        let told = |times: &[f64]| {
            let swings: Vec<Swing> = times.iter().zip(1..).map(|(times, seed)| braked(*times, seed)).collect();
            let count = Tally::default();
            let problem = problem_of(&swings, &rig(), &count);
            apart_rmse(&problem, &fitted(&problem, &rig())).is_some()
        };
        assert!(told(&[1.0, 12.0, 40.0]));
        assert!(!told(&[1.0, 1.2, 1.4]) && !told(&[40.0]));
    }
}
