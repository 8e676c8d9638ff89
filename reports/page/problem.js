// One problem: its curves, and beside them a table whose rows are the legend.
'use strict';

const CHOSEN = new Map();  // the lines that a reader chose, by problem

// The best two of this problem, and the best of each kind, unless chosen otherwise.
function linesAtFirst(problem) {
  const ranking = rankingOf(problem);
  return new Set([...ranking.slice(0, 2), ...firstOfEachKind(ranking)]);
}
const linesShown = (p) => CHOSEN.get(p) ?? linesAtFirst(DATA.problems[p]);

function showLines(p, lines) {
  CHOSEN.set(p, new Set(lines));
  refreshAll();
}

// The line of the curves, in the colour and dash of what it stands in.
const swatch = (index) => {
  const line = document.createRange().createContextualFragment('<svg class="swatch" viewBox="0 0 24 8" aria-hidden="true"><path d="M0 4h24"/></svg>').firstChild;
  line.dataset.s = index;
  return line;
};

// The bar is longer the more the work, by factors of two; the least has the shortest.
function workBar(work, low, most) {
  const bar = element('i'), span = Math.log2(Math.max(2, most / low));
  bar.style.setProperty('--w', 12 + 88 * Math.log2(work / low) / span);
  return bar;
}

// Value and origin of its rate on this very problem, where a table chose it.
const originOf = (cell) => (cell.origin === undefined ? [] : [element('small', {}, ` (${cell.origin})`)]);

// What a row tells: of a learned problem the error and the loss at equal work, else work and runs.
function figuresOf(problem, s, {low, most}) {
  const cell = cellOf(problem, s), row = problem.learned?.rows.find((one) => one.s === s);
  const td = (text) => element('td', {}, text);
  if (row !== undefined) return [td(figure(row.error ?? Infinity)), td(figure(row.loss ?? Infinity)), td(String(row.runs))];
  const work = takenBy(cell), time = takenBy(cell, view.target, MEASURES.indexOf('time')), taken = element('td', {className: 'taken'});
  if (work === Infinity) taken.append(element('span', {className: 'cross'}, '✗'));
  else taken.append(workBar(atLeast(work), atLeast(low), atLeast(most)), amount(work));
  return [taken, td(time === Infinity ? '' : String(time)), td(`${reachedOf(cell)}/${cell.reached.length}`)];
}

function legendRow(problem, s, ends, state, chart) {
  const button = pressable(DATA.optimizers[s], state.visible.has(s), () => {
    if (!state.visible.delete(s)) state.visible.add(s);
    CHOSEN.set(DATA.problems.indexOf(problem), new Set(state.visible));
    button.setAttribute('aria-pressed', state.visible.has(s));
    state.redraw();
  });
  button.className = 'name';
  button.prepend(swatch(s));
  button.append(DATA.marks[s]);
  for (const [event, lit] of [['pointerenter', s], ['pointerleave', undefined], ['focus', s], ['blur', undefined]])
    button.addEventListener(event, () => chart(lit));
  const row = element('tr', {}, element('th', {scope: 'row'}, button, ...originOf(cellOf(problem, s))), ...figuresOf(problem, s, ends));
  row.dataset.s = s;
  return row;
}

const MOST_ROWS = 14;  // more on demand

function captionOf(problem, count, all) {
  if (problem.learned !== undefined) return `At equal work, ${figure(problem.learned.work)} forward solves: error in x, loss in y. Press a name to draw or hide its line.`;
  return `Median ${measureNow().counted} to τ = ${tauName(view.target)}: ${count} of ${all} reach it. Press a name to draw or hide its line.`;
}

function drawLegend(place, problem, state, chart) {
  const ranking = rankingOf(problem), works = ranking.map((s) => takenBy(cellOf(problem, s))).filter((work) => work < Infinity);
  const ends = {low: works[0], most: works[works.length - 1]};
  const rows = ranking.map((s, i) => {
    const row = legendRow(problem, s, ends, state, chart);
    row.classList.toggle('rest', i >= MOST_ROWS && !state.visible.has(s));
    return row;
  });
  const heads = problem.learned === undefined ? ['method', measureNow().name, 'ms', 'runs'] : ['method', 'error in x', 'loss', 'runs'];
  const table = element('table', {className: 'folded'}, element('caption', {}, captionOf(problem, works.length, ranking.length)),
      element('thead', {}, element('tr', {}, ...heads.map((text) => element('th', {scope: 'col'}, text)))), element('tbody', {}, ...rows));
  const choose = (lines) => () => showLines(DATA.problems.indexOf(problem), lines);
  const presets = [pressable('one of each kind', undefined, choose(linesAtFirst(problem))), pressable('all lines', undefined, choose(ranking)),
    pressable('none', undefined, choose([]))];
  const rest = rows.filter((row) => row.classList.contains('rest')).length;
  if (rest > 0)
    presets.push(pressable(`all ${ranking.length} rows`, undefined, (event) => {
      table.classList.remove('folded');
      event.currentTarget.remove();
    }));
  place.replaceChildren(element('div', {className: 'presets'}, ...presets), table);
}

// Built at the first call, drawn anew at each.
function problemDrawer(article, problem) {
  const aimed = problem.learned !== undefined || problem.goal !== undefined ? 'x_error' : 'gap';  // what its user wants
  const hasError = problem.curves.some((curve) => curve.x_error !== undefined);
  const state = {problem, visible: new Set(), vertical: hasError ? aimed : 'gap'};
  const reading = article.querySelector('.reading'), curves = article.querySelector('.curves'), place = element('div');
  const draws = [redrawer(place, () => drawCurves(place, state, reading.textContent))];
  for (const plane of article.querySelectorAll('.plane'))
    draws.push(redrawer(plane, () => drawPlane(plane, state, plane.dataset.space)));
  const light = (index) => draws.forEach((draw) => highlight(draw.chart, index));
  // The curves at once, the planes in frames of their own; on paper there is none.
  const later = (draw) => (isPrinting ? draw() : soon(draw, draw));
  state.redraw = () => draws.forEach((draw, i) => (i === 0 ? draw() : later(draw)));
  if (hasError)
    curves.append(newSwitch('show', {gap: 'loss', x_error: 'error in x'}, state.vertical, (value) => { state.vertical = value; draws[0](); }));
  curves.append(place);
  return () => {
    state.visible = new Set(linesShown(DATA.problems.indexOf(problem)));
    drawLegend(article.querySelector('.reached'), problem, state, light);
    state.redraw();
  };
}

function liveProblem(article) {
  const problem = DATA.problems[Number(article.dataset.p)];
  if (problem.curves.length === 0) return;
  let draw;
  live(article, () => {
    if (article.querySelector('.curves') === null) return;  // it was not opened yet
    draw ??= problemDrawer(article, problem);
    draw();
  });
}
