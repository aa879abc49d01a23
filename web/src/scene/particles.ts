// Tracer particles that move with the flow, shared by the cylinder and the map.

import type { Fields } from './fields';
import { flowAt } from './interpolate';
import type { Place, Surface } from './surface';

/** Positions in a trail, the head included, and seconds between them. */
export const TRAIL = 9;
const BETWEEN = 0.085;
/** Radii per second at the peak of the flow; more in cells longer than LONG, which are drawn smaller. */
export const PACE = 0.6;
/** The share of that for visitors who prefer less motion. */
export const CALM = 0.4;
const LONG = 12;
/** Below this share of the largest flow so far, particles slow down with it, so that arrest is visible. */
const SLOWS_BELOW = 0.15;
const FADE = 0.6;

const TURN = 2 * Math.PI;

export class Particles {
  readonly count: number;
  /** Row k holds the positions k steps ago: theta, z, opacity, share of the peak speed. Unwrapped along a trail. */
  readonly data: Float32Array;
  /** The share of the time to the next row that has passed, 0 to 1. */
  phase = 0;

  private readonly age: Float32Array;
  private readonly life: Float32Array;
  private readonly pace: number;
  private readonly next: Place = [0, 0];
  private surface: Surface | null = null;

  constructor(
    calm: boolean,
    count = 900,
    private readonly random: () => number = Math.random,
  ) {
    this.count = count;
    this.pace = calm ? CALM * PACE : PACE;
    this.data = new Float32Array(4 * count * TRAIL);
    this.age = new Float32Array(count);
    this.life = new Float32Array(count);
  }

  /** Spread all particles over a cell; ages differ, so that they do not all fade at once. */
  scatter(surface: Surface): void {
    this.surface = surface;
    for (let n = 0; n < this.count; n++) {
      this.renew(n);
      this.age[n] = this.random() * this.life[n];
    }
  }

  /** Move by `dt` seconds of real time in the flow as last blended. */
  step(fields: Fields, dt: number): void {
    const { surface } = fields;
    if (surface !== this.surface) this.scatter(surface);
    const reference = Math.max(fields.peak, SLOWS_BELOW * fields.largest);
    const scale = reference > 1e-12 ? (this.pace * Math.max(1, surface.length / LONG)) / reference : 0;
    this.phase += dt / BETWEEN;
    if (this.phase >= 1) {
      this.data.copyWithin(4 * this.count, 0, 4 * this.count * (TRAIL - 1));
      this.phase %= 1;
    }
    const { data, age, life, next } = this;
    const { flow, n_theta, n_z, length } = fields;
    let speed2 = 0; // of the last place asked for
    const at = (theta: number, z: number, out: Place): void => {
      flowAt(flow, n_theta, n_z, length, theta, z, out);
      speed2 = out[0] * out[0] + out[1] * out[1];
    };
    const move = scale * dt;
    for (let n = 0, p = 0; n < this.count; n++, p += 4) {
      age[n] += dt;
      if (age[n] > life[n]) {
        this.renew(n);
        continue;
      }
      const theta = data[p];
      const z = data[p + 1];
      surface.carry(theta, z, at, move, next);
      data[p] = next[0];
      data[p + 1] = next[1];
      data[p + 2] = Math.min(1, age[n] / FADE, (life[n] - age[n]) / FADE);
      data[p + 3] = reference > 0 ? Math.min(1, Math.sqrt(speed2) / reference) : 0;
      if (data[p] < 0 || data[p] >= TURN) this.shift(p, 0, data[p] < 0 ? TURN : -TURN);
      if (data[p + 1] < 0 || data[p + 1] >= length) this.shift(p, 1, data[p + 1] < 0 ? length : -length);
    }
  }

  private shift(p: number, component: number, by: number): void {
    for (let k = 0, q = p + component; k < TRAIL; k++, q += 4 * this.count) this.data[q] += by;
  }

  private renew(n: number): void {
    this.age[n] = 0;
    this.life[n] = 3 + 3 * this.random();
    const theta = this.random() * TURN;
    const { surface } = this;
    if (!surface) return;
    let z = this.random() * surface.period;
    // Evenly over the surface: fewer where circles around the cell are short.
    while (surface.closed && this.random() * surface.widest > Math.abs(surface.radius(z))) z = this.random() * surface.period;
    for (let k = 0, p = 4 * n; k < TRAIL; k++, p += 4 * this.count) {
      this.data[p] = theta;
      this.data[p + 1] = z;
      this.data[p + 2] = 0;
      this.data[p + 3] = 0;
    }
  }
}
