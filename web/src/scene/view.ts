// The view of the cylinder: orthographic, turned, tilted and enlarged.

const TURN = 2 * Math.PI;
const STEEPEST = 1.25;
const CLOSEST = 40;
/** Tilt of the closed cell at first, and of the opened one, so that the section in it is seen. */
const USUAL = 0.2;
const OPENED = 0.45;

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
  length = 5;

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

  /** CSS pixels per radius. */
  get scale(): number {
    const rise = 0.5 * this.length * Math.cos(this.tilt) + Math.abs(Math.sin(this.tilt));
    return this.zoom * Math.min(this.width / 2.2, this.height / (2.08 * rise));
  }

  turnBy(dx: number, dy: number): void {
    const scale = this.scale;
    this.turn = (((this.turn - dx / Math.min(scale, 250)) % TURN) + TURN) % TURN;
    this.tilt = Math.max(-STEEPEST, Math.min(STEEPEST, this.tilt + dy / 250));
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
    this.tilt = this.opened ? OPENED : USUAL;
    this.zoom = 1;
    this.centre = 0;
  }

  /** Keep the cell in the picture. */
  hold(): void {
    const half = this.height / 2 / this.scale / Math.cos(this.tilt);
    const most = Math.max(0, this.length / 2 + 0.3 - half);
    this.centre = Math.max(-most, Math.min(most, this.centre));
  }

  /** The [theta, z] at a pixel from the upper left corner, or null outside the cell. */
  pick(x: number, y: number): [number, number] | null {
    const scale = this.scale;
    const right = (x - this.width / 2) / scale;
    const up = (this.height / 2 - y) / scale;
    if (Math.abs(right) >= 1) return null;
    const near = (this.opened ? -1 : 1) * Math.sqrt(1 - right * right);
    const [c, s] = [Math.cos(this.tilt), Math.sin(this.tilt)];
    const height = this.centre + up * c + ((near + up * s) / c) * s;
    const z = height + this.length / 2;
    if (z < 0 || z >= this.length) return null;
    return [(((this.turn + Math.atan2(right, near)) % TURN) + TURN) % TURN, z];
  }
}
