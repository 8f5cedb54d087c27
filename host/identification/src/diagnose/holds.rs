//! Does a claimed effect hold on every part of the swings?
//!
//! A law that is there acts in every window of the swings; what a hand, a slipping hub or a wrong law of another kind
//! left behind is carried by a few. So each claim has to pass the windowed, cluster-robust test of [`shared::score`]: its
//! strength is zero where it is absent, and the other numbers of the model answer freely; it must hold after any two
//! neighbouring windows are left out too, and be larger than its own scatter over the windows. A strength on the end of its
//! range is no measure: the swings ask for more than such a law can be, or for another one. Its strength on single
//! parts (early, late, left, right, each release) shows where it is seen.

use super::strength::{index_in, is_as_strong_as_can_be, stands_for_another, strengths};
use super::verdict::Judge;
use super::widening::in_usual_form;
use crate::fit::clusters::{Cluster, Sums, clusters, spread_of};
use crate::fit::fitted::Fitted;
use crate::fit::problem::Problem;
use crate::fit::refine::{levels, on_all};
use crate::recording::Measured;
use crate::verdict::{CHANCE_STDS, NO_CHANCE_STDS};
use serde::Serialize;
use shared::effect::Effect;
use shared::score::{MIN_SPARE_CLUSTERS, Normal, score, score_of_few};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::iter;

/// Chance that something is claimed that is not there, over all starts that were tested; and that one law holds without
/// some of the windows by chance.
pub const ALPHA: f64 = 0.01;

/// Of what a model explains (root mean square), an effect alone shall explain so much: less may be the shape of another of
/// its laws, which are seldom known to a tenth. Of 34 rigs with a drag or a spring of another shape than any of the list,
/// five were told of a second effect, which explained 0.03 to 0.06; of the pairs of the forty rigs only one effect explains
/// as little, 0.04, and that one pushes to one side. Half of it: by their shares three of the five would be told again; the
/// forty rigs and the real recordings are told alike. Twice: one real recording is told otherwise, with a quarter more left.
const SLIGHT: f64 = 0.1;

/// Columns of the test at most: three added effects of four numbers beside the base and an offset for each of a few swings.
const COLUMNS: usize = 32;

/// How far a claim goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Standing {
    /// It holds, and without any two neighbouring windows too.
    Holds,
    /// It improves the fit, but single parts of the swings carry it.
    Partly,
    /// There are too few windows to say.
    TooShort,
    /// It explains so little of all that is claimed that the shape of another law may do as much.
    Slight,
    /// Its strength, or what makes it that law, lies on the end of its range: the swings ask for more of it than there can be, or
    /// for something else.
    OutOfRange,
    /// Fitted to the end, all its numbers are within their own errors.
    Vague,
}

/// A claim on the parts of the swings.
#[derive(Clone, Debug, Serialize)]
pub struct Holding {
    /// The effect.
    pub effect: &'static str,
    /// What became of the claim.
    pub standing: Standing,
    /// How many windows of a few periods, or releases, the test stands on.
    pub windows: usize,
    /// Root mean square error of the model that has it, rad.
    pub rmse: f64,
    /// The effects of that model that are not claimed either; none beside a claimed effect.
    pub beside: Vec<&'static str>,
    /// Chance that an absent effect looks like this.
    pub p: Option<f64>,
    /// The same without the two neighbouring windows that speak most for it.
    pub p_without_two: Option<f64>,
    /// Its clearest strength over all windows, in its own unit, the other numbers of its law as they are.
    pub value: Option<f64>,
    /// Its standard deviation, from how it scatters over the windows; absent where one of them alone tells it.
    pub std: Option<f64>,
    /// The same on single parts.
    pub parts: Vec<Part>,
}

/// The strength of an effect on a part of the swings.
#[derive(Clone, Debug, Serialize)]
pub struct Part {
    /// `early`, `late`; `left`, `right` of the middle, of rates `backward`, `forward`; or the release's name.
    pub name: String,
    /// Its clearest strength there, in its own unit.
    pub value: f64,
    /// Standard deviation, if the part gives one.
    pub std: Option<f64>,
    /// Is it seen there? Absent where the part can't tell.
    pub seen: Option<bool>,
}

/// A strength with its standard deviation, from which its interval is made, and the jackknife's standard error.
struct Strength {
    value: f64,
    std: Option<f64>,
    error: Option<f64>,
}

/// The columns of one effect's test.
struct Test {
    /// Places of the other columns, then those of the strengths.
    columns: Vec<usize>,
    /// The fitted strengths.
    strengths: Vec<f64>,
}

/// All claims of a fitted model, tested; `n_starts` were tried to find it.
pub fn holdings(on: &Problem, model: &Fitted, n_starts: usize) -> Vec<Holding> {
    let linear = model.linearised(on);
    let level = ALPHA / n_starts.max(1) as f64;
    let of_effect = |effect: &&'static Effect<f64>| {
        let strong = strengths(effect);
        let matters = |j: usize| index_in(model, effect, j).is_some_and(|index| strong.contains(&index));
        holding(on, model, effect, &clusters(on, &linear, &model.starts, matters), level)
    };
    model.effects.iter().map(of_effect).collect()
}

fn holding(on: &Problem, model: &Fitted, effect: &'static Effect<f64>, clusters: &[Cluster], level: f64) -> Holding {
    let found = tested(on, model, effect.name, clusters, &Test::of(model, effect, clusters), level);
    if is_as_strong_as_can_be(model, effect) || stands_for_another(model, effect) {
        Holding { standing: Standing::OutOfRange, ..found }
    } else {
        found
    }
}

/// The test of what stands in some columns of a model.
pub(super) fn tested_columns(
    on: &Problem,
    model: &Fitted,
    name: &'static str,
    clusters: &[Cluster],
    is_tested: impl Fn(usize) -> bool,
) -> Holding {
    let size = clusters.first().map_or(0, |cluster| cluster.sides[0].gradient.len());
    let (own, mut columns): (Vec<usize>, Vec<usize>) = (0..size).partition(|j| is_tested(*j));
    columns.extend(own.clone());
    tested(on, model, name, clusters, &Test::new(model, columns, own), ALPHA)
}

fn tested(on: &Problem, model: &Fitted, name: &'static str, clusters: &[Cluster], test: &Test, level: f64) -> Holding {
    let sums: Vec<Sums> = clusters.iter().map(Cluster::sums).collect();
    let normals: Vec<Normal<f64, COLUMNS>> = sums.iter().map(|sums| test.normal(sums)).collect();
    let (n_tested, n_windows) = (test.strengths.len(), clusters.len());
    let p = score(normals.iter(), 0, n_tested).map(|found| probability(found.f, found.n_tested, found.n_clusters));
    let without = |k: usize| {
        let rest = normals.iter().enumerate().filter(move |(i, _)| *i != k && *i != k + 1).map(|(_, normal)| normal);
        score_of_few(rest, 0, n_tested).map_or(1.0, |found| probability(found.f, found.n_tested, found.n_clusters))
    };
    let p_without_two = p.map(|_| (0..n_windows - 1).map(without).fold(0.0, f64::max));
    let standing = match p.zip(p_without_two) {
        None if n_windows < n_tested + MIN_SPARE_CLUSTERS => Standing::TooShort,
        Some((p, without_two)) if p < level && without_two < ALPHA => Standing::Holds,
        _ => Standing::Partly,
    };
    let Some((k, whole)) = test.clearest(&sums) else { return Holding::unknown(on, model, name, n_windows) };
    let standing = match standing {
        Standing::Holds if whole.error.is_some_and(|error| whole.value.abs() < error) => Standing::Partly,
        standing => standing,
    };
    let parts = parts(on, test, k, whole.value, clusters);
    let rmse = on.rmse_rad(model.cost);
    let (value, std) = (Some(whole.value), whole.std);
    let beside = others(model, name);
    Holding { effect: name, standing, windows: n_windows, rmse, beside, p, p_without_two, value, std, parts }
}

impl Holding {
    /// Of a single window nothing can be said.
    fn unknown(on: &Problem, model: &Fitted, effect: &'static str, windows: usize) -> Self {
        let (standing, rmse) = (Standing::TooShort, on.rmse_rad(model.cost));
        let (p, p_without_two, value, std) = (None, None, None, None);
        let beside = others(model, effect);
        Self { effect, standing, windows, rmse, beside, p, p_without_two, value, std, parts: Vec::new() }
    }

    /// Where it stands beside claimed effects alone, these are the claim and need no word.
    pub(super) fn beside_claimed(mut self, claimed: &Fitted) -> Self {
        self.beside.retain(|name| !claimed.has(name));
        self
    }

    /// Is it a claim of this model, which has nothing beside it but what it names and what is claimed?
    pub(super) fn is_of(&self, model: &Fitted, claimed: &Fitted) -> bool {
        let is_known = |name: &&str| *name == self.effect || self.beside.contains(name) || claimed.has(name);
        model.has(self.effect) && self.beside.iter().all(|name| model.has(name)) && model.names().iter().all(is_known)
    }
}

/// What was added to a model but for this.
fn others(model: &Fitted, name: &str) -> Vec<&'static str> {
    model.names().into_iter().filter(|other| *other != name).collect()
}

/// Chance that F(q, K − q) is larger.
fn probability(f: f64, n_tested: usize, n_clusters: usize) -> f64 {
    FisherSnedecor::new(n_tested as f64, (n_clusters - n_tested) as f64).map_or(1.0, |distribution| distribution.sf(f))
}

impl Test {
    fn of(model: &Fitted, effect: &Effect<f64>, clusters: &[Cluster]) -> Self {
        let size = clusters.first().map_or(0, |cluster| cluster.sides[0].gradient.len());
        let of_effect = |j: &usize| index_in(model, effect, *j);
        let strong = strengths(effect);
        let mut columns: Vec<usize> = (0..size).filter(|j| of_effect(j).is_none()).collect();
        let own = (0..size).filter(|j| of_effect(j).is_some_and(|index| strong.contains(&index)));
        let own: Vec<usize> = own.collect();
        columns.extend(own.clone());
        Self::new(model, columns, own)
    }

    /// Of all columns, the tested ones last.
    fn new(model: &Fitted, mut columns: Vec<usize>, own: Vec<usize>) -> Self {
        // A model with more numbers than the test has room for is tested with the last of them free.
        columns.drain(..columns.len().saturating_sub(COLUMNS));
        let strengths = own.into_iter().map(|j| model.unknowns[j].get(&model.parameters)).collect();
        Self { columns, strengths }
    }

    /// The normal equations of a cluster where the effect is absent, the strengths last.
    fn normal(&self, sums: &Sums) -> Normal<f64, COLUMNS> {
        let mut normal = Normal::default();
        let first = COLUMNS - self.columns.len();
        for (i, row) in self.columns.iter().enumerate() {
            normal.gradient[first + i] = sums.gradient[*row];
            for (j, column) in self.columns.iter().enumerate() {
                normal.matrix[first + i][first + j] = sums.matrix[(*row, *column)];
            }
        }
        for (k, strength) in self.strengths.iter().enumerate() {
            let column = COLUMNS - self.strengths.len() + k;
            (0..COLUMNS).for_each(|i| normal.gradient[i] += normal.matrix[i][column] * strength);
        }
        normal
    }

    /// The strength that is clearest.
    fn clearest(&self, sums: &[Sums]) -> Option<(usize, Strength)> {
        let size = |found: &Strength| found.std.map_or(0.0, |std| found.value.abs() / std);
        self.found(sums)?.into_iter().enumerate().max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)))
    }

    /// The strengths as some samples have them.
    fn found(&self, sums: &[Sums]) -> Option<Vec<Strength>> {
        let chosen = |sums: &Sums| Sums {
            matrix: sums.matrix.select_rows(&self.columns).select_columns(&self.columns),
            gradient: sums.gradient.select_rows(&self.columns),
        };
        let spread = spread_of(&sums.iter().map(chosen).collect::<Vec<_>>())?;
        let first = self.columns.len() - self.strengths.len();
        let strength = |(k, fitted): (usize, &f64)| Strength {
            value: fitted + spread.step[first + k],
            std: spread.stds[first + k],
            error: spread.errors[first + k],
        };
        Some(self.strengths.iter().enumerate().map(strength).collect())
    }
}

/// Where one of its strengths is seen, which is `whole` altogether.
fn parts(on: &Problem, test: &Test, k: usize, whole: f64, clusters: &[Cluster]) -> Vec<Part> {
    let all: Vec<Sums> = clusters.iter().map(Cluster::sums).collect();
    let side = |side: usize| clusters.iter().map(|cluster| cluster.sides[side].clone()).collect::<Vec<Sums>>();
    let (early, late) = all.split_at(all.len() / 2);
    let mut parts: Vec<(String, Vec<Sums>)> = Vec::new();
    if on.swings.len() == 1 {
        parts.push(("early".to_owned(), early.to_vec()));
        parts.push(("late".to_owned(), late.to_vec()));
    }
    let is_angle = on.swings.iter().all(|swing| swing.measured == Measured::Angle);
    let [below, above] = if is_angle { ["left", "right"] } else { ["backward", "forward"] };
    parts.push((below.to_owned(), side(0)));
    parts.push((above.to_owned(), side(1)));
    for (swing_idx, swing) in on.swings.iter().enumerate().filter(|_| on.swings.len() > 1) {
        let own = clusters.iter().filter(|cluster| cluster.swing_idx == swing_idx).map(Cluster::sums).collect();
        parts.push((swing.name.clone(), own));
    }
    let part = |(name, sums): (String, Vec<Sums>)| {
        let Strength { value, std, .. } = test.found(&sums)?.swap_remove(k);
        Some(Part { name, value, std, seen: seen(whole, value, std) })
    };
    parts.into_iter().filter_map(part).collect()
}

/// A strength beyond chance along the whole one is seen; one against it, and surely another, is not.
fn seen(whole: f64, value: f64, std: Option<f64>) -> Option<bool> {
    let std = std?;
    let (along, apart) = (value * whole.signum(), (value - whole).abs());
    if along > CHANCE_STDS * std { Some(true) } else { (along < 0.0 && apart > NO_CHANCE_STDS * std).then_some(false) }
}

impl Judge<'_, '_> {
    /// The claimed model without effects that do not hold on every part, the least sure first; the claims that were dropped,
    /// and those that stand.
    pub(super) fn holding(&self, claimed: Fitted) -> (Fitted, Vec<Holding>, Vec<Holding>) {
        let (mut claimed, mut dropped) = (claimed, Vec::<Holding>::new());
        loop {
            let found = self.holdings(&claimed);
            let Some((worst, rest)) = self.least_sure(&claimed, &found) else {
                dropped.retain(|holding| !claimed.has(holding.effect));
                return (claimed, dropped, found);
            };
            dropped.retain(|holding| holding.effect != worst.effect);
            dropped.push(worst);
            claimed = rest;
        }
    }

    /// The claim that is to go first, and the model without it.
    fn least_sure(&self, claimed: &Fitted, found: &[Holding]) -> Option<(Holding, Fitted)> {
        let doubtful = found.iter().filter(|holding| holding.standing != Standing::Holds);
        let p = |holding: &Holding| holding.p.unwrap_or(1.0);
        match doubtful.max_by(|a, b| p(a).total_cmp(&p(b))) {
            Some(worst) => Some((worst.clone(), self.without_doubtful(claimed, worst.effect))),
            None => self.slight(claimed, found),
        }
    }

    /// The claim that explains least, if that is too little beside what all explain; and the model without it.
    pub(super) fn slight(&self, claimed: &Fitted, found: &[Holding]) -> Option<(Holding, Fitted)> {
        if found.len() < 2 {
            return None;
        }
        let rest = |effect: &&'static Effect<f64>| self.without_on_all(claimed, effect.id);
        let rests: Vec<Fitted> = claimed.effects.iter().map(rest).collect();
        // What pushes to one side is no matter of the shape of laws that act alike to both.
        let may_be_a_shape = |effect: &str| Effect::<f64>::by_name(effect).is_some_and(|it| !it.rules.resembles_offset);
        let all = found.iter().zip(rests).filter(|(holding, _)| may_be_a_shape(holding.effect));
        let (holding, rest) = all.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))?;
        let explained = |before: &Fitted| before.cost - claimed.cost;
        let slight = Holding { standing: Standing::Slight, ..holding.clone() };
        (explained(&rest) < SLIGHT.powi(2) * explained(&self.found.base)).then_some((slight, rest))
    }

    /// How far each claim of a model goes, of all that were tried.
    pub(super) fn holdings(&self, model: &Fitted) -> Vec<Holding> {
        let tried = self.candidates.iter().flat_map(|effect| iter::once(*effect).chain(effect.wider_form()));
        holdings(self.problem, model, tried.map(|effect| effect.starts.len()).sum())
    }

    /// The model without a claim that does not hold: with its law in the usual form, if it was a wider one, whose further
    /// numbers may be too many for so few windows; else the better model with one effect less, the rest of the claimed one
    /// or what the search preferred.
    pub(super) fn without_doubtful(&self, claimed: &Fitted, name: &str) -> Fitted {
        let Some(doubtful) = claimed.effects.iter().find(|effect| effect.name == name) else { return claimed.clone() };
        let rest = self.with_one_less(claimed, doubtful);
        let usual =
            in_usual_form(self.rough, claimed, doubtful).map(|usual| on_all(self.problem, &levels(self.rough, &usual)));
        usual.filter(|usual| self.is_worth_it(&rest, usual)).unwrap_or(rest)
    }

    fn with_one_less(&self, claimed: &Fitted, doubtful: &Effect<f64>) -> Fitted {
        let n_left = claimed.effects.len() - 1;
        if n_left == 0 {
            return self.found.base.clone();
        }
        let rest = self.without_on_all(claimed, doubtful.id);
        match self.found.levels.get(n_left - 1) {
            Some(level) => rest.better(self.preferred(level).clone()),
            None => rest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::rig;
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::start;
    use crate::fit::tally::Tally;
    use crate::swing::Swing;
    use nalgebra::{DMatrix, DVector};

    /// Windows that measure one nuisance and two strengths directly.
    fn clusters_of(values: impl Fn(usize) -> [f64; 3], n_windows: usize) -> Vec<Cluster> {
        let window = |k: usize| {
            let half =
                Sums { matrix: DMatrix::identity(3, 3) * 0.5, gradient: 0.5 * DVector::from_row_slice(&values(k)) };
            Cluster { swing_idx: 0, windows: Vec::new(), sides: [half.clone(), half] }
        };
        (0..n_windows).map(window).collect()
    }

    #[test]
    fn each_strength_moves_by_its_own_step() {
        let test = Test { columns: vec![0, 1, 2], strengths: vec![10.0, 20.0] };
        let around = |k: usize| if k.is_multiple_of(2) { 0.1 } else { -0.1 };
        let clusters = clusters_of(|k| [5.0 + 4.0 * around(k), 1.0 + around(k), 2.0 - 2.0 * around(k)], 12);
        let found = test.found(&clusters.iter().map(Cluster::sums).collect::<Vec<_>>()).unwrap();
        for (strength, (value, deviation)) in found.iter().zip([(11.0, 0.1), (22.0, 0.2)]) {
            assert!((strength.value - value).abs() < 1e-9);
            // The standard error of the mean of twelve, and Student's t of 11 degrees of freedom.
            let error = deviation / 11f64.sqrt();
            assert!((strength.error.unwrap() / error - 1.0).abs() < 1e-9);
            assert!((strength.std.unwrap() / (2.201 / 1.96 * error) - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn few_windows_are_too_short_and_the_early_ones_are_half_of_them() {
        let count = Tally::default();
        let times_s: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.01).collect();
        let swings = [Swing::new("one", &times_s, &times_s.iter().map(|t| (6.0 * t).cos()).collect::<Vec<_>>(), 1e-4)];
        let problem = problem_of(&swings, &rig(), &count);
        let model = Fitted::at(&problem, &Point { values: problem.template_values(), starts: start::starts(&swings) });
        let test = Test { columns: vec![0, 1, 2], strengths: vec![0.0] };
        let scatter = |k: usize| 0.05 * ((7 * k) % 5) as f64;
        let strength = |k: usize| if k < 6 { 1.0 } else { 3.0 } + scatter(k);
        let of = |n_windows: usize| {
            let clusters = clusters_of(|k| [scatter(k), -scatter(k + 1), strength(k)], n_windows);
            tested(&problem, &model, "drag", &clusters, &test, ALPHA)
        };
        assert_eq!([of(3).standing, of(5).standing], [Standing::TooShort; 2]);
        let long = of(12);
        assert_eq!(long.standing, Standing::Holds);
        let part = |name: &str| long.parts.iter().find(|part| part.name == name).unwrap().value;
        let mean = |range: std::ops::Range<usize>| range.clone().map(strength).sum::<f64>() / range.len() as f64;
        assert!((part("early") - mean(0..6)).abs() < 1e-9 && (part("late") - mean(6..12)).abs() < 1e-9, "{long:?}");
    }

    #[test]
    fn what_two_neighbouring_windows_carry_does_not_hold_without_them() {
        let count = Tally::default();
        let swings = [Swing::new("one", &[0.0, 0.1, 0.2, 0.3], &[0.3, 0.1, -0.1, -0.2], 1e-4)];
        let problem = problem_of(&swings, &rig(), &count);
        let model = Fitted::at(&problem, &Point { values: problem.template_values(), starts: start::starts(&swings) });
        let test = Test { columns: vec![0, 1, 2], strengths: vec![0.0] };
        let around = |k: usize| if k.is_multiple_of(2) { 0.1 } else { -0.1 };
        let strength = |k: usize| around(k) + if [5, 6].contains(&k) { 3.0 } else { 0.0 };
        let clusters = clusters_of(|k| [around(k), -around(k + 1), strength(k)], 14);
        let found = tested(&problem, &model, "drag", &clusters, &test, ALPHA);
        // The other twelve are as often above zero as below.
        assert!(found.p_without_two.unwrap() > 0.9 && found.standing == Standing::Partly, "{found:?}");
    }

    #[test]
    fn a_strength_is_seen_beyond_twice_its_own_error_and_not_seen_against_the_whole() {
        assert_eq!([0.15, 0.25].map(|value| seen(1.0, value, Some(0.1))), [None, Some(true)]);
        assert_eq!([-0.15, -0.25].map(|value| seen(-1.0, value, Some(0.1))), [None, Some(true)]);
        assert_eq!([seen(1.0, -0.2, Some(0.1)), seen(1.0, -0.2, Some(0.5))], [Some(false), None]);
        assert_eq!(seen(1.0, 5.0, None), None);
    }

    #[test]
    fn the_parts_of_angles_are_left_and_right_and_those_of_rates_backward_and_forward() {
        let count = Tally::default();
        let names_and_values = |measured: Measured| {
            let swings = [Swing::of("one", measured, &[0.0, 0.1, 0.2, 0.3], &[0.3, 0.1, -0.1, -0.2], 1e-4)];
            let problem = problem_of(&swings, &rig(), &count);
            let test = Test { columns: vec![0, 1, 2], strengths: vec![0.0] };
            let side = |value: f64| Sums {
                matrix: DMatrix::identity(3, 3),
                gradient: DVector::from_row_slice(&[0.0, 0.0, value]),
            };
            let cluster = || Cluster { swing_idx: 0, windows: Vec::new(), sides: [side(1.0), side(3.0)] };
            let clusters: Vec<Cluster> = (0..12).map(|_| cluster()).collect();
            let parts = parts(&problem, &test, 0, 2.0, &clusters).into_iter().skip(2);
            parts.map(|part| (part.name, part.value.round())).collect::<Vec<_>>()
        };
        let told = |names: [&str; 2]| vec![(names[0].to_owned(), 1.0), (names[1].to_owned(), 3.0)];
        assert_eq!(names_and_values(Measured::Angle), told(["left", "right"]));
        assert_eq!(names_and_values(Measured::Rate), told(["backward", "forward"]));
    }
}
