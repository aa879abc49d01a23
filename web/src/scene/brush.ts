// Strokes of a brush: points dense enough to overlap, sent in batches.

import type { Place, Surface } from './surface';

/** Milliseconds between batches: each is a step of the protocol. */
const PAUSE = 150;

export class Stroke {
  private waiting: Place[] = [];
  private last: Place | null = null;
  private sent: number;

  constructor(
    private readonly send: (points: Place[]) => void,
    private readonly radius: number,
    private readonly surface: Surface,
    now: number,
  ) {
    this.sent = now;
  }

  /** Add a point, and those between it and the previous one, across the seam if that is shorter. */
  add(point: Place, now: number): void {
    const { surface, last } = this;
    if (last) {
      const step = Math.max(this.radius / 2.5, 0.02);
      const distance = surface.apart(last, point);
      if (distance < step) return;
      // A pointer that leaves the cell and returns elsewhere has not painted in between.
      const pieces = distance > 2 ? 1 : Math.ceil(distance / step);
      for (let k = 1; k < pieces; k++) this.waiting.push(surface.between(last, point, k / pieces));
    }
    this.waiting.push(surface.within(...point));
    this.last = point;
    // The newest point is held back, so that there is always one to send at the end of a stroke.
    if (now - this.sent >= PAUSE && this.waiting.length > 1) {
      this.send(this.waiting.splice(0, this.waiting.length - 1));
      this.sent = now;
    }
  }

  end(): void {
    if (this.waiting.length) this.send(this.waiting);
    this.waiting = [];
  }
}
