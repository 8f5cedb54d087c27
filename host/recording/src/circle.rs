//! The circle on which a point of the pendulum moves, in a video's x and y: its centre is the pivot.
//!
//! An algebraic circle (I. Kåsa, IEEE Trans. Instrum. Meas. 25 (1976) 8) begins, Gauss–Newton on the distances ends.
//! Down is where the points are, so pixels that count from the top are as good as metres that count from below.
//! A short arc tells little of its centre, and a picture that is bent a little moves it far: there the origin of x and y is
//! the pivot if all points are equally far from it, where people who follow a point in a video like to put it.

mod stray;

use super::error::Fault;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Points that are used for the circle.
const MOST_POINTS: usize = 5000;

/// Rounds of Gauss–Newton; a few suffice.
const N_ROUNDS: usize = 30;

/// Stretches of the arc over which distances from the circle are averaged.
const N_STRETCHES: usize = 16;

/// A camera that is not square to the swing shows an ellipse; from this share of the radius on the angles are wrong by
/// some percent …
const MOST_OFF: f64 = 0.015;

/// … and from this on it is worth a word.
const NOTED_OFF: f64 = 0.004;

/// The radius, and with it every angle, must be known to this share.
const MOST_SPREAD: f64 = 0.02;

/// Pictures are bent by this share of the width of an arc: lenses, and cameras that are not square to the swing. Of an arc
/// of 0.1 rad to either side, bent by 0.7 %, the radius came out 42 % too large; most pictures are bent by some tenths.
const BENT: f64 = 0.003;

/// From this share of the radius on that doubt is worth a word: friction that does not grow as the speed does is wrong by
/// as much.
const NOTED_BENT: f64 = 0.05;

/// An arc shows itself where it explains more than this share of how y scatters: of an angle's rate or of a second sensor
/// whose scale is bent it explains a hundredth, …
const ARC_EXPLAINS: f64 = 0.05;

/// … and so many times as much as one number explains by chance.
const ARC_STANDS_OUT: f64 = 30.0;

/// Standard gravity, m/s².
const GRAVITY_M_S2: f64 = 9.80665;

/// A period tells a radius in metres to this share: what is not in the bob, and air and finger at the string, change it by some
/// percent. With half of it two of the six strings of a student would not count (27 and 76 cm, off by 7 and 6 %); of radii in other
/// units, over two decades, one of 23 lies so near by chance, and with twice of it one of 12.
const PERIOD_TELLS: f64 = 0.1;

/// A circle through the points.
#[derive(Debug)]
pub(super) struct Circle {
    x: f64,
    y: f64,
    radius: f64,
    /// Typical distance of the averaged points from it, as a share of the radius.
    off: f64,
    /// +1 where y counts upwards, −1 where it counts downwards.
    up: f64,
    /// Its centre is that of x and y, and the arc would not have told it.
    is_about_origin: bool,
    /// The circle of the arc itself then, if its radius is another one.
    arc: Option<Box<Self>>,
    /// Small swings hang by the radius of the arc in metres, not by this one.
    period_tells_arc: bool,
    /// By which share of the radius a bent picture may move its centre, if that was not told.
    doubt: f64,
    /// Share of the points that lie somewhere else and tell nothing of it.
    stray: f64,
}

impl Circle {
    /// Fits the circle; with a known pivot only its radius.
    pub(super) fn through(x: &[f64], y: &[f64], pivot: Option<[f64; 2]>) -> Result<Self, Fault> {
        let every = x.len().div_ceil(MOST_POINTS).max(1);
        let points: Vec<[f64; 2]> = x.iter().zip(y).step_by(every).map(|(x, y)| [*x, *y]).collect();
        let whole = Self::of(&points, pivot);
        let without_strays = || {
            let kept = stray::without_strays(&points)?;
            let stray = 1.0 - kept.len() as f64 / points.len() as f64;
            Some(Self { stray, ..Self::of(&kept, pivot).ok()? })
        };
        whole.or_else(|fault| without_strays().ok_or(fault))
    }

    fn of(points: &[[f64; 2]], pivot: Option<[f64; 2]>) -> Result<Self, Fault> {
        if let Some(pivot) = pivot {
            return Self::about(pivot, mean_distance(points, pivot), points).unless_off();
        }
        let short = |spread: f64| Fault::ShortArc {
            spread_percent: 100.0 * spread,
            off_origin_percent: Self::nearly_about_origin(points).map(|circle| 100.0 * circle.off),
        };
        let found = fitted(points);
        let circle = found.map(|(centre, radius, spread)| (Self::about(centre, radius, points), spread));
        let spread = circle.as_ref().map_or(1.0, |(circle, spread)| spread.hypot(circle.bent(points)));
        if spread > MOST_SPREAD
            && let Some(about_origin) = Self::about_origin(points)
        {
            let is_other = |arc: &Self| (arc.radius / about_origin.radius - 1.0).abs() > NOTED_BENT;
            let arc = circle.map(|(circle, _)| circle).filter(is_other);
            return Ok(Self { arc: arc.map(Box::new), ..about_origin });
        }
        match circle {
            None => Err(short(1.0)),
            Some((_, spread)) if spread > MOST_SPREAD => Err(short(spread)),
            Some((circle, _)) => Self { doubt: circle.bent(points), ..circle }.unless_off(),
        }
    }

    fn about(centre: [f64; 2], radius: f64, points: &[[f64; 2]]) -> Self {
        let mean_y = points.iter().map(|point| point[1]).sum::<f64>() / points.len().max(1) as f64;
        let up = if mean_y < centre[1] { 1.0 } else { -1.0 };
        let circle = Self {
            x: centre[0],
            y: centre[1],
            radius,
            off: 0.0,
            up,
            is_about_origin: false,
            arc: None,
            period_tells_arc: false,
            doubt: 0.0,
            stray: 0.0,
        };
        Self { off: circle.typical_distance(points), ..circle }
    }

    /// The circle about the origin of x and y, where the points lie on it to either side of straight below.
    fn about_origin(points: &[[f64; 2]]) -> Option<Self> {
        let circle = Self::nearly_about_origin(points).filter(|circle| circle.off < NOTED_OFF)?;
        Some(Self { is_about_origin: true, ..circle })
    }

    /// The same where the points lie near it, but not so near that nobody needs to say so.
    fn nearly_about_origin(points: &[[f64; 2]]) -> Option<Self> {
        let circle = Self::about([0.0; 2], mean_distance(points, [0.0; 2]), points);
        let (low, high) = circle.ends(points);
        (circle.off < MOST_OFF && low < 0.0 && high > 0.0 && high.max(-low) < FRAC_PI_2).then_some(circle)
    }

    fn ends(&self, points: &[[f64; 2]]) -> (f64, f64) {
        let angles = points.iter().map(|[x, y]| self.angle_rad(*x, *y));
        angles.fold((f64::MAX, f64::MIN), |(low, high), angle| (low.min(angle), high.max(angle)))
    }

    /// The share of the radius by which a bent picture moves it: that of its width, over how deep the arc sags.
    fn bent(&self, points: &[[f64; 2]]) -> f64 {
        let (low, high) = self.ends(points);
        let half_rad = (high - low) / 2.0;
        BENT * 2.0 * half_rad.sin() / (1.0 - half_rad.cos()).max(f64::MIN_POSITIVE)
    }

    /// The same without its doubt where small swings of that period (s) hang by this radius in metres, and by that of the arc not
    /// half as well. The other way round that makes the doubt larger, but rods swing as longer strings do.
    pub(super) fn unless_period_tells(self, period_s: f64) -> Self {
        let told = GRAVITY_M_S2 * (period_s / TAU).powi(2);
        let off = |circle: &Self| (circle.radius / told).ln().abs();
        let Some(arc) = &self.arc else { return self };
        let [off_origin, off_arc] = [off(&self), off(arc)];
        match off_origin < PERIOD_TELLS.min(off_arc / 2.0) {
            true => Self { arc: None, ..self },
            false => Self { period_tells_arc: off_arc < PERIOD_TELLS.min(off_origin / 2.0), ..self },
        }
    }

    fn unless_off(self) -> Result<Self, Fault> {
        let circle = self;
        if circle.off > MOST_OFF {
            return Err(Fault::NoCircle { off_percent: 100.0 * circle.off });
        }
        Ok(circle)
    }

    /// Angles of the points, rad: 0 straight below the centre, counter-clockwise positive.
    pub(super) fn angles_rad(&self, x: &[f64], y: &[f64]) -> Vec<f64> {
        x.iter().zip(y).map(|(x, y)| self.angle_rad(*x, *y)).collect()
    }

    fn angle_rad(&self, x: f64, y: f64) -> f64 {
        (x - self.x).atan2(self.up * (self.y - y))
    }

    /// What was found, for a person.
    pub(super) fn in_words(&self) -> String {
        let Self { x, y, radius, off, up, is_about_origin, arc, period_tells_arc, doubt, stray } = self;
        let way = if *up > 0.0 { "up" } else { "down" };
        let so_far = if *off > NOTED_OFF {
            format!("; the points are {:.1} % of it off, as when the camera is not square to the swing", 100.0 * off)
        } else if *is_about_origin {
            let arc_itself = |arc: &Self| {
                format!(
                    "; doubtful, the arc by itself would have a radius of {:.4}{}, and every angle would be {:.2} times as \
                     large: --pivot X,Y says where the pivot is, --pivot={:.4},{:.4} that of the arc",
                    arc.radius,
                    if *period_tells_arc { ", which is that of a string with this period in metres" } else { "" },
                    self.radius / arc.radius,
                    arc.x,
                    arc.y
                )
            };
            let doubt = arc.as_deref().map_or(String::new(), arc_itself);
            format!(", the origin of x and y, from which all points are equally far{doubt}")
        } else if *doubt > NOTED_BENT {
            format!(
                "; doubtful, the arc is short: a picture bent by {} % of its width moves the radius, and with it every \
                 angle, by {:.0} %; --pivot X,Y says where the pivot is",
                100.0 * BENT,
                100.0 * doubt
            )
        } else {
            String::new()
        };
        let without = match stray {
            0.0 => String::new(),
            share => format!(
                "; {:.0} % of the points lie somewhere else, as where a tracker followed something else, and tell nothing of it",
                100.0 * share
            ),
        };
        format!("angles from x and y, y counting {way}: pivot at ({x:.4}, {y:.4}), radius {radius:.4}{so_far}{without}")
    }

    /// Of the means over stretches of the arc, so that the noise of single points does not count.
    fn typical_distance(&self, points: &[[f64; 2]]) -> f64 {
        let mut by_angle: Vec<(f64, f64)> = points
            .iter()
            .map(|[x, y]| (self.angle_rad(*x, *y), (x - self.x).hypot(y - self.y) - self.radius))
            .collect();
        by_angle.sort_by(|a, b| a.0.total_cmp(&b.0));
        let stretches = by_angle.chunks(by_angle.len().div_ceil(N_STRETCHES).max(1));
        let squares: Vec<f64> =
            stretches.map(|part| (part.iter().map(|(_, off)| off).sum::<f64>() / part.len() as f64).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt() / self.radius
    }
}

/// Is y the height of a point that swings to and fro through its lowest place at x? A parabola explains most of how y
/// scatters then, however short the arc.
pub(super) fn is_arc(x: &[f64], y: &[f64]) -> bool {
    let n = x.len().min(y.len());
    let mean = |values: &[f64]| values[..n].iter().sum::<f64>() / n as f64;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let (mut normal, mut right, mut scatter) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for (x, y) in x.iter().zip(y) {
        let (u, v) = (x - mean_x, y - mean_y);
        let row = Vector3::new(1.0, u, u * u);
        normal += row * row.transpose();
        right += row * v;
        scatter += v * v;
    }
    let Some(parabola) = normal.lu().solve(&right) else { return false };
    // What the curved part alone explains, beside the level and the slope.
    let line = normal.fixed_view::<2, 2>(0, 0).lu().solve(&right.fixed_rows::<2>(0));
    let explained = |along: f64| along / scatter;
    let by_all = explained(parabola.dot(&right));
    let by_line = line.map_or(1.0, |line| explained(line.dot(&right.fixed_rows::<2>(0))));
    let (by_arc, by_chance) = (by_all - by_line, (1.0 - by_all).max(0.0) / n.saturating_sub(3).max(1) as f64);
    scatter > 0.0 && by_arc > ARC_EXPLAINS && by_arc > ARC_STANDS_OUT * by_chance
}

fn mean_distance(points: &[[f64; 2]], centre: [f64; 2]) -> f64 {
    points.iter().map(|[x, y]| (x - centre[0]).hypot(y - centre[1])).sum::<f64>() / points.len().max(1) as f64
}

/// Centre, radius, and the radius' relative standard error.
fn fitted(points: &[[f64; 2]]) -> Option<([f64; 2], f64, f64)> {
    let n = points.len() as f64;
    let (mean_x, mean_y) = (points.iter().map(|p| p[0]).sum::<f64>() / n, points.iter().map(|p| p[1]).sum::<f64>() / n);
    let local = || points.iter().map(|[x, y]| (x - mean_x, y - mean_y));
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (u, v) in local() {
        let row = Vector3::new(2.0 * u, 2.0 * v, 1.0);
        normal += row * row.transpose();
        right += row * (u * u + v * v);
    }
    let start = normal.lu().solve(&right)?;
    let mut circle = Vector3::new(start[0], start[1], (start[2] + start[0].powi(2) + start[1].powi(2)).sqrt());
    let mut spread = f64::INFINITY;
    for _ in 0..N_ROUNDS {
        let (mut normal, mut right, mut squares) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
        for (u, v) in local() {
            let (du, dv) = (u - circle[0], v - circle[1]);
            let distance = du.hypot(dv);
            let row = Vector3::new(-du / distance, -dv / distance, -1.0);
            let off = distance - circle[2];
            normal += row * row.transpose();
            right -= row * off;
            squares += off * off;
        }
        let inverse = normal.try_inverse()?;
        circle += inverse * right;
        spread = (inverse[(2, 2)].max(0.0) * squares / (n - 3.0).max(1.0)).sqrt() / circle[2].abs();
    }
    let is_sound = circle.iter().all(|value| value.is_finite()) && circle[2] > 0.0 && spread.is_finite();
    is_sound.then_some(([circle[0] + mean_x, circle[1] + mean_y], circle[2], spread))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(half_rad: f64, squeeze: f64, noise: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let angles: Vec<f64> = (0..400).map(|idx| half_rad * (f64::from(idx) * 0.1).cos()).collect();
        let random = |idx: usize| f64::from((idx as u32).wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
        let x = angles.iter().enumerate().map(|(i, a)| 300.0 + squeeze * 200.0 * a.sin() + noise * random(i)).collect();
        let y = angles.iter().enumerate().map(|(i, a)| 100.0 + 200.0 * a.cos() + noise * random(i + 7919)).collect();
        (angles, x, y)
    }

    #[test]
    fn pixels_from_the_top_give_pivot_and_angles() {
        let (angles, x, y) = arc(0.8, 1.0, 1.0);
        let circle = Circle::through(&x, &y, None).unwrap();
        assert!((circle.x - 300.0).abs() < 0.5 && (circle.y - 100.0).abs() < 1.0 && circle.up < 0.0, "{circle:?}");
        let found = circle.angles_rad(&x, &y);
        assert!(found.iter().zip(&angles).all(|(found, angle)| (found - angle).abs() < 0.01));
    }

    #[test]
    fn a_short_arc_has_its_pivot_where_x_and_y_have_their_origin_or_a_doubt() {
        let (angles, x, y) = arc(0.08, 1.0, 0.2);
        // Bent by a third of a percent of the width of 32.
        let bend = |y: &[f64], x: &[f64]| -> Vec<f64> {
            y.iter().zip(x).map(|(y, x)| y - 100.0 + 0.1 * ((x - 300.0) / 16.0).powi(2)).collect()
        };
        let (from_pivot, bent) = (x.iter().map(|x| x - 300.0).collect::<Vec<_>>(), bend(&y, &x));
        let circle = Circle::through(&from_pivot, &bent, None).unwrap();
        let words = circle.in_words();
        assert!(words.contains("the origin of x and y") && words.contains("doubtful, the arc by itself"), "{words}");
        let found = circle.angles_rad(&from_pivot, &bent);
        assert!(found.iter().zip(&angles).all(|(found, angle)| (found - angle).abs() < 0.002));
        let circle = Circle::through(&x, &bent, None).unwrap();
        assert!(circle.in_words().contains("doubtful, the arc is short") && (circle.radius - 200.0).abs() > 20.0);
        assert!(is_arc(&x, &y) && !is_arc(&y, &x) && !is_arc(&angles, &angles));
        let rates: Vec<f64> = (0..400).map(|idx| -(f64::from(idx) * 0.1).sin()).collect();
        assert!(!is_arc(&angles, &rates));
    }

    /// An arc of 0.1 rad that is bent a little, of a bob at a string of a quarter of a metre: (2π)² 0.25 / 9.80665 = 1.0032² s².
    #[test]
    fn an_origin_at_the_distance_that_the_period_tells_is_not_doubted() {
        let (_, x, y) = arc(0.08, 1.0, 0.2);
        let metres = |x: f64| x / 800.0;
        let x: Vec<f64> = x.iter().map(|x| metres(x - 300.0)).collect();
        let y: Vec<f64> = y.iter().zip(&x).map(|(y, x)| metres(y - 100.0 + 0.1 * (50.0 * x).powi(2))).collect();
        let words = |period_s: f64| Circle::through(&x, &y, None).unwrap().unless_period_tells(period_s).in_words();
        for (period_s, is_doubted) in [(1.0032, false), (1.02, false), (1.1, true), (0.9, true), (2.0, true)] {
            let words = words(period_s);
            assert!(words.contains("the origin of x and y"), "{words}");
            assert_eq!(words.contains("doubtful"), is_doubted, "{period_s} {words}");
        }
    }

    /// The arc of half a metre's string, whose axes lie a third of that too high.
    #[test]
    fn a_doubt_names_the_pivot_of_the_arc_and_a_period_that_tells_it() {
        let (_, x, y) = arc(0.08, 1.0, 0.2);
        let x: Vec<f64> = x.iter().map(|x| (x - 300.0) / 400.0).collect();
        let y: Vec<f64> = y.iter().map(|y| (y - 100.0 + 70.0) / 400.0).collect();
        let words = |period_s: f64| Circle::through(&x, &y, None).unwrap().unless_period_tells(period_s).in_words();
        let half_a_metre_s = TAU * (0.5 / GRAVITY_M_S2).sqrt();
        assert!(words(half_a_metre_s).contains("that of a string with this period"), "{}", words(half_a_metre_s));
        let other = words(1.3 * half_a_metre_s);
        assert!(other.contains("--pivot=") && !other.contains("string"), "{other}");
    }

    #[test]
    fn a_slanting_view_and_a_short_arc_are_refused() {
        let (_, x, y) = arc(1.4, 0.7, 1.0);
        assert!(matches!(Circle::through(&x, &y, None), Err(Fault::NoCircle { .. })));
        let (angles, x, y) = arc(0.05, 1.0, 2.0);
        let fault = Circle::through(&x, &y, None).unwrap_err();
        assert!(matches!(fault, Fault::ShortArc { .. }) && !fault.to_string().contains("origin"), "{fault}");
        let circle = Circle::through(&x, &y, Some([300.0, 100.0])).unwrap();
        let found = circle.angles_rad(&x, &y);
        assert!(found.iter().zip(&angles).all(|(found, angle)| (found - angle).abs() < 0.02));
    }
    /// Seen so badly that single points are some percent of the radius off.
    #[test]
    fn a_refused_arc_about_the_origin_is_told_how_to_take_it_for_the_pivot() {
        let (_, x, y) = arc(0.3, 1.0, 20.0);
        let about = |list: &[f64], origin: f64| list.iter().map(|at| at - origin).collect::<Vec<f64>>();
        let [x, y] = [about(&x, 300.0), about(&y, 100.0)];
        let fault = Circle::through(&x, &y, None).unwrap_err();
        assert!(fault.to_string().contains("say --pivot 0,0"), "{fault}");
        assert!(Circle::through(&x, &y, Some([0.0; 2])).is_ok());
    }
}
