import { describe, expect, it } from 'vitest';
import { isInside, readInside, type Inside } from '../src/protocol';
import { CylinderSurface } from '../src/scene/surface';
import { ROWS, Tracers } from '../src/scene/tracers';
import { View } from '../src/scene/view';

const CELL = new CylinderSurface(5);

describe('the inside', () => {
  /** A message of two tracers at heights, and a section of 2 rings and 3 sectors, all at one velocity. */
  const message = (heights: [number, number], axial = 0.5, begun = 1): Inside => ({
    ...{ t: 0, begun, length: 5, reference: 0.5, tracers: 2, rings: 2, sectors: 3 },
    xyz: Float32Array.from([0.1, 0.2, 0.3, 0.4, ...heights]),
    axial: new Float32Array(2).fill(axial),
    section: new Float32Array(6).fill(axial),
  });
  const height = (tracers: Tracers, row: number, n: number): number => tracers.rows[4 * (2 * row + n) + 2];

  it('is read from a message of its own kind', () => {
    const header = { t: 1, begun: 2, length: 5, reference: 1, tracers: 2, rings: 2, sectors: 3 };
    const text = new TextEncoder().encode(JSON.stringify(header));
    const start = 8 + Math.ceil(text.length / 8) * 8;
    const data = new ArrayBuffer(start + 4 * (8 + 6));
    new DataView(data).setUint32(0, text.length, true);
    expect(isInside(data)).toBe(false);
    new DataView(data).setUint32(4, 1, true);
    new Uint8Array(data).set(text, 8);
    new Float32Array(data, start).set(Array.from({ length: 14 }, (_, k) => k));
    expect(isInside(data)).toBe(true);
    const found = readInside(data);
    expect(found).toMatchObject(header);
    expect([[...found.xyz], [...found.axial], [...found.section]]).toEqual([[0, 1, 2, 3, 4, 5], [6, 7], [8, 9, 10, 11, 12, 13]]);
  });

  it('passes from message to message without a jump, also when one comes early', () => {
    const tracers = new Tracers();
    tracers.take(message([1, 2], 0.1), 0);
    expect(tracers.mixing(1000)).toBe(1);
    tracers.take(message([1.1, 1.9], 0.2), 1000);
    expect([height(tracers, 1, 0), height(tracers, 0, 0)].map((z) => Number(z.toFixed(6)))).toEqual([1, 1.1]);
    const half = tracers.mixing(1060);
    expect(half).toBeGreaterThan(0.3);
    expect(half).toBeLessThan(1);
    const drawn = 1 + 0.1 * half;
    const share = 0.2 + half * 0.2;
    tracers.take(message([1.2, 1.8], 0.5), 1060);
    expect(tracers.mixing(1060)).toBe(0);
    expect(height(tracers, 1, 0)).toBeCloseTo(drawn);
    expect(tracers.section[0]).toBeCloseTo(share);
    expect(tracers.section[1]).toBe(1);
  });

  it('has trails that leave at one end of the cell and do not cross it', () => {
    const tracers = new Tracers();
    let heights: [number, number] = [4.8, 0.2];
    for (let k = 0; k < 2 * ROWS; k++) {
      tracers.take(message(heights), 120 * k);
      heights = [(heights[0] + 0.1) % 5, (heights[1] + 4.9) % 5];
      for (let n = 0; n < 2; n++) {
        expect(height(tracers, 0, n)).toBeGreaterThanOrEqual(0);
        expect(height(tracers, 0, n)).toBeLessThanOrEqual(5);
        for (let row = 1; row < ROWS; row++) expect(Math.abs(height(tracers, row, n) - height(tracers, row - 1, n))).toBeLessThan(0.11);
      }
    }
  });

  it('begins anew with another cell, and shows nothing of a flow that does not exist', () => {
    const tracers = new Tracers();
    tracers.take(message([1, 2]), 0);
    tracers.take({ ...message([4, 3], 0.5, 2), reference: 0 }, 120);
    for (let row = 0; row < ROWS; row++) expect(height(tracers, row, 0)).toBe(4);
    expect([...tracers.section]).toEqual(new Array(12).fill(0));
    tracers.clear();
    expect(tracers.empty).toBe(true);
  });
});

describe('the view of an opened cell', () => {
  it('finds the place on the wall behind, which is seen', () => {
    const view = new View();
    Object.assign(view, { width: 400, height: 500, surface: CELL, turn: 1, tilt: 0.5, open: true });
    expect(view.tilt).toBe(0.5);
    const [theta, z] = view.pick(200, 250)!;
    expect(theta).toBeCloseTo(1 + Math.PI);
    expect(z).toBeCloseTo(2.5 - Math.tan(0.5));
    // To the right of the viewer is where theta = turn + π/2, in front and behind.
    expect(view.pick(240, 250)![0]).toBeLessThan(theta);
  });

  it('is tilted enough for the section, unless a visitor has tilted it, and back when it closes', () => {
    const view = new View();
    const before = view.tilt;
    view.open = true;
    expect(view.tilt).toBeGreaterThan(before);
    view.open = false;
    expect(view.tilt).toBe(before);
    view.open = true;
    view.tilt = -0.7;
    view.open = false;
    expect(view.tilt).toBe(-0.7);
  });
});
