// The tables of the first tab, for the tolerance and the measure chosen: figures of the report's own,
// for every one of them.
'use strict';

function setText(cell, text, small = '') {
  cell.textContent = text;
  if (small !== '') cell.append(element('small', {}, small));
}

function drawStandings(table) {
  const rows = new Map([...table.tBodies[0].rows].map((row) => [Number(row.dataset.s), row]));
  table.caption.textContent = `Standings to ${tauName(view.target)} by ${measureNow().counted}`;
  standingsNow().forEach((standing, place) => {
    const row = rows.get(standing.s);
    if (row === undefined) return;
    const [rank, , track, score, solved, wins, typical, runs] = row.cells;
    const dot = track.firstElementChild, [, , , low, high] = DATA.given[standing.s];
    setText(rank, standing.isApart ? '–' : String(place + 1));
    dot.style.setProperty('--at', standing.score);
    for (const [name, end] of [['--low', low], ['--high', high]])  // an interval of the report's own order
      if (isOwn() && end !== null) dot.style.setProperty(name, end); else dot.style.removeProperty(name);
    setText(score, standing.score.toFixed(3));
    setText(solved, String(standing.solved), `/${standing.settings}`);
    setText(wins, standing.wins === 0 ? '·' : String(standing.wins));
    setText(typical, multiple(standing.typical));
    setText(runs, String(standing.reached), `/${standing.runs}`);
    row.classList.toggle('rest', place >= DATA.shownAtFirst);
    table.tBodies[0].append(row);
  });
  for (const head of table.tHead.rows[0].cells) head.removeAttribute('aria-sort');
}

// How far from the best, as a class of the style sheet: how many of the report's steps are passed.
const heatOf = (value, low) => `h${DATA.shades.filter((step) => value / low > step).length}`;

function drawHeatCell(place, cell, low, best) {
  if (!isMeasured(cell)) return;  // not applicable, or missing: to every tolerance
  const work = takenBy(cell), {failed, missing} = cell, all = cell.reached.length, reached = reachedOf(cell);
  const isTold = (reached > 0 && reached < all) || failed > 0 || missing > 0;
  const told = `${reached}/${all}${failed > 0 ? `, ${failed} failed` : ''}${missing > 0 ? `, ${missing} missing` : ''}`;
  place.className = work === Infinity ? 'no' : work <= best ? 'h0 best' : heatOf(atLeast(work), atLeast(low));
  setText(place, amount(work), isTold ? told : '');
}

function drawHeat(table) {
  const {counted, unit} = measureNow(), solved = new Map(standingsNow().map((standing) => [standing.s, standing]));
  const leastOf = (cells) => cells.reduce((low, cell) => Math.min(low, takenBy(cell)), Infinity);
  const least = DATA.problems.map(({cells}) => leastOf(cells));
  const best = DATA.problems.map(({cells}, p) =>  // on common settings of the ranked ones
    leastOf(DATA.common.includes(p) ? cells.filter((cell) => DATA.ranked.includes(cell.s)) : cells));
  table.caption.textContent = `Median ${counted} to ${tauName(view.target)}${unit === counted ? '' : `, in ${unit}`}; ` +
      'of learned problems the error in x at equal work';
  for (const row of table.tBodies[0].rows) {
    const s = Number(row.dataset.s), standing = solved.get(s);
    if (standing !== undefined) setText(row.cells[1], String(standing.solved), `/${standing.settings}`);
    for (const place of row.querySelectorAll('td[data-p]')) {
      const p = Number(place.dataset.p), problem = DATA.problems[p], cell = cellOf(problem, s);
      if (problem.learned === undefined && cell !== undefined) drawHeatCell(place, cell, least[p], best[p]);
    }
  }
}

// Rows of class `rest` are shown on demand.
function makeMore(button) {
  const table = document.getElementById(button.dataset.table), all = button.textContent;
  button.hidden = false;
  button.addEventListener('click', () => {
    const isFolded = table.classList.toggle('folded');
    button.textContent = isFolded ? all : button.dataset.less;
  });
}

function liveOverview() {
  const standings = document.getElementById('standings-table'), heat = document.getElementById('heat');
  let areChanged = false;  // as they come they are right
  FOLLOWERS.push(() => { areChanged = areChanged || !isOwn(); });
  live(standings, () => { if (areChanged) drawStandings(standings); });  // none where all is learned
  live(heat, () => { if (areChanged) drawHeat(heat); });
  if (heat !== null) explainMatrix(heat);
  document.querySelectorAll('button.more').forEach(makeMore);
}
