import { Units } from '../panels/units';

/** A bar of a round length over the picture of the solid, where lengths have units. */
export class ScaleBar {
  readonly element = document.createElement('div');
  units = new Units(null);
  private shown = '';

  constructor() {
    this.element.className = 'scale-bar';
    this.element.hidden = true;
  }

  /** Show it for so many pixels per radius; none for 0. */
  show(scale: number, width: number): void {
    const bar = scale > 0 ? this.units.bar((0.3 * width) / scale) : null;
    const key = bar ? `${bar.name} ${(bar.length * scale).toFixed(1)}` : '';
    if (key === this.shown) return;
    this.shown = key;
    this.element.hidden = bar === null;
    if (!bar) return;
    this.element.textContent = bar.name;
    this.element.style.width = `${bar.length * scale}px`;
  }
}
