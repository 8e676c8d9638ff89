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
    head.scope = 'col';
    head.append(button);
    button.addEventListener('click', () => {
      const isDescending = head.getAttribute('aria-sort') === 'ascending';
      heads.forEach((other) => other.removeAttribute('aria-sort'));
      head.setAttribute('aria-sort', isDescending ? 'descending' : 'ascending');
      sortTable(table, column, isDescending);
    });
  });
}

// Shows the rows that hold every word of the input, among those of the view; returns how to count anew.
function makeFilter(input, table, output) {
  const rows = [...table.tBodies[0].rows];
  let texts;
  const apply = () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    texts ??= words.length > 0 ? rows.map((row) => row.textContent.toLowerCase()) : undefined;
    let shown = 0;
    rows.forEach((row, i) => {
      row.hidden = !words.every((word) => texts[i].includes(word));
      if (!row.hidden && isShown('s', Number(row.dataset.s)) && isShown('p', Number(row.dataset.p))) ++shown;
    });
    output.textContent = `${shown} of ${rows.length} rows`;
  };
  input.addEventListener('input', apply);
  return apply;
}

// A claim is of interest as long as one of its optimizers and one of its problems are.
function hideClaims() {
  for (const [id, [optimizers, problems]] of Object.entries(DATA.claims)) {
    const isOf = (kind, all) => all.length === 0 || all.some((index) => isShown(kind, index));
    for (const place of document.querySelectorAll(`[data-claim="${id}"]`))
      place.hidden = !isOf('s', optimizers) || !isOf('p', problems);
  }
}

// A claim that is led to stands open, with its head below the bars.
function openClaim(address) {
  const claim = address.startsWith('#claim-') ? document.getElementById(address.slice(1)) : null;
  if (claim === null) return;
  claim.open = true;
  claim.scrollIntoView();
}

function leadToClaims() {
  for (const link of document.querySelectorAll('a[href^="#claim-"]'))
    link.addEventListener('click', () => setTimeout(() => openClaim(link.getAttribute('href'))));
  addEventListener('hashchange', () => openClaim(location.hash));
  openClaim(location.hash);
}

// Rows of an SVG plot move up into the places of those filtered out.
function closeRows(plot) {
  const step = Number(plot.dataset.row), rows = [...plot.querySelectorAll('g[data-method]')];
  const hidden = new Set(hiddenMethods());
  let place = 0;
  rows.forEach((row, i) => {
    row.setAttribute('transform', `translate(0 ${step * (place - i)})`);
    if (!hidden.has(row.dataset.method)) ++place;
  });
  const [left, top, width] = plot.getAttribute('viewBox').split(' '), edge = Number(plot.dataset.edge);
  plot.setAttribute('viewBox', `${left} ${top} ${width} ${edge + step * place}`);
}

const OWN_TAU = tauName(DEFAULT_TARGET);
const COUNTED_IN_CELLS = DATA.by === 'time' ? 'work' : DATA.counted;

// What the table of all cells says of one of them: the matrix has no room for it.
function explanationOf(row) {
  const [problem, optimizer, runs, , , work, , , time, loss, error, fate] = [...row.cells].map((cell) => {
    const range = cell.querySelector('small')?.textContent;
    return (cell.firstChild?.textContent ?? '') + (range ? ` (${range})` : '');
  });
  const lines = work === '' ? [fate] : [
    `${runs} runs to ${OWN_TAU}`, `${COUNTED_IN_CELLS} to ${OWN_TAU}: ${work}`, `time: ${time} ms`, `final loss: ${loss}`,
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

function explainMatrix(matrix, details) {
  const tip = document.getElementById('tip');
  let rows;
  const explain = (event) => {
    rows ??= new Map([...details().tBodies[0].rows].map((row) => [`${row.dataset.s},${row.dataset.p}`, row]));
    const cell = event.target.closest('td');
    const row = cell && rows.get(`${cell.parentElement.dataset.s},${cell.dataset.p}`);
    if (row) showTip(tip, explanationOf(row), cell); else tip.hidden = true;
  };
  matrix.addEventListener('pointerover', explain);
  matrix.addEventListener('click', explain);
  matrix.addEventListener('pointerleave', () => { tip.hidden = true; });
  addEventListener('scroll', () => { tip.hidden = true; }, {passive: true});
}
