// Tables that sort by any column and filter by words. They are complete without this script.
// What a cell sorts by: its leading number, ✗ as infinite, words otherwise, nothing last.
function sortKey(cell) {
  const text = (cell?.firstChild?.textContent ?? '').trim();
  if (text === '') return {group: 2, value: 0};
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
  const body = table.tBodies[0], rows = rowsOf(table);
  const keyed = rows.map((row) => ({row, key: sortKey(cellAt(row, column))}));
  const isEmpty = (key) => key.group === 2;  // stays last in both directions
  keyed.sort((a, b) => isEmpty(a.key) || isEmpty(b.key) || !isDescending
      ? compareKeys(a.key, b.key) : compareKeys(b.key, a.key));
  const sorted = keyed.map(({row}) => row);
  if (LONG.has(table)) {
    LONG.get(table).rows = sorted;
    LONG.get(table).show();
  } else {
    body.append(...sorted);
  }
}

// Of a long table so many rows stand in the page; the others wait for a filter or an order.
const MOST_IN_PAGE = 200;
const LONG = new Map();  // {rows, show} of each
const rowsOf = (table) => LONG.get(table)?.rows ?? [...table.tBodies[0].rows];

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
  oneStop(table.tHead.rows[0]);
}

// Shows the selected rows that contain every word of the input; returns a function that repeats this.
function makeFilter(input, table, output) {
  const texts = new Map(), all = pressable('', undefined, () => { most = Infinity; show(); });
  let most = MOST_IN_PAGE;
  const textOf = (row) => {
    if (!texts.has(row)) texts.set(row, row.textContent.toLowerCase());
    return texts.get(row);
  };
  const show = () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean), {rows} = LONG.get(table);
    const wanted = rows.filter((row) => isShown('s', Number(row.dataset.s)) && isShown('p', Number(row.dataset.p)) &&
        words.every((word) => textOf(row).includes(word)));
    LONG.get(table).wanted = wanted;
    table.tBodies[0].replaceChildren(...wanted.slice(0, most));
    all.hidden = wanted.length <= most;
    all.textContent = `all ${wanted.length} rows`;
    output.textContent = `${wanted.length} of ${rows.length} rows`;
  };
  LONG.set(table, {rows: [...table.tBodies[0].rows], show});
  output.after(' ', all);
  input.addEventListener('input', show);
  show();
  return show;
}

// The texts of a table in a grid, where cells may span several, without columns that have no text; of
// the rows those that no filter hides.
function gridOf(table) {
  const textOf = (cell) => [...cell.childNodes].map((node) => (node.nodeName === 'SMALL' && !/^[/ ]/.test(node.textContent) ? ` (${node.textContent})` : node.nodeName === 'BUTTON' && node.matches('.copy') ? '' : node.textContent)).join('').trim().replaceAll(/\s+/g, ' ');
  const grid = [], heads = [...table.tHead?.rows ?? []], rows = (LONG.get(table)?.wanted ?? [...table.tBodies[0].rows]).filter((row) => row.matches('.rest') || getComputedStyle(row).display !== 'none');
  [...heads, ...rows].forEach((row, r) => {
    let at = 0;
    grid[r] ??= [];
    for (const cell of [...row.cells].filter((one) => getComputedStyle(one).display !== 'none' || row.matches('.rest'))) {
      while (grid[r][at] !== undefined) ++at;
      for (let down = 0; down < cell.rowSpan; ++down)
        for (let across = 0; across < cell.colSpan; ++across) (grid[r + down] ??= [])[at + across] = across === 0 ? textOf(cell) : '';
    }
  });
  const all = grid.slice(Math.max(0, heads.length - 1)), isWorded = (column) => all.slice(1).some((row) => (row[column] ?? '') !== '');
  const columns = [...Array(Math.max(...all.map((row) => row.length))).keys()].filter(isWorded);
  return all.map((row) => columns.map((column) => row[column] ?? ''));
}

const LATEX = {'\\': '\\textbackslash{}', '~': '\\textasciitilde{}', '^': '\\textasciicircum{}', '✗': '$\\times$', '×': '$\\times$', '†': '\\dag{}', '‡': '\\ddag{}', '§': '\\S{}', 'τ': '$\\tau$', 'κ': '$\\kappa$', '≤': '$\\le$', '≈': '$\\approx$', '‖': '$\\|$', '✓': '$\\checkmark$', '⁻': '$^{-}$', '¹': '$^{1}$', 'Δ': '$\\Delta$', 'ξ': '$\\xi$'};
const TABLE_TEXTS = {
  Markdown: (grid) => grid.map((row, i) => `| ${row.map((text) => text.replaceAll('|', '\\|')).join(' | ')} |${i === 0 ? `\n|${' --- |'.repeat(row.length)}` : ''}`).join('\n'),
  CSV: (grid) => grid.map((row) => row.map((text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text)).join(',')).join('\n'),
  LaTeX: (grid) => `\\begin{tabular}{l${'r'.repeat(grid[0].length - 1)}}\n\\hline\n${grid.map((row, i) => `${row.map((text) => text.replaceAll(/[&%$#_{}]/g, '\\$&').replaceAll(/[\\~^](?![&%$#_{}])/g, (letter) => LATEX[letter]).replaceAll(/[^\x00-\x7f]/g, (letter) => LATEX[letter] ?? letter)).join(' & ')} \\\\${i === 0 ? ' \\hline' : ''}`).join('\n')}\n\\hline\n\\end{tabular}`,
};

// Buttons that stand together are one stop of the keyboard: arrows move among them.
function oneStop(group) {
  const buttons = [...group.querySelectorAll('button')];
  buttons.forEach((button, i) => { button.tabIndex = i === 0 ? 0 : -1; });
  group.addEventListener('keydown', ({key}) => {
    const next = buttons[buttons.indexOf(document.activeElement) + (key === 'ArrowRight' ? 1 : key === 'ArrowLeft' ? -1 : NaN)];
    if (next === undefined) return;
    buttons.forEach((button) => { button.tabIndex = button === next ? 0 : -1; });
    next.focus();
  });
}

// A table that goes on at the right fades there.
const fade = (place) => place.classList.toggle('goes-on', place.scrollLeft + place.clientWidth < place.scrollWidth - 2);
const WIDTHS = new ResizeObserver((changes) => changes.forEach(({target}) => fade(target.closest('.scroll') ?? target)));
document.addEventListener('scroll', ({target}) => { if (target !== document && target.matches('.scroll')) fade(target); }, {capture: true, passive: true});

// Buttons that copy a table, below it.
function addCopies(table) {
  const place = table.closest('.scroll') ?? table;
  if (place !== table) [table, place].forEach((one) => WIDTHS.observe(one));
  if (table.tBodies.length === 0 || place.nextElementSibling?.matches('.tools')) return;
  const buttons = Object.entries(TABLE_TEXTS).map(([name, textOf]) => Object.assign(pressable(name, undefined, ({currentTarget}) => copyText(`${textOf(gridOf(table))}\n`, currentTarget)), {title: worded('copy-table', {format: name})}));
  place.after(element('p', {className: 'tools'}, ...buttons));
  oneStop(place.nextElementSibling);
}

// The meaning of a term, in the head of a column or beside a switch, on demand.
function explainTerms() {
  const tip = document.getElementById('tip');
  const explain = ({target}) => {
    const place = target.closest?.('thead th, #measures button'), name = place?.textContent.trim().replace(/^final |, .*| to .*| at .*/g, '');
    if (place && Object.hasOwn(DATA.terms, name)) showTip(tip, [name, DATA.terms[name]], place);
  };
  for (const event of ['pointerover', 'focusin']) document.addEventListener(event, explain);
  for (const event of ['pointerout', 'focusout']) document.addEventListener(event, ({target}) => { if (target.closest?.('thead th, #measures button')) tip.hidden = true; });
}

// A claim is of interest as long as one of its optimizers and one of its problems are.
function hideClaims() {
  for (const [id, [optimizers, problems]] of Object.entries(DATA.claims)) {
    const isOf = (kind, all) => all.length === 0 || all.some((index) => isShown(kind, index));
    for (const place of document.querySelectorAll(`[data-claim="${id}"]`))
      place.hidden = !isOf('s', optimizers) || !isOf('p', problems);
  }
}

// What is known of a cell of the heat table, at the tolerance and by the measure of the page.
function explanationOf(p, s) {
  const problem = DATA.problems[p], cell = cellOf(problem, s), title = `${DATA.optimizers[s]} on ${problem.spec}`;
  if (cell === undefined) return [title, 'not part of the study'];
  if (!isMeasured(cell)) return [title, 'not applicable'];
  const learned = problem.learned?.rows.find((row) => row.s === s);
  const lines = learned === undefined ? [] : [`error in x at equal work: ${figure(learned.error)} (${figure(learned.low ?? Infinity)}–${figure(learned.high ?? Infinity)})`, `loss in y there: ${figure(learned.loss)}`];
  lines.push(`${reachedOf(cell)}/${cell.reached.length} runs reach ${goalOf(problem)}`);
  MEASURES.forEach((name, measure) => lines.push(`${name}: ${figure(takenBy(cell, view.target, measure))} ${DATA.measures[measure].unit}`));
  if (cell.failed > 0) lines.push(`${cell.failed} failed`);
  if (cell.missing > 0) lines.push(`${cell.missing} missing`);
  return [title, ...lines];
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

function explainMatrix(matrix) {
  const tip = document.getElementById('tip');
  const explain = (event) => {
    const cell = event.target.closest('td[data-p]');
    if (cell !== null) showTip(tip, explanationOf(Number(cell.dataset.p), Number(cell.parentElement.dataset.s)), cell); else tip.hidden = true;
  };
  matrix.addEventListener('pointerover', explain);
  matrix.addEventListener('pointerleave', () => { tip.hidden = true; });
  addEventListener('scroll', () => { tip.hidden = true; }, {passive: true});
}
