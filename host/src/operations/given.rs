//! Can these swings be asked together, of this pendulum?

use crate::error::Failure;
use crate::geometry;
use crate::swing::{Swing, one_kind};
use shared::parameters::Parameters;

/// Can these be swings of this pendulum? Gives the doubts.
///
/// # Errors
/// They can't be.
pub fn doubts(parameters: &Parameters<f64>, swings: &[Swing]) -> Result<Vec<String>, Failure> {
    geometry::check(parameters, swings).map_err(Failure::failed)
}

/// Refuses what would count twice.
///
/// # Errors
/// Angles and rates together; a recording that is given twice, or fitted and held out at once.
pub fn refuse_doubles(fitted: &[Swing], held_out: &[Swing]) -> Result<(), Failure> {
    one_kind(fitted.iter().chain(held_out)).map_err(Failure::failed)?;
    let all: Vec<(&Swing, bool)> =
        fitted.iter().map(|swing| (swing, false)).chain(held_out.iter().map(|swing| (swing, true))).collect();
    for (i, (swing, is_held_out)) in all.iter().enumerate() {
        let Some((other, _)) = all[..i].iter().find(|(other, _)| is_same(swing, other)) else { continue };
        let (name, other) = (&swing.name, &other.name);
        let was_fitted = *is_held_out && fitted.iter().any(|fitted| is_same(swing, fitted));
        let failure = if was_fitted {
            Failure::wrong_use(format!("{name} is fitted (as {other}) and held out at once, so it confirms nothing"))
                .next("hold out another recording, or leave this one out of the fit")
        } else {
            Failure::wrong_use(format!("{name} holds the same recording as {other}, which would count twice"))
                .next("give each recording once")
        };
        return Err(failure);
    }
    Ok(())
}

fn is_same(a: &Swing, b: &Swing) -> bool {
    a.len() == b.len() && a.angles_rad == b.angles_rad && a.times_s == b.times_s
}
