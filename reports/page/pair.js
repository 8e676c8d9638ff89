// Two methods of the reader's choice. `pairOf` is the one function of these scripts that makes
// figures: those of `pairing_of` in the report, which a test of the browser holds it to for every pair.
const MOST_DOUBLINGS = 6;  // unsolved counts as 64 times as much

function medianOf(ascending) {
  const half = Math.floor(ascending.length / 2);
  return ascending.length % 2 === 1 ? ascending[half] : (ascending[half - 1] + ascending[half]) / 2;
}

// log2 of what a takes over what b takes; unsolved against solved is the most.
function doublingsOf(a, b) {
  if (a === Infinity && b === Infinity) return 0;
  if (a === Infinity || b === Infinity) return a === Infinity ? MOST_DOUBLINGS : -MOST_DOUBLINGS;
  return Math.min(MOST_DOUBLINGS, Math.max(-MOST_DOUBLINGS, Math.log2(atLeast(a)) - Math.log2(atLeast(b))));
}

// The order statistics that the test of signs does not reject at 0.05; of fewer than six the range.
function medianInterval(ascending) {
  const n = ascending.length;
  let k = n > 1000 ? Math.floor(n / 2 - 1.959964 * Math.sqrt(n) / 2) : 0, term = n > 1000 ? 1 : 0.5 ** n, misses = term;
  while (misses <= 0.025 && 2 * k < n) {
    ++k;
    term *= (n - k + 1) / k;
    misses += term;
  }
  const first = Math.max(k, 1) - 1;
  return [ascending[first], ascending[n - 1 - first]];
}

// Problems of one name count as one: the median over the settings that both were run on.
function pairOf(a, b) {
  const names = new Map();
  DATA.problems.forEach((problem, p) => {
    const mine = cellOf(problem, a), other = cellOf(problem, b);
    if (!problem.isOrdered || mine === undefined || other === undefined) return;
    const [x, y] = [takenBy(mine), takenBy(other)], one = names.get(problem.name) ?? {name: problem.name, values: [], settings: [], isSolved: false};
    names.set(problem.name, one);
    one.isSolved = one.isSolved || x < Infinity || y < Infinity;
    one.values.push(doublingsOf(x, y));
    one.settings.push({p, a: x, b: y});
  });
  const all = [...names.values()], solved = all.filter((one) => one.isSolved)
      .map((one) => ({...one, doublings: medianOf([...one.values].sort((x, y) => x - y))}));
  const sorted = solved.map((one) => one.doublings).sort((x, y) => x - y), count = (isCounted) => sorted.filter(isCounted).length;
  const [low, high] = sorted.length === 0 ? [0, 0] : medianInterval(sorted);
  return {
    names: solved, neither: all.length - solved.length,
    wins: count((d) => d < 0), losses: count((d) => d > 0), ties: count((d) => d === 0),
    typical: sorted.length === 0 ? 1 : 2 ** -medianOf(sorted), low: 2 ** -high, high: 2 ** -low,
  };
}

// --- the tab

const pair = {a: 0, b: 0, isChosen: false};

function readPair() {
  const asked = new URLSearchParams(location.search), of = (name) => DATA.optimizers.indexOf(name);
  const known = (name) => DATA.methods.indexOf(name);
  const first = [of(asked.get('a')), known('sip'), 0].find((s) => s >= 0);
  const second = [of(asked.get('b')), known('adam'), 1, 0].find((s) => s >= 0 && s < DATA.optimizers.length && s !== first);
  Object.assign(pair, {a: first, b: second ?? first, isChosen: asked.has('a') || asked.has('b')});
}

function pairSelect(key, redraw) {
  const select = element('select', {});
  select.setAttribute('aria-label', key === 'a' ? 'First method' : 'Second method');
  DATA.optimizers.forEach((name, s) => select.append(element('option', {value: s, selected: s === pair[key]}, name)));
  select.addEventListener('change', () => {
    Object.assign(pair, {[key]: Number(select.value), isChosen: true});
    writeAddress();
    redraw();
  });
  return select;
}

const named = (s) => element('b', {}, swatch(s), DATA.optimizers[s], DATA.marks[s]);

// What both take on the problems that both solve: medians, so that "dear" has a size.
function priceRows() {
  const both = DATA.problems.filter((problem) => problem.isOrdered).map((problem) => [cellOf(problem, pair.a), cellOf(problem, pair.b)])
      .filter(([x, y]) => x !== undefined && y !== undefined && takenBy(x) < Infinity && takenBy(y) < Infinity);
  const middle = (side, measure) => (both.length === 0 ? '–' : figure(Number(medianOf(both.map((cells) => takenBy(cells[side], view.target, measure)).sort((x, y) => x - y)).toPrecision(4))));
  const rows = MEASURES.map((name, measure) => [`${DATA.measures[measure].counted}, ${DATA.measures[measure].unit}`, middle(0, measure), middle(1, measure)]);
  return [...rows, ['required derivatives', DATA.asks[pair.a], DATA.asks[pair.b]],
    ['extra information (†)', DATA.privileges[pair.a] || 'none', DATA.privileges[pair.b] || 'none'],
    ['kind', DATA.kinds[pair.a], DATA.kinds[pair.b]]].map(([what, a, b]) => ({what, a, b, n: both.length}));
}

function priceTable() {
  const rows = priceRows();
  const head = element('tr', {}, element('th', {scope: 'col'}, ''), ...[pair.a, pair.b].map((s) => element('th', {scope: 'col'}, named(s))));
  const body = rows.map(({what, a, b}) => element('tr', {}, element('th', {scope: 'row'}, what), element('td', {className: 'text'}, a), element('td', {className: 'text'}, b)));
  return element('table', {className: 'prices'}, element('caption', {}, worded('pair-prices', {n: rows[0].n, tau: tauName(view.target)})),
      element('thead', {}, head), element('tbody', {}, ...body));
}

// A sentence that says no more than the interval does.
function pairSentence(told) {
  const n = told.names.length, [first, second] = [DATA.optimizers[pair.a], DATA.optimizers[pair.b]];
  const {counted} = measureNow(), isOpen = n < 6 || (told.low <= 1 && told.high >= 1);
  if (n === 0) return worded('pair-none', {tau: tauName(view.target)});
  const ties = told.ties > 0 ? worded('pair-ties', {ties: told.ties}) : '', neither = told.neither > 0 ? worded('pair-neither', {neither: told.neither}) : '';
  const values = {first, second, counted, n, ties, neither, less: told.wins, more: told.losses, ratio: multiple(told.typical),
    range: worded(n < 6 ? 'pair-range' : 'pair-interval', {n}), low: multiple(told.low), high: multiple(told.high)};
  return `${worded('pair', values)} ${worded(isOpen ? 'pair-open' : 'pair-ratio', values)}`;
}

// One bar per setting, to the left if the first method needs less; it links to the problem with both lines.
function pairBar(name, p, value, words) {
  const bar = element('i', {className: value < 0 ? 'first' : 'second'});
  bar.style.setProperty('--w', Math.abs(value) / MOST_DOUBLINGS);
  bar.dataset.s = value < 0 ? pair.a : pair.b;
  const link = element('a', {href: `#problem-${p}`}, element('span', {}, name), element('span', {className: 'way'}, bar), element('small', {}, words));
  link.dataset.p = p;
  link.addEventListener('click', () => showLines(p, [pair.a, pair.b]));
  return element('li', {}, link);
}

function pairBars(told) {
  const settings = told.names.flatMap((one) => one.settings.map(({p, a, b}) => ({p, value: doublingsOf(a, b), words: `${amount(a)} : ${amount(b)}`})));
  settings.sort((x, y) => x.value - y.value);
  return element('ol', {className: 'bars-of'}, ...settings.map(({p, value, words}) => pairBar(DATA.problems[p].spec, p, value, words)));
}

// Learned problems by the error in x at equal work.
function learnedBars() {
  const bars = [];
  DATA.problems.forEach((problem, p) => {
    const [mine, other] = [pair.a, pair.b].map((s) => problem.learned?.rows.find((row) => row.s === s));
    if (mine === undefined || other === undefined) return;
    const [x, y] = [mine.error ?? Infinity, other.error ?? Infinity];
    const value = x === Infinity || y === Infinity ? doublingsOf(x, y) : Math.min(MOST_DOUBLINGS, Math.max(-MOST_DOUBLINGS, Math.log2(x / y)));
    bars.push(pairBar(problem.spec, p, value, `${figure(x)} : ${figure(y)}`));
  });
  return bars;
}

function learnedSection() {
  const learned = learnedBars();
  return learned.length === 0 ? [] : [element('h3', {}, worded('pair-learned')), element('ol', {className: 'bars-of'}, ...learned)];
}

function drawPair(place) {
  const told = pairOf(pair.a, pair.b), redraw = () => drawPair(place);
  place.replaceChildren(
      element('p', {className: 'chosen-two'}, pairSelect('a', redraw), ' against ', pairSelect('b', redraw)),
      element('p', {className: 'verdict'}, pairSentence(told)),
      element('div', {className: 'decided'}, element('div', {},
          element('p', {className: 'legend'}, worded('pair-legend', {first: DATA.optimizers[pair.a], second: DATA.optimizers[pair.b]})),
          pairBars(told), ...learnedSection()),
      priceTable()));
}

function livePair(place) {
  readPair();
  live(place, () => drawPair(place));
}
