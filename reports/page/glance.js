// The first screen for what is shown: the same figures as the report's own, resampled here.
'use strict';

const DRAWS = 1000;

// Reproducible draws in [0, 1): Mulberry32.
function randomStream(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), 1 | state);
    mixed = (mixed + Math.imul(mixed ^ (mixed >>> 7), 61 | mixed)) ^ mixed;
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
  };
}

// Problems of one name are drawn together: two grids of one equation are no two witnesses.
function problemsByName() {
  const names = new Map();
  for (const p of shownOf('p')) {
    const {name} = DATA.problems[p];
    names.set(name, [...names.get(name) ?? [], p]);
  }
  return [...names.values()];
}

function scoresByName(isAsked) {
  return problemsByName().map((group) => {
    const sums = new Float64Array(DATA.optimizers.length), counts = new Float64Array(DATA.optimizers.length);
    for (const p of group) {
      const cells = DATA.problems[p].cells.filter((cell) => isAsked(cell.s)), low = leastWork(cells, view.target);
      for (const cell of cells) {
        sums[cell.s] += scoreOf(ratioOf(workOf(cell, view.target), low));
        counts[cell.s] += 1;
      }
    }
    return {sums, counts};
  });
}

function firstOf(groups) {
  let best = -1, most = 0;
  for (let s = 0; s < DATA.optimizers.length; ++s) {
    let sum = 0, count = 0;
    for (const group of groups) {
      sum += group.sums[s];
      count += group.counts[s];
    }
    if (count > 0 && sum / count > most) [best, most] = [s, sum / count];
  }
  return best;
}

const drawn = (groups, random) => groups.map(() => groups[Math.floor(random() * groups.length)]);

function staysFirst(first, isAsked) {
  const groups = scoresByName(isAsked), random = randomStream(1);
  let times = 0;
  for (let i = 0; i < DRAWS; ++i) times += firstOf(drawn(groups, random)) === first;
  return times / DRAWS;
}

// The second's work over the first's: the median over problems, and 95 % of the bootstrap.
function factorOf(first, second) {
  const groups = problemsByName().map((group) => group.flatMap((p) => {
    const [a, b] = [first, second].map((s) => DATA.problems[p].cells.find((cell) => cell.s === s));
    if (a === undefined || b === undefined) return [];
    const mine = workOf(a, view.target), other = workOf(b, view.target);
    if (mine === Infinity && other === Infinity) return [];
    return [mine === Infinity ? 0 : Math.max(other, 1) / Math.max(mine, 1)];
  })).filter((group) => group.length > 0);
  const random = randomStream(2);
  const all = Array.from({length: DRAWS}, () => median(drawn(groups, random).flat())).sort(order);
  return {factor: median(groups.flat()), low: all[Math.floor(0.025 * DRAWS)], high: all[Math.floor(0.975 * DRAWS)], n: groups.flat().length};
}

const times = (ratio) => (ratio === Infinity ? '∞' : `${Number(ratio.toPrecision(2))}×`);

function optimizerLink(s) {
  const link = element('a', {href: `#optimizer-${s}`}, DATA.optimizers[s]);
  return DATA.privileges[s] === '' ? link : element('span', {}, link, element('sup', {title: `sees ${DATA.privileges[s]}`}, '†'));
}

function podiumOf(standings) {
  return element('ol', {className: 'podium'}, ...standings.slice(0, 6).map(({s, score}) => {
    const bar = element('i');
    bar.style.setProperty('--w', 100 * score);
    return element('li', {}, element('span', {}, optimizerLink(s)), bar, element('b', {}, score.toFixed(3)));
  }));
}

function fillCard(card, isAsked) {
  const title = card.querySelector('h3'), standings = standingsOf(view.target, isAsked);
  const [first, second] = standings, tau = tauName(view.target);
  if (first === undefined || first.score === 0) {
    card.replaceChildren(title, element('p', {className: 'winner'}, 'nobody'), element('p', {}, `None of those shown solves any problem to ${tau}.`));
    return;
  }
  const by = second === undefined || second.score === 0 ? {n: 0} : factorOf(first.s, second.s);
  const share = staysFirst(first.s, isAsked);
  const deeds = element('p', {className: 'deeds'}, 'solves ', element('b', {}, `${first.solved} of ${first.problems}`), ` problems to τ = ${tau}, `,
      element('b', {}, String(first.wins)), ' of them with the least work');
  const much = by.n === 0 ? element('dd', {}, 'no other solves anything')
      : element('dd', {}, element('b', {}, times(by.factor)), ' the work for ', optimizerLink(second.s),
          `, the next: median over ${by.n} problems; 95 % of resamplings ${times(by.low)} to ${times(by.high)}`);
  const sure = element('dd', {}, element('b', {}, `${(100 * share).toFixed(0)} %`), ' of resamplings of the problems leave it first: ',
      share >= 0.95 ? 'settled for problems like these' : 'not settled');
  card.replaceChildren(title, element('p', {className: 'winner'}, optimizerLink(first.s)), deeds,
      element('dl', {}, element('dt', {}, 'by how much'), much, element('dt', {}, 'how sure'), sure), podiumOf(standings));
}

function fillGround(ground) {
  const [problems, , runs, failed] = ground.querySelectorAll('.tiles li'), shown = shownOf('p');
  const cells = shown.flatMap((p) => shownCells(DATA.problems[p])), sum = (count) => cells.reduce((all, cell) => all + count(cell), 0);
  problems.replaceChildren(element('b', {}, String(shown.length), element('small', {}, `/${KINDS.p.names.length}`)), 'problems shown');
  runs.replaceChildren(element('b', {}, String(sum((cell) => cell.reached.length))), 'runs that apply');
  failed.replaceChildren(element('b', {}, String(sum((cell) => cell.failed))), 'failed');
  failed.className = sum((cell) => cell.failed) > 0 ? 'bad' : '';
  const limit = isFiltered()
      ? 'What was left out was chosen, not drawn, and perhaps after its results were seen: an order among the rest is no evidence for problems or methods beyond them. '
      : `Another tolerance than the report's own, 1e-6, was chosen${view.target === 5 || view.target === 15 ? '' : ', and is in none of its tables'}: an order that changes with it is no order. `;
  ground.querySelector('p').replaceChildren(limit, element('a', {href: '#statistics'}, 'All limits'), '.');
}

function makeGlance(glance) {
  const whole = [...glance.children].map((card) => card.cloneNode(true));
  let isWhole = true;
  live(glance, () => {
    if (isPlain() && isWhole) return;
    glance.replaceChildren(...whole.map((card) => card.cloneNode(true)));
    isWhole = isPlain();
    if (isWhole) return;
    const asked = {all: (s) => isShown('s', s), open: (s) => isShown('s', s) && DATA.privileges[s] === ''};
    for (const card of glance.querySelectorAll('[data-who]')) {
      const isAsked = asked[card.dataset.who], count = shownOf('s').filter(isAsked).length;
      card.querySelector('h3').textContent = card.dataset.who === 'all' ? `Of the ${count} shown` : `Of the ${count} shown that see no more than they are given`;
      fillCard(card, isAsked);
    }
    fillGround(glance.querySelector('.ground'));
  });
}
