// The unwrapped cell: theta to the right, z up. On a closed cell every row is as wide as the circle there, so that areas
// are true (the sinusoidal projection of the figures). Needs no WebGL.

import type { BrushMark } from './cylinder';
import type { Fields } from './fields';
import type { Particles } from './particles';
import { Raster } from './raster';
import { Units } from '../panels/units';
import { POINTS, Streamlines } from './streamlines';
import { strokeTrails } from './strokes';
import { CylinderSurface, nearest, type Place, type Surface } from './surface';
import type { Defect, Palette } from '../protocol';

const TURN = 2 * Math.PI;
const MARGIN = { left: 30, right: 12, top: 10, bottom: 34 };
/** Room beside the name of the length, and the mean width of its letters. */
const [BESIDE, LETTER] = [14, 7.4];
/** Room below for a bar of a round length. */
const BAR = 24;
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
  /** Every so many of the particles are drawn. */
  nth = 1;
  /** A length in words, and a bar of a round length where lengths have units. */
  units = new Units(null);

  private readonly lines = new Streamlines();
  private surface: Surface = new CylinderSurface(5);
  private ratio = 1;
  /** The colour of print, read once: asking for it makes the browser work out all styles. */
  private ink = '';
  /** The size of print, relative to the usual one. */
  private large = 1;

  constructor(
    palette: Palette,
    private readonly particles: Particles,
  ) {
    this.raster = new Raster(palette);
    this.zone = palette.zone;
  }

  /** CSS pixels per radius, horizontally. */
  get scale(): number {
    return this.box.width / TURN / this.surface.widest;
  }

  /** The share of the box's width that a row takes. */
  private wide(z: number): number {
    const { surface } = this;
    return surface.closed ? Math.max(0, Math.abs(surface.radius(z))) / surface.widest : 1;
  }

  /** The pixel of a share of the way around, which may be beyond 0 or 1, and of the length, from the top. */
  private readonly place = (across: number, down: number): [number, number] => {
    const { box } = this;
    const x = this.surface.closed ? 0.5 + (across - 0.5) * this.wide((1 - down) * this.surface.length) : across;
    return [box.x + x * box.width, box.y + down * box.height];
  };

  /** The edge of the cell as a path. */
  private outline(): Path2D {
    const { box, surface } = this;
    const path = new Path2D();
    if (!surface.closed) {
      path.rect(box.x, box.y, box.width, box.height);
      return path;
    }
    const steps = 160;
    for (let k = 0; k <= 2 * steps; k++) {
      const down = k <= steps ? k / steps : 2 - k / steps;
      const [x, y] = this.place(k <= steps ? 0 : 1, down);
      if (k === 0) path.moveTo(x, y);
      else path.lineTo(x, y);
    }
    path.closePath();
    return path;
  }

  /** The theme has changed. */
  restyle(): void {
    this.ink = '';
  }

  fit(width: number, height: number, surface: Surface, ratio: number): void {
    const { length } = surface;
    this.width = width;
    this.height = height;
    this.surface = surface;
    this.ratio = ratio;
    this.restyle();
    for (const canvas of [this.still, this.moving]) {
      const [w, h] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
      if (canvas.width !== w || canvas.height !== h) {
        canvas.width = w;
        canvas.height = h;
      }
    }
    const k = (this.large = parseFloat(getComputedStyle(document.documentElement).fontSize) / 15);
    const left = k * (this.units.scales ? Math.max(MARGIN.left, BESIDE + LETTER * this.units.reaching(length).length) : MARGIN.left);
    const across = Math.max(20, width - left - k * MARGIN.right);
    const up = Math.max(20, height - k * (MARGIN.top + MARGIN.bottom + (this.units.scales ? BAR : 0)));
    const scale = Math.min(across / TURN, up / length);
    const { box } = this;
    box.width = Math.min(across, Math.max(NARROWEST, TURN * scale));
    box.height = length * scale;
    box.x = left + (across - box.width) / 2;
    box.y = k * MARGIN.top + (up - box.height) / 2;
  }

  /** The [theta, z] at a pixel; outside, that of the nearest edge, or null if `strict`. */
  pick(x: number, y: number, strict: boolean): [number, number] | null {
    const { box } = this;
    const across = (x - box.x) / box.width;
    const up = 1 - (y - box.y) / box.height;
    const inside = (v: number): number => Math.min(1 - 1e-6, Math.max(0, v));
    const wide = Math.max(this.wide(inside(up) * this.surface.length), 1e-6);
    const around = 0.5 + (across - 0.5) / wide;
    if (strict && (around < 0 || around >= 1 || up < 0 || up >= 1)) return null;
    return [inside(around) * TURN, inside(up) * this.surface.length];
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
      context.clip(this.outline());
      context.imageSmoothingEnabled = true;
      context.imageSmoothingQuality = 'high';
      context.drawImage(this.raster.canvas, box.x, box.y, box.width, box.height);
      this.drawLines(context);
      context.lineWidth = 2.5;
      this.raster.stroke(context, this.place, this.zone);
      context.restore();
    }
    this.drawAxes(context);
  }

  private drawLines(context: CanvasRenderingContext2D): void {
    const { lines, surface } = this;
    const flat: Place[] = Array.from({ length: POINTS }, () => [0, 0]);
    context.beginPath();
    for (let n = 0; n < lines.count; n++) {
      const first = 2 * POINTS * n;
      const broad = 0.35 + 1.0 * lines.speed[n];
      let [low, high, bottom, top] = [Infinity, -Infinity, Infinity, -Infinity];
      let torn = false;
      for (let k = 0; k < POINTS; k++) {
        let [x, y] = [lines.points[first + 2 * k], lines.points[first + 2 * k + 1]];
        if (surface.closed) {
          const before = k ? flat[k - 1][0] : x;
          [x, y] = surface.within(x, y);
          x = k ? nearest(before, x, TURN) : x;
          // Lines that turn about a pole cannot be drawn on the map.
          torn ||= Math.abs(x - before) > 1;
        }
        flat[k][0] = x;
        flat[k][1] = y;
        [low, high] = [Math.min(low, x), Math.max(high, x)];
        [bottom, top] = [Math.min(bottom, y), Math.max(top, y)];
      }
      if (torn) continue;
      // Copies across the seams.
      for (let i = low < 0 ? 1 : 0; i >= (high >= TURN ? -1 : 0); i--) {
        for (let j = bottom < 0 ? 1 : 0; j >= (top >= surface.length ? -1 : 0); j--) {
          this.taper(context, flat.map(([x, y]) => this.place(x / TURN + i, 1 - y / surface.length - j)), broad);
        }
      }
    }
    context.fillStyle = 'rgba(14, 10, 18, 0.62)';
    context.fill();
  }

  /** Add the outline of a line that thickens downstream: up one side, down the other. */
  private taper(context: CanvasRenderingContext2D, line: Place[], broad: number): void {
    const last = POINTS - 1;
    for (let m = 0; m < 2 * POINTS; m++) {
      const k = m < POINTS ? m : 2 * POINTS - 1 - m;
      const from = line[Math.max(0, k - 1)];
      const to = line[Math.min(last, k + 1)];
      const dx = to[0] - from[0];
      const dy = from[1] - to[1];
      const side = ((m < POINTS ? 1 : -1) * broad * (0.15 + (0.85 * k) / last)) / (Math.hypot(dx, dy) || 1);
      const px = line[k][0] + dy * side;
      const py = line[k][1] + dx * side;
      if (m === 0) context.moveTo(px, py);
      else context.lineTo(px, py);
    }
    context.closePath();
  }

  private drawAxes(context: CanvasRenderingContext2D): void {
    const { box } = this;
    const { closed, length } = this.surface;
    this.ink ||= getComputedStyle(this.still).color;
    context.strokeStyle = context.fillStyle = this.ink;
    context.lineWidth = 1;
    context.globalAlpha = 0.75;
    if (closed) context.stroke(this.outline());
    else context.strokeRect(box.x - 0.5, box.y - 0.5, box.width + 1, box.height + 1);
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
    const { large: k, units } = this;
    context.font = `${14 * k}px ${SERIF}`;
    context.textAlign = 'center';
    context.textBaseline = 'top';
    ['0', 'π', '2π'].forEach((text, k) => context.fillText(text, box.x + (k / 2) * box.width, bottom + 7));
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    context.fillText('0', box.x - 8, bottom - 3);
    context.fillText(units.scales ? units.reaching(length) : String(Number(length.toFixed(1))), box.x - 8, box.y + 5);
    context.font = `italic ${15 * k}px ${SERIF}`;
    context.fillText(closed ? 's' : 'z', box.x - 10, box.y + 0.5 * box.height);
    context.textAlign = 'center';
    context.textBaseline = 'top';
    context.fillText('θ', box.x + 0.25 * box.width, bottom + 6);
    this.drawBar(context);
  }

  /** A bar of a round length, in units. */
  private drawBar(context: CanvasRenderingContext2D): void {
    const { box, large: k } = this;
    const bar = this.units.bar((0.4 * box.width) / this.scale);
    if (!bar) return;
    const right = box.x + box.width;
    const y = box.y + box.height + k * (MARGIN.bottom - 4);
    context.lineWidth = 2 * k;
    context.beginPath();
    context.moveTo(right - bar.length * this.scale, y);
    context.lineTo(right, y);
    context.stroke();
    context.font = `${13 * k}px ${SERIF}`;
    context.textAlign = 'right';
    context.fillText(bar.name, right, y + 4 * k);
  }

  /** Particles, the brush, and a mark at the angle that faces the viewer of the cylinder. */
  drawMoving(fields: Fields, mark: BrushMark, turn: number, defects: Defect[]): void {
    const context = this.moving.getContext('2d', { willReadFrequently: true })!;
    const { box, ratio } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    if (fields.empty) return;
    context.save();
    context.clip(this.outline());
    this.drawTrails(context);
    if (mark.shown) this.drawBrush(context, mark);
    context.restore();
    for (const [index, theta, s] of defects) drawDefect(context, ...this.place(theta / TURN, 1 - s / this.surface.length), index);
    const x = box.x + (turn / TURN) * box.width;
    const y = box.y + box.height + 2;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x - 4.5, y + 7);
    context.lineTo(x + 4.5, y + 7);
    context.fillStyle = this.ink;
    context.fill();
  }

  private drawBrush(context: CanvasRenderingContext2D, mark: BrushMark): void {
    const { surface } = this;
    const edge = surface.edge([mark.theta, mark.z], mark.radius, 72).map(([theta, s]): Place => [nearest(mark.theta, theta, TURN), s]);
    const torn = edge.some(([theta], k) => k > 0 && Math.abs(theta - edge[k - 1][0]) > Math.PI);
    const ups = surface.closed ? [0] : [-1, 0, 1];
    context.fillStyle = 'rgba(255, 255, 255, 0.14)';
    context.strokeStyle = 'rgba(255, 255, 255, 0.95)';
    context.lineWidth = 1.5;
    for (const i of [-1, 0, 1]) {
      for (const j of ups) {
        context.beginPath();
        edge.concat([edge[0]]).forEach(([theta, s], k, all) => {
          const at = this.place(theta / TURN + i, 1 - s / surface.length - j);
          // Around a pole the edge runs over the seam: there it begins again.
          if (k === 0 || Math.abs(theta - all[k - 1][0]) > Math.PI) context.moveTo(...at);
          else context.lineTo(...at);
        });
        if (!torn) context.fill();
        context.stroke();
      }
    }
  }

  private drawTrails(context: CanvasRenderingContext2D): void {
    const { surface, particles, nth } = this;
    const { closed, length } = surface;
    const { x, y, width, height } = this.box;
    strokeTrails(context, particles, nth, (around, along, out) => {
      const [theta, s] = closed ? surface.within(around, along) : [around, along];
      const wide = closed ? this.wide(s) : 1;
      out[0] = x + (0.5 + (theta / TURN - 0.5) * wide) * width;
      out[1] = y + (1 - s / length) * height;
      return true;
    }, closed ? 0.2 * width : Infinity); // a trail over a seam or a pole comes back elsewhere
  }
}

/** A defect of P: a plus in a white disc, or a minus in a dark one. */
function drawDefect(context: CanvasRenderingContext2D, x: number, y: number, index: number): void {
  const [face, line] = index > 0 ? ['#fff', '#1b1720'] : ['#1b1720', '#fff'];
  const size = 5;
  context.beginPath();
  context.arc(x, y, size, 0, TURN);
  context.fillStyle = face;
  context.strokeStyle = '#1b1720';
  context.lineWidth = 1;
  context.fill();
  context.stroke();
  context.beginPath();
  context.moveTo(x - 0.55 * size, y);
  context.lineTo(x + 0.55 * size, y);
  if (index > 0) {
    context.moveTo(x, y - 0.55 * size);
    context.lineTo(x, y + 0.55 * size);
  }
  context.strokeStyle = line;
  context.lineWidth = 1.4;
  context.stroke();
}
