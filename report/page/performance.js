// The sections of the uses of a map: a performance simulation before and after the correction, a
// corrected program or table, an export and what its format drops.

// "F_max XY um" -> {name: "F_max XY", unit: "um"}
function figureKey(key) {
  const [, name, unit] = /^(.*) (um|urad)$/.exec(key) ?? [null, key, ''];
  return {key, name, unit};
}

const performanceFigures = (result) => Object.keys(result.as_is ?? {}).map(figureKey);

function performancePanel(result, unit, figures) {
  const shown = unitText(unit);
  const bars = (key, label, colour) => ({
    type: 'bar',
    name: label,
    x: figures.map(({name}) => name),
    y: figures.map((figure) => Math.abs(result[key][figure.key])),
    marker: {color: colour},
    hovertemplate: `%{y:.2f}\u00a0${shown}`,
  });
  return {
    name: `Size of each figure, ${shown}`,
    unit: shown,
    height: 260,
    about: `Size of each figure in ${shown} before and after the correction; the values are in ` +
        'the table.',
    draw: (colours, on) => ({
      data: [
        on.has('as_is') ? bars('as_is', 'as it is', colours.backward) : null,
        on.has('corrected_95') && result.corrected_95 ?
            bars('corrected_95', 'corrected (95 %)', colours.mean) :
            null,
      ].filter(Boolean),
      layout: figureLayout(colours, {
        barmode: 'group',
        bargap: 0.35,
        xaxis: {type: 'category', tickangle: 'auto'},
        yaxis: {rangemode: 'tozero'}
      }),
    }),
  };
}

function performanceTable(result) {
  const figures = performanceFigures(result);
  if (!figures.length) return null;
  const text = (value) => isNumber(value) ? fixed(value, 2) : null;
  const after = result.corrected_95;
  return table({
    caption: 'Figures of the test piece, before and after the correction',
    columns: [
      {head: 'Figure'}, {head: 'As it is', numeric: true},
      ...(after ? [{head: 'Corrected, 95\u00a0% below', numeric: true}] : []), {head: 'Unit'}
    ],
    rows: figures.map(
        ({
          key,
          name,
          unit
        }) => [name, text(result.as_is[key]), ...(after ? [text(after[key])] : []), unitText(unit)]),
  });
}

function performanceGroup(result) {
  const figures = performanceFigures(result);
  if (!figures.length) return null;
  const units = [...new Set(figures.map(({unit}) => unit))];
  return figureGroup({
    title: 'Before and after',
    intro: result.corrected_95 ?
        'Corrected: the error from the uncertainty of the map; 95\u00a0% of the machines that it ' +
            'allows are below.' :
        'As the machine is, without correction.',
    items: [
      {key: 'as_is', label: 'As it is', swatch: 'backward'},
      result.corrected_95 ? {key: 'corrected_95', label: 'Corrected', swatch: 'mean'} : null
    ].filter(Boolean),
    panels: units.map(
        (unit) => performancePanel(result, unit, figures.filter((figure) => figure.unit === unit))),
  });
}

registerSection({
  command: 'simulate',
  title: (result) => `Performance simulation: ${result.test}`,
  short: (result) => `Simulated ${result.test}`,
  summary: (result) => `What the machine of this map makes of the test piece \u201c${
      result.test}\u201d${result.corrected_95 ? ', as it is and corrected by the map' : ''}.`,
  facts: (result) => [['Map', result.map], ['Scale of the map', result.scale]],
  body: (result) => [performanceTable(result), performanceGroup(result)].filter(Boolean),
});

registerSection({
  command: 'correct',
  title: (result) => `Corrected ${result.kind}: ${result.out}`,
  short: (result) => `Corrected ${result.kind}`,
  summary: (result) => `Corrected by up to ${micrometres(result.largest_um)}.`,
  facts: (result) => [
      ['Map', result.map], ['From', result.from],
      ...[['Lines', 'lines'], ['Moves', 'moves'], ['Lines written for them', 'corrected'],
          ['Positions', 'rows']]
          .map(([name, key]) => [name, isNumber(result[key]) ? grouped(result[key]) : null]),
      ['Chords within', isNumber(result.chord_um) ? micrometres(result.chord_um) : null],
      ['Lines up to', isNumber(result.line_mm) ? `${significant(result.line_mm)}\u00a0mm` : null]],
  body: () => [],
});

registerSection({
  command: 'export',
  title: (result) => `Export: ${result.format}`,
  short: (result) => `Export, ${result.format}`,
  summary: (result) =>
      `Read back it differs from the map by up to ${micrometres(result.largest_difference_um)} (${
          micrometres(result.rms_difference_um)} rms); the largest error of the map is ${
          micrometres(result.largest_error_um)}.`,
  facts: (result) => [
      ['Map', result.map], ['Files', (result.files ?? []).map(shortName).join(', ')],
      ['The format drops', result.drops, true]],
  body: () => [],
  overview: {
    title: 'Exports of the map',
    columns: [
      {head: 'Format'}, {head: 'Off the map, largest', unit: '\u00b5m', numeric: true},
      {head: 'Off the map, rms', unit: '\u00b5m', numeric: true}, {head: 'Drops'}
    ],
    row: (result) =>
        [result.format, significant(result.largest_difference_um),
         significant(result.rms_difference_um), result.drops],
  },
});
