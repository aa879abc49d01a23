import { keptPalette, isDark } from '../panels/dress';
import type { Frame } from '../protocol';
import { Fields } from '../scene/fields';
import { FlatCylinder } from '../scene/flat';
import { UnwrappedMap } from '../scene/map';
import { Particles } from '../scene/particles';
import { Quality } from '../scene/quality';
import { place } from '../scene/place';
import { surfaceOf } from '../scene/surface';
import { Units } from '../panels/units';
import { View } from '../scene/view';
import type { Front } from './front';

/** The first picture of the cell, painted by the processor as the page will draw it, and where. */
export class FirstPicture {
  private canvases: HTMLCanvasElement[] = [];
  private late = false;

  constructor(private readonly front: Front) {}

  /** Paint it, unless the page draws already: the cylinder, and when that can be seen the map. */
  async paint(frame: Frame): Promise<void> {
    if (this.late) return;
    const { about, cylinder, map } = this.front;
    const palette = keptPalette(about.palettes);
    const surface = surfaceOf(null, frame.length);
    const fields = new Fields();
    fields.take(frame, surface, 0);
    const view = new View();
    view.surface = surface;
    view.width = Math.max(1, cylinder.clientWidth);
    view.height = Math.max(1, cylinder.clientHeight);
    const flat = new FlatCylinder(palette, isDark());
    flat.draw(fields, 1, view, 1); // few pixels, which are there soon
    this.show(cylinder, flat.canvas);
    await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
    performance.mark('first picture');
    if (this.late) return;

    const unwrapped = new UnwrappedMap(palette, new Particles(true, 0));
    unwrapped.units = new Units(about.scales);
    this.show(map, unwrapped.still);
    unwrapped.fit(map.clientWidth, map.clientHeight, surface, new Quality().ratio);
    fields.blend(1);
    unwrapped.layStreamlines(fields);
    unwrapped.drawStill(fields, 1);
  }

  private show(host: HTMLElement, canvas: HTMLCanvasElement): void {
    canvas.setAttribute('aria-hidden', 'true');
    place(host, canvas);
    this.canvases.push(canvas);
  }

  /** The page draws now, over this. */
  remove(): void {
    this.late = true;
    for (const canvas of this.canvases.splice(0)) canvas.remove();
  }
}
