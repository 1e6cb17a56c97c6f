// The section of a check of figures against the limits of the machine file, and its table on top.

const LIMIT_VERDICTS = {
  pass: {mark: '\u2713', text: 'pass'},
  fail: {mark: '\u2717', text: 'fail'},
  undecided: {mark: '\u25cb', text: 'undecided'},
  'not measured': {mark: '\u2013', text: 'not measured'},
};

const checksOf = (result) => result.checks ?? [];

function verdictCell(verdict) {
  const {mark, text} = LIMIT_VERDICTS[verdict] ?? {mark: '', text: verdict};
  return element(
      'span', {class: `verdict ${verdict.replace(' ', '-')}`},
      element('span', {'aria-hidden': 'true'}, `${mark}\u00a0`), text);
}

// What fails first.
const VERDICT_ORDER = ['fail', 'undecided', 'pass', 'not measured'];
const byVerdict = (result) => [...checksOf(result)].sort(
    (one, other) => VERDICT_ORDER.indexOf(one.verdict) - VERDICT_ORDER.indexOf(other.verdict));

const withConditions = ({name, conditions}) => conditions ? `${name} (${conditions})` : name;

const CHECK_COLUMNS = [
  {head: 'Figure'}, {head: 'Verdict'}, {head: 'Value', numeric: true},
  {head: 'Limit', numeric: true}, {head: 'Unit'}
];

const checkRow = (check) =>
    [withConditions(check), verdictCell(check.verdict),
     isNumber(check.value) ? quantity(check.value, check.U95) : null, significant(check.limit),
     unitText(check.unit)];

function checkSummary(result) {
  const counts = result.counts ?? {};
  const part = (key, text) => counts[key] ? `${counts[key]} ${text}` : null;
  const parts = [
    part('pass', 'within their limits'), part('fail', 'beyond them'),
    part('undecided', 'undecided: the uncertainty reaches across the limit, or none is stated'),
    part('not measured', 'not measured')
  ].filter(Boolean);
  return `Of ${counted(checksOf(result).length, 'limit')} ${joinWords(parts)}.`;
}

registerSection({
  command: 'history',
  kind: 'check',
  weight: 3,
  title: (result) => `Limits: ${result.of}`,
  short: () => 'Limits',
  summary: checkSummary,
  facts: (result) => [['Rule', result.rule, true]],
  body: (result) => [table({
    caption: 'Figures and their limits',
    columns: [...CHECK_COLUMNS, {head: 'U\u2089\u2085 from'}],
    rows: byVerdict(result).map(
        (check) => [...checkRow(check),
                    isNumber(check.U95)       ? check.U95_from :
                        isNumber(check.value) ? 'none stated' :
                                                null]),
  })],
  overview: {
    title: 'Pass and fail',
    onTop: true,
    columns: CHECK_COLUMNS,
    rows: (result) => byVerdict(result).map(checkRow),
  },
});
