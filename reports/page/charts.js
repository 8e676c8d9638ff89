// Charts as the report drew them. Lines lie in an area with coordinates from 0 to 5,000. Zooming
// changes the view of this area, and values are read from the path of a line.
const AREA = 5000;

const axisFrom = (text) => {
  const [low, high, kind] = text.split(' ');
  return {low: Number(low), high: Number(high), kind};
};
const axisOf = (chart, key) => axisFrom(chart.dataset[key]);
// A value at a share of the axis as it was drawn, and the share of a value.
const valueAt = ({low, high, kind}, share) => (kind === 'log' ? low * (high / low) ** share : low + (high - low) * share);
const shareOf = ({low, high, kind}, value) => (kind === 'log' ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));

// Round values within: the same as ticks_of in the report.
function ticksOf(low, high, isLog) {
  const ticks = [];
  if (isLog) {
    const factor = 10 ** Math.max(1, Math.ceil(Math.log10(high / low) / 8));
    for (let tick = factor ** Math.ceil(Math.log(low) / Math.log(factor) - 1e-9); tick <= high * (1 + 1e-9) && ticks.length < 64; tick *= factor) ticks.push(tick);
    if (ticks.length >= 3 || !(low > 1e-300)) return ticks;
    ticks.length = 0;
    for (let power = 10 ** Math.floor(Math.log10(low)); power <= high && ticks.length < 60; power *= 10)
      ticks.push(...[1, 2, 5].map((digit) => digit * power).filter((tick) => tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9)));
    if (ticks.length >= 3) return ticks;
    ticks.length = 0;
  }
  const rough = (high - low) / 8, power = 10 ** Math.floor(Math.log10(rough));
  const step = ([1, 2, 5].find((digit) => digit * power >= rough) ?? 10) * power;
  for (let at = Math.ceil(low / step - 1e-9); at * step <= high + 1e-9 * step && ticks.length < 64; ++at) ticks.push(at * step);
  return ticks;
}

const svgElement = (tag, attributes, text = '') => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
};

const areaOf = (chart) => chart.querySelector('.area');
const boxOf = (area) => Object.fromEntries(['x', 'y', 'width', 'height'].map((name) => [name, Number(area.getAttribute(name))]));
const viewOf = (area) => area.getAttribute('viewBox').split(' ').map(Number);

// Grid lines and figures of what is in view; the names of both axes stay.
function drawAxes(chart) {
  const area = areaOf(chart), box = boxOf(area), [left, top, width, height] = viewOf(area), axes = chart.querySelector('.axes');
  const names = [...axes.querySelectorAll('text')].filter((text) => Number.isNaN(Number(text.textContent.replace('%', '')))), made = [];
  const word = (kind, value) => (kind === 'share' ? `${Math.round(100 * value)}%` : value > 9999 ? Number(value.toPrecision(2)).toExponential().replace('+', '') : figure(value));
  const x = axisOf(chart, 'x'), y = axisOf(chart, 'y');
  for (const tick of ticksOf(valueAt(x, left / AREA), valueAt(x, (left + width) / AREA), x.kind === 'log')) {
    const at = box.x + box.width * (shareOf(x, tick) * AREA - left) / width;
    made.push(svgElement('path', {class: 'grid', d: `M${at} ${box.y}v${box.height}`}), svgElement('text', {x: at, y: box.y + box.height + 15, 'text-anchor': 'middle'}, word(x.kind, tick)));
  }
  for (const tick of ticksOf(valueAt(y, 1 - (top + height) / AREA), valueAt(y, 1 - top / AREA), y.kind === 'log')) {
    const at = box.y + box.height * ((1 - shareOf(y, tick)) * AREA - top) / height;
    made.push(svgElement('path', {class: 'grid', d: `M${box.x} ${at}h${box.width}`}), svgElement('text', {x: box.x - 6, y: at + 4, 'text-anchor': 'end'}, word(y.kind, tick)));
  }
  axes.replaceChildren(...made, ...names);
}

// The corners of a path of the report: [[x, y], …].
const POINTS = new WeakMap();
function pointsOf(path) {
  if (POINTS.has(path)) return POINTS.get(path);
  const points = [];
  let x = 0, y = 0;
  for (const [, letter, first, second] of path.getAttribute('d').matchAll(/([MLHhvl])(-?\d+)(?: ?(-?\d+))?/g)) {
    const [a, b] = [Number(first), Number(second)];
    if (letter === 'M' || letter === 'L') [x, y] = [a, b];
    else if (letter === 'l') [x, y] = [x + a, y + b];
    else if (letter === 'h') x += a;
    else if (letter === 'H') x = a;
    else y += a;
    if (points.length === 0 || 'MLl'.includes(letter) || a !== 0) points.push([x, y]);
  }
  POINTS.set(path, points);
  return points;
}

const LINE = ':is([data-s], [data-line])';
const lineOf = ({dataset}) => Number(dataset.s ?? dataset.line);
const lineIn = (place, line) => [...place.querySelectorAll(LINE)].find((one) => lineOf(one) === line);
const isLineShown = (group) => !group.classList.contains('off') && (group.dataset.s === undefined || isShown('s', Number(group.dataset.s)));
const linesOf = (chart) => [...chart.querySelectorAll(`.area > ${LINE}`)];
const pathOf = (group) => group.querySelector('.line');

// Names at the ends of lines, each below those above it that it would meet, and all above the lower edge.
const END_HEIGHT = 14;
function placedEnds(ends, bottom = Infinity) {
  const placed = [...ends].sort((a, b) => a.y - b.y).map((end) => ({...end})), meet = (one, other) => one.x < other.x + other.width && other.x < one.x + one.width;
  placed.forEach((end, i) => {
    for (const other of placed.slice(0, i)) if (meet(end, other)) end.y = Math.max(end.y, other.y + END_HEIGHT);
  });
  [...placed].reverse().forEach((end, i, all) => {
    end.y = Math.min(end.y, bottom);
    for (const other of all.slice(0, i)) if (meet(end, other)) end.y = Math.min(end.y, other.y - END_HEIGHT);
  });
  return placed;
}

// The first lines that a filter does not hide stand in where it leaves none that a chart shows.
const MOST_LENT = 5;
function lendLines(chart) {
  for (const group of chart.querySelectorAll('[data-lent]')) {
    delete group.dataset.lent;
    group.classList.add('off');
  }
  const isEmpty = () => !linesOf(chart).some(isLineShown);
  for (const group of !isEmpty() ? [] : linesOf(chart).reverse().filter(({dataset}) => dataset.s !== undefined && isShown('s', Number(dataset.s))).slice(0, MOST_LENT)) {
    group.dataset.lent = '';
    group.classList.remove('off');
  }
  chart.note ??= chart.parentElement.appendChild(element('p', {className: 'legend'}, worded('none-drawn')));
  chart.note.hidden = chart.hidden || !isEmpty();
}

// The name of a line at its end, and its points, which the report leaves to the page.
const nameOf = (group) => (group.dataset.s === undefined ? group.querySelector('title').textContent : DATA.optimizers[Number(group.dataset.s)]);
function endOf(chart, group) {
  const ends = chart.querySelector('.ends'), there = lineIn(ends, lineOf(group));
  if (there !== undefined) return there;
  const made = svgElement('text', {'data-s': lineOf(group)}, (group.matches('[data-bound]') ? '≤ ' : '') + nameOf(group).replace(/^(.{12}).{2,}(.{11})$/, '$1…$2') + (group.matches('[data-worse]') ? ' ✗' : ''));
  ends.append(made);
  if (chart.matches('.marked')) group.append(svgElement('path', {class: 'points', d: pointsOf(pathOf(group)).map(([x, y]) => `M${x} ${y}h0`).join('')}));
  return made;
}

// The markers of a line, in view, where the report puts them: at most four, at its points before even steps across.
const MARKS = 4;
function markLine(chart, group, inside) {
  const area = areaOf(chart), box = boxOf(area), [left, top, width, height] = viewOf(area), marks = chart.querySelector('.marks'), line = lineOf(group), steps = new Map();
  const mark = lineIn(marks, line) ?? marks.appendChild(svgElement('path', {class: 'mark', 'data-s': line}));
  mark.shape ??= group.dataset.s === undefined ? mark.getAttribute('d').match(/m[^M]*/)?.[0] ?? '' : DATA.shapes[line];
  for (const [x, y] of inside) if (x >= left && y >= top && y <= top + height) steps.set(Math.floor(MARKS * (x - left) / width - 0.618 * line % 1), [x, y]);
  mark.setAttribute('d', [...steps.values()].map(([x, y]) => `M${(box.x + box.width * (x - left) / width).toFixed(1)} ${(box.y + box.height * (y - top) / height).toFixed(1)}${mark.shape}`).join(''));
}

function placeNames(chart) {
  const area = areaOf(chart), box = boxOf(area), [left, top, width, height] = viewOf(area), ends = [], clamp = (share) => Math.min(1, Math.max(0, share)), isNamed = chart.querySelector('.ends') !== null;
  for (const group of linesOf(chart)) {
    const inside = isLineShown(group) ? pointsOf(pathOf(group)).filter(([x]) => x <= left + width) : [];
    if (group.dataset.s !== undefined || lineIn(chart.querySelector('.marks'), lineOf(group))) markLine(chart, group, inside);
    if (!isNamed) continue;
    if (inside.length === 0) {
      lineIn(chart.querySelector('.ends'), lineOf(group))?.classList.add('off');
      continue;
    }
    const [x, y] = inside[inside.length - 1], text = endOf(chart, group);
    text.classList.remove('off');
    const room = 6.6 * text.textContent.length, last = chart.viewBox.baseVal.width - room;
    ends.push({text, x: Math.min(box.x + box.width * clamp((x - left) / width) + 6, last), y: box.y + box.height * clamp((y - top) / height), width: room});
  }
  for (const {text, x, y} of placedEnds(ends, box.y + box.height)) {
    text.setAttribute('x', x);
    text.setAttribute('y', y + 4);
  }
}

function setView(chart, left, top, width, height) {
  areaOf(chart).setAttribute('viewBox', [left, top, width, height].map(Math.round).join(' '));
  drawAxes(chart);
  placeNames(chart);
}

// As the report drew it, but wide enough for all that is shown: no axis leaves out the end of a line
// that did not leave all measure.
function fitView(chart) {
  const inside = ([x, y]) => Math.abs(x) < 4 * AREA && Math.abs(y - AREA) < 4 * AREA;
  let [left, top, right, bottom] = [0, 0, AREA, AREA];
  for (const group of chart.closest('.plane') ? [] : linesOf(chart).filter(isLineShown)) {
    const points = pointsOf(pathOf(group)).filter(inside);
    for (const [x] of points) [left, right] = [Math.min(left, x), Math.max(right, x)];
    for (const [, y] of points.slice(-1)) [top, bottom] = [Math.min(top, y - 100), Math.max(bottom, y + 100)];
  }
  setView(chart, left, top, right - left, bottom - top);
}

// Shows those lines of all charts of a place, and presses their buttons.
function showLinesIn(place, lines) {
  for (const chart of place.querySelectorAll('.chart')) {
    for (const group of linesOf(chart)) group.classList.toggle('off', !lines.has(lineOf(group)));
    fitView(chart);
  }
  for (const button of place.querySelectorAll('button.name')) button.setAttribute('aria-pressed', lines.has(lineOf(button)));
}

function light(place, line) {
  for (const chart of place.querySelectorAll('.chart')) {
    chart.classList.toggle('lit', line !== undefined);
    for (const one of chart.querySelectorAll(LINE)) one.classList.toggle('lit', lineOf(one) === line);
  }
}

// The nearest corner of a line that is shown, within so many pixels of the pointer.
const NEAR = 14;
function nearest(chart, event) {
  const area = areaOf(chart), [left, top, width, height] = viewOf(area), matrix = area.getScreenCTM(), frame = boxOf(area);
  const shape = chart.getBoundingClientRect(), scale = shape.width / chart.viewBox.baseVal.width;
  if (matrix === null) return undefined;
  const across = shape.left + frame.x * scale, down = shape.top + frame.y * scale;
  let best;
  for (const group of linesOf(chart).filter(isLineShown))
    for (const [x, y] of pointsOf(pathOf(group))) {
      const off = Math.hypot(across + (x - left) / width * frame.width * scale - event.clientX, down + (y - top) / height * frame.height * scale - event.clientY);
      if (off < (best?.off ?? NEAR)) best = {off, x, y, group};
    }
  return best;
}

const short = (value) => figure(Number(value.toPrecision(3)));

function explainPoint(event) {
  const chart = event.target.closest?.('.chart'), tip = document.getElementById('tip');
  if (!chart) return;
  const point = nearest(chart, event);
  light(chart.parentElement, point && lineOf(point.group));
  tip.hidden = point === undefined;
  if (point === undefined) return;
  const x = short(valueAt(axisOf(chart, 'x'), point.x / AREA)), y = short(valueAt(axisOf(chart, 'y'), 1 - point.y / AREA));
  showTip(tip, [nameOf(point.group), `${y} at ${x}`], {getBoundingClientRect: () => new DOMRect(event.clientX, event.clientY - 8, 1, 16)});
}

// The τ of the page, where a chart has its line.
function moveTolerance(chart) {
  const line = chart.querySelector('.tau');
  if (line === null) return;
  const y = Math.round((1 - shareOf(axisOf(chart, 'y'), Number(line.dataset.scale) * Math.max(tauOf(view.target), DATA.problems[chart.closest('[data-p]')?.dataset.p]?.goal ?? 0))) * AREA);
  line.setAttribute('d', `M${-4 * AREA} ${y}h${9 * AREA}`);
}

document.addEventListener('pointermove', explainPoint);
document.addEventListener('pointerout', (event) => {
  const chart = event.target.closest?.('.chart');
  if (chart && !chart.contains(event.relatedTarget)) {
    light(chart.parentElement, undefined);
    document.getElementById('tip').hidden = true;
  }
});
for (const [event, isLit] of [['pointerover', true], ['pointerout', false], ['focusin', true], ['focusout', false]])
  document.addEventListener(event, ({target}) => {
    const name = target.closest?.('button.name');
    if (name) light(name.closest('figure, article'), isLit ? lineOf(name) : undefined);
  });
document.addEventListener('click', ({target}) => {
  const name = target.closest('button.name');
  if (name === null) return;
  const place = name.closest('figure, article'), line = lineOf(name);
  const lines = new Set([...place.querySelectorAll('button.name[aria-pressed=true]')].map(lineOf));
  if (!lines.delete(line)) lines.add(line);
  if (place.matches('article')) CHOSEN.set(Number(place.dataset.p), lines);
  showLinesIn(place, lines);
});
// What a problem or a figure shows on demand: other curves, and lines that are hidden at first.
function completeCharts(place, p) {
  const {charts, rest} = DATA.problems[p]?.curves ?? DATA;
  place.querySelector('.curves > .chart')?.insertAdjacentHTML('afterend', charts);
  for (const chart of place.querySelectorAll('[data-rest]')) {
    const shown = areaOf(chart).querySelector(':scope > g'), hidden = rest[chart.dataset.rest];
    if (shown === null) areaOf(chart).insertAdjacentHTML('beforeend', hidden);
    else shown.insertAdjacentHTML('beforebegin', hidden);
  }
}
ON_UNPACK.push((place) => completeCharts(place, place.dataset.p));
ON_UNPACK.push((place) => place.querySelectorAll('.names').forEach(oneStop));
ON_UNPACK.push((place) => {
  if (!place.matches('article'))
    place.querySelectorAll('.chart').forEach((chart) => live(chart, () => {
      lendLines(chart);
      fitView(chart);
    }));
});
