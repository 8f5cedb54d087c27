//! Watching a rig: which physics does its model lack, said while the pendulum swings.
//!
//! Readings are gathered at about 250 a second, releases one after the other, and the bank ([`shared::bank`]) looks at
//! all of them now and then. A swing has an error of one in a thousand to spend: half of it on the last look, when the
//! pendulum rests, the other half on the looks before, less on each. A rig that looks by itself has the last word.

mod by_rig;

pub use by_rig::{Asked, OwnLooks};

use crate::error::Failure;
use crate::look::{Look, RATE_HZ, said};
use crate::record::{Listener, Stage};
use shared::bank::findings::look;
use shared::bank::refit::{MAX_RELEASES, Releases};
use shared::parameters::Parameters;
use shared::sensor::Sensor;

/// A pendulum that was held is let go when it has moved so far, rad.
const MOVED_RAD: f64 = 0.03;

/// Of the swings that lack nothing, so many may be accused.
const ERROR_A_SWING: f64 = 1e-3;

/// Seconds of swing between two looks.
const LOOK_EVERY_S: f64 = 4.0;

/// Gathers readings and looks at them.
pub struct Watcher<'a> {
    parameters: Parameters<f64>,
    rate_hz: f64,
    every: usize,
    releases: Vec<Vec<f64>>,
    held_rad: Option<f64>,
    is_let_go: bool,
    sum_rad: f64,
    n_summed: usize,
    n_swings: usize,
    n_looks: usize,
    looked_at: usize,
    last: Option<Look>,
    tell: &'a mut dyn FnMut(Event),
}

/// What somebody at the rig may see.
pub enum Event<'a> {
    /// A new stage begins.
    Stage(Stage),
    /// The bank has looked.
    Looked(&'a Look),
    /// The rig itself looks now.
    RigLooks,
}

impl<'a> Watcher<'a> {
    /// For a rig with this model that samples so often.
    pub fn new(parameters: Parameters<f64>, rate_hz: f64, tell: &'a mut dyn FnMut(Event)) -> Self {
        let every = (rate_hz / RATE_HZ).round().max(1.0) as usize;
        Self {
            parameters,
            rate_hz,
            every,
            releases: Vec::new(),
            held_rad: None,
            is_let_go: false,
            sum_rad: 0.0,
            n_summed: 0,
            n_swings: 0,
            n_looks: 0,
            looked_at: 0,
            last: None,
            tell,
        }
    }

    /// The last look; at the end of a swing, after which the next one has its own error to spend.
    pub fn rests(&mut self) -> Look {
        let look = self.look(0.5 * ERROR_A_SWING);
        self.n_looks = 0;
        (self.tell)(Event::Looked(&look));
        self.last = Some(look.clone());
        look
    }

    /// From now on the rig has this model; releases that are there are looked at with it at once, as a rig does it.
    pub fn takes_over(&mut self, parameters: Parameters<f64>) {
        self.parameters = parameters;
        if !self.releases.is_empty() {
            self.rests();
        }
    }

    /// Releases so far.
    pub fn n_swings(&self) -> usize {
        self.n_swings
    }

    /// Says that the rig's own look is waited for.
    pub fn waits_for_rig(&mut self) {
        (self.tell)(Event::RigLooks);
    }

    fn interval_s(&self) -> f64 {
        self.every as f64 / self.rate_hz
    }

    fn look(&mut self, error: f64) -> Look {
        let parts: Vec<&[f64]> = self.releases.iter().map(Vec::as_slice).collect();
        self.looked_at = self.releases.last().map_or(0, Vec::len);
        let findings = look(&self.parameters, &Releases::new(&parts, self.interval_s()), error);
        said(&findings, self.n_swings)
    }

    fn begin(&mut self) {
        self.releases.push(Vec::new());
        let n_old = self.releases.len().saturating_sub(MAX_RELEASES);
        self.releases.drain(..n_old);
        (self.sum_rad, self.n_summed, self.looked_at) = (0.0, 0, 0);
    }
}

impl Listener for Watcher<'_> {
    fn stage(&mut self, stage: Stage) {
        if stage == Stage::Swinging {
            self.begin();
            (self.held_rad, self.is_let_go) = (None, false);
            self.n_swings += 1;
        }
        (self.tell)(Event::Stage(stage));
    }

    fn reading(&mut self, angle_rad: f64) {
        let held_rad = *self.held_rad.get_or_insert(angle_rad);
        self.is_let_go |= (angle_rad - held_rad).abs() > MOVED_RAD;
        if !self.is_let_go {
            return;
        }
        (self.sum_rad, self.n_summed) = (self.sum_rad + angle_rad, self.n_summed + 1);
        if let (true, Some(release)) = (self.n_summed == self.every, self.releases.last_mut()) {
            release.push(self.sum_rad / self.every as f64);
            (self.sum_rad, self.n_summed) = (0.0, 0);
        }
    }

    fn gap(&mut self) {
        self.begin();
    }

    fn pause(&mut self) {
        let n = self.releases.last().map_or(0, Vec::len);
        if ((n - self.looked_at.min(n)) as f64) * self.interval_s() < LOOK_EVERY_S {
            return;
        }
        self.n_looks += 1;
        // 1/(1·2) + 1/(2·3) + … = 1, however many looks there are.
        let share = 1.0 / (self.n_looks * (self.n_looks + 1)) as f64;
        let look = self.look(0.5 * ERROR_A_SWING * share);
        (self.tell)(Event::Looked(&look));
        self.last = Some(look);
    }
}

/// Why a swing with such a sensor says nothing.
pub fn disconnected(code: u16, sensor: &Sensor) -> Failure {
    let what = format!("the {} reads code {code}, an end of its range: nothing is said of this swing", sensor.name());
    Failure::failed(what).next(format!("{}; release from a smaller angle if it left its track", sensor.wires()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A release from this angle, 1 % nearer to the middle with every reading.
    fn release(watcher: &mut Watcher, from_rad: f64, n_readings: i32) {
        watcher.stage(Stage::Swinging);
        (0..n_readings).for_each(|k| watcher.reading(from_rad * 0.99_f64.powi(k)));
    }

    #[test]
    fn readings_are_averaged_to_about_250_a_second_from_where_it_is_let_go() {
        let mut silent = |_: Event| ();
        for (rate_hz, every, interval_s) in [(250.0, 1, 4e-3), (500.0, 2, 4e-3), (1000.0, 4, 4e-3), (100.0, 1, 1e-2)] {
            let mut watcher = Watcher::new(Parameters::paper(), rate_hz, &mut silent);
            assert_eq!(watcher.every, every, "{rate_hz} Hz");
            assert!((watcher.interval_s() - interval_s).abs() < 1e-12, "{rate_hz} Hz: {}", watcher.interval_s());
            // Held at 1 rad, it has moved by 0.03 with the fourth step.
            release(&mut watcher, 1.0, 4 + every as i32);
            let first: Vec<f64> = (4..4 + every as i32).map(|k| 0.99_f64.powi(k)).collect();
            let mean = first.iter().sum::<f64>() / every as f64;
            assert_eq!(watcher.releases.len(), 1);
            assert!((watcher.releases[0][0] - mean).abs() < 1e-12, "{:?} {mean}", watcher.releases);
        }
    }

    #[test]
    fn a_gap_makes_another_stretch_and_no_other_release_of_which_the_last_look_tells() {
        let mut n_looks = 0;
        let mut count = |event: Event| n_looks += usize::from(matches!(event, Event::Looked(_)));
        let mut watcher = Watcher::new(Parameters::paper(), 250.0, &mut count);
        release(&mut watcher, -1.0, 500);
        watcher.gap();
        (0..500).for_each(|_| watcher.reading(0.5));
        assert_eq!((watcher.releases.len(), watcher.n_swings()), (2, 1));
        assert_eq!((watcher.releases[0].len(), watcher.releases[1].len()), (496, 500));
        let look = watcher.rests();
        assert_eq!((look.swings, look.watched), (1, 1));
        assert_eq!(n_looks, 1);
    }

    #[test]
    fn it_looks_every_four_seconds_and_a_swing_that_rests_begins_to_count_anew() {
        let mut n_looks = 0;
        let mut count = |event: Event| n_looks += usize::from(matches!(event, Event::Looked(_)));
        let mut watcher = Watcher::new(Parameters::paper(), 250.0, &mut count);
        watcher.stage(Stage::Swinging);
        let swing = |k: i32| 0.5 * (0.024 * f64::from(k)).cos();
        for k in 0..3000 {
            watcher.reading(swing(k));
            watcher.pause();
        }
        // Twelve seconds without the beginning.
        assert_eq!(watcher.n_looks, 2);
        watcher.rests();
        assert_eq!(watcher.n_looks, 0);
        let mut other = Parameters::paper();
        other.set_friction(1e-3, 0.0, 0.0, 0.0);
        watcher.takes_over(other.clone());
        assert_eq!(watcher.parameters, other);
        assert_eq!(n_looks, 4);
    }
}
