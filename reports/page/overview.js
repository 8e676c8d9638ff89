// The tables of the first tab, for the tolerance and the measure chosen: figures of the report's own,
// for every one of them.
const SHOWN_AT_FIRST = 16;  // of the standings; the others on demand

const cellWith = (text, small = '', properties = {}) => element('td', properties, text, ...small === '' ? [] : [element('small', {}, small)]);
const nameOfMethod = (s) => [element('a', {href: `#optimizer-${s}`}, swatch(s), DATA.optimizers[s]), ...DATA.marks[s] === '' ? [] : [element('sup', {title: DATA.privileges[s]}, DATA.marks[s].trim())]];

function filledTable(table, caption, heads, rows) {
  table.replaceChildren(element('caption', {}, caption), element('thead', {}, ...heads), element('tbody', {}, ...rows));
}

// A table that scrolls by itself where it is wider than the page.
function scrolled(table) {
  const place = element('div', {className: 'scroll', tabIndex: 0}, table), made = element('div', {}, place);
  place.setAttribute('role', 'group');
  place.setAttribute('aria-label', table.caption.textContent);
  addCopies(table);
  return made;
}

// Its score as a dot on a track from 0 to 1, with the interval of the report's own order.
function trackOf(s, score) {
  const dot = element('i'), [, , , low, high] = DATA.given[s];
  dot.style.setProperty('--at', score);
  if (isOwn() && low !== null) {
    dot.style.setProperty('--low', low);
    dot.style.setProperty('--high', high);
  }
  return element('td', {className: 'track'}, dot);
}

function standingRow({s, score, solved, settings, wins, typical, reached, runs, failed}, place, isRest, remark = '') {
  const row = element('tr', {className: `${isRest ? 'rest' : ''} ${isOwn() && DATA.group.includes(s) ? 'tied' : ''}`}, cellWith(place),
      element('th', {scope: 'row', title: remark && worded('pinned-title')}, ...nameOfMethod(s), ...remark === '' ? [] : [element('small', {}, remark)]), trackOf(s, score), cellWith(score.toFixed(3)), cellWith(String(solved), `/${settings}`),
      cellWith(String(wins)), cellWith(multiple(typical)), cellWith(String(reached), `/${runs}`),
      cellWith(String(failed), '', {className: failed === 0 ? '' : 'lost'}));
  row.dataset.s = s;
  return row;
}

// Methods that are not ranked since they see more on some settings: those settings alone count.
function pinnedRows() {
  if (!isOwn()) return [];
  return DATA.pinned.map(([settings, runs, failed, [s, score, solved, wins, typical, reached]]) =>
    standingRow({s, score, solved, settings, wins, typical: typical ?? Infinity, reached, runs, failed}, '–', false, worded('pinned', {settings, all: DATA.common.length})));
}

function drawStandings(table) {
  const rows = standingsNow().filter((standing) => standing.settings > 0);  // others learn alone
  const shown = rows.filter(({s}) => isShown('s', s));  // what the reader chose is not folded
  const heads = worded('ranking-columns').split(' | ');
  if (rows.length === 0 || DATA.allLearned)
    return table.replaceChildren(element('caption', {}, worded('all-learned')));
  if (isDoubtful()) return table.replaceChildren(element('caption', {}, worded('not-timed')));
  filledTable(table, worded('ranking', {tau: tauName(view.target), measure: measureNow().counted}),
      [element('tr', {}, ...heads.map((head) => element('th', {scope: 'col'}, head)))], [
    ...rows.map((row, i) => standingRow(row, String(i + 1), shown.indexOf(row) >= SHOWN_AT_FIRST)), ...pinnedRows()]);
  makeSortable(table);
  addCopies(table);
}

// How far from the best, as a class of the style sheet: how many of the report's steps are passed.
const heatOf = (value, low) => `h${DATA.shades.filter((step) => value / low > step).length}`;

function heatCell(cell, low, best, isUnknown = false) {
  if (cell === undefined) return cellWith('', '', {className: 'none'});
  const work = takenBy(cell), {failed, missing} = cell, all = cell.reached.length, reached = reachedOf(cell);
  if (all === 0) return missing > 0 ? cellWith('missing', '', {className: 'lost'}) : cellWith('n/a', '', {className: 'na'});
  if (isUnknown) return cellWith('?', '', {className: 'none'});  // no loss of it counts as solved
  const isTold = (reached > 0 && reached < all) || failed > 0 || missing > 0;
  const told = `${reached}/${all}${failed > 0 ? `, ${failed} failed` : ''}${missing > 0 ? `, ${missing} missing` : ''}`;
  return cellWith(amount(work), isTold ? told : '', {className: work === Infinity ? 'no' : isDoubtful() ? '' : work <= best ? 'h0 best' : heatOf(atLeast(work), atLeast(low))});
}

// The error in x of a learned problem at equal work.
function learnedCell(problem, s) {
  const row = problem.learned.rows.find((one) => one.s === s), least = problem.learned.rows[0]?.error;
  if (row === undefined) return heatCell(cellOf(problem, s), 0, 0);
  if (row.error === null) return cellWith('✗', '', {className: 'no'});
  return cellWith(short(row.error), row.diverged > 0 ? worded('diverged', {runs: row.diverged}) : '', {className: row.error === least ? 'h0 best' : heatOf(row.error, least)});
}

// Best first; where all is learned, by how often each is nearest in x at equal work.
function bestFirst() {
  const nearest = (s) => DATA.problems.filter(({learned}) => learned?.rows[0]?.s === s).length, all = [...DATA.kinds.keys()];
  return DATA.allLearned ? all.sort((a, b) => nearest(b) - nearest(a)) : all;
}

// A long name loses the options without which it can be told from the others, then the middle of what stands
// before them.
const optionsIn = (spec) => [...spec.matchAll(/[[,]([^=\],]+)=([^\],]*)/g)];
const without = (spec, idle) => spec.replace(/\[.*\]/, () => {
  const kept = optionsIn(spec).filter(([, key]) => !idle.has(key)).map(([, key, value]) => `${key}=${value}`);
  return kept.length === 0 ? '' : `[${kept.join(',')}]`;
});
const IDLE = [...new Set(DATA.problems.flatMap(({spec}) => optionsIn(spec).map(([, key]) => key)))].reverse().reduce((idle, key) => {
  const more = new Set([...idle, key]), count = (of) => new Set(DATA.problems.map(({spec}) => without(spec, of))).size;
  return count(more) === DATA.problems.length ? more : idle;
}, new Set());
function brief({spec}) {
  const most = 24, text = spec.length <= most ? spec : without(spec, IDLE), [name, rest] = text.split(/(?=\[)/), room = Math.max(8, most - (rest ?? '').length);
  return name.length <= room ? text : `${name.slice(0, Math.ceil(room / 2) - 1)}…${name.slice(-Math.floor(room / 2))}${rest ?? ''}`;
}

function heatHeads(columns) {
  const groups = new Map();
  for (const p of columns) groups.set(DATA.problems[p].group, (groups.get(DATA.problems[p].group) ?? 0) + 1);
  const head = (text, properties) => element('th', {scope: 'col', ...properties}, text);
  return [element('tr', {}, head('optimizer', {rowSpan: 2}), head('solved', {rowSpan: 2}),
      ...[...groups].map(([group, count]) => head(group === 'learned' ? worded('learned') : group, {className: 'group', colSpan: count, scope: 'colgroup'}))),
    element('tr', {}, ...columns.map((p) => {
      const made = head(element('a', {href: `#problem-${p}`, title: DATA.problems[p].spec}, element('span', {}, brief(DATA.problems[p]))));
      made.dataset.p = p;
      return made;
    }))];
}

const heatColumns = () => ['physics', 'learned', 'other', 'toy', 'classical'].flatMap((group) => [...DATA.problems.keys()].filter((p) => DATA.problems[p].group === group));

// The best of each kind is shown, the rest of its kind below it on demand.
function drawHeat(table, columns = heatColumns()) {
  const {counted, unit} = measureNow(), solved = new Map(standingsNow().map((standing) => [standing.s, standing]));
  const leastOf = (cells) => cells.reduce((low, cell) => Math.min(low, takenBy(cell)), Infinity);
  const least = DATA.problems.map(({cells}) => leastOf(cells));
  const best = DATA.problems.map(({cells}, p) =>  // on common settings of the ranked ones
    leastOf(DATA.common.includes(p) ? cells.filter((cell) => DATA.ranked.includes(cell.s)) : cells));
  const kinds = new Map();
  for (const s of bestFirst()) kinds.set(DATA.kinds[s], [...kinds.get(DATA.kinds[s]) ?? [], s]);
  const shown = [...kinds].flatMap(([kind, all]) => all.filter((s) => isShown('s', s)).map((s, i) => ({s, kind: i === 0 ? kind : undefined})));
  const rows = shown.map(({s, kind}) => {
    const standing = solved.get(s), by = new Map(DATA.problems.map((problem, p) => [p, problem.cells.find((cell) => cell.s === s)]));
    const row = element('tr', {className: kind === undefined ? 'rest' : ''},
        element('th', {scope: 'row'}, ...nameOfMethod(s), ...kind === undefined ? [] : [element('small', {}, kind)]),
        standing === undefined ? cellWith('') : cellWith(String(standing.solved), `/${standing.settings}`, {className: 'solved'}),
        ...columns.map((p) => {
          const place = DATA.problems[p].learned === undefined ? heatCell(by.get(p), least[p], best[p], DATA.problems[p].isUnknown) : learnedCell(DATA.problems[p], s);
          place.dataset.p = p;
          return place;
        }));
    row.dataset.s = s;
    return row;
  });
  filledTable(table, worded('heat', {measure: counted, tau: tauName(view.target), unit: unit === counted ? '' : worded('unit', {unit})}),
      heatHeads(columns), rows);
  addCopies(table);
}

// Paper has room for so many columns; the others follow below.
const MOST_ON_PAPER = 12;
function layOnPaper(heat) {
  const all = heatColumns();
  for (let at = all.length; at > 0 && all.length > MOST_ON_PAPER; at -= MOST_ON_PAPER) {
    const part = element('table', {className: 'matrix on-paper'});
    heat.after(part);
    drawHeat(part, all.slice(Math.max(0, at - MOST_ON_PAPER), at));
  }
}

// Rows of class `rest` are shown on demand.
function makeMore(table, draw) {
  const button = pressable('', undefined, () => {
    table.classList.toggle('folded');
    label();
  });
  button.className = 'more';
  button.hidden = true;  // until its table is drawn
  table.parentElement.after(element('p', {}, button));
  const label = () => {
    const rest = table.querySelectorAll('.rest').length, all = table.tBodies[0]?.rows.length ?? 0;
    button.hidden = rest === 0;
    button.textContent = table.classList.contains('folded') ? worded('more', {rows: all}) : worded('less', {rows: all - rest});
  };
  return () => {
    draw(table);
    label();
  };
}

function liveOverview() {
  const motion = document.getElementById('motion'), standings = document.getElementById('standings-table'), heat = document.getElementById('heat');
  liveRace(motion);
  live(standings, makeMore(standings, drawStandings));
  [standings, motion].forEach(refresh);  // at once: a picture may be taken when the page has loaded
  live(heat, makeMore(heat, drawHeat));
  soon(heat, () => refresh(heat));  // it stands a little below the first screen
  explainMatrix(heat);
  addEventListener('beforeprint', () => layOnPaper(heat));
  addEventListener('afterprint', () => document.querySelectorAll('.on-paper').forEach((part) => part.remove()));
}
