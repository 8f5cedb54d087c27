//! Nelder–Mead in the coded box: climbs without derivatives, its simplex stretching along ridges.
//!
//! Points beyond the box are moved to its face, which can flatten the simplex too early, so every end is a new start:
//! a fresh simplex, turned at random and smaller each time it brings nothing, until even a small one finds nothing
//! better.
//! Source: J. A. Nelder, R. Mead, Comput. J. 7 (1965) 308, with the usual coefficients 1, 2, ½, ½.

use super::random::Random;

/// Edge of the first simplex, coded units; a quarter of the box.
const FIRST_EDGE: f64 = 0.5;
/// A fresh simplex that brought nothing is followed by one this much smaller.
const SMALLER: f64 = 0.2;
/// Moves after which a simplex is replaced, for each factor; a healthy one ends much sooner.
const LONGEST_CLIMB: usize = 400;

/// A point of the box with its merit.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The point in coded units.
    pub point: Vec<f64>,
    /// What is being maximised.
    pub merit: f64,
}

/// Climbs from a start until no simplex with edges above `smallest_edge` (coded units, above 0) finds a better point.
pub fn climb(
    start: Candidate,
    smallest_edge: f64,
    random: &mut Random,
    judged: impl Fn(Vec<f64>) -> Candidate,
) -> Candidate {
    let (mut best, mut edge) = (start, FIRST_EDGE);
    while edge > smallest_edge {
        let reached = Simplex::about(&best, edge, random, &judged).climbed(smallest_edge, &judged);
        if reached.merit > best.merit {
            let moved = distance(&reached.point, &best.point);
            edge = edge.min(moved.max(SMALLER * edge));
            best = reached;
        } else {
            edge *= SMALLER;
        }
    }
    best
}

/// One corner more than there are factors, best first.
struct Simplex {
    corners: Vec<Candidate>,
}

impl Simplex {
    /// The best point and one neighbour along each of randomly turned axes, each pointing into the box.
    fn about(best: &Candidate, edge: f64, random: &mut Random, judged: impl Fn(Vec<f64>) -> Candidate) -> Self {
        let axes = random.turned_axes(best.point.len());
        let neighbour = |axis: &Vec<f64>| {
            let [ahead, behind] = [edge, -edge].map(|step| inside(&best.point, axis, step));
            let farther = distance(&ahead, &best.point) >= distance(&behind, &best.point);
            judged(if farther { ahead } else { behind })
        };
        let corners = std::iter::once(best.clone()).chain(axes.iter().map(neighbour)).collect();
        Self { corners }.sorted()
    }

    fn climbed(mut self, smallest_edge: f64, judged: impl Fn(Vec<f64>) -> Candidate) -> Candidate {
        for _ in 0..LONGEST_CLIMB * self.corners.len() {
            if self.size() < smallest_edge {
                break;
            }
            self = self.moved(&judged).sorted();
        }
        self.corners.swap_remove(0)
    }

    /// Replaces the worst corner by a better one, or draws all corners towards the best.
    fn moved(mut self, judged: impl Fn(Vec<f64>) -> Candidate) -> Self {
        let worst = self.corners.pop().expect("a simplex has corners");
        let centre = self.centre();
        let away: Vec<f64> = centre.iter().zip(&worst.point).map(|(centre, worst)| centre - worst).collect();
        let at = |step: f64| judged(inside(&centre, &away, step));
        let reflected = at(1.0);
        let second_worst = self.corners[self.corners.len() - 1].merit;
        let replacement = if reflected.merit > self.corners[0].merit {
            better(at(2.0), reflected)
        } else if reflected.merit > second_worst {
            reflected
        } else if reflected.merit > worst.merit {
            better(at(0.5), reflected)
        } else {
            at(-0.5)
        };
        let improved = replacement.merit > worst.merit;
        self.corners.push(if improved { replacement } else { worst });
        if improved { self } else { self.drawn_together(judged) }
    }

    fn drawn_together(mut self, judged: impl Fn(Vec<f64>) -> Candidate) -> Self {
        let best = self.corners[0].point.clone();
        for corner in &mut self.corners[1..] {
            *corner = judged(best.iter().zip(&corner.point).map(|(best, value)| 0.5 * (best + value)).collect());
        }
        self
    }

    fn centre(&self) -> Vec<f64> {
        let mean = |idx: usize| self.corners.iter().map(|corner| corner.point[idx]).sum::<f64>();
        (0..self.corners[0].point.len()).map(|idx| mean(idx) / self.corners.len() as f64).collect()
    }

    fn size(&self) -> f64 {
        self.corners[1..].iter().map(|corner| distance(&corner.point, &self.corners[0].point)).fold(0.0, f64::max)
    }

    fn sorted(mut self) -> Self {
        self.corners.sort_by(|a, b| b.merit.total_cmp(&a.merit));
        self
    }
}

fn better(first: Candidate, second: Candidate) -> Candidate {
    if first.merit > second.merit { first } else { second }
}

fn inside(from: &[f64], direction: &[f64], step: f64) -> Vec<f64> {
    from.iter().zip(direction).map(|(value, part)| (value + step * part).clamp(-1.0, 1.0)).collect()
}

/// The largest difference in any one factor.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn climbed(n_factors: usize, merit: impl Fn(&[f64]) -> f64) -> Candidate {
        let judged = |point: Vec<f64>| Candidate { merit: merit(&point), point };
        climb(judged(vec![0.0; n_factors]), 1e-8, &mut Random::new(1), judged)
    }

    #[test]
    fn a_sharp_ridge_is_followed_to_its_top() {
        let top = climbed(2, |x| -(x[0] - 0.7).abs() - 300.0 * (x[1] - 0.5 * x[0]).abs());
        assert!((top.point[0] - 0.7).abs() < 1e-6, "{top:?}");
    }

    #[test]
    fn a_corner_of_the_box_is_reached_in_six_factors() {
        let top = climbed(6, |x| x.iter().enumerate().map(|(idx, value)| (idx + 1) as f64 * value).sum());
        assert!(top.point.iter().all(|value| 1.0 - value < 1e-7), "{top:?}");
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        let top = climbed(2, |x| -100.0 * (x[1] - x[0] * x[0]).powi(2) - (0.9 - x[0]).powi(2));
        assert!((top.point[0] - 0.9).abs() < 1e-6 && (top.point[1] - 0.81).abs() < 1e-6, "{top:?}");
    }
}
