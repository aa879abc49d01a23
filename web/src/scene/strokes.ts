// The particles' trails on a canvas.

import { TRAIL, type Particles } from './particles';

/** Parts of a trail, from its head on, each drawn alike. */
const PARTS: [number, number][] = [[0, 2], [2, 4], [4, 6], [6, TRAIL - 1]];
/** Opacities of particles that are drawn alike. */
const GROUPS: [number, number][] = [[0.1, 0.55], [0.55, 2]];

/** Writes the pixel of (theta, s); returns whether it is seen. */
export type Projection = (theta: number, s: number, out: [number, number]) => boolean;

/**
 * Draw the trails of every `nth` particle in few strokes of many pieces. A piece longer than `far` pixels is left out: on
 * a map that is a trail that comes back elsewhere.
 */
export function strokeTrails(context: CanvasRenderingContext2D, { data, count, phase }: Particles, nth: number, project: Projection, far = Infinity): void {
  const row = 4 * count;
  const at: [number, number] = [0, 0];
  context.strokeStyle = '#fff';
  context.lineCap = 'butt';
  for (const [dim, bright] of GROUPS) {
    PARTS.forEach(([from, to], part) => {
      context.beginPath();
      for (let p = 0; p < row; p += 4 * nth) {
        const opacity = data[p + 2];
        if (opacity < dim || opacity >= bright || data[p + 3] < 0.02) continue;
        let begun = false;
        let before = 0;
        for (let k = from, q = p + from * row; k <= to; k++, q += row) {
          if (!project(data[q], data[q + 1], at)) {
            begun = false;
            continue;
          }
          if (begun && Math.abs(at[0] - before) <= far) context.lineTo(at[0], at[1]);
          else context.moveTo(at[0], at[1]);
          begun = true;
          before = at[0];
        }
      }
      const along = 1 - (part + 0.25 * phase) / PARTS.length;
      context.globalAlpha = 0.85 * along ** 1.5 * (dim > 0.5 ? 1 : 0.4);
      context.lineWidth = 0.5 + 1.5 * along;
      context.stroke();
    });
  }
  context.globalAlpha = 1;
}
