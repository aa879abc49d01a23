import type { Hub } from './hub';
import { h } from './dom';
import { keep, kept } from './kept';
import { say } from '../words/say';

export interface InsideTarget {
  /** Whether the cell can be opened at all: the map alone cannot. */
  readonly opens: boolean;
  /** How many tracers to ask for, and their pace in radii a second. */
  readonly wanted: { tracers: number; pace: number };
  setOpen(open: boolean): void;
}

export interface InsideSwitch {
  element: HTMLElement;
  readonly on: boolean;
  toggle(): void;
}

/** Milliseconds within which the server has not answered yet. */
const ANSWERING = 2000;

/** The switch that opens the cylinder, so that the flow in the vacuole is seen. The browser remembers it. */
export function insideSwitch(hub: Hub, target: InsideTarget, root: HTMLElement, now: () => number = Date.now): InsideSwitch {
  let on = target.opens && kept('inside') === 'on';
  let asked = -Infinity;
  /** Whether the present cell is one to look into: a closed cell is not. */
  let possible = target.opens;
  const button = h('button', {
    id: 'inside', type: 'button', title: say('inside.tip'), hidden: !target.opens,
    onclick: () => toggle(),
  }, say('inside.button'));
  const ask = (): void => {
    asked = now();
    hub.ask(on ? { do: 'vacuole', on, ...target.wanted } : { do: 'vacuole', on });
  };
  const show = (): void => {
    button.setAttribute('aria-pressed', String(on));
    const open = on && possible;
    button.hidden = !possible;
    root.classList.toggle('opened', open);
    target.setOpen(open);
  };
  const toggle = (): void => {
    if (!possible) return;
    on = !on;
    keep('inside', on ? 'on' : 'off');
    show();
    ask();
  };
  // A new session knows nothing of it, and a request may have been lost with a connection.
  hub.on('cell', (cell) => {
    const before = possible;
    possible = target.opens && hub.modelOf(cell).straight;
    if (possible !== before) show();
    if (!possible) return;
    if (on !== (cell.vacuole !== undefined) && now() - asked > ANSWERING) ask();
  });
  show();
  return { element: button, get on() { return on && possible; }, toggle };
}
