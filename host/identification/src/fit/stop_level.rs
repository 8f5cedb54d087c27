//! Ms alone: with DV = 0 the error depends on it only through the turning points at which the pendulum stays, so that
//! only the torques between two of them need be tried.

use super::answered::{MAX_ROUNDS, PROFILE_95, answered_costs};
use super::descent::Tolerance;
use super::fitted::{Fitted, Stiction, sort};
use super::linear::{Linear, Steps, linearise};
use super::problem::{Point, Problem};
use super::rounded_stop::rounded_between;
use crate::cores::on_all_cores;
use crate::swing::{Swing, Window};
use shared::parameters::base;

/// At most this many turning points before the stop of each swing are considered, and as many ranges judged at once.
const MAX_STOPS: usize = 10;

/// First-order answers can't tell neighbouring levels apart: so many are tried in earnest beside the best.
const NEIGHBOURS: usize = 2;

/// Levels whose costs on decimated swings are closer than this, in noise variances, are decided on all samples.
const DOUBT: f64 = 40.0;

/// So near to an end of its range a level is on its edge, as a share of the range. Half and twice were not tried.
const EDGE: f64 = 0.01;

/// A range of Ms, N·m: all levels within it stop the pendulum alike.
type Range = (f64, f64);

/// A level, N·m, and the range it stands for.
#[derive(Clone, Copy, Debug)]
struct Level {
    level_nm: f64,
    range: Range,
}

impl Level {
    fn in_the_middle(range: Range) -> Self {
        Self { level_nm: 0.5 * (range.0 + range.1), range }
    }

    /// Of a range that is only known to end somewhere: less would hold no release, more might hold another one.
    fn none_of(range: Range) -> Self {
        Self { level_nm: 0.0, range }
    }
}

/// The level that a model has, so that the search never ends with a worse one; without any, the lowest of all ranges, of
/// which swings that come to `rest` show the ends: dry friction alone stops the pendulum there, wherever first-order answers
/// point.
fn own_level(own_nm: f64, ranges: &[Range], rest: bool) -> Level {
    let lowest = ranges.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((own_nm, own_nm));
    if own_nm == 0.0 {
        return if rest { Level::in_the_middle(lowest) } else { Level::none_of(lowest) };
    }
    let range = ranges.iter().copied().find(|range| holds(range, own_nm));
    Level { level_nm: own_nm, range: range.unwrap_or(if own_nm < lowest.0 { lowest } else { (own_nm, own_nm) }) }
}

/// A model with the best level, and the next best if that may be better on all samples. Its own level is one of those
/// that are tried; without a band.
pub(super) fn levels(decimated: &Problem, from: &Fitted) -> Vec<Fitted> {
    let own_nm = from.stiction().level_nm;
    let free = from.with_stiction(Stiction::NONE);
    let (problem, point) = (free.problem(decimated), free.point());
    let mut steps = Steps::new(&problem);
    let linear = linearise(&problem, &point, Window::Whole, &mut steps);
    let rest = decimated.comes_to_rest();
    let own = own_level(own_nm, &ranges(&problem, &point), rest);
    let first = promising(&problem, &point, &linear)
        .first()
        .copied()
        .filter(|first| *first != own.range)
        .map(Level::in_the_middle);
    let first_steps = steps.clone();
    let begin = Fitted { steps: Some(steps), ..free };
    let mut tried = in_earnest(decimated, &begin, [Some(own), first].into_iter().flatten().collect());
    for _ in 1..MAX_ROUNDS {
        tried[0] = tried[0].descended(decimated, Window::Whole, Tolerance::JUDGE);
        if !rest {
            break;
        }
        let model = &tried[0];
        let lowest = model.cost;
        let fresh = |range: &Range| tried.iter().all(|tried| !holds(range, tried.stiction().level_nm));
        let (here, mut steps) = (model.problem(decimated), model.steps.clone().unwrap_or_else(|| first_steps.clone()));
        let linear = linearise(&here, &model.point(), Window::Whole, &mut steps);
        let free = model.with_stiction(Stiction::NONE).problem(decimated);
        let next = promising(&free, &model.point(), &linear).into_iter().filter(fresh).take(NEIGHBOURS);
        let more = in_earnest(decimated, model, next.map(Level::in_the_middle).collect());
        tried.extend(more);
        sort(&mut tried);
        if tried[0].cost >= lowest {
            break;
        }
    }
    let doubt = tried[0].cost + DOUBT * decimated.noise_rad().powi(2);
    tried.truncate(if tried.len() > 1 && tried[1].cost < doubt { 2 } else { 1 });
    tried = on_all_cores(tried, |model| off_the_edge(decimated, model));
    sort(&mut tried);
    tried
}

/// Descends with each of some levels; the lowest cost first.
fn in_earnest(decimated: &Problem, from: &Fitted, levels: Vec<Level>) -> Vec<Fitted> {
    let at_level = |level: Level| {
        let moved = from.with_stiction(Stiction::level(level.level_nm));
        Fitted { level_range_nm: level.range, ..moved }.descended(decimated, Window::Whole, Tolerance::ROUGH)
    };
    let mut tried: Vec<Fitted> = on_all_cores(levels, at_level);
    sort(&mut tried);
    tried
}

/// A descent with a fixed level goes no farther than to where the pendulum would stop at another turn, and stands there as at
/// a wall, with derivatives that jump: with the level in the middle of its range it goes on.
fn off_the_edge(decimated: &Problem, model: Fitted) -> Fitted {
    let free = model.with_stiction(Stiction::NONE);
    let level_nm = model.stiction().level_nm;
    let own = ranges(&free.problem(decimated), &free.point()).into_iter().find(|range| holds(range, level_nm));
    let is_on_edge = |(low, high): &Range| (level_nm - low).min(high - level_nm) < EDGE * (high - low);
    match own.filter(is_on_edge) {
        Some(range) if level_nm > 0.0 => {
            let moved = Fitted { level_range_nm: range, ..free.with_stiction(middle(&range)) };
            let moved = moved.descended(decimated, Window::Whole, Tolerance::JUDGE);
            if moved.cost <= model.cost { moved } else { model }
        }
        _ => model,
    }
}

fn holds(range: &Range, level_nm: f64) -> bool {
    (range.0..=range.1).contains(&level_nm)
}

/// Ranges of Ms, the one that suits a guess best first, judged by first-order answers; DV = 0. Many swings have many
/// turning points: then some far apart are judged first, and ever closer ones beside the best.
fn promising(free: &Problem, point: &Point, linear: &Linear) -> Vec<Range> {
    let ranges = ranges(free, point);
    let mut judged: Vec<(usize, f64)> = Vec::new();
    let (mut from, mut to) = (0, ranges.len());
    while from < to {
        let stride = (to - from).div_ceil(MAX_STOPS);
        let fresh = |i: &usize| judged.iter().all(|(known, _)| known != i);
        let next: Vec<usize> = (from..to).step_by(stride).filter(fresh).collect();
        let tried: Vec<Stiction> = next.iter().map(|i| middle(&ranges[*i])).collect();
        judged.extend(next.into_iter().zip(answered_costs(free, linear, point, &tried)));
        judged.retain(|(_, cost)| cost.is_finite());
        judged.sort_by(|a, b| a.1.total_cmp(&b.1));
        let Some((best, _)) = judged.first().filter(|_| stride > 1) else { break };
        (from, to) = (best.saturating_sub(stride - 1), (best + stride).min(ranges.len()));
    }
    judged.into_iter().map(|(i, _)| ranges[i]).collect()
}

fn middle((low, high): &Range) -> Stiction {
    Stiction::level(0.5 * (low + high))
}

/// All levels that suit a fitted model about as well as its own: ranges beside it that cost less than `allowed` (rad²)
/// more, or than rounding may make of what sets them apart, the other numbers answering to first order. Costs are odds,
/// and so are widths: a narrow range beside a wide one has to be that much better.
pub(super) fn likely(on: &Problem, model: &Fitted, allowed: f64) -> Range {
    let free = model.with_stiction(Stiction::NONE);
    let (problem, point) = (free.problem(on), free.point());
    let own = model.level_range_nm;
    let ranges = ranges(&problem, &point);
    let Some(at) = ranges.iter().position(|range| holds(range, model.stiction().level_nm)) else { return own };
    let (from, to) = (at.saturating_sub(MAX_STOPS), (at + MAX_STOPS + 1).min(ranges.len()));
    let linear = linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point));
    let tried: Vec<Stiction> = ranges[from..to].iter().map(middle).collect();
    let costs = answered_costs(&problem, &linear, &point, &tried);
    let rounded = rounded_between(&problem, &linear, &point, &tried, at - from);
    // A wider range was likelier before any reading.
    let width = |i: usize| ranges[i].1 - ranges[i].0;
    let odds = |i: usize| 2.0 * (width(i) / width(at)).ln().max(0.0);
    let allowed = |i: usize| (PROFILE_95 + odds(i)) * rounded[i - from].max(allowed / PROFILE_95);
    let suits = |i: &usize| costs[*i - from] < costs[at - from] + allowed(*i);
    let low = (from..at).rev().take_while(suits).last().unwrap_or(at);
    let high = (at + 1..to).take_while(suits).last().unwrap_or(at);
    (ranges[low].0.min(own.0), ranges[high].1.max(own.1))
}

/// Ranges of Ms, each of which stops the pendulum at another turning point; DV = 0.
pub(super) fn ranges(problem: &Problem, point: &Point) -> Vec<Range> {
    // Where rates were measured, the turning points are still those of the angle.
    let angles: Vec<Swing> = problem.swings.iter().map(Swing::asking_for_angles).collect();
    let problem = &problem.on(&angles);
    let parameters = problem.parameters(&point.values);
    let coulomb = parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
    let gravity = parameters.pendulum.gravity_torque_nm();
    let moves = |swing_idx: usize| !problem.swings[swing_idx].comes_to_rest();
    let torques_of = |swing_idx: usize| {
        let guess = (point.values.as_slice(), point.starts[swing_idx]);
        let column = &problem.predict(swing_idx, problem.swings[swing_idx].len(), &[guess])[0];
        let all = last_turning_torques(column, gravity);
        // Where a swing that still moves ends, it does not turn.
        if moves(swing_idx) { all[1..].to_vec() } else { all }
    };
    let of_swings: Vec<Vec<f64>> = on_all_cores(0..problem.swings.len(), torques_of);
    // And it was held at none of its turning points.
    let passed = (0..of_swings.len()).filter(|swing_idx| moves(*swing_idx)).flat_map(|idx| of_swings[idx].first());
    let limit = passed.fold(f64::INFINITY, |least, torque| torque.min(least));
    let mut torques = of_swings.concat();
    torques.retain(|torque| *torque > coulomb && *torque <= limit);
    torques.sort_by(f64::total_cmp);
    torques.dedup_by(|later, earlier| *later - *earlier < 1e-3 * *earlier);
    torques.insert(0, 0.0_f64.max(coulomb));
    torques.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// |m·g·l·sin θ| at the end and the last turning points of a simulated swing, the last first.
fn last_turning_torques(angles_rad: &[f64], gravity_nm: f64) -> Vec<f64> {
    let turns = |triple: &[f64]| (triple[1] - triple[0]) * (triple[2] - triple[1]) < 0.0;
    // A sensor with backlash stays where it is for a while.
    let mut moving = angles_rad.to_vec();
    moving.dedup();
    let turning = moving.windows(3).filter(|triple| turns(triple)).map(|triple| triple[1]);
    let all: Vec<f64> = turning.chain(angles_rad.last().copied()).collect();
    all.iter().rev().take(MAX_STOPS).map(|angle| (gravity_nm * angle.sin()).abs()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;
    use crate::fit::tests::{PENDULUM, at_rest, dry_swing};
    use shared::parameters::Parameters;

    #[test]
    fn no_level_is_promising_where_dry_friction_is_larger_than_all_turning_torques() {
        let (swings, count) = (dry_swing(1.3e-4, 1.1e-3), Tally::default());
        let mut rig = Parameters::frictionless(PENDULUM);
        rig.set_friction(0.0, 1.3e-4, 0.0, 0.0);
        let problem = problem_of(&swings, &rig, &count);
        let mut point = Point { values: problem.template_values(), starts: at_rest(0.02) };
        let linear = linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point));
        assert!(!promising(&problem, &point, &linear).is_empty());
        point.values[1] = PENDULUM.gravity_torque_nm();
        assert!(promising(&problem, &point, &linear).is_empty());
    }

    #[test]
    fn a_level_on_the_edge_of_its_range_goes_to_the_middle_and_lets_the_descent_go_on() {
        let (swings, count) = (dry_swing(1.3e-4, 1.1e-3), Tally::default());
        let mut rig = Parameters::frictionless(PENDULUM);
        rig.set_friction(0.0, 1.3e-4, 0.0, 0.0);
        let problem = problem_of(&swings, &rig, &count);
        let point = Point { values: problem.template_values(), starts: at_rest(0.02) };
        let own = levels(&problem, &Fitted::at(&problem, &point)).swap_remove(0);
        let free = own.with_stiction(Stiction::NONE);
        let now = ranges(&free.problem(&problem), &free.point());
        let (low, high) = now.into_iter().find(|range| holds(range, own.stiction().level_nm)).unwrap();
        let inside =
            |model: &Fitted| (model.stiction().level_nm - low).min(high - model.stiction().level_nm) / (high - low);
        for level_nm in [high - 1e-6 * (high - low), low + 1e-6 * (high - low)] {
            let on_edge = own.with_stiction(Stiction::level(level_nm)).evaluated(&problem);
            let off = off_the_edge(&problem, on_edge.clone());
            assert!(off.cost <= on_edge.cost && inside(&off) > 0.4, "{} {} {}", off.cost, on_edge.cost, inside(&off));
        }
        let in_the_middle = own.with_stiction(Stiction::level(0.5 * (low + high))).evaluated(&problem);
        assert_eq!(off_the_edge(&problem, in_the_middle.clone()).point().values, in_the_middle.point().values);
    }
}
