//! What was cut, what was left out and what is doubtful, in words.

use super::growth::GROWN_SHARE;
use super::half_swing::{HalfSwing, size_rad};
use super::start::Start;
use super::stretch::WORTH_A_LOOK;
use super::{Bounds, Cut, MIN_TURNING_POINTS, SegmentOptions};
use crate::Recording;
use crate::noise::Noise;
use crate::number::significant;
use crate::places::as_gaps;
use std::ops::Range;

/// Digits of a noise that a message shows.
const NOISE_DIGITS: usize = 3;

/// What is taken of a recording is doubted where it swings over less than this share of what a longer part swings over that is
/// cut. Half and twice of it say the same of the recording in water for which it was made, whose tail keeps a thirteenth.
const SMALL_TAIL: f64 = 0.3;

/// And where it does not take longer, if it swings over less than this share of that: two wanders behind a propeller's push go a sixth
/// and an eleventh as far. With half of it the first would pass; twice of it was not tried.
pub(super) const TINY_TAIL: f64 = 0.2;

/// Regular swings take as long as the one before to this share. Half and twice were not tried.
const REGULAR_TIME: f64 = 0.3;

/// And keep at least this share of it. Half and twice were not tried.
const LEAST_LEFT: f64 = 0.7;

/// Times are shown to so much, s.
const SHOWN_S: f64 = 0.01;

/// From turn to turn in samples, which are whole ones where they are few: white noise turns every 1.5 (Bienaymé's test of turning
/// points), by 1 and 2, and swings of six samples a period, which are read, every 3. This lies between 2 and 3; with half of it
/// only what turns at each sample would be doubted, with twice of it swings of ten samples a period would be.
const TURNS_OF_NOISE: f64 = 2.5;

/// What may have moved it before its free swing, and what to do if nothing did.
const NOT_FREE: &str = " (a hand, a motor, a stop, or a tracker that lost it); --from begins earlier";

/// All of it, of the whole that was asked for and the part of it that tells of the swing.
pub(super) fn notes(
    [whole, cut]: [&Cut; 2],
    options: &SegmentOptions,
    bounds: &Bounds,
    interrupted: &[Range<usize>],
    noise: &Noise,
) -> Vec<String> {
    let recording = cut.recording;
    let Bounds { start, fallen, free, rest, .. } = bounds;
    let swing = *fallen.max(&start.free_idx)..free.end;
    let mut notes = beginning([whole, cut], options, start, &swing);
    notes.extend(end(whole, options, &swing, rest.as_ref()));
    notes.extend(other_swing(whole, &swing));
    notes.extend(doubt_of_hold(whole, options, &swing));
    notes.extend(whole.states.is_empty().then(|| {
        "too few samples a swing to see a hand in it, except where the swing grows: --from and --to tell where it swings freely"
            .to_owned()
    }));
    notes.extend(as_quick_as_noise(cut));
    notes.extend(whole.driven_in_words(&swing));
    let does_not_end = no_fading(whole, &swing).or_else(|| held(whole, &swing));
    notes.extend(does_not_end.or_else(|| goes_on(whole, options, &swing)));
    notes.extend(disorder(cut, free));
    notes.extend(interruptions(recording, interrupted));
    notes.extend(carried(cut, bounds));
    notes.extend(wandering(recording, noise));
    notes.extend(cut.moved_in_words(free));
    let (free_s, free_rad) = (&recording.times_s()[free.clone()], &recording.angles_rad()[free.clone()]);
    notes.extend(recording.unit.and_then(|unit| unit.doubt(free_s, free_rad)));
    notes
}

/// What lies before the swing.
fn beginning([whole, cut]: [&Cut; 2], options: &SegmentOptions, start: &Start, free: &Range<usize>) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(from_s) = options.from_s {
        let begins_s = whole.times_s()[0];
        if from_s > 0.0 && from_s < begins_s {
            notes.push(format!("--from {from_s} is before it begins: its own clock starts at {begins_s} s"));
        }
        notes.push(format!("free swing taken from {from_s} s on, as told"));
    } else {
        notes.extend(cut_before([whole, cut], start));
        if !start.was_held {
            let before = whole.asked.start..start.free_idx;
            let doubt = doubt_of_tail(whole, &before, free);
            notes.extend(doubt.or_else(|| doubt_of_regular_swings(whole, &before, free)));
        }
    }
    if free.start > start.free_idx {
        let more_s = whole.times_s()[free.start] - whole.times_s()[start.free_idx];
        notes.push(format!(
            "cut {more_s:.2} s more near upright, where the least push decides when it falls; --from begins earlier"
        ));
    }
    notes
}

/// What was cut before it, and why.
fn cut_before([whole, cut]: [&Cut; 2], start: &Start) -> Option<String> {
    let first_s = whole.times_s()[whole.asked.start];
    let free_s = whole.times_s()[start.free_idx];
    let before_s = free_s - first_s;
    if start.was_held {
        let other = if cut.asked.start > whole.asked.start { ": another motion, then" } else { "" };
        return Some(format!("cut {before_s:.2} s{other} held still before the release at {:.3} s", start.release_s));
    }
    if start.free_idx <= whole.asked.start {
        return None;
    }
    // A part of a recording begins somewhere on its clock, which --from means.
    let up_to = if first_s.abs() < SHOWN_S { String::new() } else { format!(", up to {free_s:.2} s") };
    Some(match &start.lead_in {
        Some(still) => format!(
            "cut {before_s:.2} s{up_to}: still for {:.2} s, and then it does not follow a free swing{NOT_FREE}",
            whole.duration_s(still)
        ),
        None => format!("cut the first {before_s:.2} s{up_to}: until then it does not follow a free swing{NOT_FREE}"),
    })
}

/// What lies behind the swing.
fn end(cut: &Cut, options: &SegmentOptions, free: &Range<usize>, rest: Option<&Range<usize>>) -> Option<String> {
    match (rest, options.to_s) {
        (_, Some(to_s)) => Some(format!("free swing taken up to {to_s} s, as told")),
        (Some(rest), _) if rest.end < cut.asked.end => {
            let (hung_s, moved) = (cut.duration_s(rest), moved_after(cut.times_s()[rest.end]));
            Some(format!("cut {hung_s:.2} s hanging still at the end, and {moved}"))
        }
        (Some(rest), _) => Some(format!("cut {:.2} s hanging still at the end", cut.duration_s(rest))),
        _ if free.end < cut.asked.end => Some(format!("cut {}", moved_after(cut.times_s()[free.end]))),
        _ => None,
    }
}

/// What else swings freely in it.
fn other_swing(cut: &Cut, free: &Range<usize>) -> Option<String> {
    let other = cut.longest_of(cut.other_swings(free))?;
    let (from_s, to_s) = (cut.times_s()[other.start], cut.times_s()[other.end - 1]);
    if !cut.fades(&other) {
        return Some(format!(
            "swings from {from_s:.2} to {to_s:.2} s are left out: they don't become smaller, as those that a motor or a hand drives, \
             and one that does is taken; --from {from_s:.2} --to {to_s:.2} takes them"
        ));
    }
    let why = match cut.duration_s(&other) > cut.duration_s(free) {
        true => "the one that swings more often is taken, though it is shorter",
        false => "the longest one is taken",
    };
    Some(format!(
        "a free swing from {from_s:.2} to {to_s:.2} s is left out, {why}; --from {from_s:.2} --to {to_s:.2} takes that one"
    ))
}

/// That it turns as often as noise does, in which neither a hand nor a growth is seen.
fn as_quick_as_noise(cut: &Cut) -> Option<String> {
    let n_samples = cut.half_swing_s / cut.recording.step_s();
    (n_samples < TURNS_OF_NOISE).then(|| {
        format!(
            "doubtful: from turn to turn it takes {} samples, and noise alone takes 1.5: nothing tells whether it swings freely, or \
             swings at all; record at least six samples a swing there and back",
            significant(n_samples, 2)
        )
    })
}

/// That its swings do not become smaller, as without a motor they must.
fn no_fading(cut: &Cut, free: &Range<usize>) -> Option<String> {
    if cut.fades(free) {
        return None;
    }
    let unit = cut.recording.measured().unit();
    let grown = cut.grown(free).map(|(from, to)| {
        format!(", but grow from {} to {} {unit} to either side", significant(from, 2), significant(to, 2))
    });
    Some(format!(
        "doubtful: its swings don't become smaller, as free ones do{}; does a motor or a hand drive it?",
        grown.unwrap_or_default()
    ))
}

/// That something holds its last swings, which would become smaller as those before did.
fn held(cut: &Cut, free: &Range<usize>) -> Option<String> {
    let (from_s, rad) = cut.held(free)?;
    Some(format!(
        "doubtful: its swings become smaller at first, but from {from_s:.2} s on stay as large, {} {} to either side, where any friction \
         would go on to take of them; does a motor, a hand or what carries it keep it going? --to {from_s:.2} ends before",
        significant(rad, 2),
        cut.recording.measured().unit()
    ))
}

/// That what lies about it swings as it does, for longer: either something keeps that going, or it is as free.
fn goes_on(cut: &Cut, options: &SegmentOptions, free: &Range<usize>) -> Option<String> {
    let run = cut.swings_alike(free).filter(|_| *options == SegmentOptions::default())?;
    let (from_s, to_s) = (cut.times_s()[run.start], cut.times_s()[run.end - 1]);
    Some(match cut.fades(&run) {
        false => format!(
            "doubtful: from {from_s:.2} to {to_s:.2} s it swings on without dying away, and what is taken is a part of that; does a \
             motor or a hand keep it going?"
        ),
        true => format!(
            "doubtful: from {from_s:.2} to {to_s:.2} s it swings on alike, and what is taken is a part of that: a motor or a hand keeps it \
             going, or a stand or a second pendulum swings along and makes swings grow that nobody pushes, and then --from {from_s:.2} \
             --to {to_s:.2} takes all of it"
        ),
    })
}

/// That it turns after times that no pendulum takes.
fn disorder(cut: &Cut, free: &Range<usize>) -> Option<String> {
    let (shortest_s, longest_s) = cut.disorder_s(free)?;
    Some(format!(
        "doubtful: from turn to turn it takes {} to {} s without order, and a pendulum nearly the same time: a hand may move it, or several swing together; choose a stretch that swings freely with --from and --to",
        significant(shortest_s, 2),
        significant(longest_s, 2)
    ))
}

/// That what carries it was waited for.
fn carried(cut: &Cut, bounds: &Bounds) -> Option<String> {
    let (idx, column) = bounds.carried?;
    let more_s = cut.times_s()[idx] - cut.times_s()[bounds.fallen];
    Some(format!("cut {more_s:.2} s more in which {column} still moves; --from begins earlier"))
}

/// That the best of the swings may be what is cut: it swings far larger, and takes longer than all that is left or many times as far.
fn doubt_of_tail(cut: &Cut, before: &Range<usize>, free: &Range<usize>) -> Option<String> {
    let (largest_rad, taken_rad) = (cut.largest_rad(before)?, cut.largest_rad(free)?);
    let is_longer = cut.duration_s(before) > cut.duration_s(free);
    // One way of a hand is no swing.
    let is_tiny = taken_rad < TINY_TAIL * largest_rad && cut.count_turns(before) >= MIN_TURNING_POINTS;
    (is_tiny || is_longer && taken_rad < SMALL_TAIL * largest_rad).then(|| {
        let (times, longer) = (largest_rad / taken_rad, if is_longer { "takes longer and " } else { "" });
        format!("doubtful: what is cut before {longer}swings {times:.0} times as far; is that the free swing?")
    })
}

/// The same of what is cut behind it, where no motor swings it: it may be a hand that trembles before it lets go.
fn doubt_of_hold(cut: &Cut, options: &SegmentOptions, free: &Range<usize>) -> Option<String> {
    let times = cut.times_as_large_later(free).filter(|_| *options == SegmentOptions::default())?;
    let is_driven = !cut.driven_in_words(&(free.end..cut.asked.end)).is_empty();
    (times * TINY_TAIL > 1.0 && !is_driven).then(|| {
        format!("doubtful: what is cut behind it swings {times:.0} times as far; is that the free swing, and this a hand that holds it?")
    })
}

/// That what is cut right before it may swing as freely: a hand does not turn again and again when a pendulum would, each time by a
/// little less.
fn doubt_of_regular_swings(cut: &Cut, before: &Range<usize>, free: &Range<usize>) -> Option<String> {
    let half_swings = cut.half_swings_in(before);
    let duration_s = |[from, to]: &HalfSwing| to.time_s - from.time_s;
    let is_regular = |pair: &&[HalfSwing]| {
        let loses = size_rad(&pair[1]) / size_rad(&pair[0]);
        let is_in_time = (duration_s(&pair[1]) / duration_s(&pair[0]) - 1.0).abs() < REGULAR_TIME;
        is_in_time && loses > LEAST_LEFT && cut.growth(&pair[0], &pair[1]).is_none()
    };
    let n_regular = half_swings.windows(2).rev().take_while(is_regular).count() + 1;
    let first = half_swings.get(half_swings.len().checked_sub(n_regular)?)?;
    let regular = cut.recording.index_at(first[0].time_s)..before.end;
    let dies_away = size_rad(first) > (1.0 + GROWN_SHARE) * size_rad(half_swings.last()?);
    let is_doubted = n_regular >= WORTH_A_LOOK
        && dies_away
        && cut.fades(&regular)
        && cut.driven_in_words(&regular).is_empty()
        && cut.other_swings(free).is_empty();
    is_doubted.then(|| {
        let (from_s, to_s) = (first[0].time_s, cut.times_s()[before.end]);
        format!(
            "doubtful: {n_regular} half swings before {to_s:.2} s die away one after the other, as free ones do, and are cut all the \
             same: a scale of the sensor that is uneven, or something that swings along, makes large swings look like a hand's; \
             --from {from_s:.2} takes them"
        )
    })
}

fn moved_after(time_s: f64) -> String {
    format!(
        "everything after {time_s:.2} s: something other than gravity and friction moved it there (a hand, a stop, or a tracker \
         that lost it); --to ends later"
    )
}

/// Readings of something else within it.
fn interruptions(recording: &Recording, interrupted: &[Range<usize>]) -> Option<String> {
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
