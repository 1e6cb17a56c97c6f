// The kinds of section. A kind is an object
//   {command, kind?,                      which results it shows (without kind: all of the command)
//    title(result), short(result),        heading; entry of the table of contents
//    summary(result),                     one sentence for a machinist
//    facts(result),                       [[name, text]] in addition to the common ones
//    body(result),                        elements: tables and figure groups
//    weight?,                             place among the sections: 1 to 3, all others after them
//    overview?: {title, columns, row(result) or rows(result), onTop?}}
// and is registered with registerSection in a file of its own.

const sectionKinds = [];
const registerSection = (kind) => sectionKinds.push(kind);

const sectionKindOf = (result) => sectionKinds.find(
                                      (kind) => kind.command === result.command &&
                                          (kind.kind === undefined || kind.kind === result.kind)) ??
    unknownSection;

// Any other result: its numbers as they are.
const unknownSection = {
  title: (result) => [result.command, result.kind, result.axis].filter(Boolean).join(' \u00b7 '),
  short: (result) => [result.command, result.kind, result.axis].filter(Boolean).join(' '),
  summary: () => 'This page has no figures for this kind of result; its numbers are below, in SI ' +
      'units unless their name has another unit.',
  facts: () => [],
  body: (result) => [table({
    caption: 'All numbers of this result',
    compact: true,
    columns: [{head: 'Name'}, {head: 'Value', numeric: true}],
    rows: flatRows(result),
  })],
};

// [["errors.EAX.value", "61 numbers, -1.2e-5 to 3.4e-5"], ...]
function flatRows(value, path = '') {
  if (Array.isArray(value) && value.every((one) => one === null || typeof one === 'number')) {
    const known = numbers(value);
    return [[
      path,
      known.length > 4 ?
          `${value.length} numbers, ${plain(Math.min(...known))} to ${plain(Math.max(...known))}` :
          value.map(plain).join(', ')
    ]];
  }
  if (value !== null && typeof value === 'object') {
    return Object.entries(value).flatMap(
        ([key, inner]) => flatRows(inner, path ? `${path}.${key}` : key));
  }
  return [[path, typeof value === 'number' ? plain(value) : String(value)]];
}

const plain = (value) => value === null ?
    '\u2013' :
    String(Number(value.toPrecision(6))).replace(/^-/, MINUS).replace('e-', `e${MINUS}`);

// "21 Nov 2026, 09:00 UTC"
function dateText(started) {
  const date = new Date(started);
  if (Number.isNaN(date.getTime())) return started ?? '';
  const part = (options) => date.toLocaleString('en-GB', {timeZone: 'UTC', ...options});
  return `${part({day: 'numeric', month: 'short', year: 'numeric'})}, ` +
      `${part({hour: '2-digit', minute: '2-digit'})}\u00a0UTC`;
}

function durationText(seconds) {
  if (!isNumber(seconds)) return '';
  if (seconds < 90) return `${fixed(seconds, 0)}\u00a0s`;
  const minutes = Math.round(seconds / 60);
  return minutes < 90 ? `${minutes}\u00a0min` :
                        `${Math.floor(minutes / 60)}\u00a0h ${minutes % 60}\u00a0min`;
}

// "temp_column_c": {min, max, mean} -> ["Column", "20.1 to 20.4 degC"]
function temperatureFacts(conditions = {}) {
  return Object.entries(conditions).flatMap(([key, value]) => {
    const name = /^temp_(.+)_c$/.exec(key)?.[1];
    if (!name || !value) return [];
    const label = `Temperature, ${name.replaceAll('_', ' ')}`;
    const least = isNumber(value) ? value : value.min;
    const most = isNumber(value) ? value : value.max;
    if (!isNumber(least) || !isNumber(most)) return [];
    const text = fixed(most - least, 2) === '0.00' ? fixed(most, 2) :
                                                     `${fixed(least, 2)} to ${fixed(most, 2)}`;
    return [[label, `${text}\u00a0\u00b0C`]];
  });
}

// The facts that every result may have, around those of its kind.
function allFacts(facts, result, file) {
  const conditions = result.conditions ?? {};
  return [
    ['Machine', result.machine],
    ['Chain', result.chain],
    ...facts,
    ['Started', dateText(result.started)],
    ['Duration', durationText(conditions.duration_s)],
    [
      'Feed',
      isNumber(conditions.feed_mm_min) ? `${fixed(conditions.feed_mm_min, 0)}\u00a0mm/min` : null
    ],
    ...temperatureFacts(conditions),
    ['Recording', result.recording],
    ['Result file', file],
  ];
}
