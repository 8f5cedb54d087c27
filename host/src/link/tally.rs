//! What a stream lost on its way, by frame sequence and sample number.

use shared::wire::Frame;

/// Counts of one stream.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Frames received.
    pub frames: u64,
    /// Frames that are missing in the sequence.
    pub frames_lost: u64,
    /// Raw samples that are missing in the count, for whatever reason.
    pub samples_lost: u64,
    /// Frames received with a wrong check sum; they are among the lost.
    pub frames_damaged: u64,
    /// Frames that came once more; they are passed over, and not among the received.
    pub frames_repeated: u64,
    next_raw: Option<u32>,
    next_live: Option<u32>,
    next_sample: Option<u64>,
}

impl Tally {
    pub(super) fn count(&mut self, frame: &Frame) {
        match frame {
            Frame::Samples(samples) => {
                self.frames_lost += missing(&mut self.next_raw, samples.sequence);
                let jump = self.next_sample.map_or(0, |next| samples.first_sample.wrapping_sub(next));
                // A count that runs backwards is a restarted rig, not a loss of nearly all numbers there are.
                self.samples_lost += if jump > u64::MAX / 2 { 0 } else { jump };
                self.next_sample = Some(samples.first_sample.wrapping_add(samples.codes.len() as u64));
            }
            Frame::Live(live) => self.frames_lost += missing(&mut self.next_live, live.sequence),
            _ => return,
        }
        self.frames += 1;
    }
}

fn missing(next: &mut Option<u32>, sequence: u32) -> u64 {
    let jump = next.map_or(0, |next| sequence.wrapping_sub(next));
    *next = Some(sequence.wrapping_add(1));
    if jump > u32::MAX / 2 { 0 } else { u64::from(jump) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::wire::Samples;

    fn samples(sequence: u32, first_sample: u64, n_codes: usize) -> Frame {
        let codes = std::iter::repeat_n(2048, n_codes).collect();
        Frame::Samples(Samples { sequence, first_sample, status: 0, codes })
    }

    #[test]
    fn a_lost_frame_and_its_samples_are_counted_once() {
        let mut tally = Tally::default();
        for frame in [samples(7, 100, 16), samples(8, 116, 16), samples(10, 148, 16), samples(11, 164, 16)] {
            tally.count(&frame);
        }
        assert_eq!((tally.frames, tally.frames_lost, tally.samples_lost), (4, 1, 16));
    }

    #[test]
    fn counters_may_run_over_their_end() {
        let mut tally = Tally::default();
        tally.count(&samples(u32::MAX, u64::MAX - 15, 16));
        tally.count(&samples(0, 0, 16));
        assert_eq!((tally.frames_lost, tally.samples_lost), (0, 0));
    }

    #[test]
    fn a_restarted_rig_is_not_a_loss() {
        let mut tally = Tally::default();
        tally.count(&samples(500, 8000, 16));
        tally.count(&samples(0, 0, 16));
        assert_eq!((tally.frames_lost, tally.samples_lost), (0, 0));
    }
}
