// Messages are the same everywhere; what they say of the command line is said of this page here.

const SAID_HERE = [
  [/\(host diagnose names it\)/g, '(“Find out” on the Model view names it)'],
  [/`?host diagnose`? says/g, '“Find out” on the Model view says'],
  [/(?:take it out with|take the formula out: host improve …) --remove (\S+)/g, 'click “remove” beside $1'],
  [/set `(\w+) = ([^`]+)` in rig\.toml(.*?), or give `host init` that \w+/g, 'give $2 as the $1$3'],
];

/** The same message for somebody who has no command line. */
export const onPage = (message) => SAID_HERE.reduce((words, [there, here]) => words.replace(there, here), message);

/** Less would no longer say what is wrong. */
const LEAST_LETTERS = 20;

/** A message up to its first option of the command line, and how the page says the rest. */
export function withoutOptions(message, instead) {
  const option = message.search(/--[a-z]/);
  if (option < 0) return message;
  const kept = message.slice(0, option).replace(/[:;,.(](?:(?![:;,.(]).)*$/s, '');
  return kept.length < LEAST_LETTERS ? message : `${kept}. ${instead}`;
}
