//! The control charts of a study keep the rate of false alarms that they state, and find wear soon.
//!
//! Values are drawn at random, as a rig would give them: no fit takes part.

use host::study::chart::{Chart, FALSE_ALARMS, Kind, Limits, chart};
use host::study::rig::CHARTED;
use tests::chance::Chance;
use tests::rates::fewest_hits;

const MEAN: f64 = 7e-4;
const VARIES_BY: f64 = 0.005;

/// A drift by 2 % over 40 swings.
const DRIFT: f64 = 0.02 / 40.0;

/// Swings before the bearing begins to wear.
const N_BEFORE: usize = 100;

/// The chart of one quantity of a rig, in a row of swings.
fn of(seed: u64, n: usize, drifts: impl Fn(usize) -> f64) -> Chart {
    at_rate(CHARTED[0].false_alarms, seed, n, drifts)
}

fn at_rate(false_alarms: f64, seed: u64, n: usize, drifts: impl Fn(usize) -> f64) -> Chart {
    let mut chance = Chance::new(seed);
    let value = |idx: usize| MEAN * (1.0 + VARIES_BY * chance.normal() + drifts(idx));
    chart(&(0..n).map(value).collect::<Vec<f64>>(), Limits::of(false_alarms))
}

/// All charts of a rig together, in 200,000 swings of rigs of all ages: so many alarms are Poisson's, about.
#[test]
fn at_most_one_false_alarm_in_a_thousand_swings() {
    for n_swings in [50, 400, 5000] {
        let n_rigs = 200_000 / n_swings;
        let n_alarms: usize = (0..n_rigs)
            .flat_map(|rig| CHARTED.iter().zip(2 * rig..).map(|(charted, seed)| (charted.false_alarms, seed as u64)))
            .map(|(rate, seed)| at_rate(rate, seed ^ ((n_swings as u64) << 32), n_swings, |_| 0.0).alarms.len())
            .sum();
        let rate = n_alarms as f64 / (n_rigs * n_swings) as f64;
        println!("{n_swings} swings a rig: {:.2} false alarms in 1,000 swings", 1e3 * rate);
        assert!(rate <= FALSE_ALARMS, "{n_swings} swings a rig: {rate}");
        // Limits that never alarm would be no limits.
        assert!(n_swings < 400 || rate > 0.2 * FALSE_ALARMS, "{n_swings} swings a rig: {rate}");
    }
}

/// After how many swings of the drift it is found, by rigs that were quiet until then.
fn delays(n_rigs: u64) -> Vec<usize> {
    let delay = |seed: u64| {
        let drifting = of(seed, N_BEFORE + 60, |idx| DRIFT * (idx + 1).saturating_sub(N_BEFORE) as f64);
        let rise = drifting.alarms.iter().find(|alarm| alarm.kind != Kind::Single && alarm.at >= N_BEFORE);
        rise.map_or(60, |rise| rise.at + 1 - N_BEFORE)
    };
    let mut delays: Vec<usize> = (0..n_rigs).map(|rig| delay(1_000_000 + rig)).collect();
    delays.sort_unstable();
    delays
}

/// 2 % over 40 swings is a tenth of the spread a swing: at the 15th all of them together are 3.5 spreads off, hardly
/// more than one false alarm in a thousand allows. So half of the rigs are found by then, and nearly all soon after.
#[test]
fn a_bearing_that_wears_is_found_within_fifteen_swings() {
    let delays = delays(2000);
    let mean = delays.iter().sum::<usize>() as f64 / delays.len() as f64;
    let within = |n: usize| delays.iter().filter(|delay| **delay <= n).count();
    println!("mean {mean:.1}, median {}; within 15: {}, 20: {}", delays[1000], within(15), within(20));
    assert!(mean <= 15.0 && delays[1000] <= 15, "mean {mean}, median {}", delays[1000]);
    assert!(within(15) >= fewest_hits(2000, 0.55), "{}", within(15));
    assert!(within(22) >= fewest_hits(2000, 0.95), "{}", within(22));
}

/// The swing from which on it is said to wear is about the one at which it began.
#[test]
fn a_change_is_dated_and_measured() {
    let n_right = (0..500)
        .filter(|seed| {
            let stepped = of(2_000_000 + seed, 120, |idx| if idx < 80 { 0.0 } else { 0.02 });
            let Some(rise) = stepped.alarms.iter().find(|alarm| alarm.kind == Kind::Rise) else { return false };
            let Some((share, std)) = rise.change else { return false };
            rise.since.abs_diff(80) <= 1 && (share - 0.02).abs() < 3.0 * std
        })
        .count();
    println!("{n_right} of 500");
    assert!(n_right >= fewest_hits(500, 0.95), "{n_right}");
}

/// A spilt coffee is no wear: one swing that is far off raises one alarm, of its own.
#[test]
fn one_swing_that_is_off_is_named_alone() {
    let n_right = (0..500)
        .filter(|seed| {
            let one = of(3_000_000 + seed, 60, |idx| if idx == 40 { 0.04 } else { 0.0 });
            one.alarms.len() == 1 && one.alarms[0].kind == Kind::Single && one.alarms[0].at == 40
        })
        .count();
    println!("{n_right} of 500");
    assert!(n_right >= fewest_hits(500, 0.9), "{n_right}");
}
