// The evidence of a number: the data of a method on a problem, its curve, its records, and the
// commands that repeat it.

// Its line in the chart that the article shows, from the article as it came or as it stands.
function sparkline(p, s) {
  const article = document.getElementById(`problem-${p}`), packed = article.querySelector(':scope > noscript'), made = document.createElement('template');
  if (packed !== null) {
    made.innerHTML = packed.textContent;
    completeCharts(made.content, p);
  }
  const path = (packed === null ? article : made.content).querySelector(`.curves > .chart:not([hidden]) .area > [data-s="${s}"] .line`);
  if (path === null) return [];
  const drawn = svgElement('svg', {class: 'spark', viewBox: `0 0 ${AREA} ${AREA}`, preserveAspectRatio: 'none', 'data-s': s, role: 'img', 'aria-label': 'Its curve'});
  drawn.append(svgElement('path', {d: path.getAttribute('d')}));
  return [drawn];
}

const withCopy = (command) => [element('code', {}, command), ' ', Object.assign(pressable('copy', undefined, (event) => copyText(command, event.currentTarget)), {className: 'copy'})];

function showDrawer(...content) {
  const drawer = document.getElementById('drawer'), before = document.activeElement, close = pressable('close', undefined, () => drawer.close());
  drawer.replaceChildren(close, ...content);
  document.getElementById('tip').hidden = true;
  if (!drawer.open) {
    drawer.show();
    drawer.addEventListener('close', () => before.focus(), {once: true});  // back to the cell
  }
  close.focus();
}

// The settings behind a number: the median of each method on each of them; of one method also the least of
// all that are ranked. A filter hides no evidence, so what names a method is `line`.
function openSettings(title, methods, settings, none = worded('no-settings')) {
  const {counted, unit} = measureNow(), isOne = methods.length === 1, table = element('table', {className: 'settings-of'}), tau = tauName(view.target);
  const least = (p) => Math.min(...DATA.ranked.map((s) => cellOf(DATA.problems[p], s)).filter((cell) => cell !== undefined).map((cell) => takenBy(cell)));
  const told = (cell) => `${reachedOf(cell)}/${cell.reached.length}${cell.failed > 0 ? worded('failed-of', {runs: cell.failed}) : ''}`;
  const cellsOf = (p, s) => {
    const cell = cellOf(DATA.problems[p], s), isKnown = cell !== undefined && isMeasured(cell);
    return [cellWith(isKnown ? amount(takenBy(cell)) : cell === undefined ? '' : 'n/a'), ...isOne ? [cellWith(amount(least(p))), cellWith(isKnown ? told(cell) : '')] : []].map((one) => Object.assign(one.dataset, {p, line: s}) && one);
  };
  const heads = isOne ? worded('method-columns').split(' | ') : [worded('method-columns').split(' | ')[0], ...methods.map((s) => DATA.optimizers[s])];
  const all = settings.filter((p) => methods.some((s) => cellOf(DATA.problems[p], s) !== undefined));
  filledTable(table, all.length === 0 ? none : worded('settings', {measure: counted, tau, unit: unit === counted ? '' : worded('unit', {unit})}), [element('tr', {}, ...heads.map((head) => element('th', {scope: 'col'}, head)))],
      all.map((p) => element('tr', {}, element('th', {scope: 'row'}, DATA.problems[p].spec), ...methods.flatMap((s) => cellsOf(p, s)))));
  showDrawer(element('h3', {}, title), ...methods.map((s) => element('p', {}, leaving(`#optimizer-${s}`, worded('method-card', {method: DATA.optimizers[s]})))), scrolled(table));
}

// A link to another part of the page closes what lies over it.
function leaving(address, text) {
  const link = element('a', {href: address}, text);
  link.addEventListener('click', () => document.getElementById('drawer').close());
  return link;
}

// The x of a run: the first unknowns, and where the others are.
function answerOf({answer}) {
  if (!answer) return [];
  const {seed, loss, norm, unknowns, file, columns} = answer, shown = Math.max(0, (columns[0]?.length ?? 0) - 1), table = element('table', {className: 'answer-of'});
  const rowOf = (i) => element('tr', {}, ...columns.map((texts, column) => element(i === 0 || column === 0 ? 'th' : 'td', {scope: i === 0 ? 'col' : 'row'}, texts[i])));
  const caption = worded('answer', {seed, loss, norm: norm === undefined ? '' : worded('answer-norm', {norm})}), rest = file === '' ? 'answer-rest' : 'answer-file';
  filledTable(table, caption, shown === 0 ? [] : [rowOf(0)], Array.from({length: shown}, (_, i) => rowOf(i + 1)));
  return [scrolled(table), ...shown === unknowns ? [] : [element('p', {}, ...guideText(worded(rest, {shown, unknowns, file})))]];
}

// What is known of a method on a problem, its curve, its x, the command of all its runs, and each record.
function evidenceOf(p, s) {
  const [title, ...lines] = explanationOf(p, s), cell = cellOf(DATA.problems[p], s) ?? {}, {records = [], reached = [], command} = cell, curves = leaving(`#problem-${p}`, worded('all-curves'));
  curves.addEventListener('click', () => showLines(p, [...linesShown(p), s]));
  return [element('h3', {}, title), ...lines.map((line) => element('p', {}, line)), ...sparkline(p, s), element('p', {}, curves), ...answerOf(cell),
    ...command === undefined ? [] : [element('p', {}, worded('cell-command'), ' ', ...withCopy(command))],
    ...records.length === 0 ? [] : [element('p', {}, worded(records.length < reached.length ? 'first-records' : 'all-records', {shown: records.length, all: reached.length})), element('ul', {}, ...records.map((name) => {
      const file = `${DATA.runs}${name}.json`;
      return element('li', {}, DATA.runs === '' ? `${name}.json` : element('a', {href: file}, `${name}.json`), element('br'), ...withCopy(`./isoline replay RESULTS/runs/${name}.json`));
    }))]];
}

const openDrawer = (p, ...methods) => showDrawer(...methods.flatMap((s) => evidenceOf(p, s)));

// The runs that decide a claim, from its part of the page as it came or as it stands.
function openClaim(id) {
  const claim = document.getElementById(`claim-${id}`), packed = claim.querySelector(':scope > noscript'), made = document.createElement('template');
  made.innerHTML = packed === null ? claim.innerHTML : packed.textContent;
  const parts = [...made.content.querySelectorAll('.decided > dl, table')].filter((part) => part.tagName === 'DL' || part.querySelector('th:last-child')?.textContent === 'record');
  showDrawer(element('h3', {}, claim.querySelector('summary').textContent), element('p', {}, leaving(`#claim-${id}`, worded('whole-claim'))), ...parts.reverse().map((part) => part.tagName === 'DL' ? part : scrolledPart(part)));
}
const scrolledPart = (table) => element('div', {className: 'scroll claim-runs'}, table);

// What is measured apart from runs, and the command that measures it again.
const openCommand = (title, key, command, ...file) => showDrawer(element('h3', {}, title), element('p', {}, worded(key)), ...file, element('p', {}, ...withCopy(command)));
const openPrices = ({spec, sheet}) => openCommand(spec, 'measured-again', `./isoline run --problem '${spec}' --optimizer gd --out results/costs`, element('p', {}, DATA.runs === '' ? `${sheet}` : element('a', {href: `${DATA.runs}../components/${sheet}`}, sheet)));

// What the place of a cell says of its number: by itself, or by its row, its column or the part of the page
// around it.
function keysOf(cell) {
  const table = cell.closest('table'), row = cell.parentElement, head = table.tHead?.rows.length === 1 ? table.tHead.rows[0].cells[cell.cellIndex] : undefined;
  const key = (name) => [cell, row, head, table.closest(`[data-${name}]`)].find((place) => place?.dataset[name] !== undefined)?.dataset[name];
  const [p, s] = cell.dataset.of?.split(' ') ?? [key('p'), key('line') ?? key('s')], numbers = [p, s].map((text) => (text === undefined ? undefined : Number(text)));
  return {p: numbers[0], s: numbers[1], claim: key('claim'), method: table.id === 'methods-table' ? DATA.methods[numbers[1]] : key('method'), table: table.dataset.table, column: head?.textContent};
}

// The settings that a table with a row for each method is about.
function settingsBehind(table, column, s) {
  const all = [...DATA.problems.keys()];
  if (column === 'failed') return all.filter((p) => cellOf(DATA.problems[p], s)?.failed > 0);
  if (table === 'sanity') return DATA.sanity;
  if (table === 'certified') return all.filter((p) => DATA.problems[p].name === 'nist');
  return ['calls', 'discrepancy', 'loss-without-x', 'size', 'variation', 'rates', 'tuning-choices'].includes(table) ? all : DATA.common;
}

function openEvidence(cell) {
  const {p, s, claim, method, table, column} = keysOf(cell);
  if (claim !== undefined) return openClaim(claim);
  if (p !== undefined && s !== undefined) return openDrawer(p, s);
  if (DATA.problems[p]?.sheet !== undefined) return openPrices(DATA.problems[p]);
  if (table === 'conduct-rules') return openCommand(cell.parentElement.cells[0].textContent, 'conduct-again', './isoline audit --conduct');
  if (table === 'conduct-raw') return openCommand(cell.parentElement.cells[0].textContent, 'measured-raw', 'python3 clients/peers/conduct/conduct.py measure conduct.json', element('p', {}, cell.title));
  if (method !== undefined) return openCommand(method, 'audited-again', `./isoline audit ${table === 'conduct-table' ? '--conduct ' : ''}${method}`, element('p', {}, cell.title));
  if (s === undefined) return;  // a name, or a number of the report as a whole
  const pair = table === 'leader' && s !== DATA.ranked[0] ? [DATA.ranked[0], s] : [s];
  openSettings(pair.map((one) => DATA.optimizers[one]).join(' : '), pair, settingsBehind(table, column, s), column === 'failed' ? worded('none-failed') : undefined);
}

const NUMBERS = 'main td:not(.optimizer td, .prices td), #drawer .settings-of td';
document.addEventListener('click', (event) => {
  if (event.target.closest('button, a') !== null) return;
  const cell = event.target.closest(NUMBERS), chart = event.target.closest('.chart'), point = chart && !isDragged ? nearest(chart, event) : undefined;
  if (cell !== null) {  // arrows lead on from here when the drawer is closed
    cell.tabIndex = -1;
    cell.focus({preventScroll: true});
    openEvidence(cell);
  }
  if (!point) return;
  const {p, claim} = chart.closest('[data-p], [data-claim]')?.dataset ?? {}, {s} = point.group.dataset;
  if (claim !== undefined) openClaim(claim);
  else if (p !== undefined) openDrawer(Number(p), lineOf(point.group));
  else if (s !== undefined) openSettings(DATA.optimizers[s], [Number(s)], DATA.common);
});

// By the keyboard: Enter in a table that has the focus goes to its first number, arrows to the next, Enter opens
// what stands behind it.
document.addEventListener('keydown', (event) => {
  const {key} = event, at = document.activeElement, row = at.closest?.('td')?.parentElement;
  if (key === 'Escape') document.getElementById('drawer').close();
  if (key === 'Enter' && row) {
    event.preventDefault();  // else it would press the button that has the focus then
    return at.click();
  }
  const rows = row ? [...row.parentElement.rows].filter((one) => one.getClientRects().length > 0) : [], next = {
    Enter: () => (at.matches('.scroll') ? at.querySelector('td') : null), Escape: () => row && at.closest('.scroll'),
    ArrowRight: () => row && at.nextElementSibling, ArrowLeft: () => row && at.previousElementSibling,
    ArrowDown: () => rows[rows.indexOf(row) + 1]?.cells[at.cellIndex], ArrowUp: () => rows[rows.indexOf(row) - 1]?.cells[at.cellIndex]}[key]?.();
  if (!next) return;
  event.preventDefault();
  if (next.matches('td')) next.tabIndex = -1;
  next.focus();
});
