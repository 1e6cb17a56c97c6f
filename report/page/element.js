// Small pieces of the page: elements, tables, lists of facts, rows of toggles.

// element('p', {class: 'note'}, 'text', otherElement): null or false attributes and null children
// are left out.
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== undefined && value !== false) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

const code = (name) => element('span', {class: 'code'}, name);
const symbolU95 = () =>
    element('span', {class: 'symbol'}, element('i', {}, 'U'), element('sub', {}, '95'));

// "42.3 +/- 1.2" as an element that does not break; the unit is in the head of the column.
function quantity(value, U, unit = '') {
  const text = rounded(value, U);
  return element(
      'span', {class: 'quantity'}, text.value,
      text.U ?
          element(
              'span', {class: 'plus-minus'}, element('span', {class: 'sign'}, '\u00b1'), text.U) :
          null,
      unit ? `\u00a0${unit}` : null);
}

// columns: [{head, unit?, numeric?}]; rows: lists of cells (text or element). The first column
// heads its row. On a phone each row becomes a card, and its cells carry their column's head.
function table({caption, columns, rows, compact = false}) {
  const head = (column) => element(
      'th', {scope: 'col', class: column.numeric ? 'numeric' : null}, column.head,
      column.unit ? element('span', {class: 'unit'}, column.unit) : null);
  const cell = (content, column, index) => element(
      index === 0 ? 'th' : 'td', {
        scope: index === 0 ? 'row' : null,
        class: column.numeric ? 'numeric' : null,
        'data-head': [column.label ?? column.head, column.unit].filter(Boolean).join(', '),
      },
      content ?? element('span', {class: 'absent'}, '\u2013'));
  return element(
      'div', {
        class: compact ? 'table-frame compact' : 'table-frame',
        tabindex: 0,
        role: 'region',
        'aria-label': caption
      },
      element(
          'table', {class: compact ? 'compact' : 'cards'}, element('caption', {}, caption),
          element('thead', {}, element('tr', {}, columns.map(head))),
          element(
              'tbody', {},
              rows.map(
                  (row) => element(
                      'tr', {},
                      columns.map((column, index) => cell(row[index], column, index)))))));
}

// facts: [[name, text or element, wide?]]; those without content are left out.
function factList(facts) {
  const known =
      facts.filter(([, content]) => content !== null && content !== undefined && content !== '');
  return element(
      'dl', {class: 'facts'},
      known.map(
          ([name, content, wide]) => element(
              'div', {class: wide ? 'wide' : null}, element('dt', {}, name),
              element('dd', {}, content))));
}

function notesBlock(title, notes) {
  if (!notes?.length) return null;
  return element(
      'div', {class: 'note', role: 'note'}, element('p', {}, element('strong', {}, title)),
      element('ul', {}, notes.map((note) => element('li', {}, note))));
}

// A row of toggle buttons that are the legend too. items: [{key, label, swatch, on}]; `changed`
// gets the set of keys that are on.
function toggles(label, items, changed) {
  const on = new Set(items.filter((item) => item.on !== false).map((item) => item.key));
  const button = (item) => {
    const made = element(
        'button', {type: 'button', class: 'toggle', 'aria-pressed': String(on.has(item.key))},
        item.swatch ? element('span', {class: `swatch ${item.swatch}`, 'aria-hidden': 'true'}) :
                      null,
        item.label);
    made.addEventListener('click', () => {
      on.has(item.key) ? on.delete(item.key) : on.add(item.key);
      made.setAttribute('aria-pressed', String(on.has(item.key)));
      changed(on);
    });
    return made;
  };
  const row =
      element('div', {class: 'toggles', role: 'group', 'aria-label': label}, items.map(button));
  return {row, on};
}

// A row of buttons, one of which is on. items: [{key, label}], the first is on at the start;
// `changed` gets the key that is on.
function choiceRow(label, items, changed) {
  const buttons = items.map(
      ({label: text}, index) => element('button', {type: 'button', class: 'toggle'}, text));
  const press = (chosen) => buttons.forEach(
      (button, index) => button.setAttribute('aria-pressed', String(index === chosen)));
  press(0);
  buttons.forEach((button, index) => button.addEventListener('click', () => {
    press(index);
    changed(items[index].key);
  }));
  return element('div', {class: 'toggles', role: 'group', 'aria-label': label}, buttons);
}

// A slider over a list of values, with the current value next to it.
function sliderRow({label, values, at, text}, changed) {
  const shown = element('output', {}, text(values[at]));
  const input = element('input', {
    type: 'range',
    min: 0,
    max: values.length - 1,
    step: 1,
    value: at,
    'aria-label': label,
    'aria-valuetext': text(values[at])
  });
  input.addEventListener('input', () => {
    const value = values[Number(input.value)];
    shown.textContent = text(value);
    input.setAttribute('aria-valuetext', text(value));
    changed(value);
  });
  return element('label', {class: 'slider'}, element('span', {}, label), input, shown);
}
