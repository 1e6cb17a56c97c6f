// The top of the page: all axes with their key figures, and what was left out.

// `row` gives one row for a result, `rows` several.
const rowsOf = ({row, rows}, result) => rows ? rows(result) : [row(result)];

// One table per kind of section; the first cell leads to the section.
function overviewTables(sections) {
  const kinds = sectionKinds.filter((kind) => kind.overview);
  const on_top = kinds.filter((kind) => kind.overview.onTop);
  return [...new Set([...on_top, ...kinds])].flatMap((kind) => {
    const mine = sections.filter((section) => section.kind === kind);
    if (!mine.length) return [];
    return [table({
      caption: kind.overview.title,
      columns: kind.overview.columns,
      rows: mine.flatMap(({id, result}) => rowsOf(kind.overview, result).map(([first, ...rest]) =>
        [element('a', {href: `#${id}`}, first ?? result.command), ...rest])),
    })];
  });
}

function overviewSection(sections, notes) {
  const tables = overviewTables(sections);
  const hasUncertainty = sections.some(({result}) => result.kind === 'sweep');
  return element(
      'section', {id: 'overview', 'aria-labelledby': 'overview-title'},
      element('h2', {id: 'overview-title'}, 'Overview'),
      hasUncertainty ? element(
                           'p', {class: 'intro'},
                           'Peak-to-peak values over the travel with their ' +
                               'expanded uncertainty ',
                           symbolU95(), '; straightness is the minimum zone.') :
                       null,
      tables, notesBlock('Files that are not in this report', notes));
}
