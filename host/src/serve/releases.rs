//! The releases that the live view has listened to, so that a model can be fitted to them: in memory, and in the list of
//! recordings only when that is asked for.

use crate::error::Failure;
use crate::record::Sample;
use crate::recording::{Existing, Header, WriteError, Writer};
use std::collections::VecDeque;
use std::path::Path;
use tempfile::NamedTempFile;

/// As many as the bank looks at.
pub(super) const MOST_RELEASES: usize = shared::bank::refit::MAX_RELEASES;

/// One release from shortly before it on.
pub(super) struct Release {
    header: Header,
    rate_hz: f64,
    /// The first sample's number.
    first: u64,
    /// Place behind the first one, code and angle, rad: an hour at 1 kHz takes 40 MB.
    samples: Vec<(u32, u16, f32)>,
}

/// The last ones.
#[derive(Default)]
pub(super) struct Releases {
    kept: VecDeque<Release>,
    /// Does the last one go on?
    is_growing: bool,
}

impl Release {
    fn take(&mut self, sample: Sample) {
        if self.samples.is_empty() {
            self.first = sample.number;
        }
        if let Ok(place) = u32::try_from(sample.number.saturating_sub(self.first)) {
            self.samples.push((place, sample.code, sample.angle_rad as f32));
        }
    }

    /// As a file that goes when nobody needs it any longer.
    pub(super) fn file(&self) -> Result<NamedTempFile, Failure> {
        let file = NamedTempFile::with_suffix(".csv").map_err(Failure::failed)?;
        self.write(file.path()).map_err(Failure::failed)?;
        Ok(file)
    }

    fn write(&self, path: &Path) -> Result<(), WriteError> {
        let mut writer = Writer::create(path, &self.header, Existing::Overwrite)?;
        for (place, code, angle_rad) in &self.samples {
            writer.write(f64::from(*place) / self.rate_hz, f64::from(*angle_rad), Some(*code))?;
        }
        writer.finish()
    }
}

impl Releases {
    /// A release begins.
    pub(super) fn begin(&mut self, header: Header, rate_hz: f64) {
        while self.kept.len() >= MOST_RELEASES {
            self.kept.pop_front();
        }
        self.kept.push_back(Release { header, rate_hz, first: 0, samples: Vec::new() });
        self.is_growing = true;
    }

    /// A sample of the release that goes on.
    pub(super) fn grow(&mut self, sample: Sample) {
        if let (true, Some(release)) = (self.is_growing, self.kept.back_mut()) {
            release.take(sample);
        }
    }

    /// The release has ended.
    pub(super) fn end(&mut self) {
        self.is_growing = false;
    }

    /// They are of a rig that is there no longer.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Gives all away; what still comes of the last one is not kept.
    pub(super) fn hand_over(&mut self) -> Vec<Release> {
        self.is_growing = false;
        self.kept.drain(..).collect()
    }
}
