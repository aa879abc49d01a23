import { h } from './dom';
import { explain } from './explain';

/** An explanation of the colours of the cell and the lines on it. */
export function key(): HTMLElement {
  const bar = h('span', { class: 'key-colours', 'aria-hidden': 'true' }, 'down', h('span', { class: 'bar' }), 'up');
  return h('div', { class: 'key-bar' }, bar, explain('what is drawn on the cell', () => [
    h('p', {}, 'Colour says which way filaments point, up or down, and is nearly black where they disagree or run around the cell.'),
    h('p', {}, 'White lines are the indifferent zones: filaments on their two sides point in opposite directions. In disorder there are none.'),
    h('p', {}, 'White specks move with the flow. On the map dark streaks show it too: it runs towards their thick ends.'),
  ]));
}
