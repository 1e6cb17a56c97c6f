// A path in space with its deviation magnified, drawn in an isometric view: it prints, and needs no
// graphics card.

const ISOMETRIC = [
  [Math.sqrt(3) / 2, -0.5], [Math.sqrt(3) / 2, 0.5], [0, 1]
];  // where the axes point: to the right and near, to the right and far, up

const isometric = (lists, view = ISOMETRIC) => [0, 1].map(
    (row) => lists[0].map(
        (unused, i) => lists.reduce((sum, list, axis) => sum + list[i] * view[axis][row], 0)));

// The middle of the nominal path, and the largest distance to it, in m.
function spaceExtent(paths) {
  const ends = [0, 1, 2].map((axis) => {
    const all = numbers(paths.flatMap(({position}) => position[axis]));
    return [Math.min(...all), Math.max(...all)];
  });
  return {
    middle: ends.map(([low, high]) => (low + high) / 2),
    size: Math.max(1e-6, ...ends.map(([low, high]) => (high - low) / 2)),
  };
}

function spacePath({name, position, deviation}, middle, amount, line) {
  const [x, y] = isometric(position.map(
      (list, axis) =>
          list.map((at, i) => (at - middle[axis] + amount * (deviation[axis][i] ?? 0)) * 1e3)));
  const vector = (i) => deviation.map((list) => fixed(list[i] * 1e6, 2)).join(', ');
  return {
    ...lineTrace(name, x, y, line.color, ''),
    line,
    text: x.map((unused, i) => `${vector(i)}\u00a0\u00b5m`),
    hovertemplate: amount ? '%{text}' : null,
    hoverinfo: amount ? undefined : 'skip',
  };
}

// Three short arrows along the axes.
function spaceAxes(axes, span, colours, view = ISOMETRIC) {
  const [ax, ay] = [-0.8 * span, -0.8 * span];
  return axes
      .map((name, axis) => ({
             x: ax + 0.16 * span * view[axis][0],
             y: ay + 0.16 * span * view[axis][1],
             ax,
             ay,
             axref: 'x',
             ayref: 'y',
             text: '',
             arrowcolor: colours.axis,
             arrowwidth: 1.2,
             arrowsize: 0.8,
           }))
      .concat(axes.map((name, axis) => ({
                         x: ax + 0.23 * span * view[axis][0],
                         y: ay + 0.23 * span * view[axis][1],
                         text: name,
                         showarrow: false,
                         font: {size: 12, color: colours.muted},
                       })));
}

function spacePanel({name, axes, paths}) {
  const {middle, size} = spaceExtent(paths);
  const span = 1.9e3 * size;
  return {
    name,
    unit: '\u00b5m',
    width: 'half',
    height: 420,
    about: `${name}: the path in space with its deviation magnified, and the nominal path; ` +
        'the values follow as a table.',
    draw: (colours, shown, amount) => ({
      data:
          paths.filter(({key}) => shown.has(key))
              .flatMap(
                  (path) =>
                      [spacePath(
                           {...path, name: 'nominal'}, middle, 0, {color: colours.axis, width: 1}),
                       spacePath(path, middle, amount, {color: colours[path.colour], width: 1.6}),
  ]),
      layout: squareLayout(colours, span, {annotations: spaceAxes(axes, span, colours)}),
    }),
    values: () => ({
      columns: [
        ...axes.map((axis) => ({head: axis, unit: 'mm', numeric: true})),
        ...axes.map((axis) => ({head: `Deviation ${axis}`, unit: '\u00b5m', numeric: true}))
      ],
      rows: paths.flatMap(
          ({position, deviation}) => position[0].map(
              (unused, i) =>
                  [...position.map((list) => fixed(list[i] * 1e3, 3)),
                   ...deviation.map((list) => fixed(list[i] * 1e6, 3))])),
    }),
  };
}

// seen: [{name, axes, paths: [{key, name, colour, position, deviation}]}], position and deviation
// three lists each, in m.
function spaceGroup(seen, items) {
  if (!seen.length) return null;
  const paths = seen.flatMap((one) => one.paths);
  const {size} = spaceExtent(paths);
  const most = Math.max(1e-9, ...paths.flatMap(({deviation}) => deviation.map(largest)));
  return figureGroup({
    title: 'The path in space, its deviation magnified',
    intro: 'Seen from above, front and right; the thin line is the nominal path.',
    items,
    slider: magnifierFor(size, most),
    panels: seen.map(spacePanel),
  });
}
