// The bar that chooses what is shown: lists of methods and problems, the measure, the tolerance.
function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

const groupOf = {
  s: (index) => DATA.kinds[index],
  p: (index) => DATA.problems[index].group,
};

// Names of the presets, and what each shows.
function presetsOf(kind) {
  const all = KINDS[kind].names.map((_, index) => index);
  const presets = {all, none: []};
  if (kind === 's' && DATA.privileges.some((sees) => sees !== '') && DATA.privileges.includes('')) {
    presets['without extra information'] = all.filter((index) => DATA.privileges[index] === '');
    presets['with extra information'] = all.filter((index) => DATA.privileges[index] !== '');
  }
  if (kind === 's' && all.length > 10) presets['best 10'] = all.slice(0, 10);
  return presets;
}

function show(kind, indices) {
  const shown = new Set(indices);
  changeView(() => {
    view.hidden[kind] = new Set(KINDS[kind].names.map((_, index) => index).filter((index) => !shown.has(index)));
  });
}

function choiceOf(kind, index) {
  const box = element('input', {type: 'checkbox', checked: isShown(kind, index)});
  box.dataset.choice = index;
  box.addEventListener('change', () => changeView(() => {
    if (box.checked) view.hidden[kind].delete(index); else view.hidden[kind].add(index);
  }));
  return element('label', {}, box, KINDS[kind].names[index]);
}

// One group a family, or a problem with several settings; its name shows it alone.
function groupElement(kind, name, indices) {
  const only = pressable('only', undefined, () => show(kind, indices));
  only.setAttribute('aria-label', `only ${name}`);
  const group = element('fieldset', {}, element('legend', {}, name, ' ', only));
  group.append(element('div', {className: 'choices'}, ...indices.map((index) => choiceOf(kind, index))));
  return group;
}

function fillPanel(kind, panel) {
  const search = element('input', {type: 'search', placeholder: 'search', autocomplete: 'off'});
  search.setAttribute('aria-label', kind === 's' ? 'Search methods' : 'Search problems');
  const presets = element('div', {className: 'presets'},
      ...Object.entries(presetsOf(kind)).map(([name, indices]) => pressable(name, undefined, () => show(kind, indices))));
  const groups = new Map();
  KINDS[kind].names.forEach((_, index) => {
    const name = groupOf[kind](index);
    groups.set(name, [...groups.get(name) ?? [], index]);
  });
  const isGrouped = groups.size > 1;
  const lists = isGrouped
      ? [...groups].map(([name, indices]) => groupElement(kind, name, indices))
      : [element('fieldset', {}, element('div', {className: 'choices'}, ...KINDS[kind].names.map((_, index) => choiceOf(kind, index))))];
  search.addEventListener('input', () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const label of panel.querySelectorAll('label'))
      label.hidden = !words.every((word) => label.textContent.toLowerCase().includes(word));
    for (const list of lists) list.hidden = ![...list.querySelectorAll('label')].some((label) => !label.hidden);
  });
  panel.append(search, presets, ...lists);
}

// Closed by Escape, and by a press elsewhere; filled when first opened.
function makePick(pick) {
  const kind = pick.dataset.kind, panel = pick.querySelector('.panel');
  const fillOnce = () => { if (panel.childElementCount === 0) fillPanel(kind, panel); };
  pick.addEventListener('toggle', () => {
    if (!pick.open) return;
    fillOnce();
    panel.querySelector('input').focus();
  });
  pick.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape') return;
    pick.open = false;
    pick.querySelector('summary').focus();
  });
  document.addEventListener('pointerdown', (event) => { if (!pick.contains(event.target)) pick.open = false; });
  FOLLOWERS.push(() => {
    const count = shownOf(kind).length, all = KINDS[kind].names.length;
    pick.querySelector('output').textContent = count === all ? 'all' : `${count}/${all}`;
    pick.classList.toggle('active', view.hidden[kind].size > 0);
    for (const box of panel.querySelectorAll('input[type=checkbox]')) box.checked = isShown(kind, Number(box.dataset.choice));
  });
}

function makeSlider(slider) {
  slider.max = TARGETS.length - 1;
  slider.addEventListener('input', () => changeView(() => { view.target = TARGETS[slider.value]; }));
  FOLLOWERS.push(() => {
    slider.value = TARGETS.indexOf(view.target);
    slider.setAttribute('aria-valuetext', `τ = ${tauName(view.target)}`);
    document.getElementById('tau').textContent = tauName(view.target);
  });
}

function makeMeasures(place) {
  for (const [index, name] of MEASURES.entries()) {
    const button = pressable(name, index === view.measure, () => changeView(() => { view.measure = index; }));
    place.append(button);
    FOLLOWERS.push(() => button.setAttribute('aria-pressed', index === view.measure));
  }
}

// The note about a selection of rows, or a tolerance other than the report's.
function noteOf() {
  const notes = [];
  if (isFiltered())
    notes.push(`${shownOf('s').length} of ${KINDS.s.names.length} methods and ${shownOf('p').length} of ${KINDS.p.names.length} ` +
        'problems are shown; all values still refer to all methods and problems.');
  if (!isOwn())
    notes.push(`Tables and curves are for τ = ${tauName(view.target)} by ${measureNow().counted}; sentences, intervals and statistics are ` +
        `for the report’s τ = ${tauName(DEFAULT_TARGET)} by ${DATA.measures[DEFAULT_MEASURE].counted}.`);
  return notes.join(' ');
}

function makeBar(bar) {
  bar.hidden = false;
  bar.querySelectorAll('details').forEach(makePick);
  makeMeasures(document.getElementById('measures'));
  makeSlider(document.getElementById('target'));
  const reset = document.getElementById('reset'), told = document.getElementById('told'), note = document.getElementById('filtered');
  reset.addEventListener('click', () => changeView(() => {
    Object.assign(view, {target: DEFAULT_TARGET, measure: DEFAULT_MEASURE, hidden: {s: new Set(), p: new Set()}});
  }));
  FOLLOWERS.push(() => {
    const text = noteOf();
    reset.hidden = text === '';
    note.hidden = text === '';
    note.textContent = text;
    told.textContent = text;
  });
}
