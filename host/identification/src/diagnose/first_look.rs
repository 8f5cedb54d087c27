//! The first look: what the bank, with which a rig looks by itself, says of the same swings.
//!
//! It says within a fraction of a second what the diagnosis then goes into, and tells what a rig will say by itself of
//! such swings.

use crate::look::{Look, RATE_HZ, said};
use crate::recording::{Measured, median_step_s};
use crate::swing::Swing;
use shared::bank::findings::look;
use shared::bank::order::ERROR_A_LOOK;
use shared::bank::refit::{MAX_RELEASES, Releases};
use shared::parameters::Parameters;

/// Times are even if each step is as long as the usual one within this share; a hole is a multiple of it.
const EVEN: f64 = 0.1;

/// Looks at swings with a model that was fitted to them; `None` for rates and for samples that are not even, which the
/// bank doesn't read, and for readings without noise, by which it judges. Of many releases it takes the last ones, of
/// several rates those like the first.
pub fn first_look(swings: &[Swing], model: &Parameters<f64>) -> Option<Look> {
    if swings.iter().any(Swing::has_no_noise) {
        return None;
    }
    let releases: Vec<(f64, Vec<f64>)> = swings.iter().map(parts).collect::<Option<Vec<_>>>()?.concat();
    let interval_s = releases.first()?.0;
    let alike = releases.iter().filter(|(own_s, _)| (own_s / interval_s - 1.0).abs() < 1e-3);
    let readings: Vec<&[f64]> = alike.map(|(_, readings)| readings.as_slice()).collect();
    let findings = look(model, &Releases::new(&readings, interval_s), f64::from(ERROR_A_LOOK));
    Some(said(&findings, readings.len().min(MAX_RELEASES)))
}

/// A swing as the bank reads it: means of at most [`RATE_HZ`] a second, with their interval in s, a part between two
/// holes each.
fn parts(swing: &Swing) -> Option<Vec<(f64, Vec<f64>)>> {
    if swing.measured != Measured::Angle {
        return None;
    }
    let steps_s: Vec<f64> = swing.times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let usual_s = median_step_s(&swing.times_s);
    if steps_s.iter().any(|step_s| *step_s < (1.0 - EVEN) * usual_s) {
        return None;
    }
    let every = ((1.0 / usual_s / RATE_HZ).round() as usize).max(1);
    // A mean over what it really took: rounded times would add up to a wrong period.
    let is_hole = |step_s: &f64| *step_s > (1.0 + EVEN) * usual_s;
    let whole_s: f64 = steps_s.iter().filter(|step_s| !is_hole(step_s)).sum();
    let n_whole = steps_s.iter().filter(|step_s| !is_hole(step_s)).count();
    let interval_s = every as f64 * whole_s / n_whole as f64;
    let mut ends: Vec<usize> =
        (0..steps_s.len()).filter(|place| is_hole(&steps_s[*place])).map(|place| place + 1).collect();
    ends.push(swing.len());
    let mut begin = 0;
    let mut parts = Vec::new();
    for end in ends {
        let means =
            swing.angles_rad[begin..end].chunks_exact(every).map(|chunk| chunk.iter().sum::<f64>() / every as f64);
        let means: Vec<f64> = means.collect();
        if !means.is_empty() {
            parts.push((interval_s, means));
        }
        begin = end;
    }
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;
    use shared::model::Model;

    const RATE_HZ: f64 = 1000.0;

    /// A swing with a hidden drag and a converter's noise, without what lies between two times.
    fn swing(hole_s: (f64, f64)) -> Swing {
        let mut truth = Parameters::paper();
        truth.set(10, &[2e-4]).unwrap();
        let (model, mut noise) = (Model::new(&truth), Noise::new(7));
        let mut state = model.release(1.4, 0.0);
        let (mut times_s, mut angles_rad) = (Vec::new(), Vec::new());
        for n in 0..25_000 {
            let time_s = f64::from(n) / RATE_HZ;
            if !(hole_s.0..hole_s.1).contains(&time_s) {
                times_s.push(time_s);
                angles_rad.push(state.angle_rad + 1e-3 * noise.normal());
            }
            model.step(&mut state, 1.0 / RATE_HZ);
        }
        Swing::new("swing", &times_s, &angles_rad, 1e-3)
    }

    #[test]
    fn a_drag_is_seen_at_once_and_beyond_a_hole() {
        for hole_s in [(0.0, 0.0), (6.0, 6.7)] {
            let look = first_look(&[swing(hole_s)], &Parameters::paper()).unwrap();
            assert_eq!(look.named, ["quadratic-drag"], "{look:?}");
            let number = &look.candidates[0].values[0];
            assert!((number.value - 2e-4).abs() < 4.0 * number.std.unwrap(), "{number:?}");
        }
    }

    #[test]
    fn rates_and_uneven_samples_are_not_looked_at() {
        let even = swing((0.0, 0.0));
        let rates = Swing::of("rates", Measured::Rate, &even.times_s, &even.angles_rad, 1e-3);
        assert!(first_look(&[rates], &Parameters::paper()).is_none());
        let uneven_s: Vec<f64> = even.times_s.iter().map(|t| t + 4e-4 * (900.0 * t).sin()).collect();
        assert!(first_look(&[even.like(&uneven_s, &even.angles_rad)], &Parameters::paper()).is_none());
    }
}
