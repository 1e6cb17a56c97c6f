// The section of a plan: the causes that a set of runs would show, and those it would not separate.

const planSizes = ({sizes}) => element(
    'ul', {class: 'plain'},
    sizes.map(
        ({name, quantity, unit, seen_from: seen, plausible}) => element(
            'li', {},
            [parameterName({name, quantity}), 'from', significant(seen), unit && unitText(unit),
             `(usual: ${significant(plausible)})`]
                .filter(Boolean)
                .join(' '))));

function plannedTable(caption, causes) {
  if (!causes.length) return null;
  return table({
    caption,
    columns: [
      {head: 'Cause'}, {head: 'Is seen'},
      {head: 'A usual size stands out by', unit: 'std. dev.', numeric: true}
    ],
    rows: causes.map(
        (one) =>
            [findingName(one), one.sizes?.length ? planSizes(one) : 'present or absent',
             fixed(one.visible_sd, one.visible_sd < 10 ? 1 : 0)]),
  });
}

const confusedBlock = (result) => notesBlock(
    'These runs could not separate:',
    (result.confused ?? [])
        .map(
            ({causes, cosine}) => `${causes.map(candidateName).join('; ')} (cosine ${
                fixed(cosine, 3)}; 1: they do the same)`));

const seenCauses = (result) => (result.causes ?? []).filter(({seen}) => seen);

registerSection({
  command: 'diagnose-plan',
  title: () => 'Plan: what these runs would show',
  short: () => 'Plan',
  summary: (result) => {
    const seen = seenCauses(result).length, all = (result.causes ?? []).length;
    return `Of ${all} causes, ${seen} would be seen at their usual size on a machine like this one.`;
  },
  facts: (result) => [['Runs', (result.runs ?? []).join(', '), true]],
  body: (result) => [element(
      'details', {class: 'fold group'},
      element('summary', {}, 'Each cause, and the causes that these runs could not separate'),
      confusedBlock(result), plannedTable('Would be seen', seenCauses(result)),
      plannedTable(
          'Would not be seen at their usual size',
          (result.causes ?? []).filter(({seen}) => !seen)))],
  overview: {
    title: 'Plan',
    columns: [{head: 'Runs'}, {head: 'Causes seen', numeric: true}, {head: 'Of', numeric: true}],
    row: (result) => [`${(result.runs ?? []).length} runs`, String(seenCauses(result).length),
                      String((result.causes ?? []).length)],
  },
});
