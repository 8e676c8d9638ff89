// What the page does: themes, switches, copying, and what is built when first seen.
'use strict';

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

// Draws into a place anew, whatever it held before; `redraw.chart` is what stands there.
function redrawer(place, draw) {
  const redraw = () => {
    redraw.chart?.destroy();
    place.replaceChildren();
    redraw.chart = draw(place);
  };
  return redraw;
}

// The parts of a page that follow the view: each is drawn when first seen, and after each change.
function liveProfile(section) {
  const place = section.querySelector('.chart');
  if (place === null) return;  // too few problems
  const reading = document.getElementById('profile-reading'), plainReading = reading.textContent;
  const all = DATA.optimizers.map((_, index) => index), choice = newChoice(all);
  let profile;
  const draw = redrawer(place, () => drawProfile(place, profile, choice(), reading.textContent));
  const legend = newLegend(all, draw, (index) => highlight(draw.chart, index));
  place.after(legend.place);
  live(section, () => {
    profile = profileOf(view.target);
    reading.textContent = isPlain() ? plainReading : profileReading(profile);
    draw();
    legend.fill(choice());
  });
}

function curveSwitches(state, problem, redraw) {
  const choose = (key) => (value) => { state[key] = value; redraw(); };
  const switches = [newSwitch('against', {iterations: 'iterations', work: 'work', seconds: 'time'}, 'work', choose('horizontal'))];
  if (problem.curves.some((curve) => curve.x_error !== undefined))
    switches.push(newSwitch('show', {gap: 'loss', x_error: 'error in x'}, state.vertical, choose('vertical')));
  if (problem.curves.some((curve) => curve.gap_low !== undefined))
    switches.push(newSwitch('seeds', {band: 'band', median: 'median'}, 'band', choose('seeds')));
  return switches;
}

// Built at the first call, drawn anew at each.
function problemDrawer(article, problem) {
  const ranked = problem.curves.map((curve) => curve.s), choice = newChoice(ranked);
  const aimed = problem.goal === undefined ? 'gap' : 'x_error';  // what the user of the problem wants
  const state = {problem, visible: new Set(), horizontal: 'work', vertical: aimed, seeds: 'band'};
  const reading = article.querySelector('.reading'), plainReading = reading.textContent;
  const curves = article.querySelector('.curves'), place = document.createElement('div');
  const draws = [redrawer(place, () => drawCurves(place, state, reading.textContent))];
  for (const plane of article.querySelectorAll('.plane'))
    draws.push(redrawer(plane, () => drawPlane(plane, state, plane.dataset.space)));
  const drawAll = () => draws.forEach((draw) => draw());
  const short = (problem.x?.paths ?? []).filter(isShort).map((path) => path.s);
  const legend = newLegend(ranked, drawAll, (index) => draws.forEach((draw) => highlight(draw.chart, index)), new Set(short));
  curves.append(...curveSwitches(state, problem, draws[0]), place, legend.place);
  return () => {
    reading.textContent = isPlain() ? plainReading : curveReading(problem);
    drawReached(article.querySelector('.reached'), problem, false);
    state.visible = choice();
    drawAll();
    legend.fill(state.visible);
  };
}

function liveProblem(article) {
  const problem = DATA.problems[Number(article.dataset.p)];
  if (problem.curves.length === 0) return;
  let draw;
  live(article, () => {
    draw ??= problemDrawer(article, problem);
    draw();
  });
}

function liveTables() {
  const standings = document.getElementById('standings-table'), works = document.getElementById('works');
  let areChanged = false, isExplained = false;  // as they come they are right
  FOLLOWERS.push(() => { areChanged = areChanged || !isPlain(); });
  live(standings, () => { if (areChanged) drawStandings(standings); });
  live(works, () => {
    const matrix = unpacked(works);
    if (!isExplained) explainMatrix(matrix, detailTable);
    isExplained = true;
    if (areChanged) drawMatrix(matrix);
  });
}

function offerThemes(button) {
  const label = () => { button.textContent = isDark() ? 'Light' : 'Dark'; };
  const redrawAll = () => { label(); refreshAll(); };
  button.hidden = false;
  label();
  button.addEventListener('click', () => {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    redrawAll();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redrawAll);
}

// Tables too large to be built before they are seen wait as text; without scripts they stand as they are.
function unpacked(place) {
  const packed = place.querySelector('noscript');
  if (packed !== null) {
    place.innerHTML = packed.textContent;
    place.querySelectorAll('table.sortable').forEach(makeSortable);
  }
  return place.querySelector('table');
}

const shellWord = (text) => `'${text.replaceAll("'", "'\\''")}'`;

// The command that repeats the runs of a row: problem, optimizer with all its options, seeds, budget.
function commandOf(row, again, budgets) {
  const [budget, seeds, ...optimizer] = again.split(' ');
  return `./isoline run --problem ${shellWord(DATA.problems[Number(row.dataset.p)].asked)} ` +
      `--optimizer ${shellWord(optimizer.join(' ') || DATA.optimizers[Number(row.dataset.s)])} --seeds ${seeds} ${budgets[Number(budget)]}`;
}

function offerCopies(table) {
  const budgets = JSON.parse(table.dataset.budgets);
  for (const cell of table.querySelectorAll('[data-again]')) {
    const button = pressable('copy', undefined, () => copyText(button.title, button));
    button.className = 'copy';
    button.title = commandOf(cell.parentElement, cell.dataset.again, budgets);
    cell.append(button);
  }
}

async function copyText(text, button) {
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = 'copied';
  } catch {  // no clipboard from a file: the command is shown instead
    window.prompt('Command', text);
  }
}

// The table of all cells, with what goes with it, built when first seen or asked for.
const detailTable = (() => {
  const place = document.getElementById('cells');
  let count;
  const build = () => {
    if (count !== undefined) return place.querySelector('table');
    const table = unpacked(place), wide = document.getElementById('wide');
    offerCopies(table);
    count = makeFilter(document.getElementById('filter'), table, document.getElementById('shown'));
    document.querySelector('.filter').hidden = false;
    wide.addEventListener('change', () => table.classList.toggle('wide', wide.checked));
    return table;
  };
  live(place, () => { build(); count(); });
  return build;
})();

document.documentElement.classList.add('js');
readAddress();
makeBar(document.getElementById('view'));
offerThemes(document.getElementById('theme'));
document.querySelectorAll('table.sortable').forEach(makeSortable);
makeGlance(document.querySelector('.glance'));
liveTables();
liveProfile(document.getElementById('profile'));
document.querySelectorAll('article.problem').forEach(liveProblem);
document.querySelectorAll('figure.panel').forEach(liveFigure);
document.querySelectorAll('svg.dots').forEach((plot) => live(plot, () => closeRows(plot)));
FOLLOWERS.push(hideClaims);
for (const button of document.querySelectorAll('[data-command]')) {
  button.hidden = false;
  button.addEventListener('click', () => copyText(button.dataset.command, button));
}
applyView();
leadToClaims();
