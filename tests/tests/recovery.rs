//! Known pendulums come back: random rigs from the box of the paper's Table 2, measured by an integrator that shares no
//! code with ours, are identified from one recording each, beginning with its segments.
//!
//! By default the first 24 rigs, half a minute on two cores; `RECOVERY_RIGS=100 cargo test -p tests --test recovery --
//! --include-ignored --nocapture` takes a hundred (about three minutes) and prints a line for each. Of a thousand the
//! surfaces alone bring 973 within 1.5 noises, and least squares after them all within 1.05. `RECOVERY_FROM` is the first seed.

#[path = "../../shared/tests/physics_reference/mod.rs"]
mod physics_reference;

use host::fit::identify::{Fit, Method, Options, fit};
use host::recording::Recording;
use host::recording::segment::SegmentOptions;
use host::swing::Swing;
use physics_reference::Reference;
use shared::parameters::{Parameters, base};
use std::fmt::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use tests::chance::Chance;
use tests::measured::{self, noise_rad};
use tests::paper_data::{drawing, levels};

/// How many rigs, unless the environment says otherwise.
const N_RIGS: u64 = 24;

/// The smallest and largest release, rad; either side.
const RELEASES_RAD: std::ops::Range<f64> = 0.5..2.5;

/// Ends of a 95 % interval in standard deviations.
const INTERVAL_STDS: f64 = 1.96;

/// What the intervals are judged for; Ms and DV have none where the error jumps.
const JUDGED: [&str; 3] = ["Mw", "Mc", "I"];

/// A rig that nobody knows but the test.
struct Rig {
    seed: u64,
    truth: Parameters<f64>,
    start_rad: f64,
    chance: Chance,
}

impl Rig {
    fn random(seed: u64) -> Self {
        let mut chance = Chance::new(seed);
        let drawn: Vec<f64> = levels("1").into_iter().map(|(_, low, high)| chance.within(low..high)).collect();
        let mut truth = drawing();
        truth.set_friction(drawn[0], drawn[1], drawn[2], drawn[3]);
        truth.pendulum.inertia_kg_m2 = drawn[4];
        let side = if chance.coin() { 1.0 } else { -1.0 };
        let start_rad = side * chance.within(RELEASES_RAD);
        Self { seed, truth, start_rad, chance }
    }

    /// One on so light a bearing that it swings on for longer than it is recorded, with a narrow velocity band.
    fn light(seed: u64) -> Self {
        let mut rig = Self::random(seed);
        let pendulum = rig.truth.pendulum;
        let (gravity_nm, pivot) = (pendulum.gravity_torque_nm(), pendulum.pivot_inertia_kg_m2());
        let pace_rad_s = (gravity_nm / pivot).sqrt();
        let mut between = |low: f64, high: f64| rig.chance.within(low.ln()..high.ln()).exp();
        let viscous = 2.0 * between(2e-4, 1e-3) * pace_rad_s * pivot;
        let coulomb_nm = gravity_nm * between(1e-3, 3e-3);
        let (level_nm, velocity_band) = (coulomb_nm * between(1.05, 1.8), between(2e-2, 6e-2));
        rig.truth.set_friction(viscous, coulomb_nm, level_nm, velocity_band);
        rig
    }

    fn swing(&self) -> Result<Swing, String> {
        self.recorded(|chance, advance| measured::recording(self.start_rad, chance, advance))
    }

    /// Its recording, which ends before it rests.
    fn cut_off(&self) -> Result<Swing, String> {
        self.recorded(|chance, advance| measured::cut_off(self.start_rad, chance, CUT_OFF_S, advance))
    }

    fn recorded(
        &self,
        record: impl FnOnce(&mut Chance, &mut dyn FnMut(f64) -> (f64, f64)) -> Recording,
    ) -> Result<Swing, String> {
        let mut pendulum = Reference::release(&self.truth, None, self.start_rad, 0.0);
        let recording = record(&mut self.chance.clone(), &mut |seconds| {
            pendulum.advance(seconds);
            (pendulum.angle_rad, pendulum.velocity_rad_s)
        });
        let swing = Swing::from_recording("random", &recording, &SegmentOptions::default());
        swing.map(|(swing, _)| swing).map_err(|error| error.to_string())
    }

    fn true_value(&self, symbol: &str) -> f64 {
        let value = |id, index: usize| self.truth.values(id).expect("a base effect")[index];
        match symbol {
            "Mw" => value(base::VISCOUS, 0),
            "Mc" => value(base::COULOMB, 0),
            "Ms" => value(base::STICTION, 0),
            "DV" => value(base::STICTION, 1),
            _ => self.truth.pendulum.inertia_kg_m2,
        }
    }
}

/// What became of a rig.
struct Outcome {
    rig: Rig,
    surfaces: Result<Fit, String>,
    polished: Result<Fit, String>,
}

impl Outcome {
    fn of(seed: u64) -> Self {
        let rig = Rig::random(seed);
        let swing = rig.swing();
        let identified = |method| {
            let swing = swing.clone()?;
            let options = Options { method, ranges: Vec::new() };
            fit(&[swing], &[], &drawing(), &options, &|_| {}).map_err(|error| error.to_string())
        };
        Self { surfaces: identified(Method::Rsm), polished: identified(Method::Both), rig }
    }

    /// (true value − stated value) / stated standard deviation, where one is stated.
    fn deviation_stds(&self, symbol: &str) -> Option<f64> {
        let found = self.polished.as_ref().ok()?.identified.iter().find(|found| found.symbol == symbol)?;
        found.std.map(|std| (self.rig.true_value(symbol) - found.value) / std)
    }

    /// Everything about it, on one line.
    fn in_words(&self) -> String {
        let mut words = format!("seed {:3} from {:+.2} rad:", self.rig.seed, self.rig.start_rad);
        for symbol in ["Mw", "Mc", "Ms", "DV", "I"] {
            let _ = write!(words, " {symbol} {:.4e}", self.rig.true_value(symbol));
        }
        for (method, fitted) in [("surfaces", &self.surfaces), ("polished", &self.polished)] {
            let _ = match fitted {
                Ok(fit) => write!(words, " | {method} {:.3} noises", in_noises(fit)),
                Err(error) => write!(words, " | {method}: {error}"),
            };
        }
        for symbol in JUDGED {
            let _ = match self.deviation_stds(symbol) {
                Some(stds) => write!(words, " | {symbol} {stds:+.1} σ"),
                None => write!(words, " | {symbol} without σ"),
            };
        }
        words
    }
}

/// The error in units of the noise that was put in.
fn in_noises(fit: &Fit) -> f64 {
    fit.rmse_rad / noise_rad()
}

/// All rigs, identified once for all tests, on all processors.
fn outcomes() -> &'static [Outcome] {
    static OUTCOMES: OnceLock<Vec<Outcome>> = OnceLock::new();
    OUTCOMES.get_or_init(|| {
        let number = |name: &str, usual| std::env::var(name).map_or(usual, |n| n.parse().expect("a number"));
        let (first, n_rigs) = (number("RECOVERY_FROM", 1), number("RECOVERY_RIGS", N_RIGS));
        let next = AtomicU64::new(first);
        let one_by_one = || {
            let seeds = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
            seeds.take_while(|seed| *seed < first + n_rigs).map(Outcome::of).collect::<Vec<_>>()
        };
        let n_threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let mut all: Vec<Outcome> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..n_threads).map(|_| scope.spawn(one_by_one)).collect();
            threads.into_iter().flat_map(|thread| thread.join().expect("a fit does not panic")).collect()
        });
        all.sort_by_key(|outcome| outcome.rig.seed);
        all.iter().for_each(|outcome| println!("{}", outcome.in_words()));
        all
    })
}

/// Enough rigs come within so many noises, or the others are named.
#[track_caller]
fn check_share(method: &str, most_noises: f64, share: f64, fitted: impl Fn(&Outcome) -> &Result<Fit, String>) {
    let reached = |outcome: &&Outcome| fitted(outcome).as_ref().is_ok_and(|fit| in_noises(fit) <= most_noises);
    let (good, bad): (Vec<_>, Vec<_>) = outcomes().iter().partition(reached);
    println!("{method}: {} of {} within {most_noises} noises", good.len(), outcomes().len());
    let named: Vec<String> = bad.iter().map(|outcome| outcome.in_words()).collect();
    assert!(good.len() as f64 >= share * outcomes().len() as f64, "{method}:\n{}", named.join("\n"));
}

#[test]
fn response_surfaces_alone_come_within_one_and_a_half_noises_in_95_percent_of_rigs() {
    check_share("surfaces", 1.5, 0.95, |outcome| &outcome.surfaces);
}

#[test]
fn least_squares_after_them_comes_within_5_percent_of_the_noise_in_all_rigs() {
    check_share("polished", 1.05, 1.0, |outcome| &outcome.polished);
}

/// First-order answers point to levels at which these stop at another turning point, and least squares alone ended at 1.5
/// to 7 noises there; the level that their rest shows leads to the true one.
#[test]
fn the_rest_shows_which_stiction_stops_a_swing() {
    for seed in [183, 886, 1002, 1148, 1174] {
        let rig = Rig::random(seed);
        let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
        let fit = fit(&[rig.swing().unwrap()], &[], &drawing(), &options, &|_| {}).unwrap();
        assert!(in_noises(&fit) < 1.05, "seed {seed}: {} noises", in_noises(&fit));
        for symbol in ["Ms", "DV"] {
            let found = fit.identified.iter().find(|found| found.symbol == symbol).unwrap();
            let (std, truth) = (found.std.unwrap(), rig.true_value(symbol));
            assert!((found.value - truth).abs() < 4.0 * std, "seed {seed}: {symbol} {} ± {std}, {truth}", found.value);
        }
    }
}

/// Recorded so long, s.
const CUT_OFF_S: f64 = 40.0;

/// How many light rigs, and how many of them may be outside: more than these are once in a thousand times where 5 % are.
const N_LIGHT: u64 = 60;
const OUTSIDE: usize = 9;

/// A swing that is cut off before it rests leaves open whether there is a band, and the inertia makes up for it. With half as
/// many bands tried, and Ms no more than Mc, 14 intervals of I missed the truth.
#[test]
fn intervals_of_swings_that_never_rest_hold_what_an_unknown_band_leaves_open() {
    let mut outside = [0; JUDGED.len()];
    for seed in 1..=N_LIGHT {
        let rig = Rig::light(seed);
        let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
        let fit = fit(&[rig.cut_off().unwrap()], &[], &drawing(), &options, &|_| {}).unwrap();
        assert!(in_noises(&fit) < 1.05, "seed {seed}: {} noises", in_noises(&fit));
        for (symbol, outside) in JUDGED.into_iter().zip(&mut outside) {
            let found = fit.identified.iter().find(|found| found.symbol == symbol).unwrap();
            let stds = (rig.true_value(symbol) - found.value) / found.std.unwrap();
            *outside += usize::from(stds.abs() > INTERVAL_STDS);
            println!("seed {seed}: {symbol} {stds:+.1} σ");
        }
    }
    assert!(outside.iter().all(|outside| *outside <= OUTSIDE), "{JUDGED:?}: {outside:?} of {N_LIGHT}");
}

/// Of 1,000 rigs the intervals of Mw held the truth in 939, of Mc in 944 and of I in 932: in 461 of the first 500, in 471 of
/// the next. I is known to 6e-6 of it, and steps of 10 ms move it by 0.07 of that.
#[test]
#[ignore = "needs 500 rigs, which take twenty minutes: RECOVERY_RIGS=500"]
fn stated_95_percent_intervals_contain_the_truth_in_90_to_99_percent() {
    for symbol in JUDGED {
        let stated: Vec<f64> = outcomes().iter().filter_map(|outcome| outcome.deviation_stds(symbol)).collect();
        let inside = stated.iter().filter(|stds| stds.abs() <= INTERVAL_STDS).count();
        let percent = 100.0 * inside as f64 / stated.len() as f64;
        println!("{symbol}: {inside} of {} intervals contain the truth, {percent:.0} %", stated.len());
        assert!(stated.len() as f64 >= 0.95 * outcomes().len() as f64, "{symbol}: only {} intervals", stated.len());
        assert!((90.0..=99.0).contains(&percent), "{symbol}: {percent} %");
    }
}
