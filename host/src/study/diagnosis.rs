//! What is missing from the model of a rig? Asked of its newest swings, where these leave more than the noise.

use super::database::Diagnosed;
use super::folder::Rig;
use super::measure::{PROGRAM, Reading};
use super::rig::RigView;
use super::row::Row;
use crate::diagnose::{Diagnosis, diagnose};
use crate::swing::one_kind;
use crate::verdict::Left;
use std::path::Path;

/// So many swings: of one, effects that need several releases could not be told; more take longer and rarely tell more.
const N_SWINGS: usize = 3;

/// The swings to ask, if there is reason to: most of them leave more than noise.
pub(super) fn reason(view: &RigView) -> Option<Vec<&Row>> {
    let newest = view.newest(N_SWINGS);
    let leaves_more = |row: &&&Row| row.found().is_some_and(|found| found.leaves_more_than_noise());
    let n_leave_more = newest.iter().filter(leaves_more).count();
    (2 * n_leave_more > newest.len()).then_some(newest)
}

/// What a diagnosis is made from: another one is needed when this differs.
pub(super) fn origin(swings: &[&Row]) -> String {
    let line = |row: &&Row| format!("{} {} {}\n", row.key.recording, row.origin.file_hash, row.origin.model_hash);
    format!("{PROGRAM}\n{}", swings.iter().map(line).collect::<String>())
}

/// Reads the swings again and diagnoses; `None` if they are not what they were.
pub(super) fn diagnosed(folder: &Path, rig: &Rig, of: &[&Row], reading: &Reading) -> Option<Diagnosed> {
    let read = |row: &&Row| reading.swing(folder, rig, &row.key).ok().map(|(_, swing, _)| swing);
    let swings: Vec<_> = of.iter().map(read).collect::<Option<_>>()?;
    one_kind(swings.iter()).ok()?;
    let diagnosis = diagnose(&swings, &[], rig.model.known());
    let missing = diagnosis.verdict.iter().map(|name| (*name).to_owned()).collect();
    Some(Diagnosed { from: origin(of), missing, words: in_words(&diagnosis) })
}

fn in_words(diagnosis: &Diagnosis) -> String {
    let Diagnosis { verdict, undecided, rmse_before, rmse_after, noise, left, .. } = diagnosis;
    let unit = diagnosis.measured.milli_unit();
    let milli = |value: &f64| format!("{:.2}", 1e3 * value);
    if verdict.is_empty() {
        return match left {
            _ if !diagnosis.follows => "the model does not follow the swings at all".to_owned(),
            Left::Noise if diagnosis.levels.is_some() => {
                "no effect is missing, but the friction level differs between releases".to_owned()
            }
            Left::Noise => "nothing is missing from the model".to_owned(),
            _ => format!(
                "the model leaves {} {unit} where the noise is {}, and no effect of the list can be named",
                milli(rmse_after),
                milli(noise)
            ),
        };
    }
    let or = if undecided.is_empty() { String::new() } else { format!(" (or {})", undecided.join(", ")) };
    let (before, after, noise) = (milli(rmse_before), milli(rmse_after), milli(noise));
    format!(
        "missing from the model: {}{or}; with it the error falls from {before} to {after} {unit}, the noise is {noise}",
        verdict.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::rig::tests::row;
    use super::*;
    use crate::examples::diagnosis;

    fn rig(left: [&str; 3]) -> RigView {
        let row = |(name, left): (&str, &str)| {
            let mut row = row(name, 1.0, 0.1);
            row.outcome.as_mut().unwrap().left = left.to_owned();
            row
        };
        RigView::new("rig", ["1.csv", "2.csv", "3.csv"].into_iter().zip(left).map(row).collect())
    }

    #[test]
    fn a_rig_is_diagnosed_where_most_of_its_newest_swings_leave_more_than_noise() {
        assert!(reason(&rig(["missing", "noise", "noise"])).is_none());
        assert_eq!(reason(&rig(["missing", "nearly", "noise"])).map(|swings| swings.len()), Some(3));
    }

    #[test]
    fn what_is_missing_is_told_with_the_error_before_and_after() {
        let (verdict, undecided) = (vec!["quadratic-drag"], vec!["power-law-drag"]);
        let found = Diagnosis { verdict, undecided, rmse_before: 5e-3, rmse_after: 1.5e-3, noise: 1e-3, ..diagnosis() };
        assert_eq!(
            in_words(&found),
            "missing from the model: quadratic-drag (or power-law-drag); with it the error falls from 5.00 to 1.50 mrad, \
             the noise is 1.00"
        );
    }
}
