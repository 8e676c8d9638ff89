// The bar that chooses what is shown: lists of optimizers and problems, and the slider of tolerance.
'use strict';

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

const groupOf = {
  s: (index) => DATA.families[index],
  p: (index) => DATA.problems[index].name,
};

// Names of the presets, and what each shows.
function presetsOf(kind) {
  const all = KINDS[kind].names.map((_, index) => index);
  const presets = {all, none: []};
  if (kind === 's' && DATA.privileges.some((sees) => sees !== '') && DATA.privileges.includes('')) {
    presets['not privileged'] = all.filter((index) => DATA.privileges[index] === '');
    presets['privileged'] = all.filter((index) => DATA.privileges[index] !== '');
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
  search.setAttribute('aria-label', kind === 's' ? 'Search optimizers' : 'Search problems');
  const presets = element('div', {className: 'presets'},
      ...Object.entries(presetsOf(kind)).map(([name, indices]) => pressable(name, undefined, () => show(kind, indices))));
  const groups = new Map();
  KINDS[kind].names.forEach((_, index) => {
    const name = groupOf[kind](index);
    groups.set(name, [...groups.get(name) ?? [], index]);
  });
  const isGrouped = kind === 's' && groups.size > 1;
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
  const presets = document.getElementById('target-presets');
  for (const target of DATA.rungs) {
    const button = pressable(tauName(target), target === view.target, () => changeView(() => { view.target = target; }));
    button.dataset.target = target;
    presets.append(button);
  }
  slider.addEventListener('input', () => changeView(() => { view.target = Number(slider.value); }));
  FOLLOWERS.push(() => {
    slider.value = view.target;
    slider.setAttribute('aria-valuetext', `τ = ${tauName(view.target)}`);
    document.getElementById('tau').textContent = tauName(view.target);
    for (const button of presets.children) button.setAttribute('aria-pressed', Number(button.dataset.target) === view.target);
  });
}

function makeBar(bar) {
  bar.hidden = false;
  bar.querySelectorAll('details').forEach(makePick);
  makeSlider(document.getElementById('target'));
  const reset = document.getElementById('reset'), told = document.getElementById('told');
  reset.addEventListener('click', () => changeView(() => {
    view.target = DEFAULT_TARGET;
    view.hidden = {s: new Set(), p: new Set()};
  }));
  FOLLOWERS.push(() => {
    reset.hidden = isPlain();
    told.textContent = `${shownOf('s').length} of ${KINDS.s.names.length} optimizers and ${shownOf('p').length} of ` +
        `${KINDS.p.names.length} problems are shown, to τ = ${tauName(view.target)}`;
  });
}
