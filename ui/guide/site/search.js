// Finds sections that have all words: those in titles first. "sections" is the index: [address, page, title, text] each.
'use strict';
const field = document.getElementById('search'), found = document.getElementById('found');
const SHOWN = 12, AROUND = 60;
const plain = (text) => text.toLowerCase();
const list = sections.map(([address, page, title, text]) => ({address, page, title, text, titleWords: plain(`${page} ${title}`), words: plain(text)}));

const scoreOf = (section, words) => {
  let score = 0;
  for (const word of words) {
    const inTitle = section.titleWords.includes(word), inText = section.words.includes(word);
    if (!inTitle && !inText) return 0;
    score += (inTitle ? 10 : 0) + (inText ? 1 : 0);
  }
  return score;
};
const excerpt = (section, word) => {
  const at = Math.max(0, section.words.indexOf(word) - AROUND);
  return `${at > 0 ? '… ' : ''}${section.text.slice(at, at + 2 * AROUND)} …`;
};
const search = () => {
  const words = plain(field.value).split(/\s+/).filter((word) => word.length > 1);
  found.replaceChildren();
  if (!words.length) return;
  const best = list.map((section) => ({section, score: scoreOf(section, words)})).filter((each) => each.score > 0);
  best.sort((a, b) => b.score - a.score);
  for (const {section} of best.slice(0, SHOWN)) {
    const item = document.createElement('li'), link = document.createElement('a'), small = document.createElement('small');
    link.href = section.address;
    link.textContent = section.title === section.page ? section.page : `${section.page}: ${section.title}`;
    small.textContent = excerpt(section, words[0]);
    item.append(link, small);
    found.append(item);
  }
  if (!best.length) found.append(Object.assign(document.createElement('li'), {textContent: 'Nothing found.'}));
};
field.addEventListener('input', search);
for (const link of document.querySelectorAll('nav li a'))
  if (link.getAttribute('href') === (location.pathname.split('/').pop() || 'index.html')) link.setAttribute('aria-current', 'page');
