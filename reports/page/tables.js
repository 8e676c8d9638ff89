// Tables that sort by any column and filter by words. They are complete without this script.
'use strict';

// What a cell sorts by: its leading number, ✗ as infinite, words otherwise, nothing last.
function sortKey(cell) {
  const text = (cell?.firstChild?.textContent ?? '').trim();
  if (text === '' || text === '·') return {group: 2, value: 0};
  if (text.startsWith('✗')) return {group: 0, value: Infinity};
  const number = Number(text.replace(/[≈/×].*$/, ''));
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

// What the table of all cells says of one of them: the matrix has no room for it.
function explanationOf(row) {
  const [problem, optimizer, runs, , , work, , , time, loss, error, fate] = [...row.cells].map((cell) => {
    const range = cell.querySelector('small')?.textContent;
    return (cell.firstChild?.textContent ?? '') + (range ? ` (${range})` : '');
  });
  const lines = work === '' ? [fate] : [
    `${runs} runs to 1e-6`, `work to 1e-6: ${work} forward solves`, `time: ${time} ms`, `final loss: ${loss}`,
    ...(error === '' ? [] : [`error in x: ${error}`]), `ended by: ${fate}`];
  return [`${optimizer} on ${problem}`, ...lines];
}

function showTip(tip, [title, ...lines], near) {
  const head = document.createElement('b');
  head.textContent = title;
  tip.replaceChildren(head, ...lines.map((line) => {
    const span = document.createElement('span');
    span.textContent = line;
    return span;
  }));
  tip.hidden = false;
  const box = near.getBoundingClientRect();
  const isBelow = box.bottom + tip.offsetHeight + 8 < innerHeight;
  tip.style.left = `${Math.max(8, Math.min(box.left, innerWidth - tip.offsetWidth - 8))}px`;
  tip.style.top = `${isBelow ? box.bottom + 6 : box.top - tip.offsetHeight - 6}px`;
}

// Rows of the detail table stand by problem, then optimizer, as planned: found by counting, once.
function rowsByCell(matrix, details) {
  const rows = [...details.tBodies[0].rows], lines = [...matrix.tBodies[0].rows], found = new Map();
  let next = 0;
  for (let column = 2; column < lines[0]?.cells.length; ++column)
    lines.forEach((line, s) => {
      if (!line.cells[column].classList.contains('none')) found.set(`${s},${column}`, rows[next++]);
    });
  return found;
}

function explainMatrices() {
  const tip = document.getElementById('tip');
  const matrices = [...document.querySelectorAll('table.matrix')];
  const rows = rowsByCell(matrices[0], document.getElementById('detail-table'));
  for (const matrix of matrices) {
    const explain = (event) => {
      const cell = event.target.closest('td');
      const row = cell && rows.get(`${cell.parentElement.sectionRowIndex},${cell.cellIndex}`);
      if (row) showTip(tip, explanationOf(row), cell); else tip.hidden = true;
    };
    matrix.addEventListener('pointerover', explain);
    matrix.addEventListener('click', explain);
    matrix.addEventListener('pointerleave', () => { tip.hidden = true; });
  }
  addEventListener('scroll', () => { tip.hidden = true; }, {passive: true});
}
