// The section of figures over time: small multiples with uncertainty, fitted line, band and limits.

const DAYS_A_MONTH = 30;
const seriesOf = (result) => (result.series ?? []).filter(({points}) => points?.length);

const dayText = (instant) => {
  const date = new Date(instant);
  return Number.isNaN(date.getTime()) ? '' : date.toLocaleDateString('en-GB', {
    timeZone: 'UTC',
    day: 'numeric',
    month: 'short',
    year: 'numeric'
  });
};

const monthlyRate = ({fit}) =>
    quantity(DAYS_A_MONTH * fit.rate_per_day, DAYS_A_MONTH * fit.U95_rate_per_day);

function limitText({limit_reached: reached, limit}) {
  if (!isNumber(limit)) return null;
  if (!reached) return 'never';
  if (reached.already) return reached.measured === false ? 'expected beyond it' : 'beyond it now';
  if (reached.expected)
    return `${dayText(reached.expected)} (${dayText(reached.earliest)} to ${
        dayText(reached.latest)})`;
  return reached.earliest ? `not before ${dayText(reached.earliest)}` : 'not in sight';
}

function rateTable(result) {
  return table({
    caption: 'Rate of change and limit',
    columns: [
      {head: 'Figure'}, {head: 'Change a month', numeric: true}, {head: 'Seen'},
      {head: 'Scatter beyond u', numeric: true}, {head: 'Unit'}, {head: 'Limit', numeric: true},
      {head: 'Limit reached'}
    ],
    rows: seriesOf(result).map((series) => {
      const {fit} = series;
      return [
        withConditions(series), fit ? monthlyRate(series) : null,
        fit ? (fit.drifts ? 'drifts' : 'no drift') : 'too few',
        fit ? significant(fit.excess_scatter, 2) : null, unitText(series.unit),
        isNumber(series.limit) ? significant(series.limit) : null, limitText(series)
      ];
    }),
  });
}

const pointTrace = (name, points, colours, marker) => ({
  type: 'scatter',
  mode: 'markers',
  name,
  x: points.map(({measured}) => measured),
  y: points.map(({value}) => value),
  error_y: {
    type: 'data',
    array: points.map(({U95}) => U95 ?? 0),
    color: colours.muted,
    thickness: 1,
    width: 3,
  },
  marker: {size: 7, color: colours.mean, ...marker},
});

// The limit on each side that the figure may reach.
function limitTraces({limit, signed, points, line}, colours) {
  if (!isNumber(limit)) return [];
  const all = [...points.map(({measured}) => measured), ...(line?.measured ?? [])].sort();
  const sides = signed ? [limit, -limit] : [limit];
  return sides.map((at) => ({
                     type: 'scatter',
                     mode: 'lines',
                     name: 'limit',
                     x: [all[0], all.at(-1)],
                     y: [at, at],
                     line: {color: colours.fail, width: 1.5, dash: 'dash'},
                   }));
}

function trendPanel(series) {
  const unit = unitText(series.unit);
  const {line, points} = series;
  const used = points.filter((point) => point.used), others = points.filter(({used: in_fit}) => !in_fit);
  return {
    name: series.name,
    code: series.conditions,
    unit,
    width: 'half',
    height: 240,
    about: `${withConditions(series)} over time in ${unit}, with expanded uncertainty, fitted line ` +
        `and limit: ${series.words ?? 'too few campaigns for a rate'}; the values follow as a table.`,
    draw: (colours, shown) => ({
      data: [
        shown.has('band') && line ? bandTrace(line.measured, line.value, line.U95, colours.band) :
                                    null,
        shown.has('line') && line ? {
          type: 'scatter',
          mode: 'lines',
          name: 'fitted',
          x: line.measured,
          y: line.value,
          line: {color: colours.mean, width: 1.5}
        } :
                                    null,
        ...(shown.has('limit') ? limitTraces(series, colours) : []),
        pointTrace('measured', used, colours),
        others.length ?
            pointTrace(
                'left out', others, colours,
                {symbol: 'circle-open', color: colours.muted}) :
            null,
      ].filter(Boolean),
      layout: figureLayout(colours, {
        xaxis: {type: 'date', nticks: 5},
        yaxis: {title: {text: unit, font: {size: 12, color: colours.muted}, standoff: 6}}
      }),
    }),
    values: () => ({
      columns: [
        {head: 'Measured'}, {head: 'Campaign', numeric: true}, {head: 'Value', unit, numeric: true},
        {head: 'U\u2089\u2085', unit, numeric: true}, {head: 'In the fit'}
      ],
      rows: points.map(
          ({measured, campaign, value, U95, used: in_fit}) => {
            const text = rounded(value, U95);
            return [dateText(measured), String(campaign), text.value, text.U, in_fit ? 'yes' : 'no'];
          }),
    }),
  };
}

// A drift that nears its limit, else what drifts, else that nothing does.
function trendSummary(result) {
  const series = seriesOf(result);
  const named = (list) => joinWords(list.map(withConditions));
  const beyond = series.filter(({limit_reached: reached}) => reached?.already);
  const nearing =
      series.filter(({limit_reached: reached}) => reached?.expected && !reached.already);
  const drifting = series.filter(({fit}) => fit?.drifts);
  const sentences = [];
  const measured = beyond.filter(({limit_reached: reached}) => reached.measured !== false);
  const expected = beyond.filter(({limit_reached: reached}) => reached.measured === false);
  if (measured.length) sentences.push(`${named(measured)}: beyond the limit`);
  if (expected.length)
    sentences.push(`${named(expected)}: expected to be beyond the limit if the drift went on`);
  for (const one of nearing)
    sentences.push(`${withConditions(one)} reaches its limit about ${
        dayText(one.limit_reached.expected)}`);
  if (!sentences.length && drifting.length)
    sentences.push(`${named(drifting)} drift${drifting.length === 1 ? 's' : ''}`);
  return sentences.length ? `${capital(sentences.join('; '))}.` : 'No drift is seen.';
}

registerSection({
  command: 'history',
  kind: 'trend',
  title: (result) => `Trend: ${
      joinWords([...new Set(seriesOf(result).map(({object, name}) => object || name))])}`,
  short: (result) =>
      `Trend ${[...new Set(seriesOf(result).map(({object, name}) => object || name))].join(', ')}`,
  summary: trendSummary,
  facts: (result) =>
      [['Campaigns', new Set(seriesOf(result).flatMap(
                                 ({points}) => points.map(({campaign}) => campaign))).size]],
  body: (result) => [
      rateTable(result), figureGroup({
        title: 'Over time',
        intro: 'Points with their expanded uncertainty; the line is the fitted change with its ' +
            '95\u00a0% band, the dashed line the limit of the machine file.',
        items: [
          {key: 'line', label: 'Fitted', swatch: 'mean'}, {key: 'band', label: 'Band', swatch: 'band'},
          {key: 'limit', label: 'Limit', swatch: 'fail'}
        ],
        panels: seriesOf(result).map(trendPanel),
      }),
      notesBlock('Notes', [...(result.notes ?? []), ...seriesOf(result).flatMap(({notes}) => notes ?? [])])]
                          .filter(Boolean),
});
