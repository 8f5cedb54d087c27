//! What may be said after a look: which effect is missing, how sure, how large, and what else it may be; or why nothing
//! can be said.
//!
//! The model is put right first ([`super::refit`]). Then every candidate is judged, and the one that gains most is
//! named if a gain like its own is rarer by chance than the error that the look may spend, over all effects it was
//! picked from. One window alone names nothing, because F asks all clusters.

pub use crate::reason::Reason;

use super::chance::upper_tail;
use super::clusters::Clusters;
use super::column::{Candidate, Columns, MAX_JUDGED, N_BASE, N_STARTS, Strengths};
use super::judge::{Evidence, Sizes};
use super::refit::{Bench, Refitted, Releases};
use super::window::Readings;
use crate::effect::{Effect, MAX_VALUES};
use crate::parameters::{Parameters, base};
use crate::real::Real;
use heapless::Vec;

/// How many suspects are told.
pub const MAX_SUSPECTS: usize = MAX_JUDGED;

/// Fewer clusters say nothing.
pub const MIN_CLUSTERS: usize = 8;

/// An effect that lowers the squares by less than this share of the noise's is none worth a name.
const LEAST_GAIN: f64 = 0.01;

/// Nor is one that lowers them by less than so many times the noise's square.
const LEAST_CHI_SQUARE: f64 = 50.0;

/// What a law with more numbers gains by having them: this share of it for each …
const SHARE_A_NUMBER: f64 = 0.01;

/// Two laws whose gains differ by less than this share, or by so many squares of the noise, can't be told apart; and
/// what neither explains may be wrongly counted for one of them by this share.
const TIE_SHARE: f64 = 0.05;
const TIE_CHI_SQUARE: f64 = 10.0;
const TIE_OF_REST: f64 = 0.1;

/// Nor can two of which not all parts of the swings prefer the same one: the mean of the differences is below so many
/// of its standard deviations.
const TIE_SPREAD: f64 = 1.0;

/// From this share of the noise's squares on, more than noise is there.
pub(super) const EXCESS: f64 = 0.1;

/// An effect that may be missing.
#[derive(Clone, Debug)]
pub struct Suspect<R: 'static> {
    /// The effect.
    pub effect: &'static Effect<R>,
    /// Its values at the size found, the shape that of its start.
    pub values: [R; MAX_VALUES],
    /// Which of them were found …
    pub strengths: Strengths,
    /// … and how it was judged.
    pub evidence: Evidence<R>,
    /// By how much it lowers the squares, in squares of the noise.
    pub chi_square: R,
    /// How likely F is so large by chance.
    pub p: R,
    /// By what the suspects are ordered.
    rank: R,
    /// Can't be told from the first one.
    pub is_tied: bool,
}

/// What a look found.
pub struct Findings<R: 'static> {
    /// The best suspects, the likeliest first.
    pub suspects: Vec<Suspect<R>, MAX_SUSPECTS>,
    /// Why none is named; `None` if the first one is.
    pub reason: Option<Reason>,
    /// How many windows there were, in how many clusters.
    pub n_windows: usize,
    /// K.
    pub n_clusters: usize,
    /// Noise of the readings, rad.
    pub noise_rad: R,
    /// What is left beyond the noise, as a share of the noise's squares: by the model as given, and put right.
    pub excess: [R; 2],
    /// The same with the first suspect in the model, where it is named.
    pub left: Option<R>,
}

impl<R: Copy> Findings<R> {
    /// Before there were any swings, given zero.
    pub const fn empty(zero: R) -> Self {
        Self {
            suspects: Vec::new(),
            reason: Some(Reason::TooFewSwings),
            n_windows: 0,
            n_clusters: 0,
            noise_rad: zero,
            excess: [zero; 2],
            left: None,
        }
    }
}

impl<R: Real<Mask = bool>> Findings<R> {
    fn begin(&mut self, noise_rad: R) {
        self.suspects.clear();
        (self.reason, self.left) = (Some(Reason::TooFewSwings), None);
        (self.n_windows, self.n_clusters) = (0, 0);
        (self.noise_rad, self.excess) = (noise_rad, [R::zero(); 2]);
    }

    /// What is named: the first suspect and those that can't be told from it.
    pub fn named(&self) -> impl Iterator<Item = &Suspect<R>> {
        let is_named = self.reason.is_none();
        self.suspects
            .iter()
            .enumerate()
            .filter(move |(i, suspect)| is_named && (*i == 0 || suspect.is_tied))
            .map(|s| s.1)
    }
}

/// The memory of a look, far too large for a board's stack; and what it found.
pub struct Room<R: 'static> {
    /// What was found.
    pub findings: Findings<R>,
    pub(super) model: Refitted<R>,
    pub(super) larger: Refitted<R>,
    pub(super) bench: Bench<R>,
    pub(super) clusters: Clusters<R>,
}

impl<R: Copy> Room<R> {
    /// Empty, given zero.
    pub const fn empty(zero: R) -> Self {
        Self {
            findings: Findings::empty(zero),
            model: Refitted::empty(zero),
            larger: Refitted::empty(zero),
            bench: Bench::empty(zero),
            clusters: Clusters::empty(),
        }
    }
}

/// Looks at releases with a model, and spends at most this error on naming something that is not there.
pub fn look<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    parameters: &Parameters<R>,
    on: &Releases<R, D>,
    error: R,
) -> Findings<R> {
    let mut room = Room::empty(R::zero());
    room.look(parameters, on, error);
    room.findings
}

impl<R: Real<Mask = bool>> Room<R> {
    /// The same in this room. What is done one after the other is called one by one, so that a board's stack never holds
    /// two such steps.
    pub fn look<D: Readings<R> + ?Sized>(&mut self, parameters: &Parameters<R>, on: &Releases<R, D>, error: R) {
        self.findings.begin(on.noise_rad);
        self.model.begin(parameters);
        if on.readings.is_empty() || self.model.n_windows(on, 1) == 0 {
            return;
        }
        let as_given = self.square_as_given(on);
        let is_near = self.model.is_near(&mut self.bench);
        self.model.take_band_out();
        if !self.model.settle(on, is_near, &mut self.bench) {
            self.findings.reason = Some(Reason::NotThisPendulum);
            return;
        }
        self.judge(as_given, on, error);
        if self.findings.reason == Some(Reason::FrictionAboutRest) {
            self.larger.copy(&self.model);
            if self.larger.settle_band(on, &mut self.bench) {
                self.model.copy(&self.larger);
                self.judge(as_given, on, error);
            }
        }
    }

    /// Judges all candidates beside a model that was put right.
    fn judge<D: Readings<R> + ?Sized>(&mut self, as_given: R, on: &Releases<R, D>, error: R) {
        self.findings.begin(on.noise_rad);
        let Some(free) = self.suspect_all(as_given, on, error) else { return };
        if self.findings.reason.is_none() {
            self.contest(on, free);
        }
    }

    /// Finds the suspects, and whether one is to be named; gives how many readings more there are than free numbers.
    #[inline(never)]
    fn suspect_all<D: Readings<R> + ?Sized>(&mut self, as_given: R, on: &Releases<R, D>, error: R) -> Option<R> {
        let n_windows = self.sum_up(on)?;
        let n_effects = n_effects(&self.bench.columns);
        self.pick_out();
        self.gather(on);
        let Self { findings, bench, clusters, .. } = self;
        let n = bench.all.n;
        let n_numbers = N_STARTS * n_windows + N_BASE;
        let free = (n - R::of(n_numbers as f64)).max(R::one());
        (findings.n_windows, findings.n_clusters) = (n_windows, clusters.list().len());
        findings.excess = [as_given, bench.known.square].map(|square| excess(square, free, on.noise_rad));
        findings.find_suspects(bench, clusters);
        mark_ties(findings, n);
        findings.reason = reason(findings, n_effects, n, error).or_else(|| one_release_is_too_few(findings, on));
        Some(free)
    }

    /// Follows all windows for the steps that all of them together ask for. Gives how many there are.
    #[inline(never)]
    fn sum_up<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>) -> Option<usize> {
        let Self { model, bench, .. } = self;
        let mut n_windows = 0;
        bench.columns.fill(&model.parameters, model.has_band);
        bench.all.clear();
        model.each_window(on, true, model.n_periods(on), bench, &mut |window, all, _, _| {
            all.add(window);
            n_windows += 1;
        });
        bench.known.solve(&bench.all, bench.columns.known.len()).then_some(n_windows)
    }

    /// Leaves the candidates that promise most, of each effect the best start whose sizes are physical: by what they
    /// gain they are ordered, and all others need not be followed again.
    #[inline(never)]
    fn pick_out(&mut self) {
        let Bench { columns, all, known, .. } = &mut self.bench;
        let mut best: Vec<Promise<R>, MAX_JUDGED> = Vec::new();
        for (place, candidate) in columns.candidates.iter().enumerate() {
            let Some((sizes, gain)) = known.promise(all, candidate) else { continue };
            if is_physical(candidate, &sizes) {
                let chi_square = gain / (self.findings.noise_rad * self.findings.noise_rad);
                let rank = rank(chi_square, candidate.strengths.len(), all.n);
                take_in(&mut best, Promise { effect: candidate.effect.id, place, rank });
            }
        }
        let is_kept = |place: usize| best.iter().any(|promise| promise.place == place);
        all.keep(&columns.candidates, &is_kept);
        columns.keep(&is_kept);
    }

    /// Follows all windows again, for what each has of the candidates that are left.
    #[inline(never)]
    fn gather<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>) {
        let Self { model, bench, clusters, .. } = self;
        clusters.clear();
        model.each_window(on, true, model.n_periods(on), bench, &mut |window, all, columns, known| {
            clusters.add(|share| known.share(all, window, &columns.candidates, share));
        });
    }

    /// What the model leaves as it was given, each window begun where it is best and the zero free, rad².
    #[inline(never)]
    fn square_as_given<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>) -> R {
        let Self { model, bench, .. } = self;
        bench.columns.fill(&model.parameters, model.has_band);
        bench.all.clear();
        model.each_window(on, false, model.n_periods(on), bench, &mut |window, all, _, _| all.add(window));
        let all = &bench.all;
        let (weight, score) = (all.known[N_STARTS][N_STARTS], all.known_score[N_STARTS]);
        if R::zero().lt(weight) { all.square - score * score / weight } else { all.square }
    }
}

/// What is left beyond the noise, as a share of its squares.
fn excess<R: Real<Mask = bool>>(square: R, free: R, noise_rad: R) -> R {
    square / (free * noise_rad * noise_rad) - R::one()
}

impl<R: Real<Mask = bool>> Findings<R> {
    /// The candidates that were picked out, the likeliest first.
    #[inline(never)]
    fn find_suspects(&mut self, bench: &Bench<R>, clusters: &Clusters<R>) {
        let Bench { columns, all, known, .. } = bench;
        for (index, candidate) in columns.candidates.iter().enumerate() {
            let Some(evidence) = known.evidence(clusters, all, index, candidate) else { continue };
            let suspect = suspect(candidate, evidence, (clusters.list().len(), all.n), self.noise_rad);
            let place = self.suspects.iter().position(|other| other.rank.lt(suspect.rank));
            let _ = self.suspects.insert(place.unwrap_or(self.suspects.len()), suspect);
        }
    }
}

/// What a candidate promises.
struct Promise<R> {
    effect: u16,
    place: usize,
    rank: R,
}

/// One of each effect, the likeliest first.
#[inline(never)]
fn take_in<R: Real<Mask = bool>>(best: &mut Vec<Promise<R>, MAX_JUDGED>, promise: Promise<R>) {
    if let Some(place) = best.iter().position(|other| other.effect == promise.effect) {
        if !best[place].rank.lt(promise.rank) {
            return;
        }
        best.remove(place);
    }
    let place = best.iter().position(|other| other.rank.lt(promise.rank)).unwrap_or(best.len());
    if best.is_full() && place < best.len() {
        best.pop();
    }
    // One that promises less than all that have a place has none.
    let _ = best.insert(place, promise);
}

/// By what candidates are ordered: the gain, less for each of so many numbers that share in it, on so many readings.
pub(super) fn rank<R: Real<Mask = bool>>(chi_square: R, n_numbers: usize, n: R) -> R {
    let q = R::of(n_numbers as f64);
    chi_square * (R::one() - R::of(SHARE_A_NUMBER) * q) - q * n.ln()
}

/// No strength is below what its parameter allows.
fn is_physical<R: Real<Mask = bool>>(candidate: &Candidate<R>, sizes: &Sizes<R>) -> bool {
    candidate.strengths.iter().zip(sizes).all(|(index, size)| {
        let parameter = &candidate.effect.parameters[usize::from(*index)];
        parameter.low < 0.0 || R::zero().lt(*size)
    })
}

fn suspect<R: Real<Mask = bool>>(
    candidate: &Candidate<R>,
    evidence: Evidence<R>,
    (n_clusters, n): (usize, R),
    noise_rad: R,
) -> Suspect<R> {
    let chi_square = evidence.gain / (noise_rad * noise_rad);
    let mut values = candidate.start();
    candidate.strengths.iter().zip(&evidence.sizes).for_each(|(index, size)| values[usize::from(*index)] = *size);
    Suspect {
        effect: candidate.effect,
        values,
        strengths: candidate.strengths.clone(),
        chi_square,
        p: upper_tail(evidence.f, evidence.n_tested, n_clusters - evidence.n_tested),
        rank: rank(chi_square, evidence.n_tested, n),
        is_tied: false,
        evidence,
    }
}

fn mark_ties<R: Real<Mask = bool>>(findings: &mut Findings<R>, n: R) {
    let Some((first, others)) = findings.suspects.split_first_mut() else { return };
    let rest = (findings.excess[1] * n - first.chi_square).max(R::zero());
    let near = R::of(TIE_CHI_SQUARE).max(R::of(TIE_SHARE) * first.rank + R::of(TIE_OF_REST) * rest);
    for other in others {
        other.is_tied = (first.rank - other.rank).lt(near) || !prefers(&first.evidence, &other.evidence);
    }
}

/// Do all parts of the swings prefer the first to the second?
fn prefers<R: Real<Mask = bool>>(first: &Evidence<R>, second: &Evidence<R>) -> bool {
    let differences = || first.gains.iter().zip(&second.gains).map(|(a, b)| *a - *b);
    let count = R::of(first.gains.len() as f64);
    let sum = differences().fold(R::zero(), |sum, value| sum + value);
    let mean = sum / count;
    let spread = differences().fold(R::zero(), |sum, value| sum + (value - mean) * (value - mean));
    R::of(TIE_SPREAD).lt(sum / (count * spread / (count - R::one())).sqrt())
}

fn reason<R: Real<Mask = bool>>(findings: &Findings<R>, n_effects: usize, n: R, error: R) -> Option<Reason> {
    if findings.n_clusters < MIN_CLUSTERS {
        return Some(Reason::TooFewSwings);
    }
    let least = R::of(LEAST_CHI_SQUARE).max(R::of(LEAST_GAIN) * n);
    let allowed = error / R::of(n_effects as f64);
    match findings.suspects.first() {
        Some(first) if first.p.lt(allowed) && least.lt(first.chi_square) => {
            base::has(first.effect.id).then_some(Reason::FrictionAboutRest)
        }
        _ if R::of(EXCESS).lt(findings.excess[1]) => Some(Reason::Unexplained),
        _ if R::of(EXCESS).lt(findings.excess[0]) => Some(Reason::WrongNumbers),
        _ => Some(Reason::NothingMissing),
    }
}

/// Within one release the amplitude falls as time goes by: a law of time that explains it best can't be told from others.
fn one_release_is_too_few<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    findings: &Findings<R>,
    on: &Releases<R, D>,
) -> Option<Reason> {
    let first = findings.suspects.first()?;
    (on.readings.len() < 2 && first.effect.rules.needs_several_releases).then_some(Reason::TooFewSwings)
}

/// How many effects a name is picked from.
fn n_effects<R: Real<Mask = bool>>(columns: &Columns<R>) -> usize {
    let mut n = 0;
    let mut last = None;
    for candidate in &columns.candidates {
        n += usize::from(last != Some(candidate.effect.id));
        last = Some(candidate.effect.id);
    }
    n.max(1)
}

#[cfg(test)]
mod tests {
    use super::super::column::MAX_KNOWN;
    use super::*;

    /// One that lowers the squares of 10,000 readings by so many, on all of ten clusters alike.
    fn suspect(chi_square: f64) -> Suspect<f64> {
        let (sizes, known_step) = ([0.0; 3], [0.0; MAX_KNOWN]);
        let gains = (0..10).map(|n| chi_square / 10.0 + 1e-3 * f64::from(n % 2)).collect();
        let evidence = Evidence { sizes, stds: sizes, n_tested: 1, known_step, gain: chi_square, gains, f: 1.0 };
        let effect = Effect::by_id(base::COULOMB).unwrap();
        let (values, strengths) = ([0.0; MAX_VALUES], Strengths::new());
        Suspect { effect, values, strengths, evidence, chi_square, p: 0.0, rank: chi_square, is_tied: false }
    }

    /// Ten parts whose gains differ by `mean ± 2` in turn are at 1.5·mean of the standard deviations of their mean.
    #[test]
    fn parts_prefer_a_law_whose_mean_gain_stands_out_of_their_scatter() {
        let none = suspect(0.0).evidence;
        for (mean, is_preferred) in [(0.65, false), (0.68, true)] {
            let gains = (0..10).map(|n| 7.0 + mean + if n % 2 == 0 { 2.0 } else { -2.0 }).collect();
            let other = Evidence { gains: [7.0; 10].into_iter().collect(), ..none.clone() };
            assert_eq!(prefers(&Evidence { gains, ..none.clone() }, &other), is_preferred, "{mean}");
        }
    }

    #[test]
    fn only_a_law_of_time_needs_more_than_one_release() {
        let readings = [0.1; 8];
        let told = |n_releases: usize, name: &str| {
            let mut findings = Findings::empty(0.0);
            let effect = Effect::by_name(name).unwrap();
            assert!(findings.suspects.push(Suspect { effect, ..suspect(1.0) }).is_ok());
            one_release_is_too_few(&findings, &Releases::new(&[&readings[..]; 2][..n_releases], 0.01))
        };
        assert_eq!(told(1, "drifting-friction"), Some(Reason::TooFewSwings));
        assert_eq!([told(2, "drifting-friction"), told(1, "coulomb"), told(2, "coulomb")], [None; 3]);
    }

    #[test]
    fn a_second_law_is_tied_within_a_twentieth_of_the_gain_and_a_tenth_of_what_neither_explains() {
        // Of 1000 the first law leaves nothing, or 1000 where there are 2000.
        for (excess, second, is_tied) in
            [(0.1, 940.0, false), (0.1, 960.0, true), (0.2, 840.0, false), (0.2, 860.0, true)]
        {
            let mut findings = Findings::empty(0.0);
            findings.excess[1] = excess;
            for chi_square in [1000.0, second] {
                assert!(findings.suspects.push(suspect(chi_square)).is_ok());
            }
            mark_ties(&mut findings, 10_000.0);
            assert_eq!(findings.suspects[1].is_tied, is_tied, "{excess} {second}");
        }
    }
}
