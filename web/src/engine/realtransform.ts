import { Lines } from './fft';

/**
 * Transforms of real fields [n0][n1] at half the cost of complex ones: two rows are the parts of one complex row, and
 * of a spectrum only the waves 0 ... n1/2 of the second direction are kept, [n0][half]; the others are
 * S(-m, -q) = conj S(m, q).
 */
export class RealTransform {
  /** Waves of the second direction that are kept, and pairs of rows. */
  readonly half: number;
  readonly pairs: number;
  private readonly first: Lines;
  private readonly second: Lines;
  private readonly rows: [Float64Array, Float64Array];
  private readonly columns: [Float64Array, Float64Array];

  constructor(readonly n0: number, readonly n1: number) {
    this.half = Math.floor(n1 / 2) + 1;
    this.pairs = Math.ceil(n0 / 2);
    this.first = new Lines(n0);
    this.second = new Lines(n1);
    const blank = (size: number): [Float64Array, Float64Array] => [new Float64Array(2 * size), new Float64Array(2 * size)];
    this.rows = blank(this.pairs * n1);
    this.columns = blank(2 * this.pairs * this.half);
  }

  /** An array for a field: the value at (i, j) is number (i >> 1) 2 n1 + 2 j + (i & 1). */
  field(): Float64Array {
    return new Float64Array(2 * this.pairs * this.n1);
  }

  /** Sum of a field times exp(-ikx), not scaled, [n0][half], in an array that the next call overwrites. */
  forward(field: Float64Array): Float64Array {
    const { half, pairs, n1 } = this;
    const [one, other] = this.columns;
    const rows = this.second.run(field, ...this.rows, pairs, 1, false);
    for (let r = 0; r < pairs; r += 1) {
      let even = 4 * r * half;
      let odd = even + 2 * half;
      const base = 2 * r * n1;
      for (let q = 0; q < half; q += 1, even += 2, odd += 2) {
        const a = base + 2 * q;
        const b = base + 2 * (q ? n1 - q : 0);
        const ar = 0.5 * rows[a]!, ai = 0.5 * rows[a + 1]!, br = 0.5 * rows[b]!, bi = 0.5 * rows[b + 1]!;
        one[even] = ar + br;
        one[even + 1] = ai - bi;
        one[odd] = ai + bi;
        one[odd + 1] = br - ar;
      }
    }
    return this.first.run(one, other, one, 1, half, false);
  }

  /** The field of a spectrum [n0][half], in an array that the next call overwrites. */
  inverse(spectrum: Float64Array): Float64Array {
    const { half, pairs, n1 } = this;
    const [packed, other] = this.rows;
    const columns = this.first.run(spectrum, ...this.columns, 1, half, true);
    const last = this.n0 % 2 ? pairs - 1 : pairs; // an odd last row has none beside it
    for (let r = 0; r < pairs; r += 1) {
      const factor = r === last ? 0 : 1;
      let even = 4 * r * half;
      let odd = r === last ? even : even + 2 * half;
      const base = 2 * r * n1;
      for (let q = 0; q < half; q += 1, even += 2, odd += 2) {
        const er = columns[even]!, ei = columns[even + 1]!, or = factor * columns[odd]!, oi = factor * columns[odd + 1]!;
        const a = base + 2 * q;
        packed[a] = er - oi;
        packed[a + 1] = ei + or;
        if (q === 0 || 2 * q === n1) continue;
        const b = base + 2 * (n1 - q);
        packed[b] = er + oi;
        packed[b + 1] = or - ei;
      }
    }
    return this.second.run(packed, other, packed, pairs, 1, true);
  }
}
