// The section of a positioning test against a reference: ISO 230-2.

const ISO_230_2_FIGURES = [
  ['A_um', 'A', 'Bi-directional accuracy: systematic and random errors together'],
  ['R_um', 'R', 'Bi-directional repeatability: scatter of the returns to a target'],
  ['E_um', 'E', 'Bi-directional systematic error: range of the mean deviations of both directions'],
  ['M_um', 'M', 'Range of the mean of both directions: a compensation table can remove it'],
  ['B_um', 'B', 'Reversal: the largest difference between the two directions'],
  ['mean_reversal_um', 'mean B', 'Reversal, mean over the targets, with its sign'],
];
const micrometres = (value) => `${significant(value)}\u00a0\u00b5m`;

function referenceSummary(result) {
  const {A_um: A, M_um: M, mean_reversal_um: B} = result.iso230_2 ?? {};
  const axis = result.axis ?? 'The axis';
  const sentences = [];
  if (isNumber(A)) sentences.push(`${axis} positions within ${micrometres(A)} (accuracy A)`);
  if (isNumber(M) && isNumber(A)) {
    sentences.push(`${micrometres(M)} of it repeats in both directions (M) and can be compensated`);
  }
  if (isNumber(B))
    sentences.push(`forward and backward differ by ${micrometres(Math.abs(B))} on average`);
  return capital(sentences.join('; ')) + (sentences.length ? '.' : '');
}

function isoTable(result) {
  const figures = result.iso230_2 ?? {};
  const text = (key) => isNumber(figures[key]) ? significant(figures[key]) : null;
  const known = ISO_230_2_FIGURES.filter(([key]) => isNumber(figures[key]));
  const numeric = (head) => ({head, unit: '\u00b5m', numeric: true});
  return table({
    caption: `ISO\u00a0230-2 figures of ${result.axis ?? 'the axis'}`,
    columns: [
      {head: 'Figure'}, numeric('Both'), numeric('Forward'), numeric('Backward'), {head: 'Meaning'}
    ],
    rows: known.map(
        ([key, symbol, meaning]) =>
            [symbol, text(key), text(key.replace('_um', '_up_um')),
             text(key.replace('_um', '_down_um')), meaning]),
  });
}

// The targets as lists, in mm and um.
function targetsOf(result) {
  const targets = result.iso230_2?.targets ?? [];
  if (!targets.length) return null;
  const list = (key) => targets.map((target) => target[key] ?? null);
  return {
    x: list('target_mm'),
    forward: {mean: list('mean_up_um'), s: list('std_up_um')},
    backward: {mean: list('mean_down_um'), s: list('std_down_um')},
    both: list('mean_um'),
  };
}

function directionTraces(name, x, {mean, s}, colours, shown) {
  if (!shown.has(name) || !mean.length) return [];
  const symbol = name === 'forward' ? 'triangle-right' : 'triangle-left';
  return [
    shown.has('scatter') ?
        {...bandTrace(x, mean, s.map((one) => 2 * (one ?? 0)), colours[name]), opacity: 0.18} :
        null,
    lineTrace(
        name, x, mean, colours[name], '\u00b5m',
        {mode: 'lines+markers', marker: {symbol, size: 7, color: colours[name]}}),
  ].filter(Boolean);
}

function deviationGroup(result) {
  const targets = targetsOf(result);
  if (!targets) return null;
  const {x, forward, backward, both} = targets;
  return figureGroup({
    title: 'Deviation at the targets',
    intro:
        'Mean of the cycles in each direction; the bands are two standard deviations to each side. ' +
        'A is the height of everything shown.',
    items: [
      {key: 'forward', label: 'Forward', swatch: 'forward'},
      {key: 'backward', label: 'Backward', swatch: 'backward'},
      {key: 'mean', label: 'Mean of both', swatch: 'mean'},
      {key: 'scatter', label: '\u00b12\u2009s', swatch: 'band'},
    ],
    panels: [{
      name: 'Positional deviation',
      unit: '\u00b5m',
      height: 340,
      about:
          'Positional deviation at each target in micrometres, both directions with two standard ' +
          'deviations; the values follow as a table.',
      draw: (colours, shown) => ({
        data: [
          ...directionTraces('forward', x, forward, colours, shown),
          ...directionTraces('backward', x, backward, colours, shown),
          shown.has('mean') && both.length ?
              lineTrace(
                  'mean of both', x, both, colours.mean, '\u00b5m',
                  {line: {color: colours.mean, width: 2, dash: 'dash'}}) :
              null,
        ].filter(Boolean),
        layout: figureLayout(colours, {x: 'Target position (mm)'}),
      }),
      values: () => ({
        columns: ['Target, mm', 'Forward, \u00b5m', 's, \u00b5m', 'Backward, \u00b5m', 's, \u00b5m']
                     .map((head) => ({head, numeric: true})),
        rows: x.map(
            (at, index) =>
                [positionText(at),
                 ...[forward.mean, forward.s, backward.mean, backward.s].map(
                     (list) => fixed(list[index] ?? NaN, 1))]),
      }),
    }],
  });
}

registerSection({
  command: 'reduce',
  kind: 'reference',
  title: (result) => `${result.axis ? `${result.axis} axis: ` : ''}positioning`,
  short: (result) => `${result.axis ?? ''} positioning`.trim(),
  summary: referenceSummary,
  facts: (result) => [
      ['Axis', result.axis],
      ['Targets', targetsOf(result)?.x.length],
      ['Cycles', result.iso230_2?.cycles],
      [
        'Left out',
        result.iso230_2?.left_out_rows ? `${grouped(result.iso230_2.left_out_rows)} flagged rows` :
                                         null
      ],
],
  body: (result) => [isoTable(result), deviationGroup(result)].filter(Boolean),
  overview: {
    title: 'Positioning (ISO\u00a0230-2)',
    columns: [
      {head: 'Axis'},
      ...ISO_230_2_FIGURES.map(
          ([, symbol]) => ({head: capital(symbol), unit: '\u00b5m', numeric: true}))
    ],
    row: (result) =>
        [result.axis ?? '\u2013',
         ...ISO_230_2_FIGURES.map(
             ([key]) =>
                 isNumber(result.iso230_2?.[key]) ? significant(result.iso230_2[key]) : null)],
  },
});
