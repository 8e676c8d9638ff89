// The price of a derivative: the ranking, if a gradient or a Jacobian cost another number of forward
// solves. `standingsAtPrices` is the second function of these scripts that makes figures: those of a report
// with these measured costs, which a test of the browser holds it to.
const PRICE_STEPS = 60;  // of a slider, from 1 to 1,000
const priceOf = (step) => 10 ** (step / 20);
const price = {gradient: 0, jacobian: -1};  // steps; −1: the nominal cost, min(n, m)

function costOf(flat, gradient, jacobian) {
  const costs = [];
  for (let i = 0; i < flat.length; i += 3) costs.push(flat[i] === null ? Infinity : flat[i] + gradient * flat[i + 1] + jacobian * flat[i + 2]);
  return costs.length === 0 ? Infinity : medianOf(costs.sort((x, y) => x - y));
}

// Best first; a Jacobian without a price has its nominal cost.
function standingsAtPrices(gradient, jacobian) {
  const all = DATA.ranked.map((s) => ({s, score: 0, solved: 0})), end = 64;
  for (const [declared, methods] of DATA.calls) {
    const costs = methods.map((flat) => costOf(flat, gradient, jacobian ?? declared)), least = Math.max(1, Math.min(...costs));
    costs.forEach((cost, i) => {
      if (cost === Infinity) return;
      all[i].score += Math.max(0, Math.log2(end) - Math.log2(Math.max(1, cost) / least)) / Math.log2(end) / DATA.calls.length;
      ++all[i].solved;
    });
  }
  return all.sort((a, b) => (Math.abs(a.score - b.score) > 1e-12 ? b.score - a.score : b.solved - a.solved));
}

// The method that ranks first from each price of a Jacobian on.
function leadersBy(gradient) {
  const leaders = [];
  for (let step = 0; step <= PRICE_STEPS; ++step) {
    const [{s}] = standingsAtPrices(gradient, priceOf(step));
    if (leaders.length === 0 || leaders[leaders.length - 1].s !== s) leaders.push({s, from: priceOf(step)});
  }
  return leaders;
}

function leadersText(gradient) {
  return leadersBy(gradient).map(({s, from}, i) => (i === 0 ? DATA.optimizers[s] : worded('price-from', {from: short(from), method: DATA.optimizers[s]}))).join(', ');
}

function drawPrices(list, sentence) {
  const gradient = priceOf(price.gradient), jacobian = price.jacobian < 0 ? undefined : priceOf(price.jacobian), places = standingsAtPrices(gradient, jacobian);
  if (list.childElementCount === 0)
    for (const s of DATA.ranked) {
      const row = element('li', {}, element('span', {}, ...nameOfMethod(s)), element('span', {className: 'way'}, element('i')), element('small'));
      row.querySelector('i').dataset.s = s;
      row.dataset.line = s;
      list.append(row);
    }
  const rows = new Map([...list.children].map((row) => [Number(row.dataset.line), row]));
  places.forEach(({s, score, solved}, place) => {
    const row = rows.get(s);
    row.style.setProperty('--place', place);
    row.querySelector('i').style.setProperty('--at', score);
    row.querySelector('small').textContent = `${score.toFixed(2)}, ${solved}/${DATA.calls.length}`;
  });
  list.style.setProperty('--places', places.length);
  sentence.textContent = worded('price-leaders', {gradient: short(gradient), leaders: leadersText(gradient)});
}

function priceSlider(key, redraw) {
  const least = key === 'jacobian' ? -1 : 0, output = element('output'), input = element('input', {type: 'range', min: least, max: PRICE_STEPS, value: price[key]});
  const show = () => {
    output.textContent = price[key] < 0 ? worded('price-nominal') : short(priceOf(price[key]));
    input.setAttribute('aria-valuetext', output.textContent);
  };
  input.addEventListener('input', () => {
    price[key] = Number(input.value);
    show();
    redraw();
    writeAddress();
  });
  show();
  return element('label', {className: 'tolerance'}, worded(`price-${key}`), ' ', input, output);
}

function readPrices(asked) {
  for (const key of Object.keys(price)) if (Number(asked.get(key)) > 0) price[key] = Math.min(PRICE_STEPS, Math.max(0, Math.round(20 * Math.log10(Number(asked.get(key))))));
}

function writePrices(asked) {
  if (price.gradient > 0) asked.set('gradient', short(priceOf(price.gradient)));
  if (price.jacobian >= 0) asked.set('jacobian', short(priceOf(price.jacobian)));
}

function livePrices(place) {
  if (DATA.calls.length === 0 || DATA.ranked.length < 2) return place.previousElementSibling.remove();
  const list = element('ol', {className: 'bars-of placed'}), sentence = element('p', {className: 'verdict'}), draw = () => drawPrices(list, sentence);
  sentence.setAttribute('aria-live', 'polite');
  place.append(element('p', {className: 'lead'}, worded('price-lead', {tau: tauName(DEFAULT_TARGET)})), element('p', {className: 'steps'}, priceSlider('gradient', draw), ' ', priceSlider('jacobian', draw)), sentence, list);
  live(list, draw);
}
