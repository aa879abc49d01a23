import { h } from './dom';
import { say } from '../words/say';

/** One sentence at a time, when something was refused or failed. */
export function toaster(): { element: HTMLElement; toast(sentence: string): void } {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const text = h('span');
  const hide = (): void => {
    element.classList.remove('shown');
    text.textContent = '';
  };
  const element = h('div', { id: 'toast', role: 'alert' }, text, h('button', { class: 'quiet', 'aria-label': say('page.dismiss'), onclick: hide }, '✕'));
  const toast = (sentence: string): void => {
    text.textContent = sentence;
    element.classList.add('shown');
    clearTimeout(timer);
    timer = setTimeout(hide, 4000 + 60 * sentence.length);
  };
  return { element, toast };
}

/** A lost connection, with buttons to reconnect and to go on without; the page tries by itself unless it is `over`. */
export function lostBanner(reconnect: () => void, move: () => void): {
  element: HTMLElement;
  /** `movable`: whether the cell can go on in the browser. */
  show(sentence: string, over: boolean, movable: boolean): void;
  hide(): void;
} {
  const text = h('span');
  const button = h('button', { id: 'reconnect', class: 'main', onclick: reconnect }, say('page.try-now'));
  const other = h('button', { id: 'move', onclick: move, title: say('page.move-title') }, say('page.move'));
  const element = h('div', { id: 'lost', role: 'alert', hidden: true }, text, ' ', button, other);
  return {
    element,
    show: (sentence, over, movable) => {
      const words = over ? sentence : say('page.reconnecting', { sentence });
      // Announced once, however often it is tried.
      if (text.textContent !== words) text.textContent = words;
      button.textContent = say(over ? 'page.continue' : 'page.try-now');
      other.hidden = !movable;
      element.hidden = false;
    },
    hide: () => {
      element.hidden = true;
      text.textContent = '';
    },
  };
}
