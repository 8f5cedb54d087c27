// What is missing, said while it swings: a bar of evidence for each suspect, a sentence once one is named, and adding it.

import { byId, element } from './numbers.js';
import { openPush } from './rig.js';
import { post } from './server.js';

/** A bar is full where chance would have to have so many powers of ten on its side. */
const FULL_POWERS = 15;
const LEAST_P = 1e-300;
const N_SHOWN = 5;
const NOTHING_YET = 'Nothing can be said yet: the first bars come some seconds after a release.';

let done = () => {};
let effects = new Map();

export function begin(report, all) {
  done = report;
  effects = new Map(all.map((effect) => [effect.name, effect]));
  byId('evidence-fit').addEventListener('click', () => takeOver(null));
}

/** Fits the model to what was listened to, with an effect or as it is; then asks whether the rig is to have it. */
function takeOver(effect) {
  const fitted = done(post('api/rig/suspect', { effect }).then(() => true));
  fitted.then((is) => { if (is) done(openPush()); });
}

const powers = (p) => -Math.log10(Math.max(p, LEAST_P));
const superscript = (n) => [...String(n)].map((sign) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(sign)]).join('');

/** How often chance alone would do as well. */
function chance(p) {
  const n = Math.round(powers(p));
  return n < 1 ? 'chance' : n < 4 ? `1 in ${10 ** n}` : `1 in 10${superscript(n)}`;
}

export function show(state) {
  const { evidence, rig } = state;
  const isThere = rig.firmware !== null;
  byId('evidence-stage').textContent = stageWords(evidence, rig);
  const isNamed = evidence.named.length > 0;
  byId('evidence').className = `card ${isNamed ? 'named' : ''}`;
  showWords(evidence, isNamed);
  showTrouble(evidence.trouble);
  byId('evidence-judge').textContent = evidence.judge === null ? '' : evidence.judge === 'rig' ? 'Judged by the rig itself.' : 'Judged by this program, from what the rig sends.';
  const isFree = isThere && rig.recording === null;
  byId('evidence-fit').parentElement.hidden = !evidence.asks_for_a_fit;
  byId('evidence-fit').disabled = !isFree;
  byId('evidence-key').hidden = evidence.candidates.length === 0;
  showBars(state, isNamed, isFree);
}

const STAGES = {
  settling: 'Waiting until the pendulum is still.',
  waiting: 'Still: lift it, hold it, and let it go.',
  swinging: 'Released: the bars grow while it swings.',
  'at-rest': 'At rest.',
};

function stageWords(evidence, rig) {
  if (rig.firmware === null) return 'No rig is connected.';
  if (evidence.is_rig_due && evidence.sentence !== null) return 'The rig itself looks …';
  if (evidence.stage === 'waiting' && rig.simulated) return 'Still: “Let go again” makes the simulated pendulum swing.';
  return STAGES[evidence.stage] ?? 'Paused.';
}

/** The name stands out; what it means is the list's summary of that effect. */
function showWords(evidence, isNamed) {
  const words = (evidence.sentence ?? (evidence.trouble ? '' : NOTHING_YET)).replace(/e(-?[0-9]+)/g, (_, power) => `·10${superscript(power)}`);
  const box = byId('evidence-words');
  if (box.dataset.words === words) return;
  box.dataset.words = words;
  const [first, ...others] = words.split(/(?<=\.) /);
  box.replaceChildren(element('strong', {}, first), others.length ? ` ${others.join(' ')}` : '');
  byId('evidence-meaning').textContent = isNamed ? effects.get(evidence.named[0])?.summary ?? '' : '';
}

const begun = (text) => text.charAt(0).toUpperCase() + text.slice(1);

function showTrouble(trouble) {
  const [what, next] = trouble ?? [];
  byId('evidence-trouble').textContent = !trouble ? '' : `${begun(what)}.${next ? ` Next: ${next}.` : ''}`;
}

function showBars(state, isNamed, isFree) {
  const { evidence, model } = state;
  const list = byId('evidence-bars');
  const made = JSON.stringify([evidence.candidates, evidence.named, model?.effects, isFree]);
  if (list.dataset.made === made) return;
  list.dataset.made = made;
  list.replaceChildren(...evidence.candidates.slice(0, N_SHOWN).map((candidate, place) => {
    const isClaimed = isNamed && place === 0;
    const isTied = isNamed && place > 0 && candidate.tied;
    return row(candidate, isClaimed, isTied, isFree, model);
  }));
}

function row(candidate, isClaimed, isTied, isFree, model) {
  const bar = element('div', { class: 'bar', 'aria-hidden': 'true' }, element('i'));
  bar.firstChild.style.width = `${100 * Math.min(powers(candidate.p) / FULL_POWERS, 1)}%`;
  const tag = isClaimed ? 'named' : isTied ? "can't be told apart" : null;
  const title = effects.get(candidate.name)?.summary;
  const evidence = `F ${candidate.f.toPrecision(3)} in ${candidate.windows} parts of the swings`;
  return element('li', { class: isClaimed ? 'claimed' : isTied ? 'tied' : '', 'data-name': candidate.name, 'data-p': candidate.p },
    element('div', {}, element('span', { class: 'name', title }, candidate.name), element('span', { class: 'chance', title: evidence }, chance(candidate.p))),
    bar, tag && element('div', {}, element('span', { class: 'tag' }, tag), adder(candidate.name, isFree, model)));
}

/** In the page's model it may be already, if nobody has written that to the rig. */
function adder(name, isFree, model) {
  const isHere = model?.effects.includes(name);
  const words = isHere ? 'Write it to the rig …' : 'Add it …';
  const act = () => (isHere ? done(openPush()) : takeOver(name));
  return element('button', { class: 'add', 'data-add': name, disabled: !isFree, 'aria-label': `${isHere ? 'write the model with' : 'add'} ${name}`, click: act }, words);
}
