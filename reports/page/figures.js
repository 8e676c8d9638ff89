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
      pointRadius: isScatter ? 2 : isSparse ? 3 : 0, pointStyle: MARKERS[STYLES[line.s].marker === 'circle' ? 0 : 1],
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

// All lines at first where they are not too many, but for the tuned twins of published settings.
function firstLines(figure) {
  const published = figure.lines.map((line) => line.s).filter((s) => isShown('s', s) && !DATA.optimizers[s].endsWith(', tuned'));
  return new Set(published.length <= MOST_LINES ? published : published.slice(0, SHOWN_AT_FIRST));
}

// A path is shown where it settles: the overshoot of a first step would flatten all others.
function extentOf(figure, sets, key) {
  if (figure.kind !== 'path') return extent(sets.flatMap((set) => set.data), key);
  const [low, high] = extent(sets.flatMap((set) => set.data.slice(set.data.length / 2)), key);
  const margin = 0.3 * (high - low);
  return [low - margin, high + margin];
}

function drawFigure(place, figure, visible, reading) {
  const sets = figureDatasets(figure, visible);
  const across = extentOf(figure, sets, 'x'), up = extentOf(figure, sets, 'y');
  if (figure.diagonal)
    sets.push({
      data: [{x: across[0], y: across[0]}, {x: across[1], y: across[1]}], showLine: true, pointRadius: 0,
      pointHitRadius: 0, borderColor: cssColour('--soft'), borderDash: [4, 4], borderWidth: 1.2, order: 5,
    });
  const scale = (isLog, title, [low, high]) => (isLog ? logAxis(title, low, high) : axis(title, {type: 'linear', ...(figure.kind === 'path' ? {min: low, max: high} : {})}));
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
  const ranked = figure.lines.map((line) => line.s), place = document.createElement('div');
  const choice = newChoice(ranked, () => firstLines(figure)), reading = element.querySelector('.reading').textContent;
  const draw = redrawer(place, () => drawFigure(place, figure, choice(), reading));
  const legend = newLegend(ranked, draw, (index) => highlight(draw.chart, index));
  element.append(place, legend.place);
  return () => {
    draw();
    legend.fill(choice());
  };
}

function liveFigure(element) {
  let draw;
  live(element, () => {
    draw ??= figureDrawer(element, DATA.figures[Number(element.dataset.figure)]);
    draw();
  });
}
