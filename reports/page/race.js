// The race: two to four methods on their way over contours of the loss, or as fields of x, by forward solves. A point
// or a field stands until the next one that its run kept, and a flag until the end from where the run reached τ.
const RACE_FRAMES = 60, RACE_MOST = 4, RACE_SECONDS = 8, RACE_END = 0.85;  // of the animation: the last picture stands for the rest
const race = {p: undefined, methods: [], frame: RACE_FRAMES, timer: undefined};

const runnersOf = (p) => DATA.problems[p].race.map(([s, seed, reached, works]) => ({s, seed, reached, works})).filter(({works}) => works.length > 1);
const clockAt = (most, frame) => (frame === RACE_FRAMES ? most : Math.floor(most ** (frame / RACE_FRAMES)));

// The best of three kinds, or else the first that ran.
function racersOf(p) {
  const all = runnersOf(p).map(({s}) => s), best = rankingOf(DATA.problems[p]).filter((s) => all.includes(s));
  const three = ['Adaptive gradient', 'Least squares', 'Inversion of the physics'].map((kind) => best.find((s) => DATA.kinds[s] === kind));
  return three.includes(undefined) ? best.slice(0, 3) : three;
}

// The article of a problem as it came or as it stands.
function articleOf(p) {
  const article = document.getElementById(`problem-${p}`), made = document.createElement('template');
  made.innerHTML = article.querySelector(':scope > noscript')?.textContent ?? article.innerHTML;
  return made.content;
}

// What is drawn from `from` forward solves on, and before `to`.
const stage = (items, parent, node, from, to = Infinity) => {
  parent.append(node);
  items.push({node, from, to});
};

// The contours of the problem, with the path and the place of each method.
function overContours(runners, p, items) {
  const content = articleOf(p), {rest} = DATA.problems[p].curves, plane = content.querySelector('.plane .chart'), box = boxOf(areaOf(plane));
  areaOf(plane).insertAdjacentHTML('beforeend', rest[plane.dataset.rest]);
  const lines = runners.map(({s}) => pointsOf(pathOf(lineIn(areaOf(plane), s)))), area = areaOf(plane), marks = plane.querySelector('.marks');
  linesOf(plane).forEach((line) => line.remove());
  marks.replaceChildren();
  const {width, height} = plane.viewBox.baseVal, place = ([x, y]) => `${(box.x + box.width * x / AREA).toFixed(1)} ${(box.y + box.height * y / AREA).toFixed(1)}`;
  runners.forEach(({s, works}, i) => lines[i].forEach((point, k) => {
    if (k > 0) stage(items, area, svgElement('path', {class: 'line', 'data-s': s, d: `M${lines[i][k - 1].join(' ')}L${point.join(' ')}`}), k === 0 ? 0 : works[k]);
    if (point.every((at) => at >= 0 && at <= AREA)) stage(items, marks, svgElement('path', {class: 'mark', 'data-s': s, d: `M${place(point)}${DATA.shapes[s]}`}), k === 0 ? 0 : works[k], works[k + 1]);
  }));
  return {svg: plane, width, height};
}

// x of each method beside the true one, painted as on the page.
function overFields(runners, p, items) {
  const {fields} = DATA.problems[p], canvas = articleOf(p).querySelector('.given canvas'), side = 150, isFlat = canvas.height === 1, tall = isFlat ? 40 : side;
  const svg = svgElement('svg', {}), imageOf = (letters, at) => {
    paint(canvas, bytesOf(letters));
    return svgElement('image', {x: 10 + at * (side + 12), y: 30, width: side, height: tall, href: canvas.toDataURL(), preserveAspectRatio: 'none', style: 'image-rendering: pixelated'});
  };
  const all = fields.truth === '' ? [] : [[fields.labels[0] === 'x' ? 'x*' : 'x* to y*', imageOf(fields.truth, 0)]];
  all.forEach(([name, image]) => svg.append(svgElement('text', {x: 10, y: 22}, name), image));
  runners.forEach(({s, works}, i) => {
    const at = i + all.length;
    svg.append(svgElement('text', {x: 10 + at * (side + 12), y: 22}, DATA.optimizers[s]));
    fields.found.find((found) => found.s === s).x.forEach((letters, k) => stage(items, svg, imageOf(letters, at), k === 0 ? 0 : works[k], works[k + 1]));
  });
  return {svg, width: 10 + (all.length + runners.length) * (side + 12), height: 30 + tall};
}

// A picture with all that is ever drawn of it: {svg, items, most}.
function sceneOf(p, methods) {
  const items = [], runners = runnersOf(p).filter(({s}) => methods.includes(s)), most = Math.max(...runners.map(({works}) => works[works.length - 1]));
  const {svg, width, height} = (DATA.problems[p].fields === undefined ? overContours : overFields)(runners, p, items), wide = Math.max(width, 300);
  svg.setAttribute('class', 'race');
  svg.setAttribute('viewBox', `0 0 ${wide} ${height + 26 + 18 * runners.length}`);
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', worded('motion', {problem: DATA.problems[p].spec}));
  for (let frame = 0; frame <= RACE_FRAMES; ++frame) {
    const now = clockAt(most, frame), next = frame === RACE_FRAMES ? Infinity : clockAt(most, frame + 1);
    if (frame === 0 || next > now) stage(items, svg, svgElement('text', {x: 10, y: height + 18}, worded('race-clock', {work: now})), frame === 0 ? 0 : now, next);
  }
  runners.forEach(({s, reached}, i) => {
    const y = height + 36 + 18 * i, name = svgElement('text', {x: 26, y, 'data-s': s}, DATA.optimizers[s]);
    svg.append(svgElement('path', {class: 'mark', 'data-s': s, d: `M16 ${y - 4}${DATA.shapes[s]}`}), name);
    if (reached !== null) stage(items, svg, svgElement('text', {x: 190, y}, worded('race-reached', {work: reached})), reached);
  });
  return {svg, items, most, runners};
}

const showWork = (items, work) => items.forEach(({node, from, to}) => node.classList.toggle('off', from > work || to <= work));

// One file that moves by itself: each part is shown and hidden at its share of the time (SMIL, SVG 1.1).
function animatedText({svg, items, most}) {
  const share = (work) => (work <= 1 ? 0 : work > most ? 1 : RACE_END * Math.log(work) / Math.log(most));
  items.forEach(({node, from, to}) => {
    node.classList.remove('off');
    node.setAttribute('data-time', [share(from), share(to)].map((at) => Math.min(1, at).toFixed(4)).join(' '));
  });
  const copy = new DOMParser().parseFromString(svgText(svg), 'image/svg+xml').documentElement;
  for (const one of copy.querySelectorAll('[data-time]')) {
    const [from, to] = one.getAttribute('data-time').split(' ').map(Number), times = [0, ...from > 0 ? [from] : [], ...to < 1 && to > from ? [to] : []], values = [...from > 0 ? ['none'] : [], 'inline', ...to < 1 && to > from ? ['none'] : []];
    one.removeAttribute('data-time');
    if (to <= from && to < 1) one.remove();
    else if (values.length > 1) one.append(svgElement('animate', {attributeName: 'display', calcMode: 'discrete', dur: `${RACE_SECONDS}s`, repeatCount: 'indefinite', keyTimes: times.join(';'), values: values.join(';')}));
  }
  return new XMLSerializer().serializeToString(copy);
}

// An archive of files as tar reads it (POSIX.1-1988, ustar).
function tarOf(files) {
  const encoder = new TextEncoder(), block = 512, parts = files.flatMap(([name, text]) => {
    const bytes = encoder.encode(text), head = new Uint8Array(block), octal = (value, digits) => value.toString(8).padStart(digits, '0');
    for (const [at, field] of [[0, name], [100, '0000644'], [108, '0000000'], [116, '0000000'], [124, octal(bytes.length, 11)], [136, octal(0, 11)], [148, ' '.repeat(8)], [156, '0'], [257, 'ustar'], [263, '00']]) head.set(encoder.encode(field), at);
    head.set(encoder.encode(`${octal(head.reduce((sum, byte) => sum + byte, 0), 6)}\0 `), 148);
    return [head, bytes, new Uint8Array((block - bytes.length % block) % block)];
  });
  return new Blob([...parts, new Uint8Array(2 * block)]);
}

function framesOf({svg, items, most}) {
  return [...Array(RACE_FRAMES + 1).keys()].map((frame) => {
    showWork(items, clockAt(most, frame));
    return [`frame-${String(frame).padStart(2, '0')}.svg`, svgText(svg)];
  });
}

function drawRace(place, races) {
  clearInterval(race.timer);
  race.timer = undefined;
  const {p} = race, scene = sceneOf(p, race.methods), {svg, items, most, runners} = scene, file = `race-${DATA.problems[p].spec.replaceAll(/[^A-Za-z0-9]+/g, '-')}`;
  const clock = element('input', {type: 'range', min: 0, max: RACE_FRAMES, value: race.frame});
  clock.setAttribute('aria-label', worded('race-clock-label'));
  const draw = () => {
    showWork(items, clockAt(most, race.frame));
    clock.value = race.frame;
    clock.setAttribute('aria-valuetext', worded('race-clock', {work: clockAt(most, race.frame)}));
  };
  const button = pressable('Play', undefined, () => (race.timer === undefined ? play() : pause()));
  const pause = () => {
    clearInterval(race.timer);
    race.timer = undefined;
    button.textContent = 'Play';
  };
  const play = () => {
    if (race.frame >= RACE_FRAMES) race.frame = 0;
    button.textContent = 'Pause';
    race.timer = setInterval(() => {
      race.frame = Math.min(RACE_FRAMES, race.frame + 1);
      draw();
      if (race.frame === RACE_FRAMES) pause();
    }, 1000 * RACE_SECONDS * RACE_END / RACE_FRAMES);
  };
  clock.addEventListener('input', () => {
    pause();
    race.frame = Number(clock.value);
    draw();
  });
  const problems = element('select', {}, ...races.map((one) => element('option', {value: one, selected: one === p}, DATA.problems[one].spec)));
  problems.setAttribute('aria-label', worded('race-problem'));
  problems.addEventListener('change', () => {
    race.p = Number(problems.value);
    race.methods = racersOf(race.p);
    drawRace(place, races);
  });
  const able = runnersOf(p).map(({s}) => s), selects = [...Array(Math.min(RACE_MOST, race.methods.length + 1)).keys()].map((i) => methodSelect(race.methods, able, i, () => drawRace(place, races)));
  const kept = (text) => () => {
    pause();
    text();
    draw();
  };
  const seeds = new Set(runners.map(({seed}) => seed)), told = DATA.problems[p].fields === undefined ? 'race-median' : 'race-seed';
  place.replaceChildren(element('style', {}, huesOf(race.methods, '#motion ')), element('p', {className: 'steps'}, element('a', {href: `#problem-${p}`}, worded('motion', {problem: ''})), problems, ' ', ...selects.flatMap((select) => [select, ' ']), button, ' ', clock, ' ',
          pressable(worded('race-frames'), undefined, kept(() => download(`${file}.tar`, 'application/x-tar', tarOf(framesOf(scene))))), ' ',
          pressable(worded('race-animated'), undefined, kept(() => download(`${file}.svg`, 'image/svg+xml', animatedText(scene))))),
      svg, element('p', {className: 'legend'}, worded(told, {seed: [...seeds].join(', ')})));
  draw();
  if (race.frame < RACE_FRAMES) play();
}

function liveRace(place) {
  const races = [...DATA.problems.keys()].filter((p) => runnersOf(p).length > 1), haveArrived = (p) => racersOf(p).length === 3 && runnersOf(p).filter(({s}) => racersOf(p).includes(s)).every(({reached}) => reached !== null);
  if (races.length === 0) return;
  race.p = races.find((p) => DATA.problems[p].fields === undefined && haveArrived(p)) ?? races[0];
  race.methods = racersOf(race.p);
  document.querySelector('.first').append(...place.parentElement.querySelectorAll('figure'));
  race.frame = matchMedia('(prefers-reduced-motion: reduce)').matches ? RACE_FRAMES : 0;
  live(place, () => { if (place.childElementCount === 0) drawRace(place, races); });
}
