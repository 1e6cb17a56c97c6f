// Figures of an axis sweep: error motions, straightness and its lines, reversal.

const positionTitle = (result) => `${result.axis} position (mm)`;
const positionsOf = (result) => scaled(result.stations, 1e3);

function lineTrace(name, x, y, colour, unit, extra = {}) {
  return {
    type: 'scatter',
    mode: 'lines',
    name,
    x,
    y,
    line: {color: colour, width: 1.5},
    hovertemplate: `%{y:.3~f}\u00a0${unit}`,
    ...extra
  };
}

// --- the five error motions

// The lists of one component in shown units.
function motionLists(result, component, shown) {
  const source = shown.has('target') ? result.errors_at_target ?? {} : {};
  const error = {...result.errors[component], ...source[component]};
  const {name, scale} = unitOf(error);
  const x = positionsOf(result);
  return {
    x,
    unit: name,
    value: scaled(error.value, scale),
    forward: scaled(error.forward, scale),
    backward: scaled(error.backward, scale),
    U: scaled(listOf(error.u, x.length), coverageOf(error) * scale)
  };
}

const listOf = (u, length) => Array.isArray(u) ? u : Array(length).fill(u ?? null);

function motionTraces(result, component, colours, shown) {
  const {x, unit, value, forward, backward, U} = motionLists(result, component, shown);
  const marked = (name, y, colour, symbol) => lineTrace(name, x, y, colour, unit, {
    mode: 'lines+markers',
    line: {color: colour, width: 1},
    marker: {symbol, size: 4, color: colour}
  });
  return [
    shown.has('band') ? {...bandTrace(x, value, U, colours.band), name: '95 % band'} : null,
    shown.has('forward') && forward.length ?
        marked('forward', forward, colours.forward, 'triangle-right') :
        null,
    shown.has('backward') && backward.length ?
        marked('backward', backward, colours.backward, 'triangle-left') :
        null,
    shown.has('mean') ?
        lineTrace('mean', x, value, colours.mean, unit, {line: {color: colours.mean, width: 2}}) :
        null,
  ].filter(Boolean);
}

function motionPanel(result, [component, error]) {
  const name = componentName(component, error);
  const unit = unitOf(error).name;
  return {
    name,
    code: component,
    unit,
    width: isAngular(error) ? 'third' : 'half',
    height: 240,
    about: `${name} ${component} of ${result.axis} over its travel, in ${unit}: mean, 95 percent ` +
        'band and both directions; the values follow as a table.',
    draw: (colours, shown) => ({
      data: motionTraces(result, component, colours, shown),
      layout: figureLayout(colours, {x: positionTitle(result)}),
    }),
    values: () => motionValues(result, component, unit),
  };
}

function motionValues(result, component, unit) {
  const {x, value, forward, backward, U} = motionLists(result, component, new Set());
  return {
    columns: [
      'Position, mm', `Mean, ${unit}`, `U95, ${unit}`, `Forward, ${unit}`, `Backward, ${unit}`
    ].map((head) => ({head, numeric: true})),
    rows: x.map((at, index) => {
      const text = (number) => rounded(number ?? NaN, U[index]).value;
      return [
        positionText(at), text(value[index]), rounded(value[index], U[index]).U,
        text(forward[index]), text(backward[index])
      ];
    }),
  };
}

function motionGroup(result) {
  const has = (key) => errorsOf(result).some(([, error]) => numbers(error[key]).length);
  const items = [
    {key: 'mean', label: 'Mean', swatch: 'mean'},
    {key: 'band', label: '95\u00a0% band', swatch: 'band'},
    has('forward') ? {key: 'forward', label: 'Forward', swatch: 'forward', on: false} : null,
    has('backward') ? {key: 'backward', label: 'Backward', swatch: 'backward', on: false} : null,
    result.errors_at_target ? {key: 'target', label: 'Seen at the target', on: false} : null,
  ].filter(Boolean);
  return figureGroup({
    title: 'Error motions',
    intro:
        'The mean of all passes in both directions. The band holds the true error with 95\u00a0% ' +
        'probability. An angle counts from the first station; the slope of a straightness is the ' +
        'alignment of the target and is taken off.',
    items,
    panels: [...angularOf(result), ...linearOf(result)].map((found) => motionPanel(result, found)),
  });
}

// --- straightness with its three lines

const STRAIGHTNESS_LINES = [
  {key: 'end_points', label: 'End points', swatch: 'series-2', dash: 'dot'},
  {key: 'least_squares', label: 'Least squares', swatch: 'series-3', dash: 'dash'},
  {key: 'minimum_zone', label: 'Minimum zone', swatch: 'zone', dash: 'solid'},
];

// In a result the lines contain the slope of the recording and the curve does not: each line
// is shown minus the least-squares line.
function lineOverStations(result, component, key) {
  const lines = result.straightness_lines[component];
  const [line, level] = [lines[key], lines.least_squares];
  if (!line || !level) return null;
  return result.stations.map(
      (at) => 1e6 * (line.offset - level.offset + (line.slope - level.slope) * at));
}

// The narrowest parallels: through the highest and the lowest point of the curve over the line.
function zoneTrace(x, curve, line, colour) {
  const over = numbers(curve.map((value, index) => isNumber(value) ? value - line[index] : null));
  const [low, high] = [Math.min(...over), Math.max(...over)];
  const middle = line.map((value) => value + (low + high) / 2);
  return {...bandTrace(x, middle, middle.map(() => (high - low) / 2), colour), opacity: 0.5};
}

function straightnessTraces(result, component, colours, shown) {
  const x = positionsOf(result);
  const curve = scaled(result.errors[component].value, 1e6);
  const traceOf = ({key, label, swatch, dash}) => {
    const line = shown.has(key) ? lineOverStations(result, component, key) : null;
    if (!line) return [];
    if (key === 'minimum_zone') {
      return [{...zoneTrace(x, curve, line, colours[swatch]), name: label}];
    }
    const style = {line: {color: colours[swatch], width: 1.5, dash}};
    return [lineTrace(label, x, line, colours[swatch], '\u00b5m', style)];
  };
  const [ends, squares, zone] = STRAIGHTNESS_LINES.map(traceOf);
  const measured = lineTrace(
      'measured', x, curve, colours.mean, '\u00b5m', {line: {color: colours.mean, width: 2}});
  return [...zone, ...ends, ...squares, measured];
}

function straightnessPanel(result, [component, error]) {
  const name = componentName(component, error);
  return {
    name,
    code: component,
    unit: '\u00b5m',
    width: 'half',
    height: 260,
    about: `${name} ${component} in micrometres with its reference lines by end points, least ` +
        'squares and minimum zone; the widths follow as a table.',
    draw: (colours, shown) => ({
      data: straightnessTraces(result, component, colours, shown),
      layout: figureLayout(colours, {x: positionTitle(result), yaxis: {zeroline: false}}),
    }),
    values: () => ({
      columns: [{head: 'Reference line'}, {head: 'Straightness', unit: '\u00b5m', numeric: true}],
      rows: STRAIGHTNESS_LINES.map(
          ({key,
            label}) => [label, shownQuantity(straightnessAbout(result, component, key), error)]),
    }),
  };
}

function straightnessGroup(result) {
  return figureGroup({
    title: 'Straightness',
    intro:
        'The measured path without its slope, and the three lines of ISO\u00a0230-1. The shaded ' +
        'zone is the narrowest pair of parallels that holds the path.',
    items: STRAIGHTNESS_LINES,
    panels: linearOf(result)
                .filter(([component]) => result.straightness_lines?.[component])
                .map((found) => straightnessPanel(result, found)),
  });
}

// --- reversal

function reversalPanel(result, found, name, swatches) {
  const unit = unitOf(found[0][1]);
  const x = positionsOf(result);
  const of = (component) => result.reversal[component];
  const U = unit.scale *
      Math.max(...found.map(([component, error]) => coverageOf(error) * typical(of(component).u)));
  return {
    name,
    unit: unit.name,
    width: 'half',
    height: 240,
    about:
        `${name}: difference of the two directions of travel at each station, in ${unit.name}, ` +
        'for ' + found.map(([component]) => component).join(', ') +
        '; the values follow as a table.',
    draw: (colours, shown) => ({
      data: [
        Number.isFinite(U) ?
            {...bandTrace(x, x.map(() => 0), x.map(() => U), colours.line), opacity: 0.6} :
            null,
        ...found.filter(([component]) => shown.has(component))
            .map(
                ([component]) => lineTrace(
                    component, x, scaled(of(component).value, unit.scale),
                    colours[swatches[component]], unit.name)),
      ].filter(Boolean),
      layout: figureLayout(colours, {x: positionTitle(result)}),
    }),
    values: () => ({
      columns: [
        {head: 'Position, mm', numeric: true},
        ...found.map(([component]) => ({head: `${component}, ${unit.name}`, numeric: true}))
      ],
      rows: x.map(
          (at, index) =>
              [positionText(at),
               ...found.map(
                   ([component]) =>
                       rounded((of(component).value[index] ?? NaN) * unit.scale, U).value)]),
    }),
  };
}

function reversalGroup(result) {
  const known = ([component]) => numbers(result.reversal?.[component]?.value).length;
  const [turns, bows] = [angularOf(result).filter(known), linearOf(result).filter(known)];
  const swatches = Object.fromEntries(
      [...turns, ...bows].map(([component], index) => [component, `series-${index + 1}`]));
  return figureGroup({
    title: 'Reversal',
    intro: 'Forward minus backward at each station. Inside the grey band a difference is not ' +
        'significant.',
    items: Object.entries(swatches).map(([key, swatch]) => ({key, label: key, swatch})),
    panels: [
      turns.length ? reversalPanel(result, turns, 'Rotations', swatches) : null,
      bows.length ? reversalPanel(result, bows, 'Straightness', swatches) : null,
    ].filter(Boolean),
  });
}
