// The view of the cell: orthographic, turned, tilted and enlarged.

import { CylinderSurface, type Surface } from './surface';

const TURN = 2 * Math.PI;
const STEEPEST = 1.25;
/** Of a closed cell the poles are seen from above. */
const STEEPEST_CLOSED = 1.5;
const CLOSEST = 40;
/** Tilt of the closed cell at first, and of the opened one, so that the section in it is seen. */
const USUAL = 0.2;
const OPENED = 0.45;
/** Tilt of a closed surface: enough to see its upper end. */
const ENDS = 0.5;

/** The part of a view that two cells can share. */
export type Stance = Pick<View, 'turn' | 'tilt' | 'zoom' | 'centre'>;

export class View {
  /** Angle theta that faces the viewer. */
  turn = Math.PI;
  /** Above 0 the viewer looks down on the upper end. */
  tilt = USUAL;
  zoom = 1;
  /** Whether the front is taken away: the wall that is seen is the one behind. */
  private opened = false;
  /** Height at the middle of the picture, relative to the middle of the cell, in radii. */
  centre = 0;
  width = 1;
  height = 1;
  private shown: Surface = new CylinderSurface(5);

  get surface(): Surface {
    return this.shown;
  }

  set surface(surface: Surface) {
    const another = surface.closed !== this.shown.closed;
    this.shown = surface;
    if (another) this.reset();
    this.hold();
  }

  get open(): boolean {
    return this.opened;
  }

  set open(open: boolean) {
    if (open === this.opened) return;
    this.opened = open;
    if (open && Math.abs(this.tilt) < OPENED) this.tilt = this.tilt < 0 ? -OPENED : OPENED;
    else if (!open && Math.abs(this.tilt) === OPENED) this.tilt = this.tilt < 0 ? -USUAL : USUAL;
    this.hold();
  }

  /** How far the cell reaches up and down in the picture, in radii. */
  private get rise(): number {
    const { profile, half, closed } = this.shown;
    const [cos, sin] = [Math.cos(this.tilt), Math.abs(Math.sin(this.tilt))];
    if (!closed) return half * cos + sin;
    let rise = 0;
    for (let k = 0; k < profile.length; k += 4) rise = Math.max(rise, profile[k] * sin + profile[k + 1] * cos);
    return rise;
  }

  /** CSS pixels per radius. */
  get scale(): number {
    return this.zoom * Math.min(this.width / (2.2 * this.shown.widest), this.height / (2.08 * this.rise));
  }

  turnBy(dx: number, dy: number): void {
    const scale = this.scale;
    this.turn = (((this.turn - dx / Math.min(scale, 250)) % TURN) + TURN) % TURN;
    const steepest = this.shown.closed ? STEEPEST_CLOSED : STEEPEST;
    this.tilt = Math.max(-steepest, Math.min(steepest, this.tilt + dy / 250));
    this.hold();
  }

  moveBy(dy: number): void {
    this.centre += dy / this.scale / Math.cos(this.tilt);
    this.hold();
  }

  /** Enlarge by `factor` and keep the height at `y` (pixels from the top) where it is. */
  zoomBy(factor: number, y: number): void {
    const up = this.height / 2 - y;
    const before = up / this.scale;
    this.zoom = Math.max(0.6, Math.min(CLOSEST, this.zoom * factor));
    this.centre += (before - up / this.scale) / Math.cos(this.tilt);
    this.hold();
  }

  reset(): void {
    this.turn = Math.PI;
    this.tilt = this.shown.closed ? ENDS : this.opened ? OPENED : USUAL;
    this.zoom = 1;
    this.centre = 0;
  }

  /** Keep the cell in the picture. */
  hold(): void {
    const half = this.height / 2 / this.scale / Math.cos(this.tilt);
    const most = Math.max(0, this.shown.half + 0.3 - half);
    this.centre = Math.max(-most, Math.min(most, this.centre));
  }

  /** The [theta, z] at a pixel from the upper left corner, or null outside the cell. */
  pick(x: number, y: number): [number, number] | null {
    const scale = this.scale;
    const right = (x - this.width / 2) / scale;
    const up = (this.height / 2 - y) / scale;
    const found = this.shown.pick(right, up, this.centre, this.tilt, this.opened);
    return found && [(((this.turn + found.angle) % TURN) + TURN) % TURN, found.s];
  }
}
