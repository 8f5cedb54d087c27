// Which effect is missing: candidates as bars, their evidence, one click to add, and the staircase of errors.

import { ZERO, findings } from './findings.js';
import { byId, element, mrad, number, times, waits, withSpread } from './numbers.js';
import { draw, pictureOf } from './plots.js';
import { get, post } from './server.js';
import { onPage } from './words.js';

const CURVE = 'friction-curve';

let effects = new Map();
let state = null;
let opened = null;
let done = () => {};

export function begin(report, all) {
  done = report;
  effects = new Map(all.map((effect) => [effect.name, effect]));
  byId('formula-form').addEventListener('submit', (event) => {
    event.preventDefault();
    const formula = byId('formula').value.trim();
    if (formula) done(post('api/formula', { formula }));
  });
  byId('diagnose').addEventListener('click', () => { waits('The search'); done(post('api/diagnose')); });
  byId('curve-add').addEventListener('click', () => done(post('api/change', { [hasCurve() ? 'remove' : 'add']: [CURVE] })));
}

export function show(now) {
  state = now;
  const why = whyNot(now);
  byId('diagnose').disabled = why !== null;
  byId('diagnose').title = why ?? '';
  showWords();
  showCandidates();
  byId('formula-add').disabled = byId('diagnose').disabled;
  byId('formula-add').textContent = now.model?.effects.includes('custom') ? 'Replace the law' : 'Add this law';
  showCurve();
  showSuggestions();
  showExplanation();
  showStaircase();
}

/** Why nothing can be searched for, if so. */
function whyNot(now) {
  if (!now.model) return 'There is no model yet.';
  if (!now.recordings.some((recording) => !recording.held_out)) return 'No recording takes part.';
  return now.not_compared ? `Nothing is compared: ${onPage(now.not_compared.what)}.` : null;
}

function showWords() {
  const found = state.diagnosis;
  const words = byId('diagnosis-words');
  byId('diagnosis-old').hidden = !state.diagnosis_is_old;
  if (!found) { words.replaceChildren(); return; }
  const { obstacles, headline, points } = findings(found, !isInModel(found.verdict), { zeroWords: state.zero_words, seenWords: state.seen_words });
  words.replaceChildren(
    ...obstacles.map((sentence) => element('p', {}, sentence)),
    ...(headline ? [element('p', {}, element('strong', {}, headline))] : []),
    ...(points.length ? [element('ul', {}, ...points.map((point) => element('li', {}, point)))] : []),
  );
}

/** Has the model everything that was found? */
function isInModel(verdict) {
  const laws = verdict.filter((name) => name !== ZERO);
  return laws.length > 0 && laws.every((name) => state.model?.effects.includes(name));
}

const hasCurve = () => Boolean(state.model?.effects.includes(CURVE));

/** Friction as a free curve of the speed, where no law explains the swings. */
function showCurve() {
  const box = byId('friction-curve');
  const words = state.curve_words;
  box.hidden = words === null;
  byId('curve-add').textContent = hasCurve() ? 'Remove it' : 'Add it';
  if (words === null || box.dataset.words === words) return;
  box.dataset.words = words;
  byId('curve-words').textContent = words;
  get(`api/pictures/${CURVE}`).then((picture) => {
    box.querySelector('figcaption').textContent = picture.explanation;
    return draw(box.querySelector('.plot'), () => pictureOf(picture));
  }).catch(() => {});
}

/** Small formulas for what no effect explains. */
function showSuggestions() {
  const box = byId('suggestions');
  const made = JSON.stringify(state.diagnosis?.formulas ?? []);
  if (box.dataset.made === made) return;
  box.dataset.made = made;
  const row = (suggestion) => element('p', {}, element('code', {}, suggestion.words), ` leaves ${mrad(suggestion.rmse)}, seen within ${number(suggestion.within_rad, 2)} rad. `,
    element('button', { class: 'add', click: () => { byId('formula').value = suggestion.formula; byId('formula').focus(); } }, 'Use it'));
  const all = (state.diagnosis?.formulas ?? []).map(row);
  box.replaceChildren(...(all.length ? [element('h3', {}, 'Formulas that would do'), ...all] : []));
}

const namesOf = (candidate) => (candidate.name === 'none' ? [] : candidate.name.split('+'));

function showCandidates() {
  const found = state.diagnosis;
  const list = byId('candidates');
  const made = JSON.stringify([found?.candidates, state.model?.effects, opened, state.diagnosis_is_old]);
  if (list.dataset.made === made) return;
  list.dataset.made = made;
  byId('candidates-hint').hidden = !found;
  if (!found) { list.replaceChildren(); opened = null; return; }
  const base = found.candidates.find((candidate) => candidate.name === 'none');
  // What is worse than the base model explains nothing; an error that is not finite comes as null.
  const tried = found.candidates.filter((candidate) => candidate.rmse !== null && !(base && candidate.rmse > base.rmse));
  const widest = Math.max(...tried.map((candidate) => candidate.rmse), found.rmse_before);
  list.replaceChildren(...tried.map((candidate, place) => row(candidate, place, found, widest)));
}

const STANDINGS = { claimed: 'claimed', likely: 'likely', tie: "tie: can't be told apart" };

/** What a diagnosis says of some laws together, if anything. */
function standingOf(names, found) {
  const laws = found.verdict.filter((name) => name !== ZERO);
  const suspect = found.unproven.find((claim) => claim.effect === found.suspect);
  const areAll = (others, also = []) => names.length > 0 && names.length === others.length && names.every((name) => others.includes(name) || also.includes(name));
  if (areAll(laws)) return 'claimed';
  const likely = suspect ? [suspect.effect, ...suspect.beside] : [];
  if (suspect && likely.every((name) => names.includes(name)) && names.every((name) => likely.includes(name) || laws.includes(name))) return 'likely';
  return areAll(laws, found.undecided) ? 'tie' : null;
}

function row(candidate, place, found, widest) {
  const names = namesOf(candidate);
  const here = names.length > 0 && names.every((name) => state.model?.effects.includes(name));
  const standing = standingOf(names, found);
  const bar = element('div', { class: 'bar', 'aria-hidden': 'true' }, element('i'));
  bar.firstChild.style.width = `${Math.max(100 * candidate.rmse / widest, 0.6)}%`;
  const title = names.length ? names.join(' + ') : 'base model';
  const tags = [here && element('span', { class: 'tag in' }, 'in the model'), standing && !(here && standing === 'claimed') && element('span', { class: `tag ${standing}` }, STANDINGS[standing])];
  const absent = names.filter((name) => !state.model?.effects.includes(name));
  const button = !absent.length ? element('span')
    : element('button', { class: 'add', 'data-add': absent.join('+'), disabled: state.diagnosis_is_old, title: state.diagnosis_is_old ? 'outdated: “Find out” looks again' : null, 'aria-label': `add ${absent.join(' and ')} to the model`, click: () => done(post('api/change', { add: absent })) }, 'Add');
  const open = () => { opened = opened === candidate.name ? null : candidate.name; showCandidates(); showExplanation(); };
  const look = () => showExplanation(candidate.name);
  return element('li', { class: `${place === 0 ? 'best' : ''} ${opened === candidate.name ? 'shown' : ''}`, 'data-name': candidate.name, mouseenter: look, mouseleave: () => showExplanation() },
    element('span', {}, element('button', { class: 'name', 'aria-expanded': String(opened === candidate.name), click: open, focus: look }, title), ...tags.filter(Boolean)),
    element('span', { class: 'left' }, `${times(candidate.rmse / found.noise)} ×`), button, bar);
}

/** What an effect is, in a student's words; of the one pointed at, else of the one opened. */
function showExplanation(name = opened) {
  const box = byId('explanation');
  const candidate = state.diagnosis?.candidates.find((one) => one.name === name);
  if (box.dataset.name === String(candidate?.name)) return;
  box.dataset.name = String(candidate?.name);
  if (!candidate) { box.replaceChildren(); return; }
  const found = state.diagnosis;
  const of = (effectName) => {
    const effect = effects.get(effectName);
    return effect && element('div', {}, element('p', {}, element('strong', {}, effectName), ' ', effect.summary),
      element('p', {}, element('code', {}, effect.formula)), element('p', { class: 'hint' }, `Shows best: ${effect.experiment} Source: ${effect.source}`));
  };
  const values = candidate.parameters.map((value) => `${value.symbol} = ${withSpread(value.value, value.std).filter(Boolean).join(' ± ')}${value.unit === '1' ? '' : ` ${value.unit}`}`);
  const base = found.candidates.find((one) => one.name === 'none');
  const evidence = base && candidate !== base ? ` Evidence (difference of criterion to the base model): ${number(base.criterion - candidate.criterion, 3)}.` : '';
  const told = (found.evidence ?? []).filter((one) => namesOf(candidate).includes(one.effect)).map((one) => element('p', {}, one.words));
  box.replaceChildren(...[...namesOf(candidate).map(of), ...told, values.length ? element('p', {}, values.join(', ')) : null,
    element('p', {}, `Predicted: the error goes from ${mrad(found.rmse_before)} to ${mrad(candidate.rmse)}; the noise is ${mrad(found.noise)}.${evidence}`)].filter(Boolean));
}

function showStaircase() {
  const steps = state.staircase;
  const box = byId('staircase');
  const made = JSON.stringify(steps);
  if (box.dataset.made === made) return;
  box.dataset.made = made;
  if (!steps.length) { box.replaceChildren(element('p', { class: 'hint' }, 'Each effect you add makes a step here: fitted and held-out error, with the noise as the floor.')); return; }
  const highest = Math.max(...steps.flatMap((step) => [step.rmse, step.held_out ?? 0, step.noise]));
  const bar = (value, kind = '') => {
    const made = element('i', { class: kind });
    made.style.width = `${100 * value / highest}%`;
    return made;
  };
  const last = steps[steps.length - 1];
  const step = (one) => element('div', { class: 'step' }, element('span', { class: 'name' }, one.words === 'as it is' ? 'model as it is' : one.words),
    element('span', { class: 'bars' }, bar(one.rmse), one.held_out !== null && bar(one.held_out, 'held')),
    element('output', { title: one.held_out === null ? 'fitted' : `fitted; held out ${mrad(one.held_out)}` }, mrad(one.rmse)));
  const floor = element('div', { class: 'step floor' }, element('span', { class: 'name' }, 'noise'), element('span', { class: 'bars' }, bar(last.noise)), element('output', {}, mrad(last.noise)));
  const key = steps.some((one) => one.held_out !== null) && element('p', { class: 'hint' }, 'Full bars: fitted. Striped bars: held out.');
  box.replaceChildren(...[...steps.map(step), floor, key].filter(Boolean));
}
