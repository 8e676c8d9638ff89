// The first screen for what is shown: the same figures as the report's own; its tests are not made here.
'use strict';

function optimizerLink(s) {
  const link = element('a', {href: `#optimizer-${s}`}, DATA.optimizers[s]);
  return DATA.privileges[s] === '' ? link : element('span', {}, link, element('sup', {title: `sees ${DATA.privileges[s]}`}, '†'));
}

function podiumOf(standings) {
  return element('ol', {className: 'podium'}, ...standings.slice(0, 5).map(({s, score}) => {
    const bar = element('i');
    bar.style.setProperty('--w', 100 * score);
    return element('li', {}, element('span', {}, optimizerLink(s)), bar, element('b', {}, score.toFixed(3)));
  }));
}

function fillCard(card, isAsked) {
  const title = card.querySelector('h3'), standings = rankedOf(view.target, isAsked);
  const [first] = standings, tau = tauName(view.target);
  if (first === undefined || first.score === 0) {
    card.replaceChildren(title, element('p', {className: 'winner'}, 'nobody'), element('p', {}, `None of those shown solves anything to ${tau}.`));
    return;
  }
  const deeds = element('p', {className: 'deeds'}, `solves ${first.solved} of ${first.problems} to ${tau}, ${first.wins} of them with the least ${DATA.counted}`);
  const tied = standings.filter(({score}) => Math.abs(score - first.score) < 1e-12).length;
  const sure = tied > 1 ? `${tied} are tied: their scores are equal, and nobody leads.`
      : 'Whether a lead is settled is tested on the whole report alone: what is shown here was chosen.';
  card.replaceChildren(title, element('p', {className: 'winner'}, optimizerLink(first.s)), deeds,
      element('dl', {}, element('dt', {}, 'how sure'), element('dd', {}, sure)), podiumOf(standings));
}

function fillGround(ground) {
  const [problems, , runs, failed] = ground.querySelectorAll('.tiles li'), shown = shownOf('p');
  const cells = shown.flatMap((p) => shownCells(DATA.problems[p])), sum = (count) => cells.reduce((all, cell) => all + count(cell), 0);
  problems.replaceChildren(element('b', {}, String(shown.length), element('small', {}, `/${KINDS.p.names.length}`)), 'settings shown');
  runs.replaceChildren(element('b', {}, String(sum((cell) => cell.reached.length))), 'runs that apply');
  failed.replaceChildren(element('b', {}, String(sum((cell) => cell.failed))), 'failed');
  failed.className = sum((cell) => cell.failed) > 0 ? 'bad' : '';
  const limit = isFiltered()
      ? 'What was left out was chosen, not drawn, and perhaps after its results were seen: an order among the rest is no evidence for problems or methods beyond them. '
      : `Another tolerance than the report's own, ${tauName(DEFAULT_TARGET)}, was chosen${DATA.rungs.includes(view.target) ? '' : ', and is in none of its tables'}: an order that changes with it is no order. `;
  ground.querySelectorAll('p.whole').forEach((told) => told.remove());  // of the whole report alone
  ground.querySelector('p.limits').replaceChildren(limit, element('a', {href: '#statistics'}, 'All limits'), '.');
}

function makeGlance(glance) {
  const whole = [...glance.children].map((card) => card.cloneNode(true));
  let isWhole = true;
  live(glance, () => {
    if (isPlain() && isWhole) return;
    glance.replaceChildren(...whole.map((card) => card.cloneNode(true)));
    isWhole = isPlain();
    if (isWhole) return;
    const isRanked = (s) => isShown('s', s) && DATA.order.methods.includes(s);
    const asked = {all: isRanked, open: (s) => isRanked(s) && DATA.privileges[s] === ''};
    for (const card of glance.querySelectorAll('[data-who]')) {
      const isAsked = asked[card.dataset.who], count = shownOf('s').filter(isAsked).length;
      card.querySelector('h3').textContent = card.dataset.who === 'all' ? `Of the ${count} shown` : `Of the ${count} shown that see no more than they are given`;
      fillCard(card, isAsked);
    }
    fillGround(glance.querySelector('.ground'));
  });
}
