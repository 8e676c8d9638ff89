// Tables that sort by any column and filter by words. They are complete without this script.
'use strict';

// What a cell sorts by: its leading number, ✗ as infinite, words otherwise, nothing last.
function sortKey(cell) {
  const text = (cell?.firstChild?.textContent ?? '').trim();
  if (text === '') return {group: 2, value: 0};
  if (text.startsWith('✗')) return {group: 0, value: Infinity};
  const number = Number(text.replace(/[≈/].*$/, ''));
  return Number.isNaN(number) ? {group: 1, value: text.toLowerCase()} : {group: 0, value: number};
}

function compareKeys(a, b) {
  if (a.group !== b.group) return a.group - b.group;
  return a.value < b.value ? -1 : a.value > b.value ? 1 : 0;
}

// The cell of a row under a column, where cells may span several.
function cellAt(row, column) {
  let at = 0;
  for (const cell of row.cells) {
    if (column < at + cell.colSpan) return column === at ? cell : null;
    at += cell.colSpan;
  }
  return null;
}

function sortTable(table, column, isDescending) {
  const body = table.tBodies[0];
  const keyed = [...body.rows].map((row) => ({row, key: sortKey(cellAt(row, column))}));
  const isEmpty = (key) => key.group === 2;  // stays last in both directions
  keyed.sort((a, b) => isEmpty(a.key) || isEmpty(b.key) || !isDescending
      ? compareKeys(a.key, b.key) : compareKeys(b.key, a.key));
  body.append(...keyed.map(({row}) => row));
}

function makeSortable(table) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'sort';
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener('click', () => {
      const isDescending = head.getAttribute('aria-sort') === 'ascending';
      heads.forEach((other) => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', isDescending ? 'descending' : 'ascending');
      sortTable(table, column, isDescending);
    });
  });
}

// Shows the rows that hold every word of the input.
function makeFilter(input, table, output) {
  const rows = [...table.tBodies[0].rows].map((row) => ({row, text: row.textContent.toLowerCase()}));
  const apply = () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const {row, text} of rows) {
      row.hidden = !words.every((word) => text.includes(word));
      if (!row.hidden) ++shown;
    }
    output.textContent = `${shown} of ${rows.length} rows`;
  };
  input.addEventListener('input', apply);
  apply();
}
