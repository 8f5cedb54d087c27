// Talks to the server: requests, and one socket that brings the state, progress and live points.

/** What the server answered when it could not do something: what happened, and what to do next. */
export class Refusal extends Error {
  constructor(what, next, status) { super(what); Object.assign(this, { next, status }); }
}

async function answered(response) {
  if (response.ok) return response.status === 204 ? null : response.json();
  let body = {};
  try { body = await response.json(); } catch { /* not from us */ }
  throw new Refusal(body.what ?? `the server answered ${response.status}`, body.next, response.status);
}

async function ask(path, options) {
  let response;
  try { response = await fetch(path, options); } catch {
    throw new Refusal('the program does not answer', 'start it again, then reload this page');
  }
  return answered(response);
}

export const get = (path) => ask(path);
export const post = (path, value = {}) =>
  ask(path, { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(value) });
export const remove = (path) => ask(path, { method: 'DELETE' });
export const send = (path, file, wish = {}) =>
  ask(`${path}?${new URLSearchParams({ name: file.name, ...wish })}`, { method: 'POST', body: file });

/** Listens for ever; calls `heard(message)` for each message and `lost()` when the program is gone. */
export function listen(heard, lost) {
  const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/events`);
  socket.onmessage = (event) => heard(JSON.parse(event.data));
  socket.onclose = () => { lost(); setTimeout(() => listen(heard, lost), 1000); };
}
