//! What is said of a file beside the file.

use super::columns::Columns;
use super::units::AngleUnit;
use shared::measured::Measured;

/// What the user says about the file; what is left out is found.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// `--columns`
    pub columns: Option<Columns>,
    /// `--rate`, Hz: for files without a time column; a time column is then ignored.
    pub rate_hz: Option<f64>,
    /// `--degrees` or `--radians`.
    pub angle_unit: Option<AngleUnit>,
    /// `--zero`: what the sensor reads while the pendulum hangs, in the file's unit; degrees for x and y.
    pub zero: Option<f64>,
    /// `--pivot`: where the pivot is, in the file's x and y.
    pub pivot: Option<[f64; 2]>,
    /// `--from` and `--to`, s: of x and y only those between them tell where the pivot is.
    pub within_s: [Option<f64>; 2],
    /// `--mirror`: it counts the other way, clockwise positive.
    pub mirrored: bool,
    /// `--run`: of a file that holds several runs these, by name or by number from 1; none for all.
    pub runs: Vec<String>,
    /// What a file holds that does not say it.
    pub measured: Option<Measured>,
}

impl ReadOptions {
    /// Does the user say in what unit the time counts, or how many samples a second there are?
    pub(super) fn says_time(&self) -> bool {
        let unit = self.columns.as_ref().and_then(|columns| columns.time.as_ref()?.1);
        self.rate_hz.is_some() || unit.is_some()
    }
}
