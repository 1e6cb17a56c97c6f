// The first screen, for a reader with a minute: pass or fail, the three largest errors, what to do,
// what to measure next. Each line leads to its section; what no result says is left out or said to
// be missing.

const LARGEST_SHOWN = 3;
const WORST_FIRST = ['fail', 'undecided', 'pass'];

const ofCommand = (sections, command) =>
    sections.filter(({result}) => result.command === command);
const latest = (sections) => sections.reduce(
    (last, section) => (section.result.started ?? section.result.time ?? '') >=
            (last?.result.started ?? last?.result.time ?? '') ?
        section :
        last,
    undefined);
const linkTo = (section, text) => element('a', {href: `#${section.id}`}, text);

const keptText = (count) => count === 1 ?
    'the one limit that was measured is kept' :
    `all ${counted(count, 'limit')} that were measured are kept`;

// [{verdict, section, text}] of limits, map and diagnosis.
function limitLine(sections) {
  const checks = sections.filter(
      ({result}) => result.command === 'history' && result.kind === 'check');
  if (!checks.length) return null;
  const all = checks.flatMap((section) => checksOf(section.result).map((one) => ({section, one})));
  const worst = WORST_FIRST.find((verdict) => all.some(({one}) => one.verdict === verdict));
  if (!worst) return null;
  const judged = all.filter(({one}) => one.verdict !== 'not measured');
  const mine = all.filter(({one}) => one.verdict === worst);
  const names = mine.slice(0, LARGEST_SHOWN).map(({one}) => one.name);
  const rest = mine.length - names.length;
  const text = worst === 'pass' ?
      keptText(judged.length) :
      `${mine.length} of ${counted(judged.length, 'limit')}: ${joinWords(names)}${
          rest > 0 ? ` and ${rest} more` : ''}`;
  return {verdict: worst, section: mine[0].section, text};
}

// What an error does at the end of the travels, in um: an angle turns the longest one.
function errorSizes(section) {
  const {map} = section.result;
  const grid = map?.grid ?? {};
  const spans = ['x', 'y', 'z'].map((axis) => grid[axis]).filter((list) => list?.length > 1);
  const longest = Math.max(0, ...spans.map((list) => list.at(-1) - list[0]));
  return Object.entries(map?.errors ?? {}).flatMap(([name, {unit, value, u}]) => {
    const sizes = numbers([value].flat()).map(Math.abs);
    if (!sizes.length) return [];
    const size = Math.max(...sizes), angle = unit === 'rad';
    const at = [value].flat().findIndex((one) => isNumber(one) && Math.abs(one) === size);
    const U = COVERAGE * ([u].flat()[at] ?? NaN);
    return [{name, section, angle, size, U, longest, effect: angle ? size * longest : size}];
  });
}

// Without a map: the ranges of the sweeps.
function sweepSizes(section) {
  const {errors = {}, stations = [], straightness = {}} = section.result;
  const longest = stations.length > 1 ? Math.abs(stations.at(-1) - stations[0]) : 0;
  return Object.entries(errors).flatMap(([name, error]) => {
    const angle = error.unit === 'rad';
    const range = angle ? angularRange(section.result, name)?.value : straightness[name]?.minimum_zone;
    const u = angle ? angularRange(section.result, name)?.u : straightness[name]?.u;
    if (!isNumber(range)) return [];
    return [{name, section, angle, size: range, U: COVERAGE * (u ?? NaN), longest,
             effect: angle ? range * longest : range}];
  });
}

function largestErrors(sections) {
  const map = latest([...ofCommand(sections, 'fuse'), ...ofCommand(sections, 'track')].filter(
      ({result}) => result.map?.errors));
  const sizes = map ? errorSizes(map) :
                      sections.filter(({result}) => result.kind === 'sweep').flatMap(sweepSizes);
  const seen = new Set();
  return sizes.sort((one, other) => other.effect - one.effect)
      .filter(({name}) => !seen.has(name) && seen.add(name))
      .slice(0, LARGEST_SHOWN);
}

// "EYX" -> "straightness of X along Y"
function errorWords(name) {
  const square = {A0Z: 'Y and Z', B0Z: 'X and Z', C0Y: 'X and Y'}[name];
  if (square) return `squareness of ${square}`;
  const [, what, axis] = /^E([XYZABC])([XYZ])$/.exec(name) ?? [];
  if (!axis) return '';
  if (what === axis) return `positioning of ${axis}`;
  if ('XYZ'.includes(what)) return `straightness of ${axis} along ${what}`;
  const about = 'XYZ'['ABC'.indexOf(what)];
  return about === axis ? `roll of ${axis}` : `tilt of ${axis} about ${about}`;
}

const errorLine = ({name, section, angle, size, U, longest, effect}) => element(
    'li', {}, linkTo(section, name), ` ${errorWords(name)} `, quantity(1e6 * size, 1e6 * U, angle ? '\u00b5rad' : '\u00b5m'),
    angle && longest > 0 ?
        element('span', {class: 'aside'},
                ` ${significant(1e6 * effect, 2)}\u00a0\u00b5m over ${positionText(1e3 * longest)}\u00a0mm`) :
        null);

const likeliest = (result) =>
    [...(result.findings ?? [])].sort((one, other) => other.probability - one.probability)[0];

function whatToDo(sections) {
  const lines = [];
  const diagnosis = latest(ofCommand(sections, 'diagnose'));
  const finding = diagnosis && likeliest(diagnosis.result);
  if (finding?.words?.remedy) {
    lines.push([linkTo(diagnosis, findingName(finding)),
                ` (${percent(finding.probability)}): ${finding.words.remedy}`]);
  } else if (diagnosis?.result.unexplained?.length) {
    lines.push([linkTo(diagnosis, 'Diagnosis'), ': something is left that no known cause explains; do not correct yet']);
  }
  const map = latest(ofCommand(sections, 'fuse'));
  const contradiction = map?.result.contradictions?.[0];
  if (contradiction) {
    lines.push([linkTo(map, 'Error map'), `: look at the set-up of ${shortName(contradiction)}, which contradicts the other runs; do not use the map before`]);
  } else if (map?.result.misfits?.length) {
    lines.push([linkTo(map, 'Error map'), `: ${map.result.misfits.map(shortName).join(', ')} ${map.result.misfits.length > 1 ? 'do' : 'does'} not fit; do not use the map before it is known why`]);
  } else if (map && !lines.length) {
    lines.push([linkTo(map, 'Error map'), ': export it to the control, or correct programs with it']);
  }
  return lines;
}

function whatToMeasure(sections) {
  const lines = [];
  const diagnosis = latest(ofCommand(sections, 'diagnose'));
  const next = (diagnosis?.result.rivals ?? []).map(({next_run: run}) => run).find(Boolean);
  if (next) lines.push([linkTo(diagnosis, 'Diagnosis'), `: ${next}`]);
  const track = latest(ofCommand(sections, 'track'));
  const choice = track?.result.next;
  if (choice?.tests?.length) {
    lines.push([linkTo(track, 'Map'), `: ${joinWords(choice.tests)}, ${
        significant(choice.minutes, 2)}\u00a0min, for the next ${plain(choice.days)} days`]);
  }
  const map = latest(ofCommand(sections, 'fuse'));
  if (map && isScaleOpen(map.result)) {
    lines.push([linkTo(map, 'Error map'), ': one calibrated length, for the scale']);
  }
  for (const axis of new Set((map?.result.scatter ?? []).map((each) => each.axis))) {
    lines.push([linkTo(map, 'Error map'), `: circles, or places closer together along ${axis}, where the places scatter`]);
  }
  const missing = sections.filter(
      ({result}) => result.command === 'history' && result.kind === 'check').flatMap(
      (section) => checksOf(section.result)
                       .filter(({verdict}) => verdict === 'not measured')
                       .map(({name}) => ({section, name})));
  if (missing.length) {
    lines.push([linkTo(missing[0].section, 'Limits'),
                `: ${joinWords(missing.slice(0, LARGEST_SHOWN).map(({name}) => name))}, not measured yet`]);
  }
  return lines;
}

function oneMinuteSection(sections) {
  const verdict = limitLine(sections);
  const errors = largestErrors(sections);
  const part = (title, content) => content?.length ? element(
      'div', {class: 'minute-part'}, element('h3', {}, title),
      element('ul', {class: 'plain'}, content)) : null;
  const items = (lines) => lines.slice(0, LARGEST_SHOWN).map((line) => element('li', {}, line));
  const parts = [
    part('The largest errors', errors.map(errorLine)),
    part('What to do', items(whatToDo(sections))),
    part('What to measure next', items(whatToMeasure(sections))),
  ].filter(Boolean);
  if (!verdict && !parts.length) return null;
  return element(
      'section', {id: 'one-minute', 'aria-labelledby': 'one-minute-title'},
      element('h2', {id: 'one-minute-title'}, 'In a minute'),
      verdict ?
          element('p', {class: 'minute-verdict'}, verdictCell(verdict.verdict), ' ',
                  linkTo(verdict.section, verdict.text)) :
          element('p', {class: 'intro'}, 'No limits were checked: state them in the machine file ' +
                                             'and add the result of abbe history check.'),
      element('div', {class: 'minute'}, parts));
}
