import { h } from './dom';
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
      h('p', {}, say('key.front')),
      h('p', {}, say('key.fluid')),
    ] : []),
    ...(drawn().wheeled ? [h('p', {}, say('key.direction'))] : []),
    ...(drawn().axial ? [
      ...(drawn().wheeled ? [] : [h('p', {}, say(drawn().closed ? 'key.colour-closed' : 'key.colour'))]),
      h('p', {}, say('key.zones')),
    ] : drawn().wheeled ? [] : [h('p', {}, say('key.sphere'))]),
    ...(drawn().closed ? [
      h('p', {}, say('key.defects')),
      h('p', {}, say('key.map')),
    ] : []),
    h('p', {}, say('key.specks')),
  ]));
}
