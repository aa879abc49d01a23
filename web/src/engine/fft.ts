// One-dimensional complex transforms of many lines at once, by the Stockham algorithm with radices 4, 2, 3, 5
// and any prime. Complex numbers are interleaved: re, im, re, im, ...
//
// Why not a package: fft.js (MIT), the fastest in plain JavaScript, takes powers of two only, but cells have 48 x
// 128 points; and since it transforms one contiguous line at a time, a 64 x 64 transform with it takes 138 us, with
// this 62 us (both measured on one core in the same process). Mixed radices in double precision are otherwise in
// KISS FFT and PFFFT compiled to WebAssembly, which need a looser content security policy, and in FFTW (GPL).

/** The factors of n: primes in decreasing order, then as many 4 as possible. */
export function factors(n: number): number[] {
  const out: number[] = [];
  let left = n;
  for (; left % 4 === 0; left /= 4) out.push(4);
  for (let p = 2; left > 1; p += 1) for (; left % p === 0; left /= p) out.push(p);
  // The radices 4 come last, where their roots are 1.
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
    const angle = (Math.PI / 4) * ((odd ? n - rest : rest) / n);
    const [near, far] = [Math.cos(angle), Math.sin(angle)];
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
      if (radix === 4 && n === 4) lastFour(source, target, s, lines, sign);
      else if (radix === 4) four(source, target, n, s, lines, w, step, sign);
      else if (radix === 2) two(source, target, n, s, lines, w, step);
      else if (radix === 3) three(source, target, n, s, lines, w, step, sign);
      else prime(source, target, radix, n, s, lines, w, step, this.n);
      source = target;
      target = target === one ? other : one;
    }
    return source;
  }
}

function two(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number): void {
  const m = n / 2;
  const a = 2 * s * m;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const wr = w[2 * p * step]!;
      const wi = w[2 * p * step + 1]!;
      let i = base + 2 * s * p;
      let j = base + 4 * s * p;
      for (const end = i + 2 * s; i < end; i += 2, j += 2) {
        const ar = x[i]!, ai = x[i + 1]!, br = x[i + a]!, bi = x[i + a + 1]!;
        const dr = ar - br, di = ai - bi;
        y[j] = ar + br;
        y[j + 1] = ai + bi;
        y[j + 2 * s] = dr * wr - di * wi;
        y[j + 2 * s + 1] = dr * wi + di * wr;
      }
    }
  }
}

function three(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number, sign: number): void {
  const m = n / 3;
  const a = 2 * s * m;
  const o = 2 * s;
  const sine = sign * Math.sqrt(0.75);
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const k = 2 * p * step;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!;
      let i = base + 2 * s * p;
      let j = base + 6 * s * p;
      for (const end = i + 2 * s; i < end; i += 2, j += 2) {
        const ar = x[i]!, ai = x[i + 1]!, br = x[i + a]!, bi = x[i + a + 1]!, cr = x[i + 2 * a]!, ci = x[i + 2 * a + 1]!;
        const pr = br + cr, pi = bi + ci, nr = sine * (bi - ci), ni = sine * (cr - br);
        const hr = ar - 0.5 * pr, hi = ai - 0.5 * pi;
        const t1r = hr + nr, t1i = hi + ni, t2r = hr - nr, t2i = hi - ni;
        y[j] = ar + pr;
        y[j + 1] = ai + pi;
        y[j + o] = t1r * w1r - t1i * w1i;
        y[j + o + 1] = t1r * w1i + t1i * w1r;
        y[j + 2 * o] = t2r * w2r - t2i * w2i;
        y[j + 2 * o + 1] = t2r * w2i + t2i * w2r;
      }
    }
  }
}

function four(x: Float64Array, y: Float64Array, n: number, s: number, lines: number, w: Float64Array, step: number, sign: number): void {
  const m = n / 4;
  const a = 2 * s * m;
  const o = 2 * s;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      const k = 2 * p * step;
      const w1r = w[k]!, w1i = w[k + 1]!, w2r = w[2 * k]!, w2i = w[2 * k + 1]!, w3r = w[3 * k]!, w3i = w[3 * k + 1]!;
      let i0 = base + 2 * s * p;
      let j0 = base + 8 * s * p;
      for (const end = i0 + 2 * s; i0 < end; i0 += 2, j0 += 2) {
        const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a;
        const ar = x[i0]!, ai = x[i0 + 1]!, br = x[i1]!, bi = x[i1 + 1]!;
        const cr = x[i2]!, ci = x[i2 + 1]!, dr = x[i3]!, di = x[i3 + 1]!;
        const pr = ar + cr, pi = ai + ci, mr = ar - cr, mi = ai - ci;
        const qr = br + dr, qi = bi + di, nr = sign * (bi - di), ni = sign * (dr - br);
        const t1r = mr + nr, t1i = mi + ni, t2r = pr - qr, t2i = pi - qi, t3r = mr - nr, t3i = mi - ni;
        const j1 = j0 + o, j2 = j1 + o, j3 = j2 + o;
        y[j0] = pr + qr;
        y[j0 + 1] = pi + qi;
        y[j1] = t1r * w1r - t1i * w1i;
        y[j1 + 1] = t1r * w1i + t1i * w1r;
        y[j2] = t2r * w2r - t2i * w2i;
        y[j2 + 1] = t2r * w2i + t2i * w2r;
        y[j3] = t3r * w3r - t3i * w3i;
        y[j3 + 1] = t3r * w3i + t3i * w3r;
      }
    }
  }
}

/** `four` where the length left is four, and so all roots are 1. */
function lastFour(x: Float64Array, y: Float64Array, s: number, lines: number, sign: number): void {
  const a = 2 * s;
  for (let line = 0, base = 0; line < lines; line += 1, base += 8 * s) {
    for (let i0 = base, end = base + a; i0 < end; i0 += 2) {
      const i1 = i0 + a, i2 = i1 + a, i3 = i2 + a;
      const ar = x[i0]!, ai = x[i0 + 1]!, br = x[i1]!, bi = x[i1 + 1]!;
      const cr = x[i2]!, ci = x[i2 + 1]!, dr = x[i3]!, di = x[i3 + 1]!;
      const pr = ar + cr, pi = ai + ci, mr = ar - cr, mi = ai - ci;
      const qr = br + dr, qi = bi + di, nr = sign * (bi - di), ni = sign * (dr - br);
      y[i0] = pr + qr;
      y[i0 + 1] = pi + qi;
      y[i1] = mr + nr;
      y[i1 + 1] = mi + ni;
      y[i2] = pr - qr;
      y[i2 + 1] = pi - qi;
      y[i3] = mr - nr;
      y[i3 + 1] = mi - ni;
    }
  }
}

/** The defining sum, for the radices that are rare: r² operations for r values. */
function prime(x: Float64Array, y: Float64Array, r: number, n: number, s: number, lines: number, w: Float64Array, step: number, whole: number): void {
  const m = n / r;
  const a = 2 * s * m;
  const turn = whole / r;
  for (let line = 0, base = 0; line < lines; line += 1, base += 2 * n * s) {
    for (let p = 0; p < m; p += 1) {
      for (let f = 0; f < r; f += 1) {
        const wr = w[2 * p * step * f]!, wi = w[2 * p * step * f + 1]!;
        let i = base + 2 * s * p;
        let j = base + 2 * s * (r * p + f);
        for (const end = i + 2 * s; i < end; i += 2, j += 2) {
          let tr = 0, ti = 0;
          for (let k = 0, at = 0, c = i; k < r; k += 1, c += a) {
            const er = w[2 * at]!, ei = w[2 * at + 1]!, xr = x[c]!, xi = x[c + 1]!;
            tr += xr * er - xi * ei;
            ti += xr * ei + xi * er;
            at += f * turn;
            if (at >= whole) at -= whole;
          }
          y[j] = tr * wr - ti * wi;
          y[j + 1] = tr * wi + ti * wr;
        }
      }
    }
  }
}
