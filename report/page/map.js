// The section of a fused error map: its errors, their uncertainty and sources, and the agreement of
// the runs.

// The error in space at the grid points, and its expanded uncertainty: largest and rms, in um.
function mapSize(result) {
  if (!hasMapGrid(result)) return null;
  const {error, u} = result.map.grid;
  const lengths = gridComponent(error, 'all');
  return {
    largest: 1e6 * largest(lengths),
    rms: 1e6 * typical(lengths),
    U: u ? 1e6 * COVERAGE * typical(gridComponent(u, 'all')) : NaN,
  };
}

const isScaleOpen = (result) => result.scale?.statement === 'prior only';

function scaleElement({value_ppm: value, u_ppm: u, statement} = {}) {
  if (!isNumber(value)) return null;
  return element(
      'span', {}, quantity(value, COVERAGE * u, 'ppm'), ', ',
      statement === 'prior only' ? element('strong', {}, 'PRIOR ONLY') : statement);
}

function mapSummary(result) {
  const size = mapSize(result);
  const sentences = [];
  if (size) {
    sentences.push(
        `Over the volume the tool is off by up to ${micrometres(size.largest)} ` +
        `(${micrometres(size.rms)} rms in space).`);
  }
  if (Number.isFinite(size?.U)) {
    sentences.push(`Its uncertainty is ${micrometres(size.U)} (U\u2089\u2085, rms in space).`);
  }
  if (result.scale) {
    sentences.push(
        isScaleOpen(result) ? 'Its scale is known from the tolerance only.' :
                              'Its scale is calibrated.');
  }
  return sentences.join(' ');
}

const probabilityText = (p) => p < 1e-3 ? plain(Number(p.toPrecision(1))) : significant(p, 2);
const shortName = (path) => String(path).split('/').at(-1);

function mapWarnings(result) {
  const prior = result.scale?.prior_ppm;
  const unseen =
      Object.keys(result.observability ?? {}).filter((name) => isPriorOnly(result, name));
  return [
    ...(result.contradictions ?? []).map((run) => {
      const {agreement} = result.chi2?.find((one) => one.run === run) ?? {};
      const size = agreement ? ` (chi-square ${significant(agreement.statistic)} of ${
                                   agreement.directions}, p = ${probabilityText(agreement.p)})` :
                               '';
      const widened = isNumber(result.widened) ?
          ` Until then every U\u2089\u2085 here is ${fixed(result.widened, 1)} times as large.` :
          '';
      return `CONTRADICTION: ${shortName(run)} disagrees with all other runs${size}. ` +
          'Look at its set-up, or leave it out and fuse again; if that is right, diagnose all ' +
          `recordings together.${widened}`;
    }),
    ...(result.reversals ?? []).map((each) => {
      const {value, U} = rounded(each.value, 2 * each.u);
      return `REVERSAL: ${each.error} forward minus backward ${value} \u00b1 ${U}\u00a0${
          each.unit.replace('u', '\u00b5')}; the map is the mean of both directions.`;
    }),
    ...(result.misfits ?? []).map(
        (run) => `DOES NOT FIT: what is left of ${
            shortName(run)} is more than three times its noise; abbe fuse says what it looks like. ` +
            'Do not use the map before it is known why.'),
    ...(result.scatter ?? []).map(
        ({run, axis, sd_um: size}) => `SCATTER: the places of ${shortName(run)} scatter along ${
            axis} alone, as no smooth map can hold (a wave of screw, gear or scale, rounding, lost motion that ` +
            `varies, a fine bend of a guide; or runs that do not fit or contradict). U\u2089\u2085 of E${axis}${axis} contains ${
                significant(size, 2)}\u00a0\u00b5m rms for it; circles, or places closer together, show it.`),
    isScaleOpen(result) ?
        'SCALE: PRIOR ONLY. No calibrated length went into this map: all lengths may be wrong in ' +
            `one proportion${
                isNumber(prior) ? ` of about ${significant(prior, 2)}\u00a0ppm` : ''}` +
            '. Give a run of kind length.' :
                                  null,
    unseen.length ? `PRIOR ONLY: no run determines ${joinWords(unseen)}.` : null,
  ].filter(Boolean);
}

// Chi-square over redundancy scatters about 1 by sqrt(2 / redundancy).
function chiSquareTable(result) {
  if (!result.chi2?.length) return null;
  const expected = (redundancy) => {
    const half = 2 * Math.sqrt(2 / redundancy);
    return `${fixed(Math.max(0, 1 - half), 2)} to ${fixed(1 + half, 2)}`;
  };
  return table({
    caption: 'Runs: does each fit its own noise, and does it agree with the others?',
    columns: [
      {head: 'Run'}, {head: 'Kind'}, {head: 'Rows', numeric: true},
      {head: '\u03c7\u00b2 / redundancy', numeric: true},
      {head: 'Expected, 95\u00a0%', numeric: true}, {head: 'Outliers', numeric: true},
      {head: 'p of its agreement', numeric: true}
    ],
    rows: result.chi2.map(
        ({run, kind, rows, chi2, redundancy, outliers, agreement}) =>
            [shortName(run), kind, grouped(rows),
             redundancy > 0 ? fixed(chi2 / redundancy, 3) : null,
             redundancy > 0 ? expected(redundancy) : null,
             isNumber(outliers) ? grouped(outliers) : null,
             (result.contradictions ?? []).includes(run) ?
                 element('strong', {}, `${probabilityText(agreement?.p ?? NaN)}, CONTRADICTS`) :
                 agreement?.directions ? probabilityText(agreement.p) :
                                         'no other run sees it']),
  });
}

// Without the coefficients of the error functions, which mean nothing to a reader.
function instrumentParameters(result) {
  const shown =
      (result.parameters ?? []).filter(({name}) => !/^(E[XYZABC][XYZ]|squareness)\./.test(name));
  if (!shown.length) return null;
  return element(
      'details', {class: 'values group'},
      element('summary', {}, `${shown.length} parameters of the instruments and their set-up`),
      parameterTable('Parameters of the instruments, with their expanded uncertainty', shown));
}

const millimetres = (list) => list?.map((at) => positionText(at * 1e3)).join(', ');

registerSection({
  command: 'fuse',
  weight: 2,
  title: () => 'Error map',
  short: () => 'Error map',
  summary: mapSummary,
  facts: (result) => [
      ['Isotropic scale', scaleElement(result.scale)],
      [
        'Tool point from the reference point',
        result.map?.tool ? `${millimetres(result.map.tool)}\u00a0mm` : null
      ],
      [
        'Correlation length',
        isNumber(result.smoothness_mm) ? `${positionText(result.smoothness_mm)}\u00a0mm` : null
      ],
      ['Runs', isNumber(result.chi2?.length) ? String(result.chi2.length) : null]],
  body: (result) => [notesBlock('Before this map is used', mapWarnings(result)),
                     mapSpaceGroup(result), mapSliceGroup(result), mapErrorGroup(result),
                     determinedTable(result), chiSquareTable(result), instrumentParameters(result)]
                        .filter(Boolean),
  overview: {
    title: 'Error map',
    columns: [
      {head: 'Map'}, {head: 'Largest error', unit: '\u00b5m', numeric: true},
      {head: 'Error, rms', unit: '\u00b5m', numeric: true},
      {head: 'U95, rms', unit: '\u00b5m', numeric: true}, {head: 'Scale'},
      {head: 'Contradicting run'}
    ],
    row: (result) => {
      const size = mapSize(result);
      const text = (value) => Number.isFinite(value) ? significant(value) : null;
      return [
        'Error map', text(size?.largest), text(size?.rms), text(size?.U),
        isScaleOpen(result) ? element('strong', {}, 'PRIOR ONLY') : result.scale?.statement,
        result.contradictions?.map(shortName).join(', ') || 'none'
      ];
    },
  },
});
