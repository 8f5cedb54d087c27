// Numbers as people read them.

/** Four digits, powers of ten where there would be many zeros. */
export function number(value, digits = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(digits)));
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  return `${Number(mantissa)}·10${[...String(Number(power))].map((c) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(c)]).join('')}`;
}

/** How many times as large: 1.00, 10.6, 143. */
export const times = (ratio) => (!Number.isFinite(ratio) ? '–' : ratio < 10 ? ratio.toFixed(2) : String(Number(ratio.toPrecision(3))));

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

/** A table: heads, then rows of texts or cells. */
export function fillTable(table, heads, rows) {
  const cell = (content) => (content instanceof Node ? content : element('td', {}, String(content)));
  table.replaceChildren(
    element('thead', {}, element('tr', {}, ...heads.map((head) => element('th', { scope: 'col' }, head)))),
    element('tbody', {}, ...rows.map((row) => element('tr', {}, ...row.map(cell)))),
  );
}
