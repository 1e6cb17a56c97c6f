// Strip charts of the live page (uPlot): the mean of each channel with the band between its smallest
// and its largest reading.

const STRIP_HEIGHT = 190;
const STRIP_GROUPS = [
  {title: 'Gaps', unit: '\u00b5m', wants: (name) => /^probe_._um$/.test(name)},
  {title: 'Position', unit: 'mm', wants: (name) => /^[xyz]_mm$/.test(name)},
  {title: 'Encoders', unit: 'rad', wants: (name) => /_rad$/.test(name)},
  {title: 'Temperatures', unit: '\u00b0C', wants: (name) => /^temp_.*_c$/.test(name)},
];
const channelLabel = (name) => name.replace(/^temp_/, '').replace(/_(um|mm|rad|c)$/, '').replaceAll('_', ' ');

// One chart of the channels whose index in the columns is in `channels`.
class Strip {
  constructor({title, unit}, channels, columns) {
    this.title = title;
    this.unit = unit;
    this.channels = channels;
    this.labels = channels.map((index) => channelLabel(columns[index]));
    this.data = [[], ...channels.flatMap(() => [[], [], []])];
    this.seconds = 60;
    this.plot = element('div', {
      class: 'strip',
      role: 'img',
      'aria-label': `${title} over time, in ${unit}: ${this.labels.join(', ')}`
    });
    this.node = element(
        'figure', {class: 'figure full'},
        element(
            'figcaption', {}, element('span', {class: 'figure-name'}, title),
            element('span', {class: 'unit'}, unit)),
        element(
            'div', {class: 'toggles', 'aria-hidden': 'true'},
            this.labels.map(
                (label, index) => element(
                    'span', {class: 'strip-label'},
                    element('span', {class: `swatch series-${index % 6 + 1}`}), label))),
        this.plot);
    // As a figure of the page it follows the theme.
    figures.push({plot: this.plot, width: 'full', height: STRIP_HEIGHT, drawn: true, redraw: () => this.build()});
    this.sizes = new ResizeObserver(() => this.chart?.setSize(this.size()));
    this.sizes.observe(this.plot);
  }

  add({from, to, v}) {
    this.data[0].push((from + to) / 2);
    this.channels.forEach((index, place) => {
      const [mean, least, most] = v[index] ?? [null, null, null];
      this.data[1 + 3 * place].push(mean);
      this.data[2 + 3 * place].push(most);
      this.data[3 + 3 * place].push(least);
    });
  }

  size() {
    return {width: Math.max(200, this.plot.clientWidth), height: STRIP_HEIGHT};
  }

  // The last `seconds`; 0: all.
  visible() {
    const times = this.data[0];
    if (!this.seconds || !times.length) return this.data;
    const begin = times.at(-1) - this.seconds;
    let low = 0, high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < begin) low = middle + 1; else high = middle;
    }
    return low ? this.data.map((list) => list.slice(low)) : this.data;
  }

  build() {
    if (!this.plot.isConnected) return;
    this.chart?.destroy();
    const colours = palette();
    const font = '12px "IBM Plex Sans", system-ui, sans-serif';
    const axis = {stroke: colours.muted, font, grid: {stroke: colours.line, width: 1}, ticks: {show: false}};
    const series = this.channels.flatMap((_, place) => {
      const stroke = colours.series[place % 6];
      const edge = {stroke: 'transparent', width: 0, points: {show: false}};
      return [{stroke, width: 1.5, points: {show: false}}, edge, edge];
    });
    this.chart = new uPlot(
        {
          ...this.size(),
          legend: {show: false},
          cursor: {show: false},
          scales: {x: {time: false}},
          axes: [
            {...axis, values: (_, ticks) => ticks.map((at) => `${positionText(at)} s`)},
            {...axis, size: 64, values: (_, ticks) => ticks.map((at) => positionText(at))}
          ],
          series: [{}, ...series],
          bands: this.channels.map((_, place) => ({
            series: [2 + 3 * place, 3 + 3 * place],
            fill: colours.series[place % 6].replace(/rgb\((.*)\)/, 'rgba($1, 0.2)'),
          })),
        },
        this.visible(), this.plot);
  }

  draw() {
    if (this.chart) this.chart.setData(this.visible());
    else this.build();
  }
}

function makeStrips(columns) {
  return STRIP_GROUPS.map((group) => ({
                            group,
                            channels: columns.flatMap((name, index) => group.wants(name) ? [index] : [])
                          }))
      .filter(({channels}) => channels.length)
      .map(({group, channels}) => new Strip(group, channels, columns));
}
