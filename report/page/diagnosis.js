// The section of a diagnosis: the causes found, their rivals, causes that the runs cannot show, and
// what remains unexplained.

const VERDICTS = {
  clean: 'No cause was found, and the residuals need none.',
  explained: 'The causes found explain the runs completely.',
  ambiguous: 'There is a cause, but these runs cannot separate several candidates.',
  unexplained: 'Residuals remain that no known cause explains.',
  learned: 'No known cause explains the residuals; a learned term does.',
};
const EVIDENCE_SHOWN = 8;  // candidates before the list is folded

const kindOfCause = (id) => capital(String(id).replaceAll('-', ' '));

// "X" -> "axis X", "XY" -> "axes X and Y", "probe_a+probe_b" -> "probe a and probe b"
function objectName(object) {
  const text = String(object);
  if (/^[XYZ]$/.test(text)) return `axis ${text}`;
  if (/^[XYZ]{2}$/.test(text)) return `axes ${text[0]} and ${text[1]}`;
  return text.split('+').map((one) => one.replaceAll('_', ' ')).join(' and ');
}

// "backlash:X" -> "Backlash, axis X"
function candidateName(text) {
  const [cause, object] = String(text).split(':');
  return object ? `${kindOfCause(cause)}, ${objectName(object)}` : kindOfCause(cause);
}

const findingName = ({cause, object}) => candidateName(`${cause}:${object}`);
const percent = (share) =>
    isNumber(share) ? share > 0.999 ? 'over 99.9\u00a0%' : `${fixed(100 * share, 1)}\u00a0%` : null;

function diagnosisSummary(result) {
  const terms = (result.learned ?? []).filter(({found}) => found).map(({words}) => words);
  const found = [...terms, ...(result.findings ?? []).map(findingName)];
  const verdict = VERDICTS[result.verdict] ?? capital(String(result.verdict ?? ''));
  if (!found.length) return verdict;
  const told = result.verdict === 'unexplained' ? 'What would explain part of it' : 'Found';
  return `${verdict} ${told}: ${found.join('; ')}.`;
}

// "Width" of width_um: the unit has a column of its own.
const parameterName = ({name, quantity}) => capital(quantity ?? name);

function findingParameters({parameters}) {
  const told = (parameters ?? []).filter(({value}) => isNumber(value));
  if (!told.length) return null;
  return table({
    caption: 'Size, with its expanded uncertainty',
    columns: [{head: 'Size'}, {head: 'Value', numeric: true}, {head: 'Unit'}],
    rows: told.map((one) => [parameterName(one), quantity(one.value, one.u95), unitText(one.unit)]),
  });
}

const rootMeanSquare = (values) =>
    Math.sqrt(values.reduce((sum, value) => sum + value * value, 0) / values.length);

const HARDLY = 0.02;  // of the rms of all rows: less looks like nothing beside a probability

// The result in all held-out rows: a mean over them hides a cause that acts in a few.
function heldOutSum(before, after, rows) {
  if (!isNumber(rows)) return null;
  const gain = rows * (before ** 2 - after ** 2);
  const sum = `chi-square over these ${grouped(rows)} rows falls by ${significant(gain)}`;
  if (gain <= 0) return `in these ${grouped(rows)} rows there is no gain: do not rely on it yet`;
  return before - after > HARDLY * before ?
      sum :
      `${sum}: an rms is a mean over all rows, few of which this cause affects; the probability ` +
          'follows from their sum';
}

// The gain in the channel of the cause in its own unit, then in all rows, fitted and held out.
function findingWorth({curve, rms_before: before, rms_after: after, ...heldOut}, held) {
  const {heldout_rms_before: heldBefore, heldout_rms_after: heldAfter} = heldOut;
  const pair = (one, other) => `${one} without it, ${other} with it`;
  const where = curve?.x?.length ?
      `Where it shows ${pair(...[curve.before, curve.after].map(
          (values) => `${significant(rootMeanSquare(numbers(values)))}\u00a0${unitText(curve.unit)}`))}` :
      null;
  const rows = isNumber(heldBefore) ?
      `in units of the stated noise ${pair(fixed(before, 3), fixed(after, 3))}; in held-out ` +
          `rows ${pair(fixed(heldBefore, 3), fixed(heldAfter, 3))}` :
      null;
  const told = [where, rows].filter(Boolean);
  if (!told.length) return null;
  const sum = rows ? heldOutSum(heldBefore, heldAfter, held?.rows) : null;
  return [`${capital(told.join('; '))} (rms of measured minus simulated)`, sum && capital(sum)]
      .filter(Boolean)
      .join('. ');
}

// "One of these: 4.27 Hz, 27.99 Hz": waves that the sampling of the runs shows alike.
function oneOfThese({one_of: waves, parameters}) {
  if (!waves?.length) return null;
  const unit = unitText((parameters ?? []).find(({name}) => name === waves[0].name)?.unit);
  return `One of these: ${waves.map(({value}) => `${plain(value)}\u00a0${unit}`.trim()).join(', ')}`;
}

function findingWords(finding, held) {
  const {probability, words = {}, parameters, doubts = []} = finding;
  const sensor = (parameters ?? []).find(({name}) => name === 'sensor')?.value;
  return factList([
    ['Probability', percent(probability)],
    ['Not certain', doubts.length ? capital(doubts.join('; ')) : null, true],
    ['Which one', oneOfThese(finding), true], ['Follows the sensor', sensor],
    ['Gain', findingWorth(finding, held), true],
    ['What it is', words.what && capital(words.what), true],
    ['How it shows', words.shows && capital(words.shows), true],
    ['What to check', words.check && capital(words.check), true],
    ['What to do', words.remedy && capital(words.remedy), true]
  ]);
}

// Measured minus simulated over the variable of the cause, without and with it.
function findingCurve(finding) {
  const {variable, unit, x, before, after} = finding.curve ?? {};
  if (!x?.length) return null;
  const shown = unitText(unit);
  const curves = [
    ['before', 'without the causes found', before, 'backward'],
    ['after', 'with them', after, 'mean']
  ];
  const panel = {
    name: 'Measured minus simulated',
    unit: shown,
    height: 280,
    about: `Measured minus simulated over ${variable} in ${shown}, without and with the causes found; the values follow as a table.`,
    draw: (colours, on) => ({
      data: curves.filter(([key, , y]) => y && on.has(key))
                .map(
                    ([, label, y, colour]) => lineTrace(
                        label, x, y, colours[colour], shown,
                        {mode: 'markers', marker: {size: 4, color: colours[colour]}})),
      layout: figureLayout(colours, {x: variable}),
    }),
    values: () => ({
      columns: [
        {head: variable, numeric: true},
        ...curves.map(([, label]) => ({head: capital(label), unit: shown, numeric: true}))
      ],
      rows: x.map((at, i) => [plain(at), significant(before?.[i]), significant(after?.[i])]),
    }),
  };
  return figureGroup({
    title: 'Where it shows',
    items: [
      {key: 'before', label: 'Without the causes found', swatch: 'backward'},
      {key: 'after', label: 'With them', swatch: 'mean'}
    ],
    panels: [panel],
  });
}

const findingGroup = (finding, held) => element(
    'section', {class: 'group'}, element('h3', {}, findingName(finding)),
    findingWords(finding, held),
    findingParameters(finding), findingCurve(finding));

function rivalsTable(result) {
  const rivals = result.rivals ?? [];
  if (!rivals.length) return null;
  const list = (items) =>
      element('ul', {class: 'plain'}, items.map((one) => element('li', {}, one)));
  return table({
    caption: 'Alternative causes, and the run that separates them',
    columns: [
      {head: 'Causes'}, {head: 'Probability', numeric: true}, {head: 'Run to make next'},
      {head: 'Expected probability then', numeric: true}
    ],
    rows: rivals.map(
        ({causes, odds, next_run: next, expected_odds: then}) =>
            [list((causes ?? []).map(candidateName)), list((odds ?? []).map(percent)), next ?? null,
             percent(then)]),
  });
}

function evidenceTable(result) {
  const all = [...(result.evidence ?? [])].sort((a, b) => b.log_evidence - a.log_evidence);
  if (!all.length) return null;
  const made = (caption, rows) => table({
    caption,
    columns: [
      {head: 'Cause, alone'}, {head: 'Evidence for it', unit: 'ln', numeric: true},
      {head: 'A usual size stands out by', unit: 'std. dev.', numeric: true}
    ],
    rows: rows.map(
        (one) =>
            [findingName(one), fixed(one.log_evidence, 1),
             fixed(one.visible_sd, one.visible_sd < 10 ? 1 : 0)]),
  });
  const rest = all.slice(EVIDENCE_SHOWN);
  return [
    made('All candidates against the runs, the most probable first', all.slice(0, EVIDENCE_SHOWN)),
    rest.length ? element(
                      'details', {class: 'values group'},
                      element('summary', {}, `${rest.length} more candidates`),
                      made('The other candidates', rest)) :
                  null,
  ];
}

function cannotShowBlock(result) {
  return notesBlock(
      'These runs cannot show, so there is no statement about them:',
      (result.cannot_show ?? []).map(candidateName));
}

// What is left that depends on no variable: of one thing, and of many.
const WITHOUT_VARIABLE = {
  'scatter': ['scatters beyond its stated noise', 'scatter beyond their stated noise'],
  'scatter at rest': ['scatters where nothing moves', 'scatter where nothing moves'],
  'memory': [
    'is correlated from one reading to the next', 'are correlated from one reading to the next'
  ],
};
const OBJECTS_SHOWN = 4;  // before the others are folded

// A run keeps its name as it is.
const isOfRun = ({variable}) => variable === 'scatter' || variable === 'memory';
const leftName = (left) => isOfRun(left) ? left.object : objectName(left.object);

// Where other variables do as well, none of them is certain.
const oneOf = ({object, one_of: others}) => (others ?? []).map(
    (other, i) => `${i ? ', ' : ' or with one of these: '}${other.variable}${
        other.object === object ? '' : ` of ${objectName(other.object)}`}`).join('');

const whatItDoes = (left, many) => {
  const {variable, from, to, variable_unit: unit} = left;
  if (WITHOUT_VARIABLE[variable]) return WITHOUT_VARIABLE[variable][many ? 1 : 0];
  if (!isNumber(from)) return `${many ? 'vary' : 'varies'} with ${variable}${oneOf(left)}`;
  const [first, last] = [from, to].map((border) => plain(Number(border.toPrecision(4))));
  return `${many ? 'are' : 'is'} offset where ${variable} is ${first} to ${last}\u00a0${unit},${
      oneOf(left)}`;
};

const WHAT_FOLLOWS = {
  'scatter at rest':
      'look for a bad contact, a loose mounting or a source of interference, or state the true noise in the machine file',
  'scatter':
      'no known cause makes it; look for what disturbs, or state the true noise in the machine file',
};

// What does the same, together, the largest first.
function alikeLeft(left) {
  const groups = new Map();
  for (const one of left) {
    const key = `${whatItDoes(one, true)} ${one.unit}`;
    groups.set(key, [...(groups.get(key) ?? []), one]);
  }
  return [...groups.values()].map((group) => group.sort((a, b) => b.amplitude - a.amplitude));
}

function leftTogether(group) {
  const [most] = group;
  const names = [...new Set(group.map(leftName))];
  const many = names.length > 1;
  const shown = names.length > OBJECTS_SHOWN + 1 ? names.slice(0, OBJECTS_SHOWN) : names;
  const objects = shown.length < names.length ?
      `${shown.join(', ')} and ${names.length - shown.length} more` :
      shown.join(', ').replace(/, ([^,]*)$/, ' and $1');
  const [least, largest] = [group.at(-1), most].map(({amplitude}) => significant(amplitude));
  const sizes = least === largest ? largest : `${least} to ${largest}`;
  const p = Math.max(...group.map(({p_value: chance}) => chance));
  return `${isOfRun(most) ? objects : capital(objects)} ${whatItDoes(most, many)} by ${sizes}\u00a0${unitText(most.unit)} (${
      chanceText(p, group.length > 1)}): ${
      WHAT_FOLLOWS[most.variable] ?? 'no known cause makes it'}`;
}

// Below the smallest number it is no 0.
const chanceText = (p, many) => p < 1e-300 ?
    'p below 1e-300' :
    `p ${many ? 'at most' : '='} ${plain(Number(p.toPrecision(1)))}`;

// Each of the groups that do not fit into their line.
function leftoversOneByOne(left) {
  const folded = alikeLeft(left).filter((group) => group.length > OBJECTS_SHOWN + 1).flat();
  if (!folded.length) return null;
  return element(
      'details', {class: 'values group'},
      element('summary', {}, `Each of these ${folded.length}`), table({
        caption: 'What is left unexplained, one by one',
        columns: [
          {head: 'Channel or run'}, {head: 'It'}, {head: 'Size', numeric: true}, {head: 'Unit'},
          {head: 'p', numeric: true}
        ],
        rows: folded.map((one) => [
          isOfRun(one) ? one.object : capital(objectName(one.object)), whatItDoes(one, false), significant(one.amplitude),
          unitText(one.unit), chanceText(one.p_value, false).replace(/^p (= )?/, '')
        ]),
      }));
}

// What was left before anything was learned stands there too, where a term explains it.
function leftoverBlock(result) {
  const learned = result.verdict === 'learned';
  const left = (learned ? result.left_before_learning : result.unexplained) ?? [];
  return [
    notesBlock(learned ? 'Left by the known causes:' : 'Left unexplained:', alikeLeft(left).map(leftTogether)),
    leftoversOneByOne(left)
  ];
}

const REGIMES = {
  holds: 'the outer fifths of the range ask for the same size',
  fails: 'the outer fifths of the range ask for another size: valid between what was measured',
  untold: 'the outer fifths of the range cannot tell: valid between what was measured',
};

// A term that no known cause makes: in words, why it is believed, and where it shows.
function learnedGroup(term) {
  const why = term.certificate ?? {};
  const nearest = why.nearest ?
      `; the nearest known cause is ${candidateName(why.nearest)}, cosine ${fixed(why.cosine, 2)}` :
      '';
  return element(
      'section', {class: 'group'},
      element('h3', {}, `${term.found ? 'Learned' : 'Not certain'}: ${term.words}`), factList([
        ['Expression', `${term.expression} in ${objectName(term.object)}`, true],
        ['Effect', `${significant(term.amplitude)}\u00a0${unitText(term.unit)} rms`],
        ['Not certain', (term.doubts ?? []).length ? capital(term.doubts.join('; ')) : null, true],
        ['Chance that noise makes as much', isNumber(why.by_chance) ? plain(Number(why.by_chance.toPrecision(1))) : null],
        ['Held-out rows, in their noise', why.heldout_rms_before > 0 ?
           `${fixed(why.heldout_rms_before, 3)} without it, ${fixed(why.heldout_rms_after, 3)} with it` :
           null],
        ['Elsewhere', term.smooth || !why.regime ? null : capital(REGIMES[why.regime] ?? ''), true],
        ['Could be imitated', !isNumber(why.imitated) ? null : `${fixed(100 * why.imitated, 0)}\u00a0% of its effect by parameters of the simulation${nearest}`, true],
        ['Or at', (term.alike ?? []).length ? `${term.alike.map(objectName).join('; ')}, which these runs show alike` : null, true],
        ['Or one of', (term.group ?? []).map(candidateName).join('; ') || null, true],
        ['Suggestion', term.suggestion ? `Such things are made by ${term.suggestion}` : null, true],
      ]),
      findingCurve(term));
}

const inPart = (result) => result.verdict === 'unexplained' && result.findings?.length ?
    element('p', {}, 'What would explain part of it, but is not certain beside what is left:') :
    null;

function gainTable(result) {
  const {heldout, chi2_per_row_before: before, chi2_per_row_after: after} = result;
  const rows = [
    isNumber(before) ? ['All runs', Math.sqrt(before), Math.sqrt(after)] : null,
    heldout ?
        [`${grouped(heldout.rows)} held-out rows`, heldout.rms_before, heldout.rms_after] :
        null
  ].filter(Boolean);
  if (!rows.length || !result.findings?.length) return null;
  return table({
    caption: 'Measured minus simulated, in units of the stated noise (1: noise only)',
    columns: [
      {head: 'Rows'}, {head: 'Without the causes found', numeric: true},
      {head: 'With them', numeric: true}
    ],
    rows: rows.map(([name, ...both]) => [name, ...both.map((one) => fixed(one, 3))]),
  });
}

registerSection({
  command: 'diagnose',
  weight: 1,
  title: () => 'Diagnosis: what the simulation lacks',
  short: () => 'Diagnosis',
  summary: diagnosisSummary,
  facts: (result) => [
      ['Verdict', capital(String(result.verdict ?? ''))],
      ['Recordings', (result.recordings ?? []).join(', '), true], ['Extended model', result.model],
      ['The error map changes by up to', result.map_change_um > 0 && result.findings?.length ?
         `${significant(result.map_change_um)}\u00a0\u00b5m` : null]],
  body: (result) => [...leftoverBlock(result), ...(result.learned ?? []).map(learnedGroup), inPart(result), ...(result.findings ?? []).map((one) => findingGroup(one, result.heldout)),
                     rivalsTable(result), gainTable(result), evidenceTable(result),
                     cannotShowBlock(result)]
                        .flat()
                        .filter(Boolean),
  overview: {
    title: 'Diagnosis',
    columns: [
      {head: 'Verdict'}, {head: 'Found'}, {head: 'Held out, without', numeric: true},
      {head: 'Held out, with', numeric: true}
    ],
    row: (result) =>
        [capital(String(result.verdict ?? '')),
         [...(result.findings ?? []).map(findingName),
          ...(result.learned ?? []).filter(({found}) => found).map(({words}) => words)].join('; ') || 'nothing',
         ...['rms_before', 'rms_after'].map(
             (key) => isNumber(result.heldout?.[key]) ? fixed(result.heldout[key], 3) : null)],
  },
});
