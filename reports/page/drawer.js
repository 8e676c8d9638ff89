// The evidence of a figure: what is known of a method on a problem, its curve, its records, and the
// commands that repeat it.

// A row of the table of all cells, packed or not: it has the command.
function commandOf(p, s) {
  const packed = document.querySelector('#cells > noscript')?.textContent;
  if (packed === undefined) return [...LONG.values()][0]?.rows.find((row) => row.dataset.p === String(p) && row.dataset.s === String(s))?.querySelector('[data-command]')?.dataset.command;
  const row = packed.match(new RegExp(`<tr data-p=${p} data-s=${s}>.*`))?.[0], made = document.createElement('template');
  made.innerHTML = row?.match(/<button.*<\/button>/)?.[0] ?? '';
  return made.content.firstChild?.dataset.command;
}

// Its line in the chart of the report's own measure, from the article as it came or as it stands.
function sparkline(p, s) {
  const article = document.getElementById(`problem-${p}`), html = (article.querySelector(':scope > noscript')?.textContent ?? article.querySelector('.curves')?.innerHTML ?? '').replaceAll('="', '=').replaceAll('"', ' ');
  const chart = html.split('<svg class=chart').find((part) => part.includes('data-by=') && !part.slice(0, part.indexOf('role=')).includes('hidden'));
  const path = chart?.match(new RegExp(`<g data-s=${s} ?(?:class=off ?)?>(?:<path class=band [^>]*>)?(?:</path>)?<path class=line d=([^>/]*?) ?/?>`))?.[1];
  if (path === undefined) return [];
  const drawn = svgElement('svg', {class: 'spark', viewBox: `0 0 ${AREA} ${AREA}`, preserveAspectRatio: 'none', 'data-s': s, role: 'img', 'aria-label': 'Its curve'});
  drawn.append(svgElement('path', {d: path}));
  return [drawn];
}

const withCopy = (command) => [element('code', {}, command), ' ', Object.assign(pressable('copy', undefined, (event) => copyText(command, event.currentTarget)), {className: 'copy'})];

function openDrawer(p, s) {
  const drawer = document.getElementById('drawer'), [title, ...lines] = explanationOf(p, s), {records = []} = cellOf(DATA.problems[p], s) ?? {}, command = commandOf(p, s);
  const close = pressable('close', undefined, () => drawer.close()), curves = element('a', {href: `#problem-${p}`}, 'all curves of this problem');
  curves.addEventListener('click', () => {
    drawer.close();
    showLines(p, [...linesShown(p), s]);
  });
  drawer.replaceChildren(close, element('h3', {}, title), ...lines.map((line) => element('p', {}, line)), ...sparkline(p, s), element('p', {}, curves),
      ...command === undefined ? [] : [element('p', {}, 'All its runs: ', ...withCopy(command))],
      ...records.length === 0 ? [] : [element('p', {}, 'Records, and what repeats each:'), element('ul', {}, ...records.map((name) => {
        const file = `${DATA.runs}${name}.json`;
        return element('li', {}, DATA.runs === '' ? `${name}.json` : element('a', {href: file}, `${name}.json`), element('br'), ...withCopy(`./isoline replay RESULTS/runs/${name}.json`));
      }))]);
  document.getElementById('tip').hidden = true;
  if (!drawer.open) drawer.show();
  close.focus();
}

document.addEventListener('keydown', ({key}) => { if (key === 'Escape') document.getElementById('drawer').close(); });
document.addEventListener('click', ({target}) => {
  const cell = target.closest('#heat td[data-p]');
  if (cell !== null) openDrawer(Number(cell.dataset.p), Number(cell.parentElement.dataset.s));
});
