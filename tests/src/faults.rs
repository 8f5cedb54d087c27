//! A bad link: flips, drops, inserts, repeats, splits, stalls, breaks or restarts, by a seed; and the truth beside it.

use crate::chance::Chance;
use host::record::Taken;
use host::recording::{self, ReadOptions, Recording};
use shared::wire::{Deframer, Frame};
use std::collections::{BTreeMap, VecDeque};
use std::path::Path;
use std::sync::{Arc, Mutex};

/// How a link misbehaves. Shares are per byte, times in seconds.
#[derive(Clone, Debug)]
pub struct Faults {
    flips: f64,
    drops: f64,
    inserts: f64,
    repeats: f64,
    /// Longest piece that one read gives.
    piece: usize,
    /// Share of reads that give nothing for `stall_s`.
    pub stalls: f64,
    /// How long such a read gives nothing.
    pub stall_s: f64,
    /// The cable is pulled.
    pub breaks_at_s: f64,
    /// The rig restarts.
    pub restarts_at_s: f64,
}

/// Faults of all kinds, one kind for each of so many seeds.
pub const N_KINDS: u64 = 10;

impl Faults {
    /// Of a link that is used for `length_s`; seeds of the same last digit have the same kind.
    pub fn of(seed: u64, length_s: f64) -> (Self, Chance) {
        let mut chance = Chance::new(seed);
        let mut share = |on: bool| if on { 10.0_f64.powf(chance.within(-5.5..-3.0)) } else { 0.0 };
        let kind = seed % N_KINDS;
        let all = kind == 9;
        let (flips, drops) = (share(kind == 0 || all), share(kind == 1 || all));
        let (inserts, repeats) = (share(kind == 2 || all), share(kind == 3 || all));
        let stalls = if kind == 5 || all { 1e-3 } else { 0.0 };
        let stall_s = chance.within(0.0..length_s / 3.0);
        let at_s = chance.within(0.0..length_s);
        let piece = if kind == 4 || all { 1 + chance.within(0.0..40.0) as usize } else { 4096 };
        let never = f64::INFINITY;
        let faults = Self {
            flips,
            drops,
            inserts,
            repeats,
            piece,
            stalls,
            stall_s,
            breaks_at_s: if kind == 6 { at_s } else { never },
            restarts_at_s: if kind == 7 || kind == 8 { at_s } else { never },
        };
        (faults, chance)
    }
}

/// Every code that the rig sent, by its number, for each of its starts.
#[derive(Clone, Default)]
pub struct Sent(Arc<Mutex<Vec<BTreeMap<u64, u16>>>>);

impl Sent {
    /// The rig starts, and counts anew.
    pub fn restarted(&self) {
        self.all(|sent| sent.push(BTreeMap::new()));
    }

    fn note(&self, frame: &Frame) {
        let Frame::Samples(samples) = frame else { return };
        let numbered = samples.codes.iter().enumerate().map(|(k, code)| (samples.first_sample + k as u64, *code));
        self.all(|sent| sent.last_mut().expect("a start").extend(numbered));
    }

    fn all<T>(&self, look: impl FnOnce(&mut Vec<BTreeMap<u64, u16>>) -> T) -> T {
        look(&mut self.0.lock().expect("nobody panics while looking"))
    }

    /// Is every row of the file what was sent, at its place, with everything that is missing told as a gap? Gives the
    /// number of gaps; `None` for a file too short to be read.
    #[track_caller]
    pub fn check(&self, path: &Path, taken: &Taken, what: &str) -> Option<usize> {
        let Ok(recording) = recording::read(path, &ReadOptions::default()) else {
            assert!(taken.n_samples < recording::MIN_SAMPLES, "{what}: {} samples, unreadable", taken.n_samples);
            return None;
        };
        assert_eq!(recording.len(), taken.n_samples, "{what}");
        let is_true = self.all(|sent| sent.iter().any(|sent| is_part(&recording, sent)));
        assert!(is_true, "{what}: a number that was not sent");
        let numbers = numbers(&recording);
        let missing = (numbers[numbers.len() - 1] - numbers[0] + 1) as usize - numbers.len();
        let told: usize = recording.gaps().iter().filter_map(|gap| gap.n_missing).sum();
        assert_eq!(missing, told, "{what}: gaps");
        Some(recording.gaps().len())
    }
}

/// Numbers of a file's rows at 1 kHz, from its times.
fn numbers(recording: &Recording) -> Vec<u64> {
    recording.times_s().iter().map(|time_s| (time_s * 1000.0).round() as u64).collect()
}

fn is_part(recording: &Recording, sent: &BTreeMap<u64, u16>) -> bool {
    let codes = recording.codes().expect("a rig's recording");
    let numbers = numbers(recording);
    sent.keys().any(|first| numbers.iter().zip(codes).all(|(number, code)| sent.get(&(first + number)) == Some(code)))
}

/// Bytes on a bad link towards the PC.
pub struct BadLink {
    /// What happens to them.
    pub faults: Faults,
    chance: Chance,
    sent: Sent,
    listener: Deframer,
    arriving: VecDeque<u8>,
}

impl BadLink {
    /// Notes what passes in `sent`.
    pub fn new((faults, chance): (Faults, Chance), sent: &Sent) -> Self {
        sent.restarted();
        Self { faults, chance, sent: sent.clone(), listener: Deframer::new(), arriving: VecDeque::new() }
    }

    /// Notes what the rig says, then spoils it.
    pub fn take(&mut self, byte: u8) {
        if let Some(Ok(frame)) = self.listener.push(byte) {
            self.sent.note(&frame);
        }
        if self.happens(self.faults.inserts) {
            let noise = self.chance.within(0.0..256.0) as u8;
            self.arriving.push_back(noise);
        }
        if self.happens(self.faults.drops) {
            return;
        }
        let flipped = if self.happens(self.faults.flips) { 1 << self.chance.within(0.0..8.0) as u8 } else { 0 };
        let byte = byte ^ flipped;
        self.arriving.push_back(byte);
        if self.happens(self.faults.repeats) {
            self.arriving.push_back(byte);
        }
    }

    /// Is nothing there to be read?
    pub fn is_empty(&self) -> bool {
        self.arriving.is_empty()
    }

    /// What one read gives.
    pub fn read(&mut self, buffer: &mut [u8]) -> usize {
        let n_bytes = self.arriving.len().min(buffer.len()).min(self.faults.piece);
        self.arriving.drain(..n_bytes).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        n_bytes
    }

    /// Does this read stall?
    pub fn stalls(&mut self) -> bool {
        self.happens(self.faults.stalls)
    }

    /// True once, when the rig is to restart.
    pub fn is_to_restart(&mut self, now_s: f64) -> bool {
        let now = now_s > self.faults.restarts_at_s;
        if now {
            self.faults.restarts_at_s = f64::INFINITY;
        }
        now
    }

    /// The rig has restarted; what it says now counts anew.
    pub fn restarted(&mut self) {
        self.listener = Deframer::new();
        self.sent.restarted();
    }

    fn happens(&mut self, share: f64) -> bool {
        share > 0.0 && self.chance.within(0.0..1.0) < share
    }
}
