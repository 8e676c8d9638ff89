// Legends of charts: the line of each optimizer, shown and hidden by its name.
'use strict';

const GLYPHS = {circle: '○', rect: '□', triangle: '△', rectRot: '◇', crossRot: '×'};

// The line of the curves; with the marker of the path where the path has them.
function swatch(index, hasMarkers) {
  const glyph = hasMarkers
      ? `<text x="34" y="8" font-size="13" text-anchor="middle" fill="${colourOf(index)}">${GLYPHS[STYLES[index].marker]}</text>` : '';
  const svg = `<svg width="${hasMarkers ? 42 : 24}" height="12" aria-hidden="true"><line x1="0" y1="6" x2="24" y2="6" ` +
      `stroke="${colourOf(index)}" stroke-width="2.4" stroke-dasharray="${dashOf(index).join(' ')}"/>${glyph}</svg>`;
  return document.createRange().createContextualFragment(svg);
}

// A legend that shows and hides lines; `ranked` is in order of rank. What is filtered out of the page
// has no name in it.
function fillLegend(legend, ranked, visible, onChange, onPoint) {
  const among = ranked.filter((index) => isShown('s', index));
  const show = (some) => () => {
    visible.clear();
    some.forEach((index) => visible.add(index));
    fillLegend(legend, ranked, visible, onChange, onPoint);
    onChange();
  };
  const presets = among.length <= FEW
      ? []
      : [pressable(`best ${SHOWN_AT_FIRST}`, undefined, show(among.slice(0, SHOWN_AT_FIRST))),
         pressable('all', undefined, show(among)), pressable('none', undefined, show([]))];
  presets.forEach((button) => button.classList.add('preset'));
  const names = ranked.map((index) => {
    const button = pressable(DATA.optimizers[index], visible.has(index), () => {
      if (!visible.delete(index)) visible.add(index);
      button.setAttribute('aria-pressed', visible.has(index));
      onChange();
    });
    button.dataset.s = index;
    button.prepend(swatch(index, legend.withMarkers?.has(index)));
    for (const [event, lit] of [['pointerenter', index], ['pointerleave', undefined], ['focus', index], ['blur', undefined]])
      button.addEventListener(event, () => onPoint(lit));
    return button;
  });
  legend.replaceChildren(...presets, ...names);
}

function newLegend(ranked, onChange, onPoint, withMarkers = new Set()) {
  const place = document.createElement('div');
  place.withMarkers = withMarkers;
  place.className = 'names';
  return {place, fill: (visible) => fillLegend(place, ranked, visible, onChange, onPoint)};
}

function shownAtFirst(ranked) {
  const among = ranked.filter((index) => isShown('s', index));
  return new Set(among.length <= FEW ? among : among.slice(0, SHOWN_AT_FIRST));
}

// The lines that a chart shows: chosen in its legend, until other optimizers are shown on the page.
function newChoice(ranked, first = shownAtFirst) {
  let of = null;
  const visible = new Set();
  return () => {
    const now = shownOf('s').join();
    if (now !== of) {
      of = now;
      visible.clear();
      first(ranked).forEach((index) => visible.add(index));
    }
    return visible;
  };
}
