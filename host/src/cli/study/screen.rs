//! How far a study is: a bar on a terminal, a line for each tenth elsewhere.

use crate::cli::output;
use crate::study::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Without a terminal so many lines tell how far it is.
const N_LINES: usize = 10;

/// Shows progress, from several threads at once.
pub(super) struct Screen {
    bar: Option<ProgressBar>,
    n_all: AtomicUsize,
    n_done: AtomicUsize,
}

impl Screen {
    /// Nothing is done yet.
    pub(super) fn new() -> Self {
        let style =
            ProgressStyle::with_template("{bar:24} {pos} of {len} recordings, {elapsed} gone, {eta} to go  {msg}");
        let style = style.expect("a fixed template").progress_chars("━╸─");
        let bar = output::is_watched() && !output::is_quiet();
        let bar = bar.then(|| ProgressBar::new(0).with_style(style));
        Self { bar, n_all: AtomicUsize::new(0), n_done: AtomicUsize::new(0) }
    }

    /// One step more.
    pub(super) fn show(&self, progress: &Progress) {
        match progress {
            Progress::Begins(n_all) => self.begin(*n_all),
            Progress::Known | Progress::Kept(_) => self.step(),
            Progress::Diagnoses(rig) => match &self.bar {
                Some(bar) => bar.set_message(format!("what is missing from the model of {rig}?")),
                None => output::say(&format!("{rig}: more than noise is left; trying every effect …")),
            },
        }
    }

    fn begin(&self, n_all: usize) {
        self.n_all.store(n_all, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.set_length(n_all as u64);
        }
    }

    fn step(&self) {
        let n_done = self.n_done.fetch_add(1, Ordering::Relaxed) + 1;
        let n_all = self.n_all.load(Ordering::Relaxed);
        match &self.bar {
            Some(bar) => bar.inc(1),
            None if n_done.is_multiple_of(n_all.div_ceil(N_LINES).max(1)) || n_done == n_all => {
                output::say(&format!("{n_done} of {n_all} recordings"));
            }
            None => {}
        }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
