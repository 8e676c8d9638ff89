// Up to four methods of the reader's choice. `ratioOf` is the one function of these scripts that makes
// figures: those of `work_ratio` in the report, which a test of the browser holds it to for every pair.
const MOST_COMPARED = 4;

function medianOf(ascending) {
  const half = Math.floor(ascending.length / 2);
  return ascending.length % 2 === 1 ? ascending[half] : (ascending[half - 1] + ascending[half]) / 2;
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

// The settings that may be ranked and to which all of these methods apply.
const settingsOf = (methods) => DATA.problems.flatMap((problem, p) => {
  const cells = methods.map((s) => cellOf(problem, s));
  return problem.isOrdered && cells.every((cell) => cell !== undefined && isMeasured(cell)) ? [{p, taken: cells.map((cell) => takenBy(cell))}] : [];
});

// The work of `a` over that of `b` where both solve: the median over problems, of a problem the
// median over its settings.
function ratioOf(a, b) {
  const names = new Map(), counts = {both: 0, onlyA: 0, onlyB: 0, neither: 0};
  for (const {p, taken: [x, y]} of settingsOf([a, b])) {
    ++counts[x < Infinity ? (y < Infinity ? 'both' : 'onlyA') : y < Infinity ? 'onlyB' : 'neither'];
    if (x === Infinity || y === Infinity) continue;
    const {name} = DATA.problems[p];
    names.set(name, [...names.get(name) ?? [], Math.log2(atLeast(x)) - Math.log2(atLeast(y))]);
  }
  const ascending = (values) => values.sort((x, y) => x - y), all = ascending([...names.values()].map((values) => medianOf(ascending(values))));
  if (all.length === 0) return {...counts, problems: 0, median: 1, low: 0, high: Infinity};
  const [low, high] = medianInterval(all);
  return {...counts, problems: all.length, median: 2 ** medianOf(all), low: 2 ** low, high: 2 ** high};
}

// --- the tab

const pair = {methods: [0], isChosen: false};

// Of the rows of a method that with the most settings which it and another both solve.
function bestRow(method, other) {
  const rows = [...DATA.optimizers.keys()].filter((s) => DATA.methods[s] === method && s !== other);
  return rows.sort((a, b) => ratioOf(b, other).both - ratioOf(a, other).both)[0];
}

function readPair() {
  const asked = new URLSearchParams(location.search).getAll('vs').map((name) => DATA.optimizers.indexOf(name)).filter((s) => s >= 0);
  const adam = DATA.methods.indexOf('adam'), sip = adam < 0 ? undefined : bestRow('sip', adam), own = sip === undefined ? [0, 1] : [sip, adam];
  const methods = asked.length > 0 ? asked.slice(0, MOST_COMPARED) : own.filter((s) => s < DATA.optimizers.length);
  Object.assign(pair, {methods, isChosen: asked.length > 0});
}

// The choice of one method; "–" leaves it out, and a last one adds it.
function methodSelect(methods, able, place, redraw) {
  const select = element('select', {}), isOptional = place > 1;
  select.setAttribute('aria-label', `Method ${place + 1}`);
  if (isOptional) select.append(element('option', {value: -1, selected: place >= methods.length}, '–'));
  for (const s of able)
    if (s === methods[place] || !methods.includes(s)) select.append(element('option', {value: s, selected: s === methods[place]}, DATA.optimizers[s]));
  select.addEventListener('change', () => {
    const chosen = Number(select.value);
    if (chosen < 0) methods.splice(place, 1); else methods[place] = chosen;
    redraw();
  });
  return select;
}

const named = (s) => element('b', {}, swatch(s), DATA.optimizers[s], DATA.marks[s]);

// Medians over the settings that all of them solve.
function priceTable() {
  const {methods} = pair, solved = settingsOf(methods).filter(({taken}) => taken.every((work) => work < Infinity)), doubt = (measure) => (DATA.measures[measure].name === 'time' && DATA.isTimedTogether ? '≈ ' : '');
  const middle = (s, measure) => (solved.length === 0 ? '–' : doubt(measure) + figure(Number(medianOf(solved.map(({p}) => takenBy(cellOf(DATA.problems[p], s), view.target, measure)).sort((x, y) => x - y)).toPrecision(4))));
  const rows = [...DATA.measures.map(({counted, unit}, measure) => [`${counted}, ${unit}`, (s) => middle(s, measure)]), ['required derivatives', (s) => DATA.asks[s]],
    ['extra information (†)', (s) => DATA.privileges[s] || 'none'], ['kind', (s) => DATA.kinds[s]]];
  const table = element('table', {className: 'prices'}), open = () => openSettings(worded('compared'), methods, solved.map(({p}) => p));
  filledTable(table, worded('price-caption', {settings: solved.length, tau: tauName(view.target)}), [element('tr', {}, element('td'), ...methods.map((s) => element('th', {scope: 'col'}, named(s))))],
      rows.map(([what, of]) => element('tr', {}, element('th', {scope: 'row'}, what), ...methods.map((s) => element('td', {className: 'text'}, of(s))))));
  for (const row of [...table.tBodies[0].rows].slice(0, MEASURES.length))
    for (const cell of [...row.cells].slice(1)) cell.addEventListener('click', open);
  return table;
}

// What a sentence on two methods counts.
const pairEvidence = (a, b) => Object.assign(pressable(worded('pair-evidence'), undefined, () => openSettings(worded('compared'), [a, b], settingsOf([a, b]).map(({p}) => p))), {className: 'evidence'});

// A sentence that says no more than the interval does.
function pairSentence(a, b) {
  const {both, onlyA, onlyB, neither, problems, median, low, high} = ratioOf(a, b), isOpen = problems < 6 || (low <= 1 && high >= 1);
  const counts = worded('pair-counts', {a: saidOf(a), b: saidOf(b), tau: tauName(view.target), both, onlyA, onlyB, neither});
  if (both === 0) return counts;
  if (isDoubtful()) return `${counts} ${worded('not-timed')}`;
  const [more, less, ...ratios] = median < 1 ? [b, a, 1 / median, 1 / high, 1 / low] : [a, b, median, low, high], [ratio, least, most] = ratios.map(multiple);
  return `${counts} ${worded('pair-ratio', {a: saidOf(more), b: saidOf(less), measure: measureNow().counted, ratio, interval: worded(problems < 6 ? 'pair-range' : 'pair-interval', {n: problems}), low: least, high: most})} ${worded(isOpen ? 'pair-open' : 'pair-clear')}`;
}

// The ticks of rows of dots.
function tickRow(values, at) {
  return element('li', {className: 'axis'}, element('span'), element('span', {className: 'way'}, ...values.map((value) => {
    const tick = element('b', {}, short(value));
    tick.style.setProperty('--at', at(value));
    return tick;
  })));
}

// One row a setting: a dot for each method on one logarithmic axis, ✗ at its end.
function dotRows(rows) {
  const values = rows.flatMap(({taken}) => taken.filter((value) => value > 0 && value < Infinity)), [low, high] = [Math.min(...values), Math.max(...values)];
  const at = (value) => (value === Infinity ? 1 : high > low ? 0.94 * Math.log(Math.max(value, low) / low) / Math.log(high / low) : 0);
  return element('ol', {className: 'bars-of'}, ...high > low ? [tickRow(ticksOf(low, high, true), at)] : [], ...rows.map(({p, taken, words, those = pair.methods}) => {
    const dots = taken.map((value, i) => {
      const dot = element('i', {className: value === Infinity ? 'lost' : ''}, value === Infinity ? '✗' : '');
      dot.style.setProperty('--at', at(value));
      dot.dataset.s = pair.methods[i];
      return dot;
    });
    const link = element('a', {href: `#problem-${p}`, title: DATA.problems[p].spec}, brief(DATA.problems[p])), row = element('li', {}, link, element('span', {className: 'way'}, ...dots), element('small', {}, words));
    row.dataset.p = p;
    link.addEventListener('click', () => showLines(p, those));
    row.addEventListener('click', ({target}) => { if (target !== link) openDrawer(p, ...those); });
    return row;
  }));
}

function settingRows() {
  const ratio = ([x, y]) => (x === y ? 0 : x === Infinity ? 1e9 : y === Infinity ? 1e8 : Math.log(x / y));
  return settingsOf(pair.methods).sort((x, y) => ratio(x.taken) - ratio(y.taken)).map(({p, taken}) => ({p, taken: taken.map(atLeast), words: taken.map(amount).join(' : ')}));
}

// In a sentence, without a comma: "sip (given P⁻¹)".
const saidOf = (s) => DATA.optimizers[s].replace(/, given (.*)/, ' (given $1)');

// How two methods compare on a learned problem, in the numbers of the report.
function learnedSentence(p, a, b) {
  const {pairs, rows} = DATA.problems[p].learned, one = pairs.find(([less, more]) => (less === a && more === b) || (less === b && more === a));
  if (one === undefined) return [];
  const [less, more, ratio, low, high, chance, isListed] = one, rowOf = (s) => rows.find((row) => row.s === s);
  const costOf = (s) => worded('step-cost', {work: figure(rowOf(s).solves), ms: `${DATA.isTimedTogether ? '≈ ' : ''}${figure(rowOf(s).ms)}`});
  return [element('p', {}, worded('learned-ratio', {problem: DATA.problems[p].spec, a: saidOf(more), b: saidOf(less), ratio: multiple(ratio), work: figure(DATA.problems[p].learned.work), seeds: `${rowOf(more).runs} and ${rowOf(less).runs}`, p: chance, sure: worded(chance > 0.05 ? 'pair-open' : 'pair-clear'), costA: costOf(more), costB: costOf(less),
    interval: low > 0 && high !== null ? worded('learned-interval', {low: multiple(low), high: multiple(high)}) : worded('learned-few')}), ...isListed ? [' ', element('a', {href: '#ratio-readings'}, worded('other-readings'))] : [])];
}

// Learned problems by the error in x at equal work: with the row that a method has there, whatever it was given.
function learnedSection() {
  const rows = DATA.problems.flatMap(({learned}, p) => {
    const found = pair.methods.map((s) => learned?.rows.find((row) => row.s === s) ?? learned?.rows.find((row) => DATA.methods[row.s] === DATA.methods[s]));
    const those = new Set(found.map((row) => row?.s)), taken = found.map((row) => row?.error ?? Infinity);
    return those.has(undefined) || those.size < found.length ? [] : [{p, those: [...those], taken, words: taken.map(figure).join(' : ')}];
  });
  const apart = ({taken: [x, y]}) => Math.abs(Math.log(x / y)) || 0;
  rows.sort((x, y) => apart(y) - apart(x));
  return rows.length === 0 ? [] : [element('h3', {}, worded('learned-pair')), ...rows.flatMap(({p, those: [first, ...others]}) => others.flatMap((s) => learnedSentence(p, first, s))), element('p', {className: 'legend'}, worded('learned-legend')), dotRows(rows)];
}

// The work of each other method over settings, against that of the first: below the diagonal it needs less.
function scatter(rows) {
  const solved = rows.filter(({taken}) => taken[0] < Infinity && taken.some((value, i) => i > 0 && value < Infinity)), values = solved.flatMap(({taken}) => taken.filter((value) => value < Infinity));
  if (solved.length < 2) return [];
  const [low, high] = [Math.min(...values) / 1.2, 1.2 * Math.max(...values)], at = (value) => 40 + 240 * Math.log(value / low) / Math.log(high / low);
  const drawn = svgElement('svg', {class: 'scatter', viewBox: '0 0 300 310', role: 'img', 'aria-label': worded('scatter', {measure: measureNow().counted, a: saidOf(pair.methods[0])})});
  drawn.append(svgElement('path', {class: 'grid', d: 'M40 280V40M40 280H280M40 280L280 40'}));
  for (const tick of ticksOf(low, high, true))
    drawn.append(svgElement('text', {x: at(tick), y: 294, 'text-anchor': 'middle'}, short(tick)), svgElement('text', {x: 36, y: 324 - at(tick), 'text-anchor': 'end'}, short(tick)));
  const [first, ...others] = pair.methods.map((s) => DATA.optimizers[s]);
  drawn.append(svgElement('text', {x: 160, y: 308, 'text-anchor': 'middle'}, first), svgElement('text', {x: 36, y: 30}, others.join(', ')));
  for (const {p, taken} of solved)
    taken.forEach((value, i) => {
      if (i === 0 || value === Infinity) return;
      const dot = svgElement('circle', {cx: at(taken[0]), cy: 320 - at(value), r: 4, 'data-s': pair.methods[i], 'data-p': p});
      dot.addEventListener('click', () => openDrawer(p, pair.methods[0], pair.methods[i]));
      dot.append(svgElement('title', {}, `${DATA.problems[p].spec}: ${taken.map(short).join(' : ')}`));
      drawn.append(dot);
    });
  return [element('figure', {}, element('figcaption', {}, drawn.getAttribute('aria-label')), drawn)];
}

function drawPair(place) {
  const redraw = () => {
    pair.isChosen = true;
    writeAddress();
    drawPair(place);
  };
  const {methods} = pair, rows = settingRows(), selects = [...Array(Math.min(MOST_COMPARED, methods.length + 1)).keys()].map((i) => methodSelect(methods, DATA.optimizers.keys(), i, redraw));
  place.replaceChildren(element('style', {}, huesOf(methods, '#pair ')), element('p', {className: 'chosen-two'}, ...selects.flatMap((select, i) => (i === 0 ? [select] : [i === 1 ? ' against ' : ' ', select]))),
      ...methods.slice(1).map((s) => element('p', {className: 'verdict'}, pairSentence(methods[0], s), ' ', pairEvidence(methods[0], s))),
      element('div', {className: 'decided'}, element('div', {}, ...learnedSection(), element('p', {className: 'legend'}, worded('pair-legend', {measure: measureNow().counted})), dotRows(rows)),
          element('div', {}, scrolled(priceTable()), ...scatter(rows))));
}

function livePair(place) {
  readPair();
  live(place, () => drawPair(place));
}
