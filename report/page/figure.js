// Figures: each draws itself from the current colours, so that it follows the theme and prints
// light; each has a name, a unit and its values as a table, for readers who cannot see it.

const figures = [];
const PRINT_WIDTHS = {
  full: 660,
  half: 320,
  third: 210
};

const coarsePointer = matchMedia('(pointer: coarse)').matches;

// What all figures share. `extra` overrides by key.
function figureLayout(colours, {x = '', ...extra} = {}) {
  const axis = {
    gridcolor: colours.line,
    zerolinecolor: colours.axis,
    linecolor: colours.axis,
    zerolinewidth: 1,
    ticks: '',
    automargin: true,
    tickfont: {color: colours.muted, size: 12},
    minexponent: 5,
    separatethousands: false,
  };
  return {
    autosize: true,
    margin: {l: 8, r: 10, t: 8, b: 8},
    paper_bgcolor: 'rgba(0,0,0,0)',
    plot_bgcolor: 'rgba(0,0,0,0)',
    font: {family: '"IBM Plex Sans", system-ui, sans-serif', size: 13, color: colours.ink},
    showlegend: false,
    dragmode: coarsePointer ? false : 'zoom',
    hovermode: 'x unified',
    hoverlabel:
        {bgcolor: colours.surface, bordercolor: colours.line, font: {color: colours.ink, size: 12}},
    ...extra,
    xaxis: {
      ...axis,
      showgrid: false,
      zeroline: false,
      showline: true,
      title: {text: x, font: {size: 12, color: colours.muted}, standoff: 8},
      ...extra.xaxis
    },
    yaxis: {...axis, nticks: 6, ...extra.yaxis},
  };
}

const FIGURE_OPTIONS = {
  responsive: true,
  displaylogo: false,
  doubleClick: 'reset',
  modeBarButtons: [['zoom2d', 'pan2d', 'resetScale2d', 'toImage']],
};

// A band between two lists of the same length over numbers or dates, as one closed shape. Stations
// without a number are left out and do not split it.
function bandTrace(x, middle, half, colour) {
  const points = x.map((at, index) => [at, middle[index], half[index]])
                     .filter(([at, ...half]) => at !== null && half.every(isNumber));
  const back = [...points].reverse();
  return {
    type: 'scatter',
    mode: 'lines',
    fill: 'toself',
    fillcolor: colour,
    line: {width: 0},
    hoverinfo: 'skip',
    showlegend: false,
    x: [...points, ...back].map((point) => point[0]),
    y: [...points.map((point) => point[1] + point[2]), ...back.map((point) => point[1] - point[2])],
  };
}

// The values of a figure, created when opened.
function valuesTable(caption, values) {
  const details = element(
      'details', {class: 'values'},
      element('summary', {}, 'Values', element('span', {class: 'unseen'}, ` of ${caption}`)));
  details.addEventListener('toggle', () => {
    if (details.children.length === 1) {
      details.append(table({caption: `${caption}: values`, compact: true, ...values()}));
    }
  }, {once: true});
  return details;
}

// makeFigure({name, code, unit, about, width, height, draw, values}):
//   draw(colours) -> {data, layout}; values() -> {columns, rows}; about: the figure in one
//   sentence.
function makeFigure(
    {name, code: symbol = '', unit = '', about, width = 'full', height = 260, draw, values}) {
  const plot = element(
      'div', {class: 'plot', role: 'group', 'aria-label': about, style: `height:${height}px`});
  const figure = {plot, width, height, drawn: false};
  figure.redraw = (size = null) => {
    const {data, layout} = draw(palette());
    const sized = size ? {...layout, autosize: false, width: size, height} : layout;
    figure.drawn = true;
    return Plotly.react(figure.plot, data, sized, FIGURE_OPTIONS);
  };
  figures.push(figure);
  figure.node = element(
      'figure', {class: `figure ${width}`},
      element(
          'figcaption', {},
          element(
              'span', {class: 'figure-name'}, name, symbol ? ' ' : null,
              symbol ? code(symbol) : null),
          unit ? element('span', {class: 'unit'}, unit) : null),
      plot, values ? valuesTable(`${name} ${symbol}`.trim(), values) : null);
  return figure;
}

const redrawFigures = () =>
    figures.filter((figure) => figure.drawn).forEach((figure) => figure.redraw());

// Figures are drawn one per frame, so the page can be read and scrolled from the start.
async function drawFigures() {
  for (const figure of figures) {
    if (!figure.drawn) await figure.redraw();
    await new Promise((next) => setTimeout(next));
  }
}

// For printing: the light theme and the width of the paper.
function connectPrinting() {
  const root = document.documentElement;
  let theme;
  addEventListener('beforeprint', () => {
    theme = root.dataset.theme;
    root.dataset.theme = 'light';
    figures.forEach((figure) => figure.redraw(PRINT_WIDTHS[figure.width]));
  });
  addEventListener('afterprint', () => {
    if (theme)
      root.dataset.theme = theme;
    else
      delete root.dataset.theme;
    figures.forEach((figure) => figure.redraw());
  });
}

// Panels side by side under one heading, with toggles for all of them, a choice of one component,
// and a common slider. panels: makeFigure's argument, with draw(colours, shown, amount, chosen).
function figureGroup({title, intro, items = [], choices = [], slider = null, panels}) {
  const redraw = () => made.forEach((figure) => figure.redraw());
  let shown = new Set();
  let amount = slider?.values[slider.at];
  let chosen = choices[0]?.key;
  const bar = items.length ? toggles(`Shown in ${title}`, items, (on) => {
    shown = on;
    redraw();
  }) : null;
  if (bar) shown = bar.on;
  const row = slider ? sliderRow(slider, (value) => {
    amount = value;
    redraw();
  }) : null;
  const choice = choices.length ? choiceRow(`Component in ${title}`, choices, (key) => {
    chosen = key;
    redraw();
  }) : null;
  const made = panels.map(
      (panel) =>
          makeFigure({...panel, draw: (colours) => panel.draw(colours, shown, amount, chosen)}));
  return element(
      'section', {class: 'group'}, element('h3', {}, title),
      intro ? element('p', {class: 'intro'}, intro) : null, bar?.row, choice, row,
      element('div', {class: 'panels'}, made.map((figure) => figure.node)));
}
