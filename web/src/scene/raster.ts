// P_z as an image with its zero lines, for the map.

import type { Palette } from '../protocol';
import { Pieces, zeroLines } from './contours';
import { FAINT, weight } from './contrast';
import type { Fields } from './fields';
import { Enlarger } from './interpolate';
import { paletteTable } from './palette';

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

  constructor(palette: Palette) {
    this.setPalette(palette);
  }

  setPalette(palette: Palette): void {
    this.colours = new Uint32Array(paletteTable(palette, COLOURS).buffer);
  }

  draw(fields: Fields, mixing: number): void {
    const { n_theta, n_z } = fields;
    if (this.enlarger?.n_theta !== n_theta || this.enlarger.n_z !== n_z) this.resize(n_theta, n_z);
    const { P_z, contrast, colours, bytes, canvas } = this;
    this.enlarger!.enlarge(fields.order, 0, mixing, P_z);
    this.enlarger!.enlarge(fields.order, 1, mixing, contrast);
    const half = (COLOURS - 1) / 2;
    for (let q = 0; q < bytes.length; q++) {
      const k = (half * (1 + P_z[q]) + 0.5) | 0;
      bytes[q] = colours[k < 0 ? 0 : k >= COLOURS ? COLOURS - 1 : k];
    }
    this.context.putImageData(this.image!, 0, 0);
    zeroLines(P_z, canvas.width, canvas.height, contrast, FAINT, this.zones);
  }

  /** Draw the zone lines into a box; pieces across a seam are drawn on both sides of it. */
  stroke(target: CanvasRenderingContext2D, x: number, y: number, width: number, height: number, colour: string): void {
    const { zones, canvas } = this;
    const sx = width / canvas.width;
    const sy = height / canvas.height;
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
          const dx = x + (0.5 - (copy & 1) * canvas.width) * sx;
          const dy = y + (0.5 - (copy >> 1) * canvas.height) * sy;
          target.moveTo(dx + x0 * sx, dy + y0 * sy);
          target.lineTo(dx + x1 * sx, dy + y1 * sy);
        }
      }
      target.globalAlpha = level / levels;
      if (any) target.stroke();
    }
    target.globalAlpha = 1;
  }

  private resize(n_theta: number, n_z: number): void {
    const width = Math.min(LARGEST, 4 * n_theta);
    const height = Math.min(LARGEST, 4 * n_z);
    this.canvas.width = width;
    this.canvas.height = height;
    this.image = this.context.createImageData(width, height);
    this.bytes = new Uint32Array(this.image.data.buffer);
    this.P_z = new Float32Array(width * height);
    this.contrast = new Float32Array(width * height);
    this.enlarger = new Enlarger(n_theta, n_z, width, height);
  }
}
