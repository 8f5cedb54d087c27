//! Bookkeeping of a ring that a converter fills behind the processor's back.
//!
//! One timer triggers the conversions, a second one counts the triggers, so the hardware itself says how many
//! conversions there have been, however long the processor slept: during a flash erase it may miss the ring's end
//! many times over. Sample n is always the mean of conversions n·m … n·m + m − 1; what is lost is lost in whole
//! samples, and the time base stays exact.

/// Triggers whose conversion or transfer has not ended yet; more means that the converter has stopped.
const MOST_IN_WORK: u32 = 8;

/// The share of the ring that an overtaken reader leaves to the converter, so that it is not overtaken again while it
/// catches up: 13 ms at 40,000 conversions a second, where a scan of the store takes 5 ms at once.
const HEAD_START: u32 = 4;

/// Why the ring cannot simply be read on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// Triggers go on but results do not: the converter overran and has to be started again.
    Stalled,
    /// The results overtook the reader.
    Overtaken,
}

/// Reading position in a ring of `N` conversions (a power of two).
#[derive(Clone, Debug)]
pub struct RingReader<const N: u32> {
    per_sample: u32,
    /// Trigger count when the ring's first place was filled.
    first: u32,
    /// The next conversion to read; a whole number of samples.
    next: u32,
}

impl<const N: u32> RingReader<N> {
    /// At trigger zero, with `per_sample` conversions a sample (a power of two).
    pub const fn new(per_sample: u32) -> Self {
        assert!(N.is_power_of_two() && per_sample.is_power_of_two());
        Self { per_sample, first: 0, next: 0 }
    }

    /// How many conversions can be read, `triggers` after the start, when the converter writes to place `writes_to`.
    pub fn ready(&self, triggers: u32, writes_to: u32) -> Result<u32, Trouble> {
        let in_work = triggers.wrapping_sub(self.first).wrapping_sub(writes_to) % N;
        if in_work > MOST_IN_WORK {
            return Err(Trouble::Stalled);
        }
        // Behind a skipped sample the reader is ahead of the converter for a moment.
        let ready = triggers.wrapping_sub(in_work).wrapping_sub(self.next) as i32;
        match u32::try_from(ready) {
            Ok(ready) if ready + MOST_IN_WORK >= N => Err(Trouble::Overtaken),
            Ok(ready) => Ok(ready),
            Err(_) => Ok(0),
        }
    }

    /// The place of the next sample's conversion number `i`.
    pub fn place(&self, i: u32) -> usize {
        (self.next.wrapping_add(i).wrapping_sub(self.first) % N) as usize
    }

    /// One sample has been read.
    pub fn advance(&mut self) {
        self.next = self.next.wrapping_add(self.per_sample);
    }

    /// Is the sample at `place(0)` still what it was, `triggers` after the start? The processor may have stood still while
    /// it was being read.
    pub fn is_whole(&self, triggers: u32) -> bool {
        triggers.wrapping_sub(self.next) <= N
    }

    /// Goes on with the first sample that begins after `triggers`; gives how many were left out.
    pub fn skip_to(&mut self, triggers: u32) -> u32 {
        let before = self.next;
        self.next = triggers.div_ceil(self.per_sample).wrapping_mul(self.per_sample);
        self.next.wrapping_sub(before) / self.per_sample
    }

    /// Goes on with the oldest of the last `most` samples before `triggers`, when it was overtaken, that the ring will
    /// still have for a while; gives how many were left out.
    pub fn skip_overtaken(&mut self, triggers: u32, most: u32) -> u32 {
        let kept = (most * self.per_sample).min(N - N / HEAD_START);
        self.skip_to(triggers.wrapping_sub(kept))
    }

    /// The converter was started again after `triggers` and fills the ring from its first place.
    pub fn restarted(&mut self, triggers: u32) {
        self.first = triggers;
    }
}
