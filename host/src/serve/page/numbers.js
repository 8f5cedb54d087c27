// Numbers as people read them.

const raised = (power) => [...String(power)].map((sign) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(sign)]).join('');

/** From here on zeros need no power of ten … */
const LEAST_PLAIN = 1e-3;

/** … up to here. */
const MOST_PLAIN = 1e5;

const isPlain = (size) => size >= LEAST_PLAIN && size < MOST_PLAIN;

/** Four digits, zeros at the end among them; powers of ten where there would be many zeros. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  if (isPlain(Math.abs(value))) return Number(value.toPrecision(digits)).toFixed(placesOf(value, digits));
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  return `${mantissa}·10${raised(Number(power))}`;
}

const placesOf = (value, digits) => Math.max(digits - 1 - Number(value.toExponential(digits - 1).split('e')[1]), 0);

/** Behind a point stand at most so many digits without a power of ten. */
const MOST_PLAIN_PLACES = 5;

/** More places than these nobody reads. */
const MOST_PLACES = 8;

/** A value and its ±: two digits of the ±, the value to the same place, both with the same power of ten; without a ± four digits. */
export function withSpread(value, spread) {
  if (!(spread > 0) || !Number.isFinite(value) || !Number.isFinite(spread)) return [number(value), null];
  const size = Math.max(Math.abs(value), spread);
  const power = isPlain(size) && placesOf(spread, 2) <= MOST_PLAIN_PLACES ? 0 : Math.floor(Math.log10(size));
  const places = Math.min(placesOf(spread, 2) + power, MOST_PLACES);
  const after = power ? `·10${raised(power)}` : '';
  return [value, Number(spread.toPrecision(2))].map((part) => `${(part / 10 ** power).toFixed(Math.max(places, 0))}${after}`);
}

/** How many times as large: 1.00, 10.6, 143. */
export const times = (ratio) => (!Number.isFinite(ratio) ? '–' : ratio < 10 ? ratio.toFixed(2) : number(ratio, 3));

let milli = 'mrad';

/** What the recordings measure: 'angle' or 'rate'. */
export function measuring(kind) { milli = kind === 'rate' ? 'mrad/s' : 'mrad'; }

/** The unit in which errors are shown. */
export const milliUnit = () => milli;

/** Radians as milliradians; of rates, rad/s as mrad/s. */
export const mrad = (value, digits = 3) => (value === null || value === undefined ? '–' : `${(1e3 * value).toPrecision(digits)} ${milli}`);

/** Long names are shortened in the middle: files of one series differ at their ends. */
export function shortened(name, most) {
  if (name.length <= most) return name;
  const half = Math.floor((most - 1) / 2);
  return `${name.slice(0, half)}…${name.slice(-half)}`;
}

/** A new element with attributes, properties beginning with a dot, and children. */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

export const byId = (id) => document.getElementById(id);

/** Says beside what is being done that this comes after it. */
export function waits(what) {
  if (document.body.dataset.busy === 'true') byId('job-waits').textContent = `${what} comes next.`;
}

/** A table: heads, then rows of texts or cells. */
export function fillTable(table, heads, rows) {
  const cell = (content) => (content instanceof Node ? content : element('td', {}, String(content)));
  table.replaceChildren(
    element('thead', {}, element('tr', {}, ...heads.map((head) => element('th', { scope: 'col' }, head)))),
    element('tbody', {}, ...rows.map((row) => element('tr', {}, ...row.map(cell)))),
  );
}
