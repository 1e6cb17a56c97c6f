// The section of an axis sweep: its five error motions in words and as a table.

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

// The coverage factor of U95: Student's t for a component with few degrees of freedom.
const coverageOf = (error) => error.coverage ?? COVERAGE;

// An uncertain number is {value, u}, in SI; a plain number has its own `u`.
const uncertain = (given, u) => isNumber(given) ? {value: given, u: typical(u)} : given ?? {};

// Peak to peak.
function angularRange(result, component) {
  const error = result.errors[component];
  return result.angular_ranges?.[component] ??
      {value: rangeOf(error.value), u: Math.SQRT2 * typical(error.u)};
}

const straightnessAbout = (result, component, line) => {
  const one = result.straightness?.[component];
  return uncertain(one?.[line], one?.u);
};
const meanReversal = ([, reversal]) => uncertain(reversal.mean, reversal.u);
const largestReversal = ([, reversal]) => uncertain(reversal.max, reversal.u);

function shownQuantity({value, u}, error) {
  if (!isNumber(value)) return null;
  const {scale} = unitOf(error);
  return quantity(value * scale, coverageOf(error) * u * scale);
}

// The components with a significant mean reversal, according to the result; in an older result
// according to U95. The mean decides, not the largest value: some of many stations exceed U95 by
// chance.
const seenReversals = (result) =>
    Object.entries(result.reversal ?? {}).filter(([component, one]) => {
      if (typeof one.seen === 'boolean') return one.seen;
      const {value, u} = meanReversal([component, one]);
      return Math.abs(value) > coverageOf(result.errors?.[component] ?? {}) * u;
    });

function travelText(result) {
  const stations = numbers(result.stations);
  if (!stations.length) return '';
  const [first, last] = [Math.min(...stations), Math.max(...stations)];
  // To the micrometre: the last digits of a scale fluctuate.
  const text = (position) => positionText(Number((position * 1e3).toFixed(3)));
  return `${text(first)} to ${text(last)}`;
}

function movesText(moves) {
  return {target: 'the target (table side)', head: 'the probe head (tool side)'}[moves] ?? moves;
}

function joinWords(words) {
  return words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words.at(-1)}`;
}

function inWords({value, u}, error) {
  const {scale, name} = unitOf(error);
  return `${rounded(Math.abs(value) * scale, coverageOf(error) * u * scale).value}\u00a0${name}`;
}

const TURN_VERBS = {
  roll: 'rolls',
  pitch: 'pitches',
  yaw: 'yaws'
};

// "Over 60 mm of travel, X rolls by 42 urad and pitches by 31 urad. Its path is straight within
// ..."
function sweepSummary(result) {
  const sentences = [
    turnSentence(result), straightSentence(result), leverSentence(result), reversalSentence(result),
    result.simulated ? 'The readings are simulated: no machine was measured' : null
  ];
  return sentences.filter(Boolean).map((sentence) => `${capital(sentence)}.`).join(' ');
}

function turnSentence(result) {
  const turns = angularOf(result).map(([component, error]) => {
    const verb = TURN_VERBS[error.kind] ?? `turns (${component})`;
    return `${verb} by ${inWords(angularRange(result, component), error)}`;
  });
  const travel = rangeOf(result.stations) * 1e3;
  const start = Number.isFinite(travel) ? `Over ${positionText(travel)}\u00a0mm of travel, ` : '';
  return turns.length ? `${start}${result.axis} ${joinWords(turns)}` : null;
}

function straightSentence(result) {
  const bows = linearOf(result).filter(([component]) => result.straightness?.[component]);
  const widths = bows.map(([component, error]) => {
    const width = straightnessAbout(result, component, 'minimum_zone');
    return `${inWords(width, error)} in ${component[1]}`;
  });
  return widths.length ? `Its path is straight within ${joinWords(widths)} (minimum zone)` : null;
}

function leverSentence(result) {
  const ranges = angularOf(result).map(([component]) => angularRange(result, component).value);
  if (!ranges.length) return null;
  const which = ranges.length > 1 ? 'The largest of these rotations' : 'This rotation';
  const effect = significant(Math.max(...ranges) * 0.1 * 1e6, 2);
  return `${which} alone moves a point 100\u00a0mm away by ${effect}\u00a0\u00b5m`;
}

function reversalSentence(result) {
  if (!filled(result.reversal)) return null;
  const seen = seenReversals(result).map(
      ([component, one]) =>
          `${inWords(meanReversal([component, one]), result.errors[component])} (${component})`);
  return seen.length ? `Forward and backward travel differ on average by ${joinWords(seen)}` :
                       'Forward and backward travel agree within the uncertainty';
}

function stationUncertainty(error) {
  const U = coverageOf(error) * typical(error.u) * unitOf(error).scale;
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
    rows: found.map(([component, error]) => {
      const reversal = [component, result.reversal?.[component] ?? {}];
      const shown = [...cells(component), meanReversal(reversal), largestReversal(reversal)];
      return [
        element('span', {}, `${componentName(component, error)} `, code(component)),
        ...shown.map((one) => shownQuantity(one, error)), stationUncertainty(error)
      ];
    }),
  });
}

function sweepTables(result) {
  const [turns, bows] = [angularOf(result), linearOf(result)];
  const lines = STRAIGHTNESS_LINES.map(({label}) => label);
  const widths = (component) =>
      STRAIGHTNESS_LINES.map(({key}) => straightnessAbout(result, component, key));
  return [
    turns.length ? componentTable(
                       result, 'Rotations', turns, ['Range'],
                       (component) => [angularRange(result, component)]) :
                   null,
    bows.length ? componentTable(result, 'Straightness', bows, lines, widths) : null,
  ].filter(Boolean);
}

function sampleText(samples) {
  if (!samples || !isNumber(samples.used)) return null;
  const parts = [
    ['moving', 'between stations'], ['flagged', 'flagged'],
    ['outliers', 'outliers with less weight']
  ];
  return [
    `${grouped(samples.used)} of ${grouped(samples.rows)} used`,
    ...parts.filter(([key]) => samples[key] > 0).map(([key,
                                                       name]) => `${grouped(samples[key])} ${name}`)
  ].join(', ');
}

const grouped = (count) =>
    isNumber(count) ? String(count).replace(/\B(?=(\d{3})+$)/g, THIN_SPACE) : '\u2013';

function overviewCell(component, error, one) {
  return element('span', {class: 'stacked'}, shownQuantity(one, error), code(component));
}

function sweepOverviewRow(result) {
  const turn = (kind) =>
      angularOf(result)
          .filter(([, error]) => error.kind === kind)
          .map(([component,
                 error]) => overviewCell(component, error, angularRange(result, component)))[0];
  const straight =
      linearOf(result)
          .filter(([component]) => result.straightness?.[component])
          .map(
              ([component, error]) => overviewCell(
                  component, error, straightnessAbout(result, component, 'minimum_zone')));
  const seen = seenReversals(result).map(([component]) => component).join(', ');
  return [
    result.axis, travelText(result), turn('roll'), turn('pitch'), turn('yaw'), straight[0],
    straight[1], filled(result.reversal) ? seen || 'none' : null
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
      ['Passes', result.passes],
      ['Mounting', result.mounting],
      ['Samples', sampleText(result.samples), true],
],
  body: (result) =>
      [notesBlock('Notes', result.notes), ...sweepTables(result), ...sweepFigures(result)],
  overview: {
    title: 'Axes',
    columns: [
      {head: 'Axis'},
      {head: 'Travel', unit: 'mm', numeric: true},
      {head: 'Roll', unit: '\u00b5rad', numeric: true},
      {head: 'Pitch', unit: '\u00b5rad', numeric: true},
      {head: 'Yaw', unit: '\u00b5rad', numeric: true},
      {head: 'Straightness', unit: '\u00b5m', numeric: true},
      {head: 'Straightness', unit: '\u00b5m', numeric: true},
      {head: 'Reversal seen in', numeric: true},
    ],
    row: sweepOverviewRow,
  },
});
