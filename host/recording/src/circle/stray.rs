//! Where a tracker followed something else for a while: that must not spoil the circle of the other points.
//!
//! In: points that lie on no circle. Out: those on the circle about which half of them lie closest (least median of squares,
//! P. J. Rousseeuw, J. Am. Stat. Assoc. 79 (1984) 871). A view that is not square to the swing bends what is kept too: of 200
//! such arcs, bent by 1 to 50 %, none became a circle by that. Nor does a heap: points that scatter as far from their circle as a
//! slanted view may be off it are not told from those that stray.

use super::{MOST_OFF, fitted, mean_distance};
use crate::median;
use crate::noise::MEDIAN_SIZE;

/// Circles through three points that are tried. With two thirds of the points on the circle three in ten are of such alone, with a
/// half one in eight. Half and twice were not tried.
const TRIED: usize = 200;

/// Points that decide between those.
const MOST_DECIDING: usize = 500;

/// A point belongs to the circle within so many standard deviations, as the median has them: of 10,000 noisy ones none is farther by
/// chance, and a stray one is by far. Half and twice were not tried.
const BELONGS: f64 = 5.0;

/// Rounds in which the circle and its points find each other.
const N_ROUNDS: usize = 5;

/// The points of one circle without those that stray from it; `None` if none do, or half of them.
pub(super) fn without_strays(points: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let (mut centre, mut radius) = closest_to_half(points)?;
    let (mut belong, mut limit) = (Vec::new(), 0.0);
    for _ in 0..N_ROUNDS {
        let off = |[x, y]: &[f64; 2]| ((x - centre[0]).hypot(y - centre[1]) - radius).abs();
        limit = BELONGS * median(&mut points.iter().map(off).collect::<Vec<f64>>()) / MEDIAN_SIZE;
        belong = points.iter().map(|point| off(point) <= limit).collect::<Vec<bool>>();
        (centre, radius, _) = fitted(&chosen(points, &belong))?;
    }
    let kept = chosen(points, &belong);
    // A heap of points lies about any circle as near as this.
    let are_told_apart = limit < BELONGS * MOST_OFF * radius;
    (are_told_apart && kept.len() < points.len() && 2 * kept.len() > points.len()).then_some(kept)
}

fn chosen(points: &[[f64; 2]], belong: &[bool]) -> Vec<[f64; 2]> {
    points.iter().zip(belong).filter(|(_, belongs)| **belongs).map(|(point, _)| *point).collect()
}

/// Of circles through three points each the one that half of all lie closest to.
fn closest_to_half(points: &[[f64; 2]]) -> Option<([f64; 2], f64)> {
    let n = points.len();
    let deciding: Vec<&[f64; 2]> = points.iter().step_by(n.div_ceil(MOST_DECIDING).max(1)).collect();
    // Low-discrepancy places: repeatable, and three of them are never the same.
    let place = |k: usize, ratio: f64| ((k as f64 * ratio).fract() * n as f64) as usize;
    let tried = (1..=TRIED).filter_map(|k| {
        let three = [place(k, 0.819_172_5), place(k, 0.671_043_6), place(k, 0.549_700_5)].map(|idx| points[idx]);
        let centre = about(&three)?;
        let radius = mean_distance(&three, centre);
        let off = |[x, y]: &&[f64; 2]| ((x - centre[0]).hypot(y - centre[1]) - radius).abs();
        Some((median(&mut deciding.iter().map(off).collect::<Vec<f64>>()), centre, radius))
    });
    tried.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, centre, radius)| (centre, radius))
}

/// The centre of the circle through three points.
fn about(three: &[[f64; 2]; 3]) -> Option<[f64; 2]> {
    let [[ax, ay], [bx, by], [cx, cy]] = *three;
    let twice_area = 2.0 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax));
    let (b, c) = ((bx - ax).hypot(by - ay).powi(2), (cx - ax).hypot(cy - ay).powi(2));
    let centre = [ax + ((cy - ay) * b - (by - ay) * c) / twice_area, ay + ((bx - ax) * c - (cx - ax) * b) / twice_area];
    centre.iter().all(|value| value.is_finite()).then_some(centre)
}

#[cfg(test)]
mod tests {
    use super::super::Circle;
    use super::*;

    /// Points of a swing of so many half swings on a circle of radius 200, which a slanted view may squeeze; a stretch of them
    /// elsewhere.
    fn seen(half_swings: f64, squeeze: f64, elsewhere: std::ops::Range<usize>) -> Vec<[f64; 2]> {
        let mut noise = crate::random::Noise::new(1);
        let mut point = |idx: usize| {
            let angle = 1.4 * (half_swings * std::f64::consts::PI * idx as f64 / 1000.0).cos();
            let at = if elsewhere.contains(&idx) {
                [420.0, 180.0]
            } else {
                [300.0 + squeeze * 200.0 * angle.sin(), 100.0 + 200.0 * angle.cos()]
            };
            at.map(|place| place + noise.normal())
        };
        (0..1000).map(&mut point).collect()
    }

    fn through(points: &[[f64; 2]]) -> Option<Circle> {
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|[x, y]| (*x, *y)).unzip();
        Circle::through(&x, &y, None).ok()
    }

    #[test]
    fn a_tracker_that_followed_something_else_for_a_while_spoils_no_circle() {
        for (half_swings, elsewhere) in [(8.0, 300..550), (21.0, 700..1000), (60.0, 0..150)] {
            let points = seen(half_swings, 1.0, elsewhere.clone());
            let circle = through(&points).unwrap();
            assert!((circle.radius - 200.0).abs() < 1.0 && (circle.y - 100.0).abs() < 1.0, "{circle:?}");
            assert!((circle.stray - elsewhere.len() as f64 / 1000.0).abs() < 0.02, "{circle:?}");
            assert!(circle.in_words().contains("of the points lie somewhere else"), "{}", circle.in_words());
        }
    }

    /// As two of the angles of a sensor that a hand turns now and then: half of them in a heap, and of the ways from it some near a circle.
    #[test]
    fn a_heap_is_no_circle_however_few_of_it_stray() {
        let mut noise = crate::random::Noise::new(7);
        let mut point = |idx: usize| {
            let [kind, turn] = [0.618_034, 0.754_877_7].map(|step| (idx as f64 * step).fract());
            let [a, b] = [noise.normal(), noise.normal()];
            let (angle, radius) = (4.4 * (turn - 0.5), 90.0 + 5.0 * a);
            match kind {
                kind if kind < 0.5 => [2.0 * a, 2.0 * b],
                kind if kind < 0.8 => [90.0 - radius * angle.cos(), radius * angle.sin()],
                _ => [150.0 * a, 150.0 * b],
            }
        };
        let points: Vec<[f64; 2]> = (0..1000).map(&mut point).collect();
        assert!(through(&points).is_none(), "{:?}", through(&points));
    }

    #[test]
    fn a_slanted_view_is_refused_whatever_is_left_out() {
        for squeeze in [0.5, 0.6, 0.7, 0.8] {
            assert!(through(&seen(21.0, squeeze, 0..0)).is_none(), "{squeeze}");
        }
        assert_eq!(without_strays(&seen(21.0, 1.0, 0..0)), None);
    }
}
