// What a diagnosis says, in sentences: first what stands in its way, then what is missing, then how surely.

import { mrad } from './numbers.js';

/** Every fit takes the sensor's zero off by itself. */
export const ZERO = 'angle-offset';

/** Why a law that lowers the error is not claimed. */
const REASONS = {
  'too-short': 'there are too few periods to check it on',
  'slight': 'by less than a tenth of what is claimed, whose own law may be as far from the truth',
  'out-of-range': 'only at the end of its range: these swings ask for more than it can be, or for something else',
  'vague': 'all its numbers are within their own errors, so that nobody knows by what',
  'partly': 'not on every part of the swings',
};

const named = (claim) => claim.effect + (claim.beside.length ? ` beside ${claim.beside.join(' and ')}` : '');

/** What to see to before any law is believed. */
function obstacles(found) {
  const touched = found.touches.map((touch) => `Something touched the pendulum at ${touch.time_s.toFixed(2)} s of ${touch.recording}, or its time jumped there: only the longer part of that swing is looked at here.`);
  const hardly = found.follows && found.hardly_follows && !found.driven.length;
  return [
    ...touched,
    found.driven.length && `The swings of ${found.driven.join(', ')} don't become smaller: a motor or a hand drives them, and what follows says nothing of this pendulum.`,
    !found.follows && `The model does not follow these swings at all: it leaves ${mrad(found.rmse_after)}. Did nothing touch or drive it, and are unit, zero and geometry right?`,
    hardly && 'The model hardly follows these swings: see first that the column is the angle of one pendulum, in that unit, let go and left alone.',
    hardly && found.apart_rmse && `Each recording has a model of its own that leaves ${mrad(found.apart_rmse)}: what was changed between them?`,
    found.levels && `${found.levels.words}.`,
  ].filter(Boolean);
}

/** A law that lowers the error, and why it is only likely, or not claimed at all. */
function doubt(claim, found) {
  if (claim.effect !== found.suspect) return `Not claimed: ${named(claim)}. It lowers the error to ${mrad(claim.rmse)}, but ${REASONS[claim.standing]}.`;
  const all = ['it', 'both'][claim.beside.length] || 'all';
  return `Likely, but not proven: ${named(claim)}. With ${all} the error would fall to ${mrad(claim.rmse)}, but ${REASONS[claim.standing]}; another release can tell.`;
}

/** Where no law of the list is missing for sure, but more than noise is left. */
function unnamed(found, zeroWords) {
  const putRight = found.verdict.length ? `put right (${found.verdict.join(' and ')})`
    : found.zero_is_doubtful ? "fitted, which these swings don't prove to be off," : null;
  const more = putRight ? [`With the sensor's zero ${putRight} it leaves ${mrad(found.rmse_after)}.`, zeroWords]
    : [found.levels && `With a friction level for each release it leaves ${mrad(found.rmse_after)}.`];
  const likely = found.unproven.find((claim) => claim.effect === found.suspect);
  return {
    headline: likely ? doubt(likely, found) : 'More than noise is left, but no effect of the list brings it down to the noise.',
    points: [`The base model leaves ${mrad(found.rmse_before)}.`, ...more,
      ...found.unproven.filter((claim) => claim !== likely).map((claim) => doubt(claim, found)), found.of_state?.words],
  };
}

/** What is missing, or was. */
function law(found, isMissing, { zeroWords, seenWords }) {
  const verdict = isMissing ? found.verdict : found.verdict.filter((name) => name !== ZERO);
  const falls = `With ${verdict.length > 1 ? 'them' : 'it'} the ${isMissing ? '' : 'base model\'s '}error falls from ${mrad(found.rmse_before)} to ${mrad(found.rmse_after)}.`;
  const tie = found.family ? `It is ${found.family.words}; its shape is undecided between ${found.family.members.join(' and ')}.`
    : found.undecided.length ? `These swings cannot tell it from ${found.undecided.join(', ')}.` : null;
  return {
    headline: `${isMissing ? 'Missing' : 'Already in the model'}: ${verdict.join(' and ')}. ${falls}`,
    points: [zeroWords, ...seenWords.map((words) => `${words}.`), tie, ...found.unproven.map((claim) => doubt(claim, found)),
      found.unexplained && 'What remains is not explained by any candidate.', found.of_state?.words],
  };
}

/** The sentences of a diagnosis: { obstacles, headline, points }; isMissing: does the model lack some of the verdict? */
export function findings(found, isMissing, words) {
  const first = obstacles(found);
  const hasNoLaw = found.staircase.slice(1).every((step) => step.added === 'friction levels');
  const told = () => {
    if (!found.follows && !found.unexplained && found.verdict.length === 0) return { headline: null, points: [] };
    if (hasNoLaw && found.unexplained) return unnamed(found, words.zeroWords);
    if (found.verdict.length === 0) return { headline: `${found.levels ? 'No effect' : 'Nothing'} is missing at this noise level.`, points: [] };
    return law(found, isMissing, words);
  };
  const { headline, points } = told();
  return { obstacles: first, headline, points: points.filter(Boolean) };
}
