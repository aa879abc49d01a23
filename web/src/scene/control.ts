// Pointer and keyboard input on the cylinder or the map: turning the cell or painting on it.

import { Stroke } from './brush';
import type { BrushMark } from './cylinder';
import type { Fields } from './fields';
import { listen } from './gestures';
import type { UnwrappedMap } from './map';
import { wrap, type Place } from './surface';
import type { View } from './view';

export type Tool = 'turn' | 'wound' | 'fragment' | 'align';

const TURN = 2 * Math.PI;

export class Control {
  tool: Tool = 'turn';
  readonly mark: BrushMark = { theta: Math.PI, z: 2.5, radius: 0.3, shown: false };
  onStroke: ((points: Place[]) => void) | null = null;

  private stroke: Stroke | null = null;

  constructor(
    private readonly cylinder: HTMLCanvasElement,
    private readonly map: UnwrappedMap,
    private readonly view: View,
    private readonly fields: Fields,
    /** Called when something visible has changed. */
    private readonly changed: () => void,
  ) {
    let painting = false;
    listen(cylinder, {
      start: (x, y, second) => {
        const at = view.pick(x, y);
        painting = this.painting && !second && at !== null;
        if (painting) this.begin(at!);
      },
      move: (x, y, dx, dy) => {
        const at = painting ? view.pick(x, y) : null;
        if (at) this.paint(at);
        else if (!painting) view.turnBy(dx, dy);
        changed();
      },
      end: () => this.end(),
      hover: (at) => this.point(at && view.pick(...at)),
      pinch: (factor, y, dy) => {
        view.zoomBy(factor, y);
        view.moveBy(dy);
        changed();
      },
    });
    listen(map.moving, {
      start: (x, y, second) => {
        const at = map.pick(x, y, false)!;
        painting = this.painting && !second;
        if (painting) this.begin(at);
        else this.face(at[0]);
      },
      move: (x, y) => {
        const at = map.pick(x, y, false)!;
        if (painting) this.paint(at);
        else this.face(at[0]);
      },
      end: () => this.end(),
      hover: (at) => this.point(at && map.pick(...at, true)),
      pinch: (factor) => {
        view.zoomBy(factor, view.height / 2); // the map itself always shows all of the cell
        changed();
      },
    });
    cylinder.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    cylinder.addEventListener('keydown', (event) => this.cylinderKey(event));
    map.moving.addEventListener('keydown', (event) => this.mapKey(event));
    map.moving.addEventListener('focus', () => this.showCursor());
    map.moving.addEventListener('blur', () => this.point(null));
    this.setTool('turn', this.mark.radius);
  }

  private get painting(): boolean {
    return this.tool !== 'turn' && !this.fields.empty;
  }

  setTool(tool: Tool, radius: number): void {
    this.tool = tool;
    this.mark.radius = radius;
    const brush = tool !== 'turn';
    if (!brush) this.mark.shown = false;
    this.cylinder.style.cursor = brush ? 'crosshair' : 'grab';
    this.map.moving.style.cursor = brush ? 'crosshair' : 'ew-resize';
    this.map.moving.style.touchAction = brush ? 'none' : 'pan-y';
    this.changed();
  }

  private point(at: Place | null): void {
    const shown = this.painting && at !== null;
    if (!shown && !this.mark.shown) return;
    this.mark.shown = shown;
    if (at) [this.mark.theta, this.mark.z] = at;
    this.changed();
  }

  private begin(at: Place): void {
    this.point(at);
    const send = (points: Place[]): void => this.onStroke?.(points);
    this.stroke = new Stroke(send, this.mark.radius, this.fields.surface, performance.now());
    this.stroke.add(at, performance.now());
  }

  private paint(at: Place): void {
    this.point(at);
    this.stroke?.add(at, performance.now());
  }

  private end(): void {
    this.stroke?.end();
    this.stroke = null;
  }

  private face(theta: number): void {
    this.view.turn = wrap(theta, TURN);
    this.changed();
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    if (event.shiftKey) this.view.moveBy(-(event.deltaY || event.deltaX) * lines);
    else this.view.zoomBy(Math.exp(-0.0016 * event.deltaY * lines), event.offsetY);
    this.changed();
  }

  private cylinderKey(event: KeyboardEvent): void {
    const { view } = this;
    const middle = view.height / 2;
    const step = 0.12 * Math.min(view.scale, 250);
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'ArrowLeft') view.turnBy(-step, 0);
    else if (event.key === 'ArrowRight') view.turnBy(step, 0);
    else if (event.key === 'ArrowUp' && event.shiftKey) view.moveBy(40);
    else if (event.key === 'ArrowDown' && event.shiftKey) view.moveBy(-40);
    else if (event.key === 'ArrowUp') view.turnBy(0, -18);
    else if (event.key === 'ArrowDown') view.turnBy(0, 18);
    else if (event.key === '+' || event.key === '=') view.zoomBy(1.2, middle);
    else if (event.key === '-') view.zoomBy(1 / 1.2, middle);
    else if (event.key === 'Home' || event.key === '0') view.reset();
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.changed();
  }

  /** Only for the keyboard: a click shows the brush by itself. */
  private showCursor(): void {
    if (this.map.moving.matches(':focus-visible')) this.point([this.mark.theta, this.mark.z]);
  }

  private mapKey(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { mark, fields } = this;
    const step = event.shiftKey ? 0.5 : 0.1;
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (way && this.painting) {
      // On a closed cell a step around is as long near the poles, where it is a larger angle.
      const { surface } = fields;
      const around = (step * way[0]) / Math.max(0.2, Math.abs(surface.radius(mark.z)));
      this.point(surface.within(mark.theta + around, mark.z + step * way[1]));
    } else if (way && way[0] !== 0) {
      this.face(this.view.turn + step * way[0]);
    } else if ((event.key === 'Enter' || event.key === ' ') && this.painting) {
      const z = Math.min(mark.z, fields.surface.length * (1 - 1e-6));
      this.point([mark.theta, z]);
      if (!event.repeat) this.onStroke?.([[mark.theta, z]]);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
