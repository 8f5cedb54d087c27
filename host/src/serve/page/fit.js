// The story of the fit: how the box narrowed, each design's surfaces, and how far they can be believed.

import { byId, element, fillTable, number, waits, withSpread } from './numbers.js';
import { readOtherwise } from './columns.js';
import { axis, bar, colours, draw as plot, rising } from './plots.js';
import { get, post } from './server.js';
import { onPage, withoutOptions } from './words.js';

let done = () => {};
let shown = null;
let path = null;

export function begin(report) {
  done = report;
  byId('fit').addEventListener('click', () => { waits('The fit'); done(post('api/fit')); });
  for (const id of ['stage', 'response', 'factor-x', 'factor-y']) byId(id).addEventListener('input', showStage);
}

export function show(state) {
  byId('fit').disabled = !state.model || !state.recordings.some((recording) => !recording.held_out);
  byId('fit-empty').hidden = state.fit !== null;
  byId('fit-empty').firstElementChild.textContent = byId('fit').disabled
    ? 'No fit yet. Give a model and load a recording, then start one: every design it runs is shown here.'
    : 'No fit yet. Start one: every design it runs is shown here.';
  byId('fit-story').hidden = state.fit === null;
  const made = JSON.stringify(state.fit);
  if (!state.fit || shown === made || byId('view-fit').hidden) return;
  shown = made;
  showIdentified(state.fit);
  showPath();
}

const spread = (found) => withSpread(found.value, found.std).map((text) => text ?? '–');

function showIdentified(fit) {
  const verdicts = { identified: 'identified', weak: 'weak', not: 'not identified' };
  fillTable(byId('identified'), ['Number', 'Value', '±', 'Unit', 'Of', 'Verdict'], fit.parameters.map((found) =>
    [found.symbol, ...spread(found), found.unit === '1' ? '' : found.unit, found.name, verdicts[found.verdict]]));
  byId('fit-warnings').replaceChildren(...fit.warnings.map((warning) => element('li', {}, withoutOptions(onPage(warning), readOtherwise(warning)))));
}

async function showPath() {
  path = await get('api/fit/path').catch(() => null);
  if (!path?.stages.length) return;
  const symbols = [...new Set(path.stages.flatMap((stage) => stage.ranges.map(([symbol]) => symbol)))];
  byId('path').style.height = `${7.5 * symbols.length + 3}rem`;
  plot(byId('path'), () => pathPlot(symbols));
  const stage = byId('stage');
  stage.max = path.stages.length - 1;
  stage.value = 0;
  byId('response').replaceChildren(...path.responses.map((name, k) => element('option', { value: k }, name)));
  showStage();
}

/** Room for the number of a design under its axis, in letters. */
const ROOM_OF_NUMBER = 2.4;

/** From one design with a number to the next: as many as there is room for. */
function designsApart() {
  const box = byId('path');
  const room = (box.clientWidth - 100) / (ROOM_OF_NUMBER * parseFloat(getComputedStyle(box).fontSize));
  return [1, 2, 5, 10, 20, 25, 50].find((step) => path.stages.length / step <= room) ?? 100;
}

function pathPlot(symbols) {
  const traces = [];
  const dtick = designsApart();
  const layout = { grid: { rows: symbols.length, columns: 1, pattern: 'independent', ygap: 0.25 }, showlegend: false, margin: { l: 80, r: 16, t: 8, b: 44 } };
  symbols.forEach((symbol, row) => {
    const id = row ? row + 1 : '';
    const of = (pick) => path.stages.map((stage) => {
      const j = stage.ranges.findIndex(([name]) => name === symbol);
      return j < 0 ? null : pick(stage, j);
    });
    const x = path.stages.map((_, k) => k + 1);
    const line = { shape: 'hvh', width: 0 };
    const at = { x, xaxis: `x${id}`, yaxis: `y${id}`, type: 'scatter' };
    traces.push({ ...at, y: of((stage, j) => stage.ranges[j][1]), mode: 'lines', line, name: 'high', hoverinfo: 'y+name' });
    traces.push({ ...at, y: of((stage, j) => stage.ranges[j][2]), mode: 'lines', line, fill: 'tonexty', fillcolor: `${colours()[0]}40`, name: 'low', hoverinfo: 'y+name' });
    traces.push({ ...at, y: of((stage, j) => stage.values[j]), mode: 'lines+markers', line: { color: colours()[1], width: 2 }, marker: { size: 5 }, name: symbol, connectgaps: true });
    layout[`xaxis${id}`] = axis(row === symbols.length - 1 ? 'design' : '', { dtick, range: [0.5, path.stages.length + 0.5] });
    layout[`yaxis${id}`] = axis(symbol, { nticks: 4 });
  });
  return { traces, layout };
}

async function showStage() {
  const k = Number(byId('stage').value);
  const stage = path?.stages[k];
  if (!stage) return;
  const n = stage.ranges.length;
  const [x, y] = ['factor-x', 'factor-y'].map((id, usual) => { const at = byId(id).selectedIndex; return at < 0 || at >= n ? usual : at; });
  const response = Number(byId('response').value);
  byId('stage-words').textContent = `${k + 1} of ${path.stages.length}, ${stage.window_s ? `the first ${stage.window_s} s` : 'the whole swing'}`;
  const seen = await get(`api/fit/surface?${new URLSearchParams({ stage: k, response, x, y })}`).catch((refusal) => { done(Promise.reject(refusal)); });
  if (!seen || Number(byId('stage').value) !== k) return;
  fillFactors(byId('factor-x'), seen.axes, x);
  fillFactors(byId('factor-y'), seen.axes, y);
  showSurface(seen, seen.axes, x, y, path.responses[response]);
  showTables(seen);
}

function fillFactors(select, symbols, usual) {
  if ([...select.options].map((option) => option.textContent).join() === symbols.join()) return;
  select.replaceChildren(...symbols.map((symbol) => element('option', {}, symbol)));
  select.selectedIndex = Math.min(usual, symbols.length - 1);
}

function showSurface(seen, symbols, x, y, name) {
  const dot = { x: [seen.chosen[x]], y: [seen.chosen[y]], mode: 'markers', type: 'scatter', marker: { size: 13, symbol: 'x', color: colours()[1], line: { width: 1 } }, name: 'chosen' };
  const runs = { x: seen.runs.map((run) => run[x]), y: seen.runs.map((run) => run[y]), mode: 'markers', type: 'scatter', marker: { size: 6, color: 'rgba(0,0,0,0)', line: { color: '#888', width: 1.5 } }, name: 'runs' };
  plot(byId('contour'), () => ({
    traces: [{ type: 'contour', x: seen.x, y: seen.y, z: seen.z, colorscale: rising(), colorbar: { ...bar(name), exponentformat: 'power' }, contours: { coloring: 'heatmap' }, line: { width: 0.7 }, name, showlegend: false }, runs, dot],
    layout: { xaxis: axis(symbols[x], { nticks: 6 }), yaxis: axis(symbols[y], { nticks: 6 }) },
  }));
  const side = (title) => ({ ...axis(title), nticks: 5, automargin: undefined });
  plot(byId('surface'), () => ({
    traces: [{ type: 'surface', x: seen.x, y: seen.y, z: seen.z, colorscale: rising(), showscale: false }],
    layout: { scene: { xaxis: side(symbols[x]), yaxis: side(symbols[y]), zaxis: side(name), camera: { eye: { x: -1.75, y: -1.75, z: 1.1 }, center: { x: 0, y: 0, z: -0.18 } } }, margin: { l: 0, r: 0, t: 0, b: 0 } },
  }));
  byId('optimizer').style.minWidth = `${OPTIMIZER_REM * symbols.length}rem`;
  byId('optimizer').style.height = `${6.2 * path.responses.length + 3}rem`;
  plot(byId('optimizer'), () => optimizerPlot(seen, symbols));
}

/** The lowest number of the upward axis stands in the corner, too. */
const BELOW_CORNER = { ticks: 'outside', ticklen: 7, tickcolor: 'rgba(0,0,0,0)' };

/** A narrower column would have its numbers in the one before it. */
const OPTIMIZER_REM = 10.5;

function optimizerPlot(seen, symbols) {
  const [rows, columns] = [path.responses.length, symbols.length];
  const traces = [];
  const layout = { grid: { rows, columns, pattern: 'independent', xgap: 0.28, ygap: 0.28 }, showlegend: false, shapes: [], margin: { l: 70, r: 12, t: 8, b: 44 } };
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const id = row * columns + column ? row * columns + column + 1 : '';
      const { x, y } = seen.optimizer[row][column];
      traces.push({ x, y, xaxis: `x${id}`, yaxis: `y${id}`, type: 'scatter', mode: 'lines', line: { color: colours()[0], width: 2 }, name: path.responses[row] });
      layout[`xaxis${id}`] = axis(row === rows - 1 ? symbols[column] : '', { nticks: 3, showticklabels: row === rows - 1, ...BELOW_CORNER });
      layout[`yaxis${id}`] = axis(column === 0 ? path.responses[row] : '', { nticks: 3, tickformat: '.4~g' });
      layout.shapes.push({ type: 'line', xref: `x${id}`, yref: `y${id} domain`, x0: seen.chosen[column], x1: seen.chosen[column], y0: 0, y1: 1, line: { color: colours()[1], width: 1.5, dash: 'dash' } });
    }
  }
  return { traces, layout };
}

/** `axis 1*axis 2` in the words of the axes. */
function termName(term, axes) {
  if (term === '1') return 'constant';
  const named = (_, number) => (axes[number - 1].includes(' ') ? `(${axes[number - 1]})` : axes[number - 1]);
  return term.replace(/axis (\d+)/g, named).replace('^2', '²').replace('*', ' · ');
}

function showTables(seen) {
  const p = (value) => (value === null ? '–' : value < 0.001 ? '< 0.001' : value.toFixed(3));
  fillTable(byId('coefficients'), ['Term', 'Estimate', 'Std error', 't', 'p (descriptive)'], seen.coefficients.map((one) =>
    [termName(one.name, seen.axes), number(one.estimate), number(one.standard_error, 3), number(one.t, 3), p(one.p)]));
  fillTable(byId('anova'), ['Source', 'df', 'Seq SS', 'Adj SS', 'Adj MS', 'F (descriptive)', 'p (descriptive)'], seen.anova.map((row) =>
    [row.source, row.dof, number(row.sequential_sum_of_squares), number(row.adjusted_sum_of_squares), number(row.mean_square), number(row.f), p(row.p)]));
  const share = (value) => (value === null ? '–' : `${(100 * value).toFixed(1)} %`);
  const g = seen.goodness;
  byId('goodness').textContent = `R² ${share(g.r_squared)}, adjusted ${share(g.r_squared_adjusted)}, predicted ${share(g.r_squared_predicted)}; PRESS ${number(g.press)}.`;
}
