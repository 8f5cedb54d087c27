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
    let too_long = geometry::too_long(parameters, swings);
    for (idx, words) in too_long.into_iter().chain(geometry::other_periods(parameters, swings)) {
        doubts.push(format!("doubtful: {}: {words}", swings[idx].name));
        swings[idx].doubts.push(words);
    }
    Ok(doubts)
}

/// What speaks against held-out swings beside the fitted ones, in words.
pub fn doubts_of_held_out(parameters: &Parameters<f64>, fitted: &[Swing], held_out: &[Swing]) -> Vec<String> {
    let others = geometry::held_out_of_other_periods(parameters, fitted, held_out);
    others.into_iter().map(|(idx, words)| format!("doubtful: {}: {words}", held_out[idx].name)).collect()
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
            double(name, other)
        };
        return Err(failure);
    }
    Ok(())
}

/// Why a recording is not given twice.
pub fn double(name: &str, other: &str) -> Failure {
    Failure::wrong_use(format!("{name} holds the same recording as {other}, which would count twice"))
        .next("give each recording once")
}

/// Are these readings the same, whatever their files are called?
pub fn is_same(a: &Swing, b: &Swing) -> bool {
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

    #[test]
    fn a_recording_counts_once_and_one_that_was_fitted_confirms_nothing() {
        let times_s: Vec<f64> = (0..400).map(|idx| f64::from(idx) * 5e-3).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|t| 0.2 * (6.0 * t).cos()).collect();
        let swing = |name: &str| Swing::new(name, &times_s, &angles_rad, 1e-4);
        let slower_s: Vec<f64> = times_s.iter().map(|t| 2.0 * t).collect();
        let other = Swing::new("other.csv", &slower_s, &angles_rad, 1e-4);
        let refused =
            |fitted: &[Swing], held_out: &[Swing]| refuse_doubles(fitted, held_out).unwrap_err().what().to_owned();
        // At other times it is another recording.
        assert!(refuse_doubles(&[swing("a.csv")], &[other]).is_ok());
        let held_out = refused(&[swing("a.csv")], &[swing("b.csv")]);
        assert!(held_out.starts_with("b.csv is fitted (as a.csv) and held out at once"), "{held_out}");
        let twice = refused(&[swing("a.csv"), swing("b.csv")], &[]);
        assert!(twice.starts_with("b.csv holds the same recording as a.csv"), "{twice}");
    }
}
