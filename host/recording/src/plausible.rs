//! Can these be the angles of a pendulum? One check for command line, page and library.
//!
//! The period of a pendulum grows with its amplitude, `T(A) = T0 · 2 K(sin A/2) / π`, by 1.7 % at 30° and 18 % at 90°,
//! whatever its size. Degrees or angular velocities taken as radians do not show the growth that their size would bring;
//! radians taken as degrees show thousands of times as much. Springs and magnets change the growth by some factor, but
//! not by such ones. The period itself tells whether the unit of time can be right.

use super::error::Fault;
use super::growth::{
    MIN_PERIODS, SMALLEST_SHARE, SURE, growth_beside_bending, growth_of, growth_while_falling, lengthening,
};
use super::noise;
use super::options::ReadOptions;
use super::told::Told;
use super::turning::{self, TurningPoint};
use super::{median, median_step_s, weighted_median};
use std::f64::consts::{PI, TAU};

/// Nobody swings a pendulum of less than 2.5 mm …
pub(super) const SHORTEST_PERIOD_S: f64 = 0.1;

/// … or of more than 900 m; a gate on slightly leaning hinges takes 17 s.
pub(super) const LONGEST_PERIOD_S: f64 = 60.0;

/// So many samples are enough to see turning points …
const MOST_SAMPLES: usize = 20_000;

/// … unless few of them are those of a swing before a long rest: this many a half swing are kept in any case. With half of
/// it tops would lie between samples, which makes them some percent too low; with twice of it two hours take twice as long.
const KEPT_A_HALF_SWING: f64 = 10.0;

/// The measured growth is that of radians if it may be this share of what is predicted: on seven real pendulums it was
/// 0.98 to 1.26 of it. Degrees show 1/3283, rates of a
/// pendulum with a period of 2 s 1/10, of 1 s 1/40; a spring as stiff as gravity halves the growth.
const LEAST_GROWTH: f64 = 0.2;

/// And this many times: turns taken for radians show 39, radians taken for degrees 3283; a hand or a magnet some.
const MOST_GROWTH: f64 = 4.0;

/// Near upright the law of the period is steep, and angles in a wrong unit may seem to lie anywhere, rad.
const LARGEST_TAKEN_OFF_RAD: f64 = 2.5;

/// Periods, each of which begins at another turning point, of the first two swings: a hand or a motor may have made them.
/// With all of them kept, one and a half swings of a motor make angles seem seven times too small.
const FIRST: usize = 4;

/// Just below upright, where the law of the period ends.
const LARGEST_SINE: f64 = 0.99;

/// The swings of a recording, as far as they can be seen.
#[derive(Debug)]
pub struct Swings {
    /// Largest distance from the middle, rad.
    pub largest_rad: f64,
    /// About what it swings, rad.
    pub middle_rad: f64,
    /// Typical period, s.
    pub period_s: f64,
    /// Amplitude (rad) and period (s) of each swing.
    periods: Vec<(f64, f64)>,
}

/// Is the unit of the angle right?
#[derive(Debug, PartialEq)]
pub enum Scale {
    /// The period grows as it should.
    Right,
    /// Too little is seen of the growth.
    Unknown,
    /// It grows far less than angles of this size make it grow, percent from the smallest to the largest swing.
    TooLarge {
        /// By the pendulum's law.
        predicted_percent: f64,
        /// As measured.
        found_percent: f64,
        /// May it be none at all, as for degrees or rates? Springs and magnets change it by some share of itself.
        may_be_none: bool,
    },
    /// It grows as for angles so many times as large.
    TooSmall {
        /// How many times.
        factor: f64,
    },
}

impl Swings {
    /// Looks for swings in angles (rad) of a whole recording; `None` when there are not three turning points.
    pub fn of(times_s: &[f64], angles_rad: &[f64]) -> Option<Self> {
        if times_s.len() < super::limits::MIN_SAMPLES {
            return None;
        }
        let every = thinned_by(times_s, angles_rad);
        let thin = |values: &[f64]| values.iter().copied().step_by(every).collect::<Vec<f64>>();
        let (times_s, angles_rad) = (thin(times_s), thin(angles_rad));
        let neighbours_rad = noise::of_samples(&times_s, &angles_rad, None).total_rms;
        let half_swing_s = turning::half_swing_s(&times_s, &angles_rad, neighbours_rad)?;
        let noise_rad = noise::noise_of_means(&times_s, &angles_rad, neighbours_rad, half_swing_s);
        let turns = turning::turning_points(&times_s, &angles_rad, noise_rad);
        let middles: Vec<(f64, f64)> = turns.windows(3).map(middle_and_size).collect();
        if middles.is_empty() {
            return None;
        }
        // A tremble before or after the swings has the more turning points, and small ones.
        let step = |pair: &[TurningPoint]| {
            (2.0 * (pair[1].time_s - pair[0].time_s), (pair[0].angle_rad - pair[1].angle_rad).abs())
        };
        let steps = turns.windows(2).map(step).collect();
        let middle_rad = weighted_median(middles);
        let largest_rad = turns.iter().map(|turn| (turn.angle_rad - middle_rad).abs()).fold(0.0, f64::max);
        let periods = periods(&turns);
        Some(Self { largest_rad, middle_rad, period_s: weighted_median(steps), periods })
    }

    /// Can a pendulum have this period?
    ///
    /// # Errors
    /// It can't: the unit of the time is not what it seems, or where that was told something else than gravity swings it.
    pub(super) fn judge_period(&self, told: Told, options: &ReadOptions) -> Result<(), Fault> {
        let (period_s, shortest_s, longest_s) = (self.period_s, SHORTEST_PERIOD_S, LONGEST_PERIOD_S);
        let is_possible = (shortest_s..longest_s).contains(&period_s);
        let is_told = options.says_time();
        if is_possible {
            Ok(())
        } else {
            Err(Fault::ImpossiblePeriod { period_s, shortest_s, longest_s, told, is_told })
        }
    }

    /// For readings that are rates (rad/s): angular frequency of small swings, rad/s. From the smallest swings that are
    /// seen well, with what their amplitude adds to the period taken off.
    pub fn small_rad_s(&self) -> f64 {
        let mut seen: Vec<(f64, f64)> =
            self.periods.iter().copied().filter(|(rate, _)| *rate > SMALLEST_SHARE * self.largest_rad).collect();
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        seen.truncate((seen.len() / 3).max(MIN_PERIODS));
        let (mut rates, mut periods): (Vec<f64>, Vec<f64>) = seen.into_iter().unzip();
        if periods.is_empty() {
            return TAU / self.period_s;
        }
        let (rate, seen_rad_s) = (median(&mut rates), TAU / median(&mut periods));
        // The amplitude depends on the frequency itself; it settles at once.
        (0..3).fold(seen_rad_s, |small_rad_s, _| seen_rad_s * lengthening(amplitude_rad(rate, small_rad_s)))
    }

    /// For readings that are rates (rad/s): the same swings with their amplitudes in rad.
    pub fn in_angles(mut self) -> Self {
        let small_rad_s = self.small_rad_s();
        self.periods.iter_mut().for_each(|(rate, _)| *rate = amplitude_rad(*rate, small_rad_s));
        self.largest_rad = amplitude_rad(self.largest_rad, small_rad_s);
        self.middle_rad = 0.0;
        self
    }

    /// The period that small swings have, s: of each swing with what its amplitude adds by the pendulum's law taken off.
    pub fn small_period_s(&self) -> f64 {
        let small =
            |(amplitude_rad, period_s): &(f64, f64)| period_s / lengthening(amplitude_rad.min(LARGEST_TAKEN_OFF_RAD));
        let mut periods: Vec<f64> = self.periods.iter().map(small).collect();
        if periods.is_empty() { self.period_s } else { median(&mut periods) }
    }

    /// The middle one of the amplitudes (rad), and the middle one of the periods (s).
    pub fn typical(&self) -> Option<(f64, f64)> {
        let (mut amplitudes, mut periods): (Vec<f64>, Vec<f64>) = self.periods.iter().copied().unzip();
        let amplitude_rad = median(&mut amplitudes);
        (amplitude_rad < PI).then_some((amplitude_rad, median(&mut periods)))
    }

    /// Does the period grow as that of a pendulum does, to a third, in all swings or while they fall freely?
    pub fn is_pendulum(&self) -> bool {
        /// Half of it would be missed where friction differs from swing to swing, with twice of it half a degree would pass
        /// for a degree.
        const NEAR: f64 = 0.3;
        let is_near = |(growth, spread, _): (f64, f64, f64)| {
            (growth - 1.0).abs() + SURE * spread < 2.0 * NEAR && (growth - 1.0).abs() < NEAR
        };
        self.growth().is_some_and(is_near) || growth_while_falling(&self.periods).is_some_and(is_near)
    }

    /// May the period grow as for angles so many times as large, as far as is seen? What is lost in its error may not.
    pub fn may_be_larger(&self, factor: f64) -> bool {
        /// Standard errors. It only makes a doubt of what no verdict is sure of.
        const LIKELY: f64 = 2.0;
        let grows = |(growth, spread, _): (f64, f64, f64)| {
            growth > LIKELY * spread && (growth - factor.powi(2)).abs() < LIKELY * spread
        };
        self.growth().is_some_and(grows)
    }

    /// Compares the growth of the period with the amplitude with that of a pendulum.
    pub fn scale(&self) -> Scale {
        // There and back over more than half a turn to either side: no pendulum does that.
        if self.periods.iter().filter(|(amplitude, _)| *amplitude > PI).count() >= MIN_PERIODS {
            return Scale::TooLarge { predicted_percent: f64::INFINITY, found_percent: 0.0, may_be_none: true };
        }
        match (self.scale_of(&self.periods, self.largest_rad), self.periods.get(FIRST..)) {
            // A lift by hand or a push by a motor may be larger than all swings.
            (Scale::Unknown, Some(rest)) => {
                let largest_rad = rest.iter().fold(0.0_f64, |largest, (amplitude, _)| largest.max(*amplitude));
                let of_rest = self.scale_of(rest, largest_rad);
                if matches!(of_rest, Scale::TooLarge { .. }) { of_rest } else { Scale::Unknown }
            }
            (scale, _) => scale,
        }
    }

    fn scale_of(&self, periods: &[(f64, f64)], largest_rad: f64) -> Scale {
        let Some((growth, spread, span)) = growth_of(periods, largest_rad) else { return Scale::Unknown };
        log::debug!("period grows by {growth:.3} ± {spread:.3} of what is predicted, over {:.2} %", 100.0 * span);
        // A pendulum's period that falls so much is no pendulum's in any unit: what else changes it hides its growth.
        if growth + SURE * spread < -MOST_GROWTH {
            return Scale::Unknown;
        }
        if growth + SURE * spread < LEAST_GROWTH {
            let (predicted_percent, may_be_none) = (100.0 * span, growth.abs() < SURE * spread);
            return Scale::TooLarge { predicted_percent, found_percent: predicted_percent * growth, may_be_none };
        }
        let at_least = match growth - SURE * spread {
            at_least if at_least > MOST_GROWTH => self.growth_behind_start().unwrap_or(at_least),
            at_least => at_least,
        };
        match () {
            () if at_least > MOST_GROWTH => match growth_beside_bending(periods, largest_rad) {
                Some((beside, spread, _)) if beside - SURE * spread > MOST_GROWTH => {
                    Scale::TooSmall { factor: growth.min(beside).sqrt() }
                }
                _ => Scale::Unknown,
            },
            () if at_least > LEAST_GROWTH => Scale::Right,
            () => Scale::Unknown,
        }
    }
}

impl Swings {
    /// The least growth that the periods behind the first ones show for sure.
    fn growth_behind_start(&self) -> Option<f64> {
        let (growth, spread, _) = growth_of(self.periods.get(FIRST..)?, self.largest_rad)?;
        Some(growth - SURE * spread)
    }

    /// As `growth` says of the swings that are seen well.
    fn growth(&self) -> Option<(f64, f64, f64)> {
        growth_of(&self.periods, self.largest_rad)
    }
}

/// Of how many samples one is enough.
fn thinned_by(times_s: &[f64], angles_rad: &[f64]) -> usize {
    let every = times_s.len().div_ceil(MOST_SAMPLES);
    if every == 1 {
        return 1;
    }
    let noise_rad = noise::of_samples(times_s, angles_rad, None).total_rms;
    let half_swing_s = turning::half_swing_s(times_s, angles_rad, noise_rad);
    let most = half_swing_s.map(|half_swing_s| half_swing_s / median_step_s(times_s) / KEPT_A_HALF_SWING);
    most.map_or(every, |most| every.min(most as usize).max(1))
}

/// Of a swing from one turning point to the next but one, rad. Between two alone the middle is off by half of what friction
/// takes: by 0.5 rad where it takes a third.
fn middle_and_size(three: &[TurningPoint]) -> (f64, f64) {
    let (outer, inner) = ((three[0].angle_rad + three[2].angle_rad) / 2.0, three[1].angle_rad);
    ((outer + inner) / 2.0, (outer - inner).abs())
}

/// From the rate at the lowest point (rad/s) to the amplitude (rad), by the energy: `ω² = 2 ω0² (1 − cos A)`.
fn amplitude_rad(rate_rad_s: f64, small_rad_s: f64) -> f64 {
    2.0 * (rate_rad_s / (2.0 * small_rad_s)).min(LARGEST_SINE).asin()
}

/// Amplitude and period from every turning point to the next but one, in rising order of time.
fn periods(turns: &[TurningPoint]) -> Vec<(f64, f64)> {
    let amplitude = |three: &[TurningPoint]| {
        let (first, middle, last) = (three[0].angle_rad, three[1].angle_rad, three[2].angle_rad);
        ((first - middle).abs() + (last - middle).abs()) / 4.0
    };
    let alternate = |three: &&[TurningPoint]| {
        three[0].is_maximum == three[2].is_maximum && three[0].is_maximum != three[1].is_maximum
    };
    turns.windows(3).filter(alternate).map(|three| (amplitude(three), three[2].time_s - three[0].time_s)).collect()
}

/// Adds full turns where the angle (rad) jumps by nearly one between neighbours; gives how often. Only where everything
/// lies within one turn, and only where that makes it even.
pub fn unwrap(angles_rad: &mut [f64]) -> usize {
    let (low, high) = angles_rad.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let is_jump = |pair: &[f64]| (pair[1] - pair[0]).abs() > PI;
    if high - low > TAU * 1.001 || !angles_rad.windows(2).any(is_jump) {
        return 0;
    }
    let mut turns = 0.0;
    let mut n_wraps = 0;
    let mut evened = angles_rad.to_vec();
    for idx in 1..angles_rad.len() {
        let step = angles_rad[idx] - angles_rad[idx - 1];
        if step.abs() > PI {
            turns -= step.signum();
            n_wraps += 1;
        }
        evened[idx] += turns * TAU;
    }
    let largest = |angles: &[f64]| angles.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    if largest(&evened) > PI / 2.0 {
        return 0;
    }
    angles_rad.copy_from_slice(&evened);
    n_wraps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pendulum of `ω0² = 40 /s²` with a little friction, by small steps, at 100 Hz; angles in rad, velocities in rad/s.
    fn swing(start_rad: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let (mut angle, mut velocity) = (start_rad, 0.0_f64);
        let (mut times, mut angles, mut velocities) = (Vec::new(), Vec::new(), Vec::new());
        for idx in 0..3000_u32 {
            times.push(f64::from(idx) * 0.01);
            let noise = f64::from(idx.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
            angles.push(angle + 1e-3 * start_rad * noise);
            velocities.push(velocity + 1e-3 * start_rad * noise);
            for _ in 0..20 {
                velocity += 5e-4 * (-40.0 * angle.sin() - 0.15 * velocity);
                angle += 5e-4 * velocity;
            }
        }
        (times, angles, velocities)
    }

    fn scale(times: &[f64], angles: &[f64]) -> Scale {
        Swings::of(times, angles).unwrap().scale()
    }

    #[test]
    fn the_period_tells_radians_from_degrees_and_rates() {
        for start_rad in [0.5, 1.0, 2.0, 2.8] {
            let (times, angles, velocities) = swing(start_rad);
            assert_eq!(scale(&times, &angles), Scale::Right, "{start_rad}");
            let in_small: Vec<f64> = angles.iter().map(|angle| angle.to_radians()).collect();
            assert!(
                matches!(scale(&times, &in_small), Scale::TooSmall { factor } if (50.0..200.0).contains(&factor)),
                "{start_rad}"
            );
            if start_rad < 1.5 {
                assert!(matches!(scale(&times, &velocities), Scale::TooLarge { .. }), "{start_rad}");
            }
        }
        // Two degrees, read as radians.
        let (times, angles, _) = swing(2_f64.to_radians());
        let degrees: Vec<f64> = angles.iter().map(|angle| angle.to_degrees()).collect();
        assert!(matches!(scale(&times, &degrees), Scale::TooLarge { .. }));
        assert_eq!(scale(&times, &angles), Scale::Unknown);
    }

    #[test]
    fn small_swings_take_what_the_stiffness_says_however_large_those_are_that_were_seen() {
        for start_rad in [0.2, 1.0, 1.8] {
            let (times, angles, velocities) = swing(start_rad);
            let small_s = TAU / 40_f64.sqrt();
            let found_s = Swings::of(&times, &angles).unwrap().small_period_s();
            assert!((found_s / small_s - 1.0).abs() < 2e-3, "{start_rad}: {found_s}");
            let of_rates = TAU / Swings::of(&times, &velocities).unwrap().small_rad_s();
            assert!((of_rates / small_s - 1.0).abs() < 1e-2, "{start_rad}: {of_rates}");
        }
    }

    /// Fourteen swings that halve in ten, of 1 s, longer by a share of the square of their size and shorter by one over it.
    fn swings_of(largest_rad: f64, square: f64, bending: f64) -> Swings {
        let amplitude = |n: u32| largest_rad * 0.5_f64.powf(f64::from(n) / 10.0);
        let scatter = |n: u32| 1e-5 * (f64::from(n.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5);
        let period = |n: u32| 1.0 + square * amplitude(n).powi(2) / 16.0 - bending / amplitude(n) + scatter(n);
        let periods = (0..14).map(|n| (amplitude(n), period(n))).collect();
        Swings { largest_rad, middle_rad: 0.0, period_s: 1.0, periods }
    }

    #[test]
    fn a_period_that_grows_as_where_friction_bends_is_no_other_unit() {
        let bent = swings_of(0.16, 1.0, 2e-3);
        let (growth, spread, _) = bent.growth().unwrap();
        assert!(growth - SURE * spread > MOST_GROWTH, "no case: {growth} ± {spread}");
        assert_eq!(bent.scale(), Scale::Unknown);
        // Where both act the large swings tell the unit all the same.
        for bending in [0.0, 1e-4] {
            let turns = swings_of(0.1, TAU.powi(2), bending).scale();
            assert!(matches!(turns, Scale::TooSmall { factor } if (factor / TAU - 1.0).abs() < 0.1), "{turns:?}");
        }
    }

    /// As where the top of a swing lies between few samples: of nearly equal amplitudes the growth asked for is a millionth.
    #[test]
    fn a_period_that_falls_by_more_than_a_pendulum_s_grows_says_nothing_of_the_unit() {
        let nearly_alike = |fall: f64| {
            let amplitude = |n: u32| 0.4 * (1.0 - 1e-5 * f64::from(n));
            let scatter = |n: u32| 1e-7 * (f64::from(n.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5);
            let periods = (0..30).map(|n| (amplitude(n), 1.0 - fall * amplitude(n) + scatter(n))).collect();
            Swings { largest_rad: 0.4, middle_rad: 0.0, period_s: 1.0, periods }
        };
        let (growth, spread, _) = nearly_alike(1.0).growth().unwrap();
        assert!(growth + SURE * spread < -MOST_GROWTH, "no case: {growth} ± {spread}");
        assert_eq!(nearly_alike(1.0).scale(), Scale::Unknown);
        // One that does not grow at all is that of degrees or of a spring.
        assert!(matches!(nearly_alike(0.0).scale(), Scale::TooLarge { .. }));
    }

    /// A motor swings it to and fro in 1.15 s, one and a half times, and then it swings freely, in 1 s.
    #[test]
    fn driven_swings_at_the_start_are_no_other_unit() {
        let (_, angles, _) = swing(0.13);
        let driven = (0..172_u32).map(|idx| -0.2 * (TAU * f64::from(idx) / 115.0).cos());
        let angles: Vec<f64> = driven.chain(angles).collect();
        let times: Vec<f64> = (0..angles.len()).map(|idx| idx as f64 * 0.01).collect();
        let swings = Swings::of(&times, &angles).unwrap();
        let (growth, spread, _) = swings.growth().unwrap();
        assert!(growth - SURE * spread > MOST_GROWTH, "no case: {growth} ± {spread}");
        assert!(!matches!(swings.scale(), Scale::TooSmall { .. }), "{:?}", swings.scale());
    }

    /// Drawn out to 2.3 rad by a hand, slowly, and let go into the swings of a spring, which always take 1 s.
    #[test]
    fn swings_that_are_smaller_than_the_lift_before_them_show_that_they_are_no_pendulums() {
        let lift = (0..400_u32).map(|idx| -2.3 * f64::from(idx.min(399)) / 400.0);
        let swings = (0..2000_u32).map(|idx| {
            let time_s = f64::from(idx) * 0.01;
            0.3 * (-0.12 * time_s).exp() * (TAU * time_s).sin() - 2.3 * (-4.0 * time_s).exp()
        });
        let angles: Vec<f64> = lift.chain(swings).collect();
        let times: Vec<f64> = (0..angles.len()).map(|idx| idx as f64 * 0.01).collect();
        let swings = Swings::of(&times, &angles).unwrap();
        assert_eq!(swings.scale_of(&swings.periods, swings.largest_rad), Scale::Unknown);
        assert!(matches!(swings.scale(), Scale::TooLarge { .. }), "{swings:?}");
    }

    /// Between two counts it flickers for a minute after six seconds of swing.
    #[test]
    fn a_flicker_at_rest_is_no_period() {
        let counts = |angle: f64| (angle / 0.004).round() * 0.004;
        let mut angles: Vec<f64> = swing(1.0).1.iter().take(600).map(|angle| counts(*angle)).collect();
        angles.extend(
            (0..6000_u32).map(|idx| if (idx / 20).wrapping_mul(2_654_435_761) >> 31 == 0 { 0.004 } else { 0.0 }),
        );
        let times: Vec<f64> = (0..angles.len()).map(|idx| idx as f64 * 0.01).collect();
        let period_s = Swings::of(&times, &angles).unwrap().period_s;
        assert!((0.99..1.1).contains(&period_s), "{period_s}");
    }

    /// Dry friction that takes 0.35 rad in each half swing, from the largest one on.
    #[test]
    fn the_middle_of_swings_that_soon_end_is_where_it_hangs() {
        let half_swing = |time_s: f64| (time_s / 0.5).floor();
        let angle = |time_s: f64| {
            let size = (1.9 - 0.35 * half_swing(time_s)).max(0.0);
            let rest = if half_swing(time_s) as i32 % 2 == 0 { 0.175 } else { -0.175 };
            2.16 + if size > 0.175 { (size - 0.175) * (TAU * time_s).cos() + rest } else { 0.0 }
        };
        let times: Vec<f64> = (0..600).map(|idx| f64::from(idx) * 0.01).collect();
        let angles: Vec<f64> = times.iter().map(|time_s| angle(*time_s)).collect();
        let middle_rad = Swings::of(&times, &angles).unwrap().middle_rad;
        assert!((middle_rad - 2.16).abs() < 0.02, "{middle_rad}");
    }

    #[test]
    fn wraps_are_taken_out_and_jumps_of_other_sizes_are_left() {
        let (_, angles, _) = swing(2.0);
        for begin in [-PI, 0.0] {
            let mut wrapped: Vec<f64> =
                angles.iter().map(|angle| (angle - begin + 0.3).rem_euclid(TAU) + begin).collect();
            let as_read = wrapped.clone();
            let n_wraps = unwrap(&mut wrapped);
            let whole = ((wrapped[0] - angles[0] - 0.3) / TAU).round() * TAU;
            assert!(n_wraps > 0 || wrapped == as_read);
            assert!(wrapped.iter().zip(&angles).all(|(w, a)| (w - whole - a - 0.3).abs() < 1e-9));
        }
        let mut broken = angles.clone();
        broken[700] += 3.0;
        assert_eq!(unwrap(&mut broken), 0);
    }

    #[test]
    fn the_growth_that_is_found_is_told_in_percent_of_the_period() {
        let (times, angles, _) = swing(0.5);
        let larger: Vec<f64> = angles.iter().map(|angle| 4.0 * angle).collect();
        let found = scale(&times, &larger);
        let Scale::TooLarge { predicted_percent, found_percent, .. } = found else { panic!("{found:?}") };
        // The first period between turning points lies a second behind the release, when a swing has lost 7 %.
        let growth = |largest_rad: f64| 100.0 * (lengthening(largest_rad) - lengthening(0.15 * largest_rad));
        assert!((predicted_percent / growth(1.86) - 1.0).abs() < 0.05, "{predicted_percent} {}", growth(1.86));
        assert!((found_percent / growth(0.464) - 1.0).abs() < 0.2, "{found_percent} {}", growth(0.464));
    }
}
