// Fields of a problem on a grid: a slider over the kept steps changes every picture of x.
'use strict';

const ZERO = 128;  // the byte of the value 0; colours are of bytes, a difference is one of bytes
const bytesOf = (text) => Array.from(atob(text), (letter) => letter.charCodeAt(0));
const textOf = (bytes) => btoa(bytes.map((byte) => String.fromCharCode(byte)).join(''));
const lessTruth = (bytes, truth) => bytes.map((byte, i) => Math.min(255, Math.max(1, ZERO + byte - truth[i])));

function showPicture(image, address, alt) {
  image.src = address;
  image.alt = alt;
}

// The step of the slider, or the last where a run kept fewer.
function showStep(figure, {found, head, labels, truth}, step) {
  const at = Math.min(step, found.iterations.length) - 1, cells = bytesOf(found.x[at]);
  const [x, missing] = figure.querySelectorAll('img'), of = `of ${DATA.optimizers[found.s]} at iteration ${found.iterations[at]}`;
  const apart = found.apart[at] === '' ? '' : `, ‖x − x*‖ ${found.apart[at]} ‖x*‖`;
  showPicture(x, `data:image/bmp;base64,${head}${found.x[at]}`, `${labels[0]} ${of}${apart}`);
  figure.querySelector('.at').textContent = found.iterations[at];
  if (missing === undefined) return;
  showPicture(missing, `data:image/bmp;base64,${head}${textOf(lessTruth(cells, truth))}`, `${labels[1]} ${of}${apart}`);
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
      element('small', {}, ' from the start to the end of each run, spread as the logarithm of its iterations'));
}

ON_UNPACK.push((place) => { if (place.matches('.problem')) makeFields(place); });
