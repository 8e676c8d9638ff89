// One problem: its curves, and beside them a table whose rows are the legend.
const CHOSEN = new Map();  // the lines that a reader chose, by problem

// The best others stand in where a filter hides all of them.
function linesShown(p) {
  const own = CHOSEN.get(p) ?? new Set(DATA.problems[p].lines);
  return CHOSEN.has(p) || [...own].some((s) => isShown('s', s)) ? own : new Set(rankingOf(DATA.problems[p]).filter((s) => isShown('s', s)).slice(0, MOST_LENT));
}

function showLines(p, lines) {
  CHOSEN.set(p, new Set(lines));
  refreshAll();
}

// The line of the curves, in the colour and dash of what it stands in.
const swatch = (index) => {
  const line = document.createRange().createContextualFragment(`<svg class="swatch"><path d="M0 4h24"/><path class="mark" d="M12 4${DATA.shapes[index]}"/></svg>`).firstChild;
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

function legendRow(problem, s, ends, isDrawn) {
  const button = pressable(DATA.optimizers[s], isDrawn, () => {});
  button.className = 'name';
  button.dataset.s = s;
  button.prepend(swatch(s));
  button.append(DATA.marks[s]);
  const row = element('tr', {}, element('th', {scope: 'row'}, button, ...originOf(cellOf(problem, s))), ...figuresOf(problem, s, ends));
  row.dataset.s = s;
  return row;
}

const MOST_ROWS = 14;  // more on demand

function captionOf(problem, count, all) {
  if (problem.learned !== undefined) return `At equal work, ${figure(problem.learned.work)} forward solves: error in x, loss in y. Select a name to show or hide its line.`;
  const isWorse = document.querySelector(`#problem-${DATA.problems.indexOf(problem)} [data-worse]`) !== null;
  return `Median ${measureNow().counted} needed to reach ${goalOf(problem)}: ${count} of ${all} methods reach this. Select a name to show or hide its line.${isWorse ? ` ${worded('worse')}` : ''}`;
}

function drawLegend(place, problem, lines) {
  const ranking = rankingOf(problem), works = ranking.map((s) => takenBy(cellOf(problem, s))).filter((work) => work < Infinity);
  const ends = {low: works[0], most: works[works.length - 1]};
  const rows = ranking.map((s, i) => {
    const row = legendRow(problem, s, ends, lines.has(s));
    row.classList.toggle('rest', i >= MOST_ROWS && !lines.has(s));
    return row;
  });
  const heads = problem.learned === undefined ? ['method', measureNow().name, 'ms', 'runs'] : ['method', 'error in x at equal work', 'loss at equal work', 'runs'];
  const table = element('table', {className: 'folded'}, element('caption', {}, captionOf(problem, works.length, ranking.length)),
      element('thead', {}, element('tr', {}, ...heads.map((text) => element('th', {scope: 'col'}, text)))), element('tbody', {}, ...rows));
  const choose = (lines) => () => showLines(DATA.problems.indexOf(problem), lines);
  const presets = [pressable('one of each kind', undefined, choose(problem.lines)), pressable('all lines', undefined, choose(ranking)),
    pressable('none', undefined, choose([]))];
  const rest = rows.filter((row) => row.classList.contains('rest')).length;
  if (rest > 0)
    presets.push(pressable(`all ${ranking.length} rows`, undefined, (event) => {
      table.classList.remove('folded');
      event.currentTarget.remove();
    }));
  place.replaceChildren(element('div', {className: 'presets'}, ...presets), table);
}

// The chart of the measure and the quantity chosen, with the lines chosen; the others wait hidden. One
// where two measures are the same numbers has the name of the measure chosen.
function drawProblem(article) {
  const p = Number(article.dataset.p), problem = DATA.problems[p], lines = linesShown(p), {vertical} = article.dataset, {name, counted, unit} = measureNow();
  const charts = [...article.querySelectorAll('.curves > .chart')], isOf = (measure) => ({dataset}) => dataset.vertical === vertical && [dataset.by, dataset.also].includes(measure);
  const shown = charts.find(isOf(name)) ?? charts.find(isOf(DATA.by));
  for (const chart of charts) {
    chart.toggleAttribute('hidden', chart !== shown);
    moveTolerance(chart);
  }
  if (shown?.dataset.also !== undefined) shown.querySelector('.axes > [dy="2.5em"]').textContent = counted === unit ? counted : `${counted}, ${unit}`;
  drawLegend(article.querySelector('.reached'), problem, lines);
  showLinesIn(article, lines);
}

function liveProblem(article) {
  live(article, () => {
    const curves = article.querySelector('.curves');
    if (curves?.firstElementChild) drawProblem(article);  // else it was not opened yet, or nothing ran
  });
}

ON_UNPACK.push((article) => {
  const own = article.querySelector('.curves > .chart:not([hidden])');
  if (own === null) return;
  article.dataset.vertical = own.dataset.vertical;
  if (article.querySelector('.chart[data-vertical=x_error]') !== null)
    own.parentElement.prepend(newSwitch('show', {gap: 'loss', x_error: 'error in x'}, own.dataset.vertical, (value) => {
      article.dataset.vertical = value;
      drawProblem(article);
    }));
});
