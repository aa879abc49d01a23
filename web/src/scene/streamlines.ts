// Short, evenly spread pieces of streamlines.

import type { Fields } from './fields';
import { flowAt } from './interpolate';
import type { Place, Velocity } from './surface';

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
    const { peak, surface } = fields;
    const { length } = surface;
    this.count = 0;
    if (fields.empty || !(peak > 1e-12)) return;
    const columns = Math.max(8, Math.round((4 * Math.PI) / spacing));
    const rows = Math.max(4, Math.round((2 * length) / spacing));
    if (this.taken.length !== columns * rows) this.taken = new Uint8Array(columns * rows);
    else this.taken.fill(0);
    // On a closed cell squares of one width: fewer of them in short circles around it.
    const wide = (j: number): number => Math.max(1, Math.round(columns * Math.abs(surface.radius(((j + 0.5) / rows) * length))));
    const widths = Array.from({ length: rows }, (_, j) => (surface.closed ? Math.min(columns, wide(j)) : columns));
    const square = (theta: number, z: number): number => {
      const [angle, s] = surface.within(theta, z);
      const j = Math.min(rows - 1, Math.floor((s / length) * rows));
      const i = Math.floor((angle / (2 * Math.PI)) * widths[j]);
      return Math.min(i, widths[j] - 1) * rows + j;
    };
    const velocity: Place = [0, 0];
    const { flow, n_theta, n_z, length: period } = fields;
    // Lines are followed at one speed.
    const along: Velocity = (theta, z, out) => {
      flowAt(flow, n_theta, n_z, period, theta, z, out);
      const size = Math.hypot(out[0], out[1]) || 1;
      out[0] /= size;
      out[1] /= size;
    };
    const tries = Math.min(3000, (surface.closed ? 3 : 2) * columns * rows);
    for (let n = 1; n <= tries && this.count < MOST; n++) {
      const theta = ((n * 0.7548776662466927) % 1) * 2 * Math.PI;
      const z = ((n * 0.5698402909980532) % 1) * length;
      if (this.taken[square(theta, z)]) continue;
      if (surface.closed && Math.abs(surface.radius(z)) < ((n * 0.3819660112501051) % 1) * surface.widest) continue;
      flowAt(flow, n_theta, n_z, period, theta, z, velocity);
      const speed = Math.hypot(velocity[0], velocity[1]) / peak;
      if (speed < SLOWEST) continue;
      const line = this.count;
      this.trace(fields, line, [theta, z], (spacing * (0.5 + 1.3 * Math.min(1, speed))) / (POINTS - 1), along);
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
        this.taken[((i + 1) % widths[j]) * rows + j] = 1;
        this.taken[((i + widths[j] - 1) % widths[j]) * rows + j] = 1;
      }
    }
  }

  private trace({ surface }: Fields, line: number, start: Place, step: number, along: Velocity): void {
    const first = 2 * POINTS * line;
    const next: Place = [0, 0];
    for (const way of [-1, 1]) {
      let [x, y] = start;
      for (let k = 0; k <= HALF; k++) {
        const at = first + 2 * (HALF + way * k);
        this.points[at] = x;
        this.points[at + 1] = y;
        surface.carry(x, y, along, way * step, next);
        [x, y] = next;
      }
    }
  }
}
