// The selection of the reader: the methods and problems, the tolerance, and the measure. Stored in
// the address, so that a view can be shared. It applies to every element with data-s or data-p,
// whichever script made it. A filter hides elements and does not change any number.
const TARGETS = DATA.targets;  // those there are medians to, of τ = 10^(−j/5)
const DEFAULT_TARGET = DATA.rungs[DATA.rungs.length - 1];  // the report's own
const KINDS = {s: {names: DATA.optimizers, address: 'o'}, p: {names: DATA.problems.map((problem) => problem.spec), address: 'p'}};
const MEASURES = DATA.measures.map((measure) => measure.name);
const DEFAULT_MEASURE = MEASURES.indexOf(DATA.by);
const view = {target: DEFAULT_TARGET, measure: DEFAULT_MEASURE, hidden: {s: new Set(), p: new Set()}};
const measureNow = () => DATA.measures[view.measure];

const isShown = (kind, index) => !view.hidden[kind].has(index);
const shownOf = (kind) => KINDS[kind].names.map((_, index) => index).filter((index) => isShown(kind, index));
const isFiltered = () => view.hidden.s.size > 0 || view.hidden.p.size > 0;
const isOwn = () => view.target === DEFAULT_TARGET && view.measure === DEFAULT_MEASURE;  // as the report was made
const tauOf = (target) => 10 ** (-target / 5);

function tauName(target) {
  return target % 5 === 0 ? (target === 0 ? '1' : `1e-${target / 5}`) : tauOf(target).toExponential(1).replace('.0e', 'e');
}

// 1.1 times the floor of the error in x, relative to ‖x*‖, replaces a smaller τ.
function goalOf({goal = 0, spec}) {
  if (spec.includes('goal=fit')) return worded('goal-fit');
  return goal > tauOf(view.target) ? `an error in x of ${goal} ‖x*‖ (1.1 times the floor)` : `τ = ${tauName(view.target)}`;
}

// Methods by name: the audit has one row for all settings of a method.
function hiddenMethods() {
  const shown = new Set(shownOf('s').map((index) => DATA.methods[index]));
  return [...new Set(DATA.methods)].filter((method) => !shown.has(method));
}

// A hue for each of these methods, in their order.
const huesOf = (methods, place = '') => methods.map((s, i) => `${place}[data-s="${s}"], ${place}[data-look="${CSS.escape(DATA.methods[s])}"] { --series: var(--s${i}); }`).join('\n');

const RULES = document.body.appendChild(document.createElement('style'));

function hideElements() {
  const selectors = ['s', 'p'].flatMap((kind) => [...view.hidden[kind]].map((index) => `[data-${kind}="${index}"]`));
  selectors.push(...hiddenMethods().map((method) => `[data-method="${CSS.escape(method)}"]`));
  const shown = shownOf('s');  // up to eight have a hue each, which the address keeps
  RULES.textContent = `${selectors.length === 0 ? '' : `:is(${selectors.join(',')}) { display: none !important; }`}\n${isFiltered() && shown.length <= 8 ? huesOf(shown) : ''}`;
  document.documentElement.classList.toggle('filtered', isFiltered());
}

// The shorter of both lists: "o" names those shown, "-o" those left out.
function writeAddress() {
  const asked = new URLSearchParams();
  for (const [kind, {names, address}] of Object.entries(KINDS)) {
    const hidden = [...view.hidden[kind]].sort((a, b) => a - b), shown = shownOf(kind);
    if (hidden.length === 0) continue;
    const isShort = hidden.length <= shown.length || shown.length === 0;
    for (const index of isShort ? hidden : shown) asked.append(isShort ? `-${address}` : address, names[index]);
  }
  if (view.target !== DEFAULT_TARGET) asked.set('tau', tauName(view.target));
  if (view.measure !== DEFAULT_MEASURE) asked.set('by', MEASURES[view.measure]);
  if (pair.isChosen) for (const s of pair.methods) asked.append('vs', DATA.optimizers[s]);
  writeMeans(asked);
  writePrices(asked);
  const text = asked.toString();
  try {
    history.replaceState(null, '', (text === '' ? location.pathname : `?${text}`) + location.hash);
  } catch { /* a page inside another may not have an address of its own */ }
}

function readAddress() {
  const asked = new URLSearchParams(location.search);
  for (const [kind, {names, address}] of Object.entries(KINDS)) {
    const shown = asked.getAll(address), hidden = asked.getAll(`-${address}`);
    names.forEach((name, index) => {
      if (hidden.includes(name) || (shown.length > 0 && !shown.includes(name))) view.hidden[kind].add(index);
    });
  }
  readMeans(asked);
  readPrices(asked);
  const tau = Number(asked.get('tau'));
  if (MEASURES.includes(asked.get('by'))) view.measure = MEASURES.indexOf(asked.get('by'));
  const wanted = -5 * Math.log10(tau);
  if (tau > 0) view.target = TARGETS.reduce((best, target) => (Math.abs(target - wanted) < Math.abs(best - wanted) ? target : best));
}

// One task a frame, in the order of their keys: a press is answered before all that it asks for is
// drawn.
const TASKS = new Map();
let isWorking = false;
const nextFrame = (work) => requestAnimationFrame(() => setTimeout(work));

function nextTask() {
  const [[key, task]] = TASKS;
  TASKS.delete(key);
  try {
    task();
  } finally {
    isWorking = TASKS.size > 0;
    if (isWorking) nextFrame(nextTask);
  }
}

function soon(key, task) {
  TASKS.set(key, task);
  if (isWorking) return;
  isWorking = true;
  nextFrame(nextTask);
}

// Redrawn when the view changes: at once if visible, else when it comes into sight.
const LIVE = new Map(), STALE = new Set();

function refresh(element) {
  if (STALE.delete(element)) LIVE.get(element)();
}

const SIGHT = new IntersectionObserver(
    (entries) => entries.filter((entry) => entry.isIntersecting).forEach(({target}) => soon(target, () => refresh(target))),
    {rootMargin: '300px'});

function live(element, draw) {
  if (element === null) return;
  LIVE.set(element, draw);
  STALE.add(element);
  SIGHT.observe(element);
}

function refreshAll() {
  for (const element of LIVE.keys()) {
    STALE.add(element);
    SIGHT.unobserve(element);
    SIGHT.observe(element);  // tells at once whether it is seen
  }
}

const FOLLOWERS = [];  // called after each change, before anything is drawn
let isChanging = false;

function changeView(change) {
  change();
  if (isChanging) return;
  isChanging = true;
  requestAnimationFrame(() => {
    isChanging = false;
    applyView();
    writeAddress();
  });
}

function applyView() {
  hideElements();
  FOLLOWERS.forEach((follow) => follow());
  refreshAll();
}
