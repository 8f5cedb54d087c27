//! How well a fitted friction curve is known, and on which parts of the swings it is the same: the torques at its knots
//! from windows as clusters ([`super::clusters`]), each with its share of the ridge.

use super::clusters::{Cluster, Sums, clusters, spread_of};
use super::curve::Curved;
use super::problem::Problem;
use crate::swing::{Swing, Window};
use nalgebra::DVector;

/// A part tells a knot if it has this share of what all swings tell of it; below, it is the ridge that speaks.
const TOLD: f64 = 0.03;

/// The same torque on two parts differs if it does by so many of their standard deviations together; a curve has about
/// six independent stretches, one of which is beyond 2.6 by chance in 5 % of the recordings.
const DIFFERS: f64 = 2.6;

/// The torques at the knots as a part of the swings has them.
#[derive(Clone, Debug)]
pub struct PartCurve {
    /// The large or the small swings, or the release's name.
    pub name: String,
    /// Torque and standard deviation at each knot, N·m; `None` where the part tells neither.
    pub knots: Vec<Option<(f64, f64)>>,
}

/// A friction curve on the parts of the swings.
#[derive(Clone, Debug)]
pub struct Known {
    /// Standard deviations at the knots, N·m; `None` where a single window tells a torque.
    pub stds: Vec<Option<f64>>,
    /// Parts to be compared with each other: large and small swings; each release.
    pub parts: Vec<Vec<PartCurve>>,
    /// How many clusters there are.
    pub n_windows: usize,
}

impl Known {
    /// The knots at which two parts contradict each other, and which.
    pub fn contradictions(&self) -> Vec<(usize, &str, &str)> {
        let mut found = Vec::new();
        let pairs = self.parts.iter().flat_map(|like| {
            like.iter().enumerate().flat_map(|(i, one)| like[i + 1..].iter().map(move |other| (one, other)))
        });
        for (one, other) in pairs {
            for (knot, pair) in one.knots.iter().zip(&other.knots).enumerate() {
                if let (Some((a, a_std)), Some((b, b_std))) = pair
                    && (a - b).abs() > DIFFERS * a_std.hypot(*b_std)
                {
                    found.push((knot, one.name.as_str(), other.name.as_str()));
                }
            }
        }
        found
    }
}

/// What the windows say of a fitted curve.
pub fn known(on: &Problem, curved: &Curved) -> Option<Known> {
    let problem = curved.model.problem(on);
    let first = problem.knots()?.start;
    let torques = curved.model.parameters.curve.as_ref()?.torques_nm().to_vec();
    let linear = curved.model.linearised(on);
    let is_knot = |j: usize| (first..first + torques.len()).contains(&j);
    let clusters = clusters(on, &linear, &curved.model.starts, is_knot);
    let all: Vec<Sums> = clusters.iter().map(Cluster::sums).collect();
    let told: Vec<f64> =
        (0..torques.len()).map(|k| all.iter().map(|sums| sums.matrix[(first + k, first + k)]).sum()).collect();
    let ridge = ridge(on, curved, first, &torques, all.first()?.gradient.len());
    let with_ridge = |part: &[Sums]| -> Vec<Sums> {
        part.iter().map(|sums| with_share(sums, &ridge, 1.0 / all.len() as f64)).collect()
    };
    let part = |name: String, sums: &[Sums]| -> Option<PartCurve> {
        let spread = spread_of(&with_ridge(sums))?;
        let knot = |k: usize| {
            let here: f64 = sums.iter().map(|sums| sums.matrix[(first + k, first + k)]).sum();
            let std = spread.stds[first + k].filter(|_| here > TOLD * told[k])?;
            Some((torques[k] + spread.step[first + k], std))
        };
        Some(PartCurve { name, knots: (0..torques.len()).map(knot).collect() })
    };
    let of_swing = |idx: usize| -> Vec<Sums> {
        clusters.iter().filter(|cluster| cluster.swing_idx == idx).map(Cluster::sums).collect()
    };
    let swings: Vec<Vec<Sums>> = (0..on.swings.len()).map(of_swing).collect();
    let (large, small) = large_and_small(on, &swings);
    let halves = [part("the large swings".to_owned(), &large), part("the small swings".to_owned(), &small)];
    let mut parts = vec![halves.into_iter().flatten().collect()];
    if swings.len() > 1 {
        let releases = swings.iter().zip(on.swings).map(|(own, swing)| part(swing.name.clone(), own));
        parts.push(releases.flatten().collect());
    }
    let whole = spread_of(&with_ridge(&all))?;
    let stds = (0..torques.len()).map(|k| whole.stds[first + k]).collect();
    Some(Known { stds, parts, n_windows: all.len() })
}

/// The sums of a cluster with its share of the ridge.
fn with_share(sums: &Sums, ridge: &Sums, share: f64) -> Sums {
    Sums { matrix: &sums.matrix + share * &ridge.matrix, gradient: &sums.gradient + share * &ridge.gradient }
}

/// The ridge as normal equations of so many numbers, the knots from `first` on.
fn ridge(on: &Problem, curved: &Curved, first: usize, torques_nm: &[f64], size: usize) -> Sums {
    let weighted = curved.ridge.weighted(on.n_samples(Window::Whole));
    let n_knots = torques_nm.len();
    let mut sums = Sums::zeros(size);
    sums.matrix.view_mut((first, first), (n_knots, n_knots)).copy_from(&weighted);
    sums.gradient.rows_mut(first, n_knots).copy_from(&-(weighted * DVector::from_column_slice(torques_nm)));
    sums
}

/// The sums of the larger swings and those of the smaller ones: at the same speed they are at another angle, and
/// earlier. Where each release is one cluster, the larger releases and the others.
fn large_and_small(on: &Problem, swings: &[Vec<Sums>]) -> (Vec<Sums>, Vec<Sums>) {
    if swings.iter().any(|own| own.len() > 1) {
        let large = swings.iter().flat_map(|own| own[..own.len() / 2].to_vec()).collect();
        return (large, swings.iter().flat_map(|own| own[own.len() / 2..].to_vec()).collect());
    }
    let mut by_size: Vec<(f64, &Vec<Sums>)> = on.swings.iter().map(Swing::largest_rad).zip(swings).collect();
    by_size.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut all: Vec<Sums> = by_size.into_iter().flat_map(|(_, own)| own.clone()).collect();
    let small = all.split_off(all.len() / 2);
    (all, small)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn parts_contradict_each_other_where_they_differ_by_more_than_their_errors() {
        let part =
            |name: &str, knots: &[Option<(f64, f64)>]| PartCurve { name: name.to_owned(), knots: knots.to_vec() };
        // Errors of 3 and 4 make one of 5, of which 2.6 are 13.
        let one = part("one", &[Some((100.0, 3.0)), Some((100.0, 3.0)), Some((100.0, 3.0)), None]);
        let other = part("other", &[Some((112.9, 4.0)), Some((113.1, 4.0)), Some((86.9, 4.0)), Some((0.0, 4.0))]);
        let known = Known { stds: Vec::new(), parts: vec![vec![one.clone(), other.clone()], vec![one]], n_windows: 2 };
        assert_eq!(known.contradictions(), [(1, "one", "other"), (2, "one", "other")]);
    }

    #[test]
    fn all_clusters_together_have_the_whole_ridge() {
        let sums =
            |x: f64| Sums { matrix: DMatrix::from_element(2, 2, x), gradient: DVector::from_element(2, 10.0 * x) };
        let clusters = [sums(1.0), sums(2.0), sums(4.0), sums(8.0)];
        let mut all = Sums::zeros(2);
        clusters.iter().for_each(|cluster| all.add(&with_share(cluster, &sums(100.0), 0.25)));
        assert_eq!((all.matrix[(0, 1)], all.gradient[1]), (115.0, 1150.0));
    }
}
