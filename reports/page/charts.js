// Charts over the page's data: learning curves, paths over contours, performance profiles.
'use strict';

function axis(title, rest = {}) {
  const soft = cssColour('--soft'), line = cssColour('--line');
  return {
    title: {display: true, text: title, color: soft},
    grid: {color: line, borderColor: line, drawTicks: false},
    ...rest,
    ticks: {color: soft, padding: 6, maxRotation: 0, ...rest.ticks},
  };
}

// Powers of ten are labelled, not more of them than fit; within two decades also 2 and 5 times these.
function logAxis(title, low, high) {
  const decades = Math.ceil(Math.log10(high / low));
  const every = Math.max(1, Math.ceil(decades / 8));
  return axis(title, {
    type: 'logarithmic', min: low, max: high,
    ticks: {
      autoSkip: false,
      callback: (value) => {
        const power = Math.log10(value), whole = Math.round(power);
        const leading = value / 10 ** Math.floor(power + 1e-9);
        if (decades <= 2 && [2, 5].some((digit) => Math.abs(leading - digit) < 1e-6)) return String(Number(value.toPrecision(1)));
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

function newChart(place, label, datasets, scales, tooltip, hasEndLabels = false) {
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
    plugins: [END_LABELS],
    options: {
      hasEndLabels,
      layout: {padding: {right: hasEndLabels && place.clientWidth >= NARROW ? 130 : 8, top: 4}},
      onHover: (_, items, chart) => highlight(chart, chart.data.datasets[items[0]?.datasetIndex]?.optimizer),
      animation: false, parsing: false, normalized: true, responsive: true, maintainAspectRatio: false,
      interaction: {mode: 'nearest', intersect: true},
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

// Zero has no logarithm: it is drawn below all others, and what is below the floor on the floor.
function curveDatasets(state) {
  const curves = state.problem.curves;
  const zeroX = least(curves.flatMap((curve) => curve[state.horizontal])) / 2;
  const zeroY = Math.max(LOWEST, least(curves.flatMap((curve) => curve[state.vertical])) / 10);
  return curves.filter((curve) => state.visible.has(curve.s)).map((curve) => {
    const data = [];
    curve[state.horizontal].forEach((x, i) => {
      const y = curve[state.vertical][i];
      if (x !== null && y !== null) data.push({x: x > 0 ? x : zeroX, y: Math.max(y, zeroY)});
    });
    return {label: DATA.optimizers[curve.s], data, ...lineStyle(curve.s)};
  });
}

const LOWEST = 1e-12;  // of a loss gap or error: below lies rounding
const AXES = {
  iterations: 'iterations', work: 'work, forward solves', seconds: 'time, s',
  gap: 'what is left of the loss', x_error: 'error in x',
};

// The tolerance of the tables, as a line to cross.
function toleranceLine(from, to) {
  const tau = Number(TOLERANCES[tolerance]);
  return {
    label: `τ = ${TOLERANCES[tolerance]}`, data: [{x: from, y: tau}, {x: to, y: tau}], showLine: true, pointRadius: 0,
    pointHitRadius: 0, borderColor: cssColour('--soft'), borderDash: [3, 4], borderWidth: 1.2, order: 5,
  };
}

function drawCurves(place, state) {
  const datasets = curveDatasets(state);
  const points = datasets.flatMap((set) => set.data);
  const ends = (key) => {
    const values = points.map((point) => point[key]);
    if (values.length === 0) return [1, 10];
    const low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
    return [low, high > low ? high : low * 10];
  };
  const across = ends('x'), up = ends('y');
  if (state.vertical === 'gap') {
    up[1] = Math.min(up[1] * 1.5, 1e3);  // a run that diverges would flatten all others
    datasets.push(toleranceLine(...across));
  }
  const scales = {x: logAxis(AXES[state.horizontal], ...across), y: logAxis(AXES[state.vertical], ...up)};
  const label = `${AXES[state.vertical]} against ${AXES[state.horizontal]} on ${state.problem.spec}`;
  return newChart(place, label, datasets, scales,
      tooltipOf((point) => `${short(point.y)} at ${short(point.x)}`), true);
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
  const shown = plane.paths.filter((path) => state.visible.has(path.s));
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

function drawProfile(place, profile, visible) {
  const ratios = [...visible].flatMap((s) => profile[s].slice(1));
  const end = Math.min(Math.ceil(Math.max(2, ...ratios.map(Math.log2)) + 0.5), 10);
  const datasets = [...visible].map((s) => ({
    label: DATA.optimizers[s], problems: profile[s][0], data: staircase(profile[s], end), ...lineStyle(s),
  }));
  const scales = {
    x: axis('work, as a multiple of the least on the same problem', {min: 0, max: end, ticks: {stepSize: 1, callback: (x) => `${2 ** x}×`}}),
    y: axis('problems solved', {min: 0, max: 100, ticks: {callback: (y) => `${y} %`}}),
  };
  const tooltip = tooltipOf((point) => `${point.y.toFixed(0)} % within ${short(2 ** point.x)}×`);
  tooltip.callbacks.afterLabel = (item) => `of ${item.dataset.problems} problems`;
  return newChart(place, 'Performance profile', datasets, scales, tooltip, true);
}
