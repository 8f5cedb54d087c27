// Puts the page together: tabs, theme, uploads, progress, failures; each view is a file of its own.

import * as columns from './columns.js';
import * as compare from './compare.js';
import * as discover from './discover.js';
import * as evidence from './evidence.js';
import * as fit from './fit.js';
import * as live from './live.js';
import * as rig from './rig.js';
import { byId } from './numbers.js';
import { fitToPaper, redrawAll } from './plots.js';
import { get, listen, post, send } from './server.js';
import { onPage } from './words.js';

const TABS = ['model', 'live', 'fit'];
let state = null;

/** Waits for what was asked; tells why it could not be done. */
function done(promise) {
  return promise.then(
    (value) => { if (toldHere) byId('failure').hidden = true; toldHere = false; return value; },
    (refusal) => { fail(refusal.message, refusal.next); toldHere = true; },
  );
}

/** Is what is shown the answer to something that was asked in this tab? Then a later success ends it. */
let toldHere = false;

function fail(what, next) {
  // Below it may stand a formula with a mark under the place that is wrong.
  const [first, ...place] = onPage(what).split('\n');
  byId('failure-what').textContent = first;
  byId('failure-place').textContent = place.join('\n');
  byId('failure-next').textContent = next ? `Next: ${onPage(next)}.` : '';
  byId('failure').hidden = false;
}

function hear(message) {
  if (message.type === 'live') live.take(message);
  else if (message.type === 'job') showJob(message.job);
  else if (message.type === 'state') {
    const isFirst = state === null;
    state = message;
    // Without a name in the address the page opens with the rig, if there is nothing else.
    if (isFirst && !namedTab()) openTab(state.begins_live ? 'live' : 'model'); else show();
  }
}

let told = null;
function show() {
  for (const view of [compare, discover, evidence, fit, live, rig]) view.show(state);
  const failure = JSON.stringify(state.failure);
  if (state.failure && failure !== told) fail(state.failure.what, state.failure.next);
  if (!state.failure && told !== 'null' && told !== null) byId('failure').hidden = true;
  told = failure;
  document.body.dataset.ready = 'true';
}

let doing = null;
function showJob(job) {
  byId('job').hidden = job === null;
  const isNews = document.body.dataset.busy !== String(job !== null);
  document.body.dataset.busy = String(job !== null);
  if (isNews && state) compare.showVerdict();
  if (job?.name !== doing) byId('job-waits').textContent = '';
  doing = job?.name;
  if (!job) return;
  const bar = byId('job-bar');
  if (job.share === null) bar.removeAttribute('value'); else bar.value = Math.max(job.share, 0.02);
  const count = job.simulations ? `, ${job.simulations} swings simulated` : '';
  byId('job-words').textContent = `${job.words || job.name} … ${job.seconds.toFixed(0)} s${count}`;
}

const namedTab = () => TABS.find((tab) => location.hash === `#${tab}`);

function openTab(name) {
  for (const tab of TABS) {
    const here = tab === name;
    byId(`view-${tab}`).hidden = !here;
    byId(`tab-${tab}`).setAttribute('aria-selected', String(here));
    byId(`tab-${tab}`).tabIndex = here ? 0 : -1;
  }
  history.replaceState(null, '', `/#${name}`);
  if (state) show();
  live.draw();
  compare.redraw();
}

function beginTabs() {
  for (const tab of TABS) {
    byId(`tab-${tab}`).addEventListener('click', () => openTab(tab));
    byId(`tab-${tab}`).addEventListener('keydown', (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const next = TABS[(TABS.indexOf(tab) + step + TABS.length) % TABS.length];
      openTab(next);
      byId(`tab-${next}`).focus();
    });
  }
  if (namedTab()) openTab(namedTab());
}

function beginTheme() {
  const root = document.documentElement;
  const wish = window.matchMedia('(prefers-color-scheme: dark)');
  const use = (theme) => { root.dataset.theme = theme; redrawAll(); compare.redraw(); live.draw(); };
  use(localStorage.getItem('theme') ?? (wish.matches ? 'dark' : 'light'));
  wish.addEventListener('change', () => { if (!localStorage.getItem('theme')) use(wish.matches ? 'dark' : 'light'); });
  byId('theme').addEventListener('click', () => {
    const theme = root.dataset.theme === 'dark' ? 'light' : 'dark';
    localStorage.setItem('theme', theme);
    use(theme);
  });
}

/** On paper all is light, and as wide as the paper. */
function beginPrinting() {
  const root = document.documentElement;
  let onScreen = null;
  const use = (theme) => { root.dataset.theme = theme; redrawAll(); compare.paint(); live.paint(); };
  window.addEventListener('beforeprint', () => {
    onScreen = root.dataset.theme;
    if (onScreen === 'dark') use('light');
    fitToPaper();
  });
  window.addEventListener('afterprint', () => { if (onScreen === 'dark') use('dark'); });
}

async function upload(files) {
  for (const file of files) {
    if (file.name.endsWith('.toml')) await done(send('api/model', file));
    else await done(columns.load(file));
  }
}

function beginUploads() {
  byId('upload').addEventListener('change', (event) => { upload([...event.target.files]).then(() => { event.target.value = ''; }); });
  const isFiles = (event) => event.dataTransfer?.types.includes('Files');
  document.addEventListener('dragover', (event) => { if (isFiles(event)) { event.preventDefault(); document.body.classList.add('dropping'); } });
  document.addEventListener('dragleave', (event) => { if (!event.relatedTarget) document.body.classList.remove('dropping'); });
  document.addEventListener('drop', (event) => {
    if (!isFiles(event)) return;
    event.preventDefault();
    document.body.classList.remove('dropping');
    upload([...event.dataTransfer.files]);
  });
}

async function begin() {
  beginTheme();
  const effects = await get('api/effects');
  compare.begin(done, effects);
  discover.begin(done, effects);
  evidence.begin(done, effects);
  for (const view of [columns, fit, live, rig]) view.begin(done);
  beginUploads();
  byId('failure-close').addEventListener('click', () => { byId('failure').hidden = true; done(post('api/dismiss')); });
  beginTabs();
  beginPrinting();
  let isLost = false;
  const heard = (message) => {
    if (isLost) byId('failure').hidden = true;
    isLost = false;
    hear(message);
  };
  listen(heard, () => {
    isLost = true;
    byId('rig-state').textContent = 'no connection to the program';
    fail('The connection to the program is gone', 'start it again; this page connects by itself');
  });
}

done(begin());
