import type { Hub } from './hub';
import { h, panel } from './dom';
import { short } from './scales';
import { prose } from './prose';
import { heard, say } from '../words/say';

/** The actions on this cell, past and to come. */
export function interventions(hub: Hub): HTMLElement {
  const list = h('ol', { id: 'interventions', tabindex: 0, 'aria-label': say('done.title') });
  const none = h('p', { class: 'note' }, ...prose(say('done.none')));
  let shown = '';
  let steps: [number, HTMLElement][] = [];
  const mark = (t: number): void => steps.forEach(([at, item]) => item.classList.toggle('ahead', at > t));
  hub.on('cell', (cell) => {
    const text = JSON.stringify([cell.protocol, cell.setup.scales]);
    if (text !== shown) {
      shown = text;
      steps = cell.protocol.map(({ at, text }) => [at, h('li', { title: text }, h('span', { class: 'at' }, hub.units.scales ? hub.units.lasting(at, 4) : `t = ${short(at, 4)}`), ' ', worded(text))]);
      list.replaceChildren(...steps.map(([, item]) => item));
      list.scrollTop = list.scrollHeight;
      none.hidden = steps.length > 0;
    }
    mark(cell.t);
  });
  hub.on('frame', (frame) => mark(frame.t));
  return panel('interventions', say('done.title'), false, none, list);
}

/** A step without its time: what was done, and where. */
function worded(text: string): string {
  const [, what, where] = /^(?:t = [^:]*: )?(.*?)(, in .*)?$/.exec(text)!;
  return heard(what!) + (where ?? '');
}
