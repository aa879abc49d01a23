import { Lines } from './fft';

/** Two-dimensional complex transforms of fields [n0][n1], interleaved, from one array into another. */
export class Transform {
  private readonly first: Lines;
  private readonly second: Lines;
  private readonly scratch: Float64Array;

  constructor(readonly n0: number, readonly n1: number) {
    this.first = new Lines(n0);
    this.second = new Lines(n1);
    this.scratch = new Float64Array(2 * n0 * n1);
  }

  /** Sum of field times exp(-ikx), not scaled: n0 n1 times the spectrum. */
  forward(field: Float64Array, out: Float64Array): Float64Array {
    return this.run(field, out, false);
  }

  /** The field of a spectrum. */
  inverse(spectrum: Float64Array, out: Float64Array): Float64Array {
    return this.run(spectrum, out, true);
  }

  private run(from: Float64Array, out: Float64Array, inverse: boolean): Float64Array {
    const { n0, n1, first, second, scratch } = this;
    const stages = first.count + second.count;
    if (stages === 0) out.set(from);
    // The stages write into two arrays in turn, and the last into `out`.
    const [odd, even] = stages % 2 ? [out, scratch] : [scratch, out];
    const rows = second.run(from, odd, even, n0, 1, inverse);
    if (rows === odd) first.run(rows, even, odd, 1, n1, inverse);
    else first.run(rows, odd, even, 1, n1, inverse);
    return out;
  }
}
