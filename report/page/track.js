// The section of a map that is kept true: its tests, how long its limits hold, the test to make next.

function trackSummary(result) {
  const size = mapSize(result);
  const sentences = [];
  if (size) {
    sentences.push(
        `At ${dateText(result.time)} the tool is off by up to ${micrometres(size.largest)} over ` +
        `the volume; U\u2089\u2085 ${micrometres(size.U)} (rms in space).`);
  }
  const next = result.next;
  if (next) {
    const tests = joinWords(next.tests ?? []);
    const minutes = `${significant(next.minutes, 2)}\u00a0min`;
    sentences.push(
        !next.tests?.length ?
            next.enough ? `No test is needed for ${plain(next.days)} days.` :
                          'None of the tests given helps: measure and fuse anew.' :
            next.enough ? `Next: ${tests}, ${minutes}, keeps every limit for ${plain(next.days)} days.` :
                          `The best of the tests given, ${tests}, ${minutes}, does not keep every limit.`);
  }
  return sentences.join(' ');
}

registerSection({
  command: 'track',
  weight: 2,
  title: () => 'Error map kept true',
  short: () => 'Map kept true',
  summary: trackSummary,
  facts: (result) => Object.entries(result.temperatures ?? {}).map(
      ([sensor, {temperature_c: now, lagged_c: lagged}]) =>
          [`Temperature, ${sensor}`, `${fixed(now, 2)}\u00a0\u00b0C, its structure ${fixed(lagged, 2)}\u00a0\u00b0C`]),
  body: (result) => [
    result.tests?.length ? table({
      caption: 'Tests since the map before',
      columns: [
        {head: 'Test'}, {head: 'Kind'}, {head: 'Began'}, {head: 'Minutes', numeric: true},
        {head: 'p of its agreement', numeric: true}, {head: 'U95 before', unit: '\u00b5m', numeric: true},
        {head: 'after', unit: '\u00b5m', numeric: true}
      ],
      rows: result.tests.map(
          ({test, kind, started, minutes, agreement, U95_before_um: before, U95_after_um: after}) =>
              [test, kind, dateText(started), fixed(minutes, 1),
               agreement?.directions ? probabilityText(agreement.p) : null,
               after > 0 ? significant(before) : null, after > 0 ? significant(after) : null]),
    }) : null,
    result.limits?.length ? table({
      caption: 'When does the uncertainty exceed a limit?',
      columns: [
        {head: 'Limit'}, {head: 'of', numeric: true}, {head: 'U95 now', numeric: true}, {head: 'Exceeded'}
      ],
      rows: result.limits.map(
          ({name, limit, U95, exceeded}) => [name, significant(limit), significant(U95),
                                             U95 > limit ? 'now' : exceeded ? dateText(exceeded) : 'not within ten years']),
    }) : null,
    hasMapGrid(result) ? mapSliceGroup(result) : null,
  ].filter(Boolean),
});
