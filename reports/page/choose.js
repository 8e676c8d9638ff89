// The tab "Choose a method": the report contains the advice for every choice, and this script looks
// it up.
const SIZES = ['any', 'up to 10', '11 to 100', 'more than 100'], BUDGETS = ['any', '10000', '1000', '100'];
const LEVELS = ['forward', 'gradient', 'jacobian', 'hessian'];  // in the order of DATA.advice
const means = {level: 0, inverse: 0, size: 0, budget: 0, kind: 0};  // kind: of data

const adviceFor = ({level, inverse, size, budget, kind}) => DATA.advice[(((2 * level + inverse) * SIZES.length + size) * BUDGETS.length + budget) * DATA.dataKinds.length + kind];
const hasSettings = (size) => DATA.dataKinds.some((_, kind) => adviceFor({level: 0, inverse: 0, size, budget: 0, kind})?.[1] !== 0);

// The first kind of data that this study has: it may have problems with bounds alone.
const firstKind = () => Math.max(0, DATA.dataKinds.findIndex((_, kind) => SIZES.some((_, size) => adviceFor({level: 0, inverse: 0, size, budget: 0, kind})?.[1] > 0)));

function readMeans(asked) {
  const place = (all, key) => Math.max(0, all.indexOf(asked.get(key)));
  const [level, inverse] = (asked.get('have') ?? '').split(' ');
  Object.assign(means, {level: Math.max(0, LEVELS.indexOf(level)), inverse: inverse === 'inverse' ? 1 : 0, size: place(SIZES, 'unknowns'), budget: place(BUDGETS, 'budget'), kind: asked.has('data') ? place(DATA.dataKinds, 'data') : firstKind()});
}

function writeMeans(asked) {
  if (means.level + means.inverse > 0) asked.set('have', LEVELS[means.level] + (means.inverse ? ' inverse' : ''));
  if (means.size > 0) asked.set('unknowns', SIZES[means.size]);
  if (means.budget > 0) asked.set('budget', BUDGETS[means.budget]);
  if (means.kind !== firstKind()) asked.set('data', DATA.dataKinds[means.kind]);
}

function drawAdvice(place) {
  const [text, settings, flat] = adviceFor(means) ?? [worded('choose-large'), 0, []], rows = [];
  for (let i = 0; i < flat.length; i += 6) {
    const [s, solved, , score, work, isInGroup] = flat.slice(i, i + 6);
    const row = element('tr', {className: isInGroup ? 'tied' : ''}, cellWith(String(i / 6 + 1)), element('th', {scope: 'row'}, ...nameOfMethod(s)), cellWith(String(solved), `/${settings}`), cellWith(figure(work ?? Infinity)), cellWith(score.toFixed(2)));
    row.dataset.line = s;  // no filter hides it
    rows.push(row);
  }
  const table = element('table', {className: 'advised'});
  filledTable(table, worded('choose-caption'), [element('tr', {}, ...worded('choose-columns').split(' | ').map((head) => element('th', {scope: 'col'}, head)))], rows);
  place.replaceChildren(element('p', {className: 'verdict'}, text), ...rows.length === 0 ? [] : [scrolled(table)]);
}

function liveChoose(place) {
  const answer = element('div', {className: 'answer'}), draw = () => drawAdvice(answer);
  answer.setAttribute('aria-live', 'polite');
  const choose = (key) => (value) => {
    means[key] = Number(value);
    writeAddress();
    draw();
  };
  const choices = (key, caption, names, isOffered = () => true) =>
      newSwitch(caption, Object.fromEntries(names.map((name, i) => [i, name]).filter(([i]) => isOffered(i))), String(means[key]), choose(key));
  const told = (key, size) => element('p', {className: 'lead'}, ...guideText(worded(key, {size})));
  const sizes = SIZES.filter((_, size) => size > 0 && hasSettings(size));  // one class is told, not asked for
  place.replaceChildren(choices('level', 'Simulator', ['forward only', '+ gradient', '+ Jacobian', '+ Hessian']), choices('inverse', 'Local inverse', ['no', 'yes']),
      sizes.length === 1 ? told('choose-size', sizes[0]) : choices('size', 'Unknowns', SIZES, hasSettings), choices('budget', 'Forward solves', BUDGETS),
      DATA.dataKinds.length > 1 ? choices('kind', 'Data', DATA.dataKinds) : told('choose-exact'), answer);
  live(answer, draw);
}
