// The error map in space: arrows over the volume, and slices through it with their uncertainty.

const MAP_AXES = ['x', 'y', 'z'];
const MAP_COMPONENTS = [
  {key: 'all', label: 'All three'}, {key: 0, label: 'X'}, {key: 1, label: 'Y'}, {key: 2, label: 'Z'}
];
const MAP_PLANES = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];  // across, up, through

// Turned by 25 deg and seen from 28 deg above: no two points of a cubic grid coincide, as they
// would in an isometric view.
const MAP_VIEW = [[0.906, -0.198], [0.423, 0.425], [0, 0.883]];

const hasMapGrid = (result) =>
    MAP_AXES.every((axis) => result.map?.grid?.[axis]?.length > 1) && result.map.grid.error?.[2];

// The number of a grid point: x runs fastest, then y, then z.
const gridPoint = (grid, [i, j, k]) => i + grid.x.length * (j + grid.y.length * k);

// At the grid points, in m: one component, or the length of all three.
function gridComponent(lists, component) {
  if (!lists?.[2]) return [];
  return component === 'all' ? lists[0].map((unused, i) => length3(lists.map((list) => list[i]))) :
                               lists[component];
}

const gridPlaces = (grid, every = 1) =>
    grid.z.flatMap((z, k) => grid.y.flatMap((y, j) => grid.x.map((x, i) => [i, j, k])))
        .filter((place) => place.every((index) => index % every === 0));

// The twelve edges of the volume, each a list of grid points.
const gridEdges = (grid) => [0, 1, 2].flatMap((along) => [0, 1, 2, 3].map((corner) => {
  const last = MAP_AXES.map((axis) => grid[axis].length - 1);
  const others = [0, 1, 2].filter((axis) => axis !== along);
  return grid[MAP_AXES[along]].map((unused, at) => {
    const place = [0, 0, 0];
    place[along] = at;
    others.forEach((axis, bit) => place[axis] = corner >> bit & 1 ? last[axis] : 0);
    return place;
  });
}));

// Coordinates of grid points in mm about the middle, moved by `amount` times their error. They are
// axis positions: where an axis carries the workpiece the tool moves the other way in it, sign -1.
function movedPlaces({grid, signs = [1, 1, 1]}, places, amount, component) {
  return places.map((place) => {
    if (place === null) return [NaN, NaN, NaN];
    const error = grid.error.map((list) => list[gridPoint(grid, place)]);
    return MAP_AXES.map((axis, k) => {
      const middle = (grid[axis][0] + grid[axis].at(-1)) / 2;
      const moves = component === 'all' || component === k;
      return 1e3 * (grid[axis][place[k]] - middle + (moves ? amount * signs[k] * error[k] : 0));
    });
  });
}

const columnsOf = (rows) => [0, 1, 2].map((axis) => rows.map((row) => row[axis]));

function gridLine(name, places, colour, width) {
  return {
    ...lineTrace(name, ...isometric(columnsOf(places), MAP_VIEW), colour, ''),
    line: {color: colour, width},
    hoverinfo: 'skip',
    hovertemplate: null
  };
}

function arrowTraces(map, amount, component, colours) {
  const {grid} = map;
  const places = gridPlaces(grid, grid.x.length > 8 ? 2 : 1);
  const from = movedPlaces(map, places, 0, component);
  const to = movedPlaces(map, places, amount, component);
  const stems = from.flatMap((at, i) => [at, to[i], [NaN, NaN, NaN]]);
  const edges = gridEdges(grid).flatMap((edge) => [...edge, null]);
  const [x, y] = isometric(columnsOf(to), MAP_VIEW);
  const text = places.map((place) => {
    const at = MAP_AXES.map((axis, k) => positionText(grid[axis][place[k]] * 1e3)).join(', ');
    const error = grid.error.map((list) => fixed(list[gridPoint(grid, place)] * 1e6, 2)).join(', ');
    return `at ${at}\u00a0mm<br>${error}\u00a0\u00b5m`;
  });
  return [
    gridLine('nominal', movedPlaces(map, edges, 0, component), colours.axis, 1),
    gridLine('moved', movedPlaces(map, edges, amount, component), colours.backward, 1.4),
    gridLine('error', stems, colours.mean, 1.2),
    {
      ...lineTrace('tip', x, y, colours.mean, ''),
      mode: 'markers',
      marker: {size: 3.5, color: colours.mean},
      text,
      hovertemplate: '%{text}'
    },
  ];
}

function mapSpaceGroup(result) {
  if (!hasMapGrid(result)) return null;
  const {grid} = result.map;
  const half = MAP_AXES.map((axis) => (grid[axis].at(-1) - grid[axis][0]) / 2);
  const span = 1e3 * 1.25 * Math.max(half[0] + half[1] / 2, (half[0] + half[1]) / 2 + half[2]);
  const panel = {
    name: 'Error of the tool',
    unit: '\u00b5m',
    height: 480,
    about: 'The volume with the error of the tool at grid points as arrows, and its edges as the ' +
        'errors bend them, magnified; the values follow as a table.',
    draw: (colours, shown, amount, component) => ({
      data: arrowTraces(result.map, amount, component, colours),
      layout: squareLayout(
          colours, span, {annotations: spaceAxes(['X', 'Y', 'Z'], 1.1 * span, colours, MAP_VIEW)}),
    }),
    values: () => ({
      columns: [
        ...['X', 'Y', 'Z'].map((axis) => ({head: axis, unit: 'mm', numeric: true})),
        ...['X', 'Y', 'Z'].flatMap(
            (axis) =>
                [{head: `Error ${axis}`, unit: '\u00b5m', numeric: true},
                 {head: `U95 ${axis}`, unit: '\u00b5m', numeric: true}])
      ],
      rows: gridPlaces(grid).map(
          (place) =>
              [...MAP_AXES.map((axis, k) => positionText(grid[axis][place[k]] * 1e3)),
               ...[0, 1, 2].flatMap((k) => {
                 const at = gridPoint(grid, place);
                 const text =
                     rounded(grid.error[k][at] * 1e6, COVERAGE * 1e6 * (grid.u?.[k][at] ?? 0));
                 return [text.value, text.U];
               })]),
    }),
  };
  return figureGroup({
    title: 'The map over the volume',
    intro: 'From each point of the grid a line to the actual position of the tool, along ' +
        'the axes as commanded, magnified. Grey: the volume; orange: its edges with the errors.',
    choices: MAP_COMPONENTS,
    slider: magnifierFor(Math.max(...half), Math.max(1e-9, ...grid.error.map(largest))),
    panels: [panel],
  });
}

// --- slices

// Rows of one slice, in um: `through` is held at the grid index `at`.
function sliceRows(grid, values, [across, up, through], at) {
  return grid[MAP_AXES[up]].map((unused, row) => grid[MAP_AXES[across]].map((none, column) => {
    const place = [0, 0, 0];
    [place[across], place[up], place[through]] = [column, row, at];
    return 1e6 * values[gridPoint(grid, place)];
  }));
}

function slicePanel(grid, lists, plane, {name, about, isSigned}) {
  const [across, up, through] = plane.map((axis) => 'XYZ'[axis]);
  const endsOf = (axis) => [0, -1].map((end) => grid[MAP_AXES[axis]].at(end) * 1e3);
  return {
    name: `${name}, ${across}${up}`,
    unit: '\u00b5m',
    width: 'third',
    height: 260,
    about: `${about} in the ${across}${up} plane, as colours; the values are with the map over ` +
        'the volume.',
    draw: (colours, shown, share, component) => {
      const values = gridComponent(lists, component);
      const most = 1e6 * Math.max(1e-12, largest(values));
      const sign = isSigned && component !== 'all';
      const through_list = grid[MAP_AXES[plane[2]]];
      const at = Math.round(share * (through_list.length - 1));
      const place = `${through} = ${positionText(through_list[at] * 1e3)}\u00a0mm`;
      return {
        data: [{
          type: 'heatmap',
          x: scaled(grid[MAP_AXES[plane[0]]], 1e3),
          y: scaled(grid[MAP_AXES[plane[1]]], 1e3),
          z: sliceRows(grid, values, plane, at),
          zmin: sign ? -most : 0,
          zmax: most,
          zsmooth: 'best',
          colorscale: sign ?
              [[0, colours['series-1']], [0.5, colours.surface], [1, colours['series-2']]] :
              [[0, colours.surface], [1, colours[isSigned ? 'series-2' : 'series-4']]],
          colorbar: {
            thickness: 8,
            outlinewidth: 0,
            xpad: 4,
            nticks: 5,
            tickfont: {size: 11, color: colours.muted}
          },
          hovertemplate: `${across} %{x:.4~f}, ${up} %{y:.4~f}, ${place}<br>%{z:.2f}\u00a0\u00b5m` +
              '<extra></extra>',
        }],
        layout: figureLayout(colours, {
          hovermode: 'closest',
          x: `${across} (mm), ${place}`,
          xaxis: {nticks: 5, range: endsOf(plane[0])},
          yaxis: {
            range: endsOf(plane[1]),
            showgrid: false,
            zeroline: false,
            title: {text: up, font: {size: 12, color: colours.muted}, standoff: 4}
          },
        }),
      };
    },
  };
}

function mapSliceGroup(result) {
  if (!hasMapGrid(result)) return null;
  const {grid} = result.map;
  const error = {name: 'Error', about: 'Error of the tool', isSigned: true};
  const U = {name: 'U\u2089\u2085', about: 'Expanded uncertainty of the map', isSigned: false};
  const uncertainty = grid.u?.map((list) => list.map((u) => COVERAGE * u));
  const shares = Array.from({length: 11}, (unused, i) => i / 10);
  const where = (share) => MAP_AXES
                               .map((axis) => {
                                 const at = grid[axis][Math.round(share * (grid[axis].length - 1))];
                                 return `${axis.toUpperCase()}\u00a0${positionText(at * 1e3)}`;
                               })
                               .join(', ') +
      '\u00a0mm';
  return figureGroup({
    title: 'Slices of the map',
    intro: 'Three planes through one point, the error above and its expanded uncertainty below. ' +
        'All slices of a component share one scale of colours.',
    choices: MAP_COMPONENTS.map(
        (item) => item.key === 'all' ? {...item, label: 'Length in space'} : item),
    slider: {label: 'Through', values: shares, at: 5, text: where},
    panels: [
      ...MAP_PLANES.map((plane) => slicePanel(grid, grid.error, plane, error)),
      ...(uncertainty ? MAP_PLANES.map((plane) => slicePanel(grid, uncertainty, plane, U)) : []),
    ],
  });
}
