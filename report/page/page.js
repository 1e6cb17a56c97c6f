// Reads the results in the page, builds the sections and the table of contents, draws the figures.

// What matters most first, the others in the order of the kinds, then of axis, start and file.
function orderedSections(results) {
  const order = (kind) => (sectionKinds.indexOf(kind) + 1) || sectionKinds.length + 1;
  const key = ({kind, result, file}) => [kind.weight ?? 9, String(order(kind)).padStart(3, '0'), result.axis ?? '',
                                         result.started ?? '', file]
                                            .join('\n');
  return results.map(({file, result}) => ({file, result, kind: sectionKindOf(result)}))
      .sort((one, other) => key(one) < key(other) ? -1 : 1)
      .map((section, index) => ({...section, id: `result-${index + 1}`}));
}

function resultSection({id, kind, result, file}) {
  const summary = kind.summary(result);
  return element(
      'section', {id, class: 'result', 'aria-labelledby': `${id}-title`},
      element('h2', {id: `${id}-title`}, kind.title(result)),
      summary ? element('p', {class: 'summary'}, summary) : null,
      factList(allFacts(kind.facts(result), result, file)), kind.body(result));
}

// A result that its section cannot read is replaced by a message; the others are not affected.
function safeSection(section) {
  try {
    return resultSection(section);
  } catch (error) {
    return element(
        'section', {id: section.id, class: 'result'}, element('h2', {}, section.file),
        element(
            'p', {class: 'note'},
            `This result could not be shown (${error.message}): a key has ` +
                'a form other than in docs/report.md. Write it again with this version of abbe.'));
  }
}

function contentsList(sections) {
  const entry = (id, text) => element('li', {}, element('a', {href: `#${id}`}, text));
  const repeated = (text) =>
      sections.filter(({kind, result}) => kind.short(result) === text).length > 1;
  return element(
      'ol', {}, document.getElementById('one-minute') ? entry('one-minute', 'In a minute') : null,
      entry('overview', 'Overview'), sections.map(({id, kind, result, file}) => {
        const text = kind.short(result);
        return entry(id, repeated(text) ? `${text}, ${file}` : text);
      }));
}

// The entry of the section in view is marked.
function followScrolling(contents) {
  const links = new Map([...contents.querySelectorAll('a')].map(
      (link) => [link.getAttribute('href').slice(1), link]));
  const mark = (id) => links.forEach(
      (link, key) => key === id ? link.setAttribute('aria-current', 'true') :
                                  link.removeAttribute('aria-current'));
  const watcher = new IntersectionObserver((entries) => {
    const seen = entries.filter((entry) => entry.isIntersecting);
    if (seen.length) mark(seen[0].target.id);
  }, {rootMargin: '-10% 0px -80% 0px'});
  links.forEach((link, id) => watcher.observe(document.getElementById(id)));
}

const texts = (list) => [...new Set(list.filter((one) => typeof one === 'string' && one))];

// "Measured 21 Nov 2026 to 23 Nov 2026 . Operator A. Smith . Serial numbers mill 4711"
function protocolText(sections) {
  const days = texts(sections.map(({result}) => result.started))
                   .map((started) => new Date(started))
                   .filter((date) => date.getTime() > 0)
                   .sort((one, other) => one - other)
                   .map((date) => date.toLocaleDateString(
                            'en-GB',
                            {timeZone: 'UTC', day: 'numeric', month: 'short', year: 'numeric'}));
  const stated = (key) => texts(sections.map(({result}) => result.protocol?.[key])).join('; ');
  const [operator, serial] = [stated('operator'), stated('serial')];
  return [
    days.length ? `Measured ${texts([days[0], days.at(-1)]).join(' to ')}` : null,
    operator ? `Operator ${operator}` : null,
    serial ? `Serial numbers ${serial}` : null,
    sections.some(({result}) => result.simulated) ? 'Contains simulated readings' : null,
  ].filter(Boolean).join(' \u00b7 ');
}

function writeTitle(folder, sections) {
  const machines = [...new Set(sections.map(({result}) => result.machine).filter(Boolean))];
  const title = machines.length ? `Geometric errors of ${joinWords(machines)}` : 'Geometric errors';
  const count = counted(sections.length, 'result');
  const version = sections.map(({result}) => result.abbe).find((abbe) => typeof abbe === 'string');
  document.title = title;
  document.getElementById('title').textContent = title;
  const protocol = document.getElementById('protocol');
  protocol.textContent = protocolText(sections);
  protocol.hidden = !protocol.textContent;
  document.getElementById('subtitle').textContent = [
    `Folder ${folder}`, count, version ? `abbe ${version}` : null
  ].filter(Boolean).join(' \u00b7 ');
}

async function showReport() {
  const content = JSON.parse(document.getElementById('results').textContent);
  const {folder, results, notes} = content;
  const sections = orderedSections(results);
  writeTitle(folder, sections);
  const contents = document.getElementById('contents');
  if (content.live) {
    startLive(content);
  } else {
    document.getElementById('content').append(
        ...[oneMinuteSection(sections), overviewSection(sections, notes)].filter(Boolean),
        ...sections.map(safeSection));
    contents.append(
        element('p', {class: 'contents-title', 'aria-hidden': 'true'}, 'Contents'),
        contentsList(sections));
  }
  connectThemeButton(document.getElementById('theme'), redrawFigures);
  connectPrinting();
  document.getElementById('print').addEventListener('click', () => print());
  followScrolling(contents);
  await document.fonts.ready;
  await drawFigures();
  document.documentElement.dataset.ready = 'true';
}

showReport();
