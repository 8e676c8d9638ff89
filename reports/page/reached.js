// What each optimizer took to reach the tolerance on one problem: a table with bars.
'use strict';

const MOST_ROWS = 12;  // more on demand

// The bar is longer the more the work, by factors of two; the least has the shortest.
function workBar(work, low, most) {
  const bar = element('i');
  const span = Math.log2(Math.max(2, most / low));
  bar.style.setProperty('--w', 12 + 88 * Math.log2(work / low) / span);
  return bar;
}

function reachedRow(cell, low, most) {
  const work = workOf(cell, view.target), time = timeOf(cell, view.target);
  const name = element('th', {scope: 'row'}, swatch(cell.s, false), DATA.optimizers[cell.s], ...originOf(cell));
  const taken = element('td', {className: 'taken'});
  if (work === Infinity) taken.append(element('span', {className: 'cross'}, '✗'));
  else taken.append(workBar(...[work, low, most].map((one) => Math.max(one, LEAST_UNIT))), amount(work));
  const row = element('tr', {}, name, taken, element('td', {}, time === Infinity ? '' : String(time)),
      element('td', {}, `${reachedOf(cell, view.target)}/${cell.reached.length}`));
  row.dataset.s = cell.s;
  return row;
}

// Value and origin of its rate on this very problem, where a table chose it.
function originOf(cell) {
  return cell.origin === undefined ? [] : [element('small', {}, ` (${cell.origin})`)];
}

function headRow() {
  const heads = ['optimizer', DATA.by === 'time' ? 'time' : DATA.by, 'ms', 'runs'].map((text) => element('th', {scope: 'col'}, text));
  return element('thead', {}, element('tr', {}, ...heads));
}

function drawReached(place, problem, isWhole) {
  const ranked = rankingOf(problem, view.target);
  const works = ranked.map((cell) => workOf(cell, view.target)).filter((work) => work < Infinity);
  const shown = isWhole ? ranked : ranked.slice(0, MOST_ROWS);
  const body = element('tbody', {}, ...shown.map((cell) => reachedRow(cell, works[0], works[works.length - 1])));
  const caption = element('caption', {}, `Median ${DATA.counted}, time and runs to τ = ${tauName(view.target)}: ${works.length} of ${ranked.length} get there`);
  place.replaceChildren(element('table', {}, caption, headRow(), body));
  if (ranked.length <= MOST_ROWS) return;
  const more = pressable(isWhole ? `first ${MOST_ROWS}` : `all ${ranked.length}`, undefined, () => {
    drawReached(place, problem, !isWhole);
    place.querySelector('button').focus();
  });
  place.append(more);
}

// The sentence under the title, for what is shown.
function curveReading(problem) {
  const ranked = rankingOf(problem, view.target), tau = tauName(view.target);
  const works = ranked.map((cell) => workOf(cell, view.target));
  const solved = works.filter((work) => work < Infinity).length;
  if (ranked.length === 0) return 'No optimizer shown has run on this problem.';
  if (solved === 0) return `None of the ${ranked.length} shown reaches ${tau}.`;
  const isTied = solved > 1 && works[1] === works[0];
  const next = isTied ? `, tied with ${DATA.optimizers[ranked[1].s]}` : solved > 1 ? `; next ${DATA.optimizers[ranked[1].s]}, ${multiple(ratioOf(works[1], works[0]))} as much` : '';
  return `Least median ${DATA.counted} to ${tau} among the shown: ${DATA.optimizers[ranked[0].s]}, ${amount(works[0])} ${DATA.unit}${next}. ` +
      (solved === ranked.length ? `All ${solved} get there.` : `${ranked.length - solved} of ${ranked.length} do not get there.`);
}
