// Charts of paths over contours, to scale: a unit across is a unit up, since both are of one plane.
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
  if (!isShort(path)) return {...style, borderWidth: 2.2, pointHitRadius: 2};
  const marker = markerOf(path.s);
  return {
    ...style, borderDash: [3, 3], borderWidth: 1.2, pointRadius: marker === 'crossRot' ? 5 : 4.2, pointStyle: marker,
    pointBorderWidth: 1.6, backgroundColor: cssColour('--paper'),
  };
}

// The window, widened to the shape of the drawing, so that both axes have one scale.
function toScale([left, right, bottom, top], width, height) {
  const unit = Math.max((right - left) / width, (top - bottom) / height);  // of data, a pixel
  const x = (left + right) / 2, y = (bottom + top) / 2;
  return [x - unit * width / 2, x + unit * width / 2, y - unit * height / 2, y + unit * height / 2];
}

// Planes stretched beyond this are not to scale, and say so: a valley would be a line.
const MOST_STRETCH = 12;

function drawPlane(place, state, space) {
  const plane = state.problem[space];
  const shown = plane.paths.filter((path) => state.visible.has(path.s) && isShown('s', path.s));
  const datasets = contourDatasets(plane.contours);
  for (const path of shown)
    datasets.push({label: DATA.optimizers[path.s], data: pairs(path.points), ...pathDataset(path), order: 1});
  if (plane.paths.length > 0) datasets.push(markerDataset(pairs(plane.paths[0].points)[0], 'circle', 'start'));
  if (plane.goal.length === 2) datasets.push(markerDataset(pairs(plane.goal)[0], 'star', space === 'x' ? 'solution' : 'target'));
  const [left, right, bottom, top] = plane.window;
  const stretch = Math.max((right - left) / (top - bottom), (top - bottom) / (right - left));
  const isToScale = stretch <= MOST_STRETCH;
  const plain = {ticks: {autoSkip: true, includeBounds: false}, grid: {display: false, borderColor: cssColour('--line')}};
  const scales = {
    x: axis(`${space}₁`, {min: left, max: right, ...plain}), y: axis(`${space}₂`, {min: bottom, max: top, ...plain}),
  };
  const chart = newChart(place, `Paths in ${space} on ${state.problem.spec}${isToScale ? ', both axes to one scale' : ''}`, datasets, scales,
      tooltipOf((point) => `(${short(point.x)}, ${short(point.y)})`));
  if (isToScale) keepScale(chart, plane.window);
  else place.append(element('p', {className: 'legend'}, `Not to scale: one axis is ${short(stretch)} times as long as the other.`));
  return chart;
}

// After each change of size the window fits the drawing anew.
function keepScale(chart, window) {
  const fit = () => {
    const {left, right, top, bottom} = chart.chartArea;
    if (!(right > left && bottom > top)) return;
    const [low, high, down, up] = toScale(window, right - left, bottom - top), {x, y} = chart.options.scales;
    if (Math.abs(x.min - low) + Math.abs(x.max - high) + Math.abs(y.min - down) + Math.abs(y.max - up) < 1e-9 * (high - low)) return;
    Object.assign(x, {min: low, max: high});
    Object.assign(y, {min: down, max: up});
    chart.update('none');
  };
  chart.options.onResize = () => requestAnimationFrame(() => { if (chart.ctx !== null) fit(); });
  fit();
  fit();  // the axis of other numbers may have another width
}
