//! The columns that were chosen: where each quantity of a recording comes from.

use super::cell::{Cell, Numerals};
use super::limits::LARGEST_UNSTATED_RAD;
use super::table::Table;
use super::told::Told;
use super::unit::Unit;
use super::units::{AngleUnit, RateUnit, TimeUnit};
use shared::measured::Measured;

/// Where each quantity comes from.
#[derive(Clone)]
pub(super) struct Sources {
    pub(super) time: TimeSource,
    pub(super) reading: ReadingSource,
    /// The column of times before the readings, where another one was told.
    pub(super) passed_time: Option<usize>,
    /// What the time stands in, where that are two columns: its own has the whole seconds.
    pub(super) parted: Option<Parted>,
    pub(super) code: Option<usize>,
    /// What names the run, where a file may hold several.
    pub(super) run: Option<usize>,
    /// What drives or carries the pendulum, where it moves.
    pub(super) others: Vec<usize>,
    /// What a controller holds it at, if that stands beside it.
    pub(super) set_point: Option<SetPoint>,
    /// What could be told if the column of the readings turns out to be a wrong one.
    pub(super) otherwise: String,
}

/// A column of targets that is the same in the first rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SetPoint {
    /// What messages call it.
    pub(super) column: String,
    /// In the unit of the angle.
    pub(super) value: f64,
}

/// A time in two columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parted {
    /// Whole seconds.
    pub(super) seconds: usize,
    /// What is to be added to them …
    pub(super) rest: usize,
    /// … in this unit.
    pub(super) unit: TimeUnit,
}

/// Where what was measured comes from.
#[derive(Debug, Clone)]
pub(super) enum ReadingSource {
    /// Angles.
    Angle {
        idx: usize,
        unit: Option<AngleUnit>,
    },
    /// One of several columns with names alike, which only all of their rows can tell.
    Rivals {
        columns: Vec<usize>,
        /// What could be told of this file, by its first rows.
        example: String,
    },
    /// Angular velocities; of several axes the one that moves most counts.
    Rates {
        columns: Vec<usize>,
        unit: Option<RateUnit>,
    },
    /// Of a point on the pendulum. Where neither the user nor the names say so (`is_guess`), x is an angle if they lie on
    /// no circle after all.
    Point {
        x: usize,
        y: usize,
        is_guess: bool,
    },
    Codes,
}

impl ReadingSource {
    /// The columns whose numbers are needed.
    pub(super) fn columns(&self) -> Vec<usize> {
        match self {
            Self::Angle { idx, .. } => vec![*idx],
            Self::Rates { columns, .. } | Self::Rivals { columns, .. } => columns.clone(),
            Self::Point { x, y, .. } => vec![*x, *y],
            Self::Codes => Vec::new(),
        }
    }

    /// The column before which its own time is looked for.
    pub(super) fn first_idx(&self) -> Option<usize> {
        match self {
            Self::Angle { idx, .. } => Some(*idx),
            Self::Rates { columns, .. } | Self::Rivals { columns, .. } => columns.first().copied(),
            Self::Point { .. } | Self::Codes => None,
        }
    }
}

impl Sources {
    /// What the readings are.
    pub(super) fn measured(&self) -> Measured {
        match self.reading {
            ReadingSource::Rates { .. } => Measured::Rate,
            _ => Measured::Angle,
        }
    }

    /// Stands a word in the row where the time would be, as in a summary below a table?
    pub(super) fn has_words_as_time(&self, table: &Table) -> bool {
        let fields = table.fields();
        let field = self.time.column().and_then(|idx| fields.get(idx));
        field.is_some_and(|field| field.starts_with(char::is_alphabetic) && Numerals::new().read(field) == Cell::Text)
    }

    /// Do rows that are left out leave their time behind?
    pub(super) fn counts_rows(&self) -> bool {
        matches!(self.time, TimeSource::Rate(_))
    }

    /// Are times counts at a rate, which nothing rounded?
    pub(super) fn counts(&self) -> bool {
        matches!(self.time, TimeSource::Rate(_) | TimeSource::Counter { .. })
    }

    /// What is known of the unit of a column of angles. Of large numbers the growth of the period has told it.
    pub(super) fn unit(&self, angles: &[f64]) -> Option<Unit> {
        let ReadingSource::Angle { unit, .. } = self.reading else { return None };
        let are_small = || !angles.iter().any(|angle| angle.abs() > LARGEST_UNSTATED_RAD);
        (unit.is_some() || are_small()).then(|| Unit { unit, told: self.told() })
    }

    /// The columns, for messages.
    pub(super) fn told(&self) -> Told {
        let reading = self.reading.columns().first().copied().unwrap_or_default();
        Told { time: self.time.column(), reading, measured: self.measured() }
    }
}

/// Where time comes from.
#[derive(Debug, Clone)]
pub(super) enum TimeSource {
    Column {
        idx: usize,
        unit: Option<TimeUnit>,
    },
    /// Clock times, with or without a date.
    Clock {
        idx: usize,
    },
    /// Numbers of frames or samples, some of which may be missing, at so many a second.
    Counter {
        idx: usize,
        rate_hz: f64,
    },
    Rate(f64),
}

impl TimeSource {
    pub(super) fn column(&self) -> Option<usize> {
        match self {
            Self::Column { idx, .. } | Self::Clock { idx } | Self::Counter { idx, .. } => Some(*idx),
            Self::Rate(_) => None,
        }
    }

    /// Seconds of one unit as far as it is known while rows are read.
    pub(super) fn scale(&self) -> f64 {
        match self {
            Self::Column { unit, .. } => unit.unwrap_or(TimeUnit::Seconds).seconds(),
            _ => 1.0,
        }
    }
}
