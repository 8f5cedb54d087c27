//! The words of rotary pendulums: theta of the arm, alpha of the pendulum; elsewhere alpha is an acceleration.

use super::{Meaning, RATE, has_derivative_sign, is_derivative, meaning, words};

/// Is it theta and nothing else?
pub(in crate::recording) fn is_theta(name: &str) -> bool {
    matches!(words(name).as_slice(), [word] if matches!(word.as_str(), "theta" | "θ"))
}

/// Is it alpha and nothing else, not even a unit?
pub(in crate::recording) fn is_alpha(name: &str) -> bool {
    matches!(words(name).as_slice(), [word] if is_alpha_word(word))
}

/// `alpha_dot`, `alphadot`, `dalpha`: alpha is an angle then.
pub(in crate::recording) fn is_rate_of_alpha(name: &str) -> bool {
    let words = words(name);
    let is_one = |word: &String| {
        let inner = [word.strip_prefix('d'), word.strip_suffix("dot"), word.strip_suffix('p')];
        inner.into_iter().flatten().any(is_alpha_word)
    };
    let is_named = words.iter().any(|word| is_alpha_word(word));
    words.iter().any(is_one)
        || is_named && (has_derivative_sign(name) || words.iter().any(|word| SPEED.contains(&word.as_str())))
}

fn is_alpha_word(word: &str) -> bool {
    matches!(word, "alpha" | "α")
}

/// Is it how fast an angle changes? `omega`, `theta_dot`, `velocity`.
pub(in crate::recording) fn is_speed(name: &str) -> bool {
    let words = words(name);
    let is_one = |word: &String| SPEED.contains(&word.as_str()) || RATE.contains(&word.as_str()) || is_derivative(word);
    matches!(meaning(name), Meaning::Rate { .. }) || has_derivative_sign(name) || words.iter().any(is_one)
}

/// Words of a speed.
const SPEED: &[&str] =
    &["dot", "punkt", "velocity", "vel", "velo", "speed", "v", "geschwindigkeit", "vitesse", "velocidad", "velocità"];
