// Measured over model, the verdict, the list of recordings, and sliders to feel what each number does.

import { fileOf, open, readOtherwise } from './columns.js';
import { Chart } from './chart.js';
import { byId, element, measuring, milliUnit, mrad, number, times, withSpread } from './numbers.js';
import { draw as plot, pictureOf } from './plots.js';
import { get, post, remove } from './server.js';
import { onPage, withoutOptions } from './words.js';

/** Sentences of the verdict that are always in sight. */
const SENTENCES = 3;

/** Pictures shown without being asked for. */
const SHOWN = ['loss', 'period', 'torque'];

let state = null;
let chosen = null;
let drawing = null;
let zoom = null;
let trace = null;
let charts = null;
let effects = [];
/** Values that differ from the model, by name, and effects that are only tried. */
let whatIf = {};
let tried = null;
let asking = false;
let answer = null;
let done = () => {};

export function begin(report, allEffects) {
  done = report;
  effects = allEffects;
  const zoomed = (from, to) => {
    zoom = from === null || !trace ? null : [Math.max(from, 0), Math.min(to, trace.duration_s)];
    if (zoom && zoom[1] - zoom[0] < 0.02) return;
    fetchTrace();
  };
  charts = {
    motion: new Chart(byId('motion'), { unit: 'angle, rad', zoomed, least: 1e-3 }),
    residual: new Chart(byId('residual'), { unit: 'left, mrad', scale: 1e3, zoomed, least: 1e-5 }),
  };
  byId('keep-values').addEventListener('click', () => done(post('api/values', { values: whatIf }).then(forget)));
  byId('reset-values').addEventListener('click', () => { forget(); showSliders(); showVerdict(); drawTrace(); });
  byId('try-effect').addEventListener('change', tryEffect);
  byId('undo').addEventListener('click', () => done(post('api/undo')));
  byId('more').addEventListener('toggle', () => byId('more').open && showPictures());
  byId('geometry-form').addEventListener('submit', (event) => {
    event.preventDefault();
    const values = Object.fromEntries([...new FormData(event.target)].map(([key, text]) => [key, text === '' ? null : Number(text)]));
    if (Object.values(values).every((value) => value === null)) return;
    done(post('api/pendulum', values));
  });
  byId('geometry-unknown').addEventListener('click', () => done(post('api/pendulum', {})));
}

function forget() { whatIf = {}; tried = null; answer = null; byId('try-effect').value = ''; }

export function show(now) {
  const before = state;
  state = now;
  const isRate = now.recordings[0]?.measured === 'rate';
  measuring(isRate ? 'rate' : 'angle');
  charts.motion.unit = isRate ? 'rate, rad/s' : 'angle, rad';
  charts.residual.unit = `left, ${milliUnit()}`;
  const model = JSON.stringify(now.model);
  if (!before || JSON.stringify(before.model) !== model) { forget(); showSliders(); }
  showGeometry();
  byId('model-card').hidden = now.model === null;
  byId('origin').textContent = now.model ? `${now.model.origin}${now.model.normalised ? '; geometry unknown: torques are per m·g·l' : ''}` : '';
  byId('undo').disabled = now.undos === 0;
  if (!now.recordings.some((recording) => recording.id === chosen)) { chosen = now.recordings[0]?.id ?? null; zoom = null; drawing = null; }
  if (drawing !== now.drawing) { drawing = now.drawing; answer = null; fetchTrace(); showPictures(); }
  showRecordings();
  showVerdict();
  byId('doubts').replaceChildren(...now.doubts.map((doubt) => element('li', {}, withoutOptions(doubt, readOtherwise(doubt)))));
  byId('limits').hidden = !now.comparison?.limits.length;
  byId('limits-list').replaceChildren(...(now.comparison?.limits ?? []).map((limit) => element('li', {}, limit)));
}

/** The form stays open until the recordings agree with what was typed; later it corrects. */
let isGeometryWanted = false;
let typedGeometry = '';

function showGeometry() {
  const { model, comparison } = state;
  const isUnknown = model === null || (model.normalised && model.fresh);
  const box = byId('geometry');
  byId('geometry-title').textContent = isUnknown ? 'The pendulum' : 'Change mass, length, inertia';
  const isWanted = isUnknown || state.not_compared !== null;
  if (isWanted && !isGeometryWanted) box.open = isGeometryWanted = true;
  if (!isWanted && isGeometryWanted && comparison) box.open = isGeometryWanted = false;
  const made = JSON.stringify(model?.geometry ?? null);
  if (!model?.geometry || typedGeometry === made) return;
  typedGeometry = made;
  for (const [name, value] of Object.entries(model.geometry)) byId('geometry-form').elements[name].value = Number(value.toPrecision(4));
}

export function showVerdict() {
  const box = byId('verdict');
  const { comparison } = state;
  box.className = answer ? '' : { 'nothing-missing': 'good', 'no-pattern': 'unsure', 'numbers-do-not-fit': 'unsure' }[comparison?.answer] ?? (comparison ? 'bad' : '');
  const error = errorOf();
  const ratio = error && element('div', { class: 'ratio', id: 'ratio' }, `${times(error.rmse / error.noise)} ×`,
    element('small', {}, `the noise${answer ? ', what if' : ''}: ${mrad(error.rmse)}`));
  const words = answer ? [`What if? These numbers leave ${mrad(answer.rmse_rad)} on ${theChosen().name}.`, 'Keep them, or go back to the model.']
    : resultFirst(comparison) ?? waitingFor();
  const said = words.map((sentence) => element('p', {}, sentence));
  const rest = said.splice(SENTENCES);
  const wasOpen = box.querySelector('details')?.open ?? false;
  const more = rest.length ? element('details', { open: wasOpen }, element('summary', {}, rest.length === 1 ? '1 more finding' : `${rest.length} more findings`), ...rest) : null;
  const sentences = element('div', { class: 'sentences' }, ...said, ...(more ? [more] : []));
  box.replaceChildren(...[ratio, sentences].filter(Boolean));
}

/** Where something is missing, that comes before how much is explained. */
function resultFirst(comparison) {
  if (!comparison) return null;
  const [explained, result, ...rest] = comparison.verdict;
  return comparison.answer === 'nothing-missing' || result === undefined ? comparison.verdict : [result, explained, ...rest];
}

const theChosen = () => state.recordings.find((recording) => recording.id === chosen);

/** Error and noise, rad: of what is tried on one recording, else of the comparison over all that take part, else of the
    last refit while it is made. */
function errorOf() {
  if (answer) return { rmse: answer.rmse_rad, noise: theChosen().noise_rad };
  if (state.comparison) return { rmse: state.comparison.totals.residual_rad, noise: state.comparison.totals.noise_rad };
  const step = state.staircase[state.staircase.length - 1];
  return step ?? null;
}

function waitingFor() {
  if (state.model === null && !state.recordings.length) return ['Load recordings or connect a rig: then the model runs beside what was measured, and this line says where it fails.'];
  if (state.model === null) return ['What is the pendulum like? Give mass, length and inertia, or load a rig.toml.'];
  if (!state.recordings.length) return ['Load a recording, or record a swing on the live view.'];
  if (state.recordings.every((recording) => recording.held_out)) return ['All recordings are held out: let one take part, and the model is compared with it.'];
  const failure = document.body.dataset.busy === 'true' ? null : state.not_compared ?? state.failure;
  if (!failure) return ['Comparing …'];
  return [`Nothing is compared: ${onPage(failure.what)}.`, ...(failure.next ? [`Next: ${onPage(failure.next)}.`] : [])];
}

/** Of a long name the middle is left out: files of one series differ at their ends, which always stay. */
const END_OF_NAME = 10;
const inTwoParts = (name) => [element('span', { class: 'begin' }, name.slice(0, -END_OF_NAME)), element('span', {}, name.slice(-END_OF_NAME))];

function showRecordings() {
  const row = (recording) => element('li', { class: recording.id === chosen ? 'chosen' : '' },
    element('button', { class: 'name', title: [recording.name, ...recording.notes].join('\n'), 'aria-pressed': String(recording.id === chosen), 'aria-label': recording.name, click: () => choose(recording.id) }, ...inTwoParts(recording.name)),
    fileOf(recording.name) && element('button', { class: 'away', 'aria-label': `say what is in ${recording.name}`, title: 'columns, units and sign', click: () => open(fileOf(recording.name), recording.id) }, '⚙'),
    element('button', { class: 'away', 'aria-label': `take ${recording.name} out`, title: 'take it out of the list', click: () => done(remove(`api/recordings/${recording.id}`)) }, '✕'),
    element('span', { class: 'facts' },
      `${number(recording.duration_s, 3)} s, ${recording.rmse_rad === null ? '…' : `${times(recording.rmse_rad / recording.noise_rad)} × noise`}`,
      element('label', { title: 'takes no part in fits; shows how well the model predicts' },
        element('input', { type: 'checkbox', checked: recording.held_out, change: (event) => done(post(`api/recordings/${recording.id}/held-out`, { held_out: event.target.checked })) }), ' hold out')));
  const list = byId('recordings');
  const made = JSON.stringify([state.recordings, chosen]);
  if (list.dataset.made === made) return;
  list.dataset.made = made;
  list.replaceChildren(...state.recordings.map(row));
}

function choose(id) {
  chosen = id;
  zoom = null;
  answer = null;
  showRecordings();
  showVerdict();
  fetchTrace();
}

const range = () => {
  const points = Math.min(6000, Math.max(600, Math.round(3 * byId('motion').clientWidth)));
  return zoom ? { from: zoom[0], to: zoom[1], points } : { points };
};

async function fetchTrace() {
  byId('download-csv').href = `download/modelled/${chosen}`;
  byId('downloads').hidden = chosen === null;
  if (chosen === null) { trace = null; drawTrace(); return; }
  const wanted = chosen;
  try {
    const got = await get(`api/trace/${chosen}?${new URLSearchParams(range())}`);
    if (wanted !== chosen) return;
    trace = got;
  } catch { return; }
  drawTrace();
  if (answer || Object.keys(whatIf).length) simulate();
}

function drawTrace() {
  const recording = theChosen();
  byId('trace-title').textContent = recording ? `Measured over model: ${recording.name}` : 'Measured over model';
  if (!trace) { charts.motion.show([], [0, 10]); charts.residual.show([], [0, 10]); return; }
  const x = zoom ?? [0, trace.duration_s];
  const run = answer ?? trace;
  const name = answer ? 'what if' : 'modelled';
  const motion = [{ ...trace.measured, colour: 'measured', name: 'measured', width: 2.2 }];
  if (run.modelled) motion.push({ ...run.modelled, colour: 'modelled', name, width: 1.3 });
  charts.motion.show(motion, x);
  const residual = run.residual ? [{ ...run.residual, colour: answer ? 'modelled' : 'measured', name: '', width: 1.1 }] : [];
  charts.residual.show(residual, x, [2 * trace.noise_rad]);
  document.body.dataset.drawn = String(drawing);
}

/** At once: a printer does not wait for the next picture of the screen. */
export function paint() { if (charts) Object.values(charts).forEach((chart) => chart.paint()); }

export function redraw() { if (charts) Object.values(charts).forEach((chart) => chart.draw()); }

async function showPictures() {
  if (!state.comparison) return;
  const titles = await get('api/pictures').catch(() => []);
  const first = titles.filter(({ key }) => SHOWN.includes(key)).sort((a, b) => SHOWN.indexOf(a.key) - SHOWN.indexOf(b.key));
  fill(byId('pictures'), first);
  if (byId('more').open) fill(byId('more-pictures'), titles.filter(({ key }) => !SHOWN.includes(key)));
}

function fill(box, titles) {
  const known = new Map([...box.children].map((figure) => [figure.dataset.key, figure]));
  const figures = titles.map(({ key, title, explanation }) => {
    const figure = known.get(key) ?? element('figure', { class: 'card', 'data-key': key },
      element('h2', {}, title), element('div', { class: 'plot' }), element('figcaption', {}));
    figure.querySelector('figcaption').textContent = explanation;
    get(`api/pictures/${key}`).then((picture) => plot(figure.querySelector('.plot'), () => pictureOf(picture))).catch(() => {});
    return figure;
  });
  box.replaceChildren(...figures);
}

function tryEffect(event) {
  tried = effects.find((effect) => effect.name === event.target.value) ?? null;
  whatIf = Object.fromEntries(Object.entries(whatIf).filter(([name]) => state.model.sliders.some((slider) => slider.name === name)));
  showSliders();
  if (answer) simulate();
}

function showSliders() {
  if (!state?.model) return;
  const groups = new Map();
  const all = [...state.model.sliders, ...(tried?.sliders ?? [])];
  for (const slider of all) groups.set(slider.owner, [...(groups.get(slider.owner) ?? []), slider]);
  const group = ([owner, sliders]) => element('div', {},
    element('div', { class: 'owner' }, owner, removable(owner) && element('button', { title: `take ${owner} out and refit`, click: () => done(post('api/change', { remove: [owner] })) }, 'remove')),
    ...sliders.map(sliderRow));
  byId('sliders').replaceChildren(...[...groups].map(group));
  const select = byId('try-effect');
  const absent = effects.filter((effect) => !effect.base && !state.model.effects.includes(effect.name));
  const names = absent.map((effect) => effect.name).join();
  if (select.dataset.names !== names) {
    select.dataset.names = names;
    select.replaceChildren(element('option', { value: '' }, 'choose …'), ...absent.map((effect) => element('option', { title: effect.summary }, effect.name)));
  }
  byId('what-if').hidden = Object.keys(whatIf).length === 0;
}

const removable = (owner) => owner !== 'pendulum' && state.model.effects.includes(owner);

function sliderRow(slider) {
  const value = whatIf[slider.name] ?? slider.value;
  const [shown, std] = withSpread(slider.value, slider.std);
  const isMoved = slider.name in whatIf;
  const output = element('output', {}, isMoved ? number(value) : shown, !isMoved && std && element('small', {}, `± ${std}`));
  const label = element('label', { class: slider.name in whatIf ? 'moved' : '', title: `${slider.meaning}${std ? `; ± ${std}` : ''}, ${slider.unit === '1' ? 'no unit' : slider.unit}` },
    element('span', {}, slider.symbol));
  const input = element('input', { type: 'range', min: slider.low, max: slider.high, step: 'any', 'data-name': slider.name, 'aria-label': `${slider.symbol}: ${slider.meaning}` });
  input.value = value;
  input.addEventListener('input', () => {
    whatIf[slider.name] = Number(input.value);
    label.className = 'moved';
    output.textContent = number(whatIf[slider.name]);
    byId('what-if').hidden = false;
    simulate();
  });
  label.append(input, output);
  return label;
}

/** Asks for one simulation at a time; the last position of the slider always gets its answer. */
async function simulate() {
  if (chosen === null || asking) { asking = asking ? 'again' : false; return; }
  asking = true;
  const began = performance.now();
  try {
    const values = { ...Object.fromEntries((tried?.sliders ?? []).map((slider) => [slider.name, slider.value])), ...whatIf };
    const got = await post('api/simulate', { recording: chosen, values, ...range() });
    // Meanwhile the sliders may have been put back.
    answer = Object.keys(whatIf).length ? got : null;
    document.body.dataset.simulatedMs = String(performance.now() - began);
    drawTrace();
    showVerdict();
  } catch (refusal) { done(Promise.reject(refusal)); }
  const again = asking === 'again';
  asking = false;
  if (again) simulate();
}
