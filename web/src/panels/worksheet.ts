import type { Hub } from './hub';
import { h } from './dom';
import { prose } from './prose';
import { said, say } from '../words/say';

/** Ten questions for a class: the cell of each opens behind them, and its answer stays folded until it is wanted. */
export function worksheet(hub: Hub): { element: HTMLDialogElement; open(): void } {
  const items = (): HTMLElement[] => hub.about.worksheet.map(({ question, attempt, answer, link }, k) => {
    const text = (part: string, english: string): string => said(`worksheet.${k + 1}${part}`, english);
    return h('li', {},
      h('strong', {}, text('', question)),
      h('p', {}, ...prose(text('.try', attempt))),
      h('div', { class: 'row' }, h('button', { class: 'open-cell', 'aria-label': say('worksheet.open-cell', { k: k + 1 }), onclick: () => {
        dialog.close();
        hub.ask({ do: 'begin', link });
      } }, say('worksheet.open'))),
      h('details', { class: 'inner' }, h('summary', {}, say('worksheet.answer')), h('p', {}, ...prose(text('.answer', answer)))));
  });
  const list = h('ol', {});
  const dialog = h('dialog', { id: 'worksheet', 'aria-labelledby': 'worksheet-title' },
    h('div', { class: 'row spread' }, h('h2', { id: 'worksheet-title' }, say('worksheet.title')),
      h('button', { class: 'quiet', autofocus: true, 'aria-label': say('keys.close'), onclick: () => dialog.close() }, '✕')),
    h('p', { class: 'note' }, say('worksheet.text')),
    list);
  const open = (): void => {
    if (!list.firstChild) list.append(...items());
    dialog.showModal();
  };
  return { element: dialog, open };
}
