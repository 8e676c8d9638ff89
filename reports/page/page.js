// What the page does: themes, switches, legends, copying, and charts built when first seen.
'use strict';

const TOLERANCES = ['1e-1', '1e-3', '1e-6'];
let tolerance = TOLERANCES.length - 1;
const redraws = [];  // one for each chart group already seen

function pressable(text, isPressed, onPress) {
  const button = document.createElement('button');
  button.type = 'button';
  button.textContent = text;
  if (isPressed !== undefined) button.setAttribute('aria-pressed', isPressed);
  button.addEventListener('click', onPress);
  return button;
}

// A group of buttons of which one is pressed. choices: {value: label}.
function fillSwitch(group, caption, choices, chosen, onChoose) {
  const label = document.createElement('span');
  label.textContent = caption;
  const buttons = Object.entries(choices).map(([value, text]) => pressable(text, value === chosen, (event) => {
    buttons.forEach((button) => button.setAttribute('aria-pressed', button === event.currentTarget));
    onChoose(value);
  }));
  group.replaceChildren(label, ...buttons);
  group.hidden = false;
}

function newSwitch(caption, choices, chosen, onChoose) {
  const group = document.createElement('div');
  group.className = 'switch';
  group.setAttribute('role', 'group');
  group.setAttribute('aria-label', caption);
  fillSwitch(group, caption, choices, chosen, onChoose);
  return group;
}

const GLYPHS = {circle: '○', rect: '□', triangle: '△', rectRot: '◇', crossRot: '×'};

// The line of the curves; with the marker of the path where the path has them.
function swatch(index, hasMarkers) {
  const glyph = hasMarkers
      ? `<text x="34" y="8" font-size="13" text-anchor="middle" fill="${colourOf(index)}">${GLYPHS[STYLES[index].marker]}</text>` : '';
  const svg = `<svg width="${hasMarkers ? 42 : 24}" height="12" aria-hidden="true"><line x1="0" y1="6" x2="24" y2="6" ` +
      `stroke="${colourOf(index)}" stroke-width="2.4" stroke-dasharray="${dashOf(index).join(' ')}"/>${glyph}</svg>`;
  return document.createRange().createContextualFragment(svg);
}

// A legend that shows and hides lines; `ranked` is in order of rank.
function fillLegend(legend, ranked, visible, onChange, onPoint) {
  const show = (some) => () => {
    visible.clear();
    some.forEach((index) => visible.add(index));
    fillLegend(legend, ranked, visible, onChange, onPoint);
    onChange();
  };
  const presets = ranked.length <= FEW
      ? []
      : [pressable(`best ${SHOWN_AT_FIRST}`, undefined, show(ranked.slice(0, SHOWN_AT_FIRST))),
         pressable('all', undefined, show(ranked)), pressable('none', undefined, show([]))];
  presets.forEach((button) => button.classList.add('preset'));
  const names = ranked.map((index) => {
    const button = pressable(DATA.optimizers[index], visible.has(index), () => {
      if (!visible.delete(index)) visible.add(index);
      button.setAttribute('aria-pressed', visible.has(index));
      onChange();
    });
    button.prepend(swatch(index, legend.withMarkers?.has(index)));
    for (const [event, lit] of [['pointerenter', index], ['pointerleave', undefined], ['focus', index], ['blur', undefined]])
      button.addEventListener(event, () => onPoint(lit));
    return button;
  });
  legend.replaceChildren(...presets, ...names);
}

function newLegend(ranked, visible, onChange, onPoint, withMarkers = new Set()) {
  const legend = document.createElement('div');
  legend.withMarkers = withMarkers;
  legend.className = 'names';
  fillLegend(legend, ranked, visible, onChange, onPoint);
  return legend;
}

const shownAtFirst = (ranked) => new Set(ranked.length <= FEW ? ranked : ranked.slice(0, SHOWN_AT_FIRST));

// Draws into a place anew, whatever it held before; `redraw.chart` is what stands there.
function redrawer(place, draw) {
  const redraw = () => {
    redraw.chart?.destroy();
    place.replaceChildren();
    redraw.chart = draw(place);
  };
  return redraw;
}

function buildProfile(section) {
  const place = section.querySelector('.chart');
  if (place === null) return;  // too few problems
  const all = DATA.optimizers.map((_, index) => index);
  const visible = shownAtFirst(all);
  const draw = redrawer(place, () => drawProfile(place, DATA.profiles[tolerance], visible));
  const point = (index) => highlight(draw.chart, index);
  const legend = newLegend(all, visible, draw, point);
  place.after(legend);
  redraws.push(() => { draw(); fillLegend(legend, all, visible, draw, point); });
  draw();
}

function buildProblem(article) {
  const problem = DATA.problems[Number(article.dataset.problem)];
  const ranked = problem.curves.map((curve) => curve.s);
  if (ranked.length === 0) return;
  const state = {problem, visible: shownAtFirst(ranked), horizontal: 'work', vertical: 'gap'};
  const curves = article.querySelector('.curves');
  const place = document.createElement('div');
  const draws = [redrawer(place, () => drawCurves(place, state))];
  for (const plane of article.querySelectorAll('.plane'))
    draws.push(redrawer(plane, () => drawPlane(plane, state, plane.dataset.space)));
  const drawAll = () => draws.forEach((draw) => draw());
  const point = (index) => draws.forEach((draw) => highlight(draw.chart, index));
  const choose = (key) => (value) => { state[key] = value; draws[0](); };
  curves.append(newSwitch('against', {iterations: 'iterations', work: 'work', seconds: 'time'}, 'work', choose('horizontal')));
  if (problem.curves.some((curve) => curve.x_error.some((error) => error !== null)))
    curves.append(newSwitch('show', {gap: 'loss', x_error: 'error in x'}, 'gap', choose('vertical')));
  const short = (problem.x?.paths ?? []).filter(isShort).map((path) => path.s);
  const legend = newLegend(ranked, state.visible, drawAll, point, new Set(short));
  curves.append(place, legend);
  redraws.push(() => { drawAll(); fillLegend(legend, ranked, state.visible, drawAll, point); });
  drawAll();
}

// Once each, when about to be seen; all of them before printing, since paper does not scroll.
function whenSeen(elements, build) {
  const waiting = new Set(elements);
  const buildOnce = (element) => {
    observer.unobserve(element);
    if (waiting.delete(element)) build(element);
  };
  const observer = new IntersectionObserver(
      (entries) => entries.filter((entry) => entry.isIntersecting).forEach((entry) => buildOnce(entry.target)),
      {rootMargin: '300px'});
  waiting.forEach((element) => observer.observe(element));
  addEventListener('beforeprint', () => [...waiting].forEach(buildOnce));
}

function chooseTolerance(chosen) {
  tolerance = Number(chosen);
  for (const pane of document.querySelectorAll('.pane'))
    pane.classList.toggle('shown', Number(pane.dataset.tau) === tolerance);
  for (const group of document.querySelectorAll('.switch.tau'))
    fillSwitch(group, 'to τ =', {...TOLERANCES}, String(tolerance), (value) => {
      const position = [...document.querySelectorAll('.switch.tau')].indexOf(group);
      chooseTolerance(value);
      document.querySelectorAll('.switch.tau')[position].querySelectorAll('button')[tolerance].focus();
      redraws.forEach((redraw) => redraw());
    });
}

function offerThemes(button) {
  const label = () => { button.textContent = isDark() ? 'Light' : 'Dark'; };
  const redrawAll = () => { label(); redraws.forEach((redraw) => redraw()); };
  button.hidden = false;
  label();
  button.addEventListener('click', () => {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    redrawAll();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redrawAll);
}

// A button in each cell that holds a command.
function offerCopies() {
  for (const cell of document.querySelectorAll('[data-copy]')) {
    const button = pressable('copy', undefined, () => copyFrom(cell, button));
    button.className = 'copy';
    button.title = 'Copy the command that repeats the first of these runs';
    cell.append(button);
  }
}

async function copyFrom(cell, button) {
  try {
    await navigator.clipboard.writeText(cell.dataset.copy);
    button.textContent = 'copied';
  } catch {  // no clipboard from a file: the command is shown instead
    window.prompt('Command', cell.dataset.copy);
  }
}

document.documentElement.classList.add('js');
chooseTolerance(tolerance);
offerThemes(document.getElementById('theme'));
offerCopies();
document.querySelectorAll('table.sortable').forEach(makeSortable);
document.querySelector('.filter').hidden = false;
explainMatrices();
document.getElementById('wide').addEventListener('change', (event) =>
  document.getElementById('detail-table').classList.toggle('wide', event.target.checked));
makeFilter(document.getElementById('filter'), document.getElementById('detail-table'), document.getElementById('shown'));
whenSeen([document.getElementById('profile')], buildProfile);
whenSeen(document.querySelectorAll('article.problem'), buildProblem);
whenSeen(document.querySelectorAll('figure.panel'), buildFigure);
