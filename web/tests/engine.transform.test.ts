import { describe, expect, it } from 'vitest';
import { factors, Lines, roots } from '../src/engine/fft';
import { normals } from '../src/engine/random';
import { RealTransform } from '../src/engine/realtransform';
import { Transform } from '../src/engine/transform';

/** The defining sum of a transform of interleaved numbers. */
function sum(values: Float64Array, sign: number): Float64Array {
  const n = values.length / 2;
  const w = roots(n);
  const out = new Float64Array(2 * n);
  for (let k = 0; k < n; k += 1) {
    for (let j = 0; j < n; j += 1) {
      const [c, s] = [w[2 * ((j * k) % n)]!, sign * w[2 * ((j * k) % n) + 1]!];
      out[2 * k]! += values[2 * j]! * c - values[2 * j + 1]! * s;
      out[2 * k + 1]! += values[2 * j]! * s + values[2 * j + 1]! * c;
    }
  }
  return out;
}

function furthest(a: Float64Array, b: Float64Array): number {
  return a.reduce((most, value, at) => Math.max(most, Math.abs(value - b[at]!)), 0);
}

describe('transforms', () => {
  it('factor every length', () => {
    for (let n = 1; n <= 128; n += 1) expect(factors(n).reduce((a, b) => a * b, 1)).toBe(n);
  });

  it('have roots of 1 that are exact mirror images', () => {
    for (const n of [8, 12, 20, 64, 96]) {
      const w = roots(n);
      for (let k = 0; k < n; k += 1) {
        // The angle of this simple formula, up to 2π, is itself only accurate to some 1e-15.
        expect(Math.abs(w[2 * k]! - Math.cos((2 * Math.PI * k) / n))).toBeLessThan(1.5e-15);
        expect(Math.abs(w[2 * k + 1]! + Math.sin((2 * Math.PI * k) / n))).toBeLessThan(1.5e-15);
        if (k) expect([w[2 * k]! + 0, w[2 * k + 1]! + 0]).toEqual([w[2 * (n - k)]! + 0, 0 - w[2 * (n - k) + 1]!]);
      }
    }
  });

  it('equal their defining sums for every length of a cell, both ways', () => {
    for (let n = 1; n <= 128; n += 1) {
      const values = normals(2 * n, n);
      for (const inverse of [false, true]) {
        const found = new Lines(n).run(values, new Float64Array(2 * n), new Float64Array(2 * n), 1, 1, inverse);
        expect(furthest(found, sum(values, inverse ? -1 : 1)), `${n}`).toBeLessThan(1e-12);
      }
    }
  });

  for (const [n0, n1] of [[16, 12], [15, 10], [9, 14], [64, 1], [20, 25], [8, 8], [13, 11]] as const) {
    it(`of two dimensions are undone by their inverses, also of real fields: ${n0} x ${n1}`, () => {
      const complex = new Transform(n0, n1);
      const field = normals(2 * n0 * n1, 1);
      const there = complex.forward(field, new Float64Array(field.length));
      const back = complex.inverse(there, new Float64Array(field.length)).map((value) => value / (n0 * n1));
      expect(furthest(back, field)).toBeLessThan(1e-14);

      const real = new RealTransform(n0, n1);
      const placed = real.field();
      const packed = new Float64Array(2 * n0 * n1);
      for (let i = 0; i < n0; i += 1) {
        for (let j = 0; j < n1; j += 1) {
          packed[2 * (i * n1 + j)] = field[i * n1 + j]!;
          placed[(i >> 1) * 2 * n1 + 2 * j + (i & 1)] = field[i * n1 + j]!;
        }
      }
      const whole = complex.forward(packed, new Float64Array(packed.length));
      const half = real.forward(placed).slice(0, 2 * n0 * real.half);
      for (let m = 0; m < n0; m += 1) {
        const kept = whole.subarray(2 * m * n1, 2 * (m * n1 + real.half));
        expect(furthest(half.subarray(2 * m * real.half, 2 * (m + 1) * real.half), kept)).toBeLessThan(1e-13);
      }
      expect(furthest(real.inverse(half).map((value) => value / (n0 * n1)), placed)).toBeLessThan(1e-14);
    });
  }
});
