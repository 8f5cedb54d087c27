//! What may be said after a look: which effect is missing, how sure, how large, and what else it may be; or why nothing
//! can be said.
//!
//! The model is put right first ([`super::refit`]). Then every candidate is judged, and the one that gains most is
//! named if a gain like its own is rarer by chance than the error that the look may spend, over all effects it was
//! picked from. One window alone names nothing, because F asks all clusters.

use super::chance::upper_tail;
use super::clusters::Clusters;
use super::column::{Candidate, Columns, MAX_STRENGTHS, N_BASE, N_STARTS};
use super::judge::{Evidence, Known, KnownShare, Share, jackknife};
use super::refit::{Refitted, Releases};
use super::sums::Sums;
use super::window::Readings;
use crate::effect::{Effect, MAX_VALUES};
use crate::parameters::{Parameters, base};
use crate::real::Real;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// How many suspects are told.
pub const MAX_SUSPECTS: usize = 8;

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
const EXCESS: f64 = 0.1;

/// An effect that may be missing.
#[derive(Clone, Debug)]
pub struct Suspect<R: 'static> {
    /// The effect.
    pub effect: &'static Effect<R>,
    /// Its values at the size found, the shape that of its start.
    pub values: [R; MAX_VALUES],
    /// Which of them were found …
    pub strengths: Vec<u8, MAX_STRENGTHS>,
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

/// Why nothing is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// The swings give too few windows yet.
    TooFewSwings,
    /// No friction and inertia make the model follow these swings.
    NotThisPendulum,
    /// What is wrong are the model's own numbers: with others it follows to the noise.
    WrongNumbers,
    /// Friction about rest differs from the model's, and may look like other effects.
    FrictionAboutRest,
    /// More than noise is left, but nothing in the list explains it on every part of the swings.
    Unexplained,
    /// The model follows to the noise.
    NothingMissing,
}

/// What a look found.
pub struct Findings<R: 'static> {
    /// The best suspects, the likeliest first.
    pub suspects: Vec<Suspect<R>, MAX_SUSPECTS>,
    /// Why none is named; `None` if the first one is.
    pub reason: Option<Reason>,
    /// The model put right, without the suspects.
    pub model: Option<Refitted<R>>,
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

impl<R: Real<Mask = bool>> Findings<R> {
    fn nothing(reason: Reason, noise_rad: R) -> Self {
        let (suspects, excess) = (Vec::new(), [R::zero(); 2]);
        Self { suspects, reason: Some(reason), model: None, n_windows: 0, n_clusters: 0, noise_rad, excess, left: None }
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

/// Looks at releases with a model, and spends at most this error on naming something that is not there.
pub fn look<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    parameters: &Parameters<R>,
    on: &Releases<R, D>,
    error: R,
) -> Findings<R> {
    let given = Refitted::new(parameters);
    if on.readings.is_empty() || given.n_windows(on, 1) == 0 {
        return Findings::nothing(Reason::TooFewSwings, on.noise_rad);
    }
    let Some(model) = given.clone().without_band().settled(on) else {
        return Findings::nothing(Reason::NotThisPendulum, on.noise_rad);
    };
    let as_given = square_as_given(&given, on);
    let findings = judge(model, as_given, on, error);
    let has_band = findings.reason == Some(Reason::FrictionAboutRest);
    let with_band = findings.model.as_ref().filter(|_| has_band).and_then(|model| model.with_band(on));
    match with_band {
        Some(model) => judge(model, as_given, on, error),
        None => findings,
    }
}

/// Judges all candidates beside a model that was put right. What is done one after the other is called one by one, so
/// that a board's stack never holds two such steps.
fn judge<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    model: Refitted<R>,
    as_given: R,
    on: &Releases<R, D>,
    error: R,
) -> Findings<R> {
    let mut findings = Findings::nothing(Reason::TooFewSwings, on.noise_rad);
    let Some(free) = suspect_all(&model, as_given, on, error, &mut findings) else { return findings };
    if findings.reason.is_none() {
        let first = findings.suspects.first_mut();
        let left = first.and_then(|first| settle(first, &model, on));
        findings.left = left.map(|square| excess(square, free, on.noise_rad));
    }
    findings.model = Some(model);
    findings
}

fn excess<R: Real<Mask = bool>>(square: R, free: R, noise_rad: R) -> R {
    square / (free * noise_rad * noise_rad) - R::one()
}

/// Finds the suspects, and whether one is to be named; gives how many readings more there are than free numbers.
#[inline(never)]
fn suspect_all<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    model: &Refitted<R>,
    as_given: R,
    on: &Releases<R, D>,
    error: R,
    findings: &mut Findings<R>,
) -> Option<R> {
    let columns = model.columns();
    let (mut all, mut clusters) = (Sums::default(), Clusters::default());
    let (known, n_windows) = gather(model, on, &columns, &mut all, &mut clusters)?;
    let n_numbers = N_STARTS * n_windows + N_BASE;
    let free = (all.n - R::of(n_numbers as f64)).max(R::one());
    (findings.n_windows, findings.n_clusters) = (n_windows, clusters.list.len());
    findings.excess = [as_given, known.square].map(|square| excess(square, free, on.noise_rad));
    find_suspects(&known, &clusters, &all, &columns, findings);
    mark_ties(findings, all.n);
    findings.reason = reason(findings, &columns, all.n, error).or_else(|| one_release_is_too_few(findings, on));
    Some(free)
}

/// Follows all windows twice: for the steps that all together ask for, then for what each has of them.
#[inline(never)]
fn gather<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    model: &Refitted<R>,
    on: &Releases<R, D>,
    columns: &Columns<R>,
    all: &mut Sums<R>,
    clusters: &mut Clusters<Share<R>>,
) -> Option<(Known<R>, usize)> {
    let (n_periods, mut n_windows) = (model.n_periods(on), 0);
    model.each_window(on, n_periods, columns, true, &mut |window| {
        all.add(window);
        n_windows += 1;
    });
    let known = Known::new(all, columns.known.len())?;
    model.each_window(on, n_periods, columns, true, &mut |window| {
        clusters.add(known.share(all, window, &columns.candidates));
    });
    Some((known, n_windows))
}

/// What the model leaves as it was given, each window begun where it is best and the zero free, rad².
#[inline(never)]
fn square_as_given<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(given: &Refitted<R>, on: &Releases<R, D>) -> R {
    let columns = given.columns();
    let mut all = Sums::default();
    given.each_window(on, given.n_periods(on), &columns, false, &mut |window| all.add(window));
    let (weight, score) = (all.known[N_STARTS][N_STARTS], all.known_score[N_STARTS]);
    if R::zero().lt(weight) { all.square - score * score / weight } else { all.square }
}

/// The best start of every effect whose sizes are physical, the likeliest first.
#[inline(never)]
fn find_suspects<R: Real<Mask = bool>>(
    known: &Known<R>,
    clusters: &Clusters<Share<R>>,
    all: &Sums<R>,
    columns: &Columns<R>,
    findings: &mut Findings<R>,
) {
    let best = &mut findings.suspects;
    for (index, candidate) in columns.candidates.iter().enumerate() {
        let evidence = known.evidence(clusters, all, index, candidate);
        let Some(evidence) = evidence.filter(|evidence| is_physical(candidate, evidence)) else { continue };
        let suspect = suspect(candidate, evidence, (clusters.list.len(), all.n), findings.noise_rad);
        if let Some(place) = best.iter().position(|other| other.effect == suspect.effect) {
            if !best[place].rank.lt(suspect.rank) {
                continue;
            }
            best.remove(place);
        }
        let place = best.iter().position(|other| other.rank.lt(suspect.rank)).unwrap_or(best.len());
        if best.is_full() && place < best.len() {
            best.pop();
        }
        // One that is less likely than all that have a place has none.
        let _ = best.insert(place, suspect);
    }
}

/// No strength is below what its parameter allows.
fn is_physical<R: Real<Mask = bool>>(candidate: &Candidate<R>, evidence: &Evidence<R>) -> bool {
    candidate.strengths.iter().zip(&evidence.sizes).all(|(index, size)| {
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
    let q = R::of(evidence.n_tested as f64);
    let chi_square = evidence.gain / (noise_rad * noise_rad);
    let mut values = candidate.start;
    candidate.strengths.iter().zip(&evidence.sizes).for_each(|(index, size)| values[usize::from(*index)] = *size);
    Suspect {
        effect: candidate.effect,
        values,
        strengths: candidate.strengths.clone(),
        chi_square,
        p: upper_tail(evidence.f, evidence.n_tested, n_clusters - evidence.n_tested),
        rank: chi_square * (R::one() - R::of(SHARE_A_NUMBER) * q) - q * n.ln(),
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

fn reason<R: Real<Mask = bool>>(findings: &Findings<R>, columns: &Columns<R>, n: R, error: R) -> Option<Reason> {
    if findings.n_clusters < MIN_CLUSTERS {
        return Some(Reason::TooFewSwings);
    }
    let least = R::of(LEAST_CHI_SQUARE).max(R::of(LEAST_GAIN) * n);
    let allowed = error / R::of(n_effects(columns) as f64);
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

/// The sizes of what is named, with the effect in the model: a single step is too short for a large one. Gives the
/// squares that are left then.
fn settle<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    suspect: &mut Suspect<R>,
    model: &Refitted<R>,
    on: &Releases<R, D>,
) -> Option<R> {
    let n_values = suspect.effect.parameters.len();
    let effect = (suspect.effect.id, &suspect.values[..n_values]);
    let larger = model.with(on, effect, &suspect.evidence.known_step)?;
    measure(suspect, &larger, on)
}

/// The sizes in a model that has the effect, and what it leaves.
#[inline(never)]
fn measure<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(
    suspect: &mut Suspect<R>,
    larger: &Refitted<R>,
    on: &Releases<R, D>,
) -> Option<R> {
    let columns = larger.columns();
    let is_own = |(id, _): &(u16, u8)| *id == suspect.effect.id;
    let column = N_STARTS + N_BASE + columns.present.iter().position(is_own)?;
    let (mut square, mut clusters) = (R::zero(), Clusters::default());
    larger.each_window(on, larger.n_periods(on), &columns, false, &mut |window| {
        square = square + window.square;
        clusters.add(KnownShare::new(window, column));
    });
    let (step, stds, gain) = jackknife(&clusters, columns.known.len())?;
    let own = columns.present.iter().enumerate().filter(|(_, present)| is_own(present));
    for ((place, (id, index)), c) in own.zip(0..MAX_STRENGTHS) {
        let column = N_STARTS + N_BASE + place;
        let value = larger.parameters.values(*id).and_then(|values| values.get(usize::from(*index)));
        let size = value.copied().unwrap_or(R::zero()) + step[column];
        (suspect.evidence.sizes[c], suspect.evidence.stds[c]) = (size, stds[column]);
        suspect.values[usize::from(*index)] = size;
    }
    Some(square - gain)
}
