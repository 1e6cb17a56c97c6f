// The section of an investigation: a time line of its runs, what each was expected to tell and what
// came, and the runs that were weighed beside it.

const stepEnd = (steps, index) =>
    steps.slice(0, index + 1).reduce((sum, {minutes}) => sum + minutes.total, 0);

const doneSteps = (result) => (result.steps ?? []).filter(({file}) => file);


const cameText = ({after}) => {
  if (!after) return 'not diagnosed yet';
  const found = after.findings.map(({name, probability}) => `${name} ${fixed(probability, 3)}`);
  return [after.verdict, ...found, ...after.left.map((left) => `left: ${left}`)].join('; ');
};

// One bar a run, as long as it took: set-up, waiting and run one after the other.
function timeLine(result) {
  const steps = doneSteps(result);
  const whole = Math.max(stepEnd(steps, steps.length - 1), 1e-9);
  const share = (minutes) => `width: ${(100 * minutes / whole).toFixed(3)}%`;
  const part = (kind, minutes) =>
      minutes > 0 ? element('span', {class: `part ${kind}`, style: share(minutes)}) : null;
  const bar = (step, index) => element(
      'li', {class: step.after?.certain ? 'certain' : null},
      element(
          'div', {class: 'when'},
          `${fixed(stepEnd(steps, index) - step.minutes.total, 0)} to ` +
              `${fixed(stepEnd(steps, index), 0)}\u00a0min`),
      element(
          'div', {class: 'what'}, element('strong', {}, capital(step.text)),
          element(
              'div', {class: 'bar', 'aria-hidden': 'true'},
              element(
                  'span',
                  {class: 'before', style: share(stepEnd(steps, index) - step.minutes.total)}),
              part('setup', step.minutes.set_up), part('waiting', step.minutes.waiting),
              part('run', step.minutes.run)),
          element('p', {class: 'came'}, cameText(step))));
  return element(
      'div', {class: 'group'},
      element(
          'p', {class: 'keys'}, element('span', {class: 'key setup'}), 'set up ',
          element('span', {class: 'key waiting'}), 'wait ', element('span', {class: 'key run'}),
          'run'),
      element('ol', {class: 'timeline', 'aria-label': 'Time line of the runs'}, steps.map(bar)));
}

const weighedTable = (result) => table({
  caption: 'What each run was expected to tell',
  columns: [
    {head: 'Run'}, {head: 'Open before', unit: 'bits', numeric: true},
    {head: 'Expected', unit: 'bits', numeric: true}, {head: 'Took', unit: 'min', numeric: true},
    {head: 'The next best'}
  ],
  rows: (result.steps ?? [])
            .map(
                ({text, before, bits, minutes}) =>
                    [capital(text), fixed(before.entropy_bits, 2), fixed(bits, 3),
                     fixed(minutes.total, 1), before.weighed[1]?.text ?? null]),
});

registerSection({
  command: 'investigate',
  title: () => 'Investigation',
  short: () => 'Investigation',
  summary: (result) => {
    const {ended} = result;
    const runs = doneSteps(result).length;
    if (!ended) return `${counted(runs, 'run')} so far; the investigation goes on.`;
    const sure = ended.certain ? 'certain' : 'not certain';
    return `After ${fixed(ended.minutes, 1)} minutes and ${counted(runs, 'run')} the verdict is ` +
        `${ended.verdict}, ${sure}: ${ended.why}.`;
  },
  facts: () => [],
  body: (result) =>
      [timeLine(result),
       element(
           'details', {class: 'fold group'},
           element('summary', {}, 'What was weighed before each run'), weighedTable(result))],
  overview: {
    title: 'Investigation',
    columns: [
      {head: 'Verdict'}, {head: 'Runs', numeric: true},
      {head: 'Machine time', unit: 'min', numeric: true}
    ],
    row: (result) =>
        [capital(result.ended?.verdict ?? 'goes on'), String(doneSteps(result).length),
         fixed(stepEnd(doneSteps(result), doneSteps(result).length - 1), 1)],
  },
});
