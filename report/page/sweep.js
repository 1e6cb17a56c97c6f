// The section of an axis sweep: what its five error motions come to, in words and as a table.

const errorsOf = (result) => Object.entries(result.errors ?? {});
const isAngular = (error) => error.unit === 'rad';
const angularOf = (result) => errorsOf(result).filter(([, error]) => isAngular(error));
const linearOf = (result) => errorsOf(result).filter(([, error]) => !isAngular(error));
const unitOf = (error) => shownUnit(error.unit);

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// "EYX" of a kind "straightness" -> "Straightness in Y"; "EAX", "roll" -> "Roll".
function componentName(component, error) {
  if (isAngular(error))
    return capital(error.kind ?? `rotation about ${'XYZ'['ABC'.indexOf(component[1])]}`);
  return component[1] === component[2] ? 'Positioning' : `Straightness in ${component[1]}`;
}

// Peak to peak in SI with its standard uncertainty.
function angularRange(result, component) {
  const given = result.angular_ranges?.[component];
  if (given) return {value: given.value, u: given.u};
  const error = result.errors[component];
  return {value: rangeOf(error.value), u: Math.SQRT2 * typical(error.u)};
}

function shownQuantity(value, u, unit, withUnit = false) {
  if (!isNumber(value)) return null;
  return quantity(value * unit.scale, COVERAGE * u * unit.scale, withUnit ? unit.name : '');
}

const isSignificant = (reversal) => isNumber(reversal.u) && reversal.max > COVERAGE * reversal.u;

function travelText(result) {
  const stations = numbers(result.stations);
  if (!stations.length) return '';
  const [first, last] = [Math.min(...stations), Math.max(...stations)];
  return `${positionText(first * 1e3)} to ${positionText(last * 1e3)}`;
}

function movesText(moves) {
  return {target: 'the target (table side)', head: 'the probe head (tool side)'}[moves] ?? moves;
}

function joinWords(words) {
  return words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words.at(-1)}`;
}

function bound(value, u, unit) {
  const text = rounded(value * unit.scale, COVERAGE * u * unit.scale);
  return `${text.value}\u00a0${unit.name}`;
}

// "Over 60 mm of travel, X rolls by 42 urad ... : at a point 100 mm away the roll alone shows as 4
// um."
function sweepSummary(result) {
  const travel = rangeOf(result.stations ?? []) * 1e3;
  const verbs = {roll: 'rolls', pitch: 'pitches', yaw: 'yaws'};
  const turns = angularOf(result).map(([component, error]) => {
    const {value, u} = angularRange(result, component);
    return {
      value,
      text: `${verbs[error.kind] ?? `turns (${component})`} by ${bound(value, u, unitOf(error))}`
    };
  });
  const bows = Object.entries(result.straightness ?? {})
                   .map(
                       ([component, one]) =>
                           `${bound(one.minimum_zone, one.u, SHOWN_UNITS.m)} in ${component[1]}`);
  const start = Number.isFinite(travel) ? `Over ${positionText(travel)}\u00a0mm of travel, ` : '';
  const sentences = [];
  if (turns.length)
    sentences.push(`${start}${result.axis} ${joinWords(turns.map((turn) => turn.text))}`);
  if (bows.length) sentences.push(`Its path is straight within ${joinWords(bows)} (minimum zone)`);
  if (turns.length) {
    const most = Math.max(...turns.map((turn) => turn.value));
    sentences.push(
        `${
            turns.length > 1 ? 'The largest of these rotations' :
                               'This rotation'} alone moves a point ` +
        '100\u00a0mm away by ' +
        `${significant(most * 0.1 * 1e6, 2)}\u00a0\u00b5m`);
  }
  sentences.push(...reversalSentence(result));
  return capital(sentences.map((sentence) => `${sentence}.`).join(' '));
}

function reversalSentence(result) {
  const reversals = Object.entries(result.reversal ?? {});
  if (!reversals.length) return [];
  const seen = reversals.filter(([, reversal]) => isSignificant(reversal));
  if (!seen.length) return ['Forward and backward travel agree within the uncertainty'];
  return [
    'Forward and backward travel differ by up to ' +
    joinWords(seen.map(
        ([component, reversal]) => `${
            bound(reversal.max, reversal.u, unitOf(result.errors?.[component] ?? {unit: 'm'}))} (${
            component})`))
  ];
}

const reversalCells = (reversal, unit) => reversal ?
    [
      shownQuantity(reversal.mean, reversal.u, unit), shownQuantity(reversal.max, reversal.u, unit)
    ] :
    [null, null];

function stationUncertainty(error) {
  const U = COVERAGE * typical(error.u) * unitOf(error).scale;
  return fixed(U, placesFor(U, 2));
}

// One table for the rotations, one for the straightnesses: each with its own figures and unit.
function componentTable(result, caption, found, heads, cells) {
  const unit = unitOf(found[0][1]);
  const numeric = (head) => ({head, unit: unit.name, numeric: true});
  return table({
    caption,
    columns: [
      {head: 'Component'}, ...heads.map(numeric), numeric('Reversal, mean'),
      numeric('Reversal, max.'),
      {...numeric(element('span', {}, symbolU95(), ' of a station')), label: 'U95 of a station'}
    ],
    rows: found.map(
        ([component, error]) =>
            [element('span', {}, `${componentName(component, error)} `, code(component)),
             ...cells(component, unit), ...reversalCells(result.reversal?.[component], unit),
             stationUncertainty(error)]),
  });
}

function sweepTables(result) {
  const [turns, bows] = [angularOf(result), linearOf(result)];
  const range = (component, unit) => {
    const {value, u} = angularRange(result, component);
    return [shownQuantity(value, u, unit)];
  };
  const widths = (component, unit) => {
    const one = result.straightness?.[component] ?? {};
    return STRAIGHTNESS_LINES.map(({key}) => shownQuantity(one[key], one.u, unit));
  };
  return [
    turns.length ? componentTable(result, 'Rotations', turns, ['Range'], range) : null,
    bows.length ?
        componentTable(
            result, 'Straightness', bows, STRAIGHTNESS_LINES.map(({label}) => label), widths) :
        null,
  ].filter(Boolean);
}

function sampleText(samples) {
  if (!samples || !isNumber(samples.used)) return null;
  const left = [['moving', 'between stations'], ['flagged', 'flagged'], ['outliers', 'outliers']]
                   .filter(([key]) => samples[key] > 0)
                   .map(([key, name]) => `${grouped(samples[key])} ${name}`);
  return `${grouped(samples.used)} of ${grouped(samples.rows)} used` +
      (left.length ? ` (left out: ${left.join(', ')})` : '');
}

const grouped = (count) =>
    isNumber(count) ? String(count).replace(/\B(?=(\d{3})+$)/g, THIN_SPACE) : '\u2013';

function overviewCell(result, [component, error], value, u) {
  return element(
      'span', {class: 'stacked'}, shownQuantity(value, u, unitOf(error)), code(component));
}

function sweepOverviewRow(result) {
  const byKind = (kind) => angularOf(result).find(([, error]) => error.kind === kind);
  const turn = (kind) => {
    const found = byKind(kind);
    if (!found) return null;
    const {value, u} = angularRange(result, found[0]);
    return overviewCell(result, found, value, u);
  };
  const straight = linearOf(result)
                       .filter(([component]) => result.straightness?.[component])
                       .map(
                           (found) => overviewCell(
                               result, found, result.straightness[found[0]].minimum_zone,
                               result.straightness[found[0]].u));
  const reversals = Object.entries(result.reversal ?? {});
  const seen = reversals.filter(([, reversal]) => isSignificant(reversal)).map(([name]) => name);
  return [
    result.axis, travelText(result), turn('roll'), turn('pitch'), turn('yaw'), straight[0],
    straight[1], reversals.length ? seen.join(', ') || 'none' : null
  ];
}

const filled = (value) => value && Object.keys(value).length > 0;

function sweepFigures(result) {
  return [
    filled(result.errors) ? motionGroup(result) : null,
    filled(result.straightness_lines) ? straightnessGroup(result) : null,
    filled(result.reversal) ? reversalGroup(result) : null,
    filled(result.budget) ? budgetGroup(result) : null,
    filled(result.residuals) || filled(result.noise) ? quietGroup(result) : null,
  ].filter(Boolean);
}

registerSection({
  command: 'reduce',
  kind: 'sweep',
  title: (result) => `${result.axis} axis`,
  short: (result) => `${result.axis} axis`,
  summary: sweepSummary,
  facts: (result) => [
      ['Axis', result.axis],
      ['Moving body', movesText(result.moves)],
      [
        'Stations',
        numbers(result.stations).length ?
            `${result.stations.length}, ${travelText(result)}\u00a0mm` :
            null
      ],
      ['Passes', isNumber(result.passes) ? `${result.passes}, both directions` : null],
      ['Samples', sampleText(result.samples), true],
],
  body: (result) => [...sweepTables(result), ...sweepFigures(result)],
  overview: {
    title: 'Axes',
    columns: [
      {head: 'Axis'},
      {head: 'Travel', unit: 'mm', numeric: true},
      {head: 'Roll', unit: '\u00b5rad', numeric: true},
      {head: 'Pitch', unit: '\u00b5rad', numeric: true},
      {head: 'Yaw', unit: '\u00b5rad', numeric: true},
      {head: 'Straightness', label: 'Straightness', unit: '\u00b5m', numeric: true},
      {head: 'Straightness', label: 'Straightness', unit: '\u00b5m', numeric: true},
      {head: 'Reversal seen in', numeric: true},
    ],
    row: sweepOverviewRow,
  },
});
