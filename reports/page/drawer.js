// The evidence of a figure: what is known of a method on a problem, its curve, its records, and the
// commands that repeat it.

// A row of the table of all cells, packed or not: it has the command.
function commandOf(p, s) {
  const packed = document.querySelector('#cells > noscript')?.textContent;
  if (packed === undefined) return [...LONG.values()][0]?.rows.find((row) => row.dataset.p === String(p) && row.dataset.s === String(s))?.querySelector('[data-command]')?.dataset.command;
  const row = packed.match(new RegExp(`<tr data-s=${s} data-p=${p}>.*`))?.[0], made = document.createElement('template');
  made.innerHTML = row?.match(/<button.*<\/button>/)?.[0] ?? '';
  return made.content.firstChild?.dataset.command;
}

// Its line in the chart that the article shows, from the article as it came or as it stands.
function sparkline(p, s) {
  const article = document.getElementById(`problem-${p}`), packed = article.querySelector(':scope > noscript'), made = document.createElement('template');
  if (packed !== null) made.innerHTML = packed.textContent;
  const path = (packed === null ? article : made.content).querySelector(`.curves > .chart:not([hidden]) .area > [data-s="${s}"] .line`);
  if (path === null) return [];
  const drawn = svgElement('svg', {class: 'spark', viewBox: `0 0 ${AREA} ${AREA}`, preserveAspectRatio: 'none', 'data-s': s, role: 'img', 'aria-label': 'Its curve'});
  drawn.append(svgElement('path', {d: path.getAttribute('d')}));
  return [drawn];
}

const withCopy = (command) => [element('code', {}, command), ' ', Object.assign(pressable('copy', undefined, (event) => copyText(command, event.currentTarget)), {className: 'copy'})];

function showDrawer(...content) {
  const drawer = document.getElementById('drawer'), close = pressable('close', undefined, () => drawer.close());
  drawer.replaceChildren(close, ...content);
  document.getElementById('tip').hidden = true;
  if (!drawer.open) drawer.show();
  close.focus();
}

// What stands behind a row of the ranking: the method's median on each setting that counts.
function openMethod(s) {
  const {counted, unit} = measureNow(), card = element('a', {href: `#optimizer-${s}`}, worded('method-card'));
  const settings = DATA.common.filter((p) => cellOf(DATA.problems[p], s) !== undefined), least = (p) => Math.min(...DATA.ranked.map((other) => cellOf(DATA.problems[p], other)).filter((cell) => cell !== undefined).map((cell) => takenBy(cell)));
  const table = element('table', {className: 'settings-of'});
  filledTable(table, worded('heat', {measure: counted, tau: tauName(view.target), unit: unit === counted ? '' : worded('unit', {unit})}), [element('tr', {}, ...worded('method-columns').split(' | ').map((head) => element('th', {scope: 'col'}, head)))], settings.map((p) => {
    const cell = cellOf(DATA.problems[p], s), row = element('tr', {}, element('th', {scope: 'row'}, DATA.problems[p].spec), ...isMeasured(cell) ? [cellWith(amount(takenBy(cell))), cellWith(amount(least(p))), cellWith(`${reachedOf(cell)}/${cell.reached.length}`)] : [cellWith('n/a'), cellWith(amount(least(p))), cellWith('')]);
    Object.assign(row.dataset, {p, s});
    return row;
  }));
  card.addEventListener('click', () => document.getElementById('drawer').close());
  showDrawer(element('h3', {}, DATA.optimizers[s]), element('p', {}, card), table);
}

function openDrawer(p, s) {
  const [title, ...lines] = explanationOf(p, s), {records = [], reached = []} = cellOf(DATA.problems[p], s) ?? {}, command = commandOf(p, s);
  const curves = element('a', {href: `#problem-${p}`}, 'all curves of this problem');
  curves.addEventListener('click', () => {
    document.getElementById('drawer').close();
    showLines(p, [...linesShown(p), s]);
  });
  showDrawer(element('h3', {}, title), ...lines.map((line) => element('p', {}, line)), ...sparkline(p, s), element('p', {}, curves),
      ...command === undefined ? [] : [element('p', {}, 'All runs of this cell: ', ...withCopy(command))],
      ...records.length === 0 ? [] : [element('p', {}, records.length < reached.length ? `The first ${records.length} of ${reached.length} records:` : 'Records, each with the command that repeats its run:'), element('ul', {}, ...records.map((name) => {
        const file = `${DATA.runs}${name}.json`;
        return element('li', {}, DATA.runs === '' ? `${name}.json` : element('a', {href: file}, `${name}.json`), element('br'), ...withCopy(`./isoline replay RESULTS/runs/${name}.json`));
      }))]);
}

document.addEventListener('keydown', ({key}) => { if (key === 'Escape') document.getElementById('drawer').close(); });
document.addEventListener('click', (event) => {
  const ranked = event.target.closest('#standings-table td'), of = event.target.closest('.settings-of td')?.parentElement.dataset;
  if (ranked !== null) openMethod(Number(ranked.parentElement.dataset.s));
  if (of !== undefined) openDrawer(Number(of.p), Number(of.s));
  const cell = event.target.closest('#heat td[data-p], .reached td, #cells td'), chart = event.target.closest('.curves > .chart');
  const point = chart && !isDragged ? nearest(chart, event) : undefined, {p} = (chart ?? cell)?.closest('[data-p]')?.dataset ?? {};
  if (point) openDrawer(Number(p), lineOf(point.group));
  else if (cell !== null && event.target.closest('button, a') === null) openDrawer(Number(p), Number(cell.parentElement.dataset.s));
});
