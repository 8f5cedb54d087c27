// Writing the model to the rig: old and new side by side, and only after a yes.

import { byId, element, fillTable, number } from './numbers.js';
import { get, post } from './server.js';

let done = () => {};
let typed = null;

export function begin(report) {
  done = report;
  byId('push').addEventListener('click', () => done(openPush()));
  byId('push-no').addEventListener('click', () => byId('push-dialog').close());
  byId('push-yes').addEventListener('click', () => {
    byId('push-dialog').close();
    done(post('api/rig/push'));
  });
}

export function show(state) {
  typed = state.model?.typed ?? null;
  byId('push').disabled = !state.model || state.rig.firmware === null || state.rig.recording !== null;
  byId('push').title = state.rig.firmware === null ? 'connect a rig on the live view first' : '';
}

/** Asks whether the rig is to have this model, with the numbers of both. */
export async function openPush() {
  const values = await get('api/rig/values');
  const cell = (value, changed) => element('td', changed ? { class: 'changed' } : {}, value === null ? 'absent' : number(value, 5));
  const differs = (one) => one.old === null || one.new === null || Math.abs(one.old - one.new) > 1e-6 * Math.abs(one.old);
  fillTable(byId('push-table'), ['Number', 'On the rig', 'New', 'Unit', 'Of'], values.map((one) =>
    [one.symbol, cell(one.old, false), cell(one.new, differs(one)), one.unit === '1' ? '' : one.unit, one.name]));
  byId('push-typed').hidden = typed === null;
  byId('push-typed').textContent = `The law that was typed goes with it, and the rig runs it like any other: ${typed}.`;
  byId('push-dialog').showModal();
}
