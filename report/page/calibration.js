// The section of a calibration of the linkage: errors before and after, residuals of each pose,
// parameters, combinations that the data do not determine, and the cells of a mapping.

const DISTANCES = [
  ['before', 'Nominal linkage, displacements'],
  ['after', 'Calibrated'],
  ['held_out', 'Calibrated, held-out poses'],
];
const CALIBRATION_SHOWN = 8;  // rows of a list that may be long before it is folded

const length3 = (vector) => vector?.every(isNumber) ? Math.hypot(...vector) : null;

function calibrationSummary(result) {
  const {before, after, held_out: held, combinations, combinations_seen: seen} = result;
  const sentences = [];
  const now = isNumber(held?.rms_um) ? held : after;
  if (isNumber(before?.rms_um) && isNumber(now?.rms_um)) {
    sentences.push(
        `The linkage was off by ${
            micrometres(before.rms_um)} (rms in space); calibrated it is off ` +
        `by ${micrometres(now.rms_um)}` + (now === held ? ' at held-out poses.' : '.'));
  }
  if (isNumber(seen)) {
    sentences.push(
        `The data see ${seen} of ${combinations} combinations of its parameters; the others stay ` +
        'as uncertain as their tolerances.');
  }
  return sentences.join(' ');
}

function distanceTable(result) {
  const numeric = (head) => ({head, unit: '\u00b5m', numeric: true});
  return table({
    caption: 'Distance of the ball from the reference, in space',
    columns: [{head: 'Linkage'}, numeric('Root mean square'), numeric('Largest')],
    rows: DISTANCES.filter(([key]) => isNumber(result[key]?.rms_um))
              .map(([
                     key, name
                   ]) => [name, significant(result[key].rms_um), significant(result[key].max_um)]),
  });
}

// Distances at each pose, in the order of time.
function poseResidualPanel(name, about, curves, result) {
  const poses = result.residuals.map((unused, index) => index + 1);
  return {
    name,
    unit: '\u00b5m',
    height: 240,
    about,
    draw: (colours, shown) => ({
      data: curves.filter(([key]) => key === 'before_um' || shown.has(key))
                .map(
                    ([key, label, colour]) => lineTrace(
                        label, poses, result.residuals.map((one) => length3(one[key])),
                        colours[colour], '\u00b5m', {
                          mode: 'markers',
                          marker: {
                            size: 4,
                            color: colours[colour],
                            symbol: key === 'held_out_um' ? 'diamond-open' : 'circle'
                          }
                        })),
      layout: figureLayout(colours, {x: 'Pose', yaxis: {rangemode: 'tozero'}}),
    }),
    values: () => ({
      columns: [
        {head: 'Recording'}, {head: 'Row', numeric: true},
        ...['X', 'Y', 'Z'].map((axis) => ({head: axis, unit: 'mm', numeric: true})),
        ...curves.map(([, label]) => ({head: capital(label), unit: '\u00b5m', numeric: true}))
      ],
      rows: result.residuals.map(
          (one) =>
              [one.recording.split('/').at(-1), String(one.row),
               ...one.position_mm.map((at) => fixed(at, 3)),
               ...curves.map(([key]) => fixed(length3(one[key]), 3))]),
    }),
  };
}

function poseResidualGroup(result) {
  if (!result.residuals?.length) return null;
  const items = [
    {key: 'gap_um', label: 'Calibrated', swatch: 'mean'},
    {key: 'held_out_um', label: 'Held out', swatch: 'backward'},
  ];
  const known = items.filter(({key}) => result.residuals.some((one) => length3(one[key]) !== null));
  const panels = [
    poseResidualPanel(
        'Before', 'Distance of the ball from the reference at each pose, nominal linkage.',
        [['before_um', 'before', 'muted']], result),
    poseResidualPanel(
        'After',
        'Distance of the ball from the reference at each pose, calibrated, and held ' +
            'out.',
        [['gap_um', 'calibrated', 'mean'], ['held_out_um', 'held out', 'backward']], result),
  ];
  return figureGroup({
    title: 'Residuals of each pose',
    intro:
        'Distances in space. Before: the nominal linkage with its base registered. Held out: the ' +
        'pose and its neighbours in time were held out, as in a new measurement.',
    items: known,
    panels: result.residuals.some((one) => length3(one.before_um) !== null) ? panels :
                                                                              panels.slice(1),
  });
}

const folded = (rows, summary, content) => rows.length <= CALIBRATION_SHOWN ?
    content :
    element('details', {class: 'values group'}, element('summary', {}, summary), content);

const parameterColumns = [
  {head: 'Parameter'}, {head: 'Value', numeric: true}, {head: 'Unit'},
  {head: 'Nominal', numeric: true}, {head: 'Tolerance', numeric: true}
];

function parameterTable(caption, parameters) {
  if (!parameters.length) return null;
  return table({
    caption,
    columns: parameterColumns,
    rows: parameters.map(
        ({name, value, uncertainty, unit, nominal, prior}) =>
            [code(name), quantity(value, COVERAGE * uncertainty), unitText(unit),
             positionText(nominal), isNumber(prior) ? significant(prior, 2) : 'free']),
  });
}

function parameterTables(result) {
  const all = result.parameters ?? [];
  const told = all.filter((one) => one.seen_by === 'data');
  const rest = all.filter((one) => one.seen_by !== 'data');
  return [
    parameterTable('Parameters determined by the data, with their expanded uncertainty', told),
    rest.length ? folded(
                      rest, `${rest.length} parameters limited by their tolerance`,
                      parameterTable('Parameters limited by their tolerance', rest)) :
                  null,
  ];
}

function unseenTable(result) {
  const unseen = result.unseen ?? [];
  if (!unseen.length) return null;
  const content = table({
    caption: 'Combinations that the data do not determine, in units of the tolerances',
    columns: [{head: 'Combination'}, {head: 'Left of its tolerance', unit: '%', numeric: true}],
    rows: unseen.map(
        ({words,
          share_of_prior: share}) => [words, isNumber(share) ? fixed(100 * share, 0) : null]),
  });
  return folded(unseen, `${unseen.length} combinations that the data do not determine`, content);
}

// Cell centres in mm, in the order of the cells (z fastest).
const cellCentres = ([xs, ys, zs]) =>
    xs.flatMap((x) => ys.flatMap((y) => zs.map((z) => [x, y, z].map((at) => at * 1e3))));

// The edges of the box around the centres, in mm, with a gap (NaN) after each.
function boxEdges(grid) {
  const ends = grid.map((list) => [Math.min(...list) * 1e3, Math.max(...list) * 1e3]);
  const corner = (bits) => ends.map((pair, axis) => pair[bits >> axis & 1]);
  return [0, 1, 2, 3, 4, 5, 6, 7].flatMap(
      (bits) => [0, 1, 2]
                    .filter((axis) => !(bits >> axis & 1))
                    .flatMap((axis) => [corner(bits), corner(bits | 1 << axis), [NaN, NaN, NaN]]));
}

function cellGroup(result) {
  const {centres_m: grid, shifts_um: shifts} = result.mapped ?? {};
  if (!grid || !shifts?.length) return null;
  const centres = cellCentres(grid);
  const ends = [0, 1, 2].map((axis) => rangeOf(centres.map((at) => at[axis])));
  const middle = [0, 1, 2].map((axis) => {
    const all = centres.map((at) => at[axis]);
    return (Math.min(...all) + Math.max(...all)) / 2;
  });
  const size = Math.max(0.5, ...ends) / 2;  // mm
  const span = 2.4 * size;
  const most = Math.max(1e-3, ...shifts.map((one) => length3(one) ?? 0));  // um
  const lists = (rows) => [0, 1, 2].map((axis) => rows.map((one) => one[axis] - middle[axis]));
  const panel = {
    name: 'Cells',
    unit: '\u00b5m',
    height: 460,
    about:
        'The centres of the mapping cells in space, each with the shift of the ball by its own ' +
        'parameters, magnified; the values follow as a table.',
    draw: (colours, shown, amount) => {
      const [x, y] = isometric(lists(centres));
      const tips =
          centres.map((at, i) => at.map((one, axis) => one + amount * shifts[i][axis] * 1e-3));
      const [tx, ty] = isometric(lists(tips));
      const stems = (from, to) => from.flatMap((at, i) => [at, to[i], null]);
      return {
        data: [
          {
            ...lineTrace('box', ...isometric(lists(boxEdges(grid))), colours.line, ''),
            line: {color: colours.line, width: 1},
            hoverinfo: 'skip',
            hovertemplate: null
          },
          {
            ...lineTrace('shift', stems(x, tx), stems(y, ty), colours.mean, ''),
            hoverinfo: 'skip',
            hovertemplate: null
          },
          {
            ...lineTrace('cell', x, y, colours.axis, ''),
            mode: 'markers',
            marker: {size: 4, color: colours.muted},
            text: shifts.map((one) => `${one.map((at) => fixed(at, 2)).join(', ')}\u00a0\u00b5m`),
            hovertemplate: '%{text}',
          },
        ],
        layout:
            squareLayout(colours, span, {annotations: spaceAxes(['X', 'Y', 'Z'], span, colours)}),
      };
    },
    values: () => ({
      columns: [
        ...['X', 'Y', 'Z'].map((axis) => ({head: axis, unit: 'mm', numeric: true})),
        ...['X', 'Y', 'Z'].map((axis) => ({head: `Shift ${axis}`, unit: '\u00b5m', numeric: true}))
      ],
      rows: centres.map(
          (at, i) => [...at.map((one) => fixed(one, 3)), ...shifts[i].map((one) => fixed(one, 3))]),
    }),
  };
  return figureGroup({
    title: 'Mapping cells',
    intro: `${result.mapped.cells} cells have parameters of their own. A line is the shift of ` +
        'the ball from its position with common parameters, magnified: large ones show errors that ' +
        'the model lacks, or noise.',
    slider: magnifierFor(size * 1e-3, most * 1e-6),
    panels: [panel],
  });
}

function modelTable(result) {
  if (!result.models?.length) return null;
  const numeric = (head) => ({head, unit: '\u00b5m', numeric: true});
  const text = (one) => isNumber(one) ? significant(one) : null;
  return table({
    caption: 'Error models side by side, distances in space',
    columns: [
      {head: 'Model'}, {head: 'Parameters free', numeric: true}, numeric('Calibrated, rms'),
      numeric('Held out, rms'), numeric('Held out, largest'),
      {head: 'Boelens (2006), largest, \u00b5m'}
    ],
    rows: result.models.map(
        ({name, parameters, after, held_out: held, published}) =>
            [capital(name), String(parameters), text(after?.rms_um), text(held?.rms_um),
             text(held?.max_um), published || null]),
  });
}

function outlierTable(result) {
  if (!result.outliers?.length) return null;
  return table({
    caption: 'Outlying poses, with little weight',
    columns: [
      {head: 'Recording'}, {head: 'Row', numeric: true},
      {head: 'Off by', unit: '\u00b5m', numeric: true}, {head: 'Standard deviations', numeric: true}
    ],
    rows: result.outliers.map(
        ({recording, row, gap_um: gap, normalised}) =>
            [recording.split('/').at(-1), String(row), significant(length3(gap)),
             significant(normalised, 2)]),
  });
}

registerSection({
  command: 'calibrate',
  title: () => 'Calibration of the linkage',
  short: () => 'Linkage',
  summary: calibrationSummary,
  facts: (result) => [
      ['Error model', capital(result.model ?? '')],
      ['Poses', isNumber(result.poses) ? String(result.poses) : null],
      ['Form', result.displacement ? 'displacements' : 'absolute'],
      [
        'Residuals over noise',
        isNumber(result.residuals_over_noise) ? significant(result.residuals_over_noise, 2) : null
      ],
      ['Recordings', (result.recordings ?? []).join(', ')]],
  body:
      (result) => [distanceTable(result), poseResidualGroup(result), ...parameterTables(result),
                   unseenTable(result), cellGroup(result), modelTable(result), outlierTable(result)]
                      .filter(Boolean),
  overview: {
    title: 'Calibration of the linkage',
    columns: [
      {head: 'Error model'}, {head: 'Poses', numeric: true},
      ...['Before', 'Calibrated', 'Held out'].map(
          (head) => ({head: `${head}, rms`, unit: '\u00b5m', numeric: true})),
      {head: 'Combinations seen', numeric: true}
    ],
    row: (result) =>
        [capital(result.model ?? ''), String(result.poses ?? ''),
         ...['before', 'after', 'held_out'].map(
             (key) => isNumber(result[key]?.rms_um) ? significant(result[key].rms_um) : null),
         isNumber(result.combinations_seen) ?
             `${result.combinations_seen} of ${result.combinations}` :
             null],
  },
});
