//! Which run each row belongs to, as a column of the file says it.

use super::cell::is_missing;

/// Nobody records more of them into one file.
pub(super) const MOST_RUNS: usize = 200;

/// What says yes or no, and names nothing.
const FLAGS: &[&str] = &["0", "1", "true", "false", "yes", "no", "on", "off"];

/// Which run each row belongs to, as the file says it.
#[derive(Default)]
pub(super) struct Labels {
    pub(super) names: Vec<String>,
    pub(super) of_rows: Vec<u32>,
    is_too_many: bool,
}

impl Labels {
    /// The cell of another row; an empty one is as the one above, as where cells were joined.
    pub(super) fn push(&mut self, cell: &str) {
        if self.is_too_many {
            return;
        }
        let before = self.of_rows.last().map(|label| *label as usize);
        let is_same = |label: &usize| self.names[*label] == cell;
        let known = before.filter(|label| is_missing(cell) || is_same(label));
        let known = known.or_else(|| self.names.iter().position(|name| name == cell));
        let label = known.unwrap_or_else(|| {
            self.names.push(cell.to_owned());
            self.names.len() - 1
        });
        self.of_rows.push(label as u32);
        if self.names.len() > MOST_RUNS {
            *self = Self { is_too_many: true, ..Self::default() };
        }
    }

    pub(super) fn n_changes(&self) -> usize {
        self.of_rows.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    pub(super) fn are_flags(&self) -> bool {
        self.names.len() == 2 && self.names.iter().all(|name| FLAGS.contains(&name.to_lowercase().as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_cell_is_as_the_one_above_and_too_many_names_are_none() {
        let mut labels = Labels::default();
        ["A", "", "A", "B", "", "A"].iter().for_each(|cell| labels.push(cell));
        assert_eq!((labels.of_rows.clone(), labels.n_changes()), (vec![0, 0, 0, 1, 1, 0], 2));
        (0..1000).for_each(|row| labels.push(&format!("row {row}")));
        assert!(labels.names.is_empty() && labels.of_rows.is_empty());
    }
}
