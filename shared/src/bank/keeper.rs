//! From samples to releases on the tape: when the pendulum is let go, and when its swing says no more.
//!
//! Two passages through the lowest point from well outside are a release; a hand that lifts the pendulum does not do
//! that. It began where the pendulum left the place of its outermost angle. Left alone it swings less far each time, and
//! not much longer; where it does, a hand has caught it or given it a push, and the release ended before.

use super::refit::MAX_RELEASES;
use super::tape::{CAPACITY, Span, Tape, step_rad};
use super::window;
use crate::sensor::{Reader, Sensor};
use crate::units::Code;
use heapless::Vec;

/// So many means of codes a second are kept, or a little more or less. Half would miss detents, twice would fill the
/// tape with one release and a half; on blind rigs 250 named no more.
pub const RATE_HZ: f32 = 125.0;

/// While it waits for the next release, so many codes may be written over the oldest.
const WAITING: u32 = 160;

/// Of one release no more is kept, so that three have room.
const LONGEST: u32 = (CAPACITY / 3) as u32 - WAITING;

/// A pendulum that is let go has moved so far, rad.
const MOVED_RAD: f32 = 0.03;

/// Passages of smaller swings end a release: the bank's windows do not go as far down.
const LEAST_RAD: f32 = window::LEAST_RAD as f32;

/// From one passage to the next it takes no longer, s …
const LONGEST_HALF_SWING_S: f32 = 3.0;

/// … nor than the last time on this side by more than this factor: half a turn is the quicker the smaller it is, but for
/// springs and magnets, by some per cent. Twice of it takes the usual catch for a swing.
const LONGER: f32 = 1.5;

/// Nor does it swing further than the last time on this side, but for the sensor's noise, rad.
const FURTHER_RAD: f32 = 0.05;

/// A release has so many passages: a window of one period, and what comes before it.
const LEAST_PASSAGES: u32 = 4;

/// Follows the samples.
pub struct Keeper {
    rate_hz: f32,
    reader: Reader,
    /// Samples in a mean …
    every: u32,
    /// … of which there are so many already, with this sum.
    n_summed: u32,
    sum: i32,
    releases: Vec<Span, MAX_RELEASES>,
    begun: u32,
    outermost_rad: f32,
    since_passage: u32,
    /// So many means after a passage comes the next one, if any.
    longest: u32,
    n_passages: u32,
    /// Where the tape was at the last passage.
    passed_at: u32,
    /// The half swing before the present one, and the one before that, which was on the same side.
    before: [Half; 2],
}

/// Half a swing, from one passage to the next.
#[derive(Clone, Copy)]
struct Half {
    outermost_rad: f32,
    length: u32,
}

impl Keeper {
    /// For samples of a sensor at a rate.
    pub fn new(rate_hz: f32, sensor: Sensor) -> Self {
        let every = ((rate_hz / RATE_HZ + 0.5) as u32).max(1);
        Self {
            rate_hz,
            reader: Reader::new(sensor),
            every,
            n_summed: 0,
            sum: 0,
            releases: Vec::new(),
            begun: 0,
            outermost_rad: 0.0,
            since_passage: 0,
            longest: (LONGEST_HALF_SWING_S * rate_hz) as u32 / every,
            n_passages: 0,
            passed_at: 0,
            before: [Half { outermost_rad: 0.0, length: 0 }; 2],
        }
    }

    /// Between two codes on the tape, s.
    pub fn interval_s(&self) -> f32 {
        self.every as f32 / self.rate_hz
    }

    /// What a step on the tape is, rad.
    pub fn radian_per_step(&self) -> f32 {
        step_rad(self.reader.sensor().step_rad())
    }

    /// Does it follow samples of this rate and this sensor?
    pub fn is_for(&self, rate_hz: f32, sensor: &Sensor) -> bool {
        self.rate_hz == rate_hz && self.reader.sensor() == sensor
    }

    /// The releases that the tape still has, the last one last.
    pub fn releases(&self, tape: &Tape) -> Vec<Span, MAX_RELEASES> {
        self.releases.iter().copied().filter(|span| tape.still_has(*span)).collect()
    }

    /// Takes a sample. Has a release ended with it?
    pub fn take(&mut self, code: Code, tape: &Tape) -> bool {
        if !self.reader.sensor().is_connected(code) {
            return self.miss(tape);
        }
        self.sum = self.sum.wrapping_add(self.reader.follow(code));
        self.n_summed += 1;
        if self.n_summed < self.every {
            return false;
        }
        let line = self.reader.sensor().line();
        let mean_code = self.sum as f32 / self.every as f32;
        (self.sum, self.n_summed) = (0, 0);
        self.take_mean((mean_code - line.zero_code) * line.radian_per_code, tape)
    }

    /// Samples are missing here. Has a release ended with that?
    pub fn miss(&mut self, tape: &Tape) -> bool {
        (self.sum, self.n_summed) = (0, 0);
        self.end(self.passed_at, tape)
    }

    fn take_mean(&mut self, angle_rad: f32, tape: &Tape) -> bool {
        if self.n_passages == 0 && angle_rad.abs() >= self.outermost_rad.abs() - MOVED_RAD {
            tape.rewind_to(self.begun);
            self.since_passage = 0;
        }
        if tape.n_written().wrapping_sub(self.begun) < LONGEST {
            tape.write(angle_rad / self.radian_per_step());
        }
        self.since_passage += 1;
        let passes = angle_rad * self.outermost_rad < 0.0;
        let is_far = self.outermost_rad.abs() >= LEAST_RAD;
        if self.is_disturbed(angle_rad) {
            // A hand that lifts it may have led it through the last passage.
            return self.end(self.passed_at.wrapping_sub(self.before[0].length), tape);
        }
        if passes && !is_far {
            return self.end(self.passed_at, tape);
        }
        if passes {
            self.pass(tape);
        }
        if passes || angle_rad.abs() > self.outermost_rad.abs() {
            self.outermost_rad = angle_rad;
        }
        false
    }

    /// Does it do what a pendulum that was let go does not?
    fn is_disturbed(&self, angle_rad: f32) -> bool {
        let same_side = self.before[1];
        // The half before the first passage is the hand's, that before the second one begins with it.
        let is_known = self.n_passages >= 3;
        let lasts = is_known && self.since_passage as f32 > LONGER * same_side.length as f32;
        let grows = is_known && angle_rad.abs() > same_side.outermost_rad.abs() + FURTHER_RAD;
        self.since_passage > self.longest || lasts || grows
    }

    fn pass(&mut self, tape: &Tape) {
        let half = Half { outermost_rad: self.outermost_rad, length: self.since_passage };
        self.before = [half, self.before[0]];
        self.n_passages += 1;
        self.since_passage = 0;
        self.passed_at = tape.n_written();
    }

    /// Keeps what was a release until there, and waits for the next one.
    fn end(&mut self, until: u32, tape: &Tape) -> bool {
        let span = Span { first: self.begun, length: until.wrapping_sub(self.begun) };
        let is_release = self.n_passages >= LEAST_PASSAGES;
        if is_release {
            if self.releases.is_full() {
                self.releases.remove(0);
            }
            let _ = self.releases.push(span);
            self.begun = tape.n_written();
        } else {
            tape.rewind_to(self.begun);
        }
        (self.outermost_rad, self.since_passage, self.n_passages) = (0.0, 0, 0);
        is_release
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bank::window::Readings;
    use crate::sensor::Potentiometer;
    use crate::sensor::potentiometer::FULL_SCALE_12_BIT;
    use crate::units::Radian;
    use std::boxed::Box;
    use std::vec::Vec as List;

    const SAMPLES_HZ: f32 = 1000.0;

    /// Hangs, is lifted within a second from where it is, held, and let go.
    fn let_go(angles: &mut List<f64>, from_rad: f64, held_s: f64) {
        let here = angles.last().copied().unwrap_or(0.0);
        angles.extend((0..1000).map(|i| here + (from_rad - here) * f64::from(i) / 1000.0));
        angles.extend((0..(1000.0 * held_s) as usize).map(|_| from_rad));
    }

    /// Swings on from rest at an angle, until a time in s.
    fn swing(angles: &mut List<f64>, from_rad: f64, until_s: f64) {
        let angle = |t: f64| from_rad * libm::exp(-t / 12.0) * libm::cos(5.2 * t);
        angles.extend((0..(1000.0 * until_s) as usize).map(|i| angle(i as f64 / 1000.0)));
    }

    /// Each release's length in angles, and its first angle.
    fn releases_of(angles: &[f64]) -> List<(u32, f32)> {
        let potentiometer = Potentiometer::nominal(FULL_SCALE_12_BIT);
        let (tape, mut keeper) = (Box::new(Tape::new()), Keeper::new(SAMPLES_HZ, potentiometer.into()));
        for angle_rad in angles {
            keeper.take(potentiometer.code(Radian(*angle_rad as f32)), &tape);
        }
        let first = |span: Span| tape.read(span, keeper.radian_per_step()).at(0);
        keeper.releases(&tape).into_iter().map(|span| (span.length, first(span))).collect()
    }

    #[test]
    fn a_release_is_one_until_its_swing_is_small() {
        for from_rad in [0.2, -1.0, 2.5] {
            let mut angles = List::new();
            let_go(&mut angles, from_rad, 1.0);
            swing(&mut angles, from_rad, 60.0);
            let releases = releases_of(&angles);
            let until_small_s = 12.0 * libm::log(f64::from(from_rad.abs() as f32 / LEAST_RAD));
            let kept_s = f64::from(releases[0].0) / f64::from(RATE_HZ);
            assert_eq!(releases.len(), 1, "{from_rad}");
            assert!(
                (kept_s - until_small_s.min(f64::from(LONGEST as f32 / RATE_HZ))).abs() < 1.5,
                "{from_rad}: {kept_s}"
            );
        }
    }

    /// Caught on its way and let go again from further out or from less far, sooner than it would have come to rest.
    #[test]
    fn a_catch_ends_a_release_and_what_the_hand_does_is_in_none() {
        const SWINGS_S: f64 = 10.4;
        for (again_rad, held_s) in [(1.3, 0.2), (-1.3, 0.2), (0.25, 0.5), (-0.25, 0.5), (0.3, 2.5)] {
            let mut angles = List::new();
            let_go(&mut angles, 1.0, 1.0);
            swing(&mut angles, 1.0, SWINGS_S);
            let_go(&mut angles, again_rad, held_s);
            swing(&mut angles, again_rad, 40.0);
            let releases = releases_of(&angles);
            let [(first, _), (_, begins_rad)] = releases[..] else { panic!("{again_rad}, {held_s}: {releases:?}") };
            assert!(f64::from(first) <= SWINGS_S * f64::from(RATE_HZ), "{again_rad}, {held_s}: {first}");
            assert!(
                (f64::from(begins_rad) - again_rad).abs() < 2.0 * f64::from(MOVED_RAD),
                "{again_rad}: {begins_rad}"
            );
        }
    }

    /// Pushed at its lowest point, within a sample.
    #[test]
    fn a_push_ends_a_release_and_begins_another() {
        const PUSHED_S: f64 = 17.5 * core::f64::consts::PI / 5.2;
        let mut angles = List::new();
        let_go(&mut angles, 1.0, 1.0);
        swing(&mut angles, 1.0, PUSHED_S);
        let quarter_s = 0.5 * core::f64::consts::PI / 5.2;
        angles.extend((0..(1000.0 * quarter_s) as usize).map(|i| 1.2 * libm::sin(5.2e-3 * i as f64)));
        swing(&mut angles, 1.2, 40.0);
        let releases = releases_of(&angles);
        let [(first, _), (_, begins_rad)] = releases[..] else { panic!("{releases:?}") };
        assert!(f64::from(first) <= PUSHED_S * f64::from(RATE_HZ) && begins_rad > 1.1, "{releases:?}");
    }
}
