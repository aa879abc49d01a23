import { h, takesKeys } from './dom';

export interface Keys {
  element: HTMLDialogElement;
  open(): void;
}

/** Keys for everything that is done often, and the list of them. */
export function keys(bindings: [key: string, text: string, act: () => void][]): Keys {
  const close = h('button', { class: 'main', onclick: () => dialog.close(), autofocus: true }, 'Close');
  const dialog = h(
    'dialog', { id: 'help', 'aria-labelledby': 'help-title' },
    h('h2', { id: 'help-title' }, 'Keys'),
    h('dl', {}, ...bindings.flatMap(([key, text]) => [h('dt', {}, h('kbd', {}, key === ' ' ? 'Space' : key)), h('dd', {}, text)]),
      h('dt', {}, h('kbd', {}, 'Tab')), h('dd', {}, 'on to the next control; in the phase diagram arrows move and Enter goes there')),
    close,
  );
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || dialog.open) return;
    const control = takesKeys(event.target);
    const typing = event.target instanceof HTMLElement && event.target.closest('input:not([type=range]):not([type=checkbox]), select, textarea') !== null;
    const found = bindings.find(([key]) => key === event.key);
    if (!found || typing || (control && event.key === ' ')) return;
    event.preventDefault();
    found[2]();
  });
  return { element: dialog, open: () => dialog.showModal() };
}
