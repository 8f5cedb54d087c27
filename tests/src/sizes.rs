//! How large what is hidden in a rig has to be, so that a base model leaves what is wanted: found by some fits
//! ([`Rig::scaled_to`]), and kept in a file for the rigs of the usual runs, of which a third of the time was spent on that.
//!
//! A line a rig: its label, the sizes of what is hidden and, if asked for, how many noises the base model then leaves.

use crate::hidden::Rig;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Kept numbers differ by no more from those that are found; what a rig leaves is only known to a twelfth.
const ALIKE: f64 = 0.1;

/// By the label of a rig.
pub struct Sizes {
    kept: BTreeMap<String, Vec<f64>>,
    found: RefCell<BTreeMap<String, Vec<f64>>>,
}

impl Sizes {
    /// Those of a file.
    pub fn kept(file: &str) -> Self {
        let of_line = |line: &str| {
            let (label, numbers) = line.split_once(' ').expect("a label and numbers");
            (label.to_owned(), numbers.split(' ').map(|number| number.parse().expect("a number")).collect())
        };
        let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"));
        Self { kept: text.lines().map(of_line).collect(), found: RefCell::default() }
    }

    /// None is known, all are found.
    pub fn unknown() -> Self {
        Self { kept: BTreeMap::new(), found: RefCell::default() }
    }

    /// A rig with the sizes that are kept for it, or with those that are found.
    pub fn of(&self, label: &str, rig: Rig, found: impl FnOnce(Rig) -> Rig) -> Rig {
        self.made(label, rig, |rig| (found(rig), [])).0
    }

    /// The same, and how many noises a base model leaves.
    pub fn leaving(&self, label: &str, rig: Rig, found: impl FnOnce(Rig) -> (Rig, f64)) -> (Rig, f64) {
        let (rig, [left]) = self.made(label, rig, |rig| {
            let (rig, left) = found(rig);
            (rig, [left])
        });
        (rig, left)
    }

    fn made<const N: usize>(
        &self,
        label: &str,
        mut rig: Rig,
        found: impl FnOnce(Rig) -> (Rig, [f64; N]),
    ) -> (Rig, [f64; N]) {
        let Some(numbers) = self.kept.get(label) else {
            let (rig, more) = found(rig);
            let numbers = rig.hidden.iter().map(|hidden| hidden.size).chain(more).collect();
            self.found.borrow_mut().insert(label.to_owned(), numbers);
            return (rig, more);
        };
        assert_eq!(numbers.len(), rig.hidden.len() + N, "{label}");
        let (sizes, more) = numbers.split_at(rig.hidden.len());
        rig.hidden.iter_mut().zip(sizes).for_each(|(hidden, size)| hidden.size = *size);
        (rig, std::array::from_fn(|place| more[place]))
    }

    /// All that were found are kept in a file, and about the same there; `UPDATE_SIZES=1` writes it anew.
    #[track_caller]
    pub fn check_kept_in(&self, file: &str) {
        if std::env::var_os("UPDATE_SIZES").is_some() {
            return std::fs::write(file, self.lines()).unwrap_or_else(|error| panic!("{file}: {error}"));
        }
        let kept = Self::kept(file).kept;
        for (label, found) in self.found.borrow().iter() {
            let kept = kept.get(label).unwrap_or_else(|| panic!("{label} is not kept; UPDATE_SIZES=1 writes {file}"));
            let is_alike = |(kept, found): (&f64, &f64)| (kept / found - 1.0).abs() < ALIKE;
            assert!(kept.len() == found.len() && kept.iter().zip(found).all(is_alike), "{label}: {kept:?} {found:?}");
        }
    }

    fn lines(&self) -> String {
        self.found.borrow().iter().fold(String::new(), |mut lines, (label, numbers)| {
            lines += label;
            numbers.iter().for_each(|number| {
                let _ = write!(lines, " {number:e}");
            });
            lines + "\n"
        })
    }
}

/// A seed of the name alone, so that an effect that is added to the list changes no other rig.
pub fn seed_of(name: &str) -> u64 {
    name.bytes().fold(0, |seed, letter| (31 * seed + u64::from(letter)) % 500)
}
