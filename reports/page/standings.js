// The tables of standings and of work, redrawn for what is shown and the tolerance chosen.
'use strict';

const multiple = (ratio) => (ratio === Infinity ? '✗' : `${Number(ratio.toPrecision(3))}×`);

function setText(cell, text, small = '') {
  cell.textContent = text;
  if (small !== '') cell.append(element('small', {}, small));
}

function drawStandings(table) {
  const rows = new Map([...table.tBodies[0].rows].map((row) => [Number(row.dataset.s), row]));
  table.caption.textContent = `Standings to ${tauName(view.target)}`;
  standingsOf(view.target).forEach((standing, place) => {
    const row = rows.get(standing.s), [rank, , score, solved, wins, typical, runs, failed] = row.cells;
    const bar = solved.querySelector('i');
    setText(rank, standing.isApart === true ? '–' : String(place + 1));
    setText(score, standing.score.toFixed(3));
    setText(solved, '');
    bar.style.setProperty('--w', 100 * standing.solved / standing.problems);
    solved.append(bar, String(standing.solved), element('small', {}, `/${standing.problems}`));
    setText(wins, standing.wins === 0 ? '·' : String(standing.wins));
    setText(typical, multiple(2 ** median(standing.ratios.map(Math.log2))));
    setText(runs, String(standing.reached), `/${standing.runs}`);
    setText(failed, standing.failed === 0 ? '·' : String(standing.failed));
    failed.className = standing.failed === 0 ? '' : 'lost';
    table.tBodies[0].append(row);
  });
  for (const head of table.tHead.rows[0].cells) head.removeAttribute('aria-sort');
}

// How far from the best, as a class of the style sheet: by factors of two.
const heatOf = (work, low) => `h${Math.min(7, Math.ceil(Math.log2(ratioOf(work, low))))}`;

function drawCell(place, cell, low) {
  const work = workOf(cell, view.target);
  if (!isMeasured(cell)) return;  // not applicable, or missing: to every tolerance
  const {failed, missing} = cell, all = cell.reached.length, reached = reachedOf(cell, view.target);
  const isTold = (reached > 0 && reached < all) || failed > 0 || missing > 0;
  const told = `${reached}/${all}${failed > 0 ? `, ${failed} failed` : ''}${missing > 0 ? `, ${missing} missing` : ''}`;
  place.className = work === Infinity ? 'no' : work === low ? 'h0 best' : heatOf(work, low);
  setText(place, amount(work), isTold ? told : '');
}

function drawMatrix(table) {
  const rows = new Map([...table.tBodies[0].rows].map((row) => [Number(row.dataset.s), row]));
  const standings = standingsOf(view.target);
  table.caption.textContent = `Median ${DATA.counted} to ${tauName(view.target)}${DATA.unit === DATA.counted ? '' : `, in ${DATA.unit}`}`;
  for (const p of shownOf('p')) {
    const cells = shownCells(DATA.problems[p]), low = leastWork(cells, view.target);
    for (const cell of cells) drawCell(rows.get(cell.s).cells[p + 2], cell, low);
  }
  for (const standing of standings) {
    const row = rows.get(standing.s);
    setText(row.cells[1], String(standing.solved), `/${standing.problems}`);
    table.tBodies[0].append(row);
  }
}

// The greatest share within a factor, and who has it.
function leadersWithin(profile, factor) {
  let share = 0, names = [];
  for (const [s, [problems, ...ratios]] of profile) {
    const mine = ratios.filter((ratio) => ratio <= factor).length / problems;
    if (mine > share) names = [];
    share = Math.max(share, mine);
    if (mine === share) names.push(DATA.optimizers[s]);
  }
  return {share, who: names.length > 3 ? `${names.length} methods` : names.join(' and ')};
}

function profileReading(profile) {
  const near = leadersWithin(profile, 2), ever = leadersWithin(profile, Infinity), tau = tauName(view.target);
  if (ever.share === 0) return `No method shown solves any of its problems to ${tau}.`;
  return `Among the shown, within 2× of the least ${DATA.counted} to ${tau}: ${(100 * near.share).toFixed(0)} % of its problems, by ` +
      `${near.who}; at any price: ${(100 * ever.share).toFixed(0)} %, by ${ever.who}.`;
}
