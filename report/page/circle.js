// The section of a circular test: figures of ISO 230-4, the circle with its deviation magnified,
// the path in space, harmonics, and the causes of the deviation.

const CIRCLE_FIGURES = [
  [
    'G_ccw_um', 'G(ccw)',
    'Circular deviation, counter-clockwise: the narrowest ring around the path'
  ],
  ['G_cw_um', 'G(cw)', 'Circular deviation, clockwise'],
  ['G_b_um', 'G(b)', 'The ring around both senses together'],
  ['F_max_um', 'F max', 'Largest radius minus the programmed one, about the set-up centre'],
  ['F_min_um', 'F min', 'Smallest radius minus the programmed one, about the set-up centre'],
  ['D_um', 'D', 'Mean radius of both senses minus the programmed one'],
];
// Without the programmed radius: not figures of the standard.
const RECORDED_FIGURES = [
  [
    'largest_beyond_recorded_um', 'Largest radius',
    'Minus that of the circle of the recorded positions, about the set-up centre'
  ],
  ['smallest_beyond_recorded_um', 'Smallest radius', 'Minus that of the recorded positions'],
  ['mean_beyond_recorded_um', 'Mean radius', 'Both senses, minus that of the recorded positions'],
];
const SENSES = [['ccw', 'counter-clockwise', 'forward'], ['cw', 'clockwise', 'backward']];
const SIGNATURE_NAMES = {
  scale: 'Scale',
  squareness: 'Squareness',
  servo_mismatch: 'Servo mismatch',
  servo_lag_squared: 'Servo lag, squared',
  backlash: 'Backlash',
  straightness: 'Bow',
  reversal_spike: 'Reversal spike',
  cyclic_cos: 'Cyclic, cosine',
  cyclic_sin: 'Cyclic, sine',
};
const SIGNATURE_UNITS = {
  m: '\u00b5m',
  rad: '\u00b5rad',
  s: '\u00b5s',
  s2: 'ms\u00b2',
  1: 'ppm'
};
const CIRCLE_SPAN = 1.45;  // half the width of the figure, radii

const runName = (circle, run) =>
    `${capital(circle.instrument)} ${circle.plane}, ${significant(run.feed_mm_min)}\u00a0mm/min`;
const runsOf = (result) =>
    (result.circles ?? []).flatMap((circle) => (circle.runs ?? []).map((run) => ({circle, run})));

function circleSummary(result) {
  const sentences = (result.circles ?? []).flatMap((circle) => {
    const widths =
        numbers((circle.runs ?? []).map((run) => run.G_b_um ?? run.G_ccw_um ?? run.G_cw_um));
    if (!widths.length) return [];
    return [
      `${circle.instrument} ${circle.plane}: the path lies in a ring ` +
      `${micrometres(Math.max(...widths))} wide`
    ];
  });
  const found = (result.causes ?? [])
                    .filter(isFound)
                    .sort((one, other) => other.effect_um - one.effect_um)
                    .slice(0, 2)
                    .map((one) => `${signatureName(one)} (${micrometres(one.effect_um)})`);
  if (found.length) sentences.push(`most of it comes from ${joinWords(found)}`);
  return capital(sentences.join('; ')) + (sentences.length ? '.' : '');
}

const signatureName = ({cause, object, or}) =>
    `${SIGNATURE_NAMES[cause] ?? cause} ${object}${or ? ` or ${or}` : ''}`;
// Determined by the data, and beyond its U95.
const isBeyond = ({seen, value, u}) => seen && Math.abs(value) > COVERAGE * u;
const isFound = (one) => one.certain ?? isBeyond(one);

// With its expanded uncertainty, if known.
const circleFigure = (run, key) =>
    isNumber(run[key]) ? quantity(run[key], COVERAGE * (run.u?.[key] ?? 0)) : null;

function circleFigureTable(result, caption, figures) {
  const runs = runsOf(result);
  const known = figures.filter(([key]) => runs.some(({run}) => isNumber(run[key])));
  if (!known.length) return null;
  return table({
    caption,
    columns: [
      {head: 'Figure'},
      ...runs.map(
          ({circle, run}) => ({head: runName(circle, run), unit: '\u00b5m', numeric: true})),
      {head: 'Meaning'}
    ],
    rows:
        known.map(([key, symbol,
                    meaning]) => [symbol, ...runs.map(({run}) => circleFigure(run, key)), meaning]),
  });
}

function signatureTable(circle) {
  if (!circle.causes?.length) return null;
  const scale = 1e6;  // um, urad, us, ppm, and s2 to ms2
  return table({
    caption: `Causes by one joint fit: ${circle.instrument} ${circle.plane}`,
    columns: [
      {head: 'Cause'}, {head: 'Amount', numeric: true}, {head: 'Unit'},
      {head: 'On the radius', unit: '\u00b5m', numeric: true}, {head: 'Determined by the data'}
    ],
    rows: circle.causes.map(
        (one) =>
            [signatureName(one),
             one.seen ? quantity(one.value * scale, COVERAGE * one.u * scale) : null,
             SIGNATURE_UNITS[one.unit] ?? one.unit, one.seen ? significant(one.effect_um) : null,
             isFound(one) ? 'yes' :
                 isBeyond(one) ? 'not certain: too much is unexplained' :
                 one.seen ? 'below its uncertainty' :
                            'not seen']),
  });
}

// A magnification of 1, 2 or 5 times a power of ten near `value`.
function roundNumber(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * (value < 2 * power ? 1 : value < 5 * power ? 2 : 5);
}

const circleDeviation = (run) =>
    Math.max(1e-9, ...SENSES.map(([sense]) => largest(run.profile?.[sense]?.radial)));

// Magnifications from 10 to 100 000 in steps of 1, 2, 5; the first shown makes the largest
// deviation a fifth of `size`.
function magnifierFor(size, deviation) {
  const values = [1, 2, 3, 4].flatMap((power) => [1, 2, 5].map((one) => one * 10 ** power));
  values.push(1e5);
  const best = roundNumber(Math.min(1e5, Math.max(10, 0.2 * size / deviation)));
  return {
    label: 'Magnification',
    values,
    at: Math.max(0, values.indexOf(best)),
    text: (value) => `${grouped(value)}\u00a0\u00d7`
  };
}

const ARC_GAP = 0.3;  // rad between neighbours: the path was not measured there

// Lists along a circle, closed for a full circle, with a gap (NaN) where nothing was measured.
const ringOf = (angle) => (list) => {
  if (!list?.length) return [];
  const ring =
      list.flatMap((one, i) => i && angle[i] - angle[i - 1] > ARC_GAP ? [NaN, one] : [one]);
  return angle[0] + 2 * Math.PI - angle.at(-1) > ARC_GAP ? ring : [...ring, list[0]];
};

function circleTrace(name, radius, {angle, radial}, amount, line) {
  const r = radial.map((one) => radius + amount * one * 1e3);
  const ring = ringOf(angle);
  return {
    ...lineTrace(
        name, ring(angle.map((at, index) => r[index] * Math.cos(at))),
        ring(angle.map((at, index) => r[index] * Math.sin(at))), line.color, ''),
    line,
    text: ring(radial.map(
        (one, index) => `${fixed(angle[index] * 180 / Math.PI, 0)}\u00b0: ` +
            `${fixed(one * 1e6, 2)}\u00a0\u00b5m`)),
    hovertemplate: '%{text}',
  };
}

// The nominal circle and a ring inside and outside, each labelled with its deviation.
function circleRings(radius, amount, colours) {
  const step = roundNumber(0.3 * radius / amount * 1e3);  // um
  const turn = Array.from({length: 181}, (unused, index) => index * Math.PI / 90);
  return [-step, 0, step].map((at) => {
    const r = radius + amount * at * 1e-3;
    return {
      trace: {
        ...lineTrace(
            'ring', turn.map((t) => r * Math.cos(t)), turn.map((t) => r * Math.sin(t)),
            at ? colours.line : colours.axis, ''),
        line: {color: at ? colours.line : colours.axis, width: 1},
        hoverinfo: 'skip',
        hovertemplate: null,
      },
      label: {
        x: r * Math.SQRT1_2,
        y: r * Math.SQRT1_2,
        text: at ? `${at > 0 ? '+' : MINUS}${fixed(Math.abs(at), step < 1 ? 3 : 0)}\u00a0\u00b5m` :
                   '0',
        showarrow: false,
        font: {size: 11, color: colours.muted},
        bgcolor: colours.surface,
      },
    };
  });
}

// The names of the axes at the positive ends of the cross through the centre.
function circleAxes(circle, colours) {
  const [first, second] = circle.plane.length === 2 ? circle.plane : ['1', '2'];
  const at = 1.36 * circle.radius_mm;
  const line = (x, y) =>
      ({type: 'line', x0: -x, x1: x, y0: -y, y1: y, line: {color: colours.line, width: 1}});
  const name = (axis, x, y) => ({
    x,
    y,
    text: `+${axis}`,
    showarrow: false,
    font: {size: 13, color: colours.ink},
    bgcolor: colours.surface,
  });
  const reach = 1.28 * circle.radius_mm;
  return {
    shapes: [line(reach, 0), line(0, reach)],
    names: [name(first, at, 0), name(second, 0, at)],
  };
}

// An arrow from the start of a sense in its direction; both are inside the circle, one above the
// other if they start at the same place.
function senseArrows(circle, run, senses, colours) {
  const turn = 18 * Math.PI / 180;
  return senses.flatMap(([sense, , colour], index) => {
    const start = run.start_deg?.[sense];
    if (!isNumber(start)) return [];
    const r = (0.68 - 0.1 * index) * circle.radius_mm;
    const from = start * Math.PI / 180, to = from + (sense === 'ccw' ? turn : -turn);
    const place = (angle) => [r * Math.cos(angle), r * Math.sin(angle)];
    const [x, y] = place(to), [ax, ay] = place(from);
    const arrow = {
      x,
      y,
      ax,
      ay,
      xref: 'x',
      yref: 'y',
      axref: 'x',
      ayref: 'y',
      text: `${sense} from ${fixed(start, 0)}\u00b0`,
      showarrow: true,
      arrowhead: 2,
      arrowwidth: 1.8,
      arrowcolor: colours[colour],
      font: {size: 11, color: colours[colour]},
      xanchor: Math.cos(from) > 0 ? 'right' : 'left',
      yshift: index ? -9 : 9,
    };
    return [arrow];
  });
}

const squareLayout = (colours, span, extra) => figureLayout(colours, {
  hovermode: 'closest',
  ...extra,
  xaxis: {visible: false, range: [-span, span], scaleanchor: 'y', ...extra?.xaxis},
  yaxis: {visible: false, range: [-span, span], ...extra?.yaxis},
});

function polarPanel(circle, run) {
  const radius = circle.radius_mm;
  return {
    name: runName(circle, run),
    unit: '\u00b5m',
    width: 'half',
    height: 440,
    about: `Radial deviation of the ${circle.plane} circle, ${circle.instrument}, magnified, ` +
        'around the nominal circle; the values follow as a table.',
    draw: (colours, shown, amount) => {
      const rings = circleRings(radius, amount, colours);
      const axes = circleAxes(circle, colours);
      const senses = SENSES.filter(([sense]) => shown.has(sense) && run.profile?.[sense]);
      return {
        data: [
          ...rings.map(({trace}) => trace),
          ...senses.map(
              ([sense, name, colour]) => circleTrace(
                  name, radius, run.profile[sense], amount, {color: colours[colour], width: 1.8})),
          ...senses.filter(([sense]) => shown.has('explained') && run.profile[sense].explained)
              .map(
                  ([sense, name, colour]) => circleTrace(
                      `explained, ${name}`, radius,
                      {...run.profile[sense], radial: run.profile[sense].explained}, amount,
                      {color: colours[colour], width: 1.2, dash: 'dot'})),
        ],
        layout: squareLayout(colours, CIRCLE_SPAN * radius, {
          shapes: axes.shapes,
          annotations: [
            ...axes.names, ...rings.map(({label}) => label),
            ...senseArrows(circle, run, senses, colours)
          ],
        }),
      };
    },
    values: () => profileValues(run),
  };
}

function profileValues(run) {
  const known = SENSES.filter(([sense]) => run.profile?.[sense]);
  const rows = known.flatMap(
      ([sense, name]) => run.profile[sense].angle.map(
          (at, index) =>
              [fixed(at * 180 / Math.PI, 1), name, fixed(run.profile[sense].radial[index] * 1e6, 3),
               fixed((run.profile[sense].axial?.[index] ?? NaN) * 1e6, 3)]));
  const numeric = (head, unit) => ({head, unit, numeric: true});
  return {
    columns: [
      numeric('Angle', '\u00b0'), {head: 'Sense'}, numeric('Radial', '\u00b5m'),
      numeric('Out of plane', '\u00b5m')
    ],
    rows,
  };
}

function polarGroup(result) {
  const runs = runsOf(result).filter(({run}) => run.profile);
  if (!runs.length) return null;
  return figureGroup({
    title: 'The circle, its deviation magnified',
    intro:
        'About the least-squares centre of both senses, without the eccentricity of the set-up. ' +
        'Angles count from the first axis towards the second; an arrow marks start and direction ' +
        'of a sense. Dotted: the part that the causes of the joint fit explain.',
    items: [
      {key: 'ccw', label: 'Counter-clockwise', swatch: 'forward'},
      {key: 'cw', label: 'Clockwise', swatch: 'backward'},
      {key: 'explained', label: 'Explained', swatch: 'mean', on: false},
    ],
    slider: magnifierFor(
        Math.min(...runs.map(({circle}) => circle.radius_mm)) * 1e-3,
        Math.max(...runs.map(({run}) => circleDeviation(run)))),
    panels: runs.map(({circle, run}) => polarPanel(circle, run)),
  });
}

// The circle in its own frame: first, second, out of plane; position and deviation in m.
function circleInSpace(circle, profile) {
  const radius = circle.radius_mm * 1e-3;
  const [angle, radial, axial] =
      [profile.angle, profile.radial, profile.axial].map(ringOf(profile.angle));
  const [cos, sin] = [angle.map(Math.cos), angle.map(Math.sin)];
  return {
    position: [cos.map((one) => radius * one), sin.map((one) => radius * one), angle.map(() => 0)],
    deviation: [radial.map((one, i) => one * cos[i]), radial.map((one, i) => one * sin[i]), axial],
  };
}

function circleSpaceGroup(result) {
  const runs =
      runsOf(result).filter(({run}) => SENSES.some(([sense]) => run.profile?.[sense]?.axial));
  return spaceGroup(
      runs.map(({circle, run}) => {
        const known = SENSES.filter(([sense]) => run.profile[sense]?.axial);
        const [first, second] = circle.plane.length === 2 ? circle.plane : ['1', '2'];
        const third = 'XYZ'.split('').find((axis) => !circle.plane.includes(axis)) ?? '3';
        return {
          name: runName(circle, run),
          axes: circle.plane.length === 2 ? [first, second, third] : ['1', '2', '3'],
          paths: known.map(
              ([sense, name, colour]) =>
                  ({key: sense, name, colour, ...circleInSpace(circle, run.profile[sense])})),
        };
      }),
      SENSES.map(([key, name, swatch]) => ({key, label: capital(name), swatch})));
}

function harmonicPanel(circle, run) {
  const known = SENSES.filter(([sense]) => run.harmonics?.[sense]?.length);
  return {
    name: runName(circle, run),
    unit: '\u00b5m',
    width: 'half',
    height: 240,
    about: `Amplitude of the harmonics of the radius, ${circle.plane} circle, ` +
        `${circle.instrument}, both senses; the values follow as a table.`,
    draw: (colours, shown) => ({
      data: known.filter(([sense]) => shown.has(sense))
                .map(([sense, name, colour]) => ({
                       type: 'bar',
                       name,
                       x: run.harmonics[sense].map(({order}) => order),
                       y: run.harmonics[sense].map(({amplitude_um}) => amplitude_um),
                       marker: {color: colours[colour]},
                       hovertemplate: '%{y:.3f}\u00a0\u00b5m',
                     })),
      layout: figureLayout(
          colours, {x: 'Undulations per turn', xaxis: {dtick: 1}, bargap: 0.35, bargroupgap: 0.1}),
    }),
    values: () => ({
      columns: [
        {head: 'Order', numeric: true}, {head: 'Sense'},
        {head: 'Amplitude', unit: '\u00b5m', numeric: true},
        {head: 'Phase', unit: '\u00b0', numeric: true}
      ],
      rows: known.flatMap(
          ([sense, name]) => run.harmonics[sense].map(
              ({order,
                amplitude_um,
                phase_deg}) => [String(order), name, fixed(amplitude_um, 3), fixed(phase_deg, 1)])),
    }),
  };
}

function harmonicGroup(result) {
  const runs =
      runsOf(result).filter(({run}) => SENSES.some(([sense]) => run.harmonics?.[sense]?.length));
  if (!runs.length) return null;
  return figureGroup({
    title: 'Harmonics of the radius',
    intro: 'Two per turn is an oval: squareness, scales and servo mismatch together. A single ' +
        'harmonic does not identify a cause; the joint fit does.',
    items: SENSES.map(([key, name, swatch]) => ({key, label: capital(name), swatch})),
    panels: runs.map(({circle, run}) => harmonicPanel(circle, run)),
  });
}

// The parameters of the linkage: {parameters, file, model, mapped, held_out_rms_um}.
function linkageText(linkage) {
  if (!linkage) return null;
  if (linkage.parameters !== 'calibrated') return 'its nominal parameters';
  const rms = linkage.held_out_rms_um;
  return `${linkage.file}, model ${linkage.model}${linkage.mapped ? ', mapped' : ''}` +
      (isNumber(rms) ? `, held-out rms ${micrometres(rms)}` : '');
}

// Only for a part of the circle: "240 degrees counter-clockwise, 120 clockwise".
function coveredText(result) {
  const part = runsOf(result).map(({run}) => run).find((run) => run.partial);
  if (!part) return null;
  return SENSES.filter(([sense]) => part.covered_deg?.[sense] > 0)
      .map(([sense, name]) => `${fixed(part.covered_deg[sense], 0)}\u00b0 ${name}`)
      .join(', ');
}

registerSection({
  command: 'circle',
  title: (result) =>
      `${result.partial ? 'Part of a circle' : 'Circular test'}, ${result.plane} plane`,
  short: (result) => `Circle ${result.plane}`,
  summary: circleSummary,
  facts: (result) => [
      [
        'Radius',
        isNumber(result.radius_mm) ?
            `${positionText(Number(result.radius_mm.toFixed(3)))}\u00a0mm, ${
                result.radius_is ?? 'nominal'}` :
            null
      ],
      [
        'Filter',
        result.circles?.[0]?.filter_undulations ?
            `${positionText(result.circles[0].filter_undulations)} undulations per turn` :
            'none'
      ],
      ['Linkage read with', linkageText(result.linkage)], ['Covered', coveredText(result)],
      ['Recordings', [...new Set(runsOf(result).flatMap(({run}) => run.recordings))].join(', ')]],
  body: (result) => [circleFigureTable(result, 'Figures of ISO\u00a0230-4', CIRCLE_FIGURES),
                     circleFigureTable(
                         result, 'Not figures of the standard: the programmed radius is unknown',
                         RECORDED_FIGURES),
                     polarGroup(result), circleSpaceGroup(result),
                     harmonicGroup(result), ...(result.circles ?? []).map(signatureTable),
                     notesBlock('Notes', result.notes)]
                        .filter(Boolean),
  overview: {
    title: 'Circular tests (ISO\u00a0230-4)',
    columns: [
      {head: 'Plane'}, {head: 'Instrument'},
      ...CIRCLE_FIGURES.map(([, symbol]) => ({head: symbol, unit: '\u00b5m', numeric: true}))
    ],
    row: (result) =>
        [result.plane, result.circles?.[0]?.instrument,
         ...CIRCLE_FIGURES.map(([key]) => circleFigure(result, key))],
  },
});
