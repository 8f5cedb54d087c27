//! What a board remembers of the last releases: angles, about 125 a second, in one ring.
//!
//! Sampling writes while a look reads, and neither waits for the other: every angle is written in one piece, and a look
//! whose releases were written over meanwhile is worth nothing ([`Tape::still_has`]).

use super::window::Readings;
use core::sync::atomic::{AtomicI16, AtomicU32, Ordering};

/// Angles that it holds: 98 s. Half of it would hold one long release and a part, twice would not fit a board.
pub const CAPACITY: usize = 12 * 1024;

/// A mean of codes is kept in steps of this share of a code …
const FINER: f32 = 0.25;

/// … but of no less than this, rad, so that ±3.9 rad have room.
const LEAST_STEP_RAD: f32 = 1.2e-4;

/// The step in which angles of a sensor are kept, rad, given the size of its codes.
pub fn step_rad(code_rad: f32) -> f32 {
    (FINER * code_rad).max(LEAST_STEP_RAD)
}

/// The ring.
pub struct Tape {
    steps: [AtomicI16; CAPACITY],
    /// All that were ever written; the next one goes there, counted round the ring.
    n_written: AtomicU32,
    /// The most that this ever was: what was rewound has been written over, too.
    n_spoilt: AtomicU32,
}

/// A release on the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Its first angle, as [`Tape::n_written`] counts.
    pub first: u32,
    /// How many there are, at most [`CAPACITY`].
    pub length: u32,
}

/// The angles of a release.
pub struct Taped<'a> {
    tape: &'a Tape,
    span: Span,
    radian_per_step: f32,
}

impl Default for Tape {
    fn default() -> Self {
        Self::new()
    }
}

impl Tape {
    /// Empty.
    pub const fn new() -> Self {
        Self {
            steps: [const { AtomicI16::new(0) }; CAPACITY],
            n_written: AtomicU32::new(0),
            n_spoilt: AtomicU32::new(0),
        }
    }

    /// How many angles were ever written; it comes round after a year.
    pub fn n_written(&self) -> u32 {
        self.n_written.load(Ordering::Acquire)
    }

    /// Writes an angle in steps over the oldest one.
    pub fn write(&self, steps: f32) {
        let at = self.n_written();
        let next = at.wrapping_add(1);
        self.n_spoilt.store(self.n_spoilt.load(Ordering::Relaxed).max(next), Ordering::Release);
        self.steps[place(at)].store(libm::roundf(steps) as i16, Ordering::Relaxed);
        self.n_written.store(next, Ordering::Release);
    }

    /// Forgets what was written from there on.
    pub fn rewind_to(&self, at: u32) {
        self.n_written.store(at, Ordering::Release);
    }

    /// Has nothing of a release been written over?
    pub fn still_has(&self, span: Span) -> bool {
        self.n_spoilt.load(Ordering::Acquire).wrapping_sub(span.first) as usize <= CAPACITY
    }

    /// The angles of a release in steps of this size, rad.
    pub fn read(&self, span: Span, radian_per_step: f32) -> Taped<'_> {
        Taped { tape: self, span, radian_per_step }
    }
}

fn place(at: u32) -> usize {
    at as usize % CAPACITY
}

impl Readings<f32> for Taped<'_> {
    fn len(&self) -> usize {
        self.span.length as usize
    }

    fn at(&self, index: usize) -> f32 {
        let steps = self.tape.steps[place(self.span.first.wrapping_add(index as u32))].load(Ordering::Relaxed);
        f32::from(steps) * self.radian_per_step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::boxed::Box;

    #[test]
    fn what_was_written_is_read_until_the_ring_comes_round() {
        let tape = Box::new(Tape::new());
        (0..CAPACITY + 100).for_each(|i| tape.write((i % 1000) as f32 - 500.0));
        let span = Span { first: 100, length: CAPACITY as u32 };
        assert!(tape.still_has(span) && !tape.still_has(Span { first: 99, ..span }));
        let taped = tape.read(span, step_rad(1e-3));
        for index in [0, 1, CAPACITY - 1] {
            let exact = (((100 + index) % 1000) as f32 - 500.0) * 0.25e-3;
            assert!((taped.at(index) - exact).abs() < 1e-7, "{index}");
        }
        let end = tape.n_written();
        tape.write(0.0);
        assert!(!tape.still_has(span));
        tape.rewind_to(end);
        assert!(!tape.still_has(span), "what was written over is gone");
    }

    #[test]
    fn the_count_comes_round_after_a_year() {
        assert!(f64::from(u32::MAX) / 125.0 > 365.0 * 24.0 * 3600.0);
    }
}
