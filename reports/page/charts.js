// Charts over the page's data: axes, and learning curves with their range over seeds.
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

// The range over seeds, where the curve has one: two unseen lines with what is between them filled.
function bandDatasets(curve, state, place) {
  const low = curve[`${state.vertical}_low`], high = curve[`${state.vertical}_high`];
  if (low === undefined || state.seeds !== 'band' || state.visible.size > FEW) return [];
  const band = {
    bandOf: curve.s, borderWidth: 0, pointRadius: 0, pointHitRadius: 0, pointHoverRadius: 0, showLine: true,
    backgroundColor: colourOf(curve.s) + BAND, order: 4,
  };
  const line = (values, never) => place((i) => (values[i] === null ? never : values[i]));
  return [{...band, data: line(low, null), fill: false}, {...band, data: line(high, HIGHEST), fill: '-1'}];
}

// Zero has no logarithm: it is drawn below all others, and what is below the floor on the floor.
function curveDatasets(state) {
  const curves = state.problem.curves.filter((curve) => curve[state.vertical] !== undefined);
  const zeroX = least(curves.flatMap((curve) => curve[state.horizontal])) / 2;
  const zeroY = Math.max(LOWEST, least(curves.flatMap((curve) => curve[state.vertical])) / 10);
  return curves.filter((curve) => state.visible.has(curve.s) && isShown('s', curve.s)).flatMap((curve) => {
    const place = (height) => curve[state.horizontal].flatMap((x, i) => {
      const y = curve[state.vertical][i] === null ? null : height(i);
      return x === null || y === null ? [] : [{x: x > 0 ? x : zeroX, y: Math.max(y, zeroY)}];
    });
    const data = place((i) => curve[state.vertical][i]);
    return [{label: DATA.optimizers[curve.s], data, ...lineStyle(curve.s)}, ...bandDatasets(curve, state, place)];
  });
}

const HIGHEST = 1e3;  // of a loss gap: a run that diverges would flatten all others
const LOWEST = 1e-12;  // of a loss gap or error: below lies rounding
const AXES = {
  iterations: 'iterations', work: 'work, forward solves', seconds: 'time, s',
  gap: 'what is left of the loss', x_error: 'error in x',
};

// The tolerance of the page, as a line to cross: of what is left of the loss, or of x.
function toleranceLine(scale, from, to) {
  const tau = scale * tauOf(view.target);
  return {
    label: `τ = ${tauName(view.target)}`, data: [{x: from, y: tau}, {x: to, y: tau}], showLine: true, pointRadius: 0,
    pointHitRadius: 0, borderColor: cssColour('--soft'), borderDash: [3, 4], borderWidth: 1.2, order: 5,
  };
}

function drawCurves(place, state, reading) {
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
    up[1] = Math.min(up[1] * 1.5, HIGHEST);
    if (state.problem.goal === undefined) datasets.push(toleranceLine(1, ...across));
  } else if (state.problem.goal !== undefined) {
    datasets.push(toleranceLine(state.problem.goal, ...across));
  }
  const scales = {x: logAxis(AXES[state.horizontal], ...across), y: logAxis(AXES[state.vertical], ...up)};
  const label = `${AXES[state.vertical]} against ${AXES[state.horizontal]} on ${state.problem.spec}. ${reading}`;
  return newChart(place, label, datasets, scales,
      tooltipOf((point) => `${short(point.y)} at ${short(point.x)}`), true);
}
