// Tabs: one is laid out at a time. Each has an address, and so has each problem, card and claim in
// them; what is large is made when its tab is first opened. Paper shows the open one.
const TABS = [...document.querySelectorAll('main > .tab')];
const FIRST = TABS[0].id;

// What is packed waits as text in a noscript element; without scripts it stands as it is.
function unpack(place) {
  const packed = place.querySelector(':scope > noscript');
  if (packed === null) return false;
  packed.insertAdjacentHTML('afterend', packed.textContent);
  packed.remove();
  place.querySelectorAll('table.sortable').forEach(makeSortable);
  place.querySelectorAll('table').forEach(addCopies);
  ON_UNPACK.forEach((made) => made(place));
  return true;
}
const ON_UNPACK = [];  // what scripts add to what was unpacked

// But what is folded: that waits until it is opened.
function unpackAll(place, inTime = (packed, work) => work()) {
  for (const packed of place.querySelectorAll('.packed'))
    if (packed.closest('details:not([open])') === null) inTime(packed, () => unpack(packed));
}

// What an address names, though it be packed: the element, or the place that holds it.
function placeOf(id) {
  if (id === '') return document.getElementById(FIRST);
  const there = document.getElementById(id);
  if (there !== null) return there;
  for (const packed of document.querySelectorAll('.packed'))
    if (packed.querySelector(':scope > noscript')?.textContent.includes(`id="${id}"`) ||
        packed.querySelector(':scope > noscript')?.textContent.includes(`id=${id}`)) {
      unpack(packed);
      return document.getElementById(id);
    }
  return null;
}

// Of problems and cards one is shown, the others wait.
function showOne(chosen) {
  for (const other of chosen.parentElement.querySelectorAll(':scope > .one')) other.classList.toggle('chosen', other === chosen);
  unpack(chosen);
}

// Its parts one after the other where the address names the tab, else at once: it names one of them.
function showTab(tab, isNamed) {
  for (const other of TABS) other.classList.toggle('open', other === tab);
  for (const link of document.querySelectorAll('.bars nav a'))
    if (link.hash === `#${tab.id}`) link.setAttribute('aria-current', 'page'); else link.removeAttribute('aria-current');
  const nav = document.querySelector('.bars nav'), current = nav.querySelector('[aria-current]');
  document.getElementById('left-out').textContent = worded('left-out', {tabs: [...nav.querySelectorAll('a:not([aria-current])')].map((link) => link.textContent).join(', ')});
  nav.scrollLeft = current.offsetLeft - nav.clientWidth / 2;  // on a phone the tabs scroll
  unpackAll(tab, isNamed ? soon : undefined);
  for (const place of new Set([...tab.querySelectorAll('.one')].map((one) => one.parentElement)))
    if (place.querySelector(':scope > .chosen') === null && tab.id === 'problems') showOne(place.querySelector(':scope > .one'));
}

// Opens what the address names, with its head below the bars.
function openAddress() {
  const id = decodeURIComponent(location.hash.slice(1)), place = placeOf(id) ?? document.getElementById(FIRST);
  const tab = place.closest('.tab') ?? document.getElementById(FIRST), one = place.closest('.one');
  showTab(tab, place === tab);
  if (one !== null) showOne(one);
  for (let around = place; around !== null; around = around.parentElement)
    if (around.tagName === 'DETAILS') {
      around.open = true;
      unpack(around);
      unpackAll(around);
    }
  refreshAll();
  document.documentElement.style.scrollPaddingTop = `${document.querySelector('.bars').offsetHeight + 6}px`;
  if (place === tab) return scrollTo({top: 0, behavior: 'instant'});
  const showHead = () => place.scrollIntoView({behavior: 'instant'});
  showHead();
  soon(openAddress, showHead);  // once more where drawing what it opened has moved it
}

function makeTabs() {
  document.addEventListener('toggle', ({target}) => {
    if (target.open !== true) return;
    if (target.matches('.claim')) unpack(target);
    unpackAll(target);
  }, true);
  addEventListener('hashchange', openAddress);
  document.addEventListener('click', (event) => {  // the same address again says the same
    const link = event.target.closest('a[href^="#"]');
    if (link !== null && link.hash === location.hash) openAddress();
  });
  // Paper has the open tab, whole and drawn.
  addEventListener('beforeprint', () => [...STALE].filter((one) => one.closest('.tab.open') !== null).forEach(refresh));
}
