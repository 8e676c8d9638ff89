// The values of the page: medians to each of 51 targets by each measure, and the ranking at each, all
// computed by the report. This script only reads them.
'use strict';

const DATA = JSON.parse(document.getElementById('data').textContent);

// The sentence of a key, its names filled by values.
const worded = (key, values = {}) => DATA.words[key].replace(/\{(\w+)(?:\|([^|}]*)\|([^}]*))?\}/g,
    (_, name, one, many) => (one === undefined ? values[name] : Number(values[name]) === 1 ? one : many));

// −k in a list of the report stands for k more of the number before it.
function inFull(list) {
  const all = [];
  for (const value of list)
    for (let k = Math.max(1, -value); k > 0; --k) all.push(value < 0 ? all[all.length - 1] : value);
  return all;
}

// Rows of the data by name.
for (const problem of DATA.problems) {
  problem.cells = problem.cells.map(([s, reached = [], medians = [], failed = 0, missing = 0, records = [], answer = null, command]) =>
    ({s, reached: inFull(reached), medians, failed, missing, records: records.map((name) => (name.includes('-') ? name : name + records[0].slice(records[0].indexOf('-')))), answer, command, origin: problem.origins?.[s]}));
  if (problem.learned !== undefined)
    problem.learned.rows = problem.learned.rows.map(([s, error, low, high, loss, runs, diverged, solves, ms]) => ({s, error, low, high, loss, runs, diverged, solves, ms}));
}

const isMeasured = (cell) => cell.reached.length > 0;
// As printed, times in ms; 0 stands for those of the first measure.
function mediansOf(cell, measure) {
  const medians = cell.medians[measure] ?? [];
  if (medians === 0) return mediansOf(cell, 0);
  return cell.medians[measure] = inFull(medians);
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

// Times of which some were taken while others ran rank no method.
const isDoubtful = () => measureNow().name === 'time' && DATA.isTimedTogether;
// ≈ marks times of which some were taken while other runs shared the machine.
function amount(value) {
  return figure(value) + (isDoubtful() && value < Infinity ? '≈' : '');
}
const multiple = (ratio) => (ratio === Infinity || ratio === null ? '✗' : `${Number(ratio.toPrecision(3))}×`);

// The ranking to a target by a measure, best first; then methods that are not ranked.
function standingsAt(measure, target) {
  let same = TARGETS.indexOf(target);
  while (DATA.standings[measure][same] === 0) --same;  // as at the target before
  const flat = DATA.standings[measure][same], all = [];
  for (let i = 0; i < flat.length; i += 6) {
    const [s, score, solved, wins, typical, reached] = flat.slice(i, i + 6), [settings, runs, failed] = DATA.given[s];
    all.push({s, score, solved, wins, typical: typical ?? Infinity, reached, settings, runs, failed});
  }
  return all;
}
const standingsNow = () => standingsAt(view.measure, view.target);

// The optimizers of a problem, best first: of a learned one by its error in x at equal work.
function rankingOf(problem) {
  if (problem.learned !== undefined) return problem.learned.rows.map((row) => row.s);
  const place = new Map(problem.order.map((s, i) => [s, i])), order = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
  return problem.cells.filter(isMeasured)
      .sort((a, b) => order(takenBy(a), takenBy(b)) || place.get(a.s) - place.get(b.s)).map((cell) => cell.s);
}
