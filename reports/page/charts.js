// Charts over the page's data: learning curves, paths over contours, performance profiles.
'use strict';

const SHOWN_AT_FIRST = 8;
const COLOURS = {  // Okabe and Ito (2008), told apart by colour-blind readers too
  light: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#5b4bb5', '#555555'],
  dark: ['#4aa8e8', '#f0803c', '#2cc295', '#e09cc2', '#f2b632', '#8fd0f7', '#a394f0', '#b8b8b8'],
};
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3], [14, 4]];

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

const colourOf = (index) => COLOURS[isDark() ? 'dark' : 'light'][index % 8];
const dashOf = (index) => DASHES[Math.floor(index / 8) % DASHES.length];
const cssColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function lineStyle(index) {
  return {
    borderColor: colourOf(index), backgroundColor: colourOf(index), borderDash: dashOf(index),
    borderWidth: 1.8, pointRadius: 0, pointHoverRadius: 4, pointHitRadius: 6, tension: 0, showLine: true,
  };
}

function axis(title, rest = {}) {
  const soft = cssColour('--soft'), line = cssColour('--line');
  return {
    title: {display: true, text: title, color: soft},
    grid: {color: line, borderColor: line, drawTicks: false},
    ...rest,
    ticks: {color: soft, padding: 6, maxRotation: 0, ...rest.ticks},
  };
}

// Only powers of ten are labelled, and not more of them than fit.
function logAxis(title, low, high) {
  const decades = Math.ceil(Math.log10(high / low));
  const every = Math.max(1, Math.ceil(decades / 8));
  return axis(title, {
    type: 'logarithmic', min: low, max: high,
    ticks: {
      autoSkip: false,
      callback: (value) => {
        const power = Math.log10(value), whole = Math.round(power);
        if (Math.abs(power - whole) > 1e-9 || whole % every !== 0) return null;
        return whole >= 0 && whole < 4 ? String(10 ** whole) : `1e${whole}`;
      },
    },
    grid: {
      drawTicks: false, borderColor: cssColour('--line'),
      color: (context) => {
        const power = Math.log10(context.tick?.value ?? 1);
        return Math.abs(power - Math.round(power)) < 1e-9 ? cssColour('--line') : 'transparent';
      },
    },
  });
}

function newChart(place, label, datasets, scales, tooltip) {
  const holder = document.createElement('div');
  holder.className = 'canvas';
  const canvas = document.createElement('canvas');
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', label);
  holder.append(canvas);
  place.append(holder);
  return new Chart(canvas, {
    type: 'scatter',
    data: {datasets},
    options: {
      animation: false, parsing: false, normalized: true, responsive: true, maintainAspectRatio: false,
      interaction: {mode: 'nearest', intersect: false},
      scales,
      plugins: {legend: {display: false}, tooltip},
    },
  });
}

const short = (value) => String(Number(value.toPrecision(3)));
const tooltipOf = (unit) => ({
  displayColors: false,
  filter: (item) => item.dataset.label !== undefined,
  callbacks: {label: (item) => `${item.dataset.label}: ${unit(item.raw)}`},
});

function least(values) {
  return values.reduce((low, value) => (value > 0 && value < low ? value : low), Infinity);
}

// Zero has no logarithm: it is drawn below all others, at half or a tenth of the least.
function curveDatasets(state) {
  const curves = state.problem.curves;
  const zeroX = least(curves.flatMap((curve) => curve[state.horizontal])) / 2;
  const zeroY = least(curves.flatMap((curve) => curve[state.vertical])) / 10;
  return curves.filter((curve) => state.visible.has(curve.s)).map((curve) => {
    const data = [];
    curve[state.horizontal].forEach((x, i) => {
      const y = curve[state.vertical][i];
      if (x !== null && y !== null) data.push({x: x > 0 ? x : zeroX, y: y > 0 ? y : zeroY});
    });
    return {label: DATA.optimizers[curve.s], data, ...lineStyle(curve.s)};
  });
}

const AXES = {
  iterations: 'iterations', work: 'work, forward solves', seconds: 'time, s',
  loss: 'loss', x_error: 'error in x',
};

function drawCurves(place, state) {
  const datasets = curveDatasets(state);
  const points = datasets.flatMap((set) => set.data);
  const ends = (key) => {
    const values = points.map((point) => point[key]);
    if (values.length === 0) return [1, 10];
    const low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
    return [low, high > low ? high : low * 10];
  };
  const scales = {x: logAxis(AXES[state.horizontal], ...ends('x')), y: logAxis(AXES[state.vertical], ...ends('y'))};
  const label = `${AXES[state.vertical]} against ${AXES[state.horizontal]} on ${state.problem.spec}`;
  return newChart(place, label, datasets, scales,
      tooltipOf((point) => `${short(point.y)} at ${short(point.x)}`));
}

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

function drawPlane(place, state, space) {
  const plane = state.problem[space];
  const shown = plane.paths.filter((path) => state.visible.has(path.s));
  const datasets = contourDatasets(plane.contours);
  for (const path of shown)
    datasets.push({
      label: DATA.optimizers[path.s], data: pairs(path.points), ...lineStyle(path.s), pointRadius: 1.6, order: 1,
    });
  if (plane.paths.length > 0) datasets.push(markerDataset(pairs(plane.paths[0].points)[0], 'circle', 'start'));
  if (plane.goal.length === 2) datasets.push(markerDataset(pairs(plane.goal)[0], 'star', space === 'x' ? 'solution' : 'target'));
  const [left, right, bottom, top] = plane.window;
  const scales = {x: axis(`${space}₁`, {min: left, max: right}), y: axis(`${space}₂`, {min: bottom, max: top})};
  return newChart(place, `Paths in ${space} on ${state.problem.spec}`, datasets, scales,
      tooltipOf((point) => `(${short(point.x)}, ${short(point.y)})`));
}

// ρ(τ) as a staircase over log2 τ.
function staircase(ratios, problems, end) {
  const points = [{x: 0, y: 0}];
  ratios.forEach((ratio, i) => {
    const x = Math.log2(ratio);
    if (x > end) return;
    points.push({x, y: 100 * i / problems}, {x, y: 100 * (i + 1) / problems});
  });
  points.push({x: end, y: points[points.length - 1].y});
  return points;
}

function drawProfile(place, profile, visible) {
  const farthest = Math.max(2, ...[...visible].flatMap((s) => profile.ratios[s] ?? []).map(Math.log2));
  const end = Math.min(Math.ceil(farthest + 0.5), 14);
  const datasets = [...visible].map((s) => ({
    label: DATA.optimizers[s], data: staircase(profile.ratios[s] ?? [], profile.problems, end), ...lineStyle(s),
  }));
  const scales = {
    x: axis('work, as a multiple of the least', {min: 0, max: end, ticks: {stepSize: 1, callback: (x) => `${2 ** x}×`}}),
    y: axis('problems solved', {min: 0, max: 100, ticks: {callback: (y) => `${y} %`}}),
  };
  return newChart(place, 'Performance profile', datasets, scales,
      tooltipOf((point) => `${point.y.toFixed(0)} % within ${short(2 ** point.x)}×`));
}
