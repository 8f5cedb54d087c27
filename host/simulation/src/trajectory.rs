//! Simulated readings at given times.
//!
//! The Runge–Kutta step need not be the sampling interval: longer steps are taken and the samples between are read off
//! the cubic through both ends (Hermite), which is exact to 2e-7 rad at 10 ms.

use crate::lanes::{Lanes, pack};
use shared::measured::Measured;
use shared::model::{Model, SensorState, State};
use shared::parameters::Parameters;
use shared::real::Real;
use std::array;
use std::sync::Arc;

/// One integration step and the samples that fall into it (after its start, up to its end).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    dt_s: f64,
    n_samples: usize,
}

/// How to step through a list of sample times.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Shared with the swing and its other schedules: recordings are long.
    times_s: Arc<[f64]>,
    steps: Vec<Step>,
    /// What is read at the samples.
    measured: Measured,
}

impl Schedule {
    /// `times_s` must rise strictly; the first is the start. No step is longer than `longest_step_s`. Angles are read.
    pub fn new(times_s: &Arc<[f64]>, longest_step_s: f64) -> Self {
        let mut schedule = Self { times_s: times_s.clone(), steps: Vec::new(), measured: Measured::Angle };
        let mut from = 0;
        while from + 1 < times_s.len() {
            from = schedule.add_step(from, longest_step_s);
        }
        schedule.steps.shrink_to_fit();
        schedule
    }

    /// One step from sample `from` over as many samples as it may hold, or several into one long interval.
    fn add_step(&mut self, from: usize, longest_step_s: f64) -> usize {
        let times_s = &self.times_s;
        // The tolerance keeps five 1 ms intervals in one step although 5 × 0.001 rounds up.
        let reachable = |i: &usize| times_s[*i] - times_s[from] <= longest_step_s * (1.0 + 1e-9);
        let to = (from + 1..times_s.len()).take_while(reachable).last().unwrap_or(from + 1);
        let length_s = times_s[to] - times_s[from];
        let n_steps = (length_s / longest_step_s * (1.0 - 1e-9)).ceil().max(1.0);
        let dt_s = length_s / n_steps;
        self.steps.extend((1..n_steps as usize).map(|_| Step { dt_s, n_samples: 0 }));
        self.steps.push(Step { dt_s, n_samples: to - from });
        to
    }

    /// The same steps, at whose samples this is read.
    pub fn reading(self, measured: Measured) -> Self {
        Self { measured, ..self }
    }

    /// Number of integration steps that a simulation of the first samples takes, about.
    pub fn n_steps_to(&self, n_samples: usize) -> usize {
        self.steps.len() * n_samples / self.times_s.len().max(1)
    }

    /// Number of integration steps.
    pub fn n_steps(&self) -> usize {
        self.steps.len()
    }

    /// Number of samples after the first.
    pub fn n_samples(&self) -> usize {
        self.times_s.len().saturating_sub(1)
    }
}

/// So many simulations at once take about as long as one.
pub const LANES: usize = 4;

/// So many are worth taking at once. In registers of AVX2 eight lanes take 1.0 to 1.5 times as long as four (1.3 with the base
/// model), in those of SSE2 1.3 to 2.0 times (2.0).
pub const AT_ONCE: usize = if cfg!(target_feature = "avx2") { 2 * LANES } else { LANES };

/// How a pendulum is let go, at the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Release {
    /// θ, rad.
    pub angle_rad: f64,
    /// ω, rad/s.
    pub velocity_rad_s: f64,
    /// How long it has been free already, s.
    pub begins_s: f64,
}

/// The readings at the first so many samples: rad, or rad/s where rates are measured.
pub fn readings(parameters: &Parameters<f64>, release: Release, schedule: &Schedule, n_samples: usize) -> Vec<f64> {
    let model = Model::new(parameters);
    let mut state = model.release(release.angle_rad, release.velocity_rad_s);
    state.time_s = release.begins_s;
    let mut readings = Vec::with_capacity(n_samples);
    simulate(&model, state, schedule, n_samples, |_, reading| readings.push(reading));
    readings
}

/// The same of several sets of parameters, each let go in its own way; quickest if they have the same effects and are as
/// many as [`AT_ONCE`].
pub fn readings_of_each(runs: &[(Parameters<f64>, Release)], schedule: &Schedule, n_samples: usize) -> Vec<Vec<f64>> {
    let alone = |run: &(Parameters<f64>, Release)| readings(&run.0, run.1, schedule, n_samples);
    let at_once = |runs: &[(Parameters<f64>, Release)]| {
        let together = match runs.len() {
            1 => None,
            n if n <= LANES => side_by_side::<LANES>(runs, schedule, n_samples),
            _ => side_by_side::<AT_ONCE>(runs, schedule, n_samples),
        };
        together.unwrap_or_else(|| runs.iter().map(alone).collect())
    };
    runs.chunks(AT_ONCE).flat_map(at_once).collect()
}

/// `None` if they have not the same effects. Spare lanes repeat the last run.
fn side_by_side<const N: usize>(
    runs: &[(Parameters<f64>, Release)],
    schedule: &Schedule,
    n_samples: usize,
) -> Option<Vec<Vec<f64>>> {
    let run = |lane: usize| &runs[lane.min(runs.len() - 1)];
    let parameters = pack::<N>(&array::from_fn(|lane| &run(lane).0))?;
    let of_each = |pick: fn(&Release) -> f64| Lanes(array::from_fn(|lane| pick(&run(lane).1)));
    let model = Model::new(&parameters);
    let mut state = model.release(of_each(|release| release.angle_rad), of_each(|release| release.velocity_rad_s));
    state.time_s = of_each(|release| release.begins_s);
    let mut readings: Vec<Vec<f64>> = runs.iter().map(|_| Vec::with_capacity(n_samples)).collect();
    simulate(&model, state, schedule, n_samples, |_, reading| {
        for (column, value) in readings.iter_mut().zip(reading.0) {
            column.push(value);
        }
    });
    Some(readings)
}

/// Simulates from `state`, at the first sample, and calls `read` with each sample's index and reading (rad, or
/// rad/s where rates are measured), until `n_samples` of them are read.
#[inline]
fn simulate<R: Real>(
    model: &Model<R>,
    mut state: State<R>,
    schedule: &Schedule,
    n_samples: usize,
    mut read: impl FnMut(usize, R),
) {
    let mut sensor = match schedule.measured {
        Measured::Angle => model.sensor_at_rest(&state),
        Measured::Rate => model.rate_sensor_at_rest(&state),
    };
    let reading = |state: &State<R>, sensor: &mut SensorState<R>| match schedule.measured {
        Measured::Angle => model.read(state, sensor),
        Measured::Rate => model.read_rate(state, sensor),
    };
    read(0, reading(&state, &mut sensor));
    let mut sample = 1;
    for step in &schedule.steps {
        if sample >= n_samples {
            return;
        }
        let before = state;
        model.step(&mut state, R::of(step.dt_s));
        // Several steps to one sample end at it.
        let first = sample - 1;
        for within in 1..=step.n_samples.min(n_samples - sample) {
            let share = || (schedule.times_s[sample] - schedule.times_s[first]) / step.dt_s;
            let is_end = within == step.n_samples;
            let here = if is_end { state } else { between(&before, &state, share(), step.dt_s) };
            read(sample, reading(&here, &mut sensor));
            sample += 1;
        }
    }
}

/// The state at a share of a step, on the cubic through both ends.
#[inline]
fn between<R: Real>(before: &State<R>, after: &State<R>, share: f64, dt_s: f64) -> State<R> {
    let s = share;
    let h11 = s * s * (s - 1.0);
    let h01 = s * s * (3.0 - 2.0 * s);
    let h10 = s * (1.0 - s) * (1.0 - s);
    let angle_rad = before.angle_rad
        + R::of(h01) * (after.angle_rad - before.angle_rad)
        + R::of(h10 * dt_s) * before.velocity_rad_s
        + R::of(h11 * dt_s) * after.velocity_rad_s;
    let mut here = *after;
    here.angle_rad = angle_rad;
    // The slope of the same cubic: a straight line between the velocities would be 3e-3 rad/s off.
    let chord = R::of(6.0 * s * (1.0 - s) / dt_s) * (after.angle_rad - before.angle_rad);
    here.velocity_rad_s = chord
        + R::of((1.0 - s) * (1.0 - 3.0 * s)) * before.velocity_rad_s
        + R::of(s * (3.0 * s - 2.0)) * after.velocity_rad_s;
    here.time_s = before.time_s + R::of(s * dt_s);
    here
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::parameters::Parameters;

    fn swing(times_s: &[f64]) -> Vec<f64> {
        let schedule = Schedule::new(&times_s.into(), 5e-3);
        readings(&Parameters::paper(), RELEASE, &schedule, times_s.len())
    }

    const RELEASE: Release = Release { angle_rad: 1.5, velocity_rad_s: 0.0, begins_s: 0.0 };

    #[test]
    fn long_steps_with_interpolation_agree_with_short_ones() {
        let fine: Vec<f64> = (0..20_001).map(|i| f64::from(i) * 1e-3).collect();
        let coarse: Vec<f64> = (0..2001).map(|i| f64::from(i) * 1e-2).collect();
        let (fine, coarse) = (swing(&fine), swing(&coarse));
        assert_eq!((fine.len(), coarse.len()), (20_001, 2001));
        let worst = coarse.iter().enumerate().map(|(i, x)| (x - fine[10 * i]).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-7, "{worst:e}");
    }

    #[test]
    fn several_together_read_what_each_reads_alone() {
        let times_s: Vec<f64> = (0..1500).map(|i| f64::from(i) * 1e-2).collect();
        let schedule = Schedule::new(&times_s.as_slice().into(), 1e-2);
        let run = |i: usize| {
            let mut parameters = Parameters::paper();
            parameters.pendulum.inertia_kg_m2 *= 1.0 + 1e-3 * i as f64;
            (parameters, Release { angle_rad: 0.9 + 0.1 * i as f64, velocity_rad_s: 0.2, begins_s: 0.0 })
        };
        for n_runs in [0, 1, 2, LANES, LANES + 1, 2 * LANES + 3] {
            let runs: Vec<_> = (0..n_runs).map(run).collect();
            let together = readings_of_each(&runs, &schedule, 1400);
            assert_eq!(together.len(), n_runs);
            for (column, (parameters, release)) in together.iter().zip(&runs) {
                let alone = readings(parameters, *release, &schedule, 1400);
                let apart = column.iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(column.len() == 1400 && apart < 1e-12, "{n_runs}: {apart:e}");
            }
        }
        let mut unlike = [run(0), run(1)];
        unlike[1].0.remove(1);
        let together = readings_of_each(&unlike, &schedule, 1400);
        assert!(together[1] != together[0] && together[1] == readings(&unlike[1].0, unlike[1].1, &schedule, 1400));
    }

    #[test]
    fn rates_between_long_steps_are_those_of_short_ones() {
        let rates = |interval_s: f64, n: u32| {
            let times_s: Vec<f64> = (0..n).map(|i| f64::from(i) * 1e-3).collect();
            let schedule = Schedule::new(&times_s.as_slice().into(), interval_s).reading(Measured::Rate);
            readings(&Parameters::paper(), RELEASE, &schedule, times_s.len())
        };
        let (fine, coarse) = (rates(1e-3, 10_001), rates(1e-2, 10_001));
        let off: Vec<f64> = coarse.iter().zip(&fine).map(|(a, b)| (a - b).abs()).collect();
        let worst = off.iter().copied().fold(0.0, f64::max);
        let usual = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt();
        // The cubic's slope is h³·ω⁗/125 = 2e-5 rad/s off; more only where dry friction turns within a step and the
        // acceleration jumps by 2·Mc/J = 0.22 rad/s²: up to 0.15·h of that. A straight line would be 4e-3 off.
        assert!(fine.iter().any(|rate| rate.abs() > 5.0), "it swings");
        assert!(usual < 4e-5 && worst < 3.3e-4, "usually {usual:e}, at worst {worst:e} rad/s");
    }

    #[test]
    fn uneven_times_are_met_exactly() {
        let times_s = [0.0, 0.0004, 0.0033, 0.0051, 0.2, 0.2005, 1.0];
        let even: Vec<f64> = (0..10_001).map(|i| f64::from(i) * 1e-4).collect();
        let reference = swing(&even);
        for (time_s, reading) in times_s.iter().zip(swing(&times_s)) {
            let expected = reference[(time_s * 1e4).round() as usize];
            assert!((reading - expected).abs() < 1e-7, "{time_s}: {reading} {expected}");
        }
    }
}
