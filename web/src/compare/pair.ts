import type { Ask } from '../protocol';

/** Milliseconds between pictures, and after which a request is repeated that has not been answered. */
const BETWEEN = 1000 / 30;
const REPEAT = 2000;
/** Refusals without a picture after which a cell counts as one that cannot go on. */
const MOST_REFUSALS = 3;

export interface Clock {
  now(): number;
  later(act: () => void, wait: number): void;
}

const REAL: Clock = { now: () => performance.now(), later: (act, wait) => void setTimeout(act, wait) };

/**
 * Two cells at one time: each computes up to a frame, and both go on from there only when both have arrived. What is
 * done to them waits for that too, so that it happens to both at the same time.
 */
export class Pair {
  playing = false;
  speed = 5;
  /** The frame that both are at or compute up to. */
  target = 0;
  /** Whether one of them cannot go on. */
  private stuck = false;
  private readonly at: [number, number] = [-1, -1];
  private acts: (() => void)[] = [];
  private due = 0;
  private asked = 0;
  private ended = false;
  private waiting = false;
  private refusals = 0;

  constructor(
    private readonly send: [(ask: Ask) => void, (ask: Ask) => void],
    private readonly every: () => number,
    private readonly clock: Clock = REAL,
  ) {
    this.watch();
  }

  get together(): boolean {
    return this.at.every((frame) => frame === this.target);
  }

  /** One of the cells, or both, begin anew, and will be at this frame. */
  begin(frame: number): void {
    this.at.fill(-1);
    this.acts = [];
    this.target = frame;
    this.stuck = false;
    this.asked = this.clock.now();
  }

  /** A picture of a cell has arrived. */
  came(which: 0 | 1, frame: number): void {
    this.at[which] = frame;
    this.refusals = 0;
    // One that was further than was known: the other follows.
    if (frame > this.target) this.reach(frame);
    this.onward();
  }

  play(on: boolean): void {
    this.playing = on;
    this.stuck = false;
    this.due = this.clock.now();
    this.onward();
  }

  /** One frame further. */
  step(): void {
    this.playing = false;
    this.act(() => this.reach(this.target + 1));
  }

  /** Do something to both cells once they are at one time. */
  act(what: () => void): void {
    this.acts.push(what);
    this.onward();
  }

  /** A request was refused: a cell that cannot go on stands still. */
  refused(): void {
    this.refusals += 1;
    if (this.together || this.refusals < MOST_REFUSALS) return;
    this.playing = false;
    this.stuck = true;
  }

  end(): void {
    this.ended = true;
  }

  private onward(): void {
    if (this.ended) return;
    while (this.together && this.acts.length) this.acts.shift()!();
    if (!this.playing || !this.together) return;
    const now = this.clock.now();
    if (now < this.due) {
      if (!this.waiting) this.clock.later(() => this.waited(), this.due - now);
      this.waiting = true;
      return;
    }
    const frames = Math.max(1, Math.round((BETWEEN / 1000) * (this.speed / this.every())));
    const pause = (1000 * frames * this.every()) / this.speed;
    // Time that was lost is not made up for.
    this.due = Math.max(this.due + pause, now);
    this.reach(this.target + frames);
  }

  private reach(frame: number): void {
    this.target = frame;
    this.asked = this.clock.now();
    for (const send of this.send) send({ do: 'reach', frame });
  }

  private waited(): void {
    this.waiting = false;
    this.onward();
  }

  /** A request may have been lost with a connection: it is repeated. */
  private watch(): void {
    if (this.ended) return;
    if (!this.stuck && !this.together && this.clock.now() - this.asked >= REPEAT) {
      this.asked = this.clock.now();
      this.send.forEach((send, which) => {
        if (this.at[which] !== this.target) send({ do: 'reach', frame: this.target });
      });
    }
    this.clock.later(() => this.watch(), REPEAT);
  }
}
