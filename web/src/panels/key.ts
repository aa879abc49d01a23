import { h } from './dom';
import { explain } from './explain';

/** An explanation of the colours of the cell and the lines on it; `opened` is whether its inside is seen. */
export function key(opened: () => boolean): HTMLElement {
  const bar = h('span', { class: 'key-colours', 'aria-hidden': 'true' }, 'down', h('span', { class: 'bar' }), 'up');
  const inside = h('span', { class: 'key-inside' }, 'wall: filaments · inside: fluid');
  return h('div', { class: 'key-bar' }, inside, bar, explain('what is drawn on the cell', () => [
    ...(opened() ? [
      h('p', {}, 'The front of the cell is taken away. Specks in it move with the fluid of the vacuole, which the streaming wall drags along; the disc is a section through the middle.'),
      h('p', {}, 'Their colour says whether the fluid moves up or down: full where it is as fast as the fastest flow on the wall, grey (on the disc nearly black) where it does not move along the cell. The wall behind shows filaments.'),
    ] : []),
    h('p', {}, 'Colour says which way filaments point, up or down, and is nearly black where they disagree or run around the cell.'),
    h('p', {}, 'White lines are the indifferent zones: filaments on their two sides point in opposite directions. In disorder there are none.'),
    h('p', {}, 'White specks move with the flow. On the map dark streaks show it too: it runs towards their thick ends.'),
  ]));
}
