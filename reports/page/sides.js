// Two results compared: one method against itself, or all of them at once, by the figures of a pair.
'use strict';

const SIDES = DATA.sides ?? [];  // [in BASE, in NEW, what both call it]
const side = {chosen: -1};  // -1: all methods

const pairsNow = () => (side.chosen < 0 ? SIDES : [SIDES[side.chosen]]).map(([a, b]) => [a, b]);

function sideSelect(redraw) {
  const select = element('select', {}, element('option', {value: -1}, `all ${SIDES.length} methods`),
      ...SIDES.map(([, , name], i) => element('option', {value: i}, name)));
  select.value = String(side.chosen);
  select.setAttribute('aria-label', 'Method');
  select.addEventListener('change', () => {
    side.chosen = Number(select.value);
    redraw();
  });
  return select;
}

// A bar a setting: of all methods the median over those that both were given there.
function sideBars(told) {
  const settings = told.names.flatMap((one) => one.settings), byProblem = new Map();
  for (const one of settings) byProblem.set(one.p, [...byProblem.get(one.p) ?? [], one]);
  const bars = [...byProblem].map(([p, all]) => ({
    p, value: medianOf(all.map(({a, b}) => doublingsOf(a, b)).sort((x, y) => x - y)),
    words: all.length === 1 ? `${amount(all[0].a)} : ${amount(all[0].b)}` : `${all.length} methods`,
  })).sort((x, y) => x.value - y.value);
  return element('ol', {className: 'bars-of'}, ...bars.map(({p, value, words}) => pairBar(DATA.problems[p].spec, p, value, words)));
}

// Each method against itself: where NEW needs more stands first.
function sideTable(redraw) {
  const rows = SIDES.map(([a, b, name], i) => ({name, i, told: pairOf(a, b)})).filter(({told}) => told.names.length > 0)
      .sort((x, y) => y.told.typical - x.told.typical);
  const body = rows.map(({name, i, told}) => element('tr', {},
      element('th', {scope: 'row'}, pressable(name, undefined, () => { side.chosen = i; redraw(); })),
      ...[multiple(told.typical), `${multiple(told.low)} to ${multiple(told.high)}`, told.losses, told.wins, told.ties].map((text) => element('td', {}, String(text)))));
  const heads = ['method', 'NEW over BASE', '95 % interval', 'NEW needs less', 'more', 'the same'];
  const caption = `Median factor of ${measureNow().counted} to τ = ${tauName(view.target)}, its interval (of fewer than six problems the range), and on how many problems NEW needs less, more, the same`;
  return element('table', {className: 'prices'}, element('caption', {}, caption),
      element('thead', {}, element('tr', {}, ...heads.map((text) => element('th', {scope: 'col'}, text)))), element('tbody', {}, ...body));
}

function sideSentence(told) {
  const {wins, losses, ties, neither, typical, low, high} = told, n = told.names.length, who = side.chosen < 0 ? '' : `${SIDES[side.chosen][2]}: `;
  if (n === 0) return `${who}neither result solves a problem that both have to τ = ${tauName(view.target)}.`;
  const range = n < 6 ? `range of ${n}` : '95 % interval', isOpen = low <= 1 && high >= 1;
  const rest = neither > 0 ? `; neither solves ${neither} more` : '';
  if (wins + losses === 0) return `${who}NEW needs the same ${measureNow().counted} as BASE on all ${n} problems${rest}.`;
  return `${who}NEW needs less ${measureNow().counted} than BASE on ${losses} of ${n} problems, more on ${wins}, the same on ${ties}${rest}. ` +
      `Median factor, NEW over BASE: ${multiple(typical)} (${range} ${multiple(low)} to ${multiple(high)})${isOpen || n < 6 ? ': not settled.' : '.'}`;
}

function drawSides(place) {
  const pairs = pairsNow(), told = pairOfAll(pairs), redraw = () => drawSides(place);
  Object.assign(pair, {a: pairs[0][0], b: pairs[0][1]});  // whose lines a bar opens
  place.replaceChildren(
      element('p', {className: 'chosen-two'}, 'BASE against NEW: ', sideSelect(redraw)),
      element('p', {className: 'verdict'}, sideSentence(told)),
      element('div', {className: 'decided'}, element('div', {},
          element('p', {className: 'legend'}, 'To the left BASE needs less, to the right NEW; a full bar is 64 times or unsolved. Press one for its curves.'),
          sideBars(told), ...(side.chosen < 0 ? [] : learnedSection())),
      side.chosen < 0 ? sideTable(redraw) : priceTable()));
}
