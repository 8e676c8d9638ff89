// Fields of a problem on a grid, with one byte per cell, painted on a canvas. A slider over the
// stored iterations changes every image of x.
const ZERO = 128;  // the byte of the value 0
const bytesOf = (letters) => Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
const lessTruth = (bytes, truth) => bytes.map((byte, i) => Math.min(255, Math.max(1, ZERO + byte - truth[i])));

// Of each byte its colour: greys, or blue below 0 and orange above. Both arms are straight lines of
// even steps in Oklab (Ottosson 2020), to one lightness and chroma, in hues that stay apart in all
// three dichromacies.
const RAMPS = {
  grey: (byte) => `rgb(${byte} ${byte} ${byte})`,
  diverging: (byte) => {
    const share = Math.min(1, 2 * Math.abs(byte - ZERO) / 127);
    return `oklch(${0.97 - 0.5 * share} ${0.105 * share} ${byte < ZERO ? 255 : 55})`;
  },
};

const PALETTES = new Map();
function paletteOf(ramp) {
  if (!PALETTES.has(ramp)) {
    const context = new OffscreenCanvas(256, 1).getContext('2d');
    for (let byte = 0; byte < 256; ++byte) {
      context.fillStyle = RAMPS[ramp](byte);
      context.fillRect(byte, 0, 1, 1);
    }
    PALETTES.set(ramp, new Uint32Array(context.getImageData(0, 0, 256, 1).data.buffer));
  }
  return PALETTES.get(ramp);
}

function paint(canvas, bytes = bytesOf(atob(canvas.dataset.cells))) {
  const context = canvas.getContext('2d', {willReadFrequently: true}), image = context.createImageData(canvas.width, canvas.height), palette = paletteOf(canvas.dataset.ramp);
  new Uint32Array(image.data.buffer).set(Uint32Array.from(bytes, (byte) => palette[byte]));
  context.putImageData(image, 0, 0);
}

// The step of the slider, or the last where a run kept fewer.
function showStep(figure, {found, labels, truth}, step) {
  const at = Math.min(step, found.iterations.length) - 1, cells = bytesOf(found.x[at]);
  const [x, missing] = figure.querySelectorAll('canvas'), of = `of ${DATA.optimizers[found.s]} at iteration ${found.iterations[at]}`;
  const apart = found.apart[at] === '' ? '' : `, ‖x − x*‖ ${found.apart[at]} ‖x*‖`;
  const show = (canvas, bytes, label) => {
    paint(canvas, bytes);
    canvas.setAttribute('aria-label', `${label} ${of}${apart}`);
  };
  show(x, cells, labels[0]);
  figure.querySelector('.at').textContent = found.iterations[at];
  if (missing === undefined) return;
  show(missing, lessTruth(cells, truth), labels[1]);
  figure.querySelector('.apart').textContent = found.apart[at];
}

function makeFields(article) {
  const fields = article.querySelector('.fields'), {fields: data} = DATA.problems[Number(article.dataset.p)] ?? {};
  if (fields === null || data === undefined) return;
  const most = Math.max(...data.found.map((found) => found.iterations.length)), truth = bytesOf(data.truth);
  if (most < 2) return;
  const slider = element('input', {type: 'range', min: 1, max: most, step: 1, value: most}), told = element('output', {}, `${most} of ${most}`);
  slider.setAttribute('aria-label', 'Kept step of each method');
  slider.addEventListener('input', () => {
    told.textContent = `${slider.value} of ${most}`;
    slider.setAttribute('aria-valuetext', `step ${told.textContent}`);
    for (const found of data.found)
      showStep(fields.querySelector(`figure[data-s="${found.s}"]`), {...data, found, truth}, Number(slider.value));
  });
  slider.setAttribute('aria-valuetext', `step ${most} of ${most}`);
  fields.querySelector('.steps').append(element('label', {}, 'Step ', told, ' ', slider),
      element('small', {}, ' from the start to the end of each run, evenly spaced in the logarithm of the iteration'));
}

// All pictures of a place: x and x − x* at the end of each run, and x*, are in the data.
function paintAll(place, fields) {
  place.querySelectorAll('[data-cells]').forEach((canvas) => paint(canvas));
  const truth = bytesOf(fields?.truth ?? ''), exact = place.querySelector('.given canvas:not([data-cells])');
  if (exact !== null) paint(exact, truth);
  for (const {s, x} of fields?.found ?? []) {
    const [own, missing] = place.querySelectorAll(`figure[data-s="${s}"] canvas`), cells = bytesOf(x[x.length - 1]);
    paint(own, cells);
    if (missing !== undefined) paint(missing, lessTruth(cells, truth));
  }
}

ON_UNPACK.push((place) => {
  paintAll(place, DATA.problems[place.dataset.p]?.fields);
  if (place.matches('.problem')) makeFields(place);
});
