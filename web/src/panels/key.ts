import { h } from './dom';
import { prose } from './prose';
import { explain } from './explain';
import { say } from '../words/say';

export interface Drawn {
  /** Whether the inside of the cell is seen, whether the cell is closed, and whether it has an axis. */
  opened: boolean;
  closed: boolean;
  axial: boolean;
  /** Whether colours show the direction of filaments, also around the cell. */
  wheeled: boolean;
}

/** An explanation of the colours of the cell and the lines on it. */
export function key(drawn: () => Drawn): HTMLElement {
  const bar = h('span', { class: 'key-colours', 'aria-hidden': 'true' },
    h('span', { class: 'key-axial' }, say('key.down')), h('span', { class: 'key-ball' }, say('key.disorder')),
    h('span', { class: 'bar' }),
    h('span', { class: 'key-axial' }, say('key.up')), h('span', { class: 'key-ball' }, say('key.order')),
    h('span', { class: 'wheel' }, ...['↑', '→', '↓', '←'].map((arrow) => h('i', {}, arrow))));
  const inside = h('span', { class: 'key-inside' }, say('key.inside'));
  return h('div', { class: 'key-bar' }, inside, bar, explain(say('key.what'), () => [
    ...(drawn().opened ? [
      h('p', {}, ...prose(say('key.front'))),
      h('p', {}, ...prose(say('key.fluid'))),
    ] : []),
    ...(drawn().wheeled ? [h('p', {}, ...prose(say('key.direction')))] : []),
    ...(drawn().axial ? [
      ...(drawn().wheeled ? [] : [h('p', {}, ...prose(say(drawn().closed ? 'key.colour-closed' : 'key.colour')))]),
      h('p', {}, ...prose(say('key.zones'))),
    ] : drawn().wheeled ? [] : [h('p', {}, ...prose(say('key.sphere')))]),
    ...(drawn().closed ? [
      h('p', {}, ...prose(say('key.defects'))),
      h('p', {}, ...prose(say('key.map'))),
    ] : []),
    h('p', {}, ...prose(say('key.specks'))),
  ]));
}
