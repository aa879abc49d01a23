import { h } from './dom';
import { say } from '../words/say';

const APART = 8;
let count = 0;

/**
 * A small button that opens an explanation of `about`, by touch, mouse or key; Escape or a tap elsewhere closes it.
 * `fill` returns its content each time it opens.
 */
export function explain(about: string, fill: () => (Node | string)[]): HTMLElement {
  const id = `explained-${(count += 1)}`;
  const box = h('div', { id, class: 'explained', popover: 'auto', role: 'note' });
  const button = h('button', {
    class: 'explain', type: 'button', popovertarget: id, 'aria-label': say('page.explain', { what: about }), 'aria-expanded': 'false',
  }, '?');
  const refill = (): void => box.replaceChildren(...fill());
  if (typeof box.showPopover === 'function') {
    box.addEventListener('beforetoggle', (event) => {
      if ((event as ToggleEvent).newState === 'open') refill();
    });
    box.addEventListener('toggle', (event) => {
      const open = (event as ToggleEvent).newState === 'open';
      button.setAttribute('aria-expanded', String(open));
      if (open) beside(box, button);
    });
  } else {
    // Browsers without popovers unfold it in place.
    box.hidden = true;
    button.addEventListener('click', () => {
      refill();
      box.hidden = !box.hidden;
      button.setAttribute('aria-expanded', String(!box.hidden));
    });
  }
  return h('span', { class: 'explains' }, button, box);
}

/** Below the button, or above where there is no room, and within the window. */
export function beside(box: HTMLElement, button: HTMLElement): void {
  const at = button.getBoundingClientRect();
  const { offsetWidth: width, offsetHeight: height } = box;
  const left = Math.max(APART, Math.min(at.left, innerWidth - width - APART));
  const below = at.bottom + APART / 2;
  const top = below + height + APART <= innerHeight ? below : Math.max(APART, at.top - height - APART / 2);
  box.style.left = `${left}px`;
  box.style.top = `${top}px`;
}

/** A list of names, values and meanings. */
export function table(rows: [string, string, string][]): HTMLElement {
  return h('dl', {}, ...rows.flatMap(([name, value, meaning]) => [
    h('dt', {}, name), h('dd', {}, h('strong', {}, value), h('small', {}, meaning)),
  ]));
}
