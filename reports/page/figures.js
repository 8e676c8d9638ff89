// The papers' figures: lines with their range over seeds, samples, and pictures.
'use strict';

const MOST_LINES = 16;  // as many are all shown at first

// [x, y] of a line where both have a place on the axes.
function pointsOf(figure, xs, ys) {
  const points = [];
  xs.forEach((x, i) => {
    const isDrawn = x !== null && ys[i] !== null && (!figure.log_x || x > 0) && (!figure.log_y || ys[i] > 0);
    if (isDrawn) points.push({x, y: ys[i]});
  });
  return points;
}

function figureDatasets(figure, visible) {
  const sets = [];
  for (const line of figure.lines.filter((one) => visible.has(one.s) && isShown('s', one.s))) {
    const style = lineStyle(line.s), name = DATA.optimizers[line.s];
    const isScatter = figure.kind === 'scatter', isSparse = line.x.length <= 16;
    sets.push({
      ...style, label: name, data: pointsOf(figure, line.x, line.y), showLine: !isScatter,
      pointRadius: isScatter ? 2 : isSparse ? 3 : 0, pointStyle: markerOf(line.s),
    });
    if (line.low.length === 0 || isScatter) continue;
    const band = {
      bandOf: line.s, borderWidth: 0, pointRadius: 0, pointHitRadius: 0, showLine: true, backgroundColor: colourOf(line.s) + BAND, order: 4,
    };
    sets.push({...band, data: pointsOf(figure, line.x, line.low), fill: false});
    sets.push({...band, data: pointsOf(figure, line.x, line.high), fill: '-1'});
  }
  return sets;
}

function extent(points, key) {
  const values = points.map((point) => point[key]);
  if (values.length === 0) return [1, 10];
  const low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
  return high > low ? [low, high] : [low, low === 0 ? 1 : low + Math.abs(low)];
}

// The methods that the paper's claims are about, else one of each kind. Of a published setting and
// its tuned twin the published one.
function firstLines(figure) {
  const hasTwin = (s, all) => all.some((other) => DATA.optimizers[s] === `${DATA.optimizers[other]}, tuned`);
  const single = (all) => all.filter((s) => !hasTwin(s, all)), own = single(figure.lines.map((line) => line.s));
  if (figure.paper.length > 0) return new Set(single(figure.paper));
  return new Set(own.length <= MOST_LINES ? own : own.filter((s) => LEADERS.includes(s)));
}

// The fence of Tukey (1977), three ranges of the middle half beyond it, in the logarithm where the
// axis has it: one step that diverged sets no axis.
function robustExtent(values, isLog) {
  if (values.length === 0) return [1, 10];
  const to = isLog ? Math.log : (v) => v, back = isLog ? Math.exp : (v) => v;
  const sorted = values.map(to).sort((x, y) => x - y), at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  const reach = 3 * (at(0.75) - at(0.25)), low = back(Math.max(sorted[0], at(0.25) - reach)), high = back(Math.min(sorted[sorted.length - 1], at(0.75) + reach));
  return high > low ? [low, high] : isLog ? [low / 2, 2 * low] : [low, low === 0 ? 1 : low + Math.abs(low)];
}

// A path is shown where it settles: the overshoot of a first step would flatten all others.
function extentOf(figure, sets, key) {
  const lines = sets.filter((set) => set.bandOf === undefined), isLog = figure[`log_${key}`];
  const kept = figure.kind === 'path' ? lines.flatMap((set) => set.data.slice(set.data.length / 2)) : lines.flatMap((set) => set.data);
  const [low, high] = key === 'x' && figure.kind !== 'path' ? extent(kept, key) : robustExtent(kept.map((point) => point[key]), isLog);
  const published = figure.published.flatMap((mark) => (key === 'x' ? [mark.x] : [mark.y, mark.low, mark.high]));
  const inside = published.filter((value) => value !== null && (!isLog || value > 0));
  const margin = figure.kind === 'path' ? 0.3 * (high - low) : 0;
  return [Math.min(low - margin, ...inside), Math.max(high + margin, ...inside)];
}

// The paper's values, with the error of reading them.
function publishedDatasets(figure, visible) {
  return figure.published.filter((mark) => visible.has(mark.s) && isShown('s', mark.s)).flatMap((mark) => {
    const colour = cssColour('--ink'), bar = [mark.low, mark.high].filter((y) => y !== null).map((y) => ({x: mark.x, y}));
    return [
      {label: mark.name, data: [{x: mark.x, y: mark.y}], pointStyle: 'rectRot', pointRadius: 7, pointHitRadius: 9, borderWidth: 2, borderColor: colour, backgroundColor: colourOf(mark.s), order: 0},
      {data: bar, showLine: true, pointStyle: 'line', pointRadius: 4, pointHitRadius: 0, borderWidth: 1.5, borderColor: colour, order: 0}];
  });
}

function drawFigure(place, figure, visible, reading) {
  const sets = figureDatasets(figure, visible);
  const across = extentOf(figure, sets, 'x'), up = extentOf(figure, sets, 'y');
  sets.push(...publishedDatasets(figure, visible));
  if (figure.diagonal)
    sets.push({
      data: [{x: across[0], y: across[0]}, {x: across[1], y: across[1]}], showLine: true, pointRadius: 0,
      pointHitRadius: 0, borderColor: cssColour('--soft'), borderDash: [4, 4], borderWidth: 1.2, order: 5,
    });
  const scale = (isLog, title, [low, high]) => (isLog ? logAxis(title, low, high) : axis(title, {type: 'linear', min: low, max: high, ticks: {includeBounds: false}}));
  const scales = {x: scale(figure.log_x, figure.x_label, across), y: scale(figure.log_y, figure.y_label, up)};
  return newChart(place, `${figure.title}: ${figure.y_label} against ${figure.x_label}. ${reading}`, sets, scales,
      tooltipOf((point) => `${short(point.y)} at ${short(point.x)}`));
}

function pictureElement(picture) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = picture.size;
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `${picture.title}, grey from ${short(picture.low)} to ${short(picture.high)}`);
  const context = canvas.getContext('2d'), image = context.createImageData(picture.size, picture.size);
  for (let i = 0; i < picture.size * picture.size; ++i) {
    const grey = parseInt(picture.greys.substr(2 * i, 2), 16);
    image.data.set([grey, grey, grey, 255], 4 * i);
  }
  context.putImageData(image, 0, 0);
  const figure = document.createElement('figure'), caption = document.createElement('figcaption');
  caption.textContent = `${picture.title} (${short(picture.low)} to ${short(picture.high)})`;
  figure.append(canvas, caption);
  return figure;
}

function figureDrawer(element, figure) {
  if (figure.pictures.length > 0) {
    const row = document.createElement('div');
    row.className = 'pictures';
    row.append(...figure.pictures.map(pictureElement));
    element.append(row);
    return () => {};
  }
  const place = document.createElement('div'), legend = document.createElement('div');
  const visible = firstLines(figure), reading = element.querySelector('.reading').textContent;
  const draw = redrawer(place, () => drawFigure(place, figure, visible, reading));
  element.append(place, legend);
  return () => {
    draw();
    legend.replaceChildren(...figureNames(figure, visible, draw, (index) => highlight(draw.chart, index)));
  };
}

// The names of the lines, shown and hidden by a press.
function figureNames(figure, visible, redraw, light) {
  const names = figure.lines.map((line) => line.s).filter((s) => isShown('s', s)).map((s) => {
    const button = pressable(DATA.optimizers[s], visible.has(s), () => {
      if (!visible.delete(s)) visible.add(s);
      button.setAttribute('aria-pressed', visible.has(s));
      redraw();
    });
    button.className = 'name';
    button.prepend(swatch(s));
    for (const [event, lit] of [['pointerenter', s], ['pointerleave', undefined], ['focus', s], ['blur', undefined]])
      button.addEventListener(event, () => light(lit));
    return button;
  });
  const marks = figure.published.length === 0 ? [] : [element('p', {className: 'legend'}, `◆ published, with the error of reading: ${[...new Set(figure.published.map((mark) => mark.name.split(': ')[1]))].join(', ')}.`)];
  return [element('div', {className: 'names'}, ...names), ...marks];
}

function liveFigure(element) {
  let draw;
  live(element, () => {
    draw ??= figureDrawer(element, DATA.figures[Number(element.dataset.figure)]);
    draw();
  });
}
