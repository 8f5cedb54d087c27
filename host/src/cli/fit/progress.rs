//! What is being done, while it is done: a bar on a terminal, plain lines elsewhere, nothing if asked to be quiet.

use crate::cli::output;
use crate::fit::identify::{Method, Progress};
use crate::fit::windows::windows_s;
use crate::operations::fit::News;
use crate::swing::Swing;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// The bar is drawn anew so often, so that its clock runs.
const TICK: Duration = Duration::from_millis(100);

/// Shows the steps of a fit.
pub(super) struct Screen {
    method: Method,
    n_windows: usize,
    /// On a terminal, from the first step on.
    bar: Mutex<Option<ProgressBar>>,
}

impl Screen {
    /// For a method and the swings that it is for.
    pub(super) fn new(method: Method, swings: &[Swing]) -> Self {
        Self { method, n_windows: windows_s(swings).count() + 1, bar: Mutex::new(None) }
    }

    /// Something begins.
    pub(super) fn show(&self, news: News) {
        match news {
            News::Identifying(progress) if output::is_watched() && !output::is_quiet() => self.advance(&progress),
            News::NothingNamed | News::LevelsDiffer => output::warn(&news.to_string()),
            News::Discovering => {
                self.clear();
                output::say(&news.to_string());
            }
            _ => output::say(&news.to_string()),
        }
    }

    fn advance(&self, progress: &Progress) {
        let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        let bar = bar.get_or_insert_with(|| bar_of(n_steps(self.method, self.n_windows as u64)));
        bar.inc(1);
        bar.set_message(progress.to_string());
    }

    fn clear(&self) {
        if let Some(bar) = self.bar.lock().unwrap_or_else(PoisonError::into_inner).take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        self.clear();
    }
}

fn bar_of(n_steps: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {bar:24} {elapsed:>4}  {msg}").expect("a fixed template");
    let bar = ProgressBar::new(n_steps).with_style(style.progress_chars("━╸─"));
    bar.enable_steady_tick(TICK);
    bar
}

/// One step a window of response surfaces, then descent, stiction and uncertainties.
fn n_steps(method: Method, n_windows: u64) -> u64 {
    match method {
        Method::Rsm => n_windows + 1,
        Method::LeastSquares => 3,
        Method::Both => n_windows + 3,
    }
}
