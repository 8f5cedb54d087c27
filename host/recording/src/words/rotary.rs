//! The words of rotary pendulums: theta of the arm, alpha of the pendulum; elsewhere alpha is an acceleration.

use super::derivative::{has_derivative_sign, is_derivative};
use super::meaning::{Meaning, meaning};
use super::split::words;
use super::vocabulary::{RATE, SPEED};

/// What stands beside theta: nothing, or `qube` of `thetaQube`.
pub(crate) fn beside_theta(name: &str) -> Option<Vec<String>> {
    beside(name, |word| matches!(word, "theta" | "θ"))
}

/// What stands beside an alpha that is no derivative, has no unit, and so may be the angle that goes with a theta.
pub(crate) fn beside_alpha(name: &str) -> Option<Vec<String>> {
    beside(name, is_alpha_word).filter(|_| !is_rate_of_alpha(name) && !name.contains(['²', '^']))
}

fn beside(name: &str, is_it: fn(&str) -> bool) -> Option<Vec<String>> {
    let (those, others): (Vec<String>, Vec<String>) = words(name).into_iter().partition(|word| is_it(word));
    (those.len() == 1).then_some(others)
}

/// `alpha_dot`, `alphadot`, `dalpha`: alpha is an angle then.
pub(crate) fn is_rate_of_alpha(name: &str) -> bool {
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
pub(crate) fn is_speed(name: &str) -> bool {
    let words = words(name);
    let is_one = |word: &String| SPEED.contains(&word.as_str()) || RATE.contains(&word.as_str()) || is_derivative(word);
    matches!(meaning(name), Meaning::Rate { .. }) || has_derivative_sign(name) || words.iter().any(is_one)
}
