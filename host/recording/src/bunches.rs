//! Rows that a computer stamped when it read them, many at once: from a serial port that is looked at now and then.
//!
//! In: times in s, and the readings. Out: the even times at which they were measured. A board that measures by its own clock sends
//! rows that lie on one straight line with the time; the computer finds them in bunches, each with a wait before it. Whether the
//! rows or the times are even the motion tells: over a wait it goes on by a row, or by all that it goes in that time.

/// Fewer rows could be uneven by chance.
const FEWEST: usize = 200;

/// A wait is longer than so many usual steps. Five recordings through a serial port have 17 rows a wait.
const WAIT_STEPS: f64 = 3.0;

/// There are so many waits at least.
const FEWEST_WAITS: usize = 20;

/// Waits take at least this share of the time. Of those recordings they take 0.69 to 0.71. Half and twice were not tried.
const WAITED: f64 = 0.5;

/// The last rows before waits lie so near to one line, in steps of it: those recordings have a scatter of 1.0 to 1.7. With half of it
/// one of them would be left, with twice of it 20 lost rows would pass.
const NEAR_STEPS: f64 = 5.0;

/// … but for as many as a computer that was busy leaves late.
const NEARLY_ALL: f64 = 0.95;

/// Steps beyond this share of them are wraps and spikes.
const NO_SPIKE: f64 = 0.99;

/// Takes the even times that the rows of bunches had.
pub(super) fn make_even(times_s: &mut [f64], readings: &[f64], notes: &mut Vec<String>) {
    let Some(even_s) = even(times_s, readings) else { return };
    let rate_hz = (even_s[1] - even_s[0]).recip();
    notes.push(format!(
        "the rows have times of bunches, as when a computer reads a serial port now and then, but the motion goes on evenly from row \
         to row: even times are taken, {rate_hz:.2} a second"
    ));
    times_s.copy_from_slice(&even_s);
}

fn even(times_s: &[f64], readings: &[f64]) -> Option<Vec<f64>> {
    if times_s.len() < FEWEST || readings.len() != times_s.len() {
        return None;
    }
    let steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let total_s: f64 = steps.iter().sum();
    let step_s = total_s / steps.len() as f64;
    let waits: Vec<usize> = (0..steps.len()).filter(|row| steps[*row] > WAIT_STEPS * step_s).collect();
    let waited_s: f64 = waits.iter().map(|row| steps[*row]).sum();
    if waits.len() < FEWEST_WAITS || waited_s < WAITED * total_s {
        return None;
    }
    // What was measured last before a wait waited least itself.
    let (line, line_step_s) = line_through(&waits, times_s)?;
    let off_s: Vec<f64> = waits.iter().map(|row| (times_s[*row] - line(*row)).abs()).collect();
    let (waits_share, waited_share) = (waits.len() as f64 / steps.len() as f64, waited_s / total_s);
    let is_of_rows = moved_share(readings, &waits)? < (waits_share * waited_share).sqrt();
    let is_even = is_of_rows && below(off_s, NEARLY_ALL) < NEAR_STEPS * line_step_s;
    is_even.then(|| (0..times_s.len()).map(line).collect())
}

/// How much of its way it goes in these steps; `None` where it does not move.
fn moved_share(readings: &[f64], rows: &[usize]) -> Option<f64> {
    let moved: Vec<f64> = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let most = below(moved.clone(), NO_SPIKE);
    let total: f64 = moved.iter().map(|step| step.min(most)).sum();
    let in_rows: f64 = rows.iter().map(|row| moved[*row].min(most)).sum();
    (total > 0.0).then(|| in_rows / total)
}

/// What this share of the numbers is below of.
fn below(mut numbers: Vec<f64>, share: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let place = (share * numbers.len() as f64) as usize;
    numbers.get(place.min(numbers.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
}

/// The times on the line through those of some rows, and its step.
fn line_through(rows: &[usize], times_s: &[f64]) -> Option<(impl Fn(usize) -> f64, f64)> {
    let mean = |of: &dyn Fn(usize) -> f64| rows.iter().map(|row| of(*row)).sum::<f64>() / rows.len() as f64;
    let (row, time_s) = (mean(&|row| row as f64), mean(&|row| times_s[row]));
    let across = mean(&|idx| (idx as f64 - row).powi(2));
    let step_s = mean(&|idx| (idx as f64 - row) * (times_s[idx] - time_s)) / across;
    let line = move |idx: usize| time_s + step_s * (idx as f64 - row);
    (step_s > 0.0 && step_s.is_finite()).then_some((line, step_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 260.0;

    fn swing(time_s: f64) -> f64 {
        0.9 * (-time_s / 8.0).exp() * (5.2 * time_s).cos()
    }

    /// Times at which a computer finds rows that it looks for after 50 to 80 ms, one every 0.6 ms.
    fn found(n: usize, lost: impl Fn(usize) -> bool) -> (Vec<f64>, Vec<f64>) {
        let sent: Vec<f64> = (0..n).filter(|row| !lost(*row)).map(|row| row as f64 / RATE_HZ).collect();
        let (mut looks_s, mut now_s, mut count) = (0.0, 0.0_f64, 0_u32);
        let mut found_s = Vec::new();
        for sent_s in &sent {
            while *sent_s > looks_s {
                count += 1;
                looks_s += 0.05 + 0.03 * f64::from(count.wrapping_mul(2_654_435_761) >> 16) / 65_536.0;
            }
            now_s = looks_s.max(now_s + 0.0006);
            found_s.push(now_s);
        }
        (found_s, sent.iter().map(|sent_s| swing(*sent_s)).collect())
    }

    #[test]
    fn rows_that_are_found_in_bunches_have_the_even_times_of_their_board() {
        let (mut times_s, readings) = found(4000, |_| false);
        let mut notes = Vec::new();
        make_even(&mut times_s, &readings, &mut notes);
        let step_s = (times_s[3999] - times_s[0]) / 3999.0;
        assert!((step_s * RATE_HZ - 1.0).abs() < 1e-3, "{step_s} {notes:?}");
        assert!(times_s.windows(2).all(|pair| ((pair[1] - pair[0]) / step_s - 1.0).abs() < 1e-6), "{notes:?}");
        assert!(notes[0].contains("even times are taken, 26"), "{notes:?}");
    }

    /// What a logger measures in bursts has the times that it says, and rows that were lost leave no line.
    #[test]
    fn bursts_and_lost_rows_keep_their_times() {
        let (bursts_s, _) = found(4000, |_| false);
        let of_bursts: Vec<f64> = bursts_s.iter().map(|time_s| swing(*time_s)).collect();
        let (lost_s, of_lost) = found(4000, |row| (1000..1200).contains(&row));
        let (held_s, _) = found(4000, |_| false);
        for (times_s, readings) in [(bursts_s, of_bursts), (lost_s, of_lost), (held_s, vec![0.3; 4000])] {
            let (mut kept_s, mut notes) = (times_s.clone(), Vec::new());
            make_even(&mut kept_s, &readings, &mut notes);
            assert!(kept_s == times_s && notes.is_empty(), "{notes:?}");
        }
    }
}
