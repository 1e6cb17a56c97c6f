// The live page: the report's page while a measurement goes on. It asks for the events of the server
// that it came from (live/page_server.h) and shows them; nothing goes back.

const FLAG_NAMES = [
  [1, 'stale'], [2, 'out of range'], [4, 'device error'], [8, 'interpolated'], [16, 'clock jump']
];
const STRIP_WINDOWS = [{key: 60, label: 'Last minute'}, {key: 600, label: '10 minutes'}, {key: 0, label: 'All'}];
const secondsText = (seconds) => `${fixed(seconds, 1)}\u00a0s`;
const flagText = (flags) =>
    FLAG_NAMES.filter(([bit]) => flags & bit).map(([, name]) => name).join(', ');

function livePanel(live) {
  const status = element('p', {class: 'summary', role: 'status', id: 'live-status'}, 'Connecting\u2026');
  const trouble = element('div', {role: 'alert', id: 'live-trouble'});
  const bar = element('progress', {max: 1, value: 0, 'aria-label': 'Progress'});
  const facts = element('div', {id: 'live-facts'});
  const gaps = element('div', {id: 'live-gaps'});
  const strips = element('div', {class: 'panels', id: 'live-strips'});
  const flags = element('div', {id: 'live-flags'});
  const node = element(
      'section', {id: 'live', class: 'live', 'aria-labelledby': 'live-title'},
      element('h2', {id: 'live-title'}, live.title || 'Live'), status, trouble, bar, facts, gaps,
      strips, flags);
  return {node, status, trouble, bar, facts, gaps, strips, flags};
}

class LivePage {
  constructor(live, content) {
    this.live = live;
    this.panel = livePanel(live);
    this.columns = [];
    this.strips = [];
    this.state = {};
    this.flags = new Map();
    this.rows = 0;
    this.lost = 0;
    this.results = new Map();
    this.notes = new Map();
    this.waiting = new Map();  // results of sections in which somebody works
    this.count = 0;
    this.content = content;
    this.folderGone = false;
    this.outline();
  }

  connect() {
    const events = new EventSource(`events${location.search}`);
    this.events = events;
    const on = (name, take) => events.addEventListener(name, (event) => {
      take.call(this, JSON.parse(event.data));
      this.refresh();
    });
    on('hello', this.hello);
    on('columns', this.takeColumns);
    on('rows', this.takeRows);
    on('lost', ({rows}) => this.lost += rows);
    on('flag', (flag) => this.flags.set(flag.number, flag));
    on('state', (state) => this.state = state);
    on('result', ({file, result}) => this.takeResult(file, result));
    on('gone', ({file}) => this.dropResult(file));
    on('note', ({file, note}) => {
      this.dropResult(file);
      this.notes.set(file, `${file} ${note}`);
      this.outline();
    });
    on('folder', ({there}) => this.folderGone = !there);
    on('end', (end) => {
      this.ended = end;
      events.close();
    });
    events.onopen = () => {
      this.away = null;
      this.refresh();
    };
    events.onerror = () => {
      this.away ??= new Date();
      this.refused = events.readyState === EventSource.CLOSED;
      this.refresh();
    };
  }

  // A server that was started anew has another session.
  hello({session, version}) {
    if (session === this.live.session) return;
    if (version === this.live.version) {
      location.reload();
      return;
    }
    this.events.close();
    this.foreign = version;
  }

  takeColumns(columns) {
    this.columns = columns;
    this.strips = makeStrips(columns);
    this.panel.strips.replaceChildren(
        choiceRow('Time shown', STRIP_WINDOWS, (seconds) => {
          this.strips.forEach((strip) => {
            strip.seconds = seconds;
            strip.draw();
          });
        }), ...this.strips.map((strip) => strip.node));
    this.panel.strips.firstChild.classList.add('full');
    this.gapRows = null;
  }

  takeRows(rows) {
    this.rows += rows.n;
    this.last = rows;
    this.strips.forEach((strip) => strip.add(rows));
  }

  refresh() {
    if (this.pending) return;
    this.pending = setTimeout(() => {
      this.pending = null;
      this.show();
    }, document.hidden ? 1000 : 100);
  }

  show() {
    this.showStatus();
    this.showGaps();
    this.showFlags();
    this.strips.forEach((strip) => strip.draw());
    for (const [file, result] of this.waiting) this.takeResult(file, result);
  }

  setText(node, text) {
    if (node.textContent !== text) node.textContent = text;
  }

  troubleText() {
    if (this.foreign)
      return `This page is of abbe ${this.live.version}, the server is abbe ${
          this.foreign} by now: load the page anew.`;
    if (this.ended) return '';
    if (this.refused) return 'The server refuses this page: open the address that abbe printed.';
    if (this.away)
      return `No connection since ${this.away.toLocaleTimeString('en-GB')}; the page tries again.`;
    if (this.folderGone) return 'The folder has vanished; the page keeps what it shows.';
    if (this.lost) return `${this.lost} rows could not be shown; the recording has them.`;
    return this.state.fault ?? '';
  }

  showStatus() {
    const {state, panel} = this;
    this.setText(panel.trouble, this.troubleText());
    panel.trouble.className = panel.trouble.textContent ? 'note' : '';
    const status = this.ended ? this.ended.text : state.note || (this.rows ? 'Recording' : 'Waiting');
    this.setText(panel.status, status);
    document.documentElement.dataset.live = this.ended ? 'ended' : this.away ? 'away' : 'on';
    const total = state.total > 0;
    panel.bar.hidden = !total;
    if (total) panel.bar.value = state.done / state.total;
    const at = (name) => this.last?.v[this.columns.indexOf(name)]?.[0];
    const facts = [
      ['Time', this.last ? secondsText(this.last.to) : null],
      ['Left', isNumber(state.left_s) && !this.ended ? durationText(state.left_s) : null],
      ['Done', total ? `${state.done} of ${state.total}` : null],
      ['Rows', this.rows ? grouped(this.rows) : null],
      ...['x', 'y', 'z'].map((axis) => [axis.toUpperCase(), isNumber(at(`${axis}_mm`)) ?
                                            `${fixed(at(`${axis}_mm`), 3)}\u00a0mm` :
                                            null]),
      ['Pass', isNumber(at('pass')) ? fixed(at('pass'), 0) : null],
      ['Feed', isNumber(at('feed_mm_min')) ? `${fixed(at('feed_mm_min'), 0)}\u00a0mm/min` : null],
      ...this.columns.filter((name) => /^temp_.*_c$/.test(name)).map((name) => [
        `Temperature, ${channelLabel(name)}`, isNumber(at(name)) ? `${fixed(at(name), 2)}\u00a0\u00b0C` : null
      ]),
    ];
    panel.facts.replaceChildren(factList(facts));
  }

  // One row a probe: the gap against its range.
  showGaps() {
    const probes = Object.entries(this.live.ranges ?? {}).filter(([name]) => this.columns.includes(name));
    if (!probes.length || !this.last) return;
    if (!this.gapRows) {
      this.gapRows = new Map(probes.map(([name, range]) => [name, {
        meter: element('meter', {
          min: 0, max: range, low: 0.1 * range, high: 0.9 * range, optimum: 0.5 * range,
          'aria-label': `Gap of ${channelLabel(name)}`
        }),
        value: element('span', {}),
      }]));
      this.panel.gaps.replaceChildren(table({
        caption: 'Gaps against their ranges',
        columns: [{head: 'Probe'}, {head: 'Gap', unit: '\u00b5m', numeric: true}, {head: 'In the range'}, {head: 'Range', unit: '\u00b5m', numeric: true}],
        rows: probes.map(([name, range]) => [
          channelLabel(name), this.gapRows.get(name).value, this.gapRows.get(name).meter, fixed(range, 0)
        ]),
      }));
    }
    for (const [name, {meter, value}] of this.gapRows) {
      const [gap] = this.last.v[this.columns.indexOf(name)] ?? [];
      meter.value = gap ?? 0;
      this.setText(value, isNumber(gap) ? fixed(gap, 2) : 'no reading');
    }
  }

  showFlags() {
    const flags = [...this.flags.values()].slice(-20).reverse();
    const text = JSON.stringify(flags);
    if (text === this.flagsShown) return;
    this.flagsShown = text;
    if (!flags.length) return;
    this.panel.flags.replaceChildren(table({
      caption: `Rows with a flag, ${this.flags.size} times`,
      columns: [{head: 'From', numeric: true, unit: 's'}, {head: 'To', numeric: true, unit: 's'}, {head: 'Rows', numeric: true}, {head: 'Cause'}, {head: 'Channels'}],
      rows: flags.map((flag) => [
        fixed(flag.from, 1), fixed(flag.to, 1), grouped(flag.rows), flagText(flag.flags),
        flag.columns.map(channelLabel).join(', ') || 'all'
      ]),
    }));
  }

  sections() {
    return orderedSections([...this.results].map(([file, {result}]) => ({file, result})))
        .map((section) => ({...section, id: this.results.get(section.file).id}));
  }

  // A section in which somebody works is renewed later.
  takeResult(file, result) {
    const old = this.results.get(file);
    if (old?.node.contains(document.activeElement)) {
      this.waiting.set(file, result);
      return;
    }
    this.waiting.delete(file);
    this.notes.delete(file);
    const id = old?.id ?? `result-${++this.count}`;
    const drawn = this.forget(file);
    this.results.set(file, {result, id});
    const sections = this.sections();
    const place = sections.findIndex((section) => section.file === file);
    const node = safeSection(sections[place]);
    if (result.partial)
      node.querySelector('h2').after(
          element('p', {class: 'note'}, `So far: ${result.partial}. The measurement goes on.`));
    this.keepPlots(drawn, node);
    this.results.get(file).node = node;
    const next = sections.slice(place + 1).find((section) => this.results.get(section.file).node);
    document.getElementById('content').insertBefore(
        node, next ? this.results.get(next.file).node : null);
    this.outline();
    drawFigures();
  }

  // Figures that are there already change in place, so that nothing flickers.
  keepPlots(drawn, node) {
    for (const figure of figures) {
      const name = figure.plot.getAttribute('aria-label');
      if (!node.contains(figure.plot) || !drawn.has(name)) continue;
      figure.plot.replaceWith(drawn.get(name));
      figure.plot = drawn.get(name);
      drawn.delete(name);
    }
    drawn.forEach((plot) => Plotly.purge(plot));
  }

  // Takes a section out; the plots that it had drawn, by their names.
  forget(file) {
    const drawn = new Map();
    const node = this.results.get(file)?.node;
    if (!node) return drawn;
    for (let i = figures.length - 1; i >= 0; --i) {
      if (!node.contains(figures[i].plot)) continue;
      if (figures[i].drawn) drawn.set(figures[i].plot.getAttribute('aria-label'), figures[i].plot);
      figures.splice(i, 1);
    }
    node.remove();
    this.results.delete(file);
    return drawn;
  }

  dropResult(file) {
    this.forget(file).forEach((plot) => Plotly.purge(plot));
    this.notes.delete(file);
    this.outline();
  }

  // Title, contents and overview follow the results.
  outline() {
    const sections = this.sections();
    if (sections.length) writeTitle(this.content.folder, sections);
    const contents = document.getElementById('contents');
    if (!contents.contains(document.activeElement)) {
      const list = contentsList(sections);
      list.prepend(element('li', {}, element('a', {href: '#live'}, 'Live')));
      contents.replaceChildren(list);
    }
    const overview = overviewSection(sections, [...this.notes.values()]);
    const old = document.getElementById('overview');
    if (old) old.replaceWith(overview);
    else document.getElementById('content').append(overview);
  }
}

function startLive(content) {
  const page = new LivePage(content.live, content);
  document.getElementById('content').prepend(page.panel.node);
  page.connect();
  page.show();
}
