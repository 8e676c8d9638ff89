// Charts of paths over contours, and of performance profiles.
'use strict';

function pairs(flat) {
  const points = [];
  for (let i = 0; i + 1 < flat.length; i += 2)
    points.push(flat[i] === null || flat[i + 1] === null ? {x: NaN, y: NaN} : {x: flat[i], y: flat[i + 1]});
  return points;
}

function contourDatasets(contours) {
  return contours.map((contour, i) => ({
    data: contour.lines.flatMap((line) => [...pairs(line), {x: NaN, y: NaN}]),
    borderColor: cssColour('--soft') + (i % 4 === 3 ? '90' : '50'), borderWidth: 1, pointRadius: 0,
    pointHoverRadius: 0, pointHitRadius: 0, showLine: true, order: 3,
  }));
}

function markerDataset(point, style, label) {
  return {
    data: [point], label, pointStyle: style, pointRadius: style === 'star' ? 9 : 6, borderWidth: 2,
    borderColor: cssColour('--ink'), backgroundColor: cssColour('--paper'), order: 0,
  };
}

// A short run is drawn with a marker a step, as the published figures have it; a long one as a line.
const isShort = (path) => path.points.length <= 2 * 16;

function pathDataset(path) {
  const style = lineStyle(path.s);
  if (!isShort(path)) return {...style, borderDash: dashOf(path.s), borderWidth: 2.2, pointHitRadius: 2};
  const isCross = STYLES[path.s].marker === 'crossRot';
  return {
    ...style, borderDash: [3, 3], borderWidth: 1.2, pointRadius: isCross ? 5 : 4.2, pointStyle: STYLES[path.s].marker,
    pointBorderWidth: 1.6, backgroundColor: cssColour('--paper'),
  };
}

function drawPlane(place, state, space) {
  const plane = state.problem[space];
  const shown = plane.paths.filter((path) => state.visible.has(path.s) && isShown('s', path.s));
  const datasets = contourDatasets(plane.contours);
  for (const path of shown)
    datasets.push({label: DATA.optimizers[path.s], data: pairs(path.points), ...pathDataset(path), order: 1});
  if (plane.paths.length > 0) datasets.push(markerDataset(pairs(plane.paths[0].points)[0], 'circle', 'start'));
  if (plane.goal.length === 2) datasets.push(markerDataset(pairs(plane.goal)[0], 'star', space === 'x' ? 'solution' : 'target'));
  const [left, right, bottom, top] = plane.window;
  const plain = {ticks: {autoSkip: true, includeBounds: false}, grid: {display: false, borderColor: cssColour('--line')}};
  const scales = {
    x: axis(`${space}₁`, {min: left, max: right, ...plain}), y: axis(`${space}₂`, {min: bottom, max: top, ...plain}),
  };
  return newChart(place, `Paths in ${space} on ${state.problem.spec}`, datasets, scales,
      tooltipOf((point) => `(${short(point.x)}, ${short(point.y)})`));
}

// ρ(τ) as a staircase over log2 τ.
function staircase([problems, ...ratios], end) {
  const points = [{x: 0, y: 0}];
  ratios.forEach((ratio, i) => {
    const x = Math.log2(ratio);
    if (x > end) return;
    points.push({x, y: 100 * i / problems}, {x, y: 100 * (i + 1) / problems});
  });
  points.push({x: end, y: points[points.length - 1].y});
  return points;
}

// `profile` holds what is shown; `visible` is chosen in the legend.
function drawProfile(place, profile, visible, reading) {
  const chosen = [...visible].filter((s) => profile.has(s));
  const ratios = chosen.flatMap((s) => profile.get(s).slice(1));
  const end = Math.min(Math.ceil(Math.max(2, ...ratios.map(Math.log2)) + 0.5), 10);
  const datasets = chosen.map((s) => ({
    label: DATA.optimizers[s], problems: profile.get(s)[0], data: staircase(profile.get(s), end), ...lineStyle(s),
  }));
  const scales = {
    x: axis('work, as a multiple of the least on the same problem', {min: 0, max: end, ticks: {stepSize: 1, callback: (x) => `${2 ** x}×`}}),
    y: axis('problems solved', {min: 0, max: 100, ticks: {callback: (y) => `${y} %`}}),
  };
  const tooltip = tooltipOf((point) => `${point.y.toFixed(0)} % within ${short(2 ** point.x)}×`);
  tooltip.callbacks.afterLabel = (item) => `of ${item.dataset.problems} problems`;
  return newChart(place, `Performance profile. ${reading}`, datasets, scales, tooltip, true);
}
