// The lines of the charts: a colour a kind of method, highlighting, and names at their ends.
'use strict';

const DATA = JSON.parse(document.getElementById('data').textContent);
const MARKERS = ['circle', 'rect', 'triangle', 'rectRot', 'crossRot'];
const FEW = 12;  // as many lines have their range drawn
const BAND = '22';  // how much of its colour a range over seeds has
const NARROW = 640;  // pixels

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

// Asked of the style sheet once a theme.
const COLOURS = new Map();
function cssColour(name) {
  const key = name + isDark();
  if (!COLOURS.has(key)) COLOURS.set(key, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return COLOURS.get(key);
}

// Kind, dash and marker of each, fixed by its name: the style sheet has the same.
const colourOf = (index) => cssColour(`--${DATA.styles[index][0]}`);
const dashOf = (index) => DATA.styles[index][1].split(' ').filter(Boolean).map(Number);
const markerOf = (index) => MARKERS[DATA.styles[index][2]];

function lineStyle(index) {
  const colour = colourOf(index);
  return {
    optimizer: index, borderColor: colour, backgroundColor: colour, borderDash: dashOf(index),
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

const END_HEIGHT = 13;  // of a name, in pixels

// Where each name goes: below those above it that it would meet, in one pass from top to bottom.
// Each is placed once, so that no rounding can make this go on.
function placedEnds(ends) {
  const placed = [];
  for (const end of [...ends].sort((a, b) => a.y - b.y)) {
    let y = end.y;
    for (const other of placed)  // from top to bottom, as they were placed
      if (end.x < other.x + other.width && other.x < end.x + end.width && Math.abs(other.y - y) < END_HEIGHT) y = other.y + END_HEIGHT;
    placed.push({...end, y});
    placed.sort((a, b) => a.y - b.y);
  }
  return placed;
}

// Names at the ends of the lines; where the chart is narrow the table beside it must do.
const END_LABELS = {
  id: 'endLabels',
  afterDatasetsDraw(chart) {
    if (chart.width < NARROW || !chart.options.hasEndLabels) return;
    const context = chart.ctx;
    context.save();
    context.font = '11.5px system-ui, sans-serif';
    context.textBaseline = 'middle';
    const ends = chart.data.datasets.filter((set) => set.optimizer !== undefined && set.data.length > 0).map((set) => {
      const last = set.data[set.data.length - 1], width = context.measureText(set.label).width;
      const x = Math.min(chart.scales.x.getPixelForValue(last.x) + 5, chart.width - width - 2);
      return {set, x, width, y: chart.scales.y.getPixelForValue(last.y)};
    });
    for (const end of placedEnds(ends)) {
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
