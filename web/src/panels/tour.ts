import { h, mathematics } from './dom';
import { STORY, type Stage } from './story';

export interface Tour {
  element: HTMLElement;
  start(): void;
}

/** Six steps through the paper's story, beside the living cell: it never covers what it speaks of. */
export function tour(stage: Stage): Tour {
  let at = -1;
  let opener: HTMLElement | null = null;
  const title = h('h2', { id: 'tour-title', tabindex: -1 });
  const text = h('p', { id: 'tour-text' });
  const count = h('span', { class: 'note' });
  const back = h('button', { id: 'tour-back', onclick: () => go(at - 1) }, 'Back');
  const next = h('button', { id: 'tour-next', class: 'main', onclick: () => go(at + 1) }, 'Next');
  const leaveButton = h('button', { id: 'tour-leave', class: 'quiet', 'aria-label': 'leave the tour', title: 'leave (Escape)', onclick: () => leave() }, '✕');
  const element = h(
    'section', { id: 'tour-card', 'aria-labelledby': 'tour-title', hidden: true },
    h('div', { class: 'row spread' }, title, count, leaveButton), text, h('div', { class: 'row' }, back, next),
  );

  const unmark = (): void => document.querySelectorAll('.marked').forEach((found) => found.classList.remove('marked'));
  const leave = (): void => {
    at = -1;
    unmark();
    element.hidden = true;
    opener?.focus();
  };
  const go = (k: number): void => {
    const step = STORY[k];
    if (!step) return leave();
    at = k;
    unmark();
    // Backwards, so that the first is in view where not all can be.
    for (const selector of step.marks.toReversed()) {
      const marked = document.querySelector<HTMLElement>(selector);
      const folded = marked?.closest('details');
      if (folded) folded.open = true;
      marked?.classList.add('marked');
      const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
      marked?.scrollIntoView({ block: 'nearest', behavior: still ? 'auto' : 'smooth' });
    }
    count.textContent = `${k + 1} of ${STORY.length}`;
    title.textContent = step.title;
    text.replaceChildren(...step.text.split(/(α_[pu])/).map((piece) => (piece.startsWith('α_') ? mathematics(piece) : piece)));
    back.disabled = k === 0;
    next.textContent = k === STORY.length - 1 ? 'Done' : 'Next';
    element.hidden = false;
    title.focus({ preventScroll: true });
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
