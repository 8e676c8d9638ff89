// Standings and profiles of what is shown, computed from the medians to each of 51 targets: best
// means best among the shown, exactly as the tables of the report are made.
'use strict';

const PROFILE_END = 64;  // the factor up to which a profile's area ranks

// Rows of the data by name; an empty one is none.
const present = (list) => (list === undefined || list.length === 0 ? undefined : list);
for (const problem of DATA.problems) {
  problem.cells = problem.cells.map(([s, reached = [], work = '', time = '', failed = 0, missing = 0]) =>
    ({s, reached, work, time, failed, missing, origin: problem.origins?.[s]}));
  problem.curves = problem.curves.map(([s, iterations, work, seconds, gap, low, high, error, least, greatest]) => ({
    s, iterations, work, seconds, gap, gap_low: present(low), gap_high: present(high),
    x_error: present(error), x_error_low: present(least), x_error_high: present(greatest),
  }));
}

// "5,,6" is 5, 5, 6: nothing stands for the same as before.
function listOf(text, decoded) {
  const list = [];
  if (text !== '') text.split(',').forEach((one, i) => list.push(one === '' ? list[i - 1] : decoded(one)));
  return list;
}

const halved = (code) => parseInt(code, 36) / 2;
// Digits, and a letter for the power of ten: J is 0.
const power = (code) => Number(`${parseInt(code.slice(0, -1), 36)}e${code.charCodeAt(code.length - 1) - 74}`);

const isMeasured = (cell) => cell.reached.length > 0;
// What the report counts: work unless asked otherwise, in its unit. Of counts the medians are whole
// or halves; costs and times come as printed.
const isCount = DATA.by === 'work' || DATA.by === 'iterations';
function workOf(cell, target) {
  cell.works ??= listOf(cell.work, isCount ? halved : power);
  return cell.works[target] ?? Infinity;
}
function timeOf(cell, target) {  // ms
  cell.times ??= listOf(cell.time, power);
  return cell.times[target] ?? Infinity;
}
const reachedOf = (cell, target) => cell.reached.filter((count) => count > target).length;

const shownCells = (problem) => problem.cells.filter((cell) => isShown('s', cell.s));
const leastWork = (cells, target) => cells.reduce((low, cell) => Math.min(low, workOf(cell, target)), Infinity);

// As the report writes figures: whole numbers in full, others to four digits.
function figure(value) {
  if (value === Infinity) return '✗';
  if (Math.abs(value) < 1e7 && Number.isInteger(value)) return String(value);
  const power = Math.floor(Math.log10(Math.abs(value)));
  if (power >= -3 && power < 4) return String(Number(value.toPrecision(4)));
  return value.toExponential(3).replace(/\.?0*e\+?/, 'e');
}

// ≈ marks times of which some were taken while other runs shared the machine.
const amount = (value) => (value === Infinity ? figure(value) : figure(value) + DATA.mark);

// Work over the least of the same problem; below one forward solve, or a microsecond, counts as one.
const LEAST_UNIT = DATA.by === 'time' ? 1e-3 : 1;
const ratioOf = (work, low) => (work === Infinity ? Infinity : Math.max(work, LEAST_UNIT) / Math.max(low, LEAST_UNIT));
const scoreOf = (ratio) => Math.max(0, Math.log2(PROFILE_END) - Math.log2(ratio)) / Math.log2(PROFILE_END);

const order = (a, b) => (a < b ? -1 : a > b ? 1 : 0);  // also of two infinities

function median(values) {
  const sorted = [...values].sort(order), half = Math.floor(sorted.length / 2);
  if (sorted.length === 0) return Infinity;
  return sorted.length % 2 === 1 ? sorted[half] : sorted[half - 1] / 2 + sorted[half] / 2;
}

function emptyStanding(s) {
  return {s, problems: 0, solved: 0, wins: 0, runs: 0, reached: 0, failed: 0, ratios: [], score: 0};
}

function addCell(standing, cell, low, target) {
  const work = workOf(cell, target);
  ++standing.problems;
  standing.solved += work < Infinity;
  standing.wins += work < Infinity && work === low;
  standing.ratios.push(ratioOf(work, low));
  standing.score += scoreOf(standing.ratios[standing.ratios.length - 1]);
  if (!isMeasured(cell)) return;
  standing.runs += cell.reached.length;
  standing.reached += reachedOf(cell, target);
  standing.failed += cell.failed;
}

// Best first, on settings that all of these optimizers were given.
function standingsAmong({settings, methods}, target, isAsked) {
  const all = new Map(methods.filter(isAsked).map((s) => [s, emptyStanding(s)]));
  for (const p of settings.filter((index) => isShown('p', index))) {
    const cells = DATA.problems[p].cells.filter((cell) => all.has(cell.s)), low = leastWork(cells, target);
    for (const cell of cells) addCell(all.get(cell.s), cell, low, target);
  }
  const asked = [...all.values()].filter((standing) => standing.problems > 0);
  for (const standing of asked) standing.score /= standing.problems;
  return asked.sort((a, b) => b.score - a.score || b.reached - a.reached || a.s - b.s);
}

// Those of the common order, best first; then those apart, each as it is compared with them.
const rankedOf = (target, isAsked = (s) => isShown('s', s)) => standingsAmong(DATA.order, target, isAsked);
function standingsOf(target, isAsked = (s) => isShown('s', s)) {
  const apart = DATA.order.apart.filter(({s}) => isAsked(s)).flatMap((placed) =>
      standingsAmong(placed, target, isAsked).filter(({s}) => s === placed.s).map((standing) => ({...standing, isApart: true})));
  return [...rankedOf(target, isAsked), ...apart];
}

// [problems, ratio, …] an optimizer, ascending: those solved.
function profileOf(target) {
  const profile = new Map();
  for (const standing of rankedOf(target))
    profile.set(standing.s, [standing.problems, ...standing.ratios.filter((ratio) => ratio < Infinity).sort((a, b) => a - b)]);
  return profile;
}

// The optimizers of a problem, best first.
function rankingOf(problem, target) {
  const place = new Map(problem.curves.map((curve, i) => [curve.s, i]));
  return shownCells(problem).filter(isMeasured)
      .sort((a, b) => order(workOf(a, target), workOf(b, target)) || place.get(a.s) - place.get(b.s));
}
