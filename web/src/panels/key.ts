import { h } from './dom';
import { explain } from './explain';

export interface Drawn {
  /** Whether the inside of the cell is seen, whether the cell is closed, and whether it has an axis. */
  opened: boolean;
  closed: boolean;
  axial: boolean;
}

/** An explanation of the colours of the cell and the lines on it. */
export function key(drawn: () => Drawn): HTMLElement {
  const bar = h('span', { class: 'key-colours', 'aria-hidden': 'true' },
    h('span', { class: 'key-axial' }, 'down'), h('span', { class: 'key-ball' }, 'disorder'),
    h('span', { class: 'bar' }),
    h('span', { class: 'key-axial' }, 'up'), h('span', { class: 'key-ball' }, 'order'));
  const inside = h('span', { class: 'key-inside' }, 'wall: filaments · inside: fluid');
  return h('div', { class: 'key-bar' }, inside, bar, explain('what is drawn on the cell', () => [
    ...(drawn().opened ? [
      h('p', {}, 'The front of the cell is taken away. Specks in it move with the fluid of the vacuole, which the streaming wall drags along; the disc is a section through the middle.'),
      h('p', {}, 'Their colour says whether the fluid moves up or down: full where it is as fast as the fastest flow on the wall, grey (on the disc nearly black) where it does not move along the cell. The wall behind shows filaments.'),
    ] : []),
    ...(drawn().axial ? [
      h('p', {}, `Colour says which way filaments point, up or down${drawn().closed ? ' along the cell' : ''}, and is nearly black where they disagree or run around the cell.`),
      h('p', {}, 'White lines are the indifferent zones: filaments on their two sides point in opposite directions. In disorder there are none.'),
    ] : [h('p', {}, 'A sphere has no axis by which up and down would mean anything: colour says how much filaments agree, from black for not at all.')]),
    ...(drawn().closed ? [
      h('p', {}, 'Small discs are points where filaments have no direction: around a plus they turn once with the way around it, around a minus once against it.'),
      h('p', {}, 'The map shows all of the surface with true areas, from the south pole at the bottom to the north pole.'),
    ] : []),
    h('p', {}, 'White specks move with the flow. On the map dark streaks show it too: it runs towards their thick ends.'),
  ]));
}
