// P_z, or the direction of P, as an image with the zero lines of P_z, for the map.

import type { Palette } from '../protocol';
import { Pieces, zeroLines } from './contours';
import { FAINT, weight } from './contrast';
import type { Fields } from './fields';
import { Enlarger } from './interpolate';
import { DirectionTable, paletteTable } from './palette';

const COLOURS = 1024;
const LARGEST = 256;

export class Raster {
  readonly canvas = document.createElement('canvas');
  readonly zones = new Pieces();
  private readonly context = this.canvas.getContext('2d', { alpha: false, willReadFrequently: true })!;
  private enlarger: Enlarger | null = null;
  private image: ImageData | null = null;
  private bytes = new Uint32Array(0);
  private P_z = new Float32Array(0);
  private contrast = new Float32Array(0);
  private colours = new Uint32Array(0);
  private directions: DirectionTable | null = null;
  private vector: [Float32Array, Float32Array] = [new Float32Array(0), new Float32Array(0)];

  constructor(palette: Palette) {
    this.setPalette(palette);
  }

  setPalette(palette: Palette): void {
    this.colours = new Uint32Array(paletteTable(palette, COLOURS).buffer);
    this.directions = palette.wheel && new DirectionTable(palette.wheel);
  }

  /** Draw the colours as they are laid out on the map: every row of a closed cell as wide as the circle there. */
  draw(fields: Fields, mixing: number): void {
    const { n_theta, n_z, surface } = fields;
    const share = surface.closed ? 0.5 : 1;
    const { enlarger } = this;
    if (enlarger?.n_theta !== n_theta || enlarger.n_z !== n_z || enlarger.share !== share) this.resize(n_theta, n_z, share);
    const { P_z, contrast, colours, directions, bytes, canvas, vector } = this;
    const { width, height } = canvas;
    this.enlarger!.enlarge(fields.order, 0, mixing, P_z);
    this.enlarger!.enlarge(fields.order, 1, mixing, contrast);
    if (directions) vector.forEach((part, k) => this.enlarger!.enlarge(fields.vector, k, mixing, part));
    const half = (COLOURS - 1) / 2;
    const shade = (value: number): number => {
      const k = (half * (1 + value) + 0.5) | 0;
      return colours[k < 0 ? 0 : k >= COLOURS ? COLOURS - 1 : k];
    };
    /** The colour between a pixel of the enlarged fields and the next. */
    const colour = (at: number, share: number): number => {
      const between = (field: Float32Array): number => field[at] + share * (field[at + 1] - field[at]);
      return directions ? directions.of(between(vector[0]), between(vector[1])) : shade(between(P_z));
    };
    for (let row = 0, q = 0; row < height; row++) {
      const wide = surface.closed ? surface.radius((1 - (row + 0.5) / height) * surface.length) / surface.widest : 1;
      if (wide >= 1) {
        if (directions) for (const end = q + width; q < end; q++) bytes[q] = directions.of(vector[0][q], vector[1][q]);
        else for (const end = q + width; q < end; q++) bytes[q] = shade(P_z[q]);
        continue;
      }
      const first = row * width;
      for (let k = 0; k < width; k++, q++) {
        // Beyond the outline the nearest colour; it is cut off there.
        const x = Math.min(width - 1, Math.max(0, ((k + 0.5) / width - 0.5) * (width / wide) + 0.5 * width - 0.5));
        const low = Math.min(width - 2, Math.floor(x));
        bytes[q] = colour(first + low, x - low);
      }
    }
    this.context.putImageData(this.image!, 0, 0);
    zeroLines(P_z, width, height, contrast, FAINT, this.zones, surface.closed);
  }

  /**
   * Draw the zone lines; pieces across a seam are drawn on both sides of it. `place` gives the pixels of a share of the
   * way around and of the length, from the top.
   */
  stroke(target: CanvasRenderingContext2D, place: (across: number, down: number) => [number, number], colour: string): void {
    const { zones, canvas } = this;
    const [sx, sy] = [1 / canvas.width, 1 / canvas.height];
    target.strokeStyle = colour;
    target.lineCap = 'round';
    const levels = 3;
    for (let level = 1; level <= levels; level++) {
      target.beginPath();
      let any = false;
      for (let n = 0, k = 0; n < zones.count; n++, k += 5) {
        if (Math.ceil(levels * weight(zones.data[k + 4])) !== level) continue;
        any = true;
        const [x0, y0, x1, y1] = [zones.data[k], zones.data[k + 1], zones.data[k + 2], zones.data[k + 3]];
        const again = Math.max(x0, x1) > canvas.width - 1;
        const below = Math.max(y0, y1) > canvas.height - 1;
        for (let copy = 0; copy < 4; copy++) {
          if (((copy & 1) !== 0 && !again) || ((copy & 2) !== 0 && !below)) continue;
          const dx = 0.5 - (copy & 1) * canvas.width;
          const dy = 0.5 - (copy >> 1) * canvas.height;
          target.moveTo(...place((x0 + dx) * sx, (y0 + dy) * sy));
          target.lineTo(...place((x1 + dx) * sx, (y1 + dy) * sy));
        }
      }
      target.globalAlpha = level / levels;
      if (any) target.stroke();
    }
    target.globalAlpha = 1;
  }

  private resize(n_theta: number, n_z: number, share: number): void {
    const width = Math.min(LARGEST, 4 * n_theta);
    const height = Math.min(LARGEST, 4 * n_z * share);
    this.canvas.width = width;
    this.canvas.height = height;
    this.image = this.context.createImageData(width, height);
    this.bytes = new Uint32Array(this.image.data.buffer);
    this.P_z = new Float32Array(width * height);
    this.contrast = new Float32Array(width * height);
    this.vector = [new Float32Array(width * height), new Float32Array(width * height)];
    this.enlarger = new Enlarger(n_theta, n_z, width, height, share);
  }
}
