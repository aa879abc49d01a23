// Short, evenly spread pieces of streamlines.

import type { Fields } from './fields';
import { flowAt } from './interpolate';

/** Points of one line. */
export const POINTS = 13;
const HALF = (POINTS - 1) / 2;
const MOST = 420;
/** Flow slower than this share of the peak gets no line. */
const SLOWEST = 0.03;

export class Streamlines {
  /** Positions (theta, z) of the points of each line, downstream, unwrapped. */
  readonly points = new Float32Array(2 * POINTS * MOST);
  /** Speed at the middle of each line as a share of the peak. */
  readonly speed = new Float32Array(MOST);
  count = 0;

  private taken = new Uint8Array(0);

  /**
   * Place lines about `spacing` radii apart. Seeds are tried in a fixed order that is evenly spread, so that lines
   * bend with the flow rather than jump.
   */
  lay(fields: Fields, spacing: number): void {
    const { length, peak } = fields;
    this.count = 0;
    if (fields.empty || !(peak > 1e-12)) return;
    const columns = Math.max(8, Math.round((4 * Math.PI) / spacing));
    const rows = Math.max(4, Math.round((2 * length) / spacing));
    if (this.taken.length !== columns * rows) this.taken = new Uint8Array(columns * rows);
    else this.taken.fill(0);
    const square = (theta: number, z: number): number => {
      const i = Math.floor((theta / (2 * Math.PI)) * columns);
      const j = Math.floor((z / length) * rows);
      return (((i % columns) + columns) % columns) * rows + (((j % rows) + rows) % rows);
    };
    const velocity: [number, number] = [0, 0];
    const tries = Math.min(3000, 2 * columns * rows);
    for (let n = 1; n <= tries && this.count < MOST; n++) {
      const theta = ((n * 0.7548776662466927) % 1) * 2 * Math.PI;
      const z = ((n * 0.5698402909980532) % 1) * length;
      if (this.taken[square(theta, z)]) continue;
      flowAt(fields.flow, fields.n_theta, fields.n_z, length, theta, z, velocity);
      const speed = Math.hypot(velocity[0], velocity[1]) / peak;
      if (speed < SLOWEST) continue;
      const line = this.count;
      this.trace(fields, line, theta, z, (spacing * (0.5 + 1.3 * Math.min(1, speed))) / (POINTS - 1), velocity);
      this.speed[line] = Math.min(1, speed);
      const first = 2 * POINTS * line;
      let crowded = 0;
      for (let k = 0; k < POINTS; k++) {
        crowded += this.taken[square(this.points[first + 2 * k], this.points[first + 2 * k + 1])];
      }
      if (crowded > 2) continue;
      this.count++;
      for (let k = 0; k < POINTS; k++) {
        const at = square(this.points[first + 2 * k], this.points[first + 2 * k + 1]);
        const [i, j] = [Math.floor(at / rows), at % rows];
        // The square and its neighbours on both sides are kept free of others.
        this.taken[at] = 1;
        this.taken[((i + 1) % columns) * rows + j] = 1;
        this.taken[((i + columns - 1) % columns) * rows + j] = 1;
      }
    }
  }

  private trace(fields: Fields, line: number, theta: number, z: number, step: number, v: [number, number]): void {
    const { flow, n_theta, n_z, length } = fields;
    const first = 2 * POINTS * line;
    for (const way of [-1, 1]) {
      let x = theta;
      let y = z;
      for (let k = 0; k <= HALF; k++) {
        const at = first + 2 * (HALF + way * k);
        this.points[at] = x;
        this.points[at + 1] = y;
        flowAt(flow, n_theta, n_z, length, x, y, v);
        let size = Math.hypot(v[0], v[1]) || 1;
        flowAt(flow, n_theta, n_z, length, x + (0.5 * way * step * v[0]) / size, y + (0.5 * way * step * v[1]) / size, v);
        size = Math.hypot(v[0], v[1]) || 1;
        x += (way * step * v[0]) / size;
        y += (way * step * v[1]) / size;
      }
    }
  }
}
