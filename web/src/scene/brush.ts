// Strokes of a brush: points dense enough to overlap, sent in batches.

export type Point = [number, number];

const TURN = 2 * Math.PI;
/** Milliseconds between batches: each is a step of the protocol. */
const PAUSE = 150;

/** The nearest copy of `to` as seen from `from`, with period `period`. */
export function nearest(from: number, to: number, period: number): number {
  return to - period * Math.round((to - from) / period);
}

export function wrap(value: number, period: number): number {
  const wrapped = ((value % period) + period) % period;
  return wrapped < period ? wrapped : 0;
}

export class Stroke {
  private waiting: Point[] = [];
  private last: Point | null = null;
  private sent: number;

  constructor(
    private readonly send: (points: Point[]) => void,
    private readonly radius: number,
    private readonly length: number,
    now: number,
  ) {
    this.sent = now;
  }

  /** Add a point, and those between it and the previous one, across the seam if that is shorter. */
  add(point: Point, now: number): void {
    if (this.last) {
      const [theta, z] = this.last;
      const dx = nearest(theta, point[0], TURN) - theta;
      const dz = nearest(z, point[1], this.length) - z;
      const step = Math.max(this.radius / 2.5, 0.02);
      const distance = Math.hypot(dx, dz);
      if (distance < step) return;
      // A pointer that leaves the cell and returns elsewhere has not painted in between.
      const pieces = distance > 2 ? 1 : Math.ceil(distance / step);
      for (let k = 1; k <= pieces; k++) {
        this.waiting.push([wrap(theta + (k / pieces) * dx, TURN), wrap(z + (k / pieces) * dz, this.length)]);
      }
    } else {
      this.waiting.push([wrap(point[0], TURN), wrap(point[1], this.length)]);
    }
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
