//! The last frames of a stream, to tell one that comes once more: what a link repeats is equal to the last bit. Of a rig
//! that was started anew the numbers go back too, but not to a frame that came just now.

use shared::wire::Frame;
use std::collections::VecDeque;

/// A link that repeats does so at once; this is a second of frames at the usual rate.
const N_KEPT: usize = 64;

/// The last frames, the newest in front.
#[derive(Debug, Default)]
pub(super) struct Recent(VecDeque<Frame>);

impl Recent {
    /// Keeps a frame of the stream. Was it there already?
    pub(super) fn is_repeated(&mut self, frame: &Frame) -> bool {
        if !matches!(frame, Frame::Samples(_) | Frame::Live(_)) {
            return false;
        }
        if self.0.contains(frame) {
            return true;
        }
        self.0.push_front(frame.clone());
        self.0.truncate(N_KEPT);
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::wire::{Answer, Samples};

    fn samples(sequence: u32, first_sample: u64) -> Frame {
        let codes = std::iter::repeat_n(2048, 16).collect();
        Frame::Samples(Samples { sequence, first_sample, status: 0, codes })
    }

    #[test]
    fn a_frame_that_came_just_now_is_repeated_and_one_of_a_rig_started_anew_is_not() {
        let mut recent = Recent::default();
        assert!((0..20).all(|n| !recent.is_repeated(&samples(n, 5000 + 16 * u64::from(n)))));
        assert!(recent.is_repeated(&samples(19, 5304)) && recent.is_repeated(&samples(10, 5160)));
        assert!(!recent.is_repeated(&samples(0, 160)) && !recent.is_repeated(&samples(19, 304)));
    }

    #[test]
    fn what_is_long_ago_is_forgotten_and_answers_may_be_equal() {
        let mut recent = Recent::default();
        assert!((0..200).all(|n| !recent.is_repeated(&samples(n, 16 * u64::from(n)))));
        assert_eq!(recent.0.len(), N_KEPT);
        assert!((0..2).all(|_| !recent.is_repeated(&Frame::Answer(1, Answer::Done))));
    }
}
