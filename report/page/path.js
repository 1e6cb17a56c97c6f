// The section of a test along a path: the figures of each instrument, and the path in space.

const PATH_NAMES = {
  stepping: 'Stepping test',
  square: 'Square path',
  cap: 'Tool cap',
  articulation: 'Single-point articulation',
  path: 'Path'
};
const PATH_FIGURES = [
  ['largest_um', 'Largest distance to the path'],
  ['rms_um', 'Root mean square distance'],
  ['aligned_largest_um', 'Largest distance, aligned as a rigid body'],
  ['aligned_rms_um', 'Root mean square distance, aligned'],
  ['location_um', 'Location (ISO\u00a010360-12)'],
  ['range_um', 'Range of the distances to the mean'],
  ['two_sigma_um', 'Two standard deviations (ASME\u00a0B89.4.22)'],
];

const pathTests = (result) => result.tests ?? [];
const pathName = (result) => PATH_NAMES[result.kind] ?? capital(result.kind ?? 'path');

function pathFigureTable(result) {
  const tests = pathTests(result);
  const rows = PATH_FIGURES.filter(([key]) => tests.some((test) => isNumber(test[key])));
  if (!rows.length) return null;
  return table({
    caption: `Figures of the ${pathName(result).toLowerCase()}`,
    columns: [
      {head: 'Figure'},
      ...tests.map(({instrument}) => ({head: capital(instrument), unit: '\u00b5m', numeric: true}))
    ],
    rows: rows.map(
        ([key, name]) =>
            [name,
             ...tests.map(
                 (test) => isNumber(test[key]) ?
                     quantity(test[key], COVERAGE * (test.u_calibration?.[key] ?? 0)) :
                     null)]),
  });
}

// "length_error_um" -> {head: "Length error", unit: "um"}
function columnOf(key) {
  const [, name, unit] = /^(.*?)(?:_(um|mm|n|mm_min))?$/.exec(key);
  const units = {um: '\u00b5m', mm: 'mm', n: 'N', mm_min: 'mm/min'};
  return {head: capital(name.replaceAll('_', ' ')), unit: units[unit], numeric: true};
}

// `stops`, `sides` and `displacements`, one table each.
function pathLists(test) {
  const lists = [
    ...(test.lines ?? []).map(({axis, stops}) => [`Stops along ${axis}`, stops]),
    ['Sides', test.sides], ['Displacement in the cap', test.displacements]
  ].filter(([, list]) => list?.length);
  const text = (key, value) => Array.isArray(value) ? value.map((one) => fixed(one, 2)).join(', ') :
      !isNumber(value)                              ? value ?? '-' :
      key.endsWith('_um')                           ? fixed(value, 2) :
                                                      positionText(value);
  return lists.map(([name, list]) => {
    const keys = Object.keys(list[0]).filter((key) => !['along', 'across'].includes(key));
    return table({
      caption: `${name}, ${test.instrument}`,
      columns: keys.map(columnOf),
      rows: list.map((one) => keys.map((key) => text(key, one[key]))),
    });
  });
}

function pathSpaceGroup(result) {
  const seen = pathTests(result)
                   .filter(({path}) => path)
                   .map(({instrument, path}) => ({
                          name: capital(instrument),
                          axes: ['X', 'Y', 'Z'],
                          paths: [{
                            key: 'measured',
                            name: 'measured',
                            colour: 'mean',
                            // The result has the measured path and its deviation: the nominal path
                            // is their difference.
                            position: ['x', 'y', 'z'].map(
                                (axis) => path[axis].map((at, i) => at - path[`d${axis}`][i])),
                            deviation: ['dx', 'dy', 'dz'].map((axis) => path[axis]),
                          }],
                        }));
  return spaceGroup(seen, [{key: 'measured', label: 'Measured', swatch: 'mean'}]);
}

registerSection({
  command: 'path',
  title: (result) => [pathName(result), result.nominal].filter(Boolean).join(': '),
  short: pathName,
  summary: (result) => capital(
      pathTests(result)
          .filter(({largest_um}) => isNumber(largest_um))
          .map(({instrument,
                 largest_um}) => `${instrument}: at most ${micrometres(largest_um)} from the path`)
          .join('; ')),
  facts: (result) => [
      ['Linkage read with', linkageText(result.linkage)],
      ['Recordings', [...new Set(pathTests(result).map(({recording}) => recording))].join(', ')]],
  body: (result) => [pathFigureTable(result), pathSpaceGroup(result),
                     ...pathTests(result).flatMap(pathLists), notesBlock('Notes', result.notes)]
                        .filter(Boolean),
});
