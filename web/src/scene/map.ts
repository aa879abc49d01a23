// The unwrapped cell: theta to the right, z up. Needs no WebGL.

import type { BrushMark } from './cylinder';
import type { Fields } from './fields';
import { TRAIL, type Particles } from './particles';
import { Raster } from './raster';
import { POINTS, Streamlines } from './streamlines';
import type { Palette } from '../protocol';

const TURN = 2 * Math.PI;
const MARGIN = { left: 30, right: 12, top: 10, bottom: 34 };
/** A long cell is drawn at least this wide, in pixels, even if that widens it. */
const NARROWEST = 72;
const SERIF = "'STIX Two Text', 'STIXGeneral', 'Latin Modern Roman', Georgia, 'Times New Roman', serif";

export class UnwrappedMap {
  /** The parts that change with each frame, and over them the moving ones. */
  readonly still = document.createElement('canvas');
  readonly moving = document.createElement('canvas');
  readonly raster: Raster;
  readonly box = { x: 0, y: 0, width: 1, height: 1 };
  width = 1;
  height = 1;
  zone: string;

  private readonly lines = new Streamlines();
  private length = 5;
  private ratio = 1;

  constructor(
    palette: Palette,
    private readonly particles: Particles,
  ) {
    this.raster = new Raster(palette);
    this.zone = palette.zone;
  }

  /** CSS pixels per radius, horizontally. */
  get scale(): number {
    return this.box.width / TURN;
  }

  fit(width: number, height: number, length: number, ratio: number): void {
    this.width = width;
    this.height = height;
    this.length = length;
    this.ratio = ratio;
    for (const canvas of [this.still, this.moving]) {
      const [w, h] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
      if (canvas.width !== w || canvas.height !== h) {
        canvas.width = w;
        canvas.height = h;
      }
    }
    const across = Math.max(20, width - MARGIN.left - MARGIN.right);
    const up = Math.max(20, height - MARGIN.top - MARGIN.bottom);
    const scale = Math.min(across / TURN, up / length);
    const { box } = this;
    box.width = Math.min(across, Math.max(NARROWEST, TURN * scale));
    box.height = length * scale;
    box.x = MARGIN.left + (across - box.width) / 2;
    box.y = MARGIN.top + (up - box.height) / 2;
  }

  /** The [theta, z] at a pixel; outside, that of the nearest edge, or null if `strict`. */
  pick(x: number, y: number, strict: boolean): [number, number] | null {
    const { box } = this;
    const across = (x - box.x) / box.width;
    const up = 1 - (y - box.y) / box.height;
    if (strict && (across < 0 || across >= 1 || up < 0 || up >= 1)) return null;
    const inside = (v: number): number => Math.min(1 - 1e-6, Math.max(0, v));
    return [inside(across) * TURN, inside(up) * this.length];
  }

  layStreamlines(fields: Fields): void {
    // The same distance apart on the screen for any size of the cell.
    this.lines.lay(fields, Math.max(0.2, 30 / this.scale));
  }

  drawStill(fields: Fields, mixing: number): void {
    // Kept in main memory: the processor draws many thin lines fastest, and without a graphics card everything.
    const context = this.still.getContext('2d', { willReadFrequently: true })!;
    const { box, ratio } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    if (!fields.empty) {
      this.raster.draw(fields, mixing);
      context.save();
      context.beginPath();
      context.rect(box.x, box.y, box.width, box.height);
      context.clip();
      context.imageSmoothingEnabled = true;
      context.imageSmoothingQuality = 'high';
      context.drawImage(this.raster.canvas, box.x, box.y, box.width, box.height);
      this.drawLines(context);
      context.lineWidth = 2.5;
      this.raster.stroke(context, box.x, box.y, box.width, box.height, this.zone);
      context.restore();
    }
    this.drawAxes(context);
  }

  private drawLines(context: CanvasRenderingContext2D): void {
    const { lines, box } = this;
    const sx = box.width / TURN;
    const sy = box.height / this.length;
    context.beginPath();
    for (let n = 0; n < lines.count; n++) {
      const first = 2 * POINTS * n;
      const broad = 0.35 + 1.0 * lines.speed[n];
      let [low, high, bottom, top] = [Infinity, -Infinity, Infinity, -Infinity];
      for (let k = 0; k < POINTS; k++) {
        const [x, y] = [lines.points[first + 2 * k], lines.points[first + 2 * k + 1]];
        [low, high] = [Math.min(low, x), Math.max(high, x)];
        [bottom, top] = [Math.min(bottom, y), Math.max(top, y)];
      }
      // Copies across the seams.
      for (let i = low < 0 ? 1 : 0; i >= (high >= TURN ? -1 : 0); i--) {
        for (let j = bottom < 0 ? 1 : 0; j >= (top >= this.length ? -1 : 0); j--) {
          this.taper(context, first, broad, box.x + i * box.width, box.y + box.height - j * box.height, sx, sy);
        }
      }
    }
    context.fillStyle = 'rgba(14, 10, 18, 0.62)';
    context.fill();
  }

  /** Add the outline of a line that thickens downstream: up one side, down the other. */
  private taper(context: CanvasRenderingContext2D, first: number, broad: number, x: number, y: number, sx: number, sy: number): void {
    const { points } = this.lines;
    const last = POINTS - 1;
    for (let m = 0; m < 2 * POINTS; m++) {
      const k = m < POINTS ? m : 2 * POINTS - 1 - m;
      const from = first + 2 * Math.max(0, k - 1);
      const to = first + 2 * Math.min(last, k + 1);
      const dx = (points[to] - points[from]) * sx;
      const dy = (points[to + 1] - points[from + 1]) * sy;
      const side = ((m < POINTS ? 1 : -1) * broad * (0.15 + (0.85 * k) / last)) / (Math.hypot(dx, dy) || 1);
      const px = x + points[first + 2 * k] * sx + dy * side;
      const py = y - points[first + 2 * k + 1] * sy + dx * side;
      if (m === 0) context.moveTo(px, py);
      else context.lineTo(px, py);
    }
    context.closePath();
  }

  private drawAxes(context: CanvasRenderingContext2D): void {
    const { box, length } = this;
    const style = getComputedStyle(this.still);
    context.strokeStyle = context.fillStyle = style.color;
    context.lineWidth = 1;
    context.globalAlpha = 0.75;
    context.strokeRect(box.x - 0.5, box.y - 0.5, box.width + 1, box.height + 1);
    const bottom = box.y + box.height;
    context.beginPath();
    for (const share of [0, 0.5, 1]) {
      context.moveTo(box.x + share * box.width, bottom);
      context.lineTo(box.x + share * box.width, bottom + 4);
      context.moveTo(box.x, box.y + share * box.height);
      context.lineTo(box.x - 4, box.y + share * box.height);
    }
    context.stroke();
    context.globalAlpha = 1;
    context.font = `14px ${SERIF}`;
    context.textAlign = 'center';
    context.textBaseline = 'top';
    ['0', 'π', '2π'].forEach((text, k) => context.fillText(text, box.x + (k / 2) * box.width, bottom + 7));
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    context.fillText('0', box.x - 8, bottom - 3);
    context.fillText(String(Number(length.toFixed(1))), box.x - 8, box.y + 5);
    context.font = `italic 15px ${SERIF}`;
    context.fillText('z', box.x - 10, box.y + 0.5 * box.height);
    context.textAlign = 'center';
    context.textBaseline = 'top';
    context.fillText('θ', box.x + 0.25 * box.width, bottom + 6);
  }

  /** Particles, the brush, and a mark at the angle that faces the viewer of the cylinder. */
  drawMoving(fields: Fields, mark: BrushMark, turn: number): void {
    const context = this.moving.getContext('2d', { willReadFrequently: true })!;
    const { box, ratio } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    if (fields.empty) return;
    context.save();
    context.beginPath();
    context.rect(box.x, box.y, box.width, box.height);
    context.clip();
    this.drawTrails(context);
    if (mark.shown) {
      for (let copy = 0; copy < 9; copy++) {
        const x = box.x + (mark.theta / TURN + (copy % 3) - 1) * box.width;
        const y = box.y + (1 - mark.z / this.length + Math.floor(copy / 3) - 1) * box.height;
        context.beginPath();
        context.ellipse(x, y, mark.radius * this.scale, (mark.radius * box.height) / this.length, 0, 0, TURN);
        context.fillStyle = 'rgba(255, 255, 255, 0.14)';
        context.fill();
        context.lineWidth = 1.5;
        context.strokeStyle = 'rgba(255, 255, 255, 0.95)';
        context.stroke();
      }
    }
    context.restore();
    const x = box.x + (turn / TURN) * box.width;
    const y = box.y + box.height + 2;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x - 4.5, y + 7);
    context.lineTo(x + 4.5, y + 7);
    context.fillStyle = getComputedStyle(this.still).color;
    context.fill();
  }

  private drawTrails(context: CanvasRenderingContext2D): void {
    const { box } = this;
    const { data, count, phase } = this.particles;
    const sx = box.width / TURN;
    const sy = box.height / this.length;
    const base = box.y + box.height;
    const row = 4 * count;
    context.strokeStyle = '#fff';
    context.lineCap = 'butt';
    // Few strokes of many pieces, grouped by opacity and by position along the trail.
    const parts: [number, number][] = [[0, 2], [2, 4], [4, 6], [6, TRAIL - 1]];
    for (const [dim, bright] of [[0.1, 0.55], [0.55, 2]]) {
      parts.forEach(([from, to], part) => {
        context.beginPath();
        for (let p = 0; p < row; p += 4) {
          const opacity = data[p + 2];
          if (opacity < dim || opacity >= bright || data[p + 3] < 0.02) continue;
          for (let k = from, q = p + from * row; k <= to; k++, q += row) {
            const x = box.x + data[q] * sx;
            const y = base - data[q + 1] * sy;
            if (k === from) context.moveTo(x, y);
            else context.lineTo(x, y);
          }
        }
        const along = 1 - (part + 0.25 * phase) / parts.length;
        context.globalAlpha = 0.85 * along ** 1.5 * (dim > 0.5 ? 1 : 0.4);
        context.lineWidth = 0.5 + 1.5 * along;
        context.stroke();
      });
    }
    context.globalAlpha = 1;
  }
}
