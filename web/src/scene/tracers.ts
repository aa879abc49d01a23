// Tracers inside the cell and the axial velocity on its section: the last messages, and the way between them.

import type { Inside } from '../protocol';

/** Positions in a trail, the head included. */
export const ROWS = 9;
/** Milliseconds between messages that count towards the mean interval; longer gaps are pauses. */
const LONGEST = 1000;

export class Tracers {
  count = 0;
  /** Row k holds the places k messages ago: x, y, z and the axial velocity as a share of the peak. z is unwrapped. */
  rows = new Float32Array(0);
  rings = 0;
  sectors = 0;
  /** The shares on the section before and now, for each of its points. */
  section = new Float32Array(0);
  /** Counts messages, so that others see when something is new. */
  version = 0;

  private begun = -1;
  private arrived = -Infinity;
  private interval = 120;

  get empty(): boolean {
    return this.count === 0;
  }

  /** Add a message at time `at` (ms); the way to it begins where the tracers are drawn. */
  take(inside: Inside, at: number): void {
    const { tracers, rings, sectors, length, xyz, axial, section } = inside;
    const scale = inside.reference > 1e-12 ? 1 / inside.reference : 0;
    const another =
      inside.begun !== this.begun || tracers !== this.count || rings !== this.rings || sectors !== this.sectors;
    if (another) {
      Object.assign(this, { begun: inside.begun, count: tracers, rings, sectors });
      this.rows = new Float32Array(4 * tracers * ROWS);
      this.section = new Float32Array(2 * section.length);
    }
    const m = another ? 1 : this.mixing(at);
    const { rows, count } = this;
    const row = 4 * count;
    if (!another) {
      for (let p = 0; p < row; p++) rows[p] = rows[row + p] + m * (rows[p] - rows[row + p]);
      rows.copyWithin(row, 0, row * (ROWS - 1));
    }
    for (let n = 0, p = 0; n < count; n++, p += 4) {
      const z = xyz[2 * count + n];
      if (!another) {
        const turns = Math.round((z - rows[row + p + 2]) / length);
        if (turns) for (let q = row + p + 2; q < rows.length; q += row) rows[q] += turns * length;
      }
      rows[p] = xyz[n];
      rows[p + 1] = xyz[count + n];
      rows[p + 2] = z;
      rows[p + 3] = scale * axial[n];
    }
    if (another) for (let k = 1; k < ROWS; k++) rows.copyWithin(k * row, 0, row);
    const shares = this.section;
    for (let p = 0, q = 0; p < section.length; p++, q += 2) {
      const share = scale * section[p];
      shares[q] = another ? share : shares[q] + m * (shares[q + 1] - shares[q]);
      shares[q + 1] = share;
    }
    const gap = at - this.arrived;
    if (gap < LONGEST) this.interval += 0.3 * (gap - this.interval);
    this.arrived = at;
    this.version++;
  }

  /** The progress from the message before to the last one at time `at` (ms), from 0 to 1. */
  mixing(at: number): number {
    return Math.min(1, Math.max(0, (at - this.arrived) / this.interval));
  }

  clear(): void {
    this.count = 0;
    this.begun = -1;
    this.version++;
  }
}
