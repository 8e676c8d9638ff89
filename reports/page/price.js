// The price of a derivative: the ranking, if a gradient or a Jacobian cost another number of forward
// solves. `standingsAtPrices` is the second function of these scripts that makes figures: those of a report
// with these measured costs, which a test of the browser holds it to.
const PRICE_STEPS = 60;  // of a slider, from 1 to 1,000
const priceOf = (step) => 10 ** (step / 20);
const price = {gradient: 0, jacobian: -1};  // steps; −1: the nominal cost, min(n, m)
const WORKERS = [1, 8, 64], WIDTH = 5, FORWARDS = [0, 3, 4];  // of a run in DATA.calls: the forward solves in rounds of so many workers
let workers = 0;  // index in WORKERS

function costOf(flat, gradient, jacobian, crew = 0) {
  const costs = [];
  for (let i = 0; i < flat.length; i += WIDTH) costs.push(flat[i] === null ? Infinity : flat[i + FORWARDS[crew]] + gradient * flat[i + 1] + jacobian * flat[i + 2]);
  return costs.length === 0 ? Infinity : medianOf(costs.sort((x, y) => x - y));
}

// Best first; a Jacobian without a price has its nominal cost.
function standingsAtPrices(gradient, jacobian, crew = 0) {
  const all = DATA.ranked.map((s) => ({s, score: 0, solved: 0})), end = 64;
  for (const [declared, methods, weight] of DATA.calls) {
    const costs = methods.map((flat) => costOf(flat, gradient, jacobian ?? declared, crew)), least = Math.max(1, Math.min(...costs));
    costs.forEach((cost, i) => {
      if (cost === Infinity) return;
      all[i].score += Math.max(0, Math.log2(end) - Math.log2(Math.max(1, cost) / least)) / Math.log2(end) * weight;
      ++all[i].solved;
    });
  }
  return all.sort((a, b) => (Math.abs(a.score - b.score) > 1e-12 ? b.score - a.score : b.solved - a.solved));
}

// The methods that hand several forward solves over at once, so that workers share them.
const sharing = () => new Set(DATA.ranked.filter((_, i) => DATA.calls.some(([, methods]) => methods[i].some((value, at) => at % WIDTH === FORWARDS[2] && value !== methods[i][at - FORWARDS[2]]))));

// The method that ranks first from each price of a Jacobian on; kept, since the slider of that price does not change them.
const LEADERS = new Map();
function leadersBy(gradient) {
  const key = `${gradient} ${workers}`, leaders = [];
  if (LEADERS.has(key)) return LEADERS.get(key);
  LEADERS.set(key, leaders);
  for (let step = 0; step <= PRICE_STEPS; ++step) {
    const [{s}] = standingsAtPrices(gradient, priceOf(step), workers);
    if (leaders.length === 0 || leaders[leaders.length - 1].s !== s) leaders.push({s, from: priceOf(step)});
  }
  return leaders;
}

function leadersText(gradient) {
  return leadersBy(gradient).map(({s, from}) => worded('price-from', {from: short(from), method: DATA.optimizers[s]})).join(', ');
}

function drawPrices(list, sentence, shares) {
  const gradient = priceOf(price.gradient), jacobian = price.jacobian < 0 ? undefined : priceOf(price.jacobian), places = standingsAtPrices(gradient, jacobian, workers);
  if (list.childElementCount === 0) {
    const axis = list.appendChild(tickRow([0, .25, .5, .75, 1], (score) => score));
    axis.style.setProperty('--place', DATA.ranked.length);
    for (const s of DATA.ranked) {
      const row = element('li', {}, element('span', {}, ...nameOfMethod(s)), element('span', {className: 'way'}, element('i')), element('small'));
      row.querySelector('i').dataset.s = s;
      row.dataset.line = s;
      list.append(row);
    }
  }
  const rows = new Map([...list.children].map((row) => [Number(row.dataset.line), row]));
  places.forEach(({s, score, solved}, place) => {
    const row = rows.get(s);
    row.style.setProperty('--place', place);
    row.querySelector('i').style.setProperty('--at', score);
    const alone = workers > 0 && !shares.has(s) ? ` ${worded('price-alone')}` : '';
    row.querySelector('small').textContent = `${score.toFixed(2)}, ${solved}/${DATA.calls.length}${alone}`;
  });
  list.style.setProperty('--places', places.length + 1);
  list.style.setProperty('--letters', 1 + Math.max(...DATA.ranked.map((s) => DATA.optimizers[s].length)));  // a † too
  sentence.textContent = worded('price-leaders', {gradient: short(gradient), jacobian: jacobian === undefined ? worded('price-nominal') : short(jacobian), method: DATA.optimizers[places[0].s], leaders: leadersText(gradient)});
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

function workerSwitch(redraw) {
  const select = element('select', {}, ...WORKERS.map((count, i) => element('option', {value: i, selected: i === workers}, String(count))));
  select.addEventListener('change', () => {
    workers = Number(select.value);
    redraw();
    writeAddress();
  });
  return element('label', {className: 'tolerance'}, worded('price-workers'), ' ', select);
}

function readPrices(asked) {
  workers = Math.max(0, WORKERS.indexOf(Number(asked.get('workers'))));
  for (const key of Object.keys(price)) if (Number(asked.get(key)) > 0) price[key] = Math.min(PRICE_STEPS, Math.max(0, Math.round(20 * Math.log10(Number(asked.get(key))))));
}

function writePrices(asked) {
  if (price.gradient > 0) asked.set('gradient', short(priceOf(price.gradient)));
  if (price.jacobian >= 0) asked.set('jacobian', short(priceOf(price.jacobian)));
  if (workers > 0) asked.set('workers', String(WORKERS[workers]));
}

function livePrices(place) {
  if (DATA.calls.length === 0 || DATA.ranked.length < 2) return place.previousElementSibling.remove();
  const list = element('ol', {className: 'bars-of placed'}), sentence = element('p', {className: 'verdict'}), shares = sharing(), draw = () => drawPrices(list, sentence, shares);
  sentence.setAttribute('aria-live', 'polite');
  place.append(element('p', {className: 'lead'}, worded('price-lead', {tau: tauName(DEFAULT_TARGET), settings: DATA.calls.length})), element('p', {className: 'steps'}, priceSlider('gradient', draw), ' ', priceSlider('jacobian', draw), ' ', workerSwitch(draw)), sentence, list);
  live(list, draw);
}
