import type { Hub } from './hub';
import { h, panel } from './dom';
import { short } from './scales';

/** The actions on this cell, past and to come. */
export function interventions(hub: Hub): HTMLElement {
  const list = h('ol', { id: 'interventions', tabindex: 0, 'aria-label': 'What was done' });
  const none = h('p', { class: 'note' }, 'Nothing yet. Whatever you change, cut or add is listed here and kept in the address.');
  let shown = '';
  let steps: [number, HTMLElement][] = [];
  const mark = (t: number): void => steps.forEach(([at, item]) => item.classList.toggle('ahead', at > t));
  hub.on('cell', (cell) => {
    const text = JSON.stringify(cell.protocol);
    if (text !== shown) {
      shown = text;
      steps = cell.protocol.map(({ at, text }) => [at, h('li', { title: text }, h('span', { class: 'at' }, `t = ${short(at, 4)}`), ' ', text.replace(/^t = [^:]*: /, ''))]);
      list.replaceChildren(...steps.map(([, item]) => item));
      list.scrollTop = list.scrollHeight;
      none.hidden = steps.length > 0;
    }
    mark(cell.t);
  });
  hub.on('frame', (frame) => mark(frame.t));
  return panel('interventions', 'What was done', false, none, list);
}
