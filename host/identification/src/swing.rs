//! A recording made ready for the fit: the free swing alone, its time counted from its first sample.

pub mod step;
pub mod wandering;
pub mod zero;

use crate::pace;
use crate::recording::noise::Colour;
use crate::recording::noise::rms_about_line;
use crate::recording::plausible::Swings;
use crate::recording::segment::{SegmentError, SegmentOptions, Segments, segment};
use crate::recording::turning::half_swing_s;
use crate::recording::{Fault, Measured, Recording};
use shared::effect::{CURVE_ID, Effect};
use shared::parameters::Parameters;
use simulation::Schedule;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;
use step::{FINE_STEP_S, SIMULATED_TO_RAD, longest_step_s};

/// Why a recording has no swing to fit.
#[derive(Debug, thiserror::Error)]
pub enum SwingError {
    /// No free motion was found.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// What is left can't be used.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// Swings of an angle and of a rate together: the scale of the one sensor is not that of the other.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{angle} holds angles and {rate} rates: they come from two sensors with a scale each; give recordings of one kind"
)]
pub struct MixedReadings {
    /// A recording of angles.
    pub angle: String,
    /// A recording of rates.
    pub rate: String,
}

/// What all swings measure; angles where there are none.
///
/// # Errors
/// They are not of one kind.
pub fn one_kind<'a>(swings: impl Iterator<Item = &'a Swing>) -> Result<Measured, MixedReadings> {
    let (mut angle, mut rate) = (None, None);
    for swing in swings {
        let first = if swing.measured == Measured::Angle { &mut angle } else { &mut rate };
        first.get_or_insert_with(|| swing.name.clone());
    }
    match (angle, rate) {
        (Some(angle), Some(rate)) => Err(MixedReadings { angle, rate }),
        (None, Some(_)) => Ok(Measured::Rate),
        _ => Ok(Measured::Angle),
    }
}

/// What swings of one kind measure; angles where there are none.
pub fn kind(swings: &[Swing]) -> Measured {
    swings.first().map_or(Measured::Angle, |swing| swing.measured)
}

/// How slowly the pendulum of these swings swings: as most of them say.
pub fn pace(swings: &[Swing]) -> f64 {
    let mut paces: Vec<f64> = swings.iter().map(|swing| swing.pace).collect();
    paces.sort_by(f64::total_cmp);
    paces.get(paces.len() / 2).copied().unwrap_or(1.0)
}

/// Seconds of rest, at the usual pace, that are kept behind a swing.
const KEPT_REST_S: f64 = 0.5;

/// A free swing.
#[derive(Clone, Debug)]
pub struct Swing {
    /// What people call it: the file's name.
    pub name: String,
    /// Seconds since the first sample, rising strictly.
    pub times_s: Arc<[f64]>,
    /// When the first sample was taken, s of the recording.
    pub from_s: f64,
    /// Seconds from the release to the first sample: friction that changes on the way does not begin anew with a part.
    pub begins_s: f64,
    /// What was measured.
    pub measured: Measured,
    /// The readings, unfiltered: angles in rad, or rates in rad/s where those were measured.
    pub angles_rad: Vec<f64>,
    /// Total rms noise of the readings, in their unit.
    pub noise_rad: f64,
    /// Present if it is coloured.
    pub colour: Option<Colour>,
    /// Does it not become smaller? Then something drives the pendulum.
    pub is_driven: bool,
    /// What speaks against the recording, in words.
    pub doubts: Vec<String>,
    /// A reading of so much is an amplitude of a radian: 1, or for rates the angular frequency of small swings.
    reading_per_rad: f64,
    /// How slowly the pendulum swings.
    pub pace: f64,
    /// No integration step should be longer, s.
    longest_step_s: f64,
    /// How to step through the times, usually and with effects that change within a few degrees.
    schedules: [Schedule; 2],
    /// Number of samples before the last swings, in which stiction decides.
    n_lively: usize,
    /// Of one of which some samples are left: does it come to rest, as all of them say?
    rests: Option<bool>,
    /// Between what its sensor's zero can lie, in the unit of the readings.
    zero_range: (f64, f64),
}

/// How much of the swings a fit looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// The first so many seconds, without the last swings before rest.
    First(f64),
    /// All but the last swings before rest.
    Lively,
    /// And this share (0 … 1) of the last swings.
    Calming(f64),
    /// Everything.
    Whole,
}

impl Swing {
    /// From times and angles of the free motion, noise in rad. At least three samples, times rising strictly.
    pub fn new(name: &str, times_s: &[f64], angles_rad: &[f64], noise_rad: f64) -> Self {
        Self::build(name, Measured::Angle, 1.0, times_s, angles_rad, noise_rad)
    }

    /// The same from readings of either kind and their noise.
    pub fn of(name: &str, measured: Measured, times_s: &[f64], readings: &[f64], noise: f64) -> Self {
        let small_rad_s = || Swings::of(times_s, readings).map_or(TAU, |swings| swings.small_rad_s());
        let reading_per_rad = if measured == Measured::Rate { small_rad_s() } else { 1.0 };
        Self::build(name, measured, reading_per_rad, times_s, readings, noise)
    }

    /// Other readings of the same sensor on the same pendulum.
    pub fn like(&self, times_s: &[f64], readings: &[f64]) -> Self {
        let other = Self::build(&self.name, self.measured, self.reading_per_rad, times_s, readings, self.noise_rad);
        let (from_s, begins_s, doubts) = (self.from_s + other.from_s, self.begins_s, self.doubts.clone());
        let Self { colour, is_driven, .. } = *self;
        Self { from_s, begins_s, colour, is_driven, doubts, ..other }
    }

    /// A part of it, of which the model knows when it begins.
    pub fn part(&self, range: Range<usize>) -> Self {
        let begins_s = self.begins_s + self.times_s[range.start];
        Self { begins_s, ..self.like(&self.times_s[range.clone()], &self.angles_rad[range]) }
    }

    fn build(
        name: &str,
        measured: Measured,
        reading_per_rad: f64,
        times_s: &[f64],
        readings: &[f64],
        noise_rad: f64,
    ) -> Self {
        let from_s = times_s[0];
        let times_s: Arc<[f64]> = times_s.iter().map(|t| t - times_s[0]).collect();
        let sizes_rad: Vec<f64> = readings.iter().map(|reading| reading / reading_per_rad).collect();
        let n_lively = n_lively(&sizes_rad);
        let lively_rad = &sizes_rad[..n_lively];
        let half_swing_s = half_swing_s(&times_s, lively_rad, noise_rad / reading_per_rad);
        let period_s = 2.0 * half_swing_s.unwrap_or(f64::INFINITY);
        let pace = pace::of_period(period_s);
        let longest_step_s = longest_step_s(&times_s, lively_rad, period_s, pace);
        let is_swing = measured == Measured::Angle && half_swing_s.is_some();
        let last = last_period(&times_s, pace);
        let zero_range = if is_swing { zero::range_rad(&readings[last..]) } else { zero::ANYWHERE };
        Self {
            name: name.to_owned(),
            n_lively,
            measured,
            angles_rad: readings.to_vec(),
            reading_per_rad,
            schedules: schedules(&times_s, longest_step_s, pace, 1.0, measured),
            times_s,
            from_s,
            begins_s: 0.0,
            pace,
            noise_rad,
            colour: None,
            is_driven: false,
            doubts: Vec::new(),
            longest_step_s,
            rests: None,
            zero_range,
        }
    }

    /// Names of those that a motor or a hand drives.
    pub fn driven(swings: &[Self]) -> Vec<String> {
        swings.iter().filter(|swing| swing.is_driven).map(|swing| swing.name.clone()).collect()
    }

    /// The readings as sizes of the motion about the zero with which a search begins, rad: angles as they are, rates as the
    /// amplitude that would make them.
    pub fn sizes_rad(&self) -> impl Iterator<Item = f64> {
        let zero = self.first_zero();
        self.angles_rad.iter().map(move |reading| self.size_rad(reading - zero))
    }

    /// How far it goes from there, rad.
    pub fn largest_rad(&self) -> f64 {
        self.sizes_rad().fold(0.0, |largest, size| largest.max(size.abs()))
    }

    /// The sum of the squares of its readings about that zero: what a model loses that hangs still.
    pub fn motion(&self) -> f64 {
        let zero = self.first_zero();
        self.angles_rad.iter().map(|reading| (reading - zero).powi(2)).sum()
    }

    /// A difference of readings as a size of the motion, rad.
    pub fn size_rad(&self, reading: f64) -> f64 {
        reading / self.reading_per_rad
    }

    /// The same in another noise (rms, in the unit of the readings), which is coloured.
    pub fn in_noise(&self, noise_rad: f64, colour: Colour) -> Self {
        Self { noise_rad, colour: Some(colour), ..self.clone() }
    }

    /// The same swing, of which the model's angles are asked, whatever was measured.
    pub fn asking_for_angles(&self) -> Self {
        let schedules = self.schedules.clone().map(|schedule| schedule.reading(Measured::Angle));
        Self { schedules, ..self.clone() }
    }

    /// The longest free swing of a recording and what was cut off.
    pub fn from_recording(
        name: &str,
        recording: &Recording,
        options: &SegmentOptions,
    ) -> Result<(Self, Segments), SwingError> {
        Self::of_segments(name, recording, segment(recording, options)?, options)
    }

    /// The free swing that was found in a recording. Of the rest at the end only the beginning is kept: it tells
    /// where the pendulum stopped, more of it tells nothing.
    pub(crate) fn of_segments(
        name: &str,
        recording: &Recording,
        mut segments: Segments,
        options: &SegmentOptions,
    ) -> Result<(Self, Segments), SwingError> {
        let times_s = recording.times_s();
        let pace = pace::of_period(2.0 * segments.half_swing_s);
        let rest_s = segments.rest.as_ref().map_or(f64::INFINITY, |rest| times_s[rest.start] + KEPT_REST_S * pace);
        let range = match options.to_s {
            Some(_) => segments.free.clone(),
            None => {
                let end = segments.rest.as_ref().map_or(segments.free.end, |rest| rest.end);
                segments.free.start..times_s[..end].partition_point(|t| *t <= rest_s)
            }
        };
        let part = recording.part(range.clone())?;
        let is_swing = |idx: usize| !segments.interrupted.iter().any(|lost| lost.contains(&(range.start + idx)));
        let seen = |values: &[f64]| -> Vec<f64> {
            values.iter().enumerate().filter_map(|(idx, value)| is_swing(idx).then_some(*value)).collect()
        };
        let (times_s, readings) = (seen(part.times_s()), seen(part.angles_rad()));
        let noise = segments.noise.level_rad();
        let mut swing = Self::of(name, recording.measured(), &times_s, &readings, noise);
        let least = SIMULATED_TO_RAD * swing.reading_per_rad;
        if noise < least {
            segments.notes.push(too_little_noise(recording.measured(), noise, least));
            // Whoever asks for the noise of the recording shall judge alike.
            (swing.noise_rad, segments.noise.total_rms) = (least, least);
        }
        let notes = recording.notes().iter().chain(&segments.notes);
        let doubts = notes.filter_map(|note| note.strip_prefix("doubtful: ")).map(str::to_owned).collect();
        let colour = segments.noise.colour;
        Ok((Self { colour, is_driven: !segments.fades, doubts, ..swing }, segments))
    }

    /// Is its noise only what a simulation is accurate to?
    pub fn has_no_noise(&self) -> bool {
        self.noise_rad <= SIMULATED_TO_RAD * self.reading_per_rad
    }

    /// How to step through the times with this model.
    pub fn schedule<R>(&self, parameters: &Parameters<R>) -> &Schedule {
        let is_fine = |id: u16| id != CURVE_ID && Effect::<f64>::by_id(id).is_none_or(|effect| effect.is_fine);
        &self.schedules[usize::from(parameters.effects.iter().any(|effect| is_fine(effect.id)))]
    }

    /// Integration steps of a simulation with effects that are not fine.
    pub fn n_steps(&self) -> usize {
        self.schedules[0].n_steps()
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// True without any sample.
    pub fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    /// Length in seconds.
    pub fn duration_s(&self) -> f64 {
        self.times_s.last().copied().unwrap_or(0.0)
    }

    /// Does it end at rest? Its last samples then scatter no more than the noise, about a line because a zero may drift.
    pub fn comes_to_rest(&self) -> bool {
        self.rests.unwrap_or_else(|| self.ends_still())
    }

    fn ends_still(&self) -> bool {
        let last = self.last_readings();
        let is_still = || rms_about_line(last) < REST_NOISES * self.noise_rad;
        last.len() >= MIN_START_SAMPLES && (is_still() || self.are_neighbours(last))
    }

    /// Two codes beside each other: a quiet sensor that rests on the edge between them scatters by half a step.
    fn are_neighbours(&self, readings: &[f64]) -> bool {
        let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
        high - low < NEIGHBOURS_NOISES * self.noise_rad && readings.iter().all(|x| *x == low || *x == high)
    }

    /// The mean of its last readings: where it rests, if it does.
    pub fn rest(&self) -> f64 {
        let last = self.last_readings();
        last.iter().sum::<f64>() / last.len().max(1) as f64
    }

    fn last_readings(&self) -> &[f64] {
        &self.angles_rad[self.times_s.partition_point(|t| *t < self.duration_s() - REST_S * self.pace)..]
    }

    /// Half of how far it still swings in its last period, rad.
    pub fn last_amplitude_rad(&self) -> f64 {
        let last =
            self.angles_rad[last_period(&self.times_s, self.pace)..].iter().map(|reading| self.size_rad(*reading));
        let (low, high) = last.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        0.5 * (high - low)
    }

    /// Between what its sensor's zero can lie, in the unit of the readings.
    pub fn zero_range(&self) -> (f64, f64) {
        self.zero_range
    }

    /// The zero with which a search begins.
    pub fn first_zero(&self) -> f64 {
        zero::first_rad(self.zero_range)
    }

    /// Every k-th sample, so that about `rate_hz` remain; unchanged if there are no more than that.
    pub fn thinned(&self, rate_hz: f64) -> Self {
        let every = ((self.len() as f64 / self.duration_s() / rate_hz) as usize).max(1);
        let pick = |values: &[f64]| values.iter().step_by(every).copied().collect::<Vec<f64>>();
        Self { rests: Some(self.comes_to_rest()), ..self.like(&pick(&self.times_s), &pick(&self.angles_rad)) }
    }

    /// Enough of it to find the way to the best values: few samples, and steps that are too long for the last digit.
    pub fn decimated(&self) -> Self {
        let thin = self.thinned(DECIMATED_RATE_HZ / self.pace);
        let schedules = schedules(&thin.times_s, self.longest_step_s, self.pace, DECIMATED_STEP, self.measured);
        Self { schedules, pace: self.pace, ..thin }
    }

    /// The same times with other readings.
    pub fn reading(&self, angles_rad: Vec<f64>) -> Self {
        Self { angles_rad, ..self.clone() }
    }

    /// Number of samples in a window.
    pub fn samples_within(&self, window: Window) -> usize {
        match window {
            Window::First(seconds) => self.times_s.partition_point(|t| *t <= seconds).min(self.n_lively),
            Window::Lively => self.n_lively,
            Window::Calming(share) => self.n_lively + (share * (self.len() - self.n_lively) as f64) as usize,
            Window::Whole => self.len(),
        }
    }

    /// Angle (rad) and velocity (rad/s) at the first sample.
    pub fn start_guess(&self) -> (f64, f64) {
        let (reading, slope) = self.first_reading();
        match self.measured {
            Measured::Angle => (reading, slope),
            Measured::Rate => (self.angle_at_start(reading, slope), reading),
        }
    }

    /// Reading and slope at the first sample, by a parabola through the first samples.
    fn first_reading(&self) -> (f64, f64) {
        let n_samples = self
            .samples_within(Window::First(START_FIT_S * self.pace))
            .clamp(MIN_START_SAMPLES.min(self.len()), self.len());
        let rows = nalgebra::DMatrix::from_fn(n_samples, 3, |i, j| self.times_s[i].powi(j as i32));
        let readings = nalgebra::DVector::from_column_slice(&self.angles_rad[..n_samples]);
        match rows.svd(true, true).solve(&readings, 1e-12) {
            Ok(fit) => (fit[0], fit[1]),
            Err(_) => (self.angles_rad[0], 0.0),
        }
    }

    /// From the rate at the start and the largest of the first swing by the energy, `½ ω² − ω0² cos θ` being even; it
    /// speeds up towards the lowest point.
    fn angle_at_start(&self, rate_rad_s: f64, acceleration_rad_s2: f64) -> f64 {
        let small_rad_s = self.reading_per_rad;
        let first_s = FIRST_SWING * TAU / small_rad_s;
        let first = self.times_s.partition_point(|t| *t <= first_s);
        let largest = self.angles_rad[..first].iter().fold(rate_rad_s.abs(), |largest, rate| largest.max(rate.abs()));
        let fallen = (largest.powi(2) - rate_rad_s.powi(2)) / (2.0 * small_rad_s.powi(2));
        -acceleration_rad_s2.signum() * (1.0 - fallen).clamp(-1.0, 1.0).acos()
    }
}

/// Where the last period begins.
fn last_period(times_s: &[f64], pace: f64) -> usize {
    let end_s = times_s.last().copied().unwrap_or(0.0);
    times_s.partition_point(|t| *t < end_s - LAST_PERIOD_S * pace)
}

/// Usual and fine steps, each so many times as long as it need be.
fn schedules(times_s: &Arc<[f64]>, longest_step_s: f64, pace: f64, factor: f64, measured: Measured) -> [Schedule; 2] {
    [longest_step_s, longest_step_s.min(FINE_STEP_S * pace.max(1.0))]
        .map(|step_s| Schedule::new(times_s, factor * step_s).reading(measured))
}

/// Samples up to the last one at which the pendulum is still far from its middle.
fn n_lively(angles_rad: &[f64]) -> usize {
    let (low, high) = angles_rad.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let amplitude = low.abs().max(high.abs());
    let threshold = LIVELY_RAD.max(LIVELY_SHARE * amplitude).min(0.5 * amplitude);
    angles_rad.iter().rposition(|x| x.abs() > threshold).map_or(angles_rad.len(), |last| last + 1)
}

/// Below this angle, and below this share of the largest, stiction may decide.
const LIVELY_RAD: f64 = 0.12;
const LIVELY_SHARE: f64 = 0.1;

/// A decimated swing has so many samples a second at the usual pace, and steps so many times as long: 40 to a period,
/// 3e-5 rad off.
const DECIMATED_RATE_HZ: f64 = 50.0;
const DECIMATED_STEP: f64 = 2.0;

/// That the readings have less noise than a model can be judged by.
fn too_little_noise(measured: Measured, noise: f64, least: f64) -> String {
    let unit = measured.milli_unit();
    let (noise, least) = (1e3 * noise, 1e3 * least);
    format!(
        "the readings have a noise of {noise:.1e} {unit}, as those of a simulation have; a model is simulated to {least:.2} \
         {unit}, which counts as noise"
    )
}

/// At rest the pendulum has been still for this long at the usual pace, s, and scatters by less than so many times the
/// noise.
const REST_S: f64 = 0.4;
const REST_NOISES: f64 = 1.5;

/// Two values that are less than so many noises apart are neighbours: of a sensor without noise a step is √12 of them, and
/// two steps are 6.9; with more noise they are less.
const NEIGHBOURS_NOISES: f64 = 5.0;

/// A period of the usual pace and half of it, because a pace is a power of two, s.
const LAST_PERIOD_S: f64 = 1.5;

/// A parabola follows the pendulum this long at the usual pace, s.
const START_FIT_S: f64 = 0.06;

/// The largest rate of the first swing comes within so many periods of small swings.
const FIRST_SWING: f64 = 1.3;

/// Fewer would not tell noise from velocity.
const MIN_START_SAMPLES: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_part_begins_as_long_after_the_release_as_its_first_sample() {
        let times_s: Vec<f64> = (0..2000).map(|i| f64::from(i) * 5e-3).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|t| (6.0 * t).cos()).collect();
        let whole = Swing::new("one", &times_s, &angles_rad, 1e-4);
        let part = whole.part(400..1600).part(200..900);
        assert!((part.begins_s - 3.0).abs() < 1e-9 && part.times_s[0] == 0.0, "{}", part.begins_s);
        assert_eq!(part.angles_rad, angles_rad[600..1300]);
        // So does it with fewer samples.
        assert_eq!(part.decimated().begins_s, part.begins_s);
    }

    /// A second of swinging in steps and a second of readings behind it.
    fn ending_with(last_steps: impl Fn(usize) -> f64, noise_steps: f64) -> Swing {
        let times_s: Vec<f64> = (0..400).map(|i| f64::from(i) * 5e-3).collect();
        let swinging = |i: usize| (300.0 * (0.03 * i as f64).cos()).round();
        let steps = (0..400).map(|i| if i < 200 { swinging(i) } else { last_steps(i) });
        let angles_rad: Vec<f64> = steps.map(|steps| 1e-3 * steps).collect();
        Swing::new("in steps", &times_s, &angles_rad, 1e-3 * noise_steps)
    }

    /// Of the few that are left, all may be far off by chance.
    #[test]
    fn a_decimated_swing_rests_as_all_samples_say() {
        let off = |i: usize| if i.is_multiple_of(4) { [2.5, -2.5][i / 4 % 2] } else { 0.0 };
        for (last, rests) in
            [(ending_with(off, 1.0), true), (ending_with(|i| 20.0 * (0.1 * i as f64).cos(), 1.0), false)]
        {
            assert_eq!((last.comes_to_rest(), last.decimated().comes_to_rest()), (rests, rests));
            assert!(last.decimated().len() < last.len() / 3);
        }
    }

    #[test]
    fn a_quiet_sensor_rests_on_the_edge_between_two_codes_too() {
        // A tenth of a step of noise, and what rounding makes.
        let noise_steps = (0.01_f64 + 1.0 / 12.0).sqrt();
        let every_other = |i: usize| f64::from(u8::from(i.is_multiple_of(2)));
        assert!(ending_with(every_other, noise_steps).comes_to_rest());
        assert!(!ending_with(|i| 2.0 * every_other(i), noise_steps).comes_to_rest());
        assert!(!ending_with(|i| every_other(i) + every_other(i / 2), noise_steps).comes_to_rest());
    }
}
