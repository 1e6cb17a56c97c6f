// The 21 errors of a map: each function over its travel with its band and its sources, and the
// three squarenesses.

const SQUARENESS_NAMES = {
  A0Z: 'Squareness Z to Y',
  B0Z: 'Squareness Z to X',
  C0Y: 'Squareness Y to X'
};
const isSquareness = (name) => name in SQUARENESS_NAMES;
const mapErrorName = (name, error) => SQUARENESS_NAMES[name] ??
    componentName(name, {...error, kind: `turn about ${'XYZ'['ABC'.indexOf(name[1])]}`});
const mapFunctions = (result) =>
    Object.entries(result.map?.errors ?? {}).filter(([name]) => !isSquareness(name));
const mapSquareness = (result) =>
    Object.entries(result.map?.errors ?? {}).filter(([name]) => isSquareness(name));

// The kinds of runs that determined an error, best first; none: only its tolerance.
const determinedBy = (result, name) => result.observability?.[name]?.determined_by ??
    [result.map?.errors?.[name]?.from].filter((from) => from && from !== 'prior');
const sourceText = (result, name) => determinedBy(result, name).join(', ') || 'prior only';
const isPriorOnly = (result, name) => determinedBy(result, name).length === 0;

// The largest error with its band among the functions of this unit, in its shown unit.
const largestOfUnit = (result, unit) => Math.max(
    ...mapFunctions(result)
        .filter(([, error]) => error.unit === unit)
        .flatMap(
            ([, {value, u}]) => value.map(
                (one, i) => shownUnit(unit).scale * (Math.abs(one) + COVERAGE * (u?.[i] ?? 0)))));

function mapFunctionPanel(result, [name, error]) {
  const unit = unitOf(error);
  const title = mapErrorName(name, error);
  const x = scaled(error.positions, 1e3);
  const value = scaled(error.value, unit.scale);
  const U = scaled(error.u, COVERAGE * unit.scale);
  const source = sourceText(result, name);
  const most = 1.05 * largestOfUnit(result, error.unit);
  return {
    name: title,
    code: name,
    unit: `${unit.name} \u00b7 ${source}`,
    width: 'third',
    height: 210,
    about: `${title} ${name} over the travel in ${unit.name}, with its 95 percent band, ` +
        `determined by ${source}; the values follow as a table.`,
    draw: (colours, shown) => ({
      data: [
        shown.has('band') && U.length ?
            {...bandTrace(x, value, U, colours.band), name: '95 % band'} :
            null,
        lineTrace('error', x, value, colours.mean, unit.name, {
          line: isPriorOnly(result, name) ? {color: colours.muted, width: 1.5, dash: 'dot'} :
                                            {color: colours.mean, width: 2}
        }),
      ].filter(Boolean),
      layout: figureLayout(colours, {
        x: `${name[2]} position (mm)`,
        yaxis: shown.has('one_scale') ? {range: [-most, most]} : {},
      }),
    }),
    values: () => ({
      columns: ['Position, mm', `Error, ${unit.name}`, `U95, ${unit.name}`].map(
          (head) => ({head, numeric: true})),
      rows: x.map((at, i) => {
        const text = rounded(value[i], U[i] ?? 0);
        return [positionText(at), text.value, text.U];
      }),
    }),
  };
}

function squarenessPanel(result) {
  const found = mapSquareness(result);
  const urad = (key, factor) => found.map(([, error]) => (error[key] ?? 0) * factor * 1e6);
  return {
    name: 'Squareness',
    unit: '\u00b5rad',
    width: 'half',
    height: 240,
    about: 'The three squarenesses in microradian with their 95 percent bars; the values follow ' +
        'as a table.',
    draw: (colours) => ({
      data: [lineTrace(
          'squareness', found.map(([name]) => `${name}<br>${sourceText(result, name)}`),
          urad('value', 1), colours.mean, '\u00b5rad', {
            mode: 'markers',
            marker: {size: 8, color: colours.mean},
            error_y: {type: 'data', array: urad('u', COVERAGE), color: colours.mean, thickness: 1.5}
          })],
      layout: figureLayout(colours, {xaxis: {type: 'category'}}),
    }),
    values: () => ({
      columns: [
        {head: 'Squareness'}, {head: 'Value', unit: '\u00b5rad', numeric: true},
        {head: 'Determined by'}
      ],
      rows: found.map(
          ([name, error]) =>
              [`${name}, ${SQUARENESS_NAMES[name]}`,
               quantity(error.value * 1e6, COVERAGE * (error.u ?? 0) * 1e6),
               sourceText(result, name)]),
    }),
  };
}

function mapErrorGroup(result) {
  const panels = mapFunctions(result).map((found) => mapFunctionPanel(result, found));
  if (mapSquareness(result).length) panels.push(squarenessPanel(result));
  if (!panels.length) return null;
  return figureGroup({
    title: 'The 21 errors',
    intro: 'Each error over the travel of its axis, zero at the first end; a straightness has no ' +
        'slope, which is squareness. Next to the unit: the runs that determine it; dotted: ' +
        'not measured, only its tolerance is known.',
    items: [
      {key: 'band', label: '95\u00a0% band', swatch: 'band'},
      {key: 'one_scale', label: 'One scale for all of a unit', on: false}
    ],
    panels,
  });
}

// Expanded uncertainties before (the tolerance) and after the data.
function determinedTable(result) {
  const known = Object.entries(result.observability ?? {});
  if (!known.length) return null;
  const unit = (name) => SHOWN_UNITS[/^E[XYZ]/.test(name) ? 'm' : 'rad'];
  const text = (name, u) => significant(COVERAGE * u * unit(name).scale, 2);
  return table({
    caption: 'What determined each error: expanded uncertainty, rms over the travel',
    columns: [
      {head: 'Error'}, {head: 'Before the data', numeric: true}, {head: 'After', numeric: true},
      {head: 'Unit'}, {head: 'Determined by'}
    ],
    rows: known.map(
        ([name, {prior, u}]) =>
            [code(name), text(name, prior), text(name, u), unit(name).name,
             isPriorOnly(result, name) ? element('strong', {}, 'PRIOR ONLY') :
                                         sourceText(result, name)]),
  });
}
