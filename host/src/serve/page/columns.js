// What is in a file: its first rows, which column is what, and the curve that this gives. Opens where a file can't be read
// as it is, and for whoever wants it read otherwise.

import { byId, element, fillTable } from './numbers.js';
import { post, send } from './server.js';
import { withoutOptions } from './words.js';

const TIME_UNITS = ['as named', 's', 'ms', 'us', 'ns', 'min', 'day'];
const UNITS = {
  'as named': ['theta', ''], 'angle, rad': ['theta', 'rad'], 'angle, degrees': ['theta', 'deg'], 'angle, mrad': ['theta', 'mrad'],
  'angle, gon': ['theta', 'gon'], 'angle, turns': ['theta', 'turn'], 'counts, of which a turn has': ['theta', '#/turn'],
  'counts or volts, each in degrees': ['theta', '#deg'], 'rate, rad/s': ['rate', 'rad/s'],
  'rate, degrees/s': ['rate', 'deg/s'], 'rate, rpm': ['rate', 'rpm'],
};

const MOST_LOOKED_AT = 4e6;

/** The server could read it, but has no place for it beside the others. */
const CONFLICT = 409;

let file = null;
let replaced = null;
let finished = () => {};
let asked = 0;
const kept = new Map();

/** Takes a file in; asks what its columns are if it can't be read without. */
export async function load(chosen) {
  kept.set(chosen.name, chosen);
  try { await send('api/recordings', chosen); } catch (refusal) {
    if (refusal.next === undefined || refusal.status === CONFLICT || !(await isTable(chosen))) throw refusal;
    await open(chosen, null, refusal.message);
  }
}

/** The file of a recording of the list, if it was chosen in this tab. */
export const fileOf = (name) => kept.get(name);

/** How what a message names is read otherwise: after a reload nothing is left of the files that were chosen before. */
export const readOtherwise = (message) => ([...kept.keys()].some((name) => message.includes(name))
  ? 'The ⚙ beside it reads it otherwise.' : 'Load its file here again: the ⚙ beside it then reads it otherwise.');

async function isTable(chosen) {
  try { return (await send('api/preview', beginning(chosen))).columns.length > 0; } catch { return false; }
}

/** Of a long table the first megabytes are enough to look at. */
function beginning(chosen) {
  const isText = /\.(csv|txt|tsv|dat)$/i.test(chosen.name);
  return isText && chosen.size > MOST_LOOKED_AT ? new File([chosen.slice(0, MOST_LOOKED_AT)], chosen.name) : chosen;
}

/** Asks what the columns are; resolves when the dialog is closed. */
export function open(chosen, recording, fault = '') {
  [file, replaced] = [chosen, recording];
  byId('columns-title').textContent = `What is in ${chosen.name}?`;
  byId('columns-fault').textContent = inFields(fault);
  byId('columns-form').reset();
  for (const id of ['columns-time', 'columns-reading']) byId(id).replaceChildren();
  byId('columns-dialog').showModal();
  look();
  return new Promise((resolve) => { finished = resolve; });
}

/** What a count is worth has its number beside it; without it the unit is left open. */
function chosenUnit() {
  const [role, unit] = UNITS[byId('columns-unit').value];
  const isWorth = unit.includes('#');
  byId('columns-worth').hidden = !isWorth;
  const worth = Number(byId('columns-worth').value);
  return [role, isWorth ? (worth > 0 ? unit.replace('#', String(worth)) : '') : unit];
}

const inFields = (words) => withoutOptions(words, 'Say in the fields below what the columns hold.');

function wish() {
  const [role, unit] = chosenUnit();
  const parts = [];
  const timeUnit = byId('columns-time-unit').value;
  if (byId('columns-time').value) parts.push(`t=${byId('columns-time').value}${timeUnit === TIME_UNITS[0] ? '' : `:${timeUnit}`}`);
  if (byId('columns-reading').value) parts.push(`${role}=${byId('columns-reading').value}${unit ? `:${unit}` : ''}`);
  const asWished = { columns: parts.join(','), mirrored: String(byId('columns-mirrored').checked) };
  if (byId('columns-zero').value) asWished.zero = byId('columns-zero').value;
  return asWished;
}

async function look() {
  const mine = ++asked;
  let seen;
  try { seen = await send('api/preview', beginning(file), wish()); } catch (refusal) {
    if (mine === asked) byId('columns-fault').textContent = [refusal.message, refusal.next].filter(Boolean).join('\nNext: ');
    return;
  }
  if (mine !== asked) return;
  showColumns(seen);
  byId('columns-fault').textContent = inFields(seen.fault ?? '');
  byId('columns-yes').disabled = seen.reading === null;
  byId('columns-notes').replaceChildren(...(seen.reading?.notes ?? []).map((note) => element('li', {}, inFields(note))));
  draw(seen.reading);
  document.body.dataset.columns = seen.reading?.measured ?? 'none';
}

function showColumns(seen) {
  const option = (name, idx) => element('option', { value: String(idx) }, name === String(idx) ? `column ${idx}` : `${idx}: ${name}`);
  for (const id of ['columns-time', 'columns-reading']) {
    if (byId(id).options.length) continue;
    byId(id).replaceChildren(element('option', { value: '' }, 'found by itself'), ...seen.columns.map(option));
  }
  fillTable(byId('columns-rows'), seen.columns, seen.rows);
  const heads = [...byId('columns-rows').querySelectorAll('th')];
  heads[byId('columns-time').value]?.classList.add('time');
  heads[byId('columns-reading').value]?.classList.add('reading');
}

/** The curve with its unit and its ends. */
function draw(reading) {
  const canvas = byId('columns-curve');
  const style = getComputedStyle(document.documentElement);
  const scale = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [canvas.clientWidth * scale, canvas.clientHeight * scale];
  const pen = canvas.getContext('2d');
  pen.scale(scale, scale);
  if (!reading || reading.times_s.length < 2) return;
  const { times_s: times, readings } = reading;
  const [width, height, left, foot] = [canvas.clientWidth, canvas.clientHeight, 64, 20];
  const [low, high] = [Math.min(...readings), Math.max(...readings)];
  const x = (time) => left + ((time - times[0]) / (times[times.length - 1] - times[0])) * (width - left - 8);
  const y = (value) => 8 + ((high - value) / (high - low || 1)) * (height - foot - 16);
  pen.font = '12px system-ui, sans-serif';
  pen.fillStyle = style.getPropertyValue('--quiet');
  pen.textAlign = 'right';
  for (const value of [low, (low + high) / 2, high]) pen.fillText(value.toPrecision(3), left - 6, y(value) + 4);
  pen.textAlign = 'left';
  pen.fillText(`${reading.measured} in ${reading.unit}, over ${(times[times.length - 1] - times[0]).toPrecision(3)} s`, left, height - 4);
  pen.strokeStyle = style.getPropertyValue('--measured');
  pen.lineWidth = 1.5;
  pen.beginPath();
  times.forEach((time, k) => pen.lineTo(x(time), y(readings[k])));
  pen.stroke();
}

/** Takes the file in as it was wished; a recording that is read anew is replaced. */
async function take() {
  await send('api/recordings', file, replaced === null ? wish() : { ...wish(), replaced });
  await post('api/dismiss');
  byId('columns-dialog').close();
}

export function begin(done) {
  const options = (names) => names.map((name) => element('option', { value: name }, name));
  byId('columns-time-unit').replaceChildren(...options(TIME_UNITS));
  byId('columns-unit').replaceChildren(...options(Object.keys(UNITS)));
  byId('columns-form').addEventListener('change', look);
  byId('columns-form').addEventListener('submit', (event) => { event.preventDefault(); look(); });
  byId('columns-yes').addEventListener('click', () => done(take()));
  byId('columns-no').addEventListener('click', () => byId('columns-dialog').close());
  byId('columns-dialog').addEventListener('close', () => finished());
}

export function show() {}
