import { h } from './dom';

/** One sentence at a time, for what was refused or failed. */
export function toaster(): { element: HTMLElement; toast(sentence: string): void } {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const text = h('span');
  const hide = (): void => {
    element.classList.remove('shown');
    text.textContent = '';
  };
  const element = h('div', { id: 'toast', role: 'alert' }, text, h('button', { class: 'quiet', 'aria-label': 'dismiss', onclick: hide }, '✕'));
  const toast = (sentence: string): void => {
    text.textContent = sentence;
    element.classList.add('shown');
    clearTimeout(timer);
    timer = setTimeout(hide, 4000 + 60 * sentence.length);
  };
  return { element, toast };
}

/** A lost connection, and the way back. */
export function lostBanner(reconnect: () => void): { element: HTMLElement; show(sentence: string): void; hide(): void } {
  const text = h('span');
  const button = h('button', { id: 'reconnect', class: 'main', onclick: reconnect }, 'Reconnect');
  const element = h('div', { id: 'lost', role: 'alert', hidden: true }, text, ' ', button);
  return {
    element,
    show: (sentence) => {
      text.textContent = sentence;
      element.hidden = false;
    },
    hide: () => (element.hidden = true),
  };
}
