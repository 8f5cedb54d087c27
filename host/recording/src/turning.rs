//! Turning points and zero crossings of a swing, from local least-squares fits; no derivative of noisy data.
//!
//! Energy lost per swing and period against amplitude are drawn from these. A turning point is the top of a quartic
//! over ± 0.2 of a half swing: for a sine its amplitude is off by less than 3e-6 of itself, and at 200 Hz it keeps a
//! third of the noise of one sample. A crossing is where a straight line over ± 0.1 of a half swing meets zero; the
//! curvature of a sine is odd there and does not shift it.

use super::smooth::{LocalFit, within};
use super::{chance, median, median_step_s, weighted_median};

/// Half width of a turning point's fit in half swings.
const TURNING_WIDTH: f64 = 0.2;

/// Half width of a crossing's line in half swings.
const CROSSING_WIDTH: f64 = 0.1;

/// Half width of the smoothing before extrema are looked for, in half swings.
const SMOOTHING_WIDTH: f64 = 0.12;

/// Samples on either side that a quartic wants at low rates …
const SAMPLES_BESIDE: f64 = 5.5;

/// … as long as it spans no more than this of a half swing on either side.
pub(super) const WIDEST: f64 = 0.45;

/// A parabola has two samples on either side where a swing has so few that a quartic spans too much of it: with eight a
/// period its top is 4 % too low.
const FEW_BESIDE: f64 = 2.5;

/// First look: the angle must fall by this many noise rms …
const ROUGH_FALL_NOISE: f64 = 14.0;

/// … and this share of the whole range to have turned; smaller ones are a tremble.
pub(super) const ROUGH_FALL_SHARE: f64 = 0.05;

/// What wobbles on top of a swing turns within this share of its time: at twice its rate it takes half. Half of it and twice of it
/// were not tried.
const WOBBLE_TIME: f64 = 0.6;

/// Looked at are means over so many samples, the fewest that show enough turns: swings may hardly rise out of the noise
/// of a sample, such as those of a gate that takes 9 s and moves by 8 of its noises. Twice as many would show a
/// wandering sensor as swings; half as many lose that gate.
const MEANS: [usize; 5] = [1, 2, 4, 8, 16];
const ENOUGH_TURNS: usize = 4;

/// Second look, after smoothing: fall in units of the smoothed noise, and beyond what chance makes of a long rest.
const FINE_FALL_NOISE: f64 = 8.0;

/// Where the pendulum turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// When, s.
    pub time_s: f64,
    /// Angle, rad, counter-clockwise positive.
    pub angle_rad: f64,
    /// Standard deviation of the angle, rad.
    pub spread_rad: f64,
    /// Whether it is a maximum of the angle.
    pub is_maximum: bool,
}

/// Where the pendulum passes a given angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// When, s.
    pub time_s: f64,
    /// Velocity, rad/s; positive counter-clockwise.
    pub velocity_rad_s: f64,
}

/// Turning points of a swing, in order of time; `noise_rms_rad` tells a turn from noise.
/// The ends of the stretch are never turning points, nor is a pendulum held still.
pub fn turning_points(times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64) -> Vec<TurningPoint> {
    let Some(half_swing_s) = half_swing_s(times_s, angles_rad, noise_rms_rad) else { return Vec::new() };
    let width_s = quartic_width_s(half_swing_s, median_step_s(times_s));
    fine_extrema(times_s, angles_rad, noise_rms_rad, half_swing_s)
        .into_iter()
        .filter_map(|rough| refine(times_s, angles_rad, noise_rms_rad, rough, width_s))
        .collect()
}

/// Crossings of `about_rad` (0, or the angle at which it hangs), in order of time.
pub fn crossings(times_s: &[f64], angles_rad: &[f64], about_rad: f64, noise_rms_rad: f64) -> Vec<Crossing> {
    let Some(half_swing_s) = half_swing_s(times_s, angles_rad, noise_rms_rad) else { return Vec::new() };
    let turns = turning_points(times_s, angles_rad, noise_rms_rad);
    let width_s = (CROSSING_WIDTH * half_swing_s).max(2.5 * median_step_s(times_s));
    let ends = [times_s[0]].into_iter().chain(turns.iter().map(|turn| turn.time_s)).chain(times_s.last().copied());
    let ends: Vec<f64> = ends.collect();
    ends.windows(2).filter_map(|pair| cross(times_s, angles_rad, about_rad, pair[0]..pair[1], width_s)).collect()
}

/// Typical duration of a half swing, s; `None` when there are not two turning points.
pub fn half_swing_s(times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64) -> Option<f64> {
    let lowest = angles_rad.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = angles_rad.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut found = Vec::new();
    for n_mean in MEANS {
        let fall_rad = ROUGH_FALL_NOISE * noise_rms_rad / (n_mean as f64).sqrt();
        let (times_s, angles_rad) = (means(times_s, n_mean), means(angles_rad, n_mean));
        let seen = without_wobble(extrema(&times_s, &angles_rad, fall_rad.max(ROUGH_FALL_SHARE * (highest - lowest))));
        if seen.len() > found.len() {
            found = seen;
        }
        if found.len() >= ENOUGH_TURNS {
            break;
        }
    }
    let mut intervals: Vec<f64> = found.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).collect();
    (!intervals.is_empty()).then(|| median(&mut intervals))
}

/// How often a stretch turns, beyond noise and a tremble beside all of it.
pub(super) fn n_turns(times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64, all_rad: &[f64]) -> usize {
    let (lowest, highest) = all_rad.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let fall_rad = (ROUGH_FALL_NOISE * noise_rms_rad).max(ROUGH_FALL_SHARE * (highest - lowest));
    extrema(times_s, angles_rad, fall_rad).len()
}

/// Means of so many neighbours each.
fn means(values: &[f64], n_mean: usize) -> Vec<f64> {
    values.chunks_exact(n_mean).map(|chunk| chunk.iter().sum::<f64>() / n_mean as f64).collect()
}

/// Half width of a quartic, s: wide enough for some samples, narrow enough for the shape of a swing.
pub(crate) fn quartic_width_s(half_swing_s: f64, step_s: f64) -> f64 {
    (TURNING_WIDTH * half_swing_s).max((SAMPLES_BESIDE * step_s).min(WIDEST * half_swing_s))
}

#[derive(Debug, Clone, Copy)]
struct Extremum {
    time_s: f64,
    angle_rad: f64,
    is_maximum: bool,
}

impl Extremum {
    fn new((angle_rad, idx): (f64, usize), times_s: &[f64], is_maximum: bool) -> Self {
        Self { time_s: times_s[idx], angle_rad, is_maximum }
    }

    /// How far it is to another one, rad.
    fn size(&self, other: &Self) -> f64 {
        (other.angle_rad - self.angle_rad).abs()
    }
}

/// Extrema that rise and fall by more than `fall_rad` on both sides.
fn extrema(times_s: &[f64], angles_rad: &[f64], fall_rad: f64) -> Vec<Extremum> {
    let mut found = Vec::new();
    let (Some(first), false) = (angles_rad.first(), fall_rad <= 0.0) else { return found };
    let (mut low, mut high) = ((*first, 0), (*first, 0));
    let mut rising: Option<bool> = None;
    for (idx, &angle_rad) in angles_rad.iter().enumerate() {
        if angle_rad > high.0 {
            high = (angle_rad, idx);
        }
        if angle_rad < low.0 {
            low = (angle_rad, idx);
        }
        if rising != Some(false) && angle_rad < high.0 - fall_rad {
            // The first reversal has nothing before it: the start is no turning point.
            found.extend(rising.map(|_| Extremum::new(high, times_s, true)));
            (rising, low) = (Some(false), (angle_rad, idx));
        } else if rising != Some(true) && angle_rad > low.0 + fall_rad {
            found.extend(rising.map(|_| Extremum::new(low, times_s, false)));
            (rising, high) = (Some(true), (angle_rad, idx));
        }
    }
    found
}

/// Free swings become smaller from one to the next, so that none is both smaller than those beside it and far shorter than most of
/// the way takes: that is something that swings along, as a phone that sways in its holder does.
fn without_wobble(extrema: Vec<Extremum>) -> Vec<Extremum> {
    let longest_s = WOBBLE_TIME * typical_s(&extrema);
    let mut kept: Vec<Extremum> = Vec::new();
    for extremum in extrema {
        kept.push(extremum);
        while let [.., a, b, c, d] = kept[..]
            && b.size(&c) <= a.size(&b).min(c.size(&d))
            && c.time_s - b.time_s < longest_s
        {
            kept.drain(kept.len() - 3..kept.len() - 1);
        }
    }
    kept
}

/// The time between neighbours, each with the square of its way for a weight: many small ways are no large one.
fn typical_s(extrema: &[Extremum]) -> f64 {
    let step = |pair: &[Extremum]| (pair[1].time_s - pair[0].time_s, pair[0].size(&pair[1]).powi(2));
    weighted_median(extrema.windows(2).map(step).collect())
}

/// Extrema of the smoothed angle, so that swings of a few noise rms still count.
fn fine_extrema(times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64, half_swing_s: f64) -> Vec<Extremum> {
    let step_s = median_step_s(times_s);
    let width_s = (SMOOTHING_WIDTH * half_swing_s).max(2.5 * step_s);
    let stride = ((width_s / (4.0 * step_s)) as usize).max(1);
    let smoothed: Vec<(f64, f64, f64)> = times_s
        .iter()
        .step_by(stride)
        .filter_map(|&time_s| {
            let fit = LocalFit::<3>::new(times_s, angles_rad, time_s, width_s)?;
            Some((time_s, fit.angle_rad(time_s), fit.angle_spread(time_s)))
        })
        .collect();
    let mut spreads: Vec<f64> = smoothed.iter().map(|smooth| smooth.2).collect();
    let n_independent = (times_s.len() as f64 * step_s / width_s).max(1.0);
    let fall_noise = FINE_FALL_NOISE.max(chance::range(n_independent));
    let fall_rad = (fall_noise * noise_rms_rad * median(&mut spreads)).max(f64::EPSILON);
    let (times_s, angles_rad): (Vec<f64>, Vec<f64>) = smoothed.iter().map(|smooth| (smooth.0, smooth.1)).unzip();
    without_wobble(extrema(&times_s, &angles_rad, fall_rad))
}

/// The top of a quartic, centred a second time on its own top; where it bends the other way it is the turn before or behind a hole
/// in the rows. In small noisy swings a quartic may have no top within
/// its stretch; a parabola still has.
fn refine(
    times_s: &[f64],
    angles_rad: &[f64],
    noise_rms_rad: f64,
    rough: Extremum,
    width_s: f64,
) -> Option<TurningPoint> {
    let is_maximum = rough.is_maximum;
    let top = |centre_s: f64| top_of::<5>(times_s, angles_rad, centre_s, width_s, is_maximum);
    let few_s = || FEW_BESIDE * median_step_s(times_s);
    let (time_s, angle_rad, spread) = top(rough.time_s)
        .and_then(|(first_s, ..)| top(first_s))
        .or_else(|| top_of::<3>(times_s, angles_rad, rough.time_s, width_s, is_maximum))
        .or_else(|| top_of::<3>(times_s, angles_rad, rough.time_s, few_s(), is_maximum))?;
    Some(TurningPoint { time_s, angle_rad, spread_rad: noise_rms_rad * spread, is_maximum })
}

/// Time, angle and spread per unit of noise where a polynomial of `N` coefficients is level and bends so.
fn top_of<const N: usize>(
    times_s: &[f64],
    angles_rad: &[f64],
    centre_s: f64,
    width_s: f64,
    is_maximum: bool,
) -> Option<(f64, f64, f64)> {
    let fit = LocalFit::<N>::new(times_s, angles_rad, centre_s, width_s)?;
    let time_s = fit.stationary_s().filter(|time_s| fit.bends_down(*time_s) == is_maximum)?;
    Some((time_s, fit.angle_rad(time_s), fit.angle_spread(time_s)))
}

/// The one crossing between two turning points, if the angle changes sides between them.
fn cross(
    times_s: &[f64],
    angles_rad: &[f64],
    about_rad: f64,
    between_s: std::ops::Range<f64>,
    width_s: f64,
) -> Option<Crossing> {
    let middle_s = (between_s.start + between_s.end) / 2.0;
    let range = within(times_s, middle_s, (between_s.end - between_s.start) / 2.0);
    let (first, last) = (angles_rad.get(range.start)? - about_rad, angles_rad.get(range.end - 1)? - about_rad);
    if first * last >= 0.0 {
        return None;
    }
    // With noise there may be several changes of sign; the middle one is close enough to centre the line.
    let changes: Vec<usize> =
        range.skip(1).filter(|idx| (angles_rad[idx - 1] - about_rad) * (angles_rad[*idx] - about_rad) <= 0.0).collect();
    let rough_s = times_s[*changes.get(changes.len() / 2)?];
    let first_s = meet(times_s, angles_rad, about_rad, rough_s, width_s)?.time_s;
    meet(times_s, angles_rad, about_rad, first_s, width_s)
}

fn meet(times_s: &[f64], angles_rad: &[f64], about_rad: f64, centre_s: f64, width_s: f64) -> Option<Crossing> {
    let line = LocalFit::<2>::new(times_s, angles_rad, centre_s, width_s)?;
    let velocity_rad_s = line.velocity_rad_s();
    let shift_s = (about_rad - line.angle_rad(centre_s)) / velocity_rad_s;
    (shift_s.abs() <= width_s).then_some(Crossing { time_s: centre_s + shift_s, velocity_rad_s })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const DECAY_PER_S: f64 = 0.1;
    const ANGULAR_HZ: f64 = 8.0;

    fn decaying(rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
        let times_s: Vec<f64> = (0..(10.0 * rate_hz) as usize).map(|idx| idx as f64 / rate_hz).collect();
        let angles_rad = times_s.iter().map(|t| (-DECAY_PER_S * t).exp() * (ANGULAR_HZ * t).cos()).collect();
        (times_s, angles_rad)
    }

    fn check(rate_hz: f64, tolerance_rad: f64) {
        let (times_s, angles_rad) = decaying(rate_hz);
        let turns = turning_points(&times_s, &angles_rad, 1e-5);
        // d/dt = 0 where tan(ωt) = −decay/ω.
        let first_s = (PI - (DECAY_PER_S / ANGULAR_HZ).atan()) / ANGULAR_HZ;
        assert_eq!(turns.len(), 25, "{turns:?}");
        for (turn_idx, turn) in turns.iter().enumerate() {
            let time_s = first_s + turn_idx as f64 * PI / ANGULAR_HZ;
            let angle_rad = (-DECAY_PER_S * time_s).exp() * (ANGULAR_HZ * time_s).cos();
            assert!((turn.time_s - time_s).abs() < 1e-3, "{turn:?} {time_s}");
            assert!((turn.angle_rad - angle_rad).abs() < tolerance_rad, "{turn:?} {angle_rad}");
        }
    }

    #[test]
    fn amplitudes_of_a_decaying_sine_come_back() {
        check(1000.0, 3e-6);
        check(200.0, 3e-6);
    }

    #[test]
    fn amplitudes_survive_twenty_hertz() {
        check(20.0, 2e-3);
    }

    /// What stands at an end of a hole in the rows was once taken for the turn before it.
    #[test]
    fn beside_a_hole_in_the_rows_each_turn_is_where_it_was_and_of_its_kind() {
        let (times_s, angles_rad) = decaying(25.0);
        for begin in 80..120 {
            let kept = |list: &[f64]| [&list[..begin], &list[begin + 17..]].concat();
            let (times_s, angles_rad) = (kept(&times_s), kept(&angles_rad));
            for turn in turning_points(&times_s, &angles_rad, 1e-5) {
                let n = (turn.time_s * ANGULAR_HZ + (DECAY_PER_S / ANGULAR_HZ).atan()) / PI;
                let hole_s = times_s[begin - 1] - 0.1..times_s[begin] + 0.1;
                assert!(hole_s.contains(&turn.time_s) || (n - n.round()).abs() < 5e-3, "{begin} {turn:?}");
                assert_eq!(turn.is_maximum, (n.round() as u32).is_multiple_of(2), "{begin} {turn:?}");
            }
        }
    }

    #[test]
    fn crossings_of_a_decaying_sine_come_back() {
        let (times_s, angles_rad) = decaying(200.0);
        let crossings = crossings(&times_s, &angles_rad, 0.0, 1e-5);
        assert_eq!(crossings.len(), 25);
        for (idx, crossing) in crossings.iter().enumerate() {
            let time_s = (idx as f64 + 0.5) * PI / ANGULAR_HZ;
            assert!((crossing.time_s - time_s).abs() < 2e-4, "{crossing:?} {time_s}");
            assert_eq!(crossing.velocity_rad_s < 0.0, idx % 2 == 0);
        }
    }

    #[test]
    fn crossings_of_the_angle_at_which_it_hangs_are_those_of_the_same_swing_about_zero() {
        let (times_s, angles_rad) = decaying(200.0);
        let shifted: Vec<f64> = angles_rad.iter().map(|angle| angle + 0.3).collect();
        let crossings = crossings(&times_s, &shifted, 0.3, 1e-5);
        assert_eq!(crossings.len(), 25);
        for (idx, crossing) in crossings.iter().enumerate() {
            let time_s = (idx as f64 + 0.5) * PI / ANGULAR_HZ;
            assert!((crossing.time_s - time_s).abs() < 2e-4, "{crossing:?} {time_s}");
        }
    }

    /// Noise of 1 mrad rms, even.
    fn noisy(angle: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let times_s: Vec<f64> = (0..600).map(|idx| f64::from(idx) * 0.1).collect();
        let mut state = 3_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            12f64.sqrt() * 1e-3 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let angles_rad = times_s.iter().map(|t| angle(*t) + noise()).collect();
        (times_s, angles_rad)
    }

    #[test]
    fn slow_swings_of_a_few_noises_are_seen_and_noise_alone_is_none() {
        let (times_s, angles_rad) = noisy(|t| 5e-3 * (2.0 * PI * t / 9.0).cos());
        let half_swing_s = half_swing_s(&times_s, &angles_rad, 1e-3).unwrap();
        assert!((half_swing_s - 4.5).abs() < 0.5, "{half_swing_s}");
        // Of thirteen the last one, at 58.5 s, is too near the end to have turned visibly.
        assert_eq!(turning_points(&times_s, &angles_rad, 1e-3).len(), 12);
        let (times_s, angles_rad) = noisy(|_| 0.0);
        assert!(turning_points(&times_s, &angles_rad, 1e-3).is_empty());
    }

    #[test]
    fn an_hour_of_rest_has_no_turning_points_by_chance() {
        for seed in 1..6 {
            let mut noise = crate::random::Noise::new(seed);
            let times_s: Vec<f64> = (0..200_000).map(|idx| f64::from(idx) * 0.02).collect();
            let swing = |t: f64| (1.0 - 0.05 * t).max(0.0) * (ANGULAR_HZ * t).cos();
            let angles_rad: Vec<f64> = times_s.iter().map(|t| swing(*t) + 1e-3 * noise.normal()).collect();
            let last = turning_points(&times_s, &angles_rad, 1e-3).pop().unwrap();
            assert!(last.time_s < 21.0, "{seed}: {last:?}");
        }
    }

    /// A phone that sways in its holder: at seven times the rate of the swing, by up to a sixth of it.
    #[test]
    fn what_wobbles_on_top_of_a_swing_does_not_turn_it() {
        let times_s: Vec<f64> = (0..4000).map(|idx| f64::from(idx) * 0.01).collect();
        for share in [0.05, 0.15] {
            let wobbling = |t: &f64| (-0.02 * t).exp() * ((PI * t).cos() + share * (7.2 * PI * t).cos());
            let rates: Vec<f64> = times_s.iter().map(wobbling).collect();
            let half_swing_s = half_swing_s(&times_s, &rates, 1e-3).unwrap();
            assert!((half_swing_s - 1.0).abs() < 0.2, "{share}: {half_swing_s}");
            // Of what wobbles at an end nothing is known beyond it.
            let turns = turning_points(&times_s, &rates, 1e-3);
            let n_inside = turns.iter().filter(|turn| (2.5..37.5).contains(&turn.time_s)).count();
            assert_eq!(n_inside, 35, "{share}: {turns:?}");
        }
    }

    /// Friction takes more than half of each swing, and then somebody lifts it anew.
    #[test]
    fn swings_that_die_at_once_and_begin_anew_are_no_wobble() {
        let times_s: Vec<f64> = (0..2000).map(|idx| f64::from(idx) * 0.01).collect();
        let swing = |t: f64| (-1.2 * t).exp() * (PI * t).cos();
        let angles_rad: Vec<f64> = times_s.iter().map(|t| swing(t % 5.0)).collect();
        let half_swing_s = half_swing_s(&times_s, &angles_rad, 1e-4).unwrap();
        assert!((half_swing_s - 1.0).abs() < 0.1, "{half_swing_s}");
    }

    #[test]
    fn a_still_pendulum_has_no_turning_points() {
        let times_s: Vec<f64> = (0..1000).map(|idx| f64::from(idx) * 0.005).collect();
        assert!(turning_points(&times_s, &vec![0.1; 1000], 1e-3).is_empty());
        assert!(turning_points(&[], &[], 1e-3).is_empty());
    }
}
