// The guide to this page, docs/reading-a-report.md, as Markdown that the report contains: this lays out what
// that file uses.
function guideText(text) {
  const star = '\u0001', parts = text.replaceAll('\\*', star).split(/(`[^`]+`|\*\*[^*]+\*\*|\*[^*]+\*|!?\[[^\]]*\]\([^)]*\))/);
  return parts.filter((part) => !part.startsWith('![')).map((part) => {
    const inner = part.replace(/^(`|\*\*|\*)([\s\S]*)\1$/, '$2').replace(/^\[([^\]]*)\]\([^)]*\)$/, '$1').replaceAll(star, '*').replaceAll('\\|', '|');
    return inner === part || part.startsWith('[') ? inner : element(part.startsWith('`') ? 'code' : part.startsWith('**') ? 'b' : 'em', {}, inner);
  });
}

function guideTable(lines) {
  const row = (line, tag) => element('tr', {}, ...line.split(/(?<!\\)\|/).slice(1, -1).map((text) => element(tag, {className: 'text'}, ...guideText(text.trim()))));
  return element('table', {}, element('thead', {}, row(lines[0], 'th')), element('tbody', {}, ...lines.slice(2).map((line) => row(line, 'td'))));
}

function guideParts(markdown) {
  return [...markdown.matchAll(/```[^\n]*\n([\s\S]*?)```|(.+(?:\n(?!```).+)*)/g)].map(([, code, block]) => {
    if (code !== undefined) return element('pre', {}, code);
    const heading = /^#+ /.exec(block)?.[0].length, lines = block.split('\n'), items = block.split(/(?:^|\n)\s*(?:-|\d+\.) /);
    if (heading !== undefined) return element(`h${heading}`, {}, ...guideText(block.slice(heading)));
    if (block.startsWith('|')) return guideTable(lines);
    if (items[0] === '' && items.length > 1) return element(block.startsWith('-') ? 'ul' : 'ol', {}, ...items.slice(1).map((item) => element('li', {}, ...guideText(item))));
    return element('p', {}, ...guideText(block));
  });
}

function offerGuide(place) {
  const button = pressable(place.textContent, undefined, () => showDrawer(element('div', {className: 'guide'}, ...guideParts(DATA.guide))));
  button.className = 'evidence';
  place.replaceChildren(button);
}
