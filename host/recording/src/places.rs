//! Places where rows are left out, for what is said of them.

/// Runs of marked rows.
pub(super) struct Places {
    /// The first marked row.
    pub(super) first_idx: usize,
    /// How many rows are marked.
    pub(super) n_rows: usize,
    /// How many runs of them there are.
    pub(super) n: usize,
}

impl Places {
    /// `None` where no row is marked.
    pub(super) fn of(marks: &[bool]) -> Option<Self> {
        let first_idx = marks.iter().position(|mark| *mark)?;
        let n_rows = marks.iter().filter(|mark| **mark).count();
        let n = 1 + marks[first_idx + 1..].windows(2).filter(|pair| !pair[0] && pair[1]).count();
        Some(Self { first_idx, n_rows, n })
    }

    /// What the rows become.
    pub(super) fn as_gaps(&self) -> &'static str {
        as_gaps(self.n)
    }
}

/// What rows become that are left out at so many places.
pub(super) fn as_gaps(n_places: usize) -> &'static str {
    if n_places == 1 { "a gap" } else { "gaps" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_touch_are_one_place() {
        let of = |marks: &[bool]| Places::of(marks).map(|places| (places.first_idx, places.n_rows, places.n));
        assert_eq!(of(&[true, true, false, true]), Some((0, 3, 2)));
        assert_eq!(of(&[false, true, true, false]), Some((1, 2, 1)));
        assert_eq!(of(&[false; 3]), None);
    }
}
