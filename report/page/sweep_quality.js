// Figures of the quality of an axis sweep: uncertainty budget, residuals, noise.

// --- uncertainty budget

const CAUSE_NAMES = {
  noise: 'Noise',
  gain: 'Probe gain',
  position: 'Probe positions',
  installation: 'Probe installation',
  form: 'Form of the target',
  squareness: 'Squareness of the target',
  drift: 'Drift',
  model: 'Model',
};
const causeName = (cause) => CAUSE_NAMES[cause] ?? capital(cause.replaceAll('_', ' '));

function budgetPanel(result, components, causes) {
  const u = (component, cause) => typical(result.budget[component][cause]) || 0;
  const total = (component) => Math.hypot(...causes.map((cause) => u(component, cause)));
  const label = (component) => {
    const unit = unitOf(result.errors?.[component] ?? {unit: 'm'});
    const U = coverageOf(result.errors?.[component] ?? {}) * total(component) * unit.scale;
    return `${fixed(U, placesFor(U, 2))}\u00a0${unit.name}`;
  };
  return {
    name: 'Shares of the variance',
    unit: '%',
    height: 64 + 36 * components.length,
    about:
        'Stacked bars: the share of each cause in the variance of each component; the standard ' +
        'uncertainties follow as a table.',
    draw: (colours, shown) => ({
      data: causes.map(
          (cause, index) => ({
            type: 'bar',
            orientation: 'h',
            name: causeName(cause),
            width: 0.5,
            y: components,
            x: components.map(
                (component) => 100 * (u(component, cause) / total(component)) ** 2 || 0),
            marker: {color: colours.series[index % 6], line: {color: colours.surface, width: 1}},
            visible: shown.has(cause),
            hovertemplate: `${causeName(cause)} %{x:.0f}\u00a0%<extra></extra>`,
          })),
      layout: figureLayout(colours, {
        barmode: 'stack',
        hovermode: 'closest',
        yaxis: {
          autorange: 'reversed',
          fixedrange: true,
          showgrid: false,
          ticksuffix: '  ',
          tickfont: {size: 13, color: colours.ink}
        },
        xaxis: {range: [0, 100], showline: false, fixedrange: true},
        margin: {l: 8, r: 96, t: 22, b: 8},
        annotations: [
          {
            text: '<i>U</i><sub>95</sub>',
            xref: 'paper',
            x: 1,
            xshift: 88,
            xanchor: 'right',
            yref: 'paper',
            y: 1,
            yanchor: 'bottom',
            showarrow: false,
            font: {color: colours.muted, size: 12}
          },
          ...components.map((component) => ({
                              text: label(component),
                              xref: 'paper',
                              x: 1,
                              xshift: 88,
                              xanchor: 'right',
                              y: component,
                              yanchor: 'middle',
                              showarrow: false
                            })),
        ],
      }),
    }),
    values: () => ({
      columns: [
        {head: 'Component'}, {head: 'Unit'},
        ...causes.map((cause) => ({head: causeName(cause), numeric: true})),
        {head: 'Together', numeric: true}
      ],
      rows: components.map((component) => {
        const unit = unitOf(result.errors?.[component] ?? {unit: 'm'});
        const text = (value) => value > 0 ? significant(value * unit.scale, 2) : '0';
        return [
          component, unit.name, ...causes.map((cause) => text(u(component, cause))),
          text(total(component))
        ];
      }),
    }),
  };
}

function budgetGroup(result) {
  const components = Object.keys(result.budget);
  const causes =
      [...new Set(components.flatMap((component) => Object.keys(result.budget[component])))];
  return figureGroup({
    title: 'Uncertainty budget',
    intro: 'Where the uncertainty comes from. The widest share is what to improve first.',
    items: causes.map(
        (key, index) => ({key, label: causeName(key), swatch: `series-${index % 6 + 1}`})),
    panels: [budgetPanel(result, components, causes)],
  });
}

// --- residuals and noise

const probeName = (probe) =>
    capital(probe.replace(/^probe_(.)$/, (whole, letter) => `probe ${letter.toUpperCase()}`)
                .replaceAll('_', ' '));

// One lane per probe over a common time, all to one scale, so that patterns are visible.
function residualPanel(result, probes) {
  const unit = lengthUnit(Math.max(...probes.map((probe) => largest(result.residuals[probe]))));
  const time = scaled(result.dwells?.time_s, 1 / 60);
  const x = time.length ? time : result.residuals[probes[0]].map((value, index) => index + 1);
  const span =
      1.1 * unit.scale * Math.max(...probes.map((probe) => largest(result.residuals[probe])));
  return {
    name: 'Residual of each dwell',
    unit: unit.name,
    height: 56 + 72 * probes.length,
    about:
        `Reading of each probe at each dwell minus the mean of its station and direction, over time, in ${
            unit.name}; ` +
        'root mean squares follow as a table.',
    draw: (colours, shown) => ({
      data: probes.flatMap(
          (probe, lane) =>
              directionsOf(result, x)
                  .filter(({key}) => !key || shown.has(key))
                  .map(({key, sign}) => ({
                         type: 'scatter',
                         mode: 'markers',
                         name: probeName(probe),
                         yaxis: laneName('y', lane),
                         x,
                         y: scaled(result.residuals[probe], unit.scale)
                                .map(
                                    (value, index) =>
                                        !key || result.dwells.direction[index] === sign ? value :
                                                                                          null),
                         marker: {size: 3, color: colours[key ?? 'mean']},
                         hovertemplate: `%{y:.1f}\u00a0${unit.name}`,
                       }))),
      layout: residualLayout(
          colours, probes, span, time.length ? 'Time since the start (min)' : 'Dwell'),
    }),
    values: () => ({
      columns: [
        {head: 'Probe'}, {head: `Root mean square, ${unit.name}`, numeric: true},
        {head: `Largest, ${unit.name}`, numeric: true}
      ],
      rows: probes.map(
          (probe) =>
              [probeName(probe), significant(typical(result.residuals[probe]) * unit.scale),
               significant(largest(result.residuals[probe]) * unit.scale)]),
    }),
  };
}

const DIRECTIONS = [
  {key: 'forward', label: 'Forward', swatch: 'forward', sign: 1},
  {key: 'backward', label: 'Backward', swatch: 'backward', sign: -1}
];
const directionsOf = (result, x) =>
    result.dwells?.direction?.length === x.length ? DIRECTIONS : [{}];
const laneName = (axis, lane) => lane === 0 ? axis : `${axis}${lane + 1}`;

// The largest of 1, 2, 5 times a power of ten that leaves room below `span`.
function roundStep(span) {
  const power = 10 ** Math.floor(Math.log10(0.75 * span));
  return power * [5, 2, 1].find((step) => step * power <= 0.75 * span);
}

function residualLayout(colours, probes, span, x) {
  const layout = figureLayout(colours, {
    x,
    hovermode: 'closest',
    margin: {l: 64, r: 10, t: 4, b: 8},
    xaxis: {anchor: laneName('y', probes.length - 1)}
  });
  const share = 1 / probes.length;
  layout.annotations = probes.map((probe, lane) => ({
                                    text: probeName(probe),
                                    xref: 'paper',
                                    x: 0,
                                    xanchor: 'right',
                                    xshift: -12,
                                    yref: 'paper',
                                    y: 1 - (lane + 0.5) * share,
                                    yanchor: 'middle',
                                    showarrow: false,
                                    font: {size: 12, color: colours.ink}
                                  }));
  probes.forEach((probe, lane) => {
    layout[laneName('yaxis', lane)] = {
      ...layout.yaxis,
      range: [-span, span],
      side: 'right',
      showgrid: false,
      tickvals: [-roundStep(span), 0, roundStep(span)],
      domain: [1 - (lane + 0.92) * share, 1 - (lane + 0.08) * share]
    };
  });
  return layout;
}

function noisePanel(result, probes) {
  const parts = [
    ['white_m', 'Noise of one reading', 'series-1'], ['drift_m', 'Drift', 'series-2']
  ].filter(([key]) => probes.some((probe) => isNumber(result.noise[probe][key])));
  const unit = lengthUnit(
      Math.max(...parts.map(([key]) => largest(probes.map((probe) => result.noise[probe][key])))));
  return {
    name: 'Noise of each probe',
    unit: unit.name,
    height: 240,
    about:
        `Bars: standard deviation of the noise and of the drift of each probe, in ${unit.name}; ` +
        'the values follow as a table.',
    draw: (colours) => ({
      data: parts.map(([key, name, swatch]) => ({
                        type: 'bar',
                        name,
                        x: probes.map(probeName),
                        marker: {color: colours[swatch]},
                        y: probes.map((probe) => (result.noise[probe][key] ?? 0) * unit.scale),
                        hovertemplate: `%{y:.1f}\u00a0${unit.name}`,
                      })),
      layout: figureLayout(colours, {
        showlegend: true,
        bargap: 0.55,
        bargroupgap: 0.08,
        legend: {orientation: 'h', x: 0, y: 1.02, yanchor: 'bottom', font: {size: 12}}
      }),
    }),
    values: () => ({
      columns: [
        {head: 'Probe'},
        ...parts.map(([, name]) => ({head: `${name}, ${unit.name}`, numeric: true})),
        {head: 'Correlation of neighbours', numeric: true}
      ],
      rows: probes.map(
          (probe) =>
              [probeName(probe),
               ...parts.map(([key]) => significant((result.noise[probe][key] ?? NaN) * unit.scale)),
               fixed(result.noise[probe].lag1 ?? NaN, 2)]),
    }),
  };
}

function chiSquareText({chi2, dof} = {}) {
  if (!isNumber(chi2) || !(dof > 0)) return '';
  const ratio = chi2 / dof;
  const half_width = 2.58 * Math.sqrt(2 / dof);  // of 99 %, normal approximation
  const verdict = Math.abs(ratio - 1) < half_width ? 'as large as the stated noise explains' :
      ratio > 1 ? 'larger than the stated noise explains: look for a disturbance' :
                  'smaller than the stated noise: the stated noise is too high';
  return ` The residuals are ${verdict} (chi-squared ${grouped(Math.round(chi2))} for ` +
      `${grouped(Math.round(dof))} degrees of freedom).`;
}

function quietGroup(result) {
  const residual = Object.keys(result.residuals ?? {})
                       .filter((probe) => numbers(result.residuals[probe]).length);
  const noise =
      Object.keys(result.noise ?? {})
          .filter((key) => result.noise[key] !== null && typeof result.noise[key] === 'object');
  return figureGroup({
    title: 'Residuals and noise',
    intro: 'Each dwell minus the mean of its station and direction. A pattern in time is a ' +
        'disturbance; an ' +
        `even cloud is noise.${chiSquareText(result.noise)}`,
    items: result.dwells?.direction && residual.length ? DIRECTIONS : [],
    panels: [
      residual.length ? residualPanel(result, residual) : null,
      noise.length ? noisePanel(result, noise) : null,
    ].filter(Boolean),
  });
}
