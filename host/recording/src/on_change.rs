//! Rows that a logger wrote whenever the count of an encoder changed, and at no other time.
//!
//! In: times in s and readings, one row a step. Out: what even sampling would have read, which is the last step. Taken as
//! they are, a rest has no rows, a turn has few, and each reading is half a step ahead, upwards and downwards.

use super::median_step_s;
use super::noise::smallest_step;

/// From this share of rows on that are one step off the row before, no clock wrote them: even samples of a sine are that for
/// two thirds of the time at most. With half of it these would be taken; with 1 none that missed a step.
const ONE_STEP: f64 = 0.9;

/// At a turn no row comes for more than so many times the usual step; even samples of whatever turns evenly have no such pause.
/// With half of it a row that is missing would do; a swing of eight steps to either side makes it five.
const PAUSE: f64 = 3.0;

/// Fewer rows could be so by chance.
const FEWEST: usize = 50;

/// There are never more than so many samples a row: pauses of hours stay short. Of 13 recordings of one bench 12 have 1.6 to 2.1,
/// and one that rests for long 3.2. Half of it would make that one's samples coarser, twice of it none.
const MOST_A_ROW: f64 = 4.0;

/// What stands for rows that were written on change.
pub(super) struct Held {
    /// Even times, s.
    pub(super) times_s: Vec<f64>,
    /// The last row at each of them.
    pub(super) rows: Vec<usize>,
}

/// Even samples of such rows, with a note; `None` where they are no such rows.
pub(super) fn held(times_s: &[f64], readings: &[f64], notes: &mut Vec<String>) -> Option<Held> {
    let step = smallest_step(readings).filter(|_| readings.len() >= FEWEST)?;
    let is_one_step = |pair: &&[f64]| ((pair[1] - pair[0]).abs() / step - 1.0).abs() < 0.5;
    let n_one_step = readings.windows(2).filter(is_one_step).count();
    let usual_s = median_step_s(times_s);
    let pauses = times_s.windows(2).any(|pair| pair[1] - pair[0] > PAUSE * usual_s);
    if (n_one_step as f64) < ONE_STEP * (readings.len() - 1) as f64 || !pauses {
        return None;
    }
    let (first_s, last_s) = (*times_s.first()?, *times_s.last()?);
    let step_s = usual_s.max((last_s - first_s) / (MOST_A_ROW * times_s.len() as f64));
    let n_samples = ((last_s - first_s) / step_s) as usize + 1;
    let even_s: Vec<f64> = (0..n_samples).map(|idx| first_s + idx as f64 * step_s).collect();
    let last_row = |time_s: &f64| times_s.partition_point(|row_s| row_s <= time_s).saturating_sub(1);
    notes.push(format!(
        "there is a row for each step of the encoder and none between: read as even samples would be, {:.4} a second",
        1.0 / step_s
    ));
    Some(Held { rows: even_s.iter().map(last_row).collect(), times_s: even_s })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_RAD: f64 = 0.0026;

    /// A swing that rests in the end, in steps; the instants at which it is looked at.
    fn steps(time_s: f64) -> f64 {
        let size_rad = (0.4 - 0.02 * time_s).max(0.0);
        (size_rad * (6.0 * time_s).sin() / STEP_RAD).round() * STEP_RAD
    }

    fn written_on_change(looked_at_s: impl Iterator<Item = f64>) -> (Vec<f64>, Vec<f64>) {
        let mut last = f64::NAN;
        let changed = |time_s: f64| {
            let is_new = steps(time_s) != last;
            last = steps(time_s);
            is_new.then_some((time_s, last))
        };
        looked_at_s.filter_map(changed).unzip()
    }

    #[test]
    fn a_row_for_each_step_is_read_as_even_samples_would_be() {
        let (times_s, readings) = written_on_change((0..1_500_000).map(|k| 3.0 + f64::from(k) * 2e-5));
        let mut notes = Vec::new();
        let held = held(&times_s, &readings, &mut notes).unwrap();
        let step_s = held.times_s[1] - held.times_s[0];
        assert!(held.times_s.windows(2).all(|pair| (pair[1] - pair[0] - step_s).abs() < 1e-9));
        assert!(held.times_s.len() == held.rows.len() && held.times_s.len() > times_s.len());
        let wrong = held.times_s.iter().zip(&held.rows).filter(|(t, row)| readings[**row] != steps(**t + 1e-9)).count();
        assert!(wrong < held.rows.len() / 50, "{wrong} of {}", held.rows.len());
        assert_eq!(notes.len(), 1);
    }

    #[test]
    fn a_pause_of_hours_makes_no_more_than_four_samples_a_row() {
        let (mut times_s, mut readings) = written_on_change((0..200_000).map(|k| f64::from(k) * 1e-4));
        times_s.push(7200.0);
        readings.push(readings[readings.len() - 1] + STEP_RAD);
        let held = held(&times_s, &readings, &mut Vec::new()).unwrap();
        assert!(held.times_s.len() <= 4 * times_s.len() + 1 && held.times_s.len() > 3 * times_s.len());
    }

    #[test]
    fn even_samples_in_steps_are_no_rows_on_change() {
        for rate_hz in [20.0, 100.0, 500.0, 923.0, 1500.0] {
            let times_s: Vec<f64> = (0..6000).map(|k| f64::from(k) / rate_hz).collect();
            let readings: Vec<f64> = times_s.iter().map(|t| steps(*t)).collect();
            assert!(held(&times_s, &readings, &mut Vec::new()).is_none(), "{rate_hz} Hz");
        }
    }

    #[test]
    fn even_samples_of_what_turns_evenly_are_no_rows_on_change() {
        let times_s: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
        let readings: Vec<f64> = (0..2000).map(|k| 0.1 + 1e-4 * f64::from(k)).collect();
        assert!(held(&times_s, &readings, &mut Vec::new()).is_none());
    }
}
