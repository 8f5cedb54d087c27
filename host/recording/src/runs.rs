//! Several runs in one file: a column names them, the time begins anew, or the names of the columns stand there again.
//!
//! In: the rows as they were read. Out: the rows of each run, which are then read as those of a file of its own. A clock
//! that was set back, a column that is a flag or counts rows, and rows out of order are no runs: see [`Runs::find`].

use super::error::Fault;
use super::labels::MOST_RUNS;
use super::limits::MIN_SAMPLES;
use super::samples::Samples;
use super::table::Table;

/// Each run begins within this share of the shortest one of where the first began. A clock that was set back goes on
/// from anywhere; a trigger that comes late shifts a run by a few samples.
const SAME_BEGIN: f64 = 0.05;

/// A counter that begins anew goes on without a gap; a gap of more than so many of its rows is another run's beginning.
const GOES_ON: f64 = 20.0;

/// Values that change from row to row, and not from run to run: in more than one of so many rows.
const ROWS_A_CHANGE: usize = 4;

/// So many runs are listed in a message.
const SHOWN: usize = 8;

/// A value of the column is shown up to so many letters.
const LONGEST_LABEL: usize = 40;

/// Words of a column that names the run.
const RUN: &[&str] = &[
    "run",
    "runs",
    "trial",
    "experiment",
    "exp",
    "test",
    "id",
    "take",
    "attempt",
    "repetition",
    "rep",
    "replicate",
    "series",
    "dataset",
    "recording",
    "file",
    "filename",
    "versuch",
    "versuchsnummer",
    "lauf",
    "durchgang",
    "durchlauf",
    "messung",
    "messreihe",
    "wiederholung",
    "essai",
    "mesure",
    "expérience",
    "ensayo",
    "prueba",
    "experimento",
    "prova",
    "misura",
    "esperimento",
];

/// What may stand beside them.
const BESIDE: &[&str] = &["id", "no", "nr", "num", "number", "nummer", "name", "idx", "index", "label"];

/// The column that names the run, by its name; one with a number in it (`Run 2`) is a run itself.
pub(super) fn column(table: &Table, is_free: impl Fn(usize) -> bool) -> Option<usize> {
    let names = table.names.as_deref()?;
    (0..names.len()).find(|idx| is_free(*idx) && names_runs(&names[*idx]))
}

fn names_runs(name: &str) -> bool {
    let words = words(name);
    let is_of = |list: &[&str], word: &String| list.contains(&word.as_str());
    words.first().is_some_and(|first| is_of(RUN, first)) && words[1..].iter().all(|word| is_of(BESIDE, word))
}

/// Is it one run of several that stand side by side? `Run 1`, `trial_2`, `Versuch 3`.
pub(super) fn is_one_of_several(name: &str) -> bool {
    let bare = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    bare.len() < name.len() && words(bare).iter().all(|word| RUN.contains(&word.as_str())) && !words(bare).is_empty()
}

/// Does a run's own name say that it is one? `Run 2`, `Versuch 3`.
pub(super) fn says_run(name: &str) -> bool {
    words(name).len() > 1 && words(name).first().is_some_and(|first| RUN.contains(&first.as_str()))
}

fn words(name: &str) -> Vec<String> {
    let parts = name.split(|letter: char| !letter.is_alphanumeric()).filter(|part| !part.is_empty());
    parts.map(str::to_lowercase).collect()
}

/// The runs of a file that holds several.
pub(super) struct Runs {
    /// What tells them, in words.
    by: String,
    names: Vec<String>,
    of_rows: Vec<u32>,
    /// Rows of several runs, or of several sensors, stand there in turn.
    alternate: bool,
}

impl Runs {
    /// Looks whether the rows are those of several runs.
    pub(super) fn find(samples: &Samples, table: &Table, column: Option<usize>) -> Option<Self> {
        let of_column = column.and_then(|idx| Self::of_column(samples, table.column_name(idx)));
        of_column
            .or_else(|| Self::of_begins(begins(&samples.times)?, samples, "the time begins anew with each"))
            .or_else(|| {
                let begins = samples.headings.clone();
                Self::of_begins(begins, samples, "the names of the columns stand above each")
            })
    }

    /// Each value has rows of its own, enough for a recording, and one block of them; or they stand there in turn.
    fn of_column(samples: &Samples, column: String) -> Option<Self> {
        let labels = &samples.labels;
        let (n_runs, n_rows) = (labels.names.len(), labels.of_rows.len());
        if n_runs < 2 || n_runs * MIN_SAMPLES > n_rows {
            return None;
        }
        let alternate = labels.n_changes() * ROWS_A_CHANGE > n_rows;
        let are_blocks = labels.n_changes() + 1 == n_runs;
        if !alternate && (!are_blocks || (labels.are_flags() && !samples.goes_back())) {
            return None;
        }
        let names = labels.names.iter().map(|name| shown(name)).collect();
        Some(Self { by: format!("column {column}"), names, of_rows: labels.of_rows.clone(), alternate })
    }

    fn of_begins(begins: Vec<usize>, samples: &Samples, by: &str) -> Option<Self> {
        let ends = begins.iter().skip(1).copied().chain([samples.len()]);
        let lengths: Vec<usize> = begins.iter().zip(ends).map(|(begin, end)| end.saturating_sub(*begin)).collect();
        if lengths.len() < 2 || lengths.len() > MOST_RUNS || lengths.iter().any(|length| *length < MIN_SAMPLES) {
            return None;
        }
        let of_rows = lengths.iter().enumerate().flat_map(|(run, n)| std::iter::repeat_n(run as u32, *n)).collect();
        let names = (1..=lengths.len()).map(|number| number.to_string()).collect();
        Some(Self { by: by.to_owned(), names, of_rows, alternate: false })
    }

    /// The rows of the runs that are wanted, or of all; what is done is noted.
    pub(super) fn apart(
        self,
        samples: Samples,
        wanted: &[String],
        notes: &mut Vec<String>,
    ) -> Result<Vec<(String, Samples)>, Fault> {
        let places = wanted.iter().map(|wanted| self.place(wanted)).collect::<Result<Vec<usize>, Fault>>()?;
        if self.alternate && wanted.is_empty() {
            let (runs, example) = (listed(&self.names), self.example(0));
            return Err(Fault::RunsInTurn { by: self.by, runs, example });
        }
        let mut parts: Vec<Option<Samples>> = samples.by_runs(&self.of_rows, self.names.len()).map(Some).collect();
        if wanted.is_empty() {
            notes.push(format!(
                "the file holds {} runs ({}: {}), each read as a recording; --run {} reads one",
                self.names.len(),
                self.by,
                listed(&self.names),
                self.example(1)
            ));
        }
        let places = if wanted.is_empty() { (0..parts.len()).collect() } else { places };
        let part = |place: usize| Some((self.names[place].clone(), parts[place].take()?));
        Ok(places.into_iter().filter_map(part).collect())
    }

    /// What chooses it: its name, or its number where a name would have to be quoted.
    fn example(&self, place: usize) -> String {
        example(&self.names, place)
    }

    /// By its name, else by its number from 1.
    fn place(&self, wanted: &str) -> Result<usize, Fault> {
        let by_name = self.names.iter().position(|name| *name.to_lowercase() == shown(wanted).to_lowercase());
        let by_number = || wanted.parse::<usize>().ok()?.checked_sub(1).filter(|place| *place < self.names.len());
        by_name.or_else(by_number).ok_or_else(|| Fault::NoSuchRun {
            wanted: wanted.to_owned(),
            there: format!("{} runs ({}: {})", self.names.len(), self.by, listed(&self.names)),
        })
    }
}

/// As names of recordings show it, which are no paths.
fn shown(label: &str) -> String {
    let sign = |letter: char| if letter.is_control() || matches!(letter, '/' | '\\') { '-' } else { letter };
    label.chars().take(LONGEST_LABEL).map(sign).collect()
}

/// Of a file that holds one run, only the first can be wanted.
pub(super) fn refuse_others(wanted: &[String]) -> Result<(), Fault> {
    let other = wanted.iter().find(|wanted| *wanted != "1");
    other.map_or(Ok(()), |wanted| Err(Fault::NoSuchRun { wanted: wanted.clone(), there: "one run".to_owned() }))
}

/// What chooses the run at a place: its name where that is one word, else its number.
pub(super) fn example(names: &[String], place: usize) -> String {
    let is_word = |name: &&String| name.chars().all(char::is_alphanumeric);
    names.get(place).filter(is_word).cloned().unwrap_or_else(|| (place + 1).to_string())
}

/// The first few, by comma.
pub(super) fn listed(names: &[String]) -> String {
    let more = if names.len() > SHOWN { ", …" } else { "" };
    names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ") + more
}

/// The first row of each run, where the time goes back to where it began and rises between. A counter of few bits that
/// begins anew goes on without a gap.
fn begins(times: &[f64]) -> Option<Vec<usize>> {
    let begins: Vec<usize> = (0..times.len()).filter(|idx| *idx == 0 || times[*idx] < times[*idx - 1]).collect();
    if begins.len() < 2 {
        return None;
    }
    let ends = begins.iter().skip(1).copied().chain([times.len()]);
    let runs: Vec<&[f64]> = begins.iter().zip(ends).map(|(begin, end)| &times[*begin..end]).collect();
    let lengths = runs.iter().map(|run| run[run.len() - 1] - run[0]);
    let shortest = lengths.fold(f64::MAX, f64::min);
    let begins_alike = |run: &&[f64]| (run[0] - times[0]).abs() <= SAME_BEGIN * shortest;
    (runs.iter().all(begins_alike) && !is_counter(&runs)).then_some(begins)
}

/// Do the times of all these go on where a counter of 16 or 32 bits begins anew?
fn is_counter(runs: &[&[f64]]) -> bool {
    let goes_on = |range: f64| {
        runs.windows(2).all(|pair| {
            let (before, here) = (pair[0][pair[0].len() - 1], pair[1][0]);
            let step = super::median_step_s(pair[0]);
            (0.0..=GOES_ON * step).contains(&(here + range - before))
        })
    };
    super::ticks::COUNTERS.into_iter().any(goes_on)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_names_the_run_where_its_name_says_nothing_else() {
        for name in ["run", "Trial", "run_id", "Versuch Nr.", "Experiment", "id", "File name"] {
            assert!(names_runs(name), "{name}");
        }
        for name in ["Run 2", "test angle", "idle", "runtime", "time", "number", "set"] {
            assert!(!names_runs(name), "{name}");
        }
        for name in ["Run 1", "trial_2", "Versuch3", "run12"] {
            assert!(is_one_of_several(name), "{name}");
        }
        for name in ["run", "theta_1", "12", "Run A"] {
            assert!(!is_one_of_several(name), "{name}");
        }
    }

    fn clock(n: usize, begin: f64, step: f64) -> Vec<f64> {
        (0..n).map(|row| begin + step * row as f64).collect()
    }

    #[test]
    fn a_time_that_begins_anew_is_told_from_a_clock_that_was_set_back_and_from_a_counter() {
        let joined = |runs: &[Vec<f64>]| runs.concat();
        assert_eq!(begins(&joined(&[clock(100, 0.0, 0.1), clock(80, 0.02, 0.1)])), Some(vec![0, 100]));
        assert_eq!(begins(&joined(&[clock(100, 0.0, 0.1), clock(80, 2.0, 0.1)])), None);
        assert_eq!(begins(&clock(100, 0.0, 0.1)), None);
        // 60 s in ms, and 16 bits of ms.
        assert_eq!(begins(&joined(&[clock(6000, 0.0, 10.0), clock(6000, 0.0, 10.0)])), Some(vec![0, 6000]));
        assert_eq!(begins(&joined(&[clock(6554, 0.0, 10.0), clock(6553, 4.0, 10.0)])), None);
    }
}
