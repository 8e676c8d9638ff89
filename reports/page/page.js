// What the page does: themes, switches, legends, copying, and charts built when first seen.
'use strict';

const DATA = JSON.parse(document.getElementById('data').textContent);
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

function swatch(index) {
  const svg = `<svg width="24" height="8" aria-hidden="true"><line x1="0" y1="4" x2="24" y2="4" stroke="${colourOf(index)}" ` +
      `stroke-width="2.4" stroke-dasharray="${dashOf(index).join(' ')}"/></svg>`;
  return document.createRange().createContextualFragment(svg);
}

// A legend that shows and hides lines; `ranked` is in order of rank.
function fillLegend(legend, ranked, visible, onChange) {
  const show = (some) => () => {
    visible.clear();
    some.forEach((index) => visible.add(index));
    fillLegend(legend, ranked, visible, onChange);
    onChange();
  };
  const presets = ranked.length <= SHOWN_AT_FIRST
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
    button.prepend(swatch(index));
    return button;
  });
  legend.replaceChildren(...presets, ...names);
}

function newLegend(ranked, visible, onChange) {
  const legend = document.createElement('div');
  legend.className = 'names';
  fillLegend(legend, ranked, visible, onChange);
  return legend;
}

// Draws into a place anew, whatever it held before.
function redrawer(place, draw) {
  let chart = null;
  return () => {
    chart?.destroy();
    place.replaceChildren();
    chart = draw(place);
  };
}

function buildProfile(section) {
  const place = section.querySelector('.chart');
  const all = DATA.optimizers.map((_, index) => index);
  const visible = new Set(all.slice(0, SHOWN_AT_FIRST));
  const draw = redrawer(place, () => drawProfile(place, DATA.profiles[tolerance], visible));
  const legend = newLegend(all, visible, draw);
  place.after(legend);
  redraws.push(() => { draw(); fillLegend(legend, all, visible, draw); });
  draw();
}

function buildProblem(article) {
  const problem = DATA.problems[Number(article.dataset.problem)];
  const ranked = problem.curves.map((curve) => curve.s);
  if (ranked.length === 0) return;
  const state = {problem, visible: new Set(ranked.slice(0, SHOWN_AT_FIRST)), horizontal: 'work', vertical: 'loss'};
  const curves = article.querySelector('.curves');
  const place = document.createElement('div');
  const draws = [redrawer(place, () => drawCurves(place, state))];
  for (const plane of article.querySelectorAll('.plane'))
    draws.push(redrawer(plane, () => drawPlane(plane, state, plane.dataset.space)));
  const drawAll = () => draws.forEach((draw) => draw());
  const choose = (key) => (value) => { state[key] = value; draws[0](); };
  curves.append(newSwitch('against', {iterations: 'iterations', work: 'work', seconds: 'time'}, 'work', choose('horizontal')));
  if (problem.curves.some((curve) => curve.x_error.some((error) => error !== null)))
    curves.append(newSwitch('show', {loss: 'loss', x_error: 'error in x'}, 'loss', choose('vertical')));
  const legend = newLegend(ranked, state.visible, drawAll);
  curves.append(place, legend);
  redraws.push(() => { drawAll(); fillLegend(legend, ranked, state.visible, drawAll); });
  drawAll();
}

function whenSeen(elements, build) {
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries)
      if (entry.isIntersecting) {
        observer.unobserve(entry.target);
        build(entry.target);
      }
  }, {rootMargin: '300px'});
  elements.forEach((element) => observer.observe(element));
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
makeFilter(document.getElementById('filter'), document.getElementById('detail-table'), document.getElementById('shown'));
whenSeen([document.getElementById('profile')], buildProfile);
whenSeen(document.querySelectorAll('article.problem'), buildProblem);
