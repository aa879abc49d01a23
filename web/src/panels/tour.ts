import { h } from './dom';
import { prose } from './prose';
import { place } from './place';
import { STORY, type Stage } from './story';
import { isKey, say, type Key } from '../words/say';
import type { Hub } from './hub';
import { keptPalette } from './dress';

export interface Tour {
  element: HTMLElement;
  start(): void;
}

/** Milliseconds after which the page has settled following a step. */
const SETTLING = 6000;

/** Six steps through the paper's story, next to the living cell: the card never covers what it describes. */
export function tour(stage: Stage): Tour {
  let at = -1;
  let opener: HTMLElement | null = null;
  let began = 0;
  const title = h('h2', { id: 'tour-title', tabindex: -1 });
  const text = h('p', { id: 'tour-text' });
  const count = h('span', { class: 'note' });
  const back = h('button', { id: 'tour-back', onclick: () => go(at - 1) }, say('tour.back'));
  const next = h('button', { id: 'tour-next', class: 'main', onclick: () => go(at + 1) }, say('tour.next'));
  const leaveButton = h('button', { id: 'tour-leave', class: 'quiet', 'aria-label': say('tour.leave'), title: say('tour.leave-tip'), onclick: () => leave() }, '✕');
  const element = h(
    'section', { id: 'tour-card', 'aria-labelledby': 'tour-title', hidden: true },
    h('div', { class: 'row spread' }, title, count, leaveButton), text, h('div', { class: 'row' }, back, next),
  );

  const unmark = (): void => document.querySelectorAll('.marked').forEach((found) => found.classList.remove('marked'));
  const marks = (): HTMLElement[] =>
    (STORY[at]?.marks ?? []).map((mark) => document.querySelector<HTMLElement>(mark)).filter((found) => found !== null);
  const leave = (): void => {
    at = -1;
    unmark();
    element.hidden = true;
    delete document.documentElement.dataset.tour;
    opener?.focus();
  };

  /** Scroll to the elements described, and place the card where it does not cover them. */
  const settle = (): void => {
    if (at < 0) return;
    const behavior = matchMedia('(prefers-reduced-motion: reduce)').matches ? 'auto' : 'smooth';
    const root = document.documentElement;
    root.style.setProperty('--tour', `${element.offsetHeight}px`); // as much more can be scrolled
    if (root.scrollHeight <= innerHeight) {
      // The page itself does not scroll: its panels do. Backwards, so that the first is in view where not all can be.
      element.dataset.end = 'bottom';
      for (const mark of marks().toReversed()) mark.scrollIntoView({ block: 'nearest', behavior });
      return;
    }
    const stretches = marks().map((mark) => {
      const { top, bottom } = mark.getBoundingClientRect();
      return { top: top + scrollY, bottom: bottom + scrollY };
    });
    const found = place(stretches, innerHeight, element.offsetHeight, root.scrollHeight - innerHeight, scrollY);
    element.dataset.end = found.end;
    scrollTo({ top: found.scroll, behavior });
  };
  // A step may change the page a little later; once the visitor scrolls, the page is left alone.
  const resized = new ResizeObserver(() => performance.now() - began < SETTLING && settle());
  resized.observe(document.body);
  for (const name of ['wheel', 'touchstart', 'pointerdown', 'keydown']) addEventListener(name, () => (began = -Infinity), { capture: true, passive: true });
  // A telephone's browser changes the window's height while its bar slides in and out, as the visitor scrolls.
  let width = innerWidth;
  addEventListener('resize', () => {
    if (innerWidth !== width) settle();
    width = innerWidth;
  });

  const go = (k: number): void => {
    const step = STORY[k];
    if (!step) return leave();
    at = k;
    began = performance.now();
    unmark();
    resized.disconnect();
    resized.observe(document.body);
    document.documentElement.dataset.tour = String(k);
    for (const marked of marks()) {
      const folded = marked.closest('details');
      if (folded) folded.open = true;
      marked.classList.add('marked');
      resized.observe(marked);
    }
    count.textContent = say('tour.count', { k: k + 1, all: STORY.length });
    title.textContent = say(`tour.${k + 1}` as Key);
    text.replaceChildren(...prose(say(`tour.${k + 1}-text` as Key, { colours: coloured(stage.hub) })));
    text.scrollTop = 0;
    back.disabled = k === 0;
    next.textContent = say(k === STORY.length - 1 ? 'tour.done' : 'tour.next');
    element.hidden = false;
    title.focus({ preventScroll: true });
    settle();
    step.act(stage);
  };
  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && at >= 0 && !document.querySelector('dialog[open]')) leave();
  });
  const start = (): void => {
    opener = document.activeElement instanceof HTMLElement ? document.activeElement : null;
    go(0);
  };
  return { element, start };
}

/** What the colours mean, in the palette in use. */
function coloured(hub: Hub): string {
  const key = `tour.${keptPalette(hub.about.palettes).name}`;
  return isKey(key) ? say(key) : '';
}
