//! Where the pendulum swings freely: after it was held or touched, until it hangs still.
//!
//! In: a recording, perhaps with the user's own limits. Out: index ranges and what was cut, in words.
//!
//! A free pendulum obeys `α = −ω0² sin θ + b cos θ − c sgn ω − d ω − e ω|ω|`. The five numbers are fitted to the middle
//! of the recording, robustly; where the acceleration (from local polynomials) is off by far more than noise, a hand
//! did it. The free swing is the undisturbed stretch with the most swings. The friction law is crude on purpose:
//! it must recognise a hand, which does tens of rad/s², and be blind to every kind of missing physics.
//! If the pendulum was held still before, the release is placed to a few ms by fitting the start of the fall; the free
//! range begins shortly after it, never before.

mod anew;
mod backwards;
mod ends;
mod interrupted;
mod law;
mod middle;
mod several;
mod start;
mod stretch;
mod too_few;

use super::noise::{self, Noise};
use super::places::as_gaps;
use super::turning::{self, TurningPoint};
use super::{Measured, Recording};
use crate::number::significant;
use law::{Law, State, states};
pub use several::{FreeSwing, free_swings};
use start::Start;
use std::cmp::Reverse;
use std::ops::Range;
use thiserror::Error;

/// Two swings there and back.
const MIN_TURNING_POINTS: usize = 4;

/// Stillness is doubted when the mean over a short window leaves the start by this many of its standard deviations.
const STILL_SPREADS: f64 = 5.0;

/// A noise found from n samples is known to about 1/√n of itself; beyond so many times this, it is another noise. Among
/// 10,000 samples a jump of 60 noises is noticed; with half of it one of 40, with twice of it one of 90, and with half of it
/// chance would now and then take the noise of the free swing, which is known less well.
const NOISE_SPREADS: f64 = 5.0;

/// Digits of a noise that a message shows.
const NOISE_DIGITS: usize = 3;

/// What is taken of a recording is doubted where it swings over less than this share of what a longer part swings over that is
/// cut. Half and twice of it say the same of the recording in water for which it was made, whose tail keeps a thirteenth.
const SMALL_TAIL: f64 = 0.3;

/// Times are shown to so much, s.
const SHOWN_S: f64 = 0.01;

/// A free swing of ten hours; a simulation of more would want more memory than there is.
const LONGEST_S: f64 = 36_000.0;

/// The user's own limits, s; `None` = found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SegmentOptions {
    /// `--from`: the free swing begins here.
    pub from_s: Option<f64>,
    /// `--to`: the free swing ends here.
    pub to_s: Option<f64>,
}

/// The parts of a recording, as ranges of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    /// Held still at the beginning, before the release or before a hand lifted it.
    pub lead_in: Option<Range<usize>>,
    /// Swinging freely, down to the final stop.
    pub free: Range<usize>,
    /// Samples of the free swing that are none of it, though it goes on behind: left out.
    pub interrupted: Vec<Range<usize>>,
    /// Parts beside it that may be free swings as well.
    pub others: Vec<Range<usize>>,
    /// Hanging still at the end.
    pub rest: Option<Range<usize>>,
    /// The release, s: fitted when it was held still before, else the begin of the free range.
    pub release_s: f64,
    /// Turning points within the free range.
    pub n_turning_points: usize,
    /// A typical half swing, s.
    pub half_swing_s: f64,
    /// Noise of the whole recording, or of the free range alone where something else jumps.
    pub noise: Noise,
    /// Do the swings become smaller, as free ones must?
    pub fades: bool,
    /// What was cut and why, in words.
    pub notes: Vec<String>,
}

fn turning_points(n: usize) -> String {
    if n == 1 { "one turning point".to_owned() } else { format!("{n} turning points") }
}

/// Why there is no free swing.
#[derive(Debug, Error, PartialEq)]
pub enum SegmentError {
    /// Too short.
    #[error(
        "only {} of free swing in {duration_s:.2} s, expected at least \
         {MIN_TURNING_POINTS} (two swings); release from a larger angle, record longer, or choose the stretch with \
         --from and --to",
        turning_points(*n_turning_points)
    )]
    TooFewSwings {
        /// Turning points found.
        n_turning_points: usize,
        /// Length of the stretch, s.
        duration_s: f64,
    },
    /// Because a motor moves it most of the time.
    #[error(
        "only {} of free swing, because {column} moves it: it goes from {low} to {high} and is on in {percent:.0} % of the \
         recording; record how it swings with the motor off, or choose such a stretch with --from and --to",
        turning_points(*n_turning_points)
    )]
    Driven {
        /// Turning points found.
        n_turning_points: usize,
        /// What messages call the column of the motor.
        column: String,
        /// The smallest number in it, as shown.
        low: String,
        /// The largest one.
        high: String,
        /// Of the samples, at which it is on.
        percent: f64,
    },
    /// Because nothing between them is there.
    #[error(
        "of {n_samples} readings nearly each is a turning point: there are one or two in a half swing, or the turning points \
         alone were written down; how it swings shows from ten readings a swing on"
    )]
    OnlyTurns {
        /// Readings there are.
        n_samples: usize,
    },
    /// Something drives it.
    #[error(
        "its swings grow, from {} to {} {unit} to either side, where free ones die away: something drives it (a motor, a \
         hand, a support that moves); record it once it is let go and left alone, or choose the stretch in which it dies \
         away with --from and --to",
        significant(*from, 2),
        significant(*to, 2)
    )]
    Grows {
        /// Where they begin to grow, in the unit of the readings.
        from: f64,
        /// Where they end to, the same.
        to: f64,
        /// Of the readings.
        unit: &'static str,
    },
    /// Longer than any pendulum swings.
    #[error(
        "{duration_s:e} s of free swing, expected at most {LONGEST_S} s; is the time in seconds? Otherwise choose the \
         stretch with --from and --to"
    )]
    TooLong {
        /// Length of the stretch, s.
        duration_s: f64,
    },
    /// Limits that leave nothing.
    #[error(
        "--from {from_s} s and --to {to_s} s leave {n_samples} samples; the recording goes from {first_s} s to {last_s} s"
    )]
    NothingBetween {
        /// Lower limit, s.
        from_s: f64,
        /// Upper limit, s.
        to_s: f64,
        /// Samples between them.
        n_samples: usize,
        /// First time of the recording, s.
        first_s: f64,
        /// Last time, s.
        last_s: f64,
    },
}

/// Finds the free swing.
///
/// # Errors
/// Fewer than two swings, or limits outside the recording.
pub fn segment(recording: &Recording, options: &SegmentOptions) -> Result<Segments, SegmentError> {
    let asked = asked_range(recording, options)?;
    free_swing(recording, options, asked.clone()).map_err(|fault| too_few::explained(fault, recording, &asked))
}

fn free_swing(recording: &Recording, options: &SegmentOptions, asked: Range<usize>) -> Result<Segments, SegmentError> {
    let whole = Cut::new(recording, asked.clone())?;
    let hanging = whole.of_hanging();
    let hanging = hanging.as_ref().unwrap_or(&whole);
    let found = hanging.undisturbed()?;
    // What the user says stands, whatever lies in it.
    let alone = if *options == SegmentOptions::default() { hanging.alone(&found) } else { None };
    let (cut, stretch) = alone.as_ref().map_or((hanging, found), |(cut, stretch)| (cut, stretch.clone()));
    let rest = if options.to_s.is_some() { None } else { cut.rest(&stretch) };
    let mut start = if options.from_s.is_some() { Start::at(cut, asked.start) } else { cut.start(&stretch) };
    let end = match &rest {
        Some(rest) => rest.start,
        None if options.to_s.is_some() => asked.end,
        None => stretch.end,
    };
    let fallen = if options.from_s.is_some() { start.free_idx } else { cut.fallen(start.free_idx, end) };
    let is_enough = |(idx, _): &(usize, &str)| cut.count_turns(&(*idx..end)) >= MIN_TURNING_POINTS;
    let carried = cut.carried_until(fallen, end).filter(is_enough).filter(|_| options.from_s.is_none());
    let begin = carried.map_or(fallen, |(idx, _)| idx);
    let is_doubted = [options.from_s.is_none(), options.to_s.is_none() && rest.is_none()];
    let free = cut.between_hands(begin..end.max(begin), is_doubted);
    if free.start > begin && begin == start.free_idx {
        start.moved_to(free.start, cut.times_s()[free.start]);
    }
    let n_turning_points = cut.count_turns(&free);
    let duration_s = cut.duration_s(&free);
    if duration_s > LONGEST_S {
        return Err(SegmentError::TooLong { duration_s });
    }
    if n_turning_points < MIN_TURNING_POINTS {
        return Err(SegmentError::TooFewSwings { n_turning_points, duration_s });
    }
    let (held, hanging) = cut.held_or_hanging(&start);
    let quiet_end = if options.to_s.is_some() { None } else { cut.quiet_end(&stretch) };
    let noise = cut.noise(&free).beside_still(recording, [hanging, quiet_end], held);
    let mut notes = notes([&whole, cut], options, &start, &(fallen.max(start.free_idx)..free.end), rest.as_ref());
    let touches = |lost: &&Range<usize>| lost.start < free.end && free.start < lost.end;
    let interrupted: Vec<Range<usize>> = cut.interrupted.iter().filter(touches).cloned().collect();
    notes.extend(interrupted_in_words(recording, &interrupted));
    notes.extend(carried.map(|(idx, column)| {
        let more_s = cut.times_s()[idx] - cut.times_s()[fallen];
        format!("cut {more_s:.2} s more in which {column} still moves; --from begins earlier")
    }));
    notes.extend(wandering(recording, &noise));
    notes.extend(cut.moved_in_words(&free));
    let (free_s, free_rad) = (&recording.times_s()[free.clone()], &recording.angles_rad()[free.clone()]);
    notes.extend(recording.unit.and_then(|unit| unit.doubt(free_s, free_rad)));
    let still = noise.still_rms.map_or("nothing known".to_owned(), |rms| format!("{rms:.3e} rad"));
    log::debug!(
        "noise {:.3e} rad from {}, {still} where it is still; free swing {free:?}",
        noise.total_rms,
        noise.method
    );
    let fades = cut.fades(&free);
    let others = if *options == SegmentOptions::default() { whole.other_swings(&free) } else { Vec::new() };
    let (lead_in, release_s, half_swing_s) = (start.lead_in, start.release_s, cut.half_swing_s);
    Ok(Segments {
        lead_in,
        free,
        interrupted,
        others,
        rest,
        release_s,
        n_turning_points,
        half_swing_s,
        noise,
        fades,
        notes,
    })
}

fn asked_range(recording: &Recording, options: &SegmentOptions) -> Result<Range<usize>, SegmentError> {
    let (first_s, last_s) = (recording.times_s()[0], recording.times_s()[recording.len() - 1]);
    let (from_s, to_s) = (options.from_s.unwrap_or(first_s), options.to_s.unwrap_or(last_s));
    let start = recording.index_at(from_s);
    let end = recording.times_s().partition_point(|time_s| *time_s <= to_s);
    let n_samples = end.saturating_sub(start);
    if n_samples < super::limits::MIN_SAMPLES {
        return Err(SegmentError::NothingBetween { from_s, to_s, n_samples, first_s, last_s });
    }
    Ok(start..end)
}

/// Everything known about the asked part of a recording while it is cut.
struct Cut<'a> {
    recording: &'a Recording,
    asked: Range<usize>,
    whole_noise: Noise,
    /// Of neighbours, or where it wanders the white noise that would scatter means over parts of a swing so.
    noise_rms_rad: f64,
    width_s: f64,
    half_swing_s: f64,
    turns: Vec<TurningPoint>,
    states: Vec<State>,
    law: Law,
    disturbed: Vec<bool>,
    interrupted: Vec<Range<usize>>,
}

impl<'a> Cut<'a> {
    fn new(recording: &'a Recording, asked: Range<usize>) -> Result<Self, SegmentError> {
        let (times_s, angles_rad) = (&recording.times_s()[asked.clone()], &recording.angles_rad()[asked.clone()]);
        let noise = noise::estimate(recording);
        let white_rad = noise::of_most_samples(times_s, angles_rad, &noise);
        let rough_s = turning::half_swing_s(times_s, angles_rad, white_rad);
        let of_means = |half_swing_s| noise::noise_of_means(times_s, angles_rad, white_rad, half_swing_s);
        let noise_rms_rad = rough_s.map_or(white_rad, of_means);
        let turns = turning::turning_points(times_s, angles_rad, noise_rms_rad);
        let half_swing_s = turning::half_swing_s(times_s, angles_rad, noise_rms_rad);
        let duration_s = times_s[times_s.len() - 1] - times_s[0];
        let too_few = SegmentError::TooFewSwings { n_turning_points: turns.len(), duration_s };
        let (Some(half_swing_s), true) = (half_swing_s, turns.len() >= MIN_TURNING_POINTS) else { return Err(too_few) };
        let width_s = turning::quartic_width_s(half_swing_s, recording.step_s());
        // What its colour adds to accelerations shows in how far they are off the law anyway.
        let states = states(times_s, angles_rad, white_rad, width_s);
        let mut cut = Self {
            recording,
            asked,
            whole_noise: noise,
            noise_rms_rad,
            width_s,
            half_swing_s,
            turns,
            states,
            law: Law::zeros(),
            disturbed: Vec::new(),
            interrupted: Vec::new(),
        };
        cut.find_disturbances().ok_or(too_few)?;
        if recording.measured() == Measured::Angle {
            cut.interrupted = cut.forgive_interruptions();
        }
        Ok(cut)
    }

    /// The same of the longest stretch that hangs, by its swings, where a motor holds it upright in others: how it moves there tells
    /// of no law.
    fn of_hanging(&self) -> Option<Self> {
        let parts = self.hanging_parts(self.asked.clone());
        let alone = |part: Range<usize>| {
            let alone = Self::new(self.recording, part).ok()?;
            let n_turns = alone.count_turns(&alone.undisturbed().ok()?);
            Some((n_turns, alone))
        };
        let is_part = |part: &Range<usize>| *part != self.asked && part.len() >= super::limits::MIN_SAMPLES;
        let found = parts.into_iter().filter(is_part).filter_map(alone);
        found.max_by_key(|(n_turns, _)| *n_turns).map(|(_, alone)| alone)
    }

    /// The same without what lies behind a stretch, or before it as well, and the stretch anew, if it is not shorter by that: what
    /// a hand does, and other swings, tell of no law that this one follows.
    fn alone(&self, stretch: &Range<usize>) -> Option<(Self, Range<usize>)> {
        let is_before = |part: &Range<usize>| part.end <= stretch.start && self.count_turns(part) >= MIN_TURNING_POINTS;
        let before = self.parts_left_alone().filter(is_before).map(|part| part.end).max();
        let before = before.filter(|end| self.is_disturbed_within(&(*end..stretch.start)));
        let parts = [Some(self.asked.start), before].into_iter().flatten().map(|start| start..stretch.end);
        let again = |part: Range<usize>| {
            let alone = Self::new(self.recording, part).ok()?;
            let again = alone.undisturbed().ok()?;
            again.contains(&usize::midpoint(stretch.start, stretch.end)).then_some((alone, again))
        };
        let n_swings = |(alone, again): &(Self, Range<usize>)| alone.count_swings(again);
        let found =
            parts.filter(|part| *part != self.asked).filter_map(again).min_by_key(|it| Reverse(n_swings(it)))?;
        (n_swings(&found) >= self.count_swings(stretch)).then_some(found)
    }

    /// Of the whole recording, which tells it best, unless that is larger than chance makes it beside the free swing:
    /// where a pendulum is put down or let go, the angle may jump.
    fn noise(&self, free: &Range<usize>) -> Noise {
        let of_free = noise::of_part(self.recording, free.clone());
        let chance = NOISE_SPREADS / (free.len() as f64).sqrt();
        if self.whole_noise.total_rms > of_free.total_rms * (1.0 + chance) { of_free } else { self.whole_noise.clone() }
    }

    fn times_s(&self) -> &'a [f64] {
        &self.recording.times_s()[..self.asked.end]
    }

    fn angles_rad(&self) -> &'a [f64] {
        &self.recording.angles_rad()[..self.asked.end]
    }

    fn duration_s(&self, range: &Range<usize>) -> f64 {
        match range.len() {
            0 => 0.0,
            _ => self.times_s()[range.end - 1] - self.times_s()[range.start],
        }
    }

    fn count_turns(&self, range: &Range<usize>) -> usize {
        let in_range = |time_s: f64| range.contains(&self.recording.index_at(time_s));
        self.turns.iter().filter(|turn| in_range(turn.time_s)).count()
    }

    fn n_in(&self, duration_s: f64) -> usize {
        ((duration_s / self.recording.step_s()).round() as usize).min(self.asked.len()).max(3)
    }
}

/// What a hold says of the noise, if it says more of it than the swing.
fn wandering(recording: &Recording, noise: &Noise) -> Option<String> {
    let [still, swinging] = [noise.still_rms.filter(|_| noise.wanders_where_held)?, noise.total_rms]
        .map(|rms| significant(1e3 * rms, NOISE_DIGITS));
    let unit = recording.measured().milli_unit();
    Some(format!(
        "it scatters by {still} {unit} rms while it is held, where white noise as seen in the swing would by {swinging}: a hand \
         that trembles, or a sensor whose noise is alike in neighbouring readings, and larger than it seems; let it swing \
         until it hangs still to tell them apart"
    ))
}

fn interrupted_in_words(recording: &Recording, interrupted: &[Range<usize>]) -> Option<String> {
    let first = interrupted.first()?;
    let n_rows: usize = interrupted.iter().map(Range::len).sum();
    let (n, from_s) = (interrupted.len(), recording.times_s()[first.start]);
    let (places, first_s) = match n {
        1 => (String::new(), format!("from {from_s:.2} to {:.2} s", recording.times_s()[first.end])),
        n => (format!(" at {n} places"), format!("at {from_s:.2} s first")),
    };
    Some(format!(
        "{n_rows} readings{places} leave the swing, {first_s}, and the same swing goes on behind, as when a tracker loses it or \
         somebody stands in the picture: left out as {}",
        as_gaps(n)
    ))
}

fn moved_after(time_s: f64) -> String {
    format!(
        "everything after {time_s:.2} s: something other than gravity and friction moved it there (a hand, a stop, or a tracker \
         that lost it); --to ends later"
    )
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// What may have moved it before its free swing, and what to do if nothing did.
const NOT_FREE: &str = " (a hand, a motor, a stop, or a tracker that lost it); --from begins earlier";

/// That the best of the swings may be what is cut: it takes longer than all that is left, and swings far larger.
fn doubt_of_tail(cut: &Cut, before: &Range<usize>, free: &Range<usize>) -> Option<String> {
    let (largest_rad, taken_rad) = (cut.largest_rad(before)?, cut.largest_rad(free)?);
    let is_tail = cut.duration_s(before) > cut.duration_s(free) && taken_rad < SMALL_TAIL * largest_rad;
    is_tail.then(|| {
        let times = largest_rad / taken_rad;
        format!("doubtful: what is cut before takes longer and swings {times:.0} times as far; is that the free swing?")
    })
}

fn notes(
    [cut, alone]: [&Cut; 2],
    options: &SegmentOptions,
    start: &Start,
    free: &Range<usize>,
    rest: Option<&Range<usize>>,
) -> Vec<String> {
    let first_s = cut.times_s()[cut.asked.start];
    let mut notes = Vec::new();
    let begins_s = cut.times_s()[0];
    if let Some(from_s) = options.from_s.filter(|from_s| *from_s > 0.0 && *from_s < begins_s) {
        notes.push(format!("--from {from_s} is before it begins: its own clock starts at {begins_s} s"));
    }
    let free_s = cut.times_s()[start.free_idx];
    let before_s = free_s - first_s;
    // A part of a recording begins somewhere on its clock, which --from means.
    let up_to = if first_s.abs() < SHOWN_S { String::new() } else { format!(", up to {free_s:.2} s") };
    match (&start.lead_in, options.from_s) {
        (_, Some(from_s)) => notes.push(format!("free swing taken from {from_s} s on, as told")),
        (_, None) if start.was_held => {
            let other = if alone.asked.start > cut.asked.start { ": another motion, then" } else { "" };
            notes.push(format!("cut {before_s:.2} s{other} held still before the release at {:.3} s", start.release_s));
        }
        (Some(still), None) if start.free_idx > cut.asked.start => {
            notes.push(format!(
                "cut {before_s:.2} s{up_to}: still for {:.2} s, and then it does not follow a free swing{NOT_FREE}",
                cut.duration_s(still)
            ));
        }
        (None, None) if start.free_idx > cut.asked.start => {
            notes.push(format!(
                "cut the first {before_s:.2} s{up_to}: until then it does not follow a free swing{NOT_FREE}"
            ));
        }
        _ => {}
    }
    if options.from_s.is_none() && !start.was_held {
        notes.extend(doubt_of_tail(cut, &(cut.asked.start..start.free_idx), free));
    }
    if free.start > start.free_idx {
        let more_s = cut.times_s()[free.start] - cut.times_s()[start.free_idx];
        notes.push(format!(
            "cut {more_s:.2} s more near upright, where the least push decides when it falls; --from begins earlier"
        ));
    }
    match (rest, options.to_s) {
        (_, Some(to_s)) => notes.push(format!("free swing taken up to {to_s} s, as told")),
        (Some(rest), _) if rest.end < cut.asked.end => {
            let hung_s = cut.duration_s(rest);
            notes.push(format!(
                "cut {hung_s:.2} s hanging still at the end, and {}",
                moved_after(cut.times_s()[rest.end])
            ));
        }
        (Some(rest), _) => notes.push(format!("cut {:.2} s hanging still at the end", cut.duration_s(rest))),
        _ if free.end < cut.asked.end => notes.push(format!("cut {}", moved_after(cut.times_s()[free.end]))),
        _ => {}
    }
    if let Some(other) = cut.longest_of(cut.other_swings(free)) {
        let (from_s, to_s) = (cut.times_s()[other.start], cut.times_s()[other.end - 1]);
        let why = match cut.duration_s(&other) > cut.duration_s(free) {
            true => "the one that swings more often is taken, though it is shorter",
            false => "the longest one is taken",
        };
        notes.push(format!(
            "a free swing from {from_s:.2} to {to_s:.2} s is left out, {why}; --from {from_s:.2} --to {to_s:.2} takes that one"
        ));
    }
    if cut.states.is_empty() {
        notes.push(
            "too few samples a swing to see a hand in it: --from and --to tell where it swings freely".to_owned(),
        );
    }
    notes.extend(cut.driven_in_words(free));
    if !cut.fades(free) {
        let unit = cut.recording.measured().unit();
        let grown = cut.grown(free).map(|(from, to)| {
            format!(", but grow from {} to {} {unit} to either side", significant(from, 2), significant(to, 2))
        });
        notes.push(format!(
            "doubtful: its swings don't become smaller, as free ones do{}; does a motor or a hand drive it?",
            grown.unwrap_or_default()
        ));
    }
    notes
}

#[cfg(test)]
mod tests;
