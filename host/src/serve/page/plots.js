// Pictures by the plotting library, which is fetched from this server when the first one is needed.

import { shortened } from './numbers.js';

const LIGHT = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#56b4e9', '#e69f00', '#1b1f23'];
const DARK = ['#56b4e9', '#f0a13a', '#2fc89b', '#e59cc4', '#8ecbf2', '#e6c34a', '#eceff2'];

/** From blue through white to red; on a dark page too, where empty bins would look like zero otherwise. */
const DIVERGING = [[0, '#2166ac'], [0.25, '#92c5de'], [0.5, '#f7f7f7'], [0.75, '#f4a582'], [1, '#b2182b']];

let library = null;
function loaded() {
  library ??= new Promise((done, failed) => {
    const script = document.createElement('script');
    script.src = 'plotly.js';
    script.onload = () => done(window.Plotly);
    script.onerror = failed;
    document.head.append(script);
  });
  return library;
}

const isDark = () => document.documentElement.dataset.theme === 'dark';
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
export const colours = () => (isDark() ? DARK : LIGHT);
const em = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

/** Everything drawn so far, so that a change of theme can draw it anew. */
const drawn = new Map();

/** Draws `make()`, which gives traces and layout; called again when the theme changes. */
export async function draw(element, make) {
  drawn.set(element, make);
  const plotly = await loaded();
  if (drawn.get(element) !== make || !element.isConnected) return;
  const { traces, layout } = make();
  await plotly.react(element, traces, themed(layout), { responsive: true, displaylogo: false, displayModeBar: false });
  await label(plotly, element);
  await fit(element);
  element.dataset.labelled = 'true';
  places.observe(element);
}

/** What is drawn in a tab out of sight has the library's own width, until the tab comes up. */
const places = new ResizeObserver((seen) => seen.forEach(({ target }) => fit(target)));

async function fit(element) {
  if (!element.clientWidth || element._fullLayout.width === element.clientWidth) return;
  await library.then((plotly) => plotly.Plots.resize(element));
  await label(await library, element);
}

/** Fewer labels don't tell a scale from a number. */
const LEAST_LABELS = 3;

/** Steps are rounded up to two and a half times what is asked for: with eight, three labels are certain. */
const WANTED_TICKS = [5, 6, 7, 8];

/** Small plots get few labels by themselves: as many are asked for as give three on each axis. */
async function label(plotly, element) {
  for (const wanted of WANTED_TICKS) {
    const few = scales(element).filter((name) => labels(element, name) < LEAST_LABELS);
    if (few.length === 0) return;
    await plotly.relayout(element, Object.fromEntries(few.map((name) => [`${name}.nticks`, wanted])));
  }
}

/** Axes with labels of the library's own choice. */
function scales(element) {
  const isScale = ([name, axis]) => /^[xy]axis/.test(name) && axis.type === 'linear' && axis.showticklabels && axis.tickmode === 'auto';
  return Object.entries(element._fullLayout).filter(isScale).map(([name]) => name);
}

const labels = (element, name) => element.querySelectorAll(`.${name.replace('axis', '')}tick text`).length;

/** What depends on the width, such as how many numbers there is room for, is asked anew. */
const REDRAWN_AFTER_MS = 200;
let width = window.innerWidth;
let waiting = null;
window.addEventListener('resize', () => {
  if (window.innerWidth === width) return;
  width = window.innerWidth;
  clearTimeout(waiting);
  waiting = setTimeout(redrawAll, REDRAWN_AFTER_MS);
});

export function redrawAll() {
  for (const [element, make] of drawn) {
    if (element.isConnected) draw(element, make); else drawn.delete(element);
  }
}

/** So that a printer can make them as wide as its paper. */
export function fitToPaper() {
  for (const picture of document.querySelectorAll('.plot .main-svg')) {
    const [width, height] = [picture.getAttribute('width'), picture.getAttribute('height')];
    picture.setAttribute('viewBox', `0 0 ${width} ${height}`);
    picture.closest('.plot').style.setProperty('--shape', `${width} / ${height}`);
  }
}

export function axis(title, more = {}) {
  return {
    title: { text: title, standoff: 6, font: { size: 0.8 * em() } }, gridcolor: style('grid'), zerolinecolor: style('line'), linecolor: style('line'),
    automargin: true, exponentformat: 'power', ...more,
  };
}

function themed(layout) {
  return {
    paper_bgcolor: style('card'), plot_bgcolor: style('card'), font: { color: style('ink'), size: 0.82 * em(), family: 'system-ui, sans-serif' },
    margin: { l: 60, r: 16, t: 12, b: 48 }, legend: { orientation: 'h', y: 1.02, yanchor: 'bottom', x: 0, font: { size: 0.72 * em() }, itemwidth: 30 }, hovermode: 'closest', ...layout,
  };
}

/** Over more decades the labels at 2 and 5 of each would lie on each other. */
const FEW_DECADES = 2.5;

/** Labels of whole decades at most. */
const MOST_DECADES = 5;

/** Ticks at 1, 2 and 5 of each decade, or over many at some of the decades. */
function logarithmic(values) {
  const powers = values.filter((value) => value > 0).map(Math.log10);
  const decades = powers.reduce((most, power) => Math.max(most, power), -Infinity) - powers.reduce((least, power) => Math.min(least, power), Infinity);
  return { type: 'log', dtick: decades > FEW_DECADES ? Math.ceil(decades / MOST_DECADES) : 'D2' };
}

/** A picture of the library `host` as traces. */
export function pictureOf(picture) {
  const { x, y, content } = picture;
  const all = (side) => (content.curves ?? []).flatMap((curve) => curve[side]);
  const layout = {
    xaxis: axis(inTwoLines(x.label, LONGEST_ACROSS), x.is_logarithmic ? logarithmic(all('x')) : x.is_count ? { dtick: 1 } : {}),
    yaxis: axis(inTwoLines(y.label, LONGEST_UPWARDS), y.is_logarithmic ? logarithmic(all('y')) : {}),
  };
  return { traces: content.curves ? content.curves.map(curveOf) : [heatOf(content.heat)], layout };
}

/** A longer label would reach beyond a low plot, over the legend above it, or beyond a narrow one. */
const LONGEST_UPWARDS = 20;
const LONGEST_ACROSS = 30;
function inTwoLines(label, longest) {
  if (label.length <= longest) return label;
  const spaces = [...label.matchAll(/ /g)].map((space) => space.index);
  const middle = spaces.sort((a, b) => Math.abs(a - label.length / 2) - Math.abs(b - label.length / 2))[0];
  return middle === undefined ? label : `${label.slice(0, middle)}<br>${label.slice(middle + 1)}`;
}

/** Letters of a name for which a legend has room. */
const LONGEST_NAME = 32;

function curveOf(curve) {
  const colour = curve.colour === 6 ? style('noise') : colours()[curve.colour % 7];
  const trace = { x: curve.x, y: curve.y, name: shortened(curve.name.replace(/\.csv$/, ''), LONGEST_NAME), showlegend: curve.name !== '', type: 'scatter' };
  if (curve.style === 'line' || curve.style === 'dashed') {
    return { ...trace, mode: 'lines', line: { color: colour, width: 2, dash: curve.style === 'dashed' ? 'dash' : 'solid' } };
  }
  const cloud = curve.style === 'cloud';
  const bars = curve.bars?.some((bar) => bar > 0) ? { error_y: { type: 'data', array: curve.bars, thickness: 1, width: 2 } } : {};
  return { ...trace, ...bars, mode: 'markers', marker: { color: colour, size: cloud ? 3 : 6, opacity: cloud ? 0.4 : 1 } };
}

function heatOf(heat) {
  const names = heat.names;
  return {
    type: 'heatmap', x: names ?? heat.x, y: names ?? heat.y, z: heat.values, text: heat.notes, hovertemplate: '%{text}<extra></extra>',
    zmin: -heat.limit, zmax: heat.limit, colorscale: DIVERGING,
    colorbar: bar(heat.label),
  };
}

/** Keeps the title of a key off its highest number; the library drops a line of blanks. */
const LOW_LINE = '<br><span style="font-size:0.4em;fill:transparent">.</span>';

/** The key of a coloured map. */
export const bar = (label) => ({ title: { text: `${label}${LOW_LINE}`, side: 'top', font: { size: 0.8 * em() } }, thickness: 14, outlinewidth: 0 });

/** Light to dark in one hue, readable in grey too. */
export const rising = () => (isDark() ? 'Cividis' : [[0, '#00204c'], [0.5, '#7c7b78'], [1, '#ffe945']]);
