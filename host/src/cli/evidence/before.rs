//! What must be said before a diagnosis is believed: what touched or drives the pendulum, and how badly the model follows.

use crate::cli::table::wrapped;
use crate::diagnose::Diagnosis;
use crate::fit::touch::Touch;
use crate::verdict::{LOOK_FIRST, followed_one_by_one};

/// A paragraph each, none where nothing speaks against the swings.
pub(super) fn in_words(diagnosis: &Diagnosis) -> Vec<String> {
    let touches = diagnosis.touches.iter().map(touched);
    touches.chain(driven(diagnosis)).chain(lost(diagnosis)).chain(hardly_followed(diagnosis)).collect()
}

/// What a touch leaves must not be taken for a law.
fn touched(touch: &Touch) -> String {
    let (sentence, alone) = (touch.sentence(), touch.alone("diagnose"));
    wrapped(&format!("{sentence} Only the longer part of that swing is looked at here, as if by {alone}."), 0)
}

/// That a motor or a hand drives the swings.
fn driven(diagnosis: &Diagnosis) -> Option<String> {
    let words = format!(
        "The swings of {} don't become smaller, as free ones do: a motor or a hand drives them. What follows takes them for \
         free ones and says nothing of this pendulum.",
        diagnosis.driven.join(", ")
    );
    (!diagnosis.driven.is_empty()).then(|| wrapped(&words, 0))
}

/// That no model follows: where the noise is as large as the motion, a model that stands still leaves noise.
fn lost(diagnosis: &Diagnosis) -> Option<String> {
    let (unit, name) = (diagnosis.measured.unit(), diagnosis.measured.name());
    let words = format!(
        "The model does not follow these swings at all: it leaves {:.3} {unit}, with a noise of {:.3} {unit}. Is the {name} in \
         {unit}, zero where the pendulum hangs, and the geometry right? Did nothing touch or drive it (--from, --to)? \
         Until that is right, no diagnosis means anything.",
        diagnosis.rmse_after, diagnosis.noise
    );
    (!diagnosis.follows).then(|| wrapped(&words, 0))
}

/// That what is left is too much for an effect: the wrong column, a wrong unit or a hand look like missing physics too.
fn hardly_followed(diagnosis: &Diagnosis) -> Option<String> {
    let unit = diagnosis.measured.milli_unit();
    let apart = diagnosis.apart_rmse.map_or(String::new(), |rmse| format!(" And {}.", followed_one_by_one(rmse, unit)));
    let words = format!(
        "The model hardly follows these swings: before you believe anything of what follows, {LOOK_FIRST} (host compare \
         shows where it fails).{apart}"
    );
    (diagnosis.follows && diagnosis.hardly_follows && diagnosis.driven.is_empty()).then(|| wrapped(&words, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::diagnosis;

    #[test]
    fn what_hardly_follows_is_doubted_once_and_first() {
        let told = |follows: bool, hardly_follows: bool, driven: &[&str]| {
            let driven = driven.iter().map(|name| (*name).to_owned()).collect();
            in_words(&Diagnosis { follows, hardly_follows, driven, ..diagnosis() })
        };
        assert!(told(true, false, &[]).is_empty());
        let hardly = told(true, true, &[]);
        assert!(hardly.len() == 1 && hardly[0].starts_with("The model hardly follows these swings"), "{hardly:?}");
        let lost = told(false, true, &[]);
        assert!(lost.len() == 1 && lost[0].starts_with("The model does not follow these swings at all"), "{lost:?}");
        let driven = told(true, true, &["motor.csv"]);
        assert!(driven.len() == 1 && driven[0].contains("drives them"), "{driven:?}");
    }

    #[test]
    fn recordings_that_are_followed_one_by_one_are_told_apart_where_all_together_are_hardly_followed() {
        let told = |hardly_follows: bool| {
            in_words(&Diagnosis { follows: true, hardly_follows, apart_rmse: Some(2.45e-2), ..diagnosis() })
        };
        let words = told(true)[0].replace('\n', " ");
        assert!(
            words.contains(
                ". And each recording has a model of its own that follows it far better, to 24.50 mrad: what"
            ),
            "{words}"
        );
        assert!(told(false).is_empty());
    }
}
