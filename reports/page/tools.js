// The tools of a chart: zoom by dragging, linear or logarithmic axes, and saving the chart as a
// file.

// Each corner of a path, moved: steps stay steps, since each axis moves for itself.
function movedPath(path, across, up) {
  let x = 0, y = 0;
  return path.replaceAll(/([MLHVhvl])(-?\d+)(?: ?(-?\d+))?|Z/g, (token, letter, first, second) => {
    if (token === 'Z') return token;
    const [a, b] = [Number(first), Number(second)], isDot = letter === 'h' && a === 0;
    if (letter === 'M' || letter === 'L') [x, y] = [a, b];
    else if (letter === 'l') [x, y] = [x + a, y + b];
    else if (letter === 'H') x = a;
    else if (letter === 'h') x += a;
    else y = letter === 'V' ? a : y + a;
    return isDot ? 'h0' : `${letter === 'M' ? 'M' : 'L'}${Math.round(across(x))} ${Math.round(up(y))}`;
  });
}

// The same numbers on another axis, always from those that the report drew; what is not above 0 stays at the low edge
// of a logarithm.
function setKind(chart, key, kind) {
  const far = 4 * AREA, drawn = chart.drawn ??= {x: chart.dataset.x, y: chart.dataset.y};
  const first = axisFrom(drawn[key]);
  chart.dataset[key] = kind === first.kind ? drawn[key] : `${kind === 'log' ? Math.max(first.low, 1e-6 * first.high) : first.low} ${first.high} ${kind}`;
  const mover = (key) => (at) => {
    if (chart.dataset[key] === drawn[key]) return at;
    const share = shareOf(axisOf(chart, key), valueAt(axisFrom(drawn[key]), key === 'x' ? at / AREA : 1 - at / AREA)), end = Number.isNaN(share) || share === -Infinity ? 0 : share;
    return Math.max(-far, Math.min(far, AREA * (key === 'x' ? end : 1 - end)));
  };
  for (const path of chart.querySelectorAll('.area path')) {
    if (path.matches('.tau')) continue;
    path.drawn ??= path.getAttribute('d');
    path.setAttribute('d', movedPath(path.drawn, mover('x'), mover('y')));
    POINTS.delete(path);
  }
  moveTolerance(chart);
  fitView(chart);
}

function download(name, type, text) {
  const link = element('a', {href: URL.createObjectURL(new Blob([text], {type})), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href));
}

const fileOf = (chart) => chart.querySelector('title').textContent.replaceAll(/[^A-Za-z0-9]+/g, '-');

// With the colours of the moment in each element, as programs that know no style sheet read them.
// A chart has its title above and, where they do not stand at their ends, the names of its lines below.
function svgText(chart) {
  if (!chart.matches('.chart')) return plainText(chart);
  const {width, height} = chart.viewBox.baseVal, ends = chart.querySelector('.ends'), caption = svgElement('g', {}), whole = chart.getAttribute('viewBox');
  const lines = ends !== null && getComputedStyle(ends).display !== 'none' ? [] : linesOf(chart).filter(isLineShown);
  caption.append(svgElement('text', {x: 4, y: -10}, chart.querySelector('title').textContent));
  lines.forEach((group, i) => {
    const entry = group.cloneNode(false), y = height + 12 + 18 * i;
    entry.classList.add('swatch');
    entry.append(svgElement('path', {d: `M4 ${y - 4}h24`}), svgElement('text', {x: 34, y}, nameOf(group)));
    caption.append(entry);
  });
  chart.append(caption);
  chart.setAttribute('viewBox', `0 -26 ${width} ${height + 26 + 18 * lines.length}`);
  const text = plainText(chart);
  chart.setAttribute('viewBox', whole);
  caption.remove();
  return text;
}

function plainText(chart) {
  const copy = chart.cloneNode(true), originals = [chart, ...chart.querySelectorAll('*')], pixel = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
  const plain = (colour) => {
    pixel.clearRect(0, 0, 1, 1);
    pixel.fillStyle = colour;
    pixel.fillRect(0, 0, 1, 1);
    return `rgb(${pixel.getImageData(0, 0, 1, 1).data.slice(0, 3).join(',')})`;
  };
  [copy, ...copy.querySelectorAll('*')].forEach((one, i) => {
    const style = getComputedStyle(originals[i]);
    if (style.display === 'none') return one.remove();
    for (const name of ['fill', 'stroke']) one.setAttribute(name, style[name] === 'none' ? 'none' : plain(style[name]));
    for (const name of ['stroke-width', 'stroke-dasharray', 'stroke-linecap', 'opacity', 'vector-effect', 'font-size', 'font-family', 'paint-order']) one.setAttribute(name, style.getPropertyValue(name));
  });
  return new XMLSerializer().serializeToString(copy);
}

function csvText(chart) {
  const [x, y] = [axisOf(chart, 'x'), axisOf(chart, 'y')], quoted = (text) => `"${text.replaceAll('"', '""')}"`;
  const scale = Number(chart.querySelector('.tau')?.dataset.scale), problem = DATA.problems[chart.closest('article')?.dataset.p], isExact = scale > 0 && problem !== undefined;
  const goals = isExact ? TARGETS.map((target) => scale * Math.max(tauOf(target), problem.goal ?? 0)) : [];
  const number = (axis, exact, at) => exact.find((value) => Math.abs(shareOf(axis, value) * AREA - at) <= 1) ?? Number(valueAt(axis, at / AREA).toPrecision(4));
  return ['line,x,y', ...linesOf(chart).filter(isLineShown).flatMap((group) => {
    const medians = isExact ? mediansOf(cellOf(problem, lineOf(group)), MEASURES.indexOf(chart.dataset.by)) : [];
    return pointsOf(pathOf(group)).map(([across, up]) => `${quoted(nameOf(group))},${number(x, medians, across)},${number(y, goals, AREA - up)}`);
  })].join('\n') + '\n';
}

// The chart as pixels, two for each of the screen.
function savePng(chart) {
  const copy = new DOMParser().parseFromString(svgText(chart), 'image/svg+xml').documentElement, [, , width, height] = copy.getAttribute('viewBox').split(' ').map(Number);
  const picture = new Image(), canvas = element('canvas', {width: 2 * width, height: 2 * height});
  picture.onload = () => {
    const paper = canvas.getContext('2d');
    paper.fillStyle = getComputedStyle(document.body).backgroundColor;
    paper.fillRect(0, 0, canvas.width, canvas.height);
    paper.drawImage(picture, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((bytes) => download(`${fileOf(chart)}.png`, 'image/png', bytes));
  };
  copy.setAttribute('width', width);
  copy.setAttribute('height', height);
  picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
}

// A row of buttons for the chart of a place that is not hidden.
function addTools(place) {
  const chart = () => place.querySelector('.chart:not([hidden])'), resolution = worded('resolution', {steps: AREA});
  const turn = (key) => ({currentTarget}) => {
    setKind(chart(), key, axisOf(chart(), key).kind === 'log' ? 'linear' : 'log');
    currentTarget.setAttribute('aria-pressed', axisOf(chart(), key).kind === 'log');
  };
  const tools = element('p', {className: 'tools'}, pressable('whole', undefined, () => fitView(chart())), pressable('SVG', undefined, () => download(`${fileOf(chart())}.svg`, 'image/svg+xml', svgText(chart()))),
      Object.assign(pressable('CSV', undefined, () => download(`${fileOf(chart())}.csv`, 'text/csv', csvText(chart()))), {title: resolution}),
      pressable('PNG', undefined, () => savePng(chart())), Object.assign(pressable('copy', undefined, ({currentTarget}) => copyText(csvText(chart()), currentTarget)), {title: resolution}));
  if (chart().querySelector('.band') !== null) tools.append(pressable('bands', true, ({currentTarget}) => currentTarget.setAttribute('aria-pressed', !place.classList.toggle('no-bands'))));
  for (const key of ['x', 'y'])
    if (axisOf(chart(), key).kind !== 'share' && axisOf(chart(), key).low > 0) tools.firstChild.after(pressable(`log ${key}`, axisOf(chart(), key).kind === 'log', turn(key)));
  place.querySelector('.chart:last-of-type').after(tools);
  oneStop(tools);
}

// A drag over the area of a chart looks at that part of it.
let drag, isDragged = false;
const placeIn = (chart, event) => {
  const area = areaOf(chart), box = boxOf(area), [left, top, width, height] = viewOf(area), shape = chart.getBoundingClientRect(), scale = chart.viewBox.baseVal.width / shape.width;
  return [left + ((event.clientX - shape.left) * scale - box.x) / box.width * width, top + ((event.clientY - shape.top) * scale - box.y) / box.height * height];
};
document.addEventListener('pointerdown', (event) => {
  const chart = event.target.closest?.('.chart');
  drag = chart && event.pointerType === 'mouse' && event.button === 0 ? {chart, from: placeIn(chart, event), at: [event.clientX, event.clientY]} : undefined;
  if (drag) event.preventDefault();
});
document.addEventListener('pointerup', (event) => {
  const least = 8;  // pixels: less is a press
  isDragged = drag !== undefined && Math.min(Math.abs(event.clientX - drag.at[0]), Math.abs(event.clientY - drag.at[1])) > least;
  if (isDragged) {
    const [x, y] = placeIn(drag.chart, event), [left, top] = drag.from;
    setView(drag.chart, Math.min(x, left), Math.min(y, top), Math.abs(x - left), Math.abs(y - top));
  }
  drag = undefined;
});
document.addEventListener('dblclick', ({target}) => { if (target.closest?.('.chart')) fitView(target.closest('.chart')); });
ON_UNPACK.push((place) => { for (const one of new Set([...place.querySelectorAll('.chart')].map((chart) => chart.parentElement))) addTools(one); });
