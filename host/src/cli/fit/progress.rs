//! What is being done, while it is done: a bar on a terminal, plain lines elsewhere, nothing if asked to be quiet.

use crate::cli::output;
use crate::fit::identify::{Method, Progress};
use crate::fit::windows::WINDOWS_S;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// The bar is drawn anew so often, so that its clock runs.
const TICK: Duration = Duration::from_millis(100);

/// Shows the steps of an identification.
pub(super) struct Screen {
    bar: Option<ProgressBar>,
}

impl Screen {
    /// For a method and the longest of the swings, s.
    pub(super) fn new(method: Method, longest_s: f64) -> Self {
        let bar = output::is_watched() && !output::is_quiet();
        Self { bar: bar.then(|| bar_of(n_steps(method, longest_s))) }
    }

    /// A step begins.
    pub(super) fn show(&self, progress: Progress) {
        let text = progress.to_string();
        match &self.bar {
            Some(bar) => {
                bar.inc(1);
                bar.set_message(text);
            }
            None => output::say(&format!("{text} …")),
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

fn bar_of(n_steps: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {bar:24} {elapsed:>4}  {msg}").expect("a fixed template");
    let bar = ProgressBar::new(n_steps).with_style(style.progress_chars("━╸─"));
    bar.enable_steady_tick(TICK);
    bar
}

/// One step a window of response surfaces, then descent, stiction and uncertainties.
fn n_steps(method: Method, longest_s: f64) -> u64 {
    let n_windows = WINDOWS_S.iter().filter(|seconds| **seconds < 0.8 * longest_s).count() as u64 + 1;
    match method {
        Method::Rsm => n_windows + 1,
        Method::LeastSquares => 3,
        Method::Both => n_windows + 3,
    }
}
