// The top of the page: all axes with their key figures, and what was left out.

// One table per kind of section, one row per result; the first cell leads to the section.
function overviewTables(sections) {
  return sectionKinds.filter((kind) => kind.overview).flatMap((kind) => {
    const mine = sections.filter((section) => section.kind === kind);
    if (!mine.length) return [];
    return [table({
      caption: kind.overview.title,
      columns: kind.overview.columns,
      rows: mine.map(({id, result}) => {
        const [first, ...rest] = kind.overview.row(result);
        return [element('a', {href: `#${id}`}, first ?? result.command), ...rest];
      }),
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
