// The behaviour of the page: themes, switches, copying, and parts that are built when first shown.
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

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

function offerThemes(button) {
  const label = () => { button.textContent = isDark() ? 'Light' : 'Dark'; };
  button.hidden = false;
  label();
  button.addEventListener('click', () => {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    label();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', label);
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
  table.tHead.rows[0].append(element('th', {scope: 'col'}, 'command'));
  for (const row of table.tBodies[0].rows) {
    const {command} = cellOf(DATA.problems[row.dataset.p], Number(row.dataset.s)), last = row.lastElementChild;
    if (last.colSpan > 1) last.colSpan += 1;
    if (command === undefined) continue;
    const button = element('button', {className: 'copy'}, 'copy');
    button.dataset.command = command;
    row.append(element('td', {className: 'text'}, button));
  }
  countRows = makeFilter(document.getElementById('filter'), table, document.getElementById('shown'));
  document.querySelector('.filter').hidden = false;
  wide.addEventListener('change', () => table.classList.toggle('wide', wide.checked));
});

// What was drawn of a place before it was unpacked was nothing.
ON_UNPACK.push((place) => {
  if (!LIVE.has(place)) return;
  STALE.add(place);
  soon(place, () => refresh(place));
});
document.addEventListener('click', ({target}) => {
  const button = target.closest('[data-command]');
  if (button !== null) copyText(button.dataset.command, button);
});

document.documentElement.classList.add('js');
document.documentElement.style.setProperty('--keys', JSON.stringify(worded('keys')));
readAddress();
makeBar(document.getElementById('view'));
offerThemes(document.getElementById('theme'));
document.querySelectorAll('table.sortable').forEach(makeSortable);
document.querySelectorAll('main table:not(#standings-table, #heat)').forEach(addCopies);
document.querySelectorAll('.first figure, #fit figure').forEach((place) => ON_UNPACK.forEach((made) => made(place)));
liveOverview();
livePair(document.getElementById('pair'));
liveChoose(document.getElementById('means'));
livePrices(document.getElementById('prices'));
document.querySelectorAll('article.problem').forEach(liveProblem);
FOLLOWERS.push(hideClaims, () => countRows());
explainTerms();
offerGuide(document.getElementById('docs'));
makeTabs();
applyView();
openAddress();
