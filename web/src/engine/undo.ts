import { InputError } from './errors';
import type { Live } from './live';
import type { Table } from './definitions';

/** Interventions that can be undone. */
const MOST = 20;
/** Milliseconds within which pieces of one gesture count as one intervention. */
const TOGETHER = 1000;

/** A cell before an intervention, and the parameters that the visitor had changed by then. */
export interface Before {
  live: Live;
  own: Table;
}

/** The cell before each of the last interventions, as `explorer/undo.py`. */
export class Undo {
  private readonly kept: Before[] = [];
  private gesture = '';
  private at = -Infinity;

  get count(): number {
    return this.kept.length;
  }

  /** Keep a cell, unless the intervention continues the same gesture. */
  keep(before: Before, gesture: string, now = Date.now()): void {
    if (!this.kept.length || gesture !== this.gesture || now - this.at > TOGETHER) this.kept.push(before);
    if (this.kept.length > MOST) this.kept.shift();
    this.gesture = gesture;
    this.at = now;
  }

  /** The cell before the last intervention. */
  back(): Before {
    const before = this.kept.pop();
    if (!before) throw new InputError('undo', 'nothing', 'asked for after an intervention', 'change something first');
    this.gesture = '';
    return before;
  }
}
