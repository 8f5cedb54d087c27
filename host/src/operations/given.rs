//! Can these swings be asked together, of this pendulum?

use crate::error::Failure;
use crate::geometry;
use crate::swing::{Swing, one_kind};
use shared::parameters::Parameters;

/// Can these be swings of this pendulum, and of one? Gives the doubts; what speaks against a single swing among the
/// others is kept with it too.
///
/// # Errors
/// They can't be.
pub fn doubts(parameters: &Parameters<f64>, swings: &mut [Swing]) -> Result<Vec<String>, Failure> {
    let mut doubts = geometry::check(parameters, swings).map_err(Failure::failed)?;
    for (idx, words) in geometry::other_periods(parameters, swings) {
        doubts.push(format!("doubtful: {}: {words}", swings[idx].name));
        swings[idx].doubts.push(words);
    }
    Ok(doubts)
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_swing_of_another_pendulum_is_told_and_keeps_its_doubt() {
        let times_s: Vec<f64> = (0..4000).map(|idx| f64::from(idx) * 5e-3).collect();
        let swing = |name: &str, period_s: f64| {
            let angle = |t: &f64| 0.2 * (-0.02 * t).exp() * (TAU * t / period_s).cos();
            Swing::new(name, &times_s, &times_s.iter().map(angle).collect::<Vec<_>>(), 1e-4)
        };
        let parameters = Parameters::paper();
        let mut alike = [swing("a.csv", 1.047), swing("b.csv", 1.05)];
        assert_eq!(doubts(&parameters, &mut alike).unwrap(), Vec::<String>::new());
        let mut two = [swing("a.csv", 1.047), swing("b.csv", 1.047), swing("c.csv", 1.078)];
        let told = doubts(&parameters, &mut two).unwrap();
        assert!(told.len() == 1 && told[0].starts_with("doubtful: c.csv: its period"), "{told:?}");
        assert_eq!(two.map(|swing| swing.doubts.len()), [0, 0, 1]);
    }
}
