//! Names that say how fast an angle changes, by the form of a word or by a sign.

use super::vocabulary::ANGLE;

/// `thetadot`, `phipunkt`, `dtheta`: one word for a derivative.
pub(super) fn is_derivative(word: &str) -> bool {
    let is_angle = |rest: Option<&str>| rest.is_some_and(|rest| ANGLE.contains(&rest));
    ["dot", "punkt", "ddot", "p"].iter().any(|end| is_angle(word.strip_suffix(end)))
        || ["d", "dd", "delta"].iter().any(|begin| is_angle(word.strip_prefix(begin)))
        || word.ends_with("geschwindigkeit")
        || word.ends_with("velocity")
}

/// `θ'`, `dθ/dt`, `θ̇`, and not `'Group'/'Angle'`, whose quotes open before a word.
pub(super) fn has_derivative_sign(name: &str) -> bool {
    let is_quoted = name.split('\'').skip(1).any(|behind| behind.starts_with(char::is_alphabetic));
    name.contains("/dt")
        || (name.trim_end().ends_with('\'') && !is_quoted)
        || name.contains('\u{307}')
        || name.contains('\u{308}')
}
