//! How the period grows with the amplitude, in words.

/// What the period should do and does; beyond half a turn no pendulum swings to and fro.
pub(super) fn growth_in_words(predicted_percent: f64, found_percent: f64) -> String {
    if predicted_percent.is_finite() {
        format!(
            "the period should be {predicted_percent:.1} % longer in the largest swings than in the smallest, but is \
             {found_percent:.1} %"
        )
    } else {
        "no pendulum swings to and fro over more than half a turn to either side".to_owned()
    }
}
