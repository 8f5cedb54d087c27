//! Missing torque over angle and velocity, and how well it is known.

use super::milli;
use crate::compare::Comparison;
use crate::compare::grid::N_BINS;
use crate::compare::torque::{Bin, TorqueMap};
use crate::compare::verdict::Answer;
use crate::plot::{Axis, Content, Heat, Picture};

pub(super) fn pictures(comparison: &Comparison) -> Vec<Picture> {
    let Some(map) = &comparison.torque else { return Vec::new() };
    let is_noise = comparison.answer == Answer::NothingMissing;
    vec![torque(map, is_noise), significance(map)]
}

fn torque(map: &TorqueMap, is_noise: bool) -> Picture {
    let compared = match map.coulomb_nm {
        coulomb_nm if coulomb_nm > 0.0 => format!(" For comparison: Mc is {:.2} mN·m.", milli(coulomb_nm)),
        _ => String::new(),
    };
    let found = match (map.is_significant, is_noise) {
        (true, _) => "There is more in it than chance.",
        (false, true) => "Nothing in it is beyond chance: read nothing into the colours.",
        (false, false) => {
            "More than noise is left, but no field of this map is certain: what is missing does not show as a torque of \
             angle and velocity, or the numbers do not fit yet."
        }
    };
    Picture {
        key: "torque".to_owned(),
        title: "Missing torque over angle and velocity".to_owned(),
        explanation: format!(
            "Which torque would have to be added to the model, at each angle and velocity, to explain the measurement: \
             red pushes counter-clockwise, blue clockwise, white is nothing. Friction that is too small in the model \
             is blue above and red below; a spring is red on one side and blue on the other. {found}{compared} Found \
             by integrating the equation of motion over short windows, so that no noisy derivative is needed."
        ),
        x: Axis::linear("angle in rad"),
        y: Axis::linear("velocity in rad/s"),
        content: Content::Heat(heat(map, "mN·m", milli(limit(map)), |bin| milli(bin.torque_nm))),
    }
}

fn significance(map: &TorqueMap) -> Picture {
    Picture {
        key: "torque-certainty".to_owned(),
        title: "How certain the missing torque is".to_owned(),
        explanation:
            "The same map in units of its standard error, which grows where the pendulum rarely comes. Within \
                      ± 3 it may well be chance; point at a field to see its value, its error and how many swings \
                      passed it."
                .to_owned(),
        x: Axis::linear("angle in rad"),
        y: Axis::linear("velocity in rad/s"),
        content: Content::Heat(heat(map, "torque / error", 10.0, |bin| bin.torque_nm / bin.spread_nm)),
    }
}

/// Colours go as far as nine of ten well-visited fields, so that a few uncertain ones do not bleach the rest, and at
/// least as far as chance goes, so that nothing looks like something.
fn limit(map: &TorqueMap) -> f64 {
    let well_visited = || map.bins.iter().filter(|bin| bin.n_visits >= WELL_VISITED);
    let at_share = |mut values: Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values.get((share * values.len() as f64) as usize).copied().unwrap_or(map.largest_nm())
    };
    let size_nm = at_share(well_visited().map(|bin| bin.torque_nm.abs()).collect(), 0.9);
    let chance_nm = CHANCE * at_share(well_visited().map(|bin| bin.spread_nm).collect(), 0.5);
    size_nm.max(chance_nm).max(1e-12)
}

/// Chance reaches about this many standard errors somewhere.
const CHANCE: f64 = 4.0;

/// Swings through a field from which on its colour counts.
const WELL_VISITED: usize = 5;

fn heat(map: &TorqueMap, label: &str, limit: f64, value: impl Fn(&Bin) -> f64) -> Heat {
    let mut values = vec![vec![None; N_BINS]; N_BINS];
    let mut notes = vec![vec![String::new(); N_BINS]; N_BINS];
    for bin in &map.bins {
        let (row, column) = (bin.place / N_BINS, bin.place % N_BINS);
        values[row][column] = Some(value(bin));
        notes[row][column] = format!(
            "{:+.3} ± {:.3} mN·m, {} swings, {} samples",
            milli(bin.torque_nm),
            milli(bin.spread_nm),
            bin.n_visits,
            bin.n_samples
        );
    }
    Heat {
        x: (0..N_BINS).map(|k| map.grid.centre(k).0).collect(),
        y: (0..N_BINS).map(|k| map.grid.centre(k * N_BINS).1).collect(),
        names: None,
        values,
        notes,
        label: label.to_owned(),
        limit,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::grid::Grid;

    #[test]
    fn a_field_shows_its_torque_in_standard_errors_where_it_lies() {
        let (angle_rad, velocity_rad_s) = (0.1, 0.5);
        let bin = Bin {
            place: 2 * N_BINS + 3,
            angle_rad,
            velocity_rad_s,
            torque_nm: -7e-4,
            spread_nm: 2e-4,
            n_visits: 6,
            n_samples: 50,
        };
        let map = TorqueMap {
            grid: Grid { angle_rad: 1.2, velocity_rad_s: 6.0 },
            bins: vec![bin],
            coulomb_nm: 1e-3,
            evidence: 0.0,
            explained: 0.0,
            is_significant: false,
        };
        let Content::Heat(heat) = significance(&map).content else { panic!("no map") };
        assert!((heat.values[2][3].unwrap() + 3.5).abs() < 1e-12);
        assert_eq!(heat.values.iter().flatten().flatten().count(), 1);
        assert_eq!(heat.notes[2][3], "-0.700 ± 0.200 mN·m, 6 swings, 50 samples");
    }
}
