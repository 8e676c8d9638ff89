// The figures of the page: medians to each of 51 targets by each measure, and who stands where at
// each, all computed by the report. Here they are only read.
'use strict';

// Rows of the data by name; an empty one is none.
const present = (list) => (list === undefined || list.length === 0 ? undefined : list);
for (const problem of DATA.problems) {
  problem.cells = problem.cells.map(([s, reached = [], medians = [], failed = 0, missing = 0]) =>
    ({s, reached, medians, failed, missing, origin: problem.origins?.[s]}));
  problem.curves = problem.curves.map(([s, iterations, work, cost, time, gap, low, high, error, least, greatest]) => ({
    s, iterations, work, cost: present(cost) ?? work, time, gap, gap_low: present(low), gap_high: present(high),
    x_error: present(error), x_error_low: present(least), x_error_high: present(greatest),
  }));
  if (problem.learned !== undefined)
    problem.learned.rows = problem.learned.rows.map(([s, error, low, high, loss, runs]) => ({s, error, low, high, loss, runs}));
}

// "5*2,6" is 5, 5, 6.
function listOf(text, decoded) {
  const list = [];
  for (const one of text === '' ? [] : text.split(',')) {
    const [code, count = 1] = one.split('*'), value = decoded(code);
    for (let i = 0; i < Number(count); ++i) list.push(value);
  }
  return list;
}

const halved = (code) => parseInt(code, 36) / 2;
// Digits, and a letter for the power of ten: J is 0.
const power = (code) => Number(`${parseInt(code.slice(0, -1), 36)}e${code.charCodeAt(code.length - 1) - 74}`);

const isMeasured = (cell) => cell.reached.length > 0;
// Medians of counts are whole or halves; costs and times come as printed, times in ms.
function mediansOf(cell, measure) {
  const text = cell.medians[measure];
  if (text === 0) return mediansOf(cell, 0);  // the same
  if (typeof text === 'string') cell.medians[measure] = listOf(text, DATA.measures[measure].isCount ? halved : power);
  return cell.medians[measure] ?? [];
}
const takenBy = (cell, target = view.target, measure = view.measure) => mediansOf(cell, measure)[TARGETS.indexOf(target)] ?? Infinity;
const reachedOf = (cell, target = view.target) => cell.reached.filter((count) => count > target).length;
const cellOf = (problem, s) => problem.cells.find((cell) => cell.s === s);
// Below one forward solve, or a microsecond, counts as one.
const atLeast = (value) => Math.max(value, measureNow().least);

// As the report writes figures: whole numbers in full, others to four digits.
function figure(value) {
  if (value === Infinity) return '✗';
  if (Math.abs(value) < 1e7 && Number.isInteger(value)) return String(value);
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent >= -3 && exponent < 4) return String(Number(value.toPrecision(4)));
  return value.toExponential(3).replace(/\.?0*e\+?/, 'e');
}

// ≈ marks times of which some were taken while other runs shared the machine.
function amount(value) {
  const isDoubtful = measureNow().name === 'time' && DATA.isTimedTogether && value < Infinity;
  return figure(value) + (isDoubtful ? '≈' : '');
}
const multiple = (ratio) => (ratio === Infinity || ratio === null ? '✗' : `${Number(ratio.toPrecision(3))}×`);

// Who stands where to a target by a measure, best first; then those apart.
function standingsAt(measure, target) {
  let same = TARGETS.indexOf(target);
  while (DATA.standings[measure][same] === 0) --same;  // as at the target before
  const flat = DATA.standings[measure][same], all = [];
  for (let i = 0; i < flat.length; i += 6) {
    const [s, score, solved, wins, typical, reached] = flat.slice(i, i + 6), [settings, runs, failed] = DATA.given[s];
    all.push({s, score, solved, wins, typical: typical ?? Infinity, reached, settings, runs, failed, isApart: !DATA.ranked.includes(s)});
  }
  return all;
}
const standingsNow = () => standingsAt(view.measure, view.target);

// The first of each kind in a list that stands best first.
function firstOfEachKind(ranking) {
  const kinds = new Set();
  return ranking.filter((s) => !kinds.has(DATA.kinds[s]) && kinds.add(DATA.kinds[s]));
}
// At the report's own tolerance, of all.
const LEADERS = firstOfEachKind([...DATA.kinds.keys()]);

// The optimizers of a problem, best first: of a learned one by its error in x at equal work.
function rankingOf(problem) {
  if (problem.learned !== undefined) return problem.learned.rows.map((row) => row.s);
  const place = new Map(problem.curves.map((curve, i) => [curve.s, i])), order = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
  return problem.cells.filter(isMeasured)
      .sort((a, b) => order(takenBy(a), takenBy(b)) || place.get(a.s) - place.get(b.s)).map((cell) => cell.s);
}
