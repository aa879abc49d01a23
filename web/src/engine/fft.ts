import { eight, lastEight } from './eight';
import { firstFour, five, four, lastFour, prime, three, two } from './radices';

// One-dimensional complex transforms of many lines at once, by the Stockham algorithm with radices 8, 4, 2, 3, 5
// and any other prime. Complex numbers are interleaved: re, im, re, im, ...
//
// Why not a package: fft.js (MIT), the fastest in plain JavaScript, takes powers of two only, but cells have 48 x
// 128 points; and since it transforms one contiguous line at a time, a 64 x 64 transform with it takes 138 us, with
// this 62 us (both measured on one core in the same process). Mixed radices in double precision are otherwise in
// KISS FFT and PFFFT compiled to WebAssembly, which need a looser content security policy, and in FFTW (GPL).

/** The factors of n: primes in decreasing order, then 4, then as many 8 as leave no 2. */
export function factors(n: number): number[] {
  const out: number[] = [];
  let left = n;
  let twos = 0;
  for (let rest = n; rest % 2 === 0; rest /= 2) twos += 1;
  // 2, 4, 8, 4 4, 4 8, 8 8, 4 4 8, ...
  for (; twos >= 3 && twos !== 4; twos -= 3, left /= 8) out.push(8);
  for (; left % 4 === 0; left /= 4) out.push(4);
  for (let p = 2; left > 1; p += 1) for (; left % p === 0; left /= p) out.push(p);
  // Radices 8, or else 4, come last, where their roots are 1.
  return out.reverse();
}

/** exp(-2πi k/n), k = 0 ... n - 1, each correct to rounding. */
export function roots(n: number): Float64Array {
  const out = new Float64Array(2 * n);
  for (let k = 0; k < n; k += 1) {
    // Angles are reduced to an eighth of the circle, so that roots that are mirror images are exactly that.
    const eighth = Math.floor((8 * k) / n);
    const rest = 8 * k - eighth * n;
    const odd = eighth % 2 === 1;
    const part = odd ? n - rest : rest;
    const angle = (Math.PI / 4) * (part / n);
    const [near, far] = part === n ? [Math.SQRT1_2, Math.SQRT1_2] : [Math.cos(angle), Math.sin(angle)];
    const turn = Math.floor((eighth + 1) / 2) % 4;
    const sine = odd ? -far : far;
    const [c, s] = turn === 0 ? [near, sine] : turn === 1 ? [-sine, near] : turn === 2 ? [-near, -sine] : [sine, -near];
    out[2 * k] = c;
    out[2 * k + 1] = -s;
  }
  return out;
}

interface Stage {
  radix: number;
  /** The length that is left at this stage, and by how much roots of the whole length are strided. */
  n: number;
  step: number;
}

/** Transforms of length n along the middle axis of arrays [lines][n][width]. */
export class Lines {
  private readonly stages: Stage[];
  private readonly roots: [Float64Array, Float64Array];

  get count(): number {
    return this.stages.length;
  }

  constructor(readonly n: number) {
    let left = n;
    this.stages = factors(n).map((radix) => {
      const stage = { radix, n: left, step: n / left };
      left /= radix;
      return stage;
    });
    const forward = roots(n);
    this.roots = [forward, forward.map((value, k) => (k % 2 ? -value : value))];
  }

  /**
   * Transform `from` and return the array with the result: the first stage writes into `one`, the next into `other`,
   * which may be `from`, and so on. Not scaled.
   */
  run(from: Float64Array, one: Float64Array, other: Float64Array, lines: number, width: number, inverse: boolean): Float64Array {
    const w = this.roots[inverse ? 1 : 0];
    const sign = inverse ? -1 : 1;
    let source = from;
    let target = one;
    for (const { radix, n, step } of this.stages) {
      const s = step * width;
      if (radix === 8 && n === 8) lastEight(source, target, s, lines, sign);
      else if (radix === 8) eight(source, target, n, s, lines, w, step, sign);
      else if (radix === 4 && n === 4) lastFour(source, target, s, lines, sign);
      else if (radix === 4 && s === 1) firstFour(source, target, n, lines, w, sign);
      else if (radix === 4) four(source, target, n, s, lines, w, step, sign);
      else if (radix === 2) two(source, target, n, s, lines, w, step);
      else if (radix === 3) three(source, target, n, s, lines, w, step, sign);
      else if (radix === 5) five(source, target, n, s, lines, w, step, sign);
      else prime(source, target, radix, n, s, lines, w, step, this.n);
      source = target;
      target = target === one ? other : one;
    }
    return source;
  }
}
