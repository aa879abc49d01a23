import { h, takesKeys } from './dom';
import { keep, kept } from './kept';
import { explained, glossary, symbols, titleOf } from './prose';
import { say } from '../words/say';

export interface Keys {
  element: HTMLDialogElement;
  open(): void;
}

/** Keys for frequent actions, and a list of them. */
export function keys(bindings: [key: string, text: string, act: () => void][]): Keys {
  const on = h('input', { type: 'checkbox', id: 'keys-on', checked: kept('keys') !== 'off', onchange: () => keep('keys', on.checked ? 'on' : 'off') });
  const close = h('button', { class: 'main', onclick: () => dialog.close(), autofocus: true }, say('keys.close'));
  const meanings = h('dl', { class: 'glossary' });
  const dialog = h(
    'dialog', { id: 'help', 'aria-labelledby': 'help-title' },
    h('div', { class: 'row spread' }, h('h2', { id: 'help-title' }, say('keys.title')), close),
    h('dl', {}, ...bindings.flatMap(([key, text]) => [h('dt', {}, h('kbd', {}, key === ' ' ? say('keys.space') : key)), h('dd', {}, text)]),
      h('dt', {}, h('kbd', {}, 'Tab')), h('dd', {}, say('keys.tab'))),
    h('p', {}, h('label', {}, on, say('keys.everywhere'))),
    h('h2', {}, say('glossary.title')),
    meanings,
  );
  document.addEventListener('keydown', (event) => {
    if (!on.checked || event.ctrlKey || event.metaKey || event.altKey || dialog.open || (event.repeat && event.key !== '.')) return;
    const control = takesKeys(event.target);
    const typing = event.target instanceof HTMLElement && event.target.closest('input:not([type=range]):not([type=checkbox]), select, textarea') !== null;
    const found = bindings.find(([key]) => key === event.key);
    if (!found || typing || (control && event.key === ' ')) return;
    event.preventDefault();
    found[2]();
  });
  const open = (): void => {
    if (!meanings.firstChild) meanings.append(...glossary().flatMap((name) => [h('dt', {}, titleOf(name)), h('dd', {}, ...symbols(explained(name)))]));
    dialog.showModal();
  };
  return { element: dialog, open };
}
