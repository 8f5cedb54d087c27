// The live view: points as they come, at most 20 drawings a second, a bounded stretch of them kept.

import { Chart } from './chart.js';
import { byId, element, number } from './numbers.js';
import { post } from './server.js';
import { onPage } from './words.js';

/** Points kept: a minute and a bit. */
const KEPT_S = 70;
const DRAW_EVERY_MS = 50;

const columns = ['t', 'measured', 'observed', 'rate', 'velocity', 'innovation', 'friction'];
export const kept = Object.fromEntries(columns.map((name) => [name, []]));
let drawnAt = 0;
let rig = {};
let charts = null;

function makeCharts() {
  const chart = (id, unit, scale, least, fixed) => Object.assign(new Chart(byId(id), { unit, scale, least }), { usual: fixed });
  return {
    angle: chart('live-angle', 'rad', 1, 0.01, [-2, 2]),
    velocity: chart('live-velocity', 'rad/s', 1, 0.05, [-15, 15]),
    innovation: chart('live-innovation', 'mrad', 1e3, 5e-4, [-0.05, 0.05]),
    friction: chart('live-friction', 'mN·m', 1e3, 5e-5, [-0.006, 0.006]),
  };
}

/** Live points from the server. */
export function take(message) {
  if (message.t[0] < kept.t[kept.t.length - 1]) columns.forEach((name) => { kept[name].length = 0; });
  for (const name of columns) kept[name].push(...message[name]);
  const old = kept.t.findIndex((t) => t > kept.t[kept.t.length - 1] - KEPT_S);
  // Trimmed in large pieces, so that little is moved.
  if (old > 2000) columns.forEach((name) => kept[name].splice(0, old));
  if (performance.now() - drawnAt >= DRAW_EVERY_MS) draw();
}

export function draw() {
  drawnAt = performance.now();
  if (byId('view-live').hidden || kept.t.length === 0) return;
  charts ??= makeCharts();
  const end = kept.t[kept.t.length - 1];
  const span = Number(byId('span').value);
  const from = Math.max(kept.t[0], end - span);
  const x = [from, from + span];
  const curve = (name, colour, label) => ({ x: kept.t, y: kept[name], colour, name: label, gap: 0.5 });
  const fixed = byId('fixed-scale').checked;
  for (const chart of Object.values(charts)) chart.fixed = fixed ? chart.usual : null;
  charts.angle.show([curve('measured', 'measured', 'measured'), { ...curve('observed', 'modelled', 'observed'), dash: [6, 4] }], x);
  charts.velocity.show([curve('rate', 'measured', 'measured'), { ...curve('velocity', 'modelled', 'observed'), dash: [6, 4] }], x);
  charts.innovation.show([curve('innovation', 'measured')], x);
  charts.friction.show([curve('friction', 'other')], x);
}

/** At once, for a printer. */
export function paint() { if (charts) Object.values(charts).forEach((chart) => chart.paint()); }

/** The rig's state. */
export function show(state) {
  rig = state.rig;
  const connected = rig.firmware !== null;
  byId('listen').disabled = !connected || rig.recording !== null;
  // The simulated pendulum is let go anew whenever it is listened to.
  const goesOn = rig.simulated ? 'Let go again' : 'Go on';
  byId('listen').textContent = rig.listening ? 'Pause' : goesOn;
  byId('again').hidden = !connected || !rig.simulated || !rig.listening || rig.recording !== null;
  byId('record').disabled = !connected;
  byId('record').textContent = rig.recording ? 'Stop recording' : 'Record a swing';
  const ports = byId('port');
  if (ports.options.length !== state.ports.length) {
    ports.replaceChildren(...state.ports.map((port) => element('option', {}, port)));
    if (rig.port) ports.value = rig.port;
  }
  const note = rig.failure ? `${rig.failure[0]}. Next: ${rig.failure[1] ?? 'connect again'}.`
    : rig.recording ?? rig.recorded ?? rig.note ?? (connected ? '' : 'No rig is connected. Choose one and connect; sim:… needs no hardware.');
  byId('live-note').textContent = onPage(note);
  byId('rig-state').textContent = rig.failure ? `rig lost: ${rig.port}`
    : connected ? `${rig.firmware} on ${rig.port}${rig.recording ? ', recording' : rig.listening ? ', live' : ', paused'}` : 'no rig connected';
  byId('connect').textContent = rig.failure ? 'Connect again' : 'Connect';
  byId('innovation').textContent = rig.innovation_rms_rad === null ? '–' : `${number(1e3 * rig.innovation_rms_rad, 3)} mrad`;
  for (const [id, key] of [['frames', 'frames'], ['frames-lost', 'frames_lost'], ['samples-lost', 'samples_lost'],
    ['frames-damaged', 'frames_damaged'], ['disconnected', 'disconnected']]) byId(id).textContent = rig[key];
}

export function begin(done) {
  byId('connect').addEventListener('click', () => done(post('api/rig/connect', { port: byId('port').value })));
  byId('listen').addEventListener('click', () => done(post(rig.listening ? 'api/rig/pause' : 'api/rig/listen')));
  byId('again').addEventListener('click', () => done(post('api/rig/listen')));
  byId('record').addEventListener('click', () => done(post(rig.recording ? 'api/rig/stop-recording' : 'api/rig/record')));
  byId('span').addEventListener('change', draw);
  byId('fixed-scale').addEventListener('change', draw);
}
