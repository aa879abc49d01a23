// The last two frames, laid out for drawing, and the transition from one to the other.

import type { Frame } from '../protocol';
import { Contrast } from './contrast';
import { CylinderSurface, type Surface } from './surface';

/** Milliseconds between frames that count towards the mean interval; longer gaps are pauses. */
const BRIEFEST = 16;
const LONGEST = 1500;

/**
 * Fields on the chart (theta, z) of a surface, periodic in both. On a closed surface z runs up a meridian and down
 * the one behind it: the chart is smooth over the poles, and every place is in it twice.
 */
export class Fields {
  surface: Surface = new CylinderSurface(1);
  n_theta = 0;
  /** Points along the chart, and its period. */
  n_z = 0;
  length = 1;
  /** Peak speed now, and the largest since the cell began. */
  peak = 0;
  largest = 0;
  /** Number of the newest frame, -1 without any. */
  frame = -1;
  /** Counts frames, so that others see when something is new. */
  version = 0;
  /** Four values per point: P_z (|P| on a sphere) and the contrast around it before, and both now. */
  order = new Float32Array(0);
  /** Four values per point: P_theta and P_z before, and both now. */
  vector = new Float32Array(0);
  /** Flow at the moment of the last `blend`: u_theta, u_z for each point. */
  flow = new Float32Array(0);

  /** Whether the next frame is shown at once. */
  hurried = false;

  private before = new Float32Array(0);
  private now = new Float32Array(0);
  private contrast = new Contrast(1, 1, this.surface);
  private arrived = 0;
  private interval = 60;

  get empty(): boolean {
    return this.frame < 0;
  }

  /** Add a new frame at time `at` (ms) on a surface; the transition to it begins with the present picture. */
  take(frame: Frame, surface: Surface, at: number): void {
    const rows = surface.closed ? 2 * (frame.n_z - 1) : frame.n_z;
    const points = frame.n_theta * rows;
    const another = this.empty || frame.n_theta !== this.n_theta || rows !== this.n_z || surface !== this.surface;
    if (another) {
      if (this.order.length !== 4 * points) {
        this.order = new Float32Array(4 * points);
        this.vector = new Float32Array(4 * points);
        this.flow = new Float32Array(2 * points);
        this.before = new Float32Array(2 * points);
        this.now = new Float32Array(2 * points);
      }
      this.n_theta = frame.n_theta;
      this.n_z = rows;
      this.length = surface.period;
      this.surface = surface;
      this.contrast = new Contrast(frame.n_theta, rows, surface);
    }
    const { order, vector, before, now } = this;
    const { P_theta, P_z, shown, u_theta, u_z } = charted(frame, surface);
    const contrast = this.contrast.of(shown);
    const m = another ? 0 : this.mixing(at);
    for (let p = 0, q = 0, r = 0; p < points; p++, q += 4, r += 2) {
      order[q] += m * (order[q + 2] - order[q]);
      order[q + 1] += m * (order[q + 3] - order[q + 1]);
      order[q + 2] = shown[p];
      order[q + 3] = contrast[p];
      vector[q] += m * (vector[q + 2] - vector[q]);
      vector[q + 1] += m * (vector[q + 3] - vector[q + 1]);
      vector[q + 2] = P_theta[p];
      vector[q + 3] = P_z[p];
      before[r] += m * (now[r] - before[r]);
      before[r + 1] += m * (now[r + 1] - before[r + 1]);
      now[r] = u_theta[p];
      now[r + 1] = u_z[p];
    }
    if (another || this.hurried) {
      for (let q = 0; q < order.length; q += 4) {
        order[q] = order[q + 2];
        order[q + 1] = order[q + 3];
        vector[q] = vector[q + 2];
        vector[q + 1] = vector[q + 3];
      }
      before.set(now);
    }
    this.hurried = false;
    if (!another) {
      const gap = at - this.arrived;
      if (gap < LONGEST) this.interval += 0.3 * (Math.max(gap, BRIEFEST) - this.interval);
    }
    this.arrived = at;
    this.peak = frame.peak_speed;
    this.largest = Math.max(this.largest, frame.peak_speed);
    this.frame = frame.frame;
    this.version++;
  }

  /** The progress of the transition at time `at` (ms), from 0 to 1. */
  mixing(at: number): number {
    return Math.min(1, Math.max(0, (at - this.arrived) / this.interval));
  }

  /** Set `flow` to a point of the transition. */
  blend(mixing: number): void {
    const { flow, before, now } = this;
    for (let r = 0; r < flow.length; r++) flow[r] = before[r] + mixing * (now[r] - before[r]);
  }

  clear(): void {
    this.frame = -1;
    this.peak = 0;
    this.largest = 0;
    this.interval = 60;
    this.version++;
  }
}

/** P and the flow on the chart of a surface. */
type Charted = Pick<Frame, 'P_theta' | 'P_z' | 'u_theta' | 'u_z'> & { shown: Float32Array };

/** P and the flow as they are drawn, and what of P has a colour: P_z, or |P| on a sphere, which has no axis. */
function charted(frame: Frame, surface: Surface): Charted {
  if (!surface.closed) return { ...frame, shown: frame.P_z };
  const { P_theta, P_z, n_theta, n_z } = frame;
  const twice = (field: Float32Array, sign: number): Float32Array => doubled(field, n_theta, n_z, sign);
  return {
    P_theta: twice(P_theta, -1),
    P_z: twice(P_z, -1),
    shown: surface.axial ? twice(P_z, -1) : twice(P_z.map((value, p) => Math.hypot(value, P_theta[p])), 1),
    u_theta: twice(frame.u_theta, -1),
    u_z: twice(frame.u_z, -1),
  };
}

/**
 * A field of a closed surface, given from pole to pole, on its chart: beyond a pole follows the meridian behind, where
 * components have the other sign.
 */
export function doubled(field: Float32Array, n_theta: number, n_z: number, sign: number): Float32Array {
  const last = n_z - 1;
  const rows = 2 * last;
  const out = new Float32Array(n_theta * rows);
  const behind = [Math.floor(n_theta / 2), Math.ceil(n_theta / 2)];
  for (let i = 0; i < n_theta; i++) {
    const to = i * rows;
    const [a, b] = behind.map((half) => ((i + half) % n_theta) * n_z);
    for (let j = 0; j <= last; j++) out[to + j] = field[i * n_z + j];
    for (let j = last + 1; j < rows; j++) out[to + j] = 0.5 * sign * (field[a + rows - j] + field[b + rows - j]);
  }
  return out;
}
