//! From samples to releases on the tape: when the pendulum is let go, and when its swing says no more.
//!
//! Two passages through the lowest point from well outside are a release; a hand that lifts the pendulum does not do
//! that. It began where the pendulum left the place of its outermost angle.

use super::refit::MAX_RELEASES;
use super::tape::{CAPACITY, Span, Tape};
use crate::potentiometer::Potentiometer;
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
const LEAST_RAD: f32 = 0.05;

/// From one passage to the next it takes no longer, s.
const LONGEST_HALF_SWING_S: f32 = 3.0;

/// A release has so many passages: a window of one period, and what comes before it.
const LEAST_PASSAGES: u32 = 4;

/// Follows the samples.
pub struct Keeper {
    potentiometer: Potentiometer,
    /// Samples in a mean …
    every: u32,
    /// … of which there are so many already, with this sum.
    n_summed: u32,
    sum: f32,
    releases: Vec<Span, MAX_RELEASES>,
    begun: u32,
    outermost_rad: f32,
    since_passage: u32,
    /// So many means after a passage comes the next one, if any.
    patience: u32,
    n_passages: u32,
}

impl Keeper {
    /// For samples at a rate, by a calibration.
    pub fn new(rate_hz: f32, potentiometer: Potentiometer) -> Self {
        let every = ((rate_hz / RATE_HZ + 0.5) as u32).max(1);
        Self {
            potentiometer,
            every,
            n_summed: 0,
            sum: 0.0,
            releases: Vec::new(),
            begun: 0,
            outermost_rad: 0.0,
            since_passage: 0,
            patience: (LONGEST_HALF_SWING_S * rate_hz) as u32 / every,
            n_passages: 0,
        }
    }

    /// Between two codes on the tape, s.
    pub fn interval_s(&self, rate_hz: f32) -> f32 {
        self.every as f32 / rate_hz
    }

    /// The releases that the tape still has, the last one last.
    pub fn releases(&self, tape: &Tape) -> Vec<Span, MAX_RELEASES> {
        self.releases.iter().copied().filter(|span| tape.still_has(*span)).collect()
    }

    /// Takes a sample. Has a release ended with it?
    pub fn take(&mut self, code: Code, tape: &Tape) -> bool {
        if !self.potentiometer.is_connected(code) {
            return self.miss(tape);
        }
        self.sum += f32::from(code.0);
        self.n_summed += 1;
        if self.n_summed < self.every {
            return false;
        }
        let mean = self.sum / self.every as f32;
        (self.sum, self.n_summed) = (0.0, 0);
        self.take_mean(mean, tape)
    }

    /// Samples are missing here. Has a release ended with that?
    pub fn miss(&mut self, tape: &Tape) -> bool {
        (self.sum, self.n_summed) = (0.0, 0);
        self.end(tape)
    }

    fn take_mean(&mut self, mean_code: f32, tape: &Tape) -> bool {
        let angle_rad = (mean_code - self.potentiometer.zero_code) * self.potentiometer.radian_per_code;
        if self.n_passages == 0 && angle_rad.abs() >= self.outermost_rad.abs() - MOVED_RAD {
            tape.rewind_to(self.begun);
            self.since_passage = 0;
        }
        if tape.n_written().wrapping_sub(self.begun) < LONGEST {
            tape.write(mean_code);
        }
        self.since_passage += 1;
        let passes = angle_rad * self.outermost_rad < 0.0;
        let is_far = self.outermost_rad.abs() >= LEAST_RAD;
        if passes && is_far {
            self.n_passages += 1;
            self.since_passage = 0;
        }
        if passes || angle_rad.abs() > self.outermost_rad.abs() {
            self.outermost_rad = angle_rad;
        }
        let is_over = self.since_passage > self.patience || (passes && !is_far);
        is_over && self.end(tape)
    }

    /// Keeps what was a release, and waits for the next one.
    fn end(&mut self, tape: &Tape) -> bool {
        let span = Span { first: self.begun, length: tape.n_written().wrapping_sub(self.begun) };
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
