// The lines of the charts: one colour a method, highlighting, and names at their ends.
'use strict';

const DATA = JSON.parse(document.getElementById('data').textContent);
const SHOWN_AT_FIRST = 8;
// Near Okabe and Ito (2008), moved apart until every two differ to readers with any colour blindness.
const COLOURS = {
  light: ['#1a4796', '#9a3d04', '#0d8b59', '#ce97af', '#f29102', '#07b7ff', '#04014f', '#6a556f'],
  dark: ['#587ba7', '#c65a00', '#14c56f', '#f1c8cd', '#ffa50e', '#b7c7ff', '#c562f8', '#887e7b'],
};
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3], [14, 4]];
const MARKERS = ['circle', 'rect', 'triangle', 'rectRot', 'crossRot'];
const FEW = 12;  // as many lines are all shown at first
const BAND = '22';  // how much of its colour a range over seeds has
const NARROW = 640;  // pixels

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

const cssColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// One colour a method in every chart; settings of the same method differ by dash and marker.
const STYLES = (() => {
  const methods = new Map(), variants = new Map();
  return DATA.methods.map((method) => {
    if (!methods.has(method)) methods.set(method, methods.size);
    const variant = variants.get(method) ?? 0;
    variants.set(method, variant + 1);
    const place = methods.get(method);
    return {colour: place % 8, dash: (Math.floor(place / 8) + variant) % DASHES.length, marker: MARKERS[variant % MARKERS.length]};
  });
})();
const colourOf = (index) => COLOURS[isDark() ? 'dark' : 'light'][STYLES[index].colour];
const dashOf = (index) => DASHES[STYLES[index].dash];

function lineStyle(index) {
  return {
    optimizer: index, borderColor: colourOf(index), backgroundColor: colourOf(index), borderDash: dashOf(index),
    borderWidth: 1.8, pointRadius: 0, pointHoverRadius: 4, pointHitRadius: 6, tension: 0, showLine: true,
  };
}

// Leaves one optimizer in full colour, or all of them: `index` undefined.
function highlight(chart, index) {
  if (!chart || chart.lit === index) return;
  chart.lit = index;
  for (const set of chart.data.datasets) {
    if (set.bandOf !== undefined)
      set.backgroundColor = colourOf(set.bandOf) + (index !== undefined && set.bandOf !== index ? '08' : BAND);
    if (set.optimizer === undefined) continue;
    const isFaded = index !== undefined && set.optimizer !== index;
    set.borderColor = colourOf(set.optimizer) + (isFaded ? '28' : '');
    set.borderWidth = index === set.optimizer ? 3 : 1.8;
    set.order = isFaded ? 2 : 1;
  }
  chart.update('none');
}

// Names at the ends of the lines, pushed apart; where the chart is narrow the legend must do.
const END_LABELS = {
  id: 'endLabels',
  afterDatasetsDraw(chart) {
    if (chart.width < NARROW || !chart.options.hasEndLabels) return;
    const context = chart.ctx, height = 13, placed = [];
    const ends = chart.data.datasets.filter((set) => set.optimizer !== undefined && set.data.length > 0).map((set) => {
      const last = set.data[set.data.length - 1];
      return {set, x: chart.scales.x.getPixelForValue(last.x) + 5, y: chart.scales.y.getPixelForValue(last.y)};
    }).sort((a, b) => a.y - b.y);
    context.save();
    context.font = '11.5px system-ui, sans-serif';
    context.textBaseline = 'middle';
    for (const end of ends) {
      const width = context.measureText(end.set.label).width;
      const meets = (other) => Math.abs(other.y - end.y) < height && end.x < other.x + other.width && other.x < end.x + width;
      end.x = Math.min(end.x, chart.width - width - 2);
      for (let other; (other = placed.find(meets));) end.y = other.y + height;
      placed.push({x: end.x, y: end.y, width});
      if (end.y > chart.height - 30) continue;
      context.lineWidth = 3;
      context.strokeStyle = cssColour('--paper');
      context.strokeText(end.set.label, end.x, end.y);
      context.fillStyle = end.set.borderColor;
      context.fillText(end.set.label, end.x, end.y);
    }
    context.restore();
  },
};
