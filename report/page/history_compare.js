// The section of a comparison of two campaigns: what changed, and which changes are significant.

const differencesOf = (result) => result.differences ?? [];
const campaignText = ({campaign, measured, note}) =>
    `${campaign}, ${dayText(measured)}${note ? `: ${note}` : ''}`;

function comparisonSummary(result) {
  const changed = differencesOf(result).filter(({significant: is_one}) => is_one);
  const judged = differencesOf(result).filter(({p}) => isNumber(p)).length;
  if (!changed.length) return `None of ${judged} differences is significant.`;
  return `${changed.length} of ${judged} differences ${
      changed.length === 1 ? 'is' : 'are'} significant; the chance of any false one among them ` +
      `is below ${fixed(100 * result.family_level, 0)}\u00a0%.`;
}

function differenceTable(result) {
  return table({
    caption: 'Differences, the significant ones first',
    columns: [
      {head: 'Figure'}, {head: 'Before', numeric: true}, {head: 'After', numeric: true},
      {head: 'Change', numeric: true}, {head: 'Unit'}, {head: 'p', numeric: true},
      {head: 'Significant'}, {head: 'In common'}
    ],
    rows: differencesOf(result).map((one) => {
      const shown = (value) => rounded(value, one.U95).value;
      const name = one.at_mm === undefined ? one : {
        ...one,
        name: `${one.name}, at ${positionText(one.at_mm)}\u00a0mm`
      };
      return [
        withConditions(name), shown(one.before), shown(one.after), quantity(one.change, one.U95),
        unitText(one.unit), isNumber(one.p) ? smallProbability(one.p) : null,
        isNumber(one.p) ? (one.significant ? 'yes' : 'no') : 'no uncertainty stated',
        one.shared.join(', ') || null
      ];
    }),
  });
}

const smallProbability = (p) => p < 1e-4 ? 'below 0.0001' : significant(p, 2);

function changePanel(one) {
  const unit = unitText(one.unit);
  const {positions_mm: x, change, U95} = one.curve;
  return {
    name: `Change of ${one.object}`,
    code: one.conditions,
    unit,
    width: 'half',
    height: 240,
    about: `${one.words}; change over the travel in ${unit} with its expanded uncertainty, the ` +
        'values follow as a table.',
    draw: (colours, shown) => ({
      data: [
        shown.has('band') && U95.length ? bandTrace(x, change, U95, colours.band) : null,
        lineTrace('change', x, change, one.significant ? colours.fail : colours.mean, unit),
      ].filter(Boolean),
      layout: figureLayout(colours, {x: 'Position (mm)'}),
    }),
    values: () => ({
      columns: ['Position, mm', `Change, ${unit}`, `U\u2089\u2085, ${unit}`].map(
          (head) => ({head, numeric: true})),
      rows: x.map((at, index) => {
        const text = rounded(change[index], U95[index]);
        return [positionText(at), text.value, text.U];
      }),
    }),
  };
}

const foundText = ({cause, object}) => [capital(cause.replaceAll('-', ' ')), object].join(', ');

registerSection({
  command: 'history',
  kind: 'comparison',
  title: (result) => `What changed: campaign ${result.before?.campaign} to ${result.after?.campaign}`,
  short: (result) => `Campaigns ${result.before?.campaign}, ${result.after?.campaign}`,
  summary: comparisonSummary,
  facts: (result) => [
      ['Before', campaignText(result.before)], ['After', campaignText(result.after)],
      ['Only before', (result.only_before ?? []).join(', '), true],
      ['Only after', (result.only_after ?? []).join(', '), true]],
  body: (result) => {
    const curves = differencesOf(result).filter(({curve}) => curve?.positions_mm?.length);
    return [
      notesBlock('Causes that were not found before:', (result.new_findings ?? []).map(foundText)),
      notesBlock('Causes no longer found:', (result.gone_findings ?? []).map(foundText)),
      differenceTable(result),
      curves.length ? figureGroup({
        title: 'Over the travel',
        intro: 'After minus before, with the expanded uncertainty of the difference; significant ' +
            'changes stand out by their colour.',
        items: [{key: 'band', label: 'U\u2089\u2085', swatch: 'band'}],
        panels: curves.map(changePanel),
      }) :
                      null,
    ].filter(Boolean);
  },
});
