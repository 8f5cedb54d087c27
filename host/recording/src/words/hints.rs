//! What else a name tells: whose it is, whether it counts, is a size, or says nothing at all.

use super::split::{words, words_with_digits};
use super::vocabulary::{COSINE, SINE};
use crate::units::{angle_unit, time_unit};

/// Is it the size of a vector, which has no sign? `Absolute (rad/s)`, `Gyroscope abs`.
pub(crate) fn is_size(name: &str) -> bool {
    words(name).iter().any(|word| SIZE.contains(&word.as_str()))
}

/// `time`, `theta1 (deg)`, and not `timeTrigger` or `theta_noisy`.
pub(crate) fn says_nothing_else(name: &str) -> bool {
    let says = |word: &&String| time_unit(word).is_none() && angle_unit(word).is_none() && !word.starts_with("pend");
    words(name).iter().filter(says).count() <= 1
}

/// Is one what an observer makes of the other? `theta_hat` of `theta`, `pole_angle_est` of `pole_angle`.
pub(crate) fn is_estimate_of(name: &str, measured: &str) -> bool {
    is_estimate(name) && {
        let bare = words_with_digits(name).filter(|word| !ESTIMATE.contains(&word.as_str()));
        bare.eq(words_with_digits(measured))
    }
}

/// Does it say that an observer made it?
pub(crate) fn is_estimate(name: &str) -> bool {
    words_with_digits(name).any(|word| ESTIMATE.contains(&word.as_str()))
}

/// `data`, `value`, `simout`: no word says what was measured.
pub(crate) fn says_nothing(name: &str) -> bool {
    let words = words(name);
    !words.is_empty() && words.iter().all(|word| MUTE.contains(&word.as_str()))
}

/// When a message was made, as against when it arrived: `header.stamp`.
pub(crate) fn is_stamp(name: &str) -> bool {
    let words = words(name);
    ["header", "stamp"].iter().all(|wanted| words.iter().any(|word| word == wanted))
}

/// Is it the sine or the cosine of an angle?
pub(crate) fn is_of_sine(name: &str) -> bool {
    words(name).iter().any(|word| SINE.contains(&word.as_str()) || COSINE.contains(&word.as_str()))
}

/// Does it count frames, samples or rows? `frame`, `Frame number`, `sample_idx`, `Bild`.
pub(crate) fn is_counter(name: &str) -> bool {
    let words = words(name);
    words.first().is_some_and(|word| COUNTER.contains(&word.as_str()))
        && words[1..].iter().all(|word| matches!(word.as_str(), "number" | "no" | "nr" | "idx" | "index" | "id"))
}

/// Is it the time since the row before? `dt`, `Δt (ms)`.
pub(crate) fn is_step(name: &str) -> bool {
    words(name).iter().any(|word| matches!(word.as_str(), "dt" | "δt"))
}

/// Does a name say that it is the pendulum's? `PendPos`, `pendulum_angle`, `Pendelwinkel`.
pub(crate) fn is_of_pendulum(name: &str) -> bool {
    words(name)
        .iter()
        .any(|word| word.starts_with("pend") || word.starts_with("pénd") || PENDULUM.contains(&word.as_str()))
}

/// Or that of what carries and moves it? `CartPos`, `arm_angle`.
pub(crate) fn is_of_carrier(name: &str) -> bool {
    words(name).iter().any(|word| CARRIER.contains(&word.as_str()))
}

/// Is it what a controller is told to hold? `target_deg`, `Sollwert`, `Alvo_graus`.
pub(crate) fn is_target(name: &str) -> bool {
    words(name).iter().any(|word| TARGET.contains(&word.as_str()))
}

/// Words of what a controller is told.
const TARGET: &[&str] = &[
    "target",
    "setpoint",
    "reference",
    "ref",
    "desired",
    "goal",
    "soll",
    "sollwert",
    "ziel",
    "sollwinkel",
    "zielwinkel",
    "consigne",
    "cible",
    "consigna",
    "referencia",
    "referência",
    "objetivo",
    "deseado",
    "alvo",
    "riferimento",
    "obiettivo",
];

/// Words of what an observer tells.
const ESTIMATE: &[&str] = &["hat", "est", "estimate", "estimated", "estimation"];

/// Words that tell nothing of a quantity.
const MUTE: &[&str] = &[
    "amplitude",
    "amplitud",
    "ampiezza",
    "auslenkung",
    "data",
    "field",
    "func",
    "function",
    "measurement",
    "messwert",
    "output",
    "plot",
    "reading",
    "sensor",
    "signal",
    "simout",
    "untitled",
    "val",
    "valeur",
    "valor",
    "valore",
    "value",
    "wert",
    "yout",
];

/// Words of what is counted.
const COUNTER: &[&str] =
    &["frame", "frames", "sample", "samples", "row", "index", "idx", "step", "bild", "image", "cuadro", "fotogramma"];

/// Words of a pendulum on a cart or an arm.
const PENDULUM: &[&str] = &["pole", "bob", "stange"];

/// Words of what carries it.
const CARRIER: &[&str] =
    &["cart", "trolley", "wagen", "chariot", "carro", "base", "arm", "motor", "servo", "rotor", "wheel"];

/// Words of a size.
const SIZE: &[&str] =
    &["absolute", "abs", "magnitude", "norm", "total", "absolut", "betrag", "absolue", "absoluto", "assoluto"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_is_that_of_the_name_beside_it_alone() {
        for (name, measured) in [("pole_angle_hat", "pole_angle"), ("thetaEst", "theta"), ("Estimated angle", "angle")]
        {
            assert!(is_estimate_of(name, measured), "{name}");
            assert!(!is_estimate_of(measured, name), "{name}");
        }
        for (name, measured) in [("theta2_hat", "theta1"), ("theta_hat", "angle"), ("theta", "theta"), ("test", "t")] {
            assert!(!is_estimate_of(name, measured), "{name}");
        }
    }
}
