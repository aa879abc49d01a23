// The cylinder painted by the processor, pixel by pixel, as the shaders of `cylinder.ts` draw it: for the first picture,
// and where WebGL is missing or too slow. It draws neither closed cells nor the inside.

import type { Palette } from '../protocol';
import { weight } from './contrast';
import type { BrushMark } from './cylinder';
import type { Fields } from './fields';
import { Enlarger } from './interpolate';
import { DirectionTable, paletteTable, rgb, solidColours, type Rgb } from './palette';
import type { Particles } from './particles';
import { strokeTrails, type Projection } from './strokes';
import type { View } from './view';

const TURN = 2 * Math.PI;
const COLOURS = 1024;
/** Points of the enlarged fields, between which values are linear. */
const FINE = 128;
const OPAQUE = 255 << 24;

export class FlatCylinder {
  readonly canvas = document.createElement('canvas');
  private readonly context = this.canvas.getContext('2d', { willReadFrequently: true })!;
  private image = this.context.createImageData(1, 1);
  private pixels = new Uint32Array(1);
  private enlarger = new Enlarger(4, 4, FINE, FINE);
  private readonly P_z = new Float32Array(FINE * FINE);
  private readonly contrast = new Float32Array(FINE * FINE);
  private readonly vector = [new Float32Array(FINE * FINE), new Float32Array(FINE * FINE)] as const;
  private seen = '';
  private colours = new Uint8Array(0);
  private directions: DirectionTable | null = null;
  private zone: Rgb = [0, 0, 0];
  private solid: Record<'ink' | 'paper' | 'shade', Rgb> = { ink: [0, 0, 0], paper: [0, 0, 0], shade: [0, 0, 0] };

  constructor(palette: Palette, dark: boolean) {
    this.setPalette(palette);
    this.setDark(dark);
  }

  setPalette(palette: Palette): void {
    this.seen = '';
    this.colours = paletteTable(palette, COLOURS);
    this.directions = palette.wheel && new DirectionTable(palette.wheel);
    this.zone = rgb(palette.zone);
  }

  setDark(dark: boolean): void {
    this.seen = '';
    const { ink, paper, shade } = solidColours(dark);
    this.solid = { ink: rgb(ink), paper: rgb(paper), shade: rgb(shade) };
  }

  /** Show the fields from this view; `again` if they are to be painted anew even if the view is the same. */
  draw(fields: Fields, mixing: number, view: View, ratio: number, again = true): void {
    const seen = [view.width, view.height, view.scale, view.turn, view.tilt, view.centre, ratio].join();
    if (again || seen !== this.seen) this.paint(fields, mixing, view, ratio);
    this.seen = seen;
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.putImageData(this.image, 0, 0);
  }

  private paint(fields: Fields, mixing: number, view: View, ratio: number): void {
    const [width, height] = [Math.max(1, Math.round(view.width * ratio)), Math.max(1, Math.round(view.height * ratio))];
    this.fit(width, height, fields);
    this.pixels.fill(0);
    const { enlarger, P_z, contrast, vector } = this;
    enlarger.enlarge(fields.order, 0, mixing, P_z);
    enlarger.enlarge(fields.order, 1, mixing, contrast);
    if (this.directions) vector.forEach((part, k) => enlarger.enlarge(fields.vector, k, mixing, part));
    const radius = view.scale * ratio;
    const first = Math.max(0, Math.ceil(0.5 * width - radius - 0.5));
    const last = Math.min(width - 1, Math.floor(0.5 * width + radius - 0.5));
    let before = new Float32Array(height);
    let values = new Float32Array(height);
    for (let x = first; x <= last; x++) {
      const across = (x + 0.5 - 0.5 * width) / radius;
      this.column(x, across, values, x > first ? before : null, fields, view, ratio);
      this.end(x, across, fields, view, ratio);
      [before, values] = [values, before];
    }
  }

  clear(): void {
    const { canvas, context } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
  }

  /** Draw particles and the brush over the picture of the same view. */
  drawMoving(particles: Particles, nth: number, mark: BrushMark, { surface }: Fields, view: View, ratio: number): void {
    const { context } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { width, height, scale, turn, centre } = view;
    const [cos, sin] = [Math.cos(view.tilt), Math.sin(view.tilt)];
    const project: Projection = (theta, s, out) => {
      const near = Math.cos(theta - turn);
      out[0] = 0.5 * width + scale * Math.sin(theta - turn);
      out[1] = 0.5 * height - scale * ((s - surface.half - centre) * cos - near * sin);
      return near > 0 && s >= 0 && s <= surface.length;
    };
    strokeTrails(context, particles, nth, project);
    if (!mark.shown) return;
    const at: [number, number] = [0, 0];
    let begun = false;
    context.beginPath();
    const edge = surface.edge([mark.theta, mark.z], mark.radius, 72);
    for (const [theta, s] of [...edge, edge[0]]) {
      const seen = project(theta, s, at);
      if (seen && begun) context.lineTo(...at);
      else if (seen) context.moveTo(...at);
      begun = seen;
    }
    context.strokeStyle = 'rgba(255, 255, 255, 0.95)';
    context.lineWidth = 1.5;
    context.stroke();
  }

  private fit(width: number, height: number, { n_theta, n_z }: Fields): void {
    const { canvas, context, enlarger } = this;
    if (canvas.width !== width || canvas.height !== height || this.pixels.length !== width * height) {
      canvas.width = width;
      canvas.height = height;
      this.image = context.createImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
    }
    if (enlarger.n_theta !== n_theta || enlarger.n_z !== n_z) this.enlarger = new Enlarger(n_theta, n_z, FINE, FINE);
  }

  /** One column of pixels of the skin. P_z in it is written into `values`; `before` are those of the column to the left. */
  private column(x: number, across: number, values: Float32Array, before: Float32Array | null, { surface }: Fields, view: View, ratio: number): void {
    const { pixels, P_z, contrast, colours, directions, vector, zone, solid } = this;
    const { width, height } = this.canvas;
    const { half, length } = surface;
    const radius = view.scale * ratio;
    const [cos, sin] = [Math.cos(view.tilt), Math.sin(view.tilt)];
    const depth = Math.sqrt(Math.max(0, 1 - across * across));
    const light = 0.5 + 0.5 * depth ** 0.55;
    const gloss = 255 * 0.045 * Math.exp(-18 * (across + 0.34) ** 2);
    const lineLight = 0.72 + 0.28 * Math.sqrt(depth);
    const side = radius * (1 - Math.abs(across));
    const u = ((((view.turn + Math.asin(across)) / TURN) * FINE - 0.5) % FINE + FINE) % FINE;
    const left = Math.floor(u) % FINE;
    const right = (left + 1) % FINE;
    const a = u - Math.floor(u);
    // The height on the cell falls evenly from row to row.
    const top = ((0.5 * height - 0.5) / radius + depth * sin) / cos + view.centre;
    const step = 1 / (radius * cos);
    const from = Math.max(0, Math.ceil((top - half) / step));
    const to = Math.min(height - 1, Math.floor((top + half) / step));
    const steep = radius * cos;
    const thick = 1.25 * ratio;
    for (let y = from; y <= to; y++) {
      const s = top - y * step + half;
      const v = (1 - s / length) * FINE - 0.5;
      const low = Math.floor(v);
      const b = v - low;
      const above = FINE * ((low + FINE) % FINE);
      const below = FINE * ((low + 1 + FINE) % FINE);
      const p = above + left, q = above + right, r = below + left, t = below + right;
      const wp = (1 - b) * (1 - a), wq = (1 - b) * a, wr = b * (1 - a), wt = b * a;
      const P = (values[y] = wp * P_z[p] + wq * P_z[q] + wr * P_z[r] + wt * P_z[t]);
      let red: number, green: number, blue: number;
      if (directions) {
        const [one, other] = vector;
        const colour = directions.of(
          wp * one[p] + wq * one[q] + wr * one[r] + wt * one[t],
          wp * other[p] + wq * other[q] + wr * other[r] + wt * other[t],
        );
        red = colour & 255;
        green = (colour >> 8) & 255;
        blue = (colour >> 16) & 255;
      } else {
        const k = 4 * Math.min(COLOURS - 1, Math.max(0, (0.5 * (COLOURS - 1) * (1 + P) + 0.5) | 0));
        red = colours[k];
        green = colours[k + 1];
        blue = colours[k + 2];
      }
      red = red * light + gloss;
      green = green * light + gloss;
      blue = blue * light + gloss;
      // The indifferent zone: of constant width.
      const along = y > from ? P - values[y - 1] : 0;
      const aside = before ? P - before[y] : 0;
      const distance = Math.abs(P) / (Math.sqrt(along * along + aside * aside) + 1e-7);
      if (distance < thick + 0.6) {
        const line = (1 - smoothstep(thick - 0.6, thick + 0.6, distance)) * weight(wp * contrast[p] + wq * contrast[q] + wr * contrast[r] + wt * contrast[t]);
        red += line * (zone[0] * lineLight - red);
        green += line * (zone[1] * lineLight - green);
        blue += line * (zone[2] * lineLight - blue);
      }
      const edge = Math.min(side, s * steep, (length - s) * steep);
      if (edge < 1.4 * ratio) {
        const inner = smoothstep(0, 1.4 * ratio, edge);
        red = solid.ink[0] + inner * (red - solid.ink[0]);
        green = solid.ink[1] + inner * (green - solid.ink[1]);
        blue = solid.ink[2] + inner * (blue - solid.ink[2]);
      }
      pixels[y * width + x] = pixelOf(red, green, blue);
    }
  }

  /** One column of pixels of the end that is seen. */
  private end(x: number, across: number, { surface }: Fields, view: View, ratio: number): void {
    const { pixels, solid } = this;
    const { width, height } = this.canvas;
    const radius = view.scale * ratio;
    const [cos, sin] = [Math.cos(view.tilt), Math.sin(view.tilt)];
    if (Math.abs(sin) < 1e-6) return;
    const depth = Math.sqrt(Math.max(0, 1 - across * across));
    const centre = (Math.sign(sin) * surface.half - view.centre) * cos;
    const rise = Math.abs(sin) * depth;
    const from = Math.max(0, Math.ceil(0.5 * height - 0.5 - radius * (centre + rise)));
    const to = Math.min(height - 1, Math.floor(0.5 * height - 0.5 - radius * (centre - rise)));
    for (let y = from; y <= to; y++) {
      const near = (centre - (0.5 * height - y - 0.5) / radius) / sin;
      const r = Math.hypot(across, near);
      const turned = smoothstep(0.35, 1, r) * (0.75 + 0.25 * near);
      const rim = (radius * (1 - r)) / Math.max(1, Math.hypot(across, near / Math.max(Math.abs(sin), 0.02)) / Math.max(r, 1e-3));
      const inner = smoothstep(0, 1.4 * ratio, rim);
      const part = (c: 0 | 1 | 2): number => solid.ink[c] + inner * (solid.paper[c] + turned * (solid.shade[c] - solid.paper[c]) - solid.ink[c]);
      pixels[y * width + x] = pixelOf(part(0), part(1), part(2));
    }
  }
}

function smoothstep(low: number, high: number, value: number): number {
  const t = Math.min(1, Math.max(0, (value - low) / (high - low)));
  return t * t * (3 - 2 * t);
}

function pixelOf(red: number, green: number, blue: number): number {
  const byte = (value: number): number => Math.min(255, (value + 0.5) | 0);
  return OPAQUE | (byte(blue) << 16) | (byte(green) << 8) | byte(red);
}
