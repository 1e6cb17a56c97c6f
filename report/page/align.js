// The section of an alignment: the gap of each probe over the travel against its range, the tilts,
// what was turned.

const ALIGN_VERDICTS = {
  'ready': 'The whole travel lies within the ranges of the probes',
  'goes on': 'Under way',
  'wrong wiring': 'The channels are not wired as the machine file says',
  'out of reach': 'The screws cannot bring the whole travel into the ranges of the probes',
  'stopped': 'Ended before the whole travel lay within the ranges of the probes',
};

const turnText = ({screw, turns}) =>
    `${screw} ${fixed(Math.abs(turns), 2)} turns ${turns > 0 ? 'clockwise' : 'counter-clockwise'}`;

function alignSummary(result) {
  const wiring = (result.wiring ?? []).join(', or ');
  return [ALIGN_VERDICTS[result.verdict] ?? result.verdict, capital(wiring)]
      .filter(Boolean)
      .map((sentence) => `${sentence}.`)
      .join(' ');
}

function alignTable(result) {
  const gaps = Object.entries(result.gaps ?? {});
  if (!gaps.length) return null;
  const [first, last] = (result.travel ?? []).map((at) => positionText(at * 1e3));
  const um = (value) => fixed(value * 1e6, 1);
  const numeric = (head, unit = '\u00b5m') => ({head, unit, numeric: true});
  return table({
    caption: 'Gaps over the travel',
    columns: [
      {head: 'Probe'}, numeric(`At ${first} mm`), numeric(`At ${last} mm`), numeric('Range'),
      numeric('Free of it'), numeric('Noise', 'nm'), numeric('Mains', 'nm')
    ],
    rows: gaps.map(([name, gap]) => {
      const noise = result.noise?.[name] ?? {};
      return [
        name.replace('_', ' '), um(gap.first), um(gap.last), fixed(gap.range * 1e6, 0),
        um(gap.room), isNumber(noise.white_m) ? fixed(noise.white_m * 1e9, 0) : null,
        noise.mains_m > 0 ? `${fixed(noise.mains_m * 1e9, 0)} at ${noise.mains_hz}\u00a0Hz` : 'none'
      ];
    }),
  });
}

function turnsBlock(result) {
  const turned = (result.turned ?? []).map(
      (turns, index) => `${index + 1}: ${turns.map(turnText).join(', ') || 'by hand'}`);
  if (result.verdict === 'goes on' && result.turns?.length)
    turned.push(`Now: ${result.turns.map(turnText).join(', ')}`);
  return notesBlock('Turns of the screws', turned);
}

const tiltText = (tilt) =>
    tilt ? quantity(tilt.value * 1e6, COVERAGE * tilt.u * 1e6, '\u00b5rad') : null;

registerSection({
  command: 'align',
  title: (result) => `Setting up for the ${result.axis} axis`,
  short: (result) => `Set-up ${result.axis}`,
  summary: alignSummary,
  facts: (result) =>
      [['Adjustments', result.adjustments],
       ['Travel seen', isNumber(result.seen) ? `${fixed(100 * result.seen, 0)}\u00a0%` : null],
       ['Top face rises along the axis by', tiltText(result.tilt?.top)],
       ['Side face rises along the axis by', tiltText(result.tilt?.side)],
       ['Margin', isNumber(result.margin) ? `${fixed(result.margin * 1e6, 0)}\u00a0\u00b5m` : null],
       ['Mounting', result.mounting || null]],
  overview: {
    title: 'Set-ups',
    columns: [{head: 'Axis'}, {head: 'Verdict'}, {head: 'Adjustments', numeric: true}],
    row: (result) => [result.axis, result.verdict, result.adjustments],
  },
  body: (result) =>
      [notesBlock('Notes', result.notes), alignTable(result), turnsBlock(result)].filter(Boolean),
});
