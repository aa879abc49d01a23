// How strongly filaments on the two sides of a line P_z = 0 differ in direction, as in `cyclosis.zones.contrast`.

import type { Surface } from './surface';

/** How far from a line streams are sought on both sides, in radii. */
export const REACH = 0.5;
/** Length averaged over on each side before that, in radii: noise does not count as a stream. */
export const GRAIN = 0.2;
/** Contrast below which a line is not drawn, and above which it is drawn in full. */
export const FAINT = 0.05;
export const PLAIN = 0.15;

/** On closed cells lines are not drawn where the radius is below the first, near the poles, where streams turn over. */
const BODY: [number, number] = [0.4, 0.6];

/** How strongly a line of some contrast is drawn, 0 to 1. */
export function weight(contrast: number): number {
  return Math.min(1, Math.max(0, (contrast - FAINT) / (PLAIN - FAINT)));
}

/** Points of a patch that reaches so far to each side of its middle: at least 3, and odd. */
function pointsWithin(reach: number, spacing: number, count: number): number {
  const eachWay = Math.max(1, Math.floor(reach / spacing + 0.5));
  return 2 * Math.min(eachWay, Math.floor((count - 1) / 2)) + 1;
}

/** Lines of a field: how many, and how far apart they begin; values on each, and how far apart these are on a line. */
interface Lines {
  lines: number;
  between: number;
  count: number;
  step: number;
  spacing(line: number): number;
}

/** Computes the contrast around every point of a periodic grid, in preallocated arrays. */
export class Contrast {
  readonly values: Float32Array;
  private readonly smooth: Float32Array;
  private readonly passed: Float32Array;
  private readonly highest: Float32Array;
  private readonly lowest: Float32Array;
  /** A line with its ends continued. */
  private readonly wrapped: Float32Array;
  private readonly along: Lines;
  private readonly across: Lines;
  /** The share of the contrast that counts, for each z. */
  private readonly counts: Float32Array;

  constructor(n_theta: number, n_z: number, surface: Surface) {
    const { period, closed, axial } = surface;
    const radii = Float32Array.from({ length: n_z }, (_, j) => Math.abs(surface.radius((j * period) / n_z)));
    const share = (r: number): number => Math.min(1, Math.max(0, (r - BODY[0]) / (BODY[1] - BODY[0])));
    this.counts = radii.map((r) => (closed ? (axial ? share(r) : 0) : 1));
    this.wrapped = new Float32Array(3 * Math.max(n_theta, n_z));
    const field = (): Float32Array => new Float32Array(n_theta * n_z);
    [this.values, this.smooth, this.passed, this.highest, this.lowest] = [field(), field(), field(), field(), field()];
    this.along = { lines: n_theta, between: n_z, count: n_z, step: 1, spacing: () => period / n_z };
    this.across = { lines: n_z, between: 1, count: n_theta, step: n_z, spacing: (j) => (2 * Math.PI * Math.max(radii[j], BODY[0])) / n_theta };
  }

  /** Set `values` to min(max p, max(-p)) around every point, where p is the theta-major P_z, smoothed. */
  of(P_z: Float32Array): Float32Array {
    const { values, smooth, passed, highest, lowest, along, across, counts, wrapped } = this;
    averaged(P_z, passed, along, wrapped);
    averaged(passed, smooth, across, wrapped);
    for (const [sign, out] of [[1, highest], [-1, lowest]] as const) {
      // The least is the largest of the opposite.
      largest(smooth, passed, along, sign, wrapped);
      largest(passed, out, across, 1, wrapped);
    }
    for (let p = 0, j = 0; p < values.length; p++, j = j + 1 < counts.length ? j + 1 : 0) {
      values[p] = counts[j] * Math.min(highest[p], lowest[p]);
    }
    return values;
  }
}

/** Copy a periodic line with so many values of its other end before and after it. */
function wrap(from: Float32Array, start: number, { count, step }: Lines, half: number, sign: number, out: Float32Array): void {
  for (let k = 0, p = start; k < count; k++, p += step) out[half + k] = sign * from[p];
  out.copyWithin(0, count, count + half);
  out.copyWithin(count + half, half, 2 * half);
}

/** Write the mean of every point's neighbourhood on periodic lines. */
function averaged(from: Float32Array, to: Float32Array, of: Lines, wrapped: Float32Array): void {
  const { lines, between, count, step, spacing } = of;
  for (let line = 0; line < lines; line++) {
    const points = pointsWithin(GRAIN, spacing(line), count);
    const start = line * between;
    wrap(from, start, of, (points - 1) / 2, 1, wrapped);
    for (let k = 0; k < count; k++) {
      let sum = 0;
      for (let m = k; m < k + points; m++) sum += wrapped[m];
      to[start + k * step] = sum / points;
    }
  }
}

/** Write the largest of every point's neighbourhood on periodic lines of a field times a sign. */
function largest(from: Float32Array, to: Float32Array, of: Lines, sign: number, wrapped: Float32Array): void {
  const { lines, between, count, step, spacing } = of;
  for (let line = 0; line < lines; line++) {
    const points = pointsWithin(REACH, spacing(line), count);
    const start = line * between;
    wrap(from, start, of, (points - 1) / 2, sign, wrapped);
    // Each pass makes the largest of twice as many values, and the last of as many as are wanted.
    const reached = count + points - 1;
    let width = 1;
    for (; 2 * width <= points; width *= 2) {
      for (let k = 0; k + 2 * width <= reached; k++) if (wrapped[k + width] > wrapped[k]) wrapped[k] = wrapped[k + width];
    }
    const rest = points - width;
    for (let k = 0; k < count; k++) {
      const [a, b] = [wrapped[k], wrapped[k + rest]];
      to[start + k * step] = a > b ? a : b;
    }
  }
}
