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
function newSwitch(caption, choices, chosen, onChoose) {
  const buttons = Object.entries(choices).map(([value, text]) => pressable(text, value === chosen, (event) => {
    buttons.forEach((button) => button.setAttribute('aria-pressed', button === event.currentTarget));
    onChoose(value);
  }));
  const group = element('div', {className: 'switch'}, element('span', {}, caption), ...buttons);
  group.setAttribute('role', 'group');
  group.setAttribute('aria-label', caption);
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

const shellWord = (text) => `'${text.replaceAll("'", "'\\''")}'`;

// The command that repeats the runs of a row: problem, optimizer with all its options, seeds, budget.
function commandOf(row, again, budgets) {
  const [budget, seeds, ...optimizer] = again.split(' ');
  return `./isoline run --problem ${shellWord(DATA.problems[Number(row.dataset.p)].asked)} ` +
      `--optimizer ${shellWord(optimizer.join(' ') || DATA.labels[Number(row.dataset.s)])} --seeds ${seeds} ${budgets[Number(budget)]}`;
}

// To those of the table's rows that stand in the page.
function offerCopies(table) {
  const budgets = JSON.parse(table.dataset.budgets);
  for (const cell of table.querySelectorAll('[data-again]')) {
    if (cell.childElementCount > 0) continue;  // it has one
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

// The table of all cells, with what goes with it, once it is unpacked.
let countRows = () => {};
ON_UNPACK.push((place) => {
  if (place.id !== 'cells') return;
  const table = place.querySelector('table'), wide = document.getElementById('wide');
  if (table === null) return;  // too many
  countRows = makeFilter(document.getElementById('filter'), table, document.getElementById('shown'), () => offerCopies(table));
  document.querySelector('.filter').hidden = false;
  wide.addEventListener('change', () => table.classList.toggle('wide', wide.checked));
});

// Buttons and plots of what was unpacked.
ON_UNPACK.push((place) => {
  for (const button of place.querySelectorAll('[data-command]')) {
    button.hidden = false;
    button.addEventListener('click', () => copyText(button.dataset.command, button));
  }
  place.querySelectorAll('svg.dots').forEach((plot) => live(plot, () => closeRows(plot)));
  if (LIVE.has(place)) {
    STALE.add(place);  // what was drawn of it before was nothing
    soon(place, () => refresh(place));
  }
});

document.documentElement.classList.add('js');
readAddress();
makeBar(document.getElementById('view'));
offerThemes(document.getElementById('theme'));
document.querySelectorAll('table.sortable').forEach(makeSortable);
liveOverview();
livePair(document.getElementById('pair'));
document.querySelectorAll('article.problem').forEach(liveProblem);
document.querySelectorAll('figure.panel').forEach(liveFigure);
FOLLOWERS.push(hideClaims, () => countRows());
makeTabs();
applyView();
openAddress();
