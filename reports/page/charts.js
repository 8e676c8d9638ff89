// Charts over the page's data: axes, and curves with their range over seeds.
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

// Within a factor of three a linear axis says as much, and has figures on it.
const LEAST_FACTOR = 3;

// Powers of ten are labelled, not more of them than fit; within two decades also 2 and 5 times these.
function logAxis(title, low, high) {
  if (high / low < LEAST_FACTOR) return axis(title, {type: 'linear', min: low, max: high, ticks: {includeBounds: false}});
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

// What the curve had taken at each of its points, by the measure of the page.
const takenAlong = (curve) => curve[measureNow().name];

// Of a direct problem the best loss so far, which holds until a better one is evaluated: a staircase
// through the very medians of the tables where these are of the loss, so that a line crosses τ where
// the table says. Points between and beyond them come from the kept iterations.
function stairs(curve, cell, {problem, vertical}) {
  const xs = takenAlong(curve), points = [];
  const medians = vertical === 'gap' && problem.goal === undefined ? mediansOf(cell, view.measure) : [];
  const first = medians[0] ?? Infinity, last = medians[medians.length - 1] ?? -Infinity;
  const keep = (x, i) => curve[vertical][i] !== null && x !== null && (x < first || x > last);
  xs.forEach((x, i) => { if (keep(x, i)) points.push({x, y: curve[vertical][i]}); });
  medians.forEach((x, place) => points.push({x, y: tauOf(TARGETS[place])}));
  points.sort((a, b) => a.x - b.x || b.y - a.y);
  if (vertical === 'gap')
    for (let i = 1; i < points.length; ++i) points[i].y = Math.min(points[i].y, points[i - 1].y);
  return points.filter((point, i) => i === 0 || i === points.length - 1 || point.y !== points[i - 1].y);
}

// Zero has no logarithm: it is drawn below all others, and what is below the floor on the floor.
const HIGHEST = 1e3;  // of a loss gap: a run that diverges would flatten all others
const LOWEST = 1e-12;  // of a loss gap or error: below lies rounding

function linesOf(state) {
  const {problem, vertical} = state;
  return problem.curves.filter((curve) => state.visible.has(curve.s) && isShown('s', curve.s) && curve[vertical] !== undefined)
      .map((curve) => ({curve, points: problem.learned === undefined
          ? stairs(curve, cellOf(problem, curve.s), state) : pointsAlong(curve, vertical)}));
}

// Of a learned problem what the network of each kept iteration is worth.
function pointsAlong(curve, vertical) {
  return takenAlong(curve).map((x, i) => ({x, y: curve[vertical][i]})).filter(({x, y}) => x !== null && y !== null);
}

// The range over seeds, where the curve has one: two unseen stairs with what is between them filled.
function bandDatasets(curve, state, place) {
  const low = curve[`${state.vertical}_low`], high = curve[`${state.vertical}_high`];
  if (low === undefined || state.visible.size > FEW) return [];
  const xs = takenAlong(curve);
  const band = {
    bandOf: curve.s, borderWidth: 0, pointRadius: 0, pointHitRadius: 0, pointHoverRadius: 0, showLine: true, stepped: true,
    backgroundColor: colourOf(curve.s) + BAND, order: 4,
  };
  const line = (values, never) => xs.map((x, i) => ({x, y: values[i] ?? never})).filter(({x, y}) => x !== null && y !== null).map(place);
  return [{...band, data: line(low, null), fill: false}, {...band, data: line(high, HIGHEST), fill: '-1'}];
}

function curveDatasets(state) {
  const lines = linesOf(state), points = lines.flatMap((line) => line.points);
  const zeroX = least(points.map((point) => point.x)) / 2, zeroY = Math.max(LOWEST, least(points.map((point) => point.y)) / 10);
  const place = ({x, y}) => ({x: x > 0 ? x : zeroX, y: Math.max(y, zeroY)});
  return lines.flatMap(({curve, points: own}) => [
    {
      label: DATA.optimizers[curve.s], data: own.map(place), ...lineStyle(curve.s), stepped: true,
      pointRadius: own.length > 60 ? 0 : 1.8, pointStyle: markerOf(curve.s),
    },
    ...bandDatasets(curve, state, place)]);
}

const AXES = {gap: 'relative loss gap, best so far', x_error: 'error in x'};
const axisName = (state) => (state.vertical === 'gap' && state.problem.learned !== undefined ? 'relative loss gap' : AXES[state.vertical]);

// The tolerance of the page, as a line to cross: of the relative loss gap, or of x.
function toleranceLine(scale, from, to) {
  const tau = scale * tauOf(view.target);
  return {
    label: `τ = ${tauName(view.target)}`, data: [{x: from, y: tau}, {x: to, y: tau}], showLine: true, pointRadius: 0,
    pointHitRadius: 0, borderColor: cssColour('--soft'), borderDash: [3, 4], borderWidth: 1.2, order: 5,
  };
}

function drawCurves(place, state, reading) {
  const datasets = curveDatasets(state);
  const points = datasets.filter((set) => set.label !== undefined).flatMap((set) => set.data);
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
  const {counted, unit} = measureNow(), title = counted === unit ? counted : `${counted}, ${unit}`;
  const scales = {x: logAxis(title, ...across), y: logAxis(axisName(state), ...up)};
  const label = `${axisName(state)} against ${title} on ${state.problem.spec}. ${reading}`;
  return newChart(place, label, datasets, scales,
      tooltipOf((point) => `${short(point.y)} at ${short(point.x)}`), true);
}
