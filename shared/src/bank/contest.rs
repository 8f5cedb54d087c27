//! The first suspect put into the model, and in its place the likeliest of those that can't be told from it.
//!
//! Candidates are picked by one linear step, which errs by a few per cent of a large gain: more than what separates a
//! spring from a sensor's gain. In the model each takes as many steps as it needs, and the one that explains more takes
//! the first place.

use super::clusters::Clusters;
use super::column::{Column, Columns, MAX_STRENGTHS, N_BASE, N_STARTS};
use super::findings::{EXCESS, Reason, Room, Suspect, rank};
use super::judge::{jackknife, share_of_known};
use super::refit::{Bench, Refitted, Releases, STILL, Watch};
use super::sums::Sums;
use super::window::Readings;
use crate::effect::Effect;
use crate::parameters::base;
use crate::real::Real;

/// So many suspects are put into the model. Of 108 blind rigs with one effect 93 are named first with one of them, 98
/// with two or three. A law that contains the first one, or is contained in it, is none of them: it explains as much.
const MAX_SETTLED: usize = 2;

/// Where more than the noise is left even so, what is named leaves at most this share of what was there, as a diagnosis
/// on the PC has it. On the same rigs two of four wrong names go by this; with half of it all four, but also a third of
/// the right ones of two effects, with twice of it none.
const MOST_LEFT: f64 = 0.4;

/// Of a sensor's law that is linear in no strength a step counts from this many squares of the noise on. With ten times
/// as many the play of a gear comes out half a standard deviation too small; a tenth changes nothing.
const STILL_WHERE_CURVED: f64 = 1.0;

impl<R: Real<Mask = bool>> Room<R> {
    /// Puts the suspects that may be the one into the model, one after the other; the one that explains more is the
    /// first then. `free`: how many readings more there are than free numbers.
    #[inline(never)]
    pub(super) fn contest<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>, free: R) {
        let (n, before) = (self.bench.all.n, self.findings.excess[1]);
        let (mut winner, mut lowest, mut most, mut n_settled) = (0, None, R::zero(), 0);
        for place in 0..self.findings.suspects.len() {
            if n_settled == MAX_SETTLED || !self.may_be_it(place) {
                continue;
            }
            n_settled += 1;
            let n_numbers = self.findings.suspects[place].strengths.len();
            let explains = |left: R| rank((before + R::one()) * free - left, n_numbers, n);
            match self.settle(place, lowest, on).filter(|left| most.lt(explains(*left))) {
                Some(left) => (winner, lowest, most) = (place, Some(left), explains(left)),
                // Its steps lead nowhere: nobody knows that another one explains more.
                None if place == 0 => return,
                None => {}
            }
        }
        let findings = &mut self.findings;
        findings.suspects[0].is_tied = winner > 0;
        findings.suspects[winner].is_tied = false;
        findings.suspects[..=winner].rotate_right(1);
        findings.left = lowest.map(|left| left / free - R::one());
        let explains_little = |left: R| R::of(EXCESS).lt(left) && (R::of(MOST_LEFT) * before).lt(left);
        if findings.left.is_some_and(explains_little) {
            findings.reason = Some(Reason::Unexplained);
        }
    }

    fn may_be_it(&self, place: usize) -> bool {
        let [first, own] = [0, place].map(|place| &self.findings.suspects[place]);
        let is_rival = own.is_tied && !base::has(own.effect.id) && !contains(first.effect, own.effect);
        place == 0 || is_rival && !contains(own.effect, first.effect)
    }

    /// A suspect in the model, with its sizes there: a single step is too short for a large one. Gives what is left, in
    /// squares of the noise; its steps end where that is clearly more than what it was to beat.
    #[inline(never)]
    fn settle<D: Readings<R> + ?Sized>(&mut self, place: usize, to_beat: Option<R>, on: &Releases<R, D>) -> Option<R> {
        let Self { findings, model, larger, bench, clusters } = self;
        let suspect = &mut findings.suspects[place];
        let effect = (suspect.effect.id, &suspect.values[..suspect.effect.parameters.len()]);
        let mut watched = Watched { effect: effect.0, column: None, is_curved: false, clusters, to_beat };
        larger.copy(model);
        let has_settled = larger.settle_with(on, effect, &suspect.evidence.known_step, bench, &mut watched);
        let left = bench.known.square / (on.noise_rad * on.noise_rad);
        (has_settled && measure(suspect, larger, bench, watched.clusters)).then_some(left)
    }
}

/// Is the second law a special case of the first?
fn contains<R>(law: &Effect<R>, special: &Effect<R>) -> bool {
    law.generalises == Some(special.name)
}

/// The windows of a step with an effect in the model.
struct Watched<'a, R: 'static> {
    effect: u16,
    /// Of its first strength, among the known ones.
    column: Option<usize>,
    /// Is that no derivative at all sizes?
    is_curved: bool,
    clusters: &'a mut Clusters<R>,
    to_beat: Option<R>,
}

impl<R: Real<Mask = bool>> Watch<R> for Watched<'_, R> {
    fn begin(&mut self, columns: &Columns<R>) {
        let place = columns.present.iter().position(|(id, _)| *id == self.effect);
        self.column = place.map(|place| N_STARTS + N_BASE + place);
        let column = self.column.and_then(|column| columns.known.get(column));
        self.is_curved = matches!(column, Some(Column::Between { .. }));
        self.clusters.clear();
    }

    fn take(&mut self, window: &Sums<R>) {
        if let Some(column) = self.column {
            self.clusters.add(|share| share_of_known(window, column, share));
        }
    }

    /// A next step gains less than this one.
    fn is_enough(&self, left: R, gain: R) -> bool {
        let still = R::of(if self.is_curved { STILL_WHERE_CURVED } else { STILL });
        gain.lt(still) || self.to_beat.is_some_and(|to_beat| gain.lt(left - to_beat))
    }
}

/// The sizes in a model that has the effect, by the clusters of its last step. False where one of them alone tells two
/// numbers apart.
#[inline(never)]
fn measure<R: Real<Mask = bool>>(
    suspect: &mut Suspect<R>,
    larger: &Refitted<R>,
    bench: &Bench<R>,
    clusters: &Clusters<R>,
) -> bool {
    let Some((_, stds, _)) = jackknife(clusters, bench.columns.known.len()) else { return false };
    let own = bench.columns.present.iter().enumerate().filter(|(_, (id, _))| *id == suspect.effect.id);
    for ((place, (id, index)), c) in own.zip(0..MAX_STRENGTHS) {
        let value = larger.parameters.values(*id).and_then(|values| values.get(usize::from(*index)));
        let size = value.copied().unwrap_or(R::zero());
        (suspect.evidence.sizes[c], suspect.evidence.stds[c]) = (size, stds[N_STARTS + N_BASE + place]);
        suspect.values[usize::from(*index)] = size;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::parameters::Parameters;
    use std::boxed::Box;
    use std::vec::Vec;

    const INTERVAL_S: f64 = 4e-3;

    /// Readings of half a minute with a drag that the model lacks.
    fn swing(model: &Model<f64>, angle_rad: f64) -> Vec<f64> {
        let mut state = model.release(angle_rad, 0.0);
        let mut reading = |step: u32| {
            model.step(&mut state, INTERVAL_S);
            state.angle_rad + 1e-3 * (f64::from(step.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5)
        };
        (0..7500).map(&mut reading).collect()
    }

    #[test]
    fn a_first_suspect_that_cannot_be_put_into_the_model_gives_its_place_to_nobody() {
        let mut given = Parameters::<f64>::paper();
        given.set_friction(5.4e-4, 7.1e-4, 0.0, 0.0);
        let mut truth = given.clone();
        truth.set(10, &[8e-5]).unwrap();
        let model = Model::new(&truth);
        let readings = [1.4, -1.1, 0.8].map(|angle_rad| swing(&model, angle_rad));
        let parts: Vec<&[f64]> = readings.iter().map(Vec::as_slice).collect();
        let on = Releases::new(&parts, INTERVAL_S);
        let mut room = Box::new(Room::empty(0.0));
        room.look(&given, &on, 1e-3);
        assert_eq!(room.findings.suspects[0].effect.id, 10, "{:?}", room.findings.reason);
        assert!(room.findings.suspects.len() > 2);
        room.findings.suspects.iter_mut().skip(1).for_each(|other| other.is_tied = true);
        room.findings.suspects[0].values = [f64::NAN; crate::effect::MAX_VALUES];
        room.contest(&on, 20_000.0);
        assert_eq!(room.findings.suspects[0].effect.id, 10);
        assert!(room.findings.suspects.iter().skip(1).all(|other| other.is_tied));
    }
}
